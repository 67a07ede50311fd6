"""Circuits: boundaries of cells, paths through pixels, windings of polygons."""

from typing import Any

import numpy as np
import pytest

from geomtorsion.errors import OrientationError
from geomtorsion.loops import Loop
from geomtorsion.materials.maps import Circuit
from geomtorsion.materials.maps.pixel_circuits import windings


def chain(circuit):
    """{(start, end) in ascending sense: times}."""
    found = {}
    for a, b, n in zip(circuit.starts.tolist(), circuit.ends.tolist(), circuit.times, strict=True):
        key, sign = ((tuple(a), tuple(b)), 1) if a < b else ((tuple(b), tuple(a)), -1)
        found[key] = found.get(key, 0) + sign * int(n)
    return {key: n for key, n in found.items() if n}


def test_a_square_runs_from_x_to_y():
    """Along its first row (x) forwards, along its last column (y) forwards."""
    assert chain(Circuit.square((2, 3), 1)) == {
        ((2, 3), (2, 4)): 1, ((2, 4), (3, 4)): 1, ((3, 3), (3, 4)): -1, ((2, 3), (3, 3)): -1,
    }  # fmt: skip
    through = Circuit.through([(2, 3), (2, 5), (5, 5), (5, 3)])
    assert chain(through) == chain(Circuit.rectangle((2, 3), 3, 2))


def test_every_pixel_is_left_as_often_as_it_is_reached():
    """The boundary of cells closes, also with holes and with multiples."""
    cells = np.random.default_rng(2).integers(-2, 3, (6, 7))
    circuit = Circuit.of_cells(cells, (1, 1))
    flow = np.zeros((10, 10), dtype=int)
    np.add.at(flow, tuple(circuit.starts.T), -circuit.times)
    np.add.at(flow, tuple(circuit.ends.T), circuit.times)
    assert not flow.any()
    assert circuit.pixels.min() >= 1


@pytest.mark.parametrize("made", [list, tuple, np.array])
def test_cells_may_be_truth_values(made):
    """Truth values work the same in lists, tuples and arrays."""
    rows = [[True, False], [True, True]]
    assert chain(Circuit.of_cells(made(rows))) == chain(Circuit.of_cells([[1, 0], [1, 1]]))


def test_windings_agree_with_the_loop():
    """Windings agree with Loop.winding at each point, for a curve that winds twice around some."""
    loop = Loop.spline([[1, 1], [5, 1], [5, 4], [2, 4], [2, 2], [4, 2], [4, 5], [1, 5]])
    xs, ys = np.arange(0.25, 6, 0.7), np.arange(0.3, 6, 0.6)
    corners = loop.points(4000)
    corners = np.concatenate([corners, corners[:, :1]], axis=1)
    found = windings(corners, xs, ys)
    expected = [[loop.winding([x, y]) for x in xs] for y in ys]
    assert found.tolist() == expected
    assert found.max() == 2


def one_step(start, end, times: float = 1):
    return Circuit(np.array([start]), np.array([end]), np.array([times]))


HALF: Any = ((1.5, 1), 2)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Circuit.square((1, 1), 0), "rows: expected a whole number from 1 on"),
        (lambda: Circuit.square(*HALF), "pixel: expected a whole number"),
        (lambda: Circuit.square((1,), 2), "expected a row and a column, got"),
        (lambda: Circuit.of_cells(np.zeros((2, 2), dtype=int)), "not all zero"),
        (lambda: Circuit.of_cells([[True], [True, False]]), "whole numbers or truth values"),
        (lambda: Circuit.of_cells([[False]]), "not all zero"),
        (lambda: Circuit.of_cells(np.array([["x"]])), "whole numbers or truth values"),
        (lambda: Circuit.through([(0, 0), (1, 1), (0, 1)]), r"column .* \(0, 0\) and \(1, 1\)"),
        (lambda: Circuit.through([(0, 0), (0, 1)]), "expected three or more, got 2"),
        (lambda: Circuit.through([(0, 0)] * 3), "got the same pixel each time"),
        (lambda: one_step((0, 0), (0, 1)), r"got one that is open at pixel \(0, 0\)"),
        (lambda: one_step((0, 0), (2, 1)), r"neighbouring pixels, got \[0, 0\] to \[2, 1\]"),
        (lambda: one_step((0, 0.5), (0, 1)), "starts: expected rows and columns of pixels"),
        (lambda: one_step((0, 0), (0, 1), 0.5), "times: expected whole numbers, got fractions"),
    ],
)  # fmt: skip
def test_bad_circuits(call, message):
    """Each message names the expected value."""
    with pytest.raises(OrientationError, match=message):
        call()
