"""Figures of stresses: the right layer, the right values, and lines where they are."""

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import GridError

BOX = gt.Box.of_bounds([0, 0, 0], [4, 4, 4])
CORNERS, SIDES = [[1, 1, 2], [3, 1, 2], [3, 3, 2], [1, 3, 2]], [[0, 1], [1, 2], [2, 3], [3, 0]]
LOOP = gt.DislocationNetwork.of_arrays(gt.LineArrays(CORNERS, SIDES, [[0, 0, 0.25]] * 4, BOX))
STEEL = gt.ElasticConstants.isotropic(80, 0.3, unit="GPa")
FOUND = gt.stresses(LOOP, STEEL, shape=(16, 12, 8), core=0.5)


def test_a_layer_of_the_loop():
    """The layer of the loop shows its four sides and the values of this layer."""
    (axes, _) = FOUND.plot(component="xx", layer=4).axes
    assert len(axes.lines) == 5  # four sides, and the dots, none here
    assert np.size(axes.lines[-1].get_xdata()) == 0
    np.testing.assert_array_equal(
        np.asarray(axes.collections[0].get_array()).reshape(16, 12), FOUND.stress[0, 0, :, :, 4]
    )
    assert axes.get_title() == r"$\sigma_{xx}$ / GPa"


def test_lines_that_cross_are_dots():
    """A section across the loop has two dots, at the crossings."""
    figure = FOUND.plot(component="xz", plane="xz", layer=6)
    dots = figure.axes[0].lines[-1]
    points = np.array(sorted(np.asarray(dots.get_xydata()).tolist()))
    np.testing.assert_allclose(points, [[1, 2], [3, 2]], atol=1e-12)
    assert "Layer y = 2." in figure.texts[0].get_text()


def test_without_a_layer_the_strongest_is_drawn():
    """The default layer holds the largest value of the component."""
    mesh = FOUND.plot(component="zz", plane=(1, 2)).axes[0].collections[0]
    assert np.abs(np.asarray(mesh.get_array())).max() == np.abs(FOUND.stress[2, 2]).max()


def test_a_plane_map_and_its_corrections():
    """The caption of a plane map names the missing direction and the corrections."""
    alpha = np.zeros((3, 3, 8, 8, 1))
    alpha[2, 2, 3, 3] = 0.1
    field = gt.NyeField(alpha, gt.Box.of_bounds([0, 0, 0], [8, 8, 1], (False, False, True)), "um")
    figure = gt.stresses(field.padded(8).balanced(), STEEL).plot()
    text = figure.texts[0].get_text()
    assert "Nothing depends on z" in text
    assert "spread over the cell" in text.replace("\n", " ")
    assert figure.axes[0].get_xlabel() == "$x$ / um"


def test_a_notebook_shows_the_figure():
    """Text and figure."""
    page = FOUND._repr_html_()
    assert "Stresses(16 x 12 x 8 nodes" in page
    assert "<svg" in page


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"component": "xw"}, "mises, xx"),
        ({"plane": "xx"}, "two of x, y, z"),
        ({"plane": (0, 3)}, "two of x, y, z"),
        ({"layer": 8}, "from 0 to 7"),
    ],
)
def test_refusals(options, words):
    """Components, planes and layers that do not exist are refused."""
    with pytest.raises(GridError, match=words):
        FOUND.plot(**options)
