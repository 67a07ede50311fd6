"""Results: lines of families that add up to b, lattice units, significance."""

import numpy as np
import pytest

from geomtorsion.errors import OrientationError
from geomtorsion.materials.maps import Circuit, OrientationMap
from tests.materials.maps.synthetic import NICKEL, noisy_wall


def wall(sigma=0.0):
    angles = np.zeros((21, 20, 3))
    angles[:, 10:, 0] = 2.0
    crystal = OrientationMap.from_euler(angles, 0.1, NICKEL, sigma=sigma)
    return crystal.burgers(Circuit.rectangle((0, 5), 20, 10))


def test_lines_add_up():
    """A 2 degree wall of 2 um has 2 um theta / a lines of [100], or twice as many of <110>/2."""
    b = wall()
    expected = 2e4 * 2 * np.sin(np.radians(1)) / 3.52
    (whole,) = b.lines((1, 0, 0))
    # b is turned by a degree from [100], which needs only a few lines of [010].
    assert whole.total == pytest.approx(expected, rel=0.03)
    (half,) = b.lines((0.5, 0.5, 0))
    assert half.numbers @ half.vectors == pytest.approx(b.vector * 1e4, rel=1e-9)
    assert half.total == pytest.approx(2 * expected, rel=0.03)
    assert b.indices == pytest.approx(b.vector * 1e4 / 3.52)
    # With both families the shorter sum is chosen: one [100] is shorter than two <110>/2.
    both = b.lines((1, 0, 0), (0.5, 0.5, 0))
    assert both[0].total == pytest.approx(whole.total, rel=0.05)


def test_families_that_do_not_span():
    """An orthorhombic [100] cannot make up a vector in another direction."""
    from geomtorsion.materials.maps import Phase

    angles = np.zeros((6, 6, 3))
    angles[:, 3:, 1] = 2.0
    olivine = Phase("olivine", "mmm", (4.76, 10.2, 5.98))
    b = OrientationMap.from_euler(angles, 0.1, olivine, sigma=0).burgers(Circuit.square((0, 0), 5))
    with pytest.raises(OrientationError, match="do not span.*Give another family"):
        b.lines((1, 0, 0))
    with pytest.raises(OrientationError, match="families: expected at least one Burgers vector"):
        b.lines()


def test_significance():
    """Noise has a significance near sqrt(3), a wall in it far more, a wall without it infinity."""
    noise = OrientationMap.from_euler(noisy_wall(0.0, (60, 60), 0.3, 1), 0.1, NICKEL)
    found = noise.burgers_map(6)
    assert np.sqrt((found.significance**2).mean()) == pytest.approx(np.sqrt(3), rel=0.1)
    assert wall(sigma=0.3).significance > 10
    assert wall().significance == np.inf


def test_conventions():
    """FS/RH has the opposite sign; SF/RH has the same sign."""
    b = wall()
    assert b.in_convention("FS/RH").tolist() == (-b.vector).tolist()
    assert b.in_convention("SF/RH").tolist() == b.vector.tolist()


def test_repr():
    """The repr has one line: the vector, its grain and phase."""
    assert "um in crystal axes, grain 0, nickel" in repr(wall())
