"""Sampled frames as sources: circuits and surveys of grids against closed forms."""

# The tests pass what users pass, including wrong types, and read optional values.
# pyright: reportOptionalMemberAccess=false

import numpy as np
import pytest

from geomtorsion.loops import Loop
from geomtorsion.materials.fields import SampledFrame

AXES = [np.linspace(0, 5, 11), np.linspace(0, 6, 13)]


def field(**options):
    """Torsion 2 in both rows: b is (2, 2) times the enclosed area."""
    x, y = np.meshgrid(*AXES, indexing="ij")
    return SampledFrame(AXES, np.array([[-y, x], [0 * x, 2 * x]]), **options)


def test_a_circle_encloses_its_area():
    """b = (2, 2) times the area, and the arrow is b."""
    found = field(sigma=0.01, unit="nm").burgers(Loop.circle([2, 3], 1.5))
    area = np.pi * 1.5**2
    assert found.vector == pytest.approx([2 * area] * 2)
    assert found.area == pytest.approx(area)
    assert found.arrow == pytest.approx(found.vector)
    assert found.unit == "nm"
    assert found.is_significant
    assert found.path[:, 0] == pytest.approx(found.path[:, -1])
    assert found.to_json()["significance"] == found.significance


def test_surveys_are_at_the_middles():
    """Circuits of 2 x 2 cells of 0.5: the first is around (0.5, 0.5)."""
    found = field(sigma=0.01).burgers_map(2)
    assert found.vectors.shape == (2, 9, 11)
    assert found.vectors == pytest.approx(2.0)
    assert found.per_area == pytest.approx(np.sqrt(8))
    assert (found.lines[0][0], found.lines[1][-1]) == (0.5, 5.5)
    assert found.significant.all()


def test_noise_is_rarely_significant():
    """In a flat field with noise about one circuit in a thousand is significant."""
    rng = np.random.default_rng(7)
    values = rng.normal(0, 0.1, (2, 2, 150, 150))
    flat = SampledFrame([np.arange(150.0)] * 2, values, 2, sigma=0.1)
    found = flat.burgers_map(3)
    assert 0 < found.significant.mean() < 4e-3


def test_layers_of_three_axes():
    """Layers are across the plane, in the order of the third axis, with the torsion at their z."""
    axes = [np.arange(7.0), np.arange(8.0), np.arange(6.0)]
    x, _y, z = np.meshgrid(*axes, indexing="ij")
    cube = SampledFrame(axes, np.array([[0 * x, x * z, 0 * x]]), sigma=0.01)
    found = cube.burgers_map(2)
    assert found.layers[3] == "z = 3"
    assert found.vectors[0, :, :, 3] == pytest.approx(3 * 4)
    assert found.strongest_layer == 5
    # In the plane y, z the coframe x z dy has the torsion -x.
    other = cube.burgers_map(1, (1, 2))
    assert other.axes == ("y", "z")
    assert other.laid(other.vectors)[0, :, :, 4] == pytest.approx(-4)
    assert other.layers[4] == "x = 4"


def test_circuits_in_three_axes_are_on_a_section():
    """The section is the plane of largest area through the circuit's middle, near its layer."""
    axes = [np.arange(7.0), np.arange(8.0), np.arange(6.0)]
    x, y, z = np.meshgrid(*axes, indexing="ij")
    values = np.array([[0 * x, x * z, 0 * x], [y, 0 * x, 0 * x], [0 * x, -z * x, 0 * x]])
    cube = SampledFrame(axes, values, sigma=0.01)
    found = cube.burgers(Loop.circle([4.2, 3, 2], 1.5, plane=(1, 2)))
    assert found.section.plane == (1, 2)
    assert found.section.at == pytest.approx((4.2,))
    assert np.hypot(found.path[0] - 3, found.path[1] - 2) == pytest.approx(1.5, abs=1e-9)
    # The coframe x z dy has the torsion -x in y and z.
    assert found.vector[0] == pytest.approx(-4.2 * found.area, rel=1e-3)
    assert found.arrow == pytest.approx(found.vector[1:])
    below = cube.backdrop(found.section)
    assert "x = 4" in below.title
    assert below.values.shape == (7, 5)
    assert below.values == pytest.approx(np.sqrt(2) * 4)
    # Without a section the backdrop is the middle of the third axis.
    assert "z = 2" in cube.backdrop().title


def test_holes_stay_blank():
    """Circuits that touch a hole are unknown in the backdrop, and in a survey of one size."""
    hole = np.zeros((11, 13), dtype=bool)
    hole[5, 6] = True
    found = field(mask=hole, sigma=0.01)
    assert (~found.burgers_map(1, widen=False).known).sum() == 4
    assert np.isnan(found.backdrop().values).sum() == 4


def test_which_way_y_runs():
    """y runs upwards in figures of grids."""
    assert not field().burgers_map(2).down
    assert not field().backdrop().down
