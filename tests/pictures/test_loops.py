"""Figures of loops: the open image of a loop, and maps."""

from typing import Any

import numpy as np
import pytest
import sympy as sp

from geomtorsion.errors import LoopError
from geomtorsion.geometry import Frame
from geomtorsion.loops import Loop, burgers_map, burgers_vector, burgers_vectors
from geomtorsion.loops.hodograph import hodograph
from geomtorsion.pictures.loops import draw_closure, draw_map
from geomtorsion.spaces import load

pytest.importorskip("matplotlib")

SEEN = 1e-9  # Share of a figure that is too small to see.


@pytest.mark.parametrize(
    ("name", "loop", "values"),
    [
        ("so3", Loop.circle([0.3, 1, 0.2], 0.5), {}),
        ("screw_dislocation", Loop.circle([0, 0, 0], 1), {"b": 1}),
        ("flat_polar", Loop.polygon([[1, 0], [2, 0], [2, 2], [1, 2]]), {}),
        ("so3", Loop.circle([0.3, 1, 0.2], 0.5).reversed().times(2), {}),
        ("twisted_bar", Loop.spline([[1, 0, 0], [0, 1, 1], [-1, 0, 0], [0, -1, 2]]), {"kappa": 2}),
    ],
    ids=lambda value: value if isinstance(value, str) else getattr(value, "name", ""),
)
def test_the_image_ends_at_the_burgers_vector(name: str, loop: Loop, values: dict) -> None:
    """The image starts at zero and ends at b; the path itself closes."""
    b = burgers_vector(load(name).frame, loop, parameters=values)
    drawn = hodograph(b)
    assert drawn.magnified == 1
    assert drawn.image[:, 0].tolist() == [0] * loop.dimension
    assert drawn.image[:, -1] == pytest.approx(b.vector, abs=SEEN)
    assert drawn.path[:, 0] == pytest.approx(drawn.path[:, -1], abs=SEEN)


@pytest.mark.parametrize("radius", [1e-4, 1e-12, 1e-300])
def test_a_gap_too_small_to_see_is_enlarged(radius: float) -> None:
    """A small gap is enlarged to a visible size, by a power of ten that the title names."""
    b = burgers_vector(load("so3").frame, Loop.circle([0.3, 1, 0.2], radius))
    drawn = hodograph(b)
    gap = drawn.image[:, -1]
    assert 0.03 < np.abs(gap).max() / np.ptp(drawn.image, axis=1).max() < 0.9
    direction = b.reduced / np.abs(b.reduced).max()
    assert gap / np.abs(gap).max() == pytest.approx(direction, abs=1e-3)
    title = draw_closure(b).axes[1].get_title()
    assert "gap enlarged" in title
    assert ("$10^{" in title) == (radius < 1e-5)


def test_axes_have_labels_and_units() -> None:
    """Coordinates have centre and unit, legs have numbers; the panel is 3d only if necessary."""
    figure = draw_closure(burgers_vector(load("so3").frame, Loop.circle([0.3, 1, 0.2], 1e-6)))
    left = figure.axes[0]
    # Type hints of matplotlib describe only two-dimensional axes.
    right: Any = figure.axes[1]
    assert left.get_xlabel() == r"$(\phi_{1} - 0.3)$ / 1e-06"
    assert right.name == "3d"
    assert right.get_zlabel() == "$X^3$ / 1e-06"
    flat = draw_closure(
        burgers_vector(load("flat_polar").frame, Loop.polygon([[1, 0], [2, 0], [2, 2], [1, 2]]))
    )
    assert [axes.name for axes in flat.axes] == ["rectilinear"] * 2
    nothing = draw_closure(
        burgers_vector(load("flat_polar").frame, Loop.polygon([[1, 0], [1, 2], [1, 1]]))
    )
    assert "|b|" in nothing.axes[1].get_title()


def test_a_map_rings_the_defect() -> None:
    """One panel for the one component, one ring with its strength; the first axis points right."""
    grid = np.linspace(-1, 1, 12)
    edge = load("edge_dislocation").frame
    found = burgers_map(edge, (grid, grid[2:]), parameters={"b": 0.1})
    figure = draw_map(found)
    axes, _ = figure.axes
    assert axes.get_title().startswith("$b^1$")
    assert [text.get_text() for text in axes.texts] == ["b = 0.1"]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("$x$", "$y$")
    assert axes.get_xlim() == pytest.approx((-1, 1))
    assert axes.get_ylim() == pytest.approx((grid[2], 1))


def test_a_map_of_a_smooth_density() -> None:
    """Each cell has its value; `relative` shows the difference from 2 S."""
    grids = (np.linspace(0, 3, 7), np.linspace(0.5, 2, 5))
    found = burgers_map(load("so3").frame, grids)
    first, second = (axes for axes in draw_map(found).axes if axes.get_title())
    assert (first.get_title(), second.get_title()) == ("$b^1$ per area", "$b^2$ per area")
    colours = first.collections[0].get_array()
    assert np.asarray(colours).reshape(4, 6) == pytest.approx(found.density[0].T)
    assert "minus $2S$" in draw_map(found, relative=True).axes[0].get_title()


def test_omitted_components_are_counted() -> None:
    """Three of four components are drawn, and the title of the figure states both numbers."""
    x, y, z, w = sp.symbols("x y z w")
    rows = [[int(i == k) + (i + 1) * y * int(k == 0) for k in range(4)] for i in range(4)]
    figure = draw_map(burgers_map(Frame([x, y, z, w], rows), (np.linspace(0, 1, 4),) * 2))
    assert figure.get_suptitle() == "the first 3 of 4 components"
    assert len([axes for axes in figure.axes if axes.get_title()]) == 3


def test_only_grids_are_maps() -> None:
    """A list of circles is refused, because a map needs a grid."""
    found = burgers_vectors(load("so3").frame, [[0, 1, 0]], 0.1)
    with pytest.raises(LoopError, match="expected a survey over a grid"):
        draw_map(found)
