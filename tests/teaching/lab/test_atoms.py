"""A crystal on the page: circuits made by clicks, and the library's b for them."""

from __future__ import annotations

import re
from itertools import pairwise
from typing import Any

import networkx as nx
import numpy as np
import pytest

from geomtorsion.teaching.lab.atoms import CRYSTALS, closure, crystal
from tests.browser import Watched


def corners(name: str, low: tuple[float, float], high: tuple[float, float]) -> list[int]:
    """Atoms nearest to the corners of a rectangle, anticlockwise; the first one is repeated."""
    places = np.array(crystal(name)["atoms"])
    around = [low, (high[0], low[1]), high, (low[0], high[1]), low]
    return [int(np.linalg.norm(places - one, axis=1).argmin()) for one in around]


def ring(name: str, low: tuple[float, float], high: tuple[float, float]) -> list[int]:
    """A closed path along bonds around a rectangle of the crystal."""
    graph = nx.Graph([bond[:2] for bond in crystal(name)["bonds"]])
    path: list[int] = []
    for one, two in pairwise(corners(name, low, high)):
        path += nx.shortest_path(graph, one, two)[:-1]
    return path


@pytest.mark.parametrize("name", CRYSTALS)
def test_circuits_measure_the_dislocations_inside(name: str):
    """b is minus the integral of du: only the lines inside the circuit count."""
    for low, high in (((-6, -3), (6, 3)), ((-6, -3), (1, 3)), ((-6, -5), (6, -1.5))):
        inside = [b for x, y, b in CRYSTALS[name] if low[0] < x < high[0] and low[1] < y < high[1]]
        assert closure(name, ring(name, low, high)) == [-sum(inside), 0], (low, high)


@pytest.mark.parametrize("name", CRYSTALS)
def test_bonds_are_neighbours(name: str):
    """Each bond has about the length of its lattice vector; inner atoms have 3 to 5 bonds."""
    made = crystal(name)
    places = np.array(made["atoms"])
    first, second, *steps = np.array(made["bonds"]).T
    bent = places[second] - places[first] - np.array(steps).T
    assert np.linalg.norm(bent, axis=1).max() < 0.75
    count = np.bincount(np.concatenate([first, second]), minlength=len(places))
    inner = (np.abs(places) < (6, 4)).all(axis=1)
    assert set(count[inner]) <= {3, 4, 5}


def test_a_crystal_is_clicked(shared_lab: Watched):
    """In a browser, clicks and arrow keys make a circuit, and the crystal fits a phone."""
    page = shared_lab.tab("Loops")
    frame: Any = page.frame_locator("#atoms iframe")
    said = frame.locator("#result")
    frame.locator("#example").click()
    assert "Its gap from start to end is b = (−1, 0)" in said.inner_text()
    frame.locator("#restart").click()
    around = (-4, -2), (4, 3)
    for atom in corners("one", *around):
        frame.locator(f'circle[data-atom="{atom}"]').click()
    assert closure("one", ring("one", *around)) == [-1, 0]
    assert re.search(
        r"anticlockwise: the circuit closes in the crystal, but.*b = \(−1, 0\)", said.inner_text()
    )
    frame.locator("#which").select_option("none")
    frame.locator("#crystal").focus()
    for key in ("ArrowUp", "ArrowRight", "ArrowUp", "ArrowLeft", "ArrowDown"):
        page.keyboard.press(key)
    assert (
        "4 steps, anticlockwise: the circuit closes in the crystal and in the perfect lattice"
        in said.inner_text()
    )
    page.keyboard.press("Backspace")
    assert "3 steps with the sum (0, 1)" in said.inner_text()
    content = page.locator("#atoms iframe").element_handle().content_frame()
    for width in (400, 1280):
        page.set_viewport_size({"width": width, "height": 800})
        frame.locator("#example").click()
        for side in ("Width", "Height"):
            inner = content.evaluate(f"document.body.scroll{side} - inner{side}")
            assert inner <= 0, (width, side)
