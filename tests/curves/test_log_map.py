"""Logarithm: how near to a conjugate point geodesics between two places are found."""

import numpy as np
import pytest

from geomtorsion.curves import log_map
from geomtorsion.errors import GeomtorsionError
from geomtorsion.geometry import levi_civita
from geomtorsion.spaces import load


@pytest.mark.parametrize(("short", "found"), [(1e-5, True), (5e-7, False)])
def test_how_near_to_a_conjugate_point_geodesics_are_found(short, found):
    """At the antipode of a sphere the end depends on one direction only; so near to it, no more."""
    start, end = [np.pi / 2, 0.0], [np.pi / 2, np.pi - short]
    call = {"parameters": {"R": 1}, "guess": [0.0, np.pi - 3 * short]}
    connection = levi_civita(load("s2").frame)
    if found:
        vector = log_map(connection, start, end, **call).vector
        assert np.abs(vector) == pytest.approx([0, np.pi - short], abs=1e-6)
    else:
        with pytest.raises(GeomtorsionError):
            log_map(connection, start, end, **call)
