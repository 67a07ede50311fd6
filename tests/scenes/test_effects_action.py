"""Equations assembled by effects equal those derived by action/ from a Lagrangian: exact zero."""

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.exact import Field
from geomtorsion.scenes import Body, effects
from geomtorsion.scenes.assembly import assemble
from geomtorsion.scenes.context import ATTITUDE, OMEGA, POSITION, VELOCITY
from tests.chosen import few

E = effects
MASS, MOMENTS = sp.Integer(2), (sp.Integer(1), sp.Rational(3, 2), sp.Rational(9, 4))
BODY = Body(mass=MASS, moments=MOMENTS)
PHI = sp.symbols("phi1:4", real=True)
X = sp.symbols("x1:4", real=True)
U = sp.symbols("u1:7")
T = sp.Symbol("t")
G = sp.Rational(49, 5)
W, V = sp.Matrix(U[:3]), sp.Matrix(U[3:])
R = (
    sp.rot_ccw_axis3(PHI[2]) * sp.rot_ccw_axis2(PHI[1]) * sp.rot_ccw_axis3(PHI[0])
)  # body to space, the paper's angles
SPINNING = sum(i * w**2 for i, w in zip(MOMENTS, W, strict=True)) / 2
FLYING = SPINNING + MASS * V.dot(V) / 2
HEIGHT = X[2]


def q(value):
    """A decimal as a fraction, so that both sides have the same number."""
    return sp.Rational(value)


def assembled(*acting):
    """Rates of speeds from effects, in the symbols of the frame; velocities in body axes."""
    made = assemble(BODY, {effect.key: effect for effect in acting})
    table = {sp.Symbol(name): value for name, value in made.values.items()}
    table |= dict(zip(OMEGA, W, strict=True)) | dict(zip(POSITION, X, strict=True))
    table |= {ATTITUDE[i, j]: R[i, j] for i in range(3) for j in range(3)}
    table |= dict(zip(VELOCITY, R * V, strict=True)) | {sp.Symbol("u"): U[3]}
    rates = [made.rates[symbol].xreplace(table) for symbol in made.speeds]
    if made.constraint is None:
        space = sp.Matrix([made.rates[v].xreplace(table) for v in VELOCITY])
        rates += list(R.T * space - W.cross(V))
    return rates


def agree(found, acting) -> None:
    """All differences are exactly zero; both derivations of action/ agree as well."""
    theirs = dict(zip([s.name for s in found.velocities], found.accelerations, strict=True))
    ours = assembled(*acting)
    assert len(theirs) == len(ours)
    # A sleigh has its forward speed first; the frame has its rotation first.
    names = sorted(theirs) if len(ours) != 2 else sorted(theirs, reverse=True)
    field = Field([*PHI, *X, *U, T])
    for name, mine in zip(names, ours, strict=True):
        assert field.read(sp.sympify(theirs[name] - mine)).is_zero
    assert found.agrees is True


SPRING_END = sp.Matrix(X) + R * sp.Matrix([0, q(0.5), 1]) - sp.Matrix([1, 0, 2])
DIPOLE = sp.Matrix([1, 0, 2])
ORBIT = R.T * sp.Matrix([sp.cos(T / 2), sp.sin(T / 2), 0])
TIDE = sp.Matrix([i * c for i, c in zip(MOMENTS, ORBIT, strict=True)])
BLOWN = V + W.cross(sp.Matrix([0, 0, -1])) - R.T * sp.Matrix([3, 0, 0])
DRAG = -q(0.25) * BLOWN
PUSH = sp.Matrix([0, 3 * sp.cos(T), 10])

FREE = {
    "spin": ([], FLYING, None, "closed_in_coordinates"),
    "gravity": ([E.Gravity(G)], FLYING - MASS * G * HEIGHT, None, "closed_in_coordinates"),
    "spring": (
        [E.Spring(3, arm=(0, q(0.5), 1), anchor=(1, 0, 2))],
        FLYING - q(1.5) * SPRING_END.dot(SPRING_END), None, "closed_in_coordinates",
    ),
    "magnet": (
        [E.Magnet(DIPOLE, ("cos(t)", 0, 2))],
        FLYING + (R * DIPOLE).dot(sp.Matrix([sp.cos(T), 0, 2])), None, "closed_in_coordinates",
    ),
    "gravity gradient": (
        [E.GravityGradient(q(0.5))],
        FLYING - q(0.375) * ORBIT.dot(TIDE), None, "closed_in_coordinates",
    ),
    "rotor": (
        [E.Rotor((0, 3, 4), 5)], FLYING + 3 * W[1] + 4 * W[2], None, "closed_in_coordinates",
    ),
    "drag": (
        [E.LinearDrag(q(0.25), arm=(0, 0, -1), wind=(3, 0, 0))],
        FLYING, [*sp.Matrix([0, 0, -1]).cross(DRAG), *DRAG], "closed_in_coordinates",
    ),
    "damping": (
        [E.AngularDamping((1, 2, 3))], FLYING, [-W[0], -2 * W[1], -3 * W[2], 0, 0, 0],
        "closed_in_coordinates",
    ),
    "missile": (
        [E.Thrust((0, "3*cos(t)", 10), point=(0, 1, -2))],
        FLYING, [*sp.Matrix([0, 1, -2]).cross(PUSH), *PUSH], "closed_in_coordinates",
    ),
    "body moment": (
        [E.BodyMoment((0, "t^2", "-Omega3"))], FLYING, [0, T**2, -W[2], 0, 0, 0],
        "closed_in_coordinates",
    ),
    "custom": (
        [E.Custom(force=(0, 0, "-2*vx"), moment=("n1", 0, 0))],
        FLYING, [R[2, 0], 0, 0, *(R.T * sp.Matrix([0, 0, -2 * (R * V)[0]]))],
        "closed_in_coordinates",
    ),
    "autoparallel": ([E.Torsion()], FLYING, None, "closed_in_image"),
}  # fmt: skip


@pytest.mark.parametrize("name", few(4, list(FREE)))
def test_free_bodies(name):
    """On the frame of R^3 x SO(3), by Hamilton's principle or (autoparallels) Kleinert's."""
    acting, lagrangian, forces, principle = FREE[name]
    frame = gt.spaces.load("r3xso3").frame
    agree(gt.equations_of_motion(frame, lagrangian, forces, principle), acting)


def test_heavy_top_and_naive_top():
    """On SO(3): moments about the pivot, by the right principle and the naive one."""
    frame = gt.spaces.load("so3").frame
    arm = sp.Matrix([q(0.25), 0, q(0.5)])
    lagrangian = SPINNING - MASS * G * (R * arm)[2]
    pivot = E.Pivot(tuple(arm), moments_at="pivot")
    agree(gt.equations_of_motion(frame, lagrangian), [E.Gravity(G), pivot])
    naive = gt.equations_of_motion(frame, SPINNING - 2 * sp.cos(PHI[1]), principle="naive")
    made = assembled(E.Naive(), E.Magnet((0, 0, 1), (0, 0, -2)))
    field = Field([*PHI, *X, *U])
    for theirs, ours in zip(naive.accelerations, made[:3], strict=True):
        assert field.read(theirs - ours).is_zero


def test_rolling_ball():
    """Chaplygin's ball: V = Omega x r n as constraints on the 6-frame."""
    r = q(0.5)
    rolling = list(V - W.cross(r * R[2, :].T))
    frame = gt.spaces.load("r3xso3").frame
    found = gt.equations_of_motion(frame, FLYING, constraints=rolling)
    agree(found, [E.Rolling(r, "ball")])


def test_rolling_disc():
    """In the chart sin(phi2) > 0 the contact is r (cos phi1, -sin phi1, 0) from the centre."""
    r = q(0.5)
    contact = r * sp.Matrix([sp.cos(PHI[0]), -sp.sin(PHI[0]), 0])
    rolling = list(V - contact.cross(W))
    frame = gt.spaces.load("r3xso3").frame
    lagrangian = FLYING - MASS * G * HEIGHT
    found = gt.equations_of_motion(frame, lagrangian, constraints=rolling)
    agree(found, [E.Gravity(G), E.Rolling(r)])


def test_chaplygin_sleigh_on_a_slope():
    """Omega1 = Omega2 = V3 = 0 and V2 = a Omega3; gravity along the inclined plane."""
    a = q(0.5)
    held = [U[0], U[1], U[4] - a * U[2], U[5]]
    frame = gt.spaces.load("r3xso3").frame
    lagrangian = FLYING - MASS * G * HEIGHT
    found = gt.equations_of_motion(frame, lagrangian, constraints=held)
    agree(found, [E.Gravity(G), E.KnifeEdge((a, 0, 0))])
