"""Figures of crystals in a plane: atoms by grain, dislocations with b, units."""

from typing import Any

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.materials.crystals import PlaneCrystal

pytest.importorskip("matplotlib")

COLUMNS, ROWS = (np.mgrid[-10:11, -10:11] + 0.5).reshape(2, -1)


def test_a_perfect_crystal_has_atoms_and_no_arrow():
    """One series of all atoms; the axes name a unit only if it is known."""
    crystal = PlaneCrystal(np.column_stack([COLUMNS, ROWS]))
    axes = crystal.plot().axes[0]
    assert [np.size(line.get_xdata()) for line in axes.lines] == [crystal.count]
    assert not axes.texts
    assert axes.get_xlabel() == "x (unit of the positions)"
    figure = gt.pictures.draw_plane_crystal(crystal, "nm")
    assert figure.axes[0].get_ylabel() == "y (nm)"
    assert figure.texts[0].get_text() == ("441 atoms, 1 grain, 0 dislocations; square, a = 1 nm.")


def test_arrows_are_multiples_of_b():
    """Each arrow starts at its dislocation and is b times the number in the caption."""
    slip = np.arctan2(ROWS, COLUMNS) / (2 * np.pi)
    crystal = PlaneCrystal(np.column_stack([COLUMNS + slip, ROWS]))
    (point,) = crystal.dislocations()
    figure = gt.pictures.draw_plane_crystal(crystal)
    drawn: Any = figure.axes[0].texts[0]
    assert len(figure.axes[0].texts) == 1
    assert tuple(drawn.get_position()) == pytest.approx(point.position)
    away = np.subtract(drawn.xy, point.position) / point.burgers[0]
    assert away == pytest.approx([2, 2 * point.burgers[1] / point.burgers[0]])
    assert "Arrows: b, drawn 2 times as long." in figure.texts[0].get_text()
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels[0].startswith("grain 0: square, ")
    assert labels[1:] == ["dislocation with b"]


def test_grains_and_cells_are_drawn():
    """Two grains have two colours, and a periodic cell its four edges."""
    turn = np.radians(20)
    turned = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    first = np.column_stack([COLUMNS, ROWS])
    second = first @ turned.T
    places = np.concatenate([first[first[:, 0] < -0.4], second[second[:, 0] > 0.4]])
    axes = PlaneCrystal(places).plot().axes[0]
    assert len({line.get_color() for line in axes.lines}) == 2
    wrapped = PlaneCrystal(first + 10, cell=[21, 21]).plot().axes[0]
    assert np.asarray(wrapped.lines[-1].get_xydata())[2].tolist() == [21, 21]
