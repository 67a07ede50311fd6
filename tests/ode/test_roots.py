"""Roots: which valleys between two samples are searched."""

import numpy as np
import pytest

from geomtorsion.ode.roots import crossings


@pytest.mark.parametrize(("reach", "seen"), [(0.25, True), (0.4, False)])
def test_how_near_to_zero_a_valley_is_looked_into(reach, seen):
    """The lowest point of the parabola through three samples is this part of the middle value."""
    times = np.array([-1.0, 0.0, 1.0])
    bend = 8 * (1 - reach)

    def function(t):
        """A parabola, 1 at -1 and at 0, with a hole at its lowest point that no sample shows."""
        return 1 + bend / 2 * (t + t**2) - np.exp(-(((t + 0.5) / 0.1) ** 2))

    assert len(crossings(function, times, function(times))) == (2 if seen else 0)
