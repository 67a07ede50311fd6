"""Blocks: maps of fields larger than memory, block by block, with a ledger of what is done.

Every block is computed from its own nodes and a halo, with the stencils that the whole grid would
have there, and sums that do not depend on where a block begins: any size of blocks gives the same
bits, and so does a run that was killed and taken up again.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from math import prod
from pathlib import Path
from shutil import disk_usage
from typing import Any

import numpy as np

from geomtorsion import checks
from geomtorsion.errors import CheckpointError, GridError, LimitError
from geomtorsion.loops.quadrature import PIECE
from geomtorsion.materials.blocks import (
    digest_of_arrays,
    open_ledger,
    read_array,
    run_blocks,
    write_array,
)
from geomtorsion.materials.fields.cells import circuits, torsion
from geomtorsion.materials.fields.circuits import Field
from geomtorsion.materials.fields.grid import (
    Grid,
    check_length,
    check_order,
    other_order,
    periodic_axes,
)
from geomtorsion.materials.fields.noise import (
    SMOOTH,
    Noise,
    estimated_from_parts,
    independent_significances,
)
from geomtorsion.materials.fields.sources import Source

# Nodes from which noise is estimated, some ten megabytes, and nodes of each window of a larger
# field: the median over so many has an error of half a per cent.
SAMPLE, WINDOW = 8 * PIECE, PIECE // 8
# Files in one folder, whose numbers are in memory: more than any disk has room for, with blocks as
# large as they are made by themselves.
MOST_BLOCKS = 1_000_000


@dataclass(frozen=True, eq=False)
class Parts:
    """What a map in blocks keeps of each circuit (or node).

    vectors: b^i (or torsion); sigmas: its standard deviation by noise; shape (rows, places...).
    interpolation: the error of the grid, of the largest component, shape (places...).
    """

    vectors: np.ndarray
    sigmas: np.ndarray
    interpolation: np.ndarray

    @classmethod
    def of(cls, values: np.ndarray) -> Parts:
        """The parts of one array of shape (2 * rows + 1, places...)."""
        rows = len(values) // 2
        return cls(values[:rows], values[rows:-1], values[-1])

    @property
    def errors(self) -> np.ndarray:
        """Noise (one standard deviation) and grid together, of the largest component."""
        return np.hypot(self.interpolation, self.sigmas.max(axis=0))

    @property
    def significance(self) -> np.ndarray:
        """|b| in units of its errors, as for `Plaquettes`."""
        return independent_significances(self.vectors, self.sigmas, self.interpolation)


@dataclass(frozen=True, eq=False)
class BlockMap:
    """A map in blocks, one file each in a folder.

    folder: of the blocks and the ledger. block: places in each block along each axis.
    size: edges of the circuits, or (0, 0) for torsion at the nodes; plane: the two axes.
    steps, order, periodic: as for `SampledFrame`. sigma: noise of each component, shape
    (rows, columns along the grid). stride: nodes from one place to the next along each axis.
    """

    source: Source
    folder: str
    steps: tuple[float, ...]
    block: tuple[int, ...]
    size: tuple[int, int]
    plane: tuple[int, int]
    order: int
    periodic: tuple[bool, ...]
    sigma: np.ndarray
    reference: np.ndarray
    stride: tuple[int, ...]

    @property
    def grid_shape(self) -> tuple[int, ...]:
        """Nodes along each axis."""
        return self.source.shape[2:]

    @cached_property
    def places(self) -> tuple[int, ...]:
        """Places of the map along each axis."""
        every = zip(self.grid_shape, self.periodic, self.stride, strict=True)
        return tuple(
            -(-(n if wraps else n - self._sides.get(k, 0)) // stride)
            for k, (n, wraps, stride) in enumerate(every)
        )

    @cached_property
    def _sides(self) -> dict[int, int]:
        """Edges along the sides of circuits, by axis of the plane."""
        return dict(zip(self.plane, self.size, strict=True))

    @cached_property
    def numbers(self) -> tuple[tuple[int, ...], ...]:
        """Number of every block along each axis."""
        counts = [range(-(-n // b)) for n, b in zip(self.places, self.block, strict=True)]
        return tuple(product(*counts))

    def file(self, number: Sequence[int]) -> Path:
        """Where a block is kept."""
        return Path(self.folder, f"block-{'-'.join(map(str, number))}.npy")

    @property
    def done(self) -> list[tuple[int, ...]]:
        """The blocks that are finished."""
        return [number for number in self.numbers if self.file(number).is_file()]

    def span(self, number: Sequence[int]) -> tuple[tuple[int, int], ...]:
        """First place of a block along each axis, and the first one behind it."""
        triples = zip(number, self.block, self.places, strict=True)
        return tuple((k * b, min((k + 1) * b, n)) for k, b, n in triples)

    def compute(self, number: tuple[int, ...]) -> tuple[int, ...]:
        """One block of the map, written to its file: `Parts` as one array."""
        low, values = self._read(number, beside_holes=False)
        if np.isnan(values).any():
            low, values = self._read(number, beside_holes=True)
        _check_finite(values, low)
        found = self._of(self._field(values))
        inner = [
            slice(first * stride - begin, (last - 1) * stride + 1 - begin, stride)
            for (first, last), stride, begin in zip(
                self.span(number), self.stride, low, strict=True
            )
        ]
        write_array(self.file(number), found[(slice(None), *inner)])
        return number

    def _read(self, number: Sequence[int], beside_holes: bool) -> tuple[list[int], np.ndarray]:
        """First node along each axis, and the values of all that a block is computed from."""
        ends = [
            self._reach(k, first * stride, (last - 1) * stride, beside_holes)
            for k, ((first, last), stride) in enumerate(
                zip(self.span(number), self.stride, strict=True)
            )
        ]
        low = [begin for begin, _ in ends]
        values = self.source.read(low, [end for _, end in ends])
        return low, values[:, : len(self.grid_shape)]

    def _reach(self, axis: int, first: int, last: int, beside_holes: bool) -> tuple[int, int]:
        """The first node, and the first one behind, that places from first to last need.

        The halo of centred stencils: order / 2 - 1 nodes for circuits, order / 2 for torsion, none
        across the plane. At an end of the grid and beside holes they lie on one side.
        """
        n, slopes = self.grid_shape[axis], self.size == (0, 0)
        if axis not in self.plane:
            return first, last + 1
        if not slopes:
            last += self._sides[axis] - 1
        nodes = max(self.order, self._other) + slopes
        if beside_holes:
            begin, end = first - nodes + 2 - slopes, last + nodes
            return (begin, end) if self.periodic[axis] else (max(begin, 0), min(end, n))
        begin, end = (k - (nodes - 1) // 2 for k in (first, last))
        if not self.periodic[axis]:
            begin, end = (min(max(k, 0), n - nodes) for k in (begin, end))
        return begin, end + nodes

    @property
    def _other(self) -> int:
        """The order against which errors are measured."""
        return other_order(self.order)

    def _field(self, values: np.ndarray) -> Field:
        """A block with its halo as a field of its own, less what is subtracted everywhere."""
        grid = _grid_of(values, self.steps)
        bent = values - self.reference.reshape(*self.reference.shape, *(1,) * len(self.steps))
        bent[:, :, grid.holes] = 0
        noise = None
        if self.sigma.any():
            noise = Noise.of_sigma(self.sigma.reshape(*self.sigma.shape, *(1,) * len(self.steps)))
        return Field(grid, bent, self.reference, noise, self.order, self._other, 0.0)

    def _of(self, field: Field) -> np.ndarray:
        """The map of a field: `Parts` as one array."""
        if self.size == (0, 0):
            curl, difference, sigmas = torsion(field, self.plane)
            return np.concatenate([curl, sigmas, difference.max(axis=0)[None]])
        found = circuits(field, self.plane, self.size)
        return np.concatenate([found.vectors, found.sigmas, found.interpolation[None]])

    def read(self) -> np.ndarray:
        """The whole map, shape (rows + 1, places...): b^i (or torsion), and last the error.

        Raises
        ------
        CheckpointError
            Blocks are missing.
        """
        missing = len(self.numbers) - len(self.done)
        if missing:
            raise CheckpointError(
                f"{self.folder}: {missing} of {len(self.numbers)} blocks are missing. Call "
                "blocked_map again: it goes on where it ended."
            )
        found = np.empty((self.source.shape[0] + 1, *self.places))
        for number, values in self:
            parts = Parts.of(values)
            whole = np.concatenate([parts.vectors, parts.errors[None]])
            found[(slice(None), *(slice(*ends) for ends in self.span(number)))] = whole
        return found

    def __iter__(self) -> Iterator[tuple[tuple[int, ...], np.ndarray]]:
        """The finished blocks one by one, each `Parts` as one array."""
        for number in self.done:
            yield number, np.load(self.file(number), allow_pickle=False)

    @property
    def _digest(self) -> str:
        """Of what the first, the middle and the last block are computed from."""
        numbers = self.numbers
        chosen = sorted({0, len(numbers) // 2, len(numbers) - 1})
        return digest_of_arrays(self._read(numbers[k], beside_holes=False)[1] for k in chosen)

    @property
    def ledger(self) -> dict[str, Any]:
        """What a run must have in common with the one that it takes up."""
        given = self.source.given
        return {
            "source": given if isinstance(given, str) else type(given).__name__,
            "digest": self.source.digest or self._digest,
            "shape": list(self.source.shape),
            "steps": list(self.steps),
            "block": list(self.block),
            "size": list(self.size),
            "plane": list(self.plane),
            "order": self.order,
            "periodic": list(self.periodic),
            "sigma": self.sigma.tolist(),
            "stride": list(self.stride),
            "reference": [[float(x).hex() for x in row] for row in self.reference],
        }

    def __repr__(self) -> str:
        places = " x ".join(map(str, self.places))
        return f"BlockMap({places} places, {len(self.done)} of {len(self.numbers)} blocks done)"


def blocked_map(
    source: Any,
    folder: str | Path,
    steps: Sequence[float],
    block: int | Sequence[int],
    size: int | Sequence[int] = 1,
    plane: tuple[int, int] = (0, 1),
    order: int = 4,
    *,
    shape: Sequence[int] | None = None,
    periodic: Any = (),
    sigma: float | np.ndarray = 0.0,
    stride: int | Sequence[int] = 1,
    workers: int = 1,
    client: Any = None,
) -> BlockMap:
    """Burgers vectors of circuits at every place of a field larger than memory, block by block.

    Parameters
    ----------
    source
        The coframe, shape (rows, columns, N_1, ..., N_d), NaN in holes: an array (also a mapped
        one), the path of an .npy file or a Zarr array (extra `cluster`), or a function that takes
        slices of the grid and returns the values there.
    folder
        Where blocks are kept, one file each. A run that was killed goes on there.
    steps
        Spacing of each axis.
    block
        Places in a block along each axis, one number or one for each. It decides about memory, not
        about values.
    size
        Cells along the sides of the circuits; 0: the torsion at all nodes instead.
    sigma
        Standard deviation of the noise of every value: one number, or one for each component, shape
        (rows, columns along the grid). Rounding is not in the errors.
    stride
        Nodes from one place to the next, one number or one for each axis: the size, for circuits
        that lie side by side.
    workers
        Processes on this machine (the source must then be a path or can be sent to others). A
        script asks for them below ``if __name__ == "__main__":``, since each reads it again.
    client
        A `dask.distributed.Client`, which runs one task for each block on its workers.

    Raises
    ------
    GridError
        Steps, size or block fit no grid.
    CheckpointError
        The folder holds blocks of another run.
    LimitError
        A process ended before its work was done.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> y, x = np.mgrid[:40, :30].astype(float)
    >>> with TemporaryDirectory() as folder:
    ...     found = blocked_map(np.array([[-x, y]]) / 2, folder, (1, 1), block=16, size=4)
    ...     found, found.read()[0].round(9).max()
    (BlockMap(36 x 26 places, 6 of 6 blocks done), np.float64(16.0))
    """
    made = _checked(
        source, folder, steps, block, size, plane, order, shape, periodic, sigma, stride
    )
    checks.count(workers, "workers", GridError, 1)
    _open_ledger(made)
    left = [number for number in made.numbers if not made.file(number).is_file()]
    _check_disk(made, left)
    run_blocks(made.compute, left, workers, client)
    return made


def estimated_sigma(source: Source) -> np.ndarray:
    """Noise of each component, shape (rows, columns along the grid), from a sample of the field.

    The estimate is that of `SampledFrame(sigma="estimate")`, from all nodes of a small field, and
    from windows spread evenly over a large one.
    """
    shape = source.shape[2:]
    d = len(shape)
    windows = [[(0, n)] for n in shape]
    if prod(shape) > SAMPLE:
        # Windows as wide as sixth differences need, or wider.
        side = max(SMOOTH + 1, round(WINDOW ** (1 / d)))
        count = max(2, round((SAMPLE / WINDOW) ** (1 / d)))
        sides = [min(n, side) for n in shape]
        windows = [
            [(int(k), int(k) + m) for k in np.unique(np.linspace(0, n - m, count).astype(int))]
            for n, m in zip(shape, sides, strict=True)
        ]
    parts = []
    for window in product(*windows):
        low, high = zip(*window, strict=True)
        values = source.read(low, high)[:, :d]
        _check_finite(values, low)
        parts.append((values, _grid_of(values, (1.0,) * d)))
    return estimated_from_parts(parts).reshape(source.shape[0], d)


def _grid_of(values: np.ndarray, steps: tuple[float, ...]) -> Grid:
    """The grid of a block with its holes."""
    shape = values.shape[2:]
    holes = np.asarray(np.isnan(values).any(axis=(0, 1)))
    axes = tuple(np.arange(float(n)) for n in shape)
    return Grid(axes, tuple("xyzuvw"[: len(shape)]), (False,) * len(shape), holes, steps)


def _check_finite(values: np.ndarray, low: Sequence[int]) -> None:
    """Refuse infinite values in a block whose first node is low."""
    if np.isinf(values).any():
        place = np.argwhere(np.isinf(values))[0, 2:] + low
        raise GridError(
            f"source: finite values were needed, but one is infinite at node "
            f"{tuple(place.tolist())}. Write NaN where nothing is known."
        )


def _checked(
    source: Any,
    folder: str | Path,
    steps: Sequence[float],
    block: int | Sequence[int],
    size: int | Sequence[int],
    plane: tuple[int, int],
    order: int,
    shape: Sequence[int] | None,
    periodic: Any,
    sigma: float | np.ndarray,
    stride: int | Sequence[int],
) -> BlockMap:
    """Everything that was given, looked at once."""
    check_order(order)
    found = Source.of(source, shape)
    grid = found.shape[2:]
    d = len(grid)
    spacing = checks.numbers(steps, d, "steps", GridError)
    for k, step in enumerate(spacing):
        checks.positive(step, f"steps[{k}]", GridError)
    names = tuple("xyzuvw"[:d])
    wraps = periodic_axes(periodic, names)
    pair = checks.entries(plane, "plane", GridError)
    if len(pair) != 2 or pair[0] == pair[1] or not set(pair) <= set(range(d)):
        raise GridError(
            f"plane: two different axes from 0 to {d - 1} were needed, but {plane!r} came."
        )
    sides = _several(size, 2, "size", 0)
    if 0 in sides and sides != (0, 0):
        raise GridError(f"size: 0 for both axes (torsion) or for none was needed, not {size}.")
    for k, side in zip(pair, sides, strict=True):
        checks.count(side, "size", GridError, 0, grid[k] - 1)
    blocks = _several(block, d, "block", 1)
    check_length(names, grid, order)
    components = (found.shape[0], d)
    blocks_needed = prod(-(-n // b) for n, b in zip(grid, blocks, strict=True))
    if blocks_needed > MOST_BLOCKS:
        raise LimitError(
            f"block: expected at most {MOST_BLOCKS:,} blocks, got {blocks_needed:,} for the shape "
            f"{found.shape}. Give larger blocks, or a part of the field."
        )
    noise = checks.array(sigma, "sigma", GridError)
    if noise.shape not in ((), components) or (noise < 0).any():
        raise GridError(
            f"sigma: 0 or more was needed, as one number or in shape {components}, but "
            f"{checks.shown(sigma)} came."
        )
    # The same everywhere, so that blocks agree: a constant part closes exactly, unrounded.
    reference = np.nan_to_num(found.read((0,) * d, (1,) * d).reshape(*found.shape[:2]))[:, :d]
    return BlockMap(
        found, str(folder), tuple(map(float, spacing)), blocks, (sides[0], sides[1]),
        (pair[0], pair[1]), order, wraps, np.broadcast_to(noise, components), reference,
        _several(stride, d, "stride", 1),
    )  # fmt: skip


def _several(given: Any, count: int, name: str, least: int) -> tuple[int, ...]:
    """One whole number for all, or one for each."""
    entries = checks.rows(given)
    rows = list(entries) if isinstance(entries, list | tuple) else [given] * count
    if len(rows) != count:
        raise GridError(
            f"{name}: one number or {count} were needed, but {checks.shown(given)} came."
        )
    return tuple(checks.count(n, name, GridError, least) for n in rows)


def _check_disk(made: BlockMap, left: Sequence[Sequence[int]]) -> None:
    """Refuse a map whose blocks find no room: not after hours of work."""
    places = sum(prod(b - a for a, b in made.span(number)) for number in left)
    needed = 8 * (2 * made.source.shape[0] + 1) * places
    free = disk_usage(made.folder).free
    if needed > free:
        raise LimitError(
            f"{made.folder}: expected {needed:,} free bytes for the blocks of the map, got "
            f"{free:,}. Make room, name another disk, or give a part of the field."
        )


def _open_ledger(made: BlockMap) -> None:
    """Begin a folder, or take up what is in it."""
    if not open_ledger(Path(made.folder), made.ledger):
        return
    expected = prod(made.block) * (2 * made.source.shape[0] + 1) * 8
    for number in made.done:
        # A file that somebody has cut is done again.
        if made.file(number).stat().st_size > expected + 1000 or not _whole(made, number):
            made.file(number).unlink()


def _whole(made: BlockMap, number: tuple[int, ...]) -> bool:
    """Whether a block has the size that it must have."""
    wanted = (2 * made.source.shape[0] + 1, *(b - a for a, b in made.span(number)))
    return read_array(made.file(number), wanted) is not None
