"""Figure of a lattice image: six panels, the circuit and its Burgers vector."""

# Tests pass wrong types on purpose, as users do, and read attributes that may be missing.
# pyright: reportArgumentType=false, reportAttributeAccessIssue=false, reportOperatorIssue=false, reportOptionalMemberAccess=false

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import ArgumentError
from geomtorsion.pictures.lattice import draw_lattice

pytest.importorskip("matplotlib")

Y, X = np.mgrid[127:-1:-1, 0:128] - 63.6
IMAGE = gt.LatticeImage(
    np.cos(2 * np.pi * X / 8 - np.arctan2(Y, X)) + np.cos(2 * np.pi * Y / 8), 0.5, "nm"
)
PHASES = IMAGE.phases()
CIRCUIT = gt.Loop.circle([31.8, 31.8], 20)


def test_six_panels_with_the_circuit_and_its_vector():
    """Six panels: axes in nm, holes masked, the circuit anticlockwise as requested."""
    figure = draw_lattice(IMAGE, PHASES, PHASES.burgers(CIRCUIT))
    panels = [axes for axes in figure.axes if axes.images]
    titles = [axes.get_title() for axes in panels]
    assert titles[:2] == ["image and circuit", "phase of spot 1"]
    assert len(titles) == 6
    x, y = panels[0].lines[0].get_data()
    assert np.hypot(x - 31.8, y - 31.8) == pytest.approx(np.full(len(x), 20.0), abs=0.6)
    assert panels[4].get_xlabel() == "x / nm"
    assert panels[2].images[0].get_array().mask.sum() == PHASES.holes.sum() > 0
    (text,) = figure.texts
    assert "b = (-1, 0) in lattice vectors" in text.get_text()
    assert "anticlockwise" in text.get_text()


def test_the_caption_names_a_clockwise_circuit():
    """The caption states the clockwise sense; without a circuit there is no caption."""
    figure = draw_lattice(IMAGE, PHASES, PHASES.burgers(CIRCUIT.reversed()))
    assert "run clockwise" in figure.texts[0].get_text().replace("\n", " ")
    assert not draw_lattice(IMAGE, PHASES).texts


@pytest.mark.parametrize("wrong", [(None, PHASES), (IMAGE, IMAGE), (IMAGE, PHASES, [1, 0])])
def test_what_cannot_be_drawn_is_refused(wrong):
    """The message gives the expected type of the wrong argument."""
    with pytest.raises(ArgumentError, match="expected "):
        draw_lattice(*wrong)
