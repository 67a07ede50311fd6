"""Map points: measured points in any order, and the grid of pixels that contains them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from geomtorsion.errors import FileFormatError, LimitError
from geomtorsion.materials.maps.phases import Phase
from geomtorsion.support.npz import most_unpacked


@dataclass(frozen=True, eq=False)
class MapFile:
    """The content of a file of an orientation map.

    euler: Bunge's angles phi1, Phi, phi2 in radians, shape (rows, columns, 3).
    phase: number of the phase of each pixel, 0 where nothing was indexed, shape (rows, columns).
    phases: number -> phase. steps: along x and y. shift: of every second row, as a share of the
        step along x: 0 for square grids, 1/2 (or -1/2) for hexagonal grids.
    """

    euler: np.ndarray
    phase: np.ndarray
    phases: Mapping[int, Phase]
    steps: tuple[float, float]
    shift: float = 0.0


@dataclass(frozen=True, eq=False)
class Declared:
    """The grid that the header of a file describes.

    counts: number of pixels in each row. steps: along x and y. shift: of every second row, in
    steps.
    """

    counts: np.ndarray
    steps: tuple[float, float]
    shift: float = 0.0

    @property
    def pixels(self) -> tuple[np.ndarray, np.ndarray]:
        """Row and column of each point, row by row."""
        row = np.repeat(np.arange(len(self.counts)), self.counts)
        return row, np.arange(len(row)) - np.repeat(
            np.cumsum(self.counts) - self.counts, self.counts
        )


@dataclass(frozen=True, eq=False)
class MapPoints:
    """Points of a file, in the order of the file.

    name: of the file. size: of the file in bytes. x, y: positions in um, shape (points,). euler:
    radians, shape (points, 3). phase: shape (points,). declared: the grid in the header, or None.
    start: line of the first point, counted from 1; None for binary files.
    """

    name: str
    size: int
    x: np.ndarray
    y: np.ndarray
    euler: np.ndarray
    phase: np.ndarray
    phases: Mapping[int, Phase]
    declared: Declared | None = None
    start: int | None = None

    def where(self, k: int) -> str:
        """Position of a point in the file, in words."""
        return f"point {k + 1}" if self.start is None else f"line {self.start + k}"


@dataclass(frozen=True, eq=False)
class _Pixels:
    """Row and column of each point, and the grid."""

    row: np.ndarray
    column: np.ndarray
    steps: tuple[float, float]
    shift: float


def gridded(points: MapPoints) -> MapFile:
    """The map of points; x and y decide where they and the header disagree.

    Missing points become pixels without an orientation.

    Raises
    ------
    FileFormatError
        The file is truncated, the points are not on a grid, or two points have one position.
    LimitError
        A few points far apart would make a grid of very many pixels.
    """
    pixels = _pixels(points)
    rows, columns = (int(k.max()) + 1 for k in (pixels.row, pixels.column))
    # Angles and phase take 32 bytes of memory for each pixel.
    most = most_unpacked(points.size)
    if 32 * rows * columns > most:
        raise LimitError(
            f"{points.name}: expected a grid of at most {most // 32:,} pixels for a file of this "
            f"length, got {rows:,} x {columns:,}, most of them missing. Export the map on its grid."
        )
    flat = pixels.row * columns + pixels.column
    order = np.argsort(flat, kind="stable")
    twice = np.flatnonzero(np.diff(flat[order]) == 0)
    if len(twice):
        one, other = sorted(order[twice[0] : twice[0] + 2].tolist())
        raise FileFormatError(
            f"{points.name}: expected one point at each position, got {points.where(one)} and "
            f"{points.where(other)} at one position. Keep one of them."
        )
    euler = np.zeros((rows * columns, 3))
    phase = np.zeros(rows * columns, dtype=np.int64)
    euler[flat], phase[flat] = points.euler, points.phase
    return MapFile(
        euler.reshape(rows, columns, 3), phase.reshape(rows, columns), points.phases, pixels.steps,
        pixels.shift,
    )  # fmt: skip


def _pixels(points: MapPoints) -> _Pixels:
    """The pixel of each point, and the grid."""
    # Rows of hexagonal grids are shifted by half a step. Half of that separates the two grids.
    pixels = _by_order(points, 0.25)
    if pixels is not None:
        return pixels
    try:
        return _by_place(points)
    except FileFormatError:
        # Coordinates with few digits may determine only the order of the points.
        pixels = _by_order(points, 0.5)
        if pixels is None:
            raise
    return pixels


def _by_order(points: MapPoints, most: float) -> _Pixels | None:
    """Pixels in the order of the header, if each point is close to its pixel; otherwise None.

    most: largest distance from the pixel, in steps, along x and along y.
    """
    declared = points.declared
    if declared is None or min(declared.steps) <= 0 or not len(points.x):
        return None
    count, total = len(points.x), int(declared.counts.sum())
    if count > total:
        return None
    row, column = (k[:count] for k in declared.pixels)
    across = column + declared.shift * (row % 2)
    for values, place, step in (
        (points.x, across, declared.steps[0]), (points.y, row, declared.steps[1]),
    ):  # fmt: skip
        if (np.abs((values - values[0]) / step - place + place[0]) >= most).any():
            return None
    if count < total:
        if count in np.cumsum(declared.counts):
            return None
        raise FileFormatError(
            f"{points.name}: {points.where(count - 1)}: expected {total:,} points in "
            f"{len(declared.counts)} rows of pixels, as declared in the header, got {count:,} "
            "before the file ends. It is truncated: export it again."
        )
    return _Pixels(row, column, _steps(points, row, across, declared.steps), declared.shift)


def _steps(
    points: MapPoints, row: np.ndarray, across: np.ndarray, otherwise: tuple[float, float]
) -> tuple[float, float]:
    """Steps along x and y: the steps of the header if they fit the points, or fitted steps."""
    dx, dy = otherwise if points.declared is None else points.declared.steps
    return _better(points.x, across, dx), _better(points.y, row, dy)


def _better(values: np.ndarray, place: np.ndarray, declared: float) -> float:
    """The step of the header, unless a fitted step describes the points twice as well."""
    off, at = values - values[0], place - place[0]
    own = float((off * at).sum() / max((at * at).sum(), 1e-300))
    rests = [float(np.abs(off - step * at).max()) for step in (declared, own)]
    rounding = 4 * float(np.spacing(np.abs(values).max()))
    return declared if own <= 0 or rests[0] <= 2 * rests[1] + rounding else own


def _by_place(points: MapPoints) -> _Pixels:
    """Pixels from x and y: a row has equal y, and its points are whole numbers of steps apart."""
    if not len(points.x):
        raise FileFormatError(
            f"{points.name}: expected points of a map, got none. Export it again."
        )
    x, y = points.x, points.y
    levels = _distinct(y)
    row, dy = _indices(points, "Y", y, np.diff(levels), levels[0], 1)
    order = np.lexsort((x, row))
    gaps = np.diff(x[order])[np.diff(row[order]) == 0]
    # Every second row may begin half a step later or earlier.
    firsts = [x[row % 2 == k].min() if (row % 2 == k).any() else x.min() for k in (0, 1)]
    half, dx = _indices(points, "X", x, gaps[gaps > 0], x.min(), 2)
    odd = [np.unique(half[row % 2 == k] % 2) for k in (0, 1)]
    mixed = [k for k in (0, 1) if len(odd[k]) > 1]
    if mixed:
        mine = row % 2 == mixed[0]
        usual = int(np.bincount(half[mine] % 2).argmax())
        k = int(np.flatnonzero(mine & (half % 2 != usual))[0])
        base = x.min() + usual * dx / 2
        raise _off(points, k, "X", x[k], dx, base + dx * np.rint((x[k] - base) / dx))
    shift = 0.0
    if len(odd[0]) and len(odd[1]) and odd[0][0] != odd[1][0]:
        shift = 0.5 if firsts[1] > firsts[0] else -0.5
    column = half // 2
    return _Pixels(row, column, _steps(points, row, column + shift * (row % 2), (dx, dy)), shift)


def _distinct(values: np.ndarray) -> np.ndarray:
    """Different values, ascending; values that differ by single-precision rounding are merged."""
    levels = np.unique(values)
    rounding = 8 * np.finfo(np.float32).eps * float(np.abs(levels).max(initial=0))
    return levels[np.append(True, np.diff(levels) > rounding)]


def _indices(
    points: MapPoints, axis: str, values: np.ndarray, gaps: np.ndarray, start: float, parts: int
) -> tuple[np.ndarray, float]:
    """Number of each coordinate in parts of a step, and the step, estimated from the gaps.

    The step is the median gap or, if most points are missing, the smallest gap.
    """
    gaps = gaps[gaps > 8 * np.finfo(np.float32).eps * float(np.abs(values).max(initial=0))]
    if not len(gaps):
        raise FileFormatError(
            f"{points.name}: expected a map of two or more rows and columns, got {len(values):,} "
            f"points with one {axis}. Export the map as a grid of points, not as a line or a list."
        )
    number, step, off = values, 1.0, np.ones(len(values), dtype=bool)
    for guess in (float(np.median(gaps)), float(gaps.min())):
        step = guess
        for _ in range(3):
            # In a sum of consecutive gaps, only the two end points contribute rounding.
            times = np.rint(gaps / step)
            used = (times > 0) & (np.abs(gaps - times * step) < step / 4)
            step = float(gaps[used].sum() / times[used].sum()) if used.any() else step
        number = np.rint(parts * (values - start) / step)
        off = np.abs(values - start - number * step / parts) > step / (4 * parts)
        lost = np.rint(gaps / step) == 0
        # With a wrong step, half of the points are off by chance; a large one merges neighbours.
        if max(off.mean(), lost.mean()) < 0.25 and number.max() < 2**40:
            break
    else:
        raise FileFormatError(
            f"{points.name}: expected points on a grid, got {len(values):,} points without a "
            f"grid: {axis} has no step. Circuits need neighbours: export a map (job mode Grid)."
        )
    if off.any():
        k = int(np.argmax(off))
        raise _off(
            points, k, axis, values[k], step, start + step * np.rint((values[k] - start) / step)
        )
    return number.astype(np.int64), step


def _off(
    points: MapPoints, k: int, axis: str, found: float, step: float, expected: float
) -> FileFormatError:
    """The error for a point that is not on the grid."""
    return FileFormatError(
        f"{points.name}: {points.where(k)}: expected {axis} = {expected:g} from steps of {step:g}, "
        f"got {found:g}. Steps are mixed: export the map on its full grid."
    )
