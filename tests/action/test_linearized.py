"""Linearized: steady motions agree with derivatives of the rates; a bicycle with its benchmark."""

# Complex arrays, and names that are texts or symbols.
# pyright: reportAttributeAccessIssue=false, reportArgumentType=false

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import (
    ConstraintError,
    KineticMatrixError,
    LagrangianError,
    LimitError,
    MissingValueError,
    StartError,
    UnknownNameError,
)
from tests.action.test_constraints import SLEDGE, SLEIGH, disc_equations
from tests.action.test_equations import SPIN, U
from tests.rounding import ROUNDED

G, M, R, W = sp.symbols("g m r W", positive=True)
Q, K = sp.symbols("q k", real=True)
LINE = gt.Frame([Q], [[1]])


def slopes(equations, found, at):
    """The matrix by differentiation of the written rates."""
    names = {
        s.name: s
        for s in (*equations.frame.coordinates, *equations.hamel.bundle.symbols.velocities)
    }
    place = {names.get(name, sp.Symbol(name)): value for name, value in at.items()}
    states = [names[name] for name in found.states]
    rows = [[equations.rates[s.name].diff(x).subs(place) for x in states] for s in states]
    return sp.Matrix(rows)


def test_critical_speed_of_a_disc():
    """A rolling disc stays upright for W^2 > g / (3 r): W > 1/sqrt(3) in unit numbers."""
    equations, _, _ = disc_equations()
    found = equations.linearized(at={"q2": 0, "u2": W})
    assert found.states == ("q2", "u1", "u2", "u3")
    assert sp.expand(found.polynomial[2] - (12 * W**2 / 5 - 4 * G / (5 * R))) == 0
    assert found.polynomial[0] == 1
    assert (found.polynomial[1], *found.polynomial[3:]) == (0, 0, 0)
    unit = found.at({"g": 1, "r": 1})
    slow, fast = (unit.at({"W": 1 / np.sqrt(3) + gap}).eigenvalues for gap in (-1e-6, 1e-6))
    assert slow.real.max() > 1e-3
    assert np.abs(fast.real).max() == 0
    assert unit.at({"W": sp.sqrt(3) / 3}).polynomial == (1, 0, 0, 0, 0)


def steady_cases():
    """Equations, each with a steady motion."""
    yield gt.equations_of_motion(gt.spaces.load("so3").frame, SPIN), {"u2": W}
    yield (
        gt.equations_of_motion(gt.spaces.load("so3").frame, SPIN, principle="closed_in_image"),
        {"u1": 1, "u2": W, "u3": 3},
    )
    hoop = "u1**2/2 + W**2*sin(q)**2/2 + k*cos(q)"
    bead = gt.equations_of_motion(LINE, hoop, ["-c*u1"], parameters=["W", "k", "c"])
    yield bead, {"q": 0}
    yield bead, {"q": sp.pi}
    yield gt.equations_of_motion(SLEDGE, SLEIGH, constraints=[U[1]]), {"u1": W, "theta": 0}
    disc, _, lean = disc_equations()
    turning = 2
    spin = turning * sp.tan(lean) / 6 - 4 * G * sp.sin(lean) / (6 * R * turning)
    angle = sp.Rational(1, 3)
    yield disc, {"q2": angle, "u2": spin.subs(lean, angle), "u3": turning, "u1": 0}
    kepler = gt.spaces.load("flat_polar").frame
    yield (
        gt.equations_of_motion(kepler, "(u1**2 + u2**2)/2 + 1/r"),
        {"r": 4, "u2": sp.Rational(1, 2)},
    )
    yield gt.equations_of_motion(LINE, "u1**2*(1 + q**2)/2 - q**2*exp(q)"), {"q": 0}


@pytest.mark.parametrize("case", range(8))
def test_slopes_of_the_rates(case):
    """Expansion at the state and differentiation of the written rates give the same matrix."""
    equations, at = list(steady_cases())[case]
    found = equations.linearized(at=at)
    zero = dict.fromkeys((u.name for u in equations.velocities), sp.S.Zero)
    expected = slopes(equations, found, zero | at)
    expected = expected.subs({sp.Symbol(x.name): x for x in found.matrix.free_symbols})
    gap = (found.matrix - expected).applyfunc(sp.simplify)
    assert gap == sp.zeros(*gap.shape)


def test_a_kepler_orbit_turns_once_per_turn():
    """A circular orbit around 1/r is stable, with the frequency of the orbit."""
    found = gt.linearized(
        gt.spaces.load("flat_polar").frame, "(u1**2 + u2**2)/2 + 1/r", at={"r": 4, "u2": "1/2"}
    )
    assert found.eigenvalues == pytest.approx([-0.125j, 0, 0.125j], abs=ROUNDED)


def test_eigenvalues_keep_their_digits():
    """A triple zero stays zero, where eigenvalues in doubles would be about 1e-5."""
    chain = "u1**2/2 + u2**2/2"
    plane = gt.Frame(sp.symbols("x y"), sp.eye(2))
    found = gt.linearized(plane, chain, ["y", "0"], at={"y": 0})
    assert found.states == ("y", "u1", "u2")
    assert (found.eigenvalues == 0).all()


BICYCLE = {
    "wheelbase": 1.02, "trail": 0.08, "tilt": sp.pi / 10, "g": 9.81, "rear": 0.3, "front": 0.35,
}  # fmt: skip
# [Meijaard2007], table 2: M u'' + v C1 u' + (g K0 + v^2 K2) u = 0 for (lean, steer).
MASS = np.array([[80.81722, 2.31941332208709], [2.31941332208709, 0.29784188199686]])
DAMPING = np.array([[0, 33.86641391492494], [-0.85035641456978, 1.68540397397560]])
WEIGHT = np.array([[-80.95, -2.59951685249872], [-2.59951685249872, -0.80329488458618]])
SPRING = np.array([[0, 76.59734589573222], [0, 2.65431523794604]])


def turn(axis, angle):
    """The matrix of a rotation about an axis."""
    c, s = sp.cos(angle), sp.sin(angle)
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    matrix = sp.eye(3)
    matrix[i, i] = matrix[j, j] = c
    matrix[j, i], matrix[i, j] = s, -s
    return matrix


def bicycle():
    """The Whipple bicycle: x forwards, z downwards; four bodies, five constraints of rolling."""
    n = {name: sp.nsimplify(value) for name, value in BICYCLE.items()}
    q = sp.symbols("x y yaw lean pitch steer spin front", real=True)
    u = sp.symbols("u1:9")
    right, down = sp.Matrix([0, 1, 0]), sp.Matrix([0, 0, 1])
    leaning = turn("z", q[2]) * turn("x", q[3])
    rear = leaning * turn("y", q[4])
    head = turn("y", n["tilt"])
    fork = rear * head * turn("z", q[5]) * head.T
    omega = u[2] * down + u[3] * turn("z", q[2]) * sp.Matrix([1, 0, 0]) + u[4] * leaning * right
    omega_fork = omega + u[5] * rear * head * down
    omegas = [omega + u[6] * leaning * right, omega, omega_fork, omega_fork + u[7] * fork * right]
    ground = sp.Matrix([q[0], q[1], 0])
    hub = ground - leaning * down * n["rear"]
    axis = hub + rear * sp.Matrix([n["wheelbase"] + n["trail"], 0, n["rear"]])
    R10 = sp.Rational(1, 10)
    front = axis + fork * sp.Matrix([-n["trail"], 0, -n["front"]])
    frame_centre = hub + rear * sp.Matrix([3 * R10, 0, n["rear"] - 9 * R10])
    handle = axis + fork * sp.Matrix([9 * R10 - n["wheelbase"] - n["trail"], 0, -7 * R10])
    side = fork * right
    lowest = (down - side[2] * side) / sp.sqrt(1 - side[2] ** 2)
    places = [hub, frame_centre, handle, front]
    masses = (2, 85, 4, 3)
    speed = [place.jacobian(q) * sp.Matrix(u) for place in places]
    energy = sum(m * v.dot(v) / 2 for m, v in zip(masses, speed, strict=True))
    energy += n["g"] * sum(m * place[2] for m, place in zip(masses, places, strict=True))
    tensors = [[9.2, 0, 2.4, 11, 2.8], [0.05892, 0, -0.00756, 0.06, 0.00708]]
    for w, body, (xx, _, xz, yy, zz) in zip(omegas[1:3], (rear, fork), tensors, strict=True):
        xx, xz, yy, zz = map(sp.nsimplify, (xx, xz, yy, zz))
        local = body.T * w
        energy += (local.T * sp.Matrix([[xx, 0, xz], [0, yy, 0], [xz, 0, zz]]) * local)[0] / 2
    wheels = ((omegas[0], leaning * right, 0.0603, 0.12), (omegas[3], side, 0.1405, 0.28))
    for w, normal, across, along in wheels:
        across, along = map(sp.nsimplify, (across, along))
        energy += (across * w.dot(w) + (along - across) * w.dot(normal) ** 2) / 2
    behind = speed[0] + omegas[0].cross(ground - hub)
    ahead = speed[3] + omegas[3].cross(n["front"] * lowest)
    return gt.Frame(q, sp.eye(8)), energy, [behind[0], behind[1], *ahead]


@pytest.fixture(scope="module")
def ridden():
    """The bicycle that runs straight on, with its speed v as a parameter."""
    frame, energy, ties = bicycle()
    upright = dict.fromkeys(("yaw", "lean", "pitch", "steer"), 0)
    at = upright | {"u7": -sp.Symbol("v") / sp.Rational(3, 10)}
    return gt.linearized(frame, energy, constraints=ties, at=at, velocities=["u4", "u6", "u7"])


@pytest.mark.parametrize("speed", [0.5, 3, 5, 8])
def test_bicycle_benchmark(ridden, speed):
    """Four eigenvalues agree with the paper; yaw, pitch and forward speed give zeros."""
    pulled = np.linalg.solve(MASS, 9.81 * WEIGHT + speed**2 * SPRING)
    held = np.linalg.solve(MASS, speed * DAMPING)
    published = np.linalg.eigvals(np.block([[np.zeros((2, 2)), np.eye(2)], [-pulled, -held]]))
    found = ridden.at({"v": speed}).eigenvalues
    assert (found == 0).sum() == 3
    assert np.sort_complex(found[found != 0]) == pytest.approx(
        np.sort_complex(published), abs=1e-10
    )


def test_critical_speeds_of_the_bicycle(ridden):
    """Weave becomes stable at 4.29238253634111 m/s, capsize unstable at 6.02426201538837 m/s."""
    weave = ridden.at({"v": 4.29238253634111}).eigenvalues
    assert weave[np.abs(weave.imag) > 1].real == pytest.approx([0, 0], abs=1e-12)
    capsize = ridden.at({"v": 6.02426201538837}).eigenvalues
    assert np.sort(np.abs(capsize))[3] < 1e-12


def test_the_bicycle_cannot_be_written_out_and_names_the_remedy():
    """The error for the full equations names the function that expands them."""
    frame, energy, ties = bicycle()
    numbers = [tie.subs(sp.sqrt(5), sp.Symbol("s", positive=True)) for tie in ties]
    with pytest.raises(LimitError, match=r"gt.linearized\(..., at="):
        gt.equations_of_motion(frame, energy, constraints=numbers)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: gt.linearized(LINE, "u1**2/2 - q", at={"q": 0}), StartError, "got u1' = -1 at"),
        (
            lambda: gt.linearized(LINE, "u1**2/2 - q**2", at={"q": 0, "u1": 1}),
            StartError,
            "got q, which change",
        ),
        (lambda: gt.linearized(LINE, "u1**2/2 - q*t", at={"q": 0}), StartError, "explicit time t"),
        (
            lambda: gt.linearized(LINE, "u1**2/2 - q**2", at={}),
            MissingValueError,
            "at: expected a value for q",
        ),
        (
            lambda: gt.linearized(LINE, "u1**2/2 - q**2", at={"q": 0, "p": 1}),
            UnknownNameError,
            "got 'p'",
        ),
        (
            lambda: gt.linearized(LINE, "u1**4 - q**2", at={"q": 0}),
            KineticMatrixError,
            "determinant vanishes",
        ),
        (
            lambda: gt.linearized(LINE, "u1**2/2 - sqrt(q)", at={"q": 0}),
            LagrangianError,
            "smooth at this state, got sqrt",
        ),
        (
            lambda: gt.linearized(SLEDGE, SLEIGH, constraints=["u2**2"], at={}),
            ConstraintError,
            "linear in the velocities, got u2",
        ),
        (
            lambda: gt.linearized(SLEDGE, SLEIGH, constraints=["u2", "2*u2"], at={"theta": 0}),
            ConstraintError,
            r"constraints\[1\]: expected an independent constraint",
        ),
        (
            lambda: gt.linearized(SLEDGE, SLEIGH, constraints=["u2 - u1"], at={"u1": 1, "u2": 2}),
            StartError,
            r"expected u\d = .*, as the constraints require",
        ),
        (
            lambda: gt.linearized(
                SLEDGE, SLEIGH, constraints=["u2"], velocities=["u1"], at={"theta": 0}
            ),
            ConstraintError,
            "velocities: expected 2 of u1, u2, u3, got u1",
        ),
        (
            lambda: (
                gt.linearized(LINE, "u1**2/2 - k*q**2", at={"q": 0}, parameters=["k"]).eigenvalues
            ),
            MissingValueError,
            "eigenvalues: expected a value for k",
        ),
        (
            lambda: gt.linearized(LINE, "u1**2/2 - q**2", at={"q": 0}).at({"k": 1}),
            UnknownNameError,
            "expected a parameter, got 'k'. There are none",
        ),
    ],
)
def test_refusals(call, error, words):
    """A state or system without a linearisation is refused with the reason."""
    with pytest.raises(error, match=words):
        call()
