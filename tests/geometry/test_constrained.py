"""Constrained connections: legs, one-forms, the torsion that decides, and refusals."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest
import scipy.integrate
import sympy as sp

import geomtorsion as gt
from geomtorsion.curves import edges_of
from geomtorsion.errors import (
    CoframeError,
    ConstraintError,
    ExpressionError,
    GeomtorsionError,
    MetricError,
    ShapeError,
    StartError,
    TensorIndexError,
    UndecidedError,
)
from tests.rounding import ROUNDED

x, y, theta, phi = sp.symbols("x y theta phi", real=True)
m, I_z, J, R, a = sp.symbols("m I J R a", positive=True)
BLADE = "cos(theta)*dy - sin(theta)*dx"


def sleigh() -> gt.Connection:
    """Chaplygin's sleigh: centre of mass a distance a in front of the blade."""
    side, ahead = -m * a * sp.sin(theta), m * a * sp.cos(theta)
    metric = [[m, 0, side], [0, m, ahead], [side, ahead, I_z + m * a**2]]
    return gt.constrained(gt.Frame.from_metric([x, y, theta], metric), [BLADE])


def disc() -> gt.Connection:
    """An upright disc that rolls: phi turns it, theta steers it."""
    energy = gt.Frame.from_metric([x, y, theta, phi], sp.diag(m, m, J, I_z).tolist())
    forms = ["cos(theta)*dx + sin(theta)*dy - R*dphi", BLADE]
    return gt.constrained(energy, forms, parameters=[R])


def test_one_forms_of_any_length_and_angle_leave_the_metric_as_it_is():
    """The adapted frame has the metric that was given, whatever one-forms it is adapted to."""
    energy = gt.Frame.from_metric([x, y, theta, phi], sp.diag(1, 2, 3, m).tolist())
    forms = ["3*dx + dy - 2*dtheta", "dx + (2 + x**2)*dtheta + dphi"]
    for constraints in (forms, forms[::-1], forms[:1]):
        adapted = gt.constrained(energy, constraints).frame
        expected = gt.Tensor(adapted, "dd", {(k, k): value for k, value in enumerate((1, 2, 3, m))})
        assert (adapted.metric - expected).is_zero is True


def test_sleigh_follows_the_equations_of_chaplygin():
    """u' = a w^2, w' = -m a u w / (I + m a^2): Chaplygin 1911; the forbidden velocity is zero."""
    values = {"m": 2.0, "I": 0.5, "a": 0.3}
    forward, turn = 1.0, 2.0
    velocity = [np.cos(0.2), np.sin(0.2), turn]
    problem = gt.autoparallel(sleigh(), [0, 0, 0.2], velocity, parameters=values)
    curve = gt.solve(problem, 5.0, 1e-11)
    rates = {"u": "a*w**2", "w": "-m*a*u*w/(I + m*a**2)"}
    place = {"x": "u*cos(th)", "y": "u*sin(th)", "th": "w"}
    begin = {"u": forward, "w": turn, "x": 0, "y": 0, "th": 0.2}
    expected = gt.solve(gt.ODE.of(rates | place, begin, parameters=values), 5.0, 1e-11)
    end = curve.at(5.0).coordinates
    assert np.abs(end - [expected[name][-1] for name in ("x", "y", "th")]).max() < 1e-12
    assert np.abs(curve.frame_velocity[:, 2]).max() < ROUNDED


def test_disc_rolls_on_a_circle():
    """Constant rates of rolling and steering: a circle of radius R phi' / theta'."""
    values = {"m": 1.0, "J": 0.25, "I": 0.5, "R": 0.8}
    problem = gt.autoparallel(disc(), [0, 0, 0, 0], [1.6, 0, 0.5, 2.0], parameters=values)
    curve = gt.solve(problem, 6.0, 1e-11)
    away = np.hypot(curve.coordinates[:, 0], curve.coordinates[:, 1] - 3.2) - 3.2
    assert np.abs(away).max() < 1e-12


def test_coefficients_within_each_side_equal_levi_civita():
    """Permitted legs turn against each other as in Levi-Civita's connection; so do forbidden ones.

    Legs of so3 turn against each other in each plane, so that no case is empty.
    """
    frame = gt.spaces.load("so3").frame
    four = gt.Frame(
        [*frame.coordinates, x],
        [[*row, 0] for row in frame.coframe.to_sympy().tolist()] + [[0, 0, 0, 1]],
    )
    for space, allowed in ((frame, (0,)), (frame, (1, 2)), (four, (0, 3)), (four, (2,))):
        free = gt.levi_civita(space).spin_connection
        bound = gt.constrained(space, allowed).spin_connection
        within = 0
        for a, i, j in np.ndindex(*[space.dimension] * 3):
            same_side = (i in allowed) == (j in allowed)
            expected = free[a, i, j] if same_side else 0
            assert sp.simplify(bound[a, i, j] - expected) == 0, (allowed, a, i, j)
            within += same_side and i not in allowed and free[a, i, j] != 0
        assert within or allowed == (1, 2) or allowed == (0, 3)


def test_torsion_that_prevents_integrability():
    """The disc: one component along the blade's leg, R sqrt(m / (J (I + m R^2)))."""
    verdict = disc().integrable
    assert verdict.holds is False
    assert list(verdict.obstructions) == [(0, 1, 3)]
    expected = R * sp.sqrt(m / (J * (I_z + m * R**2)))
    assert sp.simplify(verdict.obstructions[0, 1, 3] - expected) == 0
    assert "T_12^4" in repr(verdict)


def test_holonomic_constraints_are_integrable():
    """A pendulum of fixed length: d(x^2 + y^2) = 0 has no obstruction."""
    plane = gt.Frame([x, y], [[1, 0], [0, 1]], domain=[x > 0])
    assert bool(gt.constrained(plane, ["x*dx + y*dy"]).integrable)


def test_integrability_that_cannot_be_decided_raises():
    """A verdict without an answer is neither true nor false."""
    with pytest.raises(UndecidedError, match="obstructions"):
        bool(gt.geometry.Integrability(None, {}))


def test_unconstrained_connections_are_integrable():
    """Every leg is permitted: nothing can be obstructed."""
    assert bool(gt.cartan(gt.spaces.load("so3").frame).integrable)


def test_connection_is_metric_and_all_legs_permitted_is_levi_civita():
    """Metric in every case; without a forbidden leg nothing changes."""
    assert sleigh().metric_compatible is True
    frame = gt.spaces.load("s2").frame
    everything = gt.constrained(frame, (0, 1))
    assert (everything.coefficients - gt.levi_civita(frame).coefficients).is_zero


def test_the_metric_stays_the_kinetic_metric():
    """The adapted frame has the metric it was made from."""
    change = sp.Matrix(disc().frame.metric.to_sympy()) - sp.diag(m, m, J, I_z)
    assert sp.simplify(change) == sp.zeros(4)


def test_forms_text_and_components_agree():
    """A text, a list of components and a form give the same legs."""
    plane = gt.Frame([x, y, theta], [[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    row = [-sp.sin(theta), sp.cos(theta), 0]
    form = gt.Form(plane, 1, {0: row[0], 1: row[1]})
    legs = [gt.constrained(plane, [given]).frame.coframe.to_sympy() for given in (BLADE, row, form)]
    assert legs[0] == legs[1] == legs[2]


def test_copies_substitutions_and_coordinates_keep_the_constraints():
    """Copies, substitutions and changes of coordinates are constrained."""
    connection = sleigh()
    u, v = sp.symbols("u v", real=True)
    moved = connection.in_coordinates([u, v, theta], [u + v, u - v, theta])
    for other in (
        copy.deepcopy(connection),
        pickle.loads(pickle.dumps(connection)),
        connection.subs({m: 2}),
        moved,
    ):
        assert other.allowed == (0, 1)
        assert not other.integrable


def test_potential_pulls_along_permitted_legs_only():
    """A bead on a wire in a field: the force across the wire does nothing."""
    plane = gt.Frame([x, y], [[1, 0], [0, 1]])
    wire = gt.constrained(plane, ["dy - dx"])
    fall = gt.autoparallel(wire, [0, 0], [0, 0], potential="y")
    curve = gt.solve(fall, 2.0, 1e-11)
    # Half of the acceleration acts along the diagonal, in x and in y: -1/2 each.
    assert np.abs(curve.at(2.0).coordinates - [-1, -1]).max() < 1e-12
    pushed = gt.solve(gt.autoparallel(wire, [0, 0], [0, 0], force=["sqrt(2)", 5]), 2.0, 1e-11)
    assert np.abs(pushed.at(2.0).coordinates - [2, 2]).max() < 1e-12


def test_force_of_a_slow_motion():
    """A force is not scaled with the speed: x'' = -x/4 from a small velocity."""
    line = gt.levi_civita(gt.Frame([x, y], [[1, 0], [0, 1]]))
    problem = gt.autoparallel(line, [0, 0], [0.01, 0], potential=x**2 / 8)
    curve = gt.solve(problem, 3.0, 1e-11)
    assert abs(curve.at(3.0).coordinates[0] - 0.02 * np.sin(1.5)) < 1e-12
    assert gt.prove(curve).holds


ENERGY = gt.Frame.from_metric([x, y, theta], sp.diag(m, m, I_z).tolist())
TURNED = gt.Frame(
    [x, y], [[1, 0], [0, 1]], signature=[[1, sp.Rational(1, 2)], [sp.Rational(1, 2), 1]]
)


@pytest.mark.parametrize(
    ("frame", "allowed", "error", "words"),
    [
        (ENERGY, [], ConstraintError, "expected a list, got \\[\\]"),
        (ENERGY, BLADE, ConstraintError, "allowed: expected a list"),
        (ENERGY, 3, ConstraintError, "allowed: expected a list"),
        (ENERGY, [3], TensorIndexError, "legs from 0 to 2, got 3"),
        (ENERGY, [-1], TensorIndexError, "legs from 0 to 2, got -1"),
        (ENERGY, [0, 0], TensorIndexError, "each leg once"),
        (ENERGY, [0, "dx"], ConstraintError, "constraint 1: expected a list, got 0"),
        (ENERGY, ["dx", "2*dx"], ConstraintError, "constraint 2: expected independent"),
        (ENERGY, ["dx - dx"], ConstraintError, "does not vanish, got zero"),
        (ENERGY, ["dx**2"], ConstraintError, "functions times dx, dy, dtheta"),
        (ENERGY, ["dx*dy"], ConstraintError, "functions times dx, dy, dtheta"),
        (ENERGY, ["sin(dx)"], ConstraintError, "functions times dx, dy, dtheta"),
        (ENERGY, ["dx + y"], ConstraintError, "part free of velocities"),
        (ENERGY, ["dx", "dy", "dtheta"], ConstraintError, "at most 2 constraints"),
        (
            ENERGY,
            [[1, 2]],
            ConstraintError,
            "components: expected one for each of 3",
        ),
        (ENERGY, ["dq"], ExpressionError, "dq"),
        (ENERGY, ["__import__('os')"], ExpressionError, "constraint 1"),
        (TURNED, [0], MetricError, "orthogonal"),
        (gt.spaces.load("schwarzschild").frame, [0, 1], MetricError, "positive on the permitted"),
        (gt.spaces.load("schwarzschild").frame, ["dr"], MetricError, "positive on the permitted"),
        (3, [0], GeomtorsionError, "expected a Frame"),
    ],
)
def test_anything_but_a_constraint_is_refused(frame, allowed, error, words):
    """Each message names the expected value."""
    with pytest.raises(error, match=words):
        gt.constrained(frame, allowed)


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ({"velocity": [1, 0, 1]}, StartError, "a velocity that the constraints permit"),
        ({"velocity": [0, 0, 1], "force": [1, 2]}, ShapeError, "one for each of 3 legs"),
        ({"velocity": [0, 0, 1], "potential": "z"}, ExpressionError, "z"),
        ({"velocity": [0, 0, 1], "potential": "m*("}, ExpressionError, "potential"),
    ],
)
def test_bad_motions_are_refused(arguments, error, words):
    """Velocities across the blade, and forces that cannot be read."""
    values = {"m": 2, "I": 1, "a": 1}
    with pytest.raises(error, match=words):
        gt.autoparallel(sleigh(), [0, 0, 0.5], parameters=values, **arguments)


def test_legs_of_a_metric_do_not_change_coordinates():
    """A metric would choose other legs, so that numbers of legs would mean others."""
    bound = gt.constrained(ENERGY, (0, 2))
    u, v = sp.symbols("u v", real=True)
    with pytest.raises(CoframeError, match="legs derived from a metric"):
        bound.in_coordinates([u, v, theta], [u + v, u - v, theta])


def test_constraints_in_a_tetrad_file(tmp_path):
    """The key `constraints` of a file, and a value of the wrong kind."""
    file = tmp_path / "skate.toml"
    text = 'coordinates = ["x", "y", "theta"]\nmetric = [[1, 0, 0], [0, 1, 0], [0, 0, 2]]\n'
    file.write_text(f'{text}constraints = ["{BLADE}"]\n')
    space = gt.read(file)
    assert space.connection is not None
    assert space.connection.allowed == (0, 1)
    assert space.frame is space.connection.frame
    pair = gt.spaces.solve_pair(space, t=2.0)
    assert pair.straight.frame_velocity[0, 2] == 0
    file.write_text(f"{text}constraints = 3\n")
    with pytest.raises(GeomtorsionError, match="expected a list of texts"):
        gt.read(file)


def test_a_metric_whose_positivity_depends_on_parameters():
    """The inequality to declare is named; declared, the connection exists."""
    x, y, m, k = sp.symbols("x y m k", positive=True)
    metric = [[m, k], [k, m]]
    with pytest.raises(MetricError, match=r"domain=\[\.\.\., '-2\*k \+ 2\*m > 0'\]"):
        gt.constrained(gt.Frame.from_metric([x, y], metric, domain="k > m"), ["dx + dy"])
    # Without a domain the region where the metric is positive is assumed.
    assumed = gt.Frame.from_metric([x, y], metric)
    assert str(assumed.region) == "k < m"
    assert gt.constrained(assumed, ["dx + dy"]).allowed == (0,)
    declared = gt.Frame.from_metric([x, y], metric, domain="-2*k + 2*m > 0")
    assert gt.constrained(declared, ["dx + dy"]).allowed == (0,)


def end_with_multipliers(forms, start, velocity, t, masses=None):
    """Coordinates at t of a body under forms a_r(q) q' = 0, by d'Alembert with multipliers (scipy).

    masses: a constant kinetic metric; the unit matrix if there is none.
    """
    q = sp.symbols("q:4", real=True)
    rate = sp.symbols("v:4", real=True)
    rows = sp.Matrix(forms(*q))
    slope = sum((rows.diff(one) * speed for one, speed in zip(q, rate, strict=True)), 0 * rows)
    numbers = sp.lambdify((*q, *rate), [rows, slope * sp.Matrix(rate)], modules="numpy")
    inverse = np.linalg.inv(np.eye(4) if masses is None else masses)

    def rates(_, state):
        a, b = (np.array(part, dtype=float) for part in numbers(*state))
        pull = a.T @ np.linalg.solve(a @ inverse @ a.T, -b)
        return np.concatenate([state[4:], (inverse @ pull).ravel()])

    run = scipy.integrate.solve_ivp(
        rates, (0, t), [*start, *velocity], method="DOP853", rtol=1e-12, atol=1e-12
    )
    return run.y[:4, -1]


def two_wheels(x, y, a, b):
    """Two rows of one-forms with a hidden square in the metric on the permitted velocities."""
    return [
        [-sp.sin(a + b), sp.cos(a + b), -sp.cos(b), 0],
        [-sp.sin(a), sp.cos(a), 1, 0],
    ]


@pytest.mark.parametrize(
    ("start", "velocity", "t"),
    [
        ([0, 0, 0, 0], [1, 0, 0, 1], 6.0),
        ([0, 0, 0, 0], [2, 0, 0, -1.5], 8.0),
        ([0.3, -0.2, np.pi / 2, np.pi / 2], [0.4, 0, 0.4, 0.9], 5.0),
    ],
)
def test_motions_cross_points_that_only_the_notation_had(start, velocity, t):
    """sqrt((cos(b)**2 + 1) p**2) is |p| sqrt(cos(b)**2 + 1): nothing is singular where p = 0."""
    names = ("x", "y", "a", "b")
    frame = gt.Frame(" ".join(names), np.eye(4, dtype=int).tolist())
    forms = two_wheels(*(sp.Symbol(name, real=True) for name in names))
    wheels = gt.constrained(frame, forms)
    assert edges_of(wheels.frame) == ()
    rows = np.array(sp.Matrix(two_wheels(*start)), dtype=float)
    assert np.abs(rows @ velocity).max() < 1e-12
    end = gt.solve(gt.autoparallel(wheels, start, velocity), t, 1e-10).coordinates[-1]
    assert np.abs(end - end_with_multipliers(two_wheels, start, velocity, t)).max() < 1e-8


def test_the_motion_of_two_wheels_to_six():
    """The end to eight digits, of an integration with multipliers by other code."""
    frame = gt.Frame("x y a b", np.eye(4, dtype=int).tolist())
    forms = ["-sin(a+b)*dx + cos(a+b)*dy - cos(b)*da", "-sin(a)*dx + cos(a)*dy + da"]
    motion = gt.autoparallel(gt.constrained(frame, forms), [0, 0, 0, 0], [1, 0, 0, 1])
    end = gt.solve(motion, 6.0, 1e-10).coordinates[-1]
    assert np.abs(end - [0.92911619, 1.70560703, -0.02011445, 6]).max() < 1e-8


def test_a_skate_on_a_sphere():
    """dtheta = sin(theta) dphi is a rhumb line at 45 degrees: phi = log(tan(theta/2)) + constant,
    run with the constant speed sqrt(2) R theta'."""
    skate = gt.constrained(gt.spaces.load("s2").frame, ["dtheta - sin(theta)*dphi"])
    assert skate.frame.branches == ()
    start = [1.0, 0.2]
    motion = gt.autoparallel(skate, start, [0.5, 0.5 / np.sin(1.0)], parameters={"R": 2.0})
    theta_end, phi_end = gt.solve(motion, 2.0, 1e-11).coordinates[-1]
    assert theta_end == pytest.approx(2.0, abs=1e-10)
    turned = np.log(np.tan(1.0)) - np.log(np.tan(0.5))
    assert phi_end - 0.2 == pytest.approx(turned, abs=1e-10)


@pytest.mark.parametrize("domain", [None, "theta > 0, theta < pi"])
def test_the_body_of_suslov(domain):
    """A body with omega_3 = 0 from its kinetic metric in Euler's angles (Suslov 1902):
    I_1 o_1' = -o_2 (I_13 o_1 + I_23 o_2), I_2 o_2' = o_1 (I_13 o_1 + I_23 o_2)."""
    psi = sp.Symbol("psi", real=True)
    rates = sp.Matrix(
        [
            [sp.sin(theta) * sp.sin(psi), sp.cos(psi), 0],
            [sp.sin(theta) * sp.cos(psi), -sp.sin(psi), 0],
            [sp.cos(theta), 0, 1],
        ]
    )
    half, third = sp.Rational(1, 2), sp.Rational(1, 3)
    moments = sp.Matrix([[2, 0, half], [0, 3, third], [half, third, 4]])
    metric = (rates.T * moments * rates).applyfunc(sp.expand).tolist()
    body = gt.Frame.from_metric([phi, theta, psi], metric, domain=domain)
    suslov = gt.constrained(body, ["cos(theta)*dphi + dpsi"])
    omega = sp.lambdify((phi, theta, psi), rates)

    def slopes(_, state):
        turn = np.linalg.solve(np.array(omega(*state[:3]), dtype=float), [*state[3:], 0])
        pull = state[3] / 2 + state[4] / 3
        return [*turn, -state[4] * pull / 2, state[3] * pull / 3]

    start, spin = [0.3, 1.1, 0.4], [0.7, 0.2]
    run = scipy.integrate.solve_ivp(
        slopes, (0, 3), [*start, *spin], method="DOP853", rtol=1e-12, atol=1e-12
    )
    velocity = slopes(0, [*start, *spin])[:3]
    end = gt.solve(gt.autoparallel(suslov, start, velocity), 3.0, 1e-10).coordinates[-1]
    assert np.abs(end - run.y[:3, -1]).max() < 1e-9
