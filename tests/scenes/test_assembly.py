"""Assembly: constraints that nobody ships, against equations by hand, and what is refused."""

from dataclasses import dataclass
from typing import ClassVar

import pytest
import sympy as sp

from geomtorsion.errors import SceneError
from geomtorsion.scenes import Body, Scene, State, effects
from geomtorsion.scenes.assembly import assemble
from geomtorsion.scenes.context import Context
from geomtorsion.scenes.effects import Constraint, Contribution, Effect
from geomtorsion.scenes.kane import gathered


@dataclass(frozen=True)
class Gimbal(Effect):
    """Turns about the vertical (speed b) and about the first body axis (speed a) only."""

    key: ClassVar[str] = "gimbal"
    title: ClassVar[str] = "two axes"

    def adds(self, context: Context) -> Contribution:
        a, b = (context.state(name) for name in "ab")
        n = context.vertical
        held = Constraint(("a", "b"), (a + b * n[0], b * n[1], b * n[2]), (0, 0, 0),
                          position=(0, 0, 0), start={"a": 0.3, "b": 2.0})  # fmt: skip
        return Contribution(constraint=held)


def test_a_gimbal():
    """L = (I1 a^2 + (I2 s^2 + I3 c^2) b^2) / 2 with the tilt theta' = a: Lagrange by hand."""
    made = assemble(Body(moments=(1, 2, 3)), {"gimbal": Gimbal()})
    a, b, n2, n3, i1, i2, i3 = sp.symbols("a b n2 n3 I1 I2 I3")
    # On the motion n1 = 0: then n = (0, sin theta, cos theta).
    flat = {sp.Symbol("n1"): 0}
    rates = [sp.simplify(made.rates[s].xreplace(flat)) for s in (a, b)]
    around = i2 * n2**2 + i3 * n3**2
    assert sp.simplify(rates[0] - (i2 - i3) * n2 * n3 * b**2 / i1) == 0
    assert sp.simplify(rates[1] + 2 * (i2 - i3) * n2 * n3 * a * b / around) == 0


def test_a_gimbal_runs():
    """Its momentum about the vertical and its energy are found and kept."""
    scene = Scene(
        Body(moments=(1, 2, 3)), (Gimbal(),), State(quaternion=(1, 0, 0, 0)), ["a", "energy"], t=9
    )
    assert scene.selection.states == ("a", "b", "n1", "n2", "n3")
    drift = scene.run().drift
    assert drift["energy"] < 1e-10
    assert drift["vertical_angular_momentum"] < 1e-10


def test_terms_are_gathered():
    """One term for each product of states; denominators of states stay where they are."""
    x, y, k, m = sp.symbols("x y k m")
    assert gathered(k * x * y + m * x * y - 2 * x / (1 + y), frozenset({k, m})) == {
        x * y: k + m, x / (1 + y): -2,
    }  # fmt: skip
    assert gathered(k * (x - x), frozenset({k})) == {}


def test_equations_of_a_top_by_hand():
    """Lagrange's top as Landau and Lifshitz have it (section 35), in body axes."""
    body = Body(mass=2.0, moments=(1, 1, 0.5))
    made = assemble(body, {"g": effects.Gravity(), "p": effects.Pivot((0, 0, 0.25))})
    names = "Omega1 Omega2 Omega3 n1 n2 m g a3 I1 I3"
    o1, o2, o3, n1, n2, m, g, a, i1, i3 = sp.symbols(names)
    around = i1 + m * a**2
    assert sp.simplify(made.rates[o1] * around - ((around - i3) * o2 * o3 + m * g * a * n2)) == 0
    assert sp.simplify(made.rates[o2] * around + (around - i3) * o1 * o3 + m * g * a * n1) == 0
    assert made.rates[o3] == 0


def test_a_tensor_is_inverted_exactly():
    """J is the inverse of I to the last digit, not to rounding."""
    inertia = [[1.0, 0.1, 0.0], [0.1, 2.0, 0.2], [0.0, 0.2, 2.5]]
    made = assemble(Body(inertia=inertia), {})
    values = {sp.Symbol(k): v for k, v in made.values.items()}
    matrix = made.inertia.xreplace(values)
    names = [[f"J{min(i, j)}{max(i, j)}" for j in (1, 2, 3)] for i in (1, 2, 3)]
    inverse = sp.Matrix([[made.values.get(name, 0) for name in row] for row in names])
    assert matrix * inverse == sp.eye(3)


@dataclass(frozen=True)
class Odd(Effect):
    """Brings whatever it is given."""

    brings: Contribution
    key: ClassVar[str] = "odd"
    title: ClassVar[str] = "odd"
    several: ClassVar[bool] = True

    def adds(self, context: Context) -> Contribution:
        return self.brings


def test_what_is_refused():
    body = Body(moments=(1, 2, 3))
    with pytest.raises(SceneError, match="gimbal and pivot both tie"):
        assemble(body, {"gimbal": Gimbal(), "pivot": effects.Pivot((0, 0, 1))})
    one = Odd(Contribution(states={"w": sp.S.One}, start={"w": 0}))
    with pytest.raises(SceneError, match="brings the state 'w', which another effect has"):
        assemble(body, {"odd": one, "odd2": one})
    with pytest.raises(SceneError, match="the state 'w' without a start"):
        assemble(body, {"odd": Odd(Contribution(states={"w": sp.S.One}))})
    context = Context(body)
    with pytest.raises(SceneError, match="'Omega1' is taken already"):
        context.state("Omega1")
    with pytest.raises(SceneError, match="k = nan: a finite number"):
        context.parameter("k", float("nan"))
    with pytest.raises(SceneError, match="arm has 2 components"):
        context.vector("arm", (1, 2))


def test_names_of_parameters():
    """Zeros stay zeros, equal moments share a symbol, a taken name gets the key."""
    context = Context(Body(moments=(2, 2, 1)))
    assert context.inertia == sp.diag(*sp.symbols("I1 I1 I3"))
    context.key = "spring2"
    assert context.parameter("k", 0) == 0
    assert context.parameter("k", 1) == sp.Symbol("k")
    assert context.parameter("k", 2) == sp.Symbol("k_spring2")
    assert context.switchable("on", 0) == sp.Symbol("on")
    assert context.values["k_spring2"] == 2
