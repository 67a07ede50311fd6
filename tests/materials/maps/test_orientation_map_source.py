"""Orientation maps as sources: tilt walls and real maps."""

# The tests pass what users pass, including wrong types, and read optional values.
# pyright: reportOptionalIterable=false, reportOptionalMemberAccess=false
# pyright: reportArgumentType=false

import numpy as np
import pytest

from geomtorsion.errors import OrientationError
from geomtorsion.loops import Loop
from geomtorsion.materials.readers import open_source
from tests.materials.maps.synthetic import wall
from tests.real import real


def test_a_tilt_wall():
    """b/L = 2 sin(theta/2), by a circuit and by the survey, at the position of the wall."""
    field = wall(2.0, (20, 30), 0.5, sigma=0.01)
    expected = 2 * np.sin(np.radians(1.0))
    found = field.burgers(Loop.plaquette([4, 2], [5, 4]))
    assert found.magnitude / 4 == pytest.approx(expected, rel=1e-9)
    assert np.hypot(*found.arrow) == pytest.approx(found.magnitude)
    assert np.nanmin(found.path, axis=1) == pytest.approx([4, 2])
    survey = field.burgers_map(4)
    p, q = np.unravel_index(np.argmax(survey.per_area), survey.known.shape)
    assert survey.per_area[p, q] == pytest.approx(2 * expected / 4)
    assert abs(survey.lines[0][p] - 7.25) <= 1
    assert survey.vectors.shape == (3, 26, 16)
    assert survey.arrows.shape == (2, 26, 16)
    assert not survey.significant[:10].any()


def test_a_plane_is_refused():
    """A map has only one plane."""
    with pytest.raises(OrientationError, match="plane: expected x and y, the only plane"):
        wall(2.0, (20, 30), 0.5, sigma=0).burgers_map(2, (1, 0))


def test_silicon_shows_nothing_but_noise():
    """On the wafer the rms of b at 8 pixels is below 6.5e-5 per um; no circuit is significant."""
    field = open_source(real("ebsd/si_wafer.ctf"))
    survey = field.burgers_map(8)
    assert np.sqrt(np.mean(survey.per_area**2)) < 6.5e-5
    assert not survey.significant.any()
    assert field.backdrop().values.shape == (48, 35)


def test_which_way_y_runs_and_a_plane_as_a_list():
    """y runs downwards in figures, as instruments show maps."""
    crystal = wall(1, (8, 9), 0.5, sigma=0)
    assert crystal.burgers_map(2, [0, 1]).down
    assert crystal.backdrop().down
