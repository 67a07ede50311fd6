"""Constrained connections: legs, one-forms, the torsion that decides, and refusals."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
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
        bool(gt.Integrability(None, {}))


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
    with pytest.raises(CoframeError, match="legs that a metric chose"):
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
