"""Circuits: closed paths from pixel to neighbouring pixel of a map."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geomtorsion.errors import OrientationError
from geomtorsion.loops import Loop
from geomtorsion.loops.quadrature import PIECE
from geomtorsion.materials.fields.stencils import SLACK
from geomtorsion.support import checks


@dataclass(frozen=True, eq=False, repr=False)
class Circuit:
    """A closed chain of steps between neighbouring pixels.

    starts, ends: row and column of the pixels of each step, shape (k, 2).
    times: multiplicity of each step, shape (k,).
    name: of the circuit, for messages and figures.

    Raises
    ------
    OrientationError
        A step does not lead to a neighbour, or the chain does not close; the message names a pixel.

    Examples
    --------
    >>> square = Circuit.square((10, 20), 8)
    >>> len(square.starts), square
    (32, Circuit 'square of 8 x 8 cells at pixel (10, 20)': 32 steps)
    """

    starts: np.ndarray
    ends: np.ndarray
    times: np.ndarray
    name: str = "circuit"

    def __post_init__(self) -> None:
        """Check that steps join neighbours and that the chain closes."""
        for key in ("starts", "ends"):
            pixels = checks.array(getattr(self, key), key, OrientationError, shape=(None, 2))
            if (pixels != np.rint(pixels)).any() or (pixels < 0).any():
                raise OrientationError(
                    f"{key}: expected rows and columns of pixels from 0 on, got fractions or "
                    "negative numbers. Count pixels from 0."
                )
            object.__setattr__(self, key, pixels.astype(np.int64))
        times = checks.array(self.times, "times", OrientationError, shape=(len(self.starts),))
        object.__setattr__(self, "times", np.rint(times).astype(np.int64))
        if (times != self.times).any():
            raise OrientationError("times: expected whole numbers, got fractions. Correct them.")
        count = len(self.starts)
        checks.check_one_each(self.ends, count, "starts", "ends", OrientationError)
        far = np.abs(self.ends - self.starts).sum(axis=1) != 1
        if far.any() or not len(far):
            k = int(np.argmax(far)) if len(far) else 0
            came = f"{self.starts[k].tolist()} to {self.ends[k].tolist()}" if len(far) else "none"
            raise OrientationError(
                f"expected steps between neighbouring pixels, got {came}. Lead the circuit along "
                "rows and columns."
            )
        nodes, where = np.unique(
            np.concatenate([self.starts, self.ends]), axis=0, return_inverse=True
        )
        flow = np.bincount(where.ravel(), np.concatenate([-self.times, self.times]), len(nodes))
        if flow.any():
            open_end = tuple(nodes[np.argmax(flow != 0)].tolist())
            raise OrientationError(
                f"{self.name}: expected a closed circuit, got one that is open at pixel "
                f"{open_end}. Lead it back to its start."
            )

    def __repr__(self) -> str:
        return f"Circuit {self.name!r}: {len(self.starts)} steps"

    @classmethod
    def square(cls, corner: Sequence[int], size: int) -> Circuit:
        """A square of size x size cells; see `rectangle`."""
        return cls.rectangle(corner, size, size)

    @classmethod
    def rectangle(cls, corner: Sequence[int], rows: int, columns: int) -> Circuit:
        """A rectangle, from x to y: first along its row, then along its column.

        Parameters
        ----------
        corner
            Row and column of the corner pixel with the smallest row and column.
        rows, columns
            Numbers of cells in both directions.

        Raises
        ------
        OrientationError
            A number is not whole, or no cell is inside.
        """
        row, column = _pixel(corner)
        rows = checks.count(rows, "rows", OrientationError, 1)
        columns = checks.count(columns, "columns", OrientationError, 1)
        cells = np.ones((rows, columns), dtype=np.int64)
        size = f"{rows} x {columns} cells"
        name = f"{'square' if rows == columns else 'rectangle'} of {size} at pixel {row, column}"
        return cls.of_cells(cells, (row, column), name)

    @classmethod
    def of_cells(
        cls,
        cells: np.ndarray | Sequence[Sequence[int]] | Sequence[Sequence[bool]],
        corner: Sequence[int] = (0, 0),
        name: str = "circuit",
    ) -> Circuit:
        """The boundary of cells, each between four pixels.

        Parameters
        ----------
        cells
            How often the circuit surrounds each cell, or whether it does, shape (rows, columns).
        corner
            Row and column of the first cell's corner pixel, the one with the smallest indices.

        Examples
        --------
        >>> Circuit.of_cells([[1, 1], [1, 0]])
        Circuit 'circuit': 8 steps
        """
        row, column = _pixel(corner)
        kind = "whole numbers or truth values of shape (rows, columns), not all zero"
        shape = (None, None)
        counts = checks.array(
            _counted(cells), "cells", OrientationError, shape=shape, expected=kind
        )
        if not counts.any() or (counts != np.rint(counts)).any():
            checks.refuse(OrientationError, "cells", kind, cells)
        inside = np.pad(counts.astype(np.int64), 1)
        # A step along a row counts +1 for the cell below it (larger row), -1 for the cell above.
        along = inside[1:, 1:-1] - inside[:-1, 1:-1]
        across = inside[1:-1, :-1] - inside[1:-1, 1:]
        steps = [(np.argwhere(along), (0, 1), along), (np.argwhere(across), (1, 0), across)]
        starts = np.concatenate([first for first, _, _ in steps])
        ends = np.concatenate([first + np.array(step) for first, step, _ in steps])
        times = np.concatenate([table[tuple(first.T)] for first, _, table in steps])
        origin = np.array([row, column])
        return cls(starts + origin, ends + origin, times, name)

    @classmethod
    def through(cls, pixels: Sequence[Sequence[int]] | np.ndarray) -> Circuit:
        """A circuit through pixels in order, in straight lines along rows and columns.

        Parameters
        ----------
        pixels
            Row and column of each corner, shape (k, 2); the circuit returns from the last corner
            to the first.

        Raises
        ------
        OrientationError
            Two consecutive pixels share neither row nor column.

        Examples
        --------
        >>> Circuit.through([(0, 0), (0, 3), (2, 3), (2, 0)])
        Circuit 'circuit': 10 steps
        """
        corners = np.array([_pixel(pixel) for pixel in checks.entries(pixels, "pixels")])
        if len(corners) < 3:
            raise OrientationError(f"pixels: expected three or more, got {len(corners)}.")
        starts, ends = [], []
        for one, other in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            way = other - one
            if way.all():
                raise OrientationError(
                    f"pixels: expected each pixel in the row or column of the one before, got "
                    f"{tuple(one.tolist())} and {tuple(other.tolist())}. Put a pixel between them."
                )
            points = one + np.arange(abs(way).max() + 1)[:, None] * np.sign(way)
            starts.append(points[:-1])
            ends.append(points[1:])
        start, end = np.concatenate(starts), np.concatenate(ends)
        if not len(start):
            raise OrientationError("pixels: expected a circuit, got the same pixel each time.")
        return cls(start, end, np.ones(len(start), dtype=np.int64))

    @property
    def pixels(self) -> np.ndarray:
        """All pixels on the circuit, each once, shape (k, 2)."""
        return np.unique(np.concatenate([self.starts, self.ends]), axis=0)


def _counted(cells: object) -> object:
    """Cells with 1 for True and 0 for False; input that is not truth values is returned as is."""
    try:
        array = np.asarray(cells) if isinstance(cells, list | tuple | np.ndarray) else None
    except ValueError:
        return cells
    return cells if array is None or array.dtype.kind != "b" else array.astype(int)


def _pixel(pixel: object) -> tuple[int, int]:
    """Row and column of a pixel, checked."""
    kind, remedy = "a row and a column", "Write (row, column)."
    numbers = checks.entries(pixel, "pixel", OrientationError, 2, expected=kind, remedy=remedy)
    row, column = (checks.count(x, "pixel", OrientationError) for x in numbers)
    return row, column


def circuit_of(
    loop: Loop, shape: tuple[int, int], steps: tuple[float, float], shift: float, unit: str
) -> Circuit:
    """The circuit around the cells whose middles a loop surrounds; see OrientationMap.circuit.

    shape: numbers of rows and columns of pixels. steps, shift: of the map. unit: of lengths, for
    messages.
    """
    checks.instance(loop, Loop, "loop")
    if loop.dimension != 2:
        raise OrientationError(
            f"loop: expected two coordinates, x and y of the map, got {loop.dimension}."
        )
    rows, columns = shape
    begin = np.array([steps[0] * min(shift, 0.0), 0.0])
    end = np.array([steps[0] * (columns - 1 + max(shift, 0.0)), steps[1] * (rows - 1)])
    # Four points for each pixel along the loop, limited by memory.
    count = int(min(4 * loop.length / min(steps), PIECE))
    points = loop.points(max(count, 400))
    points = np.concatenate([points, points[:, :1]], axis=1)
    off = np.maximum(begin - points.T, points.T - end)
    if (off > SLACK * end).any():
        raise OrientationError(
            f"{loop!r} leaves the map, which extends from ({begin[0]:.6g}, 0) to ({end[0]:.6g}, "
            f"{end[1]:.6g}) {unit}. Choose a smaller loop, or another position."
        )
    xs = steps[0] * (np.arange(columns - 1) + (1 + shift) / 2)
    ys = steps[1] * (np.arange(rows - 1) + 0.5)
    cells = windings(points, xs, ys)
    if not cells.any():
        raise OrientationError(
            f"expected a loop around the middle of a cell (steps are {steps[0]:g} and "
            f"{steps[1]:g} {unit}), got {loop!r}. Choose a larger loop."
        )
    return Circuit.of_cells(cells, name=loop.name or "loop")


def windings(points: np.ndarray, xs: np.ndarray, ys: np.ndarray) -> np.ndarray:
    """Winding numbers of a closed polygon around the points of a grid, positive from x to y.

    points: corners, shape (2, k), the last one equal to the first. Returns shape (ys, xs).
    """
    steps = np.zeros((len(ys), len(xs) + 1), dtype=np.int64)
    for k in range(points.shape[1] - 1):
        (x0, x1), (y0, y1) = points[:, k : k + 2]
        if y0 == y1:
            continue
        low, high = np.searchsorted(ys, sorted((y0, y1)), side="left")
        rows = np.arange(low, high)
        crossings = x0 + (ys[rows] - y0) / (y1 - y0) * (x1 - x0)
        # A polygon side changes the winding number of all grid points with x below its crossing.
        np.add.at(steps, (rows, np.searchsorted(xs, crossings, side="left")), 1 if y1 > y0 else -1)
    ahead = np.cumsum(steps[:, ::-1], axis=1)[:, ::-1]
    return ahead[:, 1:]
