"""Assembly: constraints of the tests' own agree with equations by hand; wrong parts are refused."""

import subprocess
import sys
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest
import sympy as sp
from sympy.physics.mechanics import (
    KanesMethod,
    Point,
    ReferenceFrame,
    RigidBody,
    dynamicsymbols,
    inertia,
)

import geomtorsion as gt
from geomtorsion.errors import SceneError
from geomtorsion.scenes import Body, Scene, State, effects
from geomtorsion.scenes.assembly import assemble, gathered
from geomtorsion.scenes.context import OMEGA, Context
from geomtorsion.scenes.effects import Constraint, Contribution, Effect


@dataclass(frozen=True)
class Gimbal(Effect):
    """The body rotates only around the vertical (speed b) and its first axis (speed a)."""

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
    """There is one term for each product of states; denominators with states are kept."""
    x, y, k, m = sp.symbols("x y k m")
    assert gathered(k * x * y + m * x * y - 2 * x / (1 + y), frozenset({k, m})) == {
        x * y: k + m, x / (1 + y): -2,
    }  # fmt: skip
    assert gathered(k * (x - x), frozenset({k})) == {}


def test_equations_of_a_top_by_hand():
    """Lagrange's top agrees with Landau and Lifshitz (section 35), in body axes."""
    body = Body(mass=2.0, moments=(1, 1, 0.5))
    made = assemble(body, {"g": effects.Gravity(), "p": effects.Pivot((0, 0, 0.25))})
    names = "Omega1 Omega2 Omega3 n1 n2 m g a3 I1 I3"
    o1, o2, o3, n1, n2, m, g, a, i1, i3 = sp.symbols(names)
    around = i1 + m * a**2
    assert sp.simplify(made.rates[o1] * around - ((around - i3) * o2 * o3 + m * g * a * n2)) == 0
    assert sp.simplify(made.rates[o2] * around + (around - i3) * o1 * o3 + m * g * a * n1) == 0
    assert made.rates[o3] == 0


def test_a_tensor_is_inverted_exactly():
    """J is the inverse of I exactly, not only to rounding."""
    inertia = [[1.0, 0.1, 0.0], [0.1, 2.0, 0.2], [0.0, 0.2, 2.5]]
    made = assemble(Body(inertia=inertia), {})
    values = {sp.Symbol(k): v for k, v in made.values.items()}
    matrix = made.inertia.xreplace(values)
    names = [[f"J{min(i, j)}{max(i, j)}" for j in (1, 2, 3)] for i in (1, 2, 3)]
    inverse = sp.Matrix([[made.values.get(name, 0) for name in row] for row in names])
    assert matrix * inverse == sp.eye(3)


@dataclass(frozen=True)
class Odd(Effect):
    """An effect that adds the given contribution."""

    brings: Contribution
    key: ClassVar[str] = "odd"
    title: ClassVar[str] = "odd"
    several: ClassVar[bool] = True

    def adds(self, context: Context) -> Contribution:
        return self.brings


def test_bad_calls_are_refused():
    body = Body(moments=(1, 2, 3))
    with pytest.raises(
        SceneError, match="expected one effect that constrains .*, got gimbal and pivot"
    ):
        assemble(body, {"gimbal": Gimbal(), "pivot": effects.Pivot((0, 0, 1))})
    one = Odd(Contribution(states={"w": sp.S.One}, start={"w": 0}))
    with pytest.raises(SceneError, match="expected a new state, got 'w', which another effect has"):
        assemble(body, {"odd": one, "odd2": one})
    with pytest.raises(SceneError, match="expected a start for the state 'w', got none"):
        assemble(body, {"odd": Odd(Contribution(states={"w": sp.S.One}))})
    context = Context(body)
    with pytest.raises(SceneError, match="expected a new name, got 'Omega1'"):
        context.state("Omega1")
    with pytest.raises(SceneError, match="k: expected a finite number, got nan"):
        context.parameter("k", float("nan"))
    with pytest.raises(SceneError, match="arm: expected three components, got"):
        context.vector("arm", (1, 2))


def test_names_of_parameters():
    """Zeros stay zeros, equal moments share a symbol, a used name gets the key as suffix."""
    context = Context(Body(moments=(2, 2, 1)))
    assert context.inertia == sp.diag(*sp.symbols("I1 I1 I3"))
    context.key = "spring2"
    assert context.parameter("k", 0) == 0
    assert context.parameter("k", 1) == sp.Symbol("k")
    assert context.parameter("k", 2) == sp.Symbol("k_spring2")
    assert context.switchable("on", 0) == sp.Symbol("on")
    assert context.values["k_spring2"] == 2


E = effects
MASS, MOMENTS, G = 2.0, (1.0, 1.6, 2.1), 9.81
PHI = dynamicsymbols("phi1:4")
SPEEDS = dynamicsymbols("w1:4")


def turning():
    """Space frame, body frame in the paper's angles, Rz(phi3) Ry(phi2) Rz(phi1), its relations."""
    space, body = ReferenceFrame("N"), ReferenceFrame("B")
    body.orient_body_fixed(space, (PHI[2], PHI[1], PHI[0]), "ZYZ")
    rate = body.ang_vel_in(space)
    relations = [
        rate.dot(axis) - w for axis, w in zip((body.x, body.y, body.z), SPEEDS, strict=True)
    ]
    body.set_ang_vel(space, SPEEDS[0] * body.x + SPEEDS[1] * body.y + SPEEDS[2] * body.z)
    return space, body, relations


def solved(method, table):
    """Accelerations at numbers, from mass matrix and forcing."""
    matrix = np.array(method.mass_matrix.xreplace(table).evalf().tolist(), dtype=float)
    right = np.array(method.forcing.xreplace(table).evalf().tolist(), dtype=float)
    return np.linalg.solve(matrix, right).ravel()


def random_numbers(seed):
    """Angles and angular velocity."""
    rng = np.random.default_rng(seed)
    return rng.uniform([0, 0.3, 0], [6, 2.8, 6]), rng.normal(size=3)


def rates(scene, names, **values):
    """Rates of states from a scene at its start, which is given by `values`."""
    moved = Scene(scene.body, scene.effects, State(**values), scene.watch, scene.t)
    start, parameters = moved.numbers
    table = {sp.Symbol(k): sp.Float(float(v), 30) for k, v in {**parameters, **start}.items()}
    return [float(moved.equations[name].xreplace(table)) for name in names]


def test_a_heavy_asymmetric_top_with_skew_inertia():
    """A pivot, gravity and a torque of the body, with products of inertia."""
    tensor = [[1.2, 0.1, -0.2], [0.1, 1.6, 0.3], [-0.2, 0.3, 2.1]]
    arm = (0.3, -0.2, 0.5)
    scene = Scene(
        Body(MASS, inertia=tensor),
        [E.Gravity(G), E.Pivot(arm), E.AngularDamping((0.1, 0.2, 0.3))],
        State(omega=(0, 0, 1), euler=(0, 1, 0)), ["omega"], 1,
    )  # fmt: skip
    space, body, relations = turning()
    fixed, centre = Point("O"), Point("C")
    fixed.set_vel(space, 0)
    centre.set_pos(fixed, arm[0] * body.x + arm[1] * body.y + arm[2] * body.z)
    centre.v2pt_theory(fixed, space, body)
    dyadic = inertia(body, 1.2, 1.6, 2.1, 0.1, 0.3, -0.2)
    top = RigidBody("top", centre, body, MASS, (dyadic, centre))
    damping = -sum((c * w * axis for c, w, axis in zip(
        (0.1, 0.2, 0.3), SPEEDS, (body.x, body.y, body.z), strict=True)), 0 * body.x)  # fmt: skip
    method = KanesMethod(space, q_ind=PHI, u_ind=SPEEDS, kd_eqs=relations)
    method.kanes_equations([top], [(centre, -MASS * G * space.z), (body, damping)])
    for seed in range(4):
        angles, omega = random_numbers(seed)
        theirs = solved(method, dict(zip((*PHI, *SPEEDS), (*angles, *omega), strict=True)))
        ours = rates(scene, ["Omega1", "Omega2", "Omega3"], omega=omega, euler=angles)
        assert abs(theirs - ours).max() < 1e-12 * abs(theirs).max()


@pytest.mark.parametrize("shape", ["disc", "ball"])
def test_a_rolling_disc_and_a_rolling_ball_with_unequal_moments(shape):
    """The velocity of the centre follows from the point of contact; gravity acts."""
    r = 0.4
    scene = Scene(
        Body(MASS, MOMENTS), [E.Rolling(r, shape), E.Gravity(G), E.LinearDrag(0.3)],
        State(omega=(0, 0, 1), euler=(0, 1, 0)), ["omega"], 1,
    )  # fmt: skip
    space, body, relations = turning()
    contact, centre = Point("K"), Point("C")
    contact.set_vel(space, 0)
    # In the disc: a quarter turn from the line of nodes, up the slope.
    tilted = ReferenceFrame("L")
    tilted.orient_body_fixed(space, (PHI[2], PHI[1], 0), "ZYZ")
    upward = -tilted.x if shape == "disc" else space.z
    centre.set_pos(contact, r * upward)
    centre.set_vel(space, (body.ang_vel_in(space)).cross(r * upward))
    wheel = RigidBody("wheel", centre, body, MASS, (inertia(body, *MOMENTS), centre))
    method = KanesMethod(space, q_ind=PHI, u_ind=SPEEDS, kd_eqs=relations)
    pull = -MASS * G * space.z - 0.3 * centre.vel(space)
    method.kanes_equations([wheel], [(centre, pull)])
    for seed in range(3):
        angles, omega = random_numbers(seed)
        theirs = solved(method, dict(zip((*PHI, *SPEEDS), (*angles, *omega), strict=True)))
        ours = rates(scene, ["Omega1", "Omega2", "Omega3"], omega=omega, euler=angles)
        assert abs(theirs - ours).max() < 1e-11 * abs(theirs).max()


def test_a_sleigh_with_its_centre_off_the_blade():
    """Chaplygin's sleigh with arm (a, b), drag and a spring at the centre of mass."""
    a, b, drag, stiff = 0.3, -0.2, 0.4, 3.0
    scene = Scene(
        Body(MASS, MOMENTS),
        [E.KnifeEdge((a, b, 0), speed=1.5), E.LinearDrag(drag), E.Spring(stiff)],
        State(omega=(0, 0, 0.7), euler=(0.4, 0, 0), position=(0.5, -0.3, 0)), ["omega"], 1,
    )  # fmt: skip
    angle, x, y, u, w = dynamicsymbols("angle x y u w")
    space = ReferenceFrame("N")
    body = space.orientnew("B", "Axis", (angle, space.z))
    body.set_ang_vel(space, w * space.z)
    origin, blade, centre = Point("O"), Point("A"), Point("C")
    origin.set_vel(space, 0)
    centre.set_pos(origin, x * space.x + y * space.y)
    blade.set_vel(space, u * body.x)
    blade.set_pos(centre, -a * body.x - b * body.y)
    velocity = u * body.x + (w * space.z).cross(a * body.x + b * body.y)
    centre.set_vel(space, velocity)
    sled = RigidBody("sled", centre, body, MASS, (inertia(body, *MOMENTS), centre))
    relations = [
        angle.diff() - w,
        x.diff() - velocity.dot(space.x),
        y.diff() - velocity.dot(space.y),
    ]
    method = KanesMethod(space, q_ind=[angle, x, y], u_ind=[u, w], kd_eqs=relations)
    pull = -drag * velocity - stiff * (x * space.x + y * space.y)
    method.kanes_equations([sled], [(centre, pull)])
    theirs = solved(method, {angle: 0.4, x: 0.5, y: -0.3, u: 1.5, w: 0.7})
    values = {"omega": (0, 0, 0.7), "euler": (0.4, 0, 0), "position": (0.5, -0.3, 0)}
    assert abs(theirs - rates(scene, ["u", "Omega3"], **values)).max() < 1e-13 * abs(theirs).max()


def test_short_sums_are_gathered_and_long_ones_left():
    """Short products of sums are expanded, so that like terms meet; long ones stay factored."""
    for count, factored in ((3, False), (20, False), (40, True)):
        series = " + ".join(f"y**{k}" for k in range(1, count))
        effect = E.BodyMoment((f"(x + 1)*({series})", 0, 0))
        rate = assemble(Body(moments=(1, 2, 3)), {"body_moment": effect}).rates[OMEGA[0]]
        assert (sp.Symbol("x") + 1 in rate.atoms(sp.Add)) == factored


def outcome(scene):
    """Invariants, equations and states of a scene, as text that shows every bit."""
    solution = gt.solve(scene.ode, 1.0, 1e-8)
    states = solution.states.astype(float).tobytes().hex()
    return str((sorted(scene.ode.invariants), dict(scene.ode.rates.expressions), states))


VARIANTS = {
    "helix": [{}, {"torsion.strength": 0.5}, {"body.mass": 3}, {"torsion.strength": 0}],
    "lagrange_loop": [{}, {"gravity.g": 1.62}, {"pivot.arm[0]": 0.01}],
    "rolling_disc": [{}, {"gravity.g": 3}],
}


@pytest.mark.parametrize("name", VARIANTS)
def test_a_changed_number_compiles_nothing(name):
    """Scenes of one form share their compiled equations, and no result depends on the order."""
    scenes = [gt.scenes.load(name).with_values(change) for change in VARIANTS[name]]
    forward = [outcome(scene) for scene in scenes]
    again = [gt.scenes.load(name).with_values(change) for change in VARIANTS[name]]
    assert [outcome(scene) for scene in reversed(again)] == forward[::-1]
    assert again[0].ode.rates is scenes[0].ode.rates
    assert again[1].ode.rates is scenes[0].ode.rates
    # A new process has seen none of the other variants.
    code = (
        "import geomtorsion as gt; from tests.scenes.test_assembly import outcome; "
        f"print(outcome(gt.scenes.load({name!r}).with_values({VARIANTS[name][-1]!r})))"
    )
    alone = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert alone.stdout.strip() == forward[-1]


def test_invariants_depend_on_numbers():
    """Torsion of strength 1 keeps each angular velocity; strength 1/2 does not."""
    body, start = Body(moments=(1, 2, 3)), State(omega=(1, 2, 3))
    half, whole = (
        Scene(body, [effects.Torsion(size)], start, watch=["omega"]) for size in (0.5, 1)
    )
    assert "axial_angular_momentum" in whole.ode.invariants
    assert "axial_angular_momentum" not in half.ode.invariants
