"""End maps: which motions end how, against conserved energies and straight lines."""

from typing import Any

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import ArgumentError, ShapeError, StartError, UnknownNameError

SWING = gt.ODE.of({"x": "v", "v": "-sin(x)"}, [0, 0], events=[gt.When("pi - x")])


def test_pendulums_over_the_top():
    """Those with an energy above the separatrix pass the top; on it the end is not certain."""
    places, speeds = np.linspace(-2.0, 2.0, 8), np.linspace(0.3, 2.8, 7)
    over = gt.end_map(SWING, {"x": places, "v": speeds}, 30.0)
    energy = speeds[:, None] ** 2 / 2 - np.cos(places)
    assert over.fate.shape == (7, 8)
    assert np.array_equal(over.fate == 0, energy > 1)
    assert np.array_equal(over.fate == -1, energy < 1)
    assert (over.times[energy < 1] == 30.0).all()
    assert (over.times[energy > 1] < 30.0).all()
    assert list(over.counts.values()) == [(energy > 1).sum(), (energy < 1).sum(), 0]


def test_an_uncertain_end_is_marked():
    """A ball that rolls to the top of a hill ends as its error decides; the others do not."""
    hill = gt.ODE.of({"x": "v", "v": "x"}, [1, 0], events=[gt.When("x + 0.5")])
    ends = gt.end_map(hill, {"v": [-1.1, -1.0, -0.9], "x": [1.0]}, 60.0)
    assert ends.fate.tolist() == [[0, -2, -1]]
    assert ends.undecided.tolist() == [[False, True, False]]
    assert np.isnan(ends.times[0, 1])
    assert "undecided: 1" in repr(ends)


@pytest.mark.parametrize("kind", ["velocity", "frame_velocity"])
def test_lines_to_two_walls(kind):
    """A straight line meets the wall ahead of it first; coordinates and velocities vary."""
    plane = gt.Frame(sp.symbols("x y"), sp.eye(2))
    names = ("x'", "y'") if kind == "velocity" else ("u1", "u2")
    speed: dict[str, Any] = {kind: [1, 1]}
    line = gt.geodesic(plane, [0, 0], **speed, stop=["1 - x", "1 - y"])
    speeds = np.array([0.2, 0.5, 0.9])
    walls = gt.end_map(line, {names[0]: speeds, names[1]: speeds + 0.05}, 10.0)
    assert np.array_equal(walls.fate == 0, speeds[None, :] > speeds[:, None] + 0.05)
    near = gt.end_map(line, {"x": [0.0, 0.5], "y": [0.25, 0.75]}, 10.0)
    assert near.fate.tolist() == [[1, 0], [1, 1]]
    assert near.times == pytest.approx(np.array([[0.75, 0.5], [0.25, 0.25]]))


def test_a_condition_with_a_kink_is_one_end():
    """Both sides of |x| stop a motion, and both are the same end."""
    line = gt.ODE.of({"x": "v", "v": "0"}, [0, 1], events=[gt.When("1 - Abs(x)")])
    walls = gt.end_map(line, {"x": [0.0, 0.5], "v": [-1.0, 0.0, 2.0]}, 4.0)
    assert walls.fate.tolist() == [[0, 0], [-1, -1], [0, 0]]
    assert len(walls.conditions) == 1
    assert list(walls.counts.values()) == [4, 2, 0]


def test_the_figure_has_an_entry_for_each_end():
    """Only ends that occur are in the legend."""
    pytest.importorskip("matplotlib")
    ends = gt.end_map(SWING, {"x": [0.0, 1.0], "v": [0.5, 2.5]}, 10.0)
    figure = ends.plot()
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["on the way", *ends.conditions]
    figure.canvas.draw()
    box = legend.get_window_extent()
    assert 0 <= box.x0 < box.x1 <= figure.bbox.width
    with pytest.raises(ArgumentError, match="expected the result of gt.end_map"):
        gt.pictures.draw_ends(3)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: gt.end_map(SWING, {"x": [1.0]}, 1.0), ShapeError, "two names with their values"),
        (lambda: gt.end_map(SWING, {"x": [1.0], "w": [1.0]}, 1.0), UnknownNameError, "'w'"),
        (lambda: gt.end_map(SWING, {"x": 1.0, "v": [1.0]}, 1.0), ShapeError, "values of x"),
        (lambda: gt.end_map(SWING, {"x": [4.0], "v": [1.0]}, 1.0), StartError, "for member 0"),
        (lambda: gt.end_map(SWING, {"x": [0.0], "v": [1.0]}, [1.0]), StartError, "the last time"),
        (lambda: gt.end_map(gt.ODE.of({"x": 1}, [0]), {"x": [0], "y": [1]}, 1.0),
         StartError, "a condition that ends it"),
        (lambda: gt.end_map(3, {"x": [0], "y": [1]}, 1.0), StartError, "a condition that ends it"),
        (lambda: gt.end_map(
            gt.geodesic("s2", [1, 0], [0, 1], parameters={"R": 1}, stop="2 - phi"),
            {"R": [1.0], "phi": [0.0]}, 1.0), UnknownNameError, "R"),
    ],
)  # fmt: skip
def test_refusals(call, error, words):
    """A map needs two numbers of a start, and a condition that ends the motion."""
    with pytest.raises(error, match=words):
        call()


def test_three_bodies_have_the_symmetry_of_two_equal_stars():
    """Half a turn exchanges the stars, and with them the ends of a body that starts at rest."""
    right, left = "((x - 1/2)**2 + y**2)", "((x + 1/2)**2 + y**2)"
    rates = {
        "x": "u",
        "y": "v",
        "u": f"2*v + x - (x - 1/2)/(2*{right}**(3/2)) - (x + 1/2)/(2*{left}**(3/2))",
        "v": f"-2*u + y - y/(2*{right}**(3/2)) - y/(2*{left}**(3/2))",
    }
    ends = [gt.When(f"{right} - 1/400"), gt.When(f"{left} - 1/400"), gt.When("9 - x**2 - y**2")]
    body = gt.ODE.of(rates, [1, 0, 0, 0], events=ends)
    places = np.linspace(-1.85, 1.85, 12)
    found = gt.end_map(body, {"x": places, "y": places}, 10.0)
    assert not found.undecided.any()
    exchanged = {-1: -1, 0: 1, 1: 0, 2: 2}
    turned = [[exchanged[int(x)] for x in row[::-1]] for row in found.fate[::-1]]
    assert turned == found.fate.tolist()
    assert {0, 1, 2} <= set(found.fate.ravel().tolist())
