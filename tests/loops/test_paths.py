"""Paths: open paths, and paths that close by a period."""

import numpy as np
import pytest

import geomtorsion.spaces as spaces
from geomtorsion.errors import LoopError
from geomtorsion.geometry import cartan, levi_civita
from geomtorsion.loops import AffineMap, Loop, develop, develop_path, develop_period, dispiration
from tests.rounding import ROUNDED

TURN = 2 * np.pi
ROUND = {"phi": TURN}


def test_polar_frame_misses_the_circumference():
    """The orthonormal polar frame: Cartan gives (0, 2 pi r), Levi-Civita closes."""
    frame = spaces.load("flat_polar").frame
    for radius in (1e-9, 0.7, 1e5):
        circle = [[radius, 0.3], [radius, 0.3 + TURN]]
        b = develop_period(cartan(frame), circle, ROUND)
        assert np.abs(b.burgers - [0, TURN * radius]).max() < 1e-13 * radius
        assert not b.turn.any()
        closed = develop_period(levi_civita(frame), circle, ROUND)
        assert np.abs(closed.burgers).max() < 1e-12 * radius
        assert np.abs(closed.turn).max() < 1e-13


@pytest.mark.parametrize("space", ["wedge_disclination", "wedge_disclination_periodic"])
@pytest.mark.parametrize("alpha", [0.8, 1.1])
def test_cone_is_the_same_in_every_chart_and_frame(space, alpha):
    """Multivalued legs, periodic legs and Cartesian coordinates give the same motion."""
    cone = levi_civita(spaces.load(space).frame)
    cartesian = develop(levi_civita(dispiration(alpha, 0)), Loop.circle([0, 0, 0], 2))
    for turns in (1, 2, -1):
        circle = [[2, 0, 0], [2, turns * TURN, 0]]
        found = develop_period(cone, circle, ROUND, parameters={"alpha": alpha})
        expected = cartesian.motion.inverse if turns < 0 else cartesian.motion
        expected = expected @ expected if turns == 2 else expected
        assert np.abs(found.increment - expected.increment).max() < 1e-12


def test_shape_of_the_path_does_not_matter_around_a_line():
    """Space is flat away from the axis, so that only the winding counts."""
    cone = levi_civita(spaces.load("wedge_disclination").frame)
    corners = [[2, 0, 0], [0.5, 1, 3], [4, 2, -1], [1, 5, 0], [2, TURN, 0]]
    crooked = develop_period(cone, corners, ROUND, parameters={"alpha": 0.7})
    straight = develop_period(cone, [corners[0], corners[-1]], ROUND, parameters={"alpha": 0.7})
    assert np.abs(crooked.increment - straight.increment).max() < 1e-11


def test_paths_compose_to_the_whole():
    """Two pieces joined are the path; the path forth and back is the identity."""
    bar = levi_civita(spaces.load("so3").frame)
    points = [[0.1, 1.0, 0.2], [0.4, 1.2, 0.0], [0.9, 0.7, 0.5]]
    whole = develop_path(bar, points)
    pieces = develop_path(bar, points[:2]) @ develop_path(bar, points[1:])
    assert np.abs(whole.increment - pieces.increment).max() < ROUNDED
    there_and_back = whole @ develop_path(bar, points[::-1])
    assert np.abs(there_and_back.increment).max() < ROUNDED
    assert np.abs((whole @ whole.inverse).increment).max() < ROUNDED


def test_paths_that_do_not_close_are_refused():
    """The error names the gap, or the unknown coordinate."""
    frame = cartan(spaces.load("flat_polar").frame)
    with pytest.raises(LoopError, match=r"misses its start \(1, 0\) by \(0, -0.283185\)"):
        develop_period(frame, [[1, 0], [1, 6]], ROUND)
    with pytest.raises(LoopError, match=r"misses its start .* by \(1, 0\)"):
        develop_period(frame, [[1, 0], [2, TURN]], ROUND)
    with pytest.raises(LoopError, match="periods: expected a coordinate, got 'psi'"):
        develop_period(frame, [[1, 0], [1, TURN]], {"psi": TURN})
    with pytest.raises(LoopError, match="expected the change of phi in one turn"):
        develop_period(frame, [[1, 0], [1, TURN]], {"phi": 0})
    with pytest.raises(LoopError, match="each different from the next"):
        develop_path(frame, [[1, 0]])


def test_motions_have_invariants_to_the_last_digit():
    """Angle, axis, centre and logarithm are right from tiny angles to half a turn."""
    axis = np.array([2.0, -1.0, 2.0]) / 3
    cross = np.array([[0, -2, -1], [2, 0, -2], [1, 2, 0]]) / 3
    for angle in (1e-200, 1e-9, 0.5, 3.1, np.pi - 1e-7):
        # A transported vector turns by +angle, the arriving frame by -angle.
        turn = -np.sin(angle) * cross + 2 * np.sin(angle / 2) ** 2 * cross @ cross
        shift = 0.25 * axis - turn @ np.array([1.0, 0.0, -1.0])
        found = AffineMap.of(turn, shift)
        assert abs(found.angle / angle - 1) < ROUNDED
        direction = found.axis
        assert direction is not None
        assert np.abs(direction - axis).max() < 1e-8
        assert abs(found.along_axis - 0.25) < 1e-8
        if 1e-6 < angle < 3.13:
            assert found.centre is not None
            assert np.abs(found.centre - [1, 0, -1]).max() < 1e-9
        if angle < 3.13:
            assert np.abs(found.frank / angle - cross).max() < 1e-12
    nothing = AffineMap.of(np.zeros((3, 3)), [3.0, 0.0, 4.0])
    assert (nothing.angle, nothing.axis, nothing.centre, nothing.along_axis) == (0, None, None, 5)
    assert not nothing.frank.any()


def test_motions_of_other_kinds_are_refused():
    """Refused: an axis outside three dimensions, an angle of another map, bad shapes."""
    plane = AffineMap.of(np.array([[0.0, 1.0], [-1.0, 0.0]]), [0.0, 0.0])
    with pytest.raises(ValueError, match="only in 3 dimensions, not in 2"):
        _ = plane.axis
    with pytest.raises(LoopError, match="not a rotation"):
        _ = plane.angle
    with pytest.raises(ValueError, match="square matrix"):
        AffineMap.of(np.zeros((2, 2)), [0.0, 0.0, 0.0])
    half = AffineMap.of(np.diag([-2.0, -2.0, 0.0]), [0.0, 0.0, 0.0])
    assert abs(half.angle - np.pi) < ROUNDED
    with pytest.raises(LoopError, match="half a turn"):
        _ = half.frank
