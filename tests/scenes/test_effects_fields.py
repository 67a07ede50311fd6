"""Effects refuse input that makes no sense, with the field, the value and a remedy."""

# The tests pass bad input and arrays for lists, and use results that could be None.
# pyright: reportArgumentType=false

from typing import Any

import pytest
import sympy as sp

from geomtorsion.errors import ExpressionError, SceneError
from geomtorsion.scenes import Body, effects
from geomtorsion.scenes.assembly import assemble
from geomtorsion.scenes.context import Context
from geomtorsion.scenes.effects.fields import between, read

E = effects
BODY = Body(mass=2.0, moments=(1.0, 1.6, 2.1))
BAD: Any = 3


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (
            lambda: E.GravityGradient(-1),
            r"gravity_gradient.rate: expected a number >= 0 \(rad/s\), got -1",
        ),
        (lambda: E.GravityGradient("fast"), "gravity_gradient.rate: .*, got 'fast'"),
        (lambda: E.Spring(-3), r"spring.stiffness: expected a number >= 0 \(N/m\), got -3"),
        (
            lambda: E.Spring(3, arm=(1, 2)),
            r"spring.arm: expected three components \(m\), got",
        ),
        (lambda: E.LinearDrag(float("nan")), "linear_drag.coefficient: .*, got nan"),
        (
            lambda: E.LinearDrag(1, wind=BAD),
            r"linear_drag.wind: expected three components \(m/s\), got 3",
        ),
        (lambda: E.QuadraticDrag(1, smoothing=-1), "quadratic_drag.smoothing: .*, got -1"),
        (lambda: E.AngularDamping(-1), "angular_damping.coefficient: expected one number >= 0"),
        (lambda: E.AngularDamping((1, 2)), "or three"),
        (lambda: E.AngularDamping((1, 2, "x")), "or three"),
        (lambda: E.Thrust("20"), "thrust.force: expected three components"),
        (
            lambda: E.Thrust((0, 0, 1), start=3, end=2),
            "expected an end after the start at 3 s, got 2 s",
        ),
        (lambda: E.Thrust((0, 0, 1), start="soon"), "thrust.start: .*, got 'soon'"),
        (
            lambda: E.BodyMoment((0, 0, 1), end=0),
            "body_moment: expected an end after the start at 0 s, got 0 s",
        ),
        (lambda: E.Magnet((0, 1), (0, 0, 1)), "magnet.dipole"),
        (lambda: E.Rotor((0, 0, 0), 1), r"rotor.axis: expected a direction, got \(0, 0, 0\)"),
        (lambda: E.Rotor((0, 0, 1), 1, inertia=0), "rotor.inertia: expected a number > 0"),
        (lambda: E.Rotor((0, 0, 1), 1, torque="t"), "expected also rotor.inertia"),
        (lambda: E.Rolling(0), "rolling.radius: expected a number > 0"),
        (lambda: E.Rolling(1, "wheel"), "expected one of disc, ball"),
        (lambda: E.KnifeEdge(speed=None), "knife_edge.speed: .*, got None"),
        (lambda: E.Torsion("on"), "torsion.strength: .*, got 'on'"),
        (lambda: E.Custom(moment=BAD), "custom.moment: expected three"),
        (lambda: E.Custom(axes="world"), "expected one of space, body"),
        (lambda: E.Custom(states={"a": "t"}), "expected a in both states and start"),
        (lambda: E.Custom(parameters=BAD), "parameters: expected a table of names"),
        (lambda: E.Custom(switches=[1]), "custom.switches"),
        (
            lambda: E.Custom(switches=[(1, {"k": 2})]),
            "got 'k'. There are none",
        ),
    ],
)
def test_fields_are_checked_at_the_door(make, words):
    with pytest.raises(SceneError, match=words):
        make()


@pytest.mark.parametrize(
    ("effect", "error", "words"),
    [
        (E.Thrust((0, 0, "20*exp(-s)")), ExpressionError, r"thrust.force\[2\]"),
        (E.Thrust((0, 0, "__import__('os')")), ExpressionError, r"thrust.force\[2\]"),
        (E.Thrust((0, 0, "f(t)")), ExpressionError, "f"),
        (E.BodyMoment(("t.real", 0, 0)), ExpressionError, r"body_moment.moment\[0\]"),
        (
            E.Magnet((0, 0, 1), (0, 0, "x")),
            SceneError,
            "magnet.field: expected a uniform field, .* got x",
        ),
        (E.Rotor((0, 0, 1), 1, inertia=9), SceneError, "expected less than 2.1 kg m"),
        (E.Rotor((0, 0, 1), 1, inertia=1, torque="k*w"), ExpressionError, "rotor.torque"),
        (E.Custom(force=("-k*x", 0, 0)), ExpressionError, "k"),
        (
            E.Custom(energy=sp.Symbol("Omega4")),
            ExpressionError,
            "expected a known name, got 'Omega4'",
        ),
        (E.Thrust((0, 0, "20*Omga1")), ExpressionError, "Did you mean Omega1"),
        (E.Custom(states={"x": "t"}, start={"x": 1}), SceneError, "expected a new name, got 'x'"),
    ],
)
def test_expressions_are_checked_when_they_are_read(effect, error, words):
    with pytest.raises(error, match=words):
        effect.adds(Context(BODY))


def test_expressions_may_hold_decimals_and_own_names():
    context = Context(BODY)
    w = sp.Symbol("w")
    found = read("0.25*w - Omega1/I1", context, "a", "somewhere", {"w": w})
    assert found == w / 4 - context.Omega[0] / context.inertia[0, 0]
    assert read(sp.Symbol("t", real=True) ** 2, context, "a", "") == context.t**2
    assert read(0, context, "a", "") == 0
    assert read(1.5, context, "a", "") == sp.Symbol("a")
    assert context.values["a"] == sp.Rational(3, 2)


def test_switches_follow_from_times():
    context = Context(BODY)
    context.key = "thrust"
    assert between(context, "one", None, None) == (1, ())
    on, switches = between(context, "two", 1, 2)
    assert switches == ((1, {on.name: 1}), (2, {on.name: 0}))
    assert context.values[on.name] == 0
    late, switches = between(context, "three", None, 2)
    assert switches == ((2, {late.name: 0}),)
    assert context.values[late.name] == 1
    with pytest.raises(SceneError, match="expected an end after the start"):
        between(context, "four", 2, 2)


def test_two_springs_have_names_of_their_own():
    """The parameters of a second effect of the same kind carry its key."""
    made = assemble(BODY, {"spring": E.Spring(3), "spring2": E.Spring(4)})
    stiff = sorted(name for name in made.values if name.startswith("k"))
    assert len(stiff) == 2
    assert sorted(float(made.values[name]) for name in stiff) == [3, 4]
