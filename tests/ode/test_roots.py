"""Roots: which valleys between two samples are searched."""

import numpy as np
import pytest

from geomtorsion.ode.roots import crossings
from tests.rounding import ROUNDED


@pytest.mark.parametrize(("reach", "seen"), [(0.25, True), (0.4, False)])
def test_how_near_to_zero_a_valley_is_looked_into(reach, seen):
    """The lowest point of the parabola through three samples is this part of the middle value."""
    times = np.array([-1.0, 0.0, 1.0])
    bend = 8 * (1 - reach)

    def function(t):
        """A parabola, 1 at -1 and at 0, with a hole at its lowest point that no sample shows."""
        return 1 + bend / 2 * (t + t**2) - np.exp(-(((t + 0.5) / 0.1) ** 2))

    assert len(crossings(function, times, function(times))) == (2 if seen else 0)
    # Backwards as well: the crossings are as far from the middle of the hole on both sides.
    back = crossings(function, times[::-1], function(times[::-1]))
    assert len(back) == (2 if seen else 0)
    assert np.all(np.diff(back) < 0)
    assert back.sum() == pytest.approx(-1.0 if seen else 0.0, rel=ROUNDED)


@pytest.mark.parametrize(("direction", "turns"), [(0, [1, 2, 3]), (1, [2]), (-1, [1, 3])])
@pytest.mark.parametrize("backwards", [False, True])
def test_crossings_in_one_direction(direction, turns, backwards):
    """The sine falls through zero at pi and 3 pi and rises at 2 pi; backwards it is reversed."""
    times = np.linspace(0.5, 10, 40)
    if backwards:
        times, direction, turns = times[::-1], -direction, turns[::-1]
    found = crossings(np.sin, times, np.sin(times), direction)
    assert found == pytest.approx(np.pi * np.array(turns), rel=ROUNDED)
