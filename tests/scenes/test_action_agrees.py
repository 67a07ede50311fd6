"""Action agrees: each shipped scene's equations follow from a Lagrangian over R^3 x SO(3), exactly.

The scene assembles forces and torques in the body and projects them (Kane); the action principle
varies a Lagrangian over the six-dimensional frame. They share no code; their difference is zero.
"""

# Tests pass what users pass, wrong input included, and read values that may be missing.
# pyright: reportAttributeAccessIssue=false

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.exact import Field
from geomtorsion.scenes.assembly import Assembly
from geomtorsion.scenes.context import ATTITUDE, OMEGA, POSITION, VELOCITY

FRAME = gt.spaces.load("r3xso3").frame
PHI, PLACE = FRAME.coordinates[:3], FRAME.coordinates[3:]
U = sp.symbols("u1:7")
# dX = R^T dx: the lower right block of the coframe is the rotation from space to body.
BODY_SPACE = sp.Matrix(6, 6, lambda i, j: sp.sympify(FRAME.coframe[int(i), int(j)]))[3:, 3:]
TABLE = (
    {ATTITUDE[i, j]: BODY_SPACE[j, i] for i in range(3) for j in range(3)}
    | dict(zip(OMEGA, U[:3], strict=True))
    | dict(zip(POSITION, PLACE, strict=True))
    | dict(zip(VELOCITY, BODY_SPACE.T * sp.Matrix(U[3:]), strict=True))
)
# The speed of the sleigh along its blade is the velocity along the first body axis.
MOVING = {sp.Symbol("u"): U[3]}


def in_frame(expression):
    """An expression of a scene in the coordinates and velocities of the frame."""
    return sp.sympify(expression).xreplace(TABLE).xreplace(MOVING)


def from_action(made: Assembly, principle: str):
    """Equations of motion from L = T - V, forces without potential, and constraints."""
    parts = [part for part in made.parts.values() if not part.replaces]
    omega, velocity = sp.Matrix(U[:3]), sp.Matrix(U[3:])
    momentum, forces = sp.zeros(3, 1), sp.zeros(6, 1)
    potential = sp.S.Zero
    for part in parts:
        assert not part.states, "scenes with states of effects are compared elsewhere"
        momentum += sp.Matrix(part.momentum or (0, 0, 0))
        if part.energy is not None:
            potential += in_frame(part.energy)
        else:
            push = BODY_SPACE * sp.Matrix([in_frame(f) for f in part.force or (0, 0, 0)])
            turn = sp.Matrix([in_frame(m) for m in part.moment or (0, 0, 0)])
            forces += sp.Matrix([*turn, *push])
    kinetic = (omega.T * made.inertia * omega)[0] / 2 + made.context.mass * velocity.dot(
        velocity
    ) / 2
    held = made.constraint
    kept = []
    if held is not None:
        kept = [in_frame(o) - u for o, u in zip(held.omega, U[:3], strict=True)]
        kept += [in_frame(v) - u for v, u in zip(held.velocity, U[3:], strict=True)]
        kept = [k for k in kept if k != 0]
    lagrangian = kinetic + momentum.dot(omega) - potential
    return gt.equations_of_motion(FRAME, lagrangian, list(forces), principle, kept or None)


def differences(made: Assembly, equations):
    """Differences that must vanish: rates of the scene less rates of the action, in the frame."""
    spin = sp.Matrix([in_frame(w) for w in made.omega])
    rates = equations.rates
    back = {}
    if made.constraint is not None:
        back = {u: in_frame(v) for u, v in zip(U[3:], made.constraint.velocity, strict=True)}
        back |= {u: in_frame(w) for u, w in zip(U[:3], made.omega, strict=True)}
        back = {u: v for u, v in back.items() if u != v}
    for symbol in made.speeds:
        name = str(TABLE.get(symbol, MOVING.get(symbol)))
        yield name, in_frame(made.rates[symbol]) - rates[name].xreplace(back)
    if made.constraint is None:
        # v = R V in space, so that R^T v' = V' + Omega x V.
        v = sp.Matrix(U[3:])
        turned = BODY_SPACE * sp.Matrix([in_frame(made.rates[s]) for s in VELOCITY])
        ours = turned - spin.cross(v)
        for name, value in zip(("u4", "u5", "u6"), ours, strict=True):
            yield name, value - rates[name]


def vanishes(expression) -> bool:
    symbols = sorted(expression.free_symbols, key=str)
    return not symbols or Field(symbols).read(expression).is_zero is True


PRINCIPLES = {"naive_top": "naive", "helix": "closed_in_image"}


@pytest.mark.parametrize("name", gt.scenes.names())
def test_equations_from_the_action(name):
    """The difference is exactly zero for every speed; constrained scenes use an adapted frame."""
    scene = gt.scenes.load(name)
    # Effects that replace the principle bring no force of their own here.
    lawful = {k: e for k, e in scene.keyed.items() if k not in ("naive", "torsion")}
    plain = gt.scenes.assembly.assemble(scene.body, lawful)
    equations = from_action(plain, PRINCIPLES.get(name, "closed_in_coordinates"))
    found: dict[str, sp.Expr] = dict(differences(scene.assembly, equations))
    assert len(found) == (6 if scene.assembly.constraint is None else len(scene.assembly.speeds))
    if name == "naive_top":
        # The scene is naive about the rotation, its subject, and not about the translation.
        found = {speed: found[speed] for speed in ("u1", "u2", "u3")}
    for speed, value in found.items():
        value = value.xreplace({sp.Symbol("torsion"): sp.S.One})
        assert vanishes(value), f"{name}: {speed}' differs by {value}"


def test_a_difference_would_be_seen():
    """A pivot a little further up, or the other principle, gives a nonzero difference."""
    made = gt.scenes.load("lagrange_cusp").assembly
    equations = from_action(made, "closed_in_coordinates")
    rate = in_frame(made.rates[OMEGA[0]])
    assert vanishes(rate - equations.rates["u1"])
    arm = sp.Symbol("a3")
    assert arm in rate.free_symbols
    assert not vanishes(rate.xreplace({arm: 1 + arm}) - equations.rates["u1"])
    free = gt.scenes.load("euler_top").assembly
    wrong = from_action(free, "naive")
    assert not all(vanishes(value) for _, value in differences(free, wrong))
