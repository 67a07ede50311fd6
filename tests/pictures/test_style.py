"""Style: names of saved figures, and refusals of objects that cannot be drawn."""

from collections.abc import Callable, Hashable
from typing import Any

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import ArgumentError

pytest.importorskip("matplotlib")

LINE = np.linspace(-1, 1, 12)
FIELD = gt.SampledFrame([LINE, LINE], np.tile(np.eye(2)[..., None, None], (1, 1, 12, 12)))


@pytest.mark.parametrize(
    ("draw", "needed"),
    [(gt.pictures.draw_closure, "b: expected a BurgersVector"),
     (gt.pictures.draw_map, "survey: expected a BurgersMap"),
     (gt.pictures.draw_survey, "survey: expected a Survey"),
     (gt.pictures.draw_network, "net: expected a Network"),
     (gt.pictures.draw_dislocations, "net: expected a DislocationNetwork"),
     (gt.pictures.draw_lines, "net: expected a DislocationNetwork"),
     (gt.pictures.draw_series, "series: expected a DislocationSeries"),
     (gt.pictures.draw_plane_crystal, "crystal: expected a PlaneCrystal"),
     (gt.pictures.draw_plan, "plan: expected a DependencyGraph"),
     (gt.pictures.draw_solution, "found: expected a Solution or an Ensemble"),
     (gt.pictures.curve_pictures, "pair: expected a Pair"),
     (lambda value: gt.pictures.save(value, "picture.png"), "figure: expected a Figure")],
)  # fmt: skip
@pytest.mark.parametrize("came", [None, "b", FIELD.burgers(gt.Loop.circle([0, 0], 0.5))])
def test_wrong_types_are_refused(draw: Callable[[Any], object], needed: str, came: Any):
    """The message names the argument and the expected type."""
    with pytest.raises(ArgumentError, match=needed):
        draw(came)


@pytest.mark.parametrize("plane", [(0, 7), (0, 0), (0,), 3, ("x", "y"), (-1, 0)])
def test_a_plane_is_two_coordinates(plane: Any):
    """A plane is two different axes of the network, given as numbers."""
    lines = [("a", "b", (1, 0, 0)), ("b", "c", (1, 0, 0))]
    net = gt.DislocationNetwork.of_lines(lines, surface=["a", "c"])
    places: dict[Hashable, Any] = {"a": (0, 0, 0), "b": (1, 0, 0), "c": (1, 1, 0)}
    with pytest.raises(ArgumentError, match="plane"):
        gt.pictures.draw_dislocations(net, places, plane)


def test_a_number_is_refused_as_path():
    """A number as path is refused, because Python reads it as a handle of an open file."""
    figure = gt.pictures.draw_plan(gt.spaces.load("s2").frame.plan("metric"))
    with pytest.raises(ArgumentError, match="path: expected the name of a file"):
        gt.pictures.save(figure, 3)  # pyright: ignore[reportArgumentType]
