"""Blocked map: circuits of a field larger than memory, as dask tasks that fill a Zarr array.

Each block is computed from its own nodes and a halo. It uses the stencils of the whole grid, and
sums that do not depend on the start of the block. Therefore all block sizes give identical bits.
A block is done when its chunk is in the array.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import count, product
from math import inf, prod
from pathlib import Path
from shutil import disk_usage, rmtree
from typing import Any

import numpy as np

from geomtorsion.errors import CheckpointError, FileFormatError, GridError, LimitError
from geomtorsion.materials.fields.cells import circuits, torsion
from geomtorsion.materials.fields.contents import guarded, module
from geomtorsion.materials.fields.grid import (
    check_length,
    check_order,
    other_order,
    periodic_axes,
    several,
    two_axes,
)
from geomtorsion.materials.fields.grid_circuits import Field
from geomtorsion.materials.fields.large_arrays import (
    LargeArray,
    check_finite,
    digest_of_arrays,
    grid_of,
    opened,
)
from geomtorsion.materials.fields.noise import Noise
from geomtorsion.materials.survey import Errors
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.executors import Executor, checked_executor
from geomtorsion.support.files import read_json_text, read_text, written
from geomtorsion.support.progress import PATIENCE, bar

# Largest number of tasks in one dask graph, which takes some kilobytes of memory for each.
MOST_BLOCKS = 100_000
# The attribute of the array that describes its run.
RUN = "geomtorsion"


@dataclass(frozen=True, eq=False)
class Parts:
    """Results of a map in blocks for each circuit (or node).

    vectors: b^i (or torsion), shape (rows, places...). sigmas: its standard deviation from noise,
    same shape. systematic: grid error of the largest component, shape (places...).
    """

    vectors: np.ndarray
    sigmas: np.ndarray
    systematic: np.ndarray

    @classmethod
    def of(cls, values: np.ndarray) -> Parts:
        """Split one array of shape (2 * rows + 1, places...) into its parts."""
        rows = len(values) // 2
        return cls(values[:rows], values[rows:-1], values[-1])

    @property
    def errors(self) -> Errors:
        """Noise and grid error."""
        return Errors({(i, i): row**2 for i, row in enumerate(self.sigmas)}, self.systematic)

    @property
    def error(self) -> np.ndarray:
        """Noise and grid error combined, as in `Burgers.error`, shape (places...)."""
        return np.hypot(np.linalg.norm(self.sigmas, axis=0), self.systematic)


@dataclass(frozen=True, eq=False)
class BlockMap:
    """A map in blocks, the chunks of one Zarr array.

    path: of the array, which has shape (2 * rows + 1, places...). block: places of a block along
    each axis. size: edges along the sides of the circuits, or (0, 0) for torsion at the nodes.
    plane: the two axes. steps, order, periodic: as for `SampledFrame`. sigma: noise of each
    component, shape (rows, columns along the grid). stride: nodes from place to place along each
    axis.
    """

    source: LargeArray
    path: str
    steps: tuple[float, ...]
    block: tuple[int, ...]
    size: tuple[int, int]
    plane: tuple[int, int]
    order: int
    periodic: tuple[bool, ...]
    sigma: np.ndarray
    reference: np.ndarray
    stride: tuple[int, ...]

    @cached_property
    def places(self) -> tuple[int, ...]:
        """Number of places of the map along each axis."""
        every = zip(self.source.shape[2:], self.periodic, self.stride, strict=True)
        return tuple(
            -(-(n if wraps else n - self._sides.get(k, 0)) // stride)
            for k, (n, wraps, stride) in enumerate(every)
        )

    @cached_property
    def _sides(self) -> dict[int, int]:
        """Number of edges along the sides of circuits, by axis of the plane."""
        return dict(zip(self.plane, self.size, strict=True))

    @cached_property
    def numbers(self) -> tuple[tuple[int, ...], ...]:
        """Indices of all blocks, one along each axis."""
        counts = [range(-(-n // b)) for n, b in zip(self.places, self.block, strict=True)]
        return tuple(product(*counts))

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the array, which holds `Parts` for all places."""
        return (2 * self.source.shape[0] + 1, *self.places)

    @property
    def chunks(self) -> tuple[int, ...]:
        """Shape of the chunks of the array, one for each block."""
        return (self.shape[0], *self.block)

    def file(self, number: Sequence[int]) -> Path:
        """Path of the chunk of a block."""
        return Path(self.path, "c", "0", *map(str, number))

    def is_done(self, number: Sequence[int]) -> bool:
        """Whether the chunk of a block is complete: all chunks have equal size, also at edges."""
        file = self.file(number)
        return file.is_file() and file.stat().st_size == 8 * prod(self.chunks)

    @property
    def done(self) -> list[tuple[int, ...]]:
        """The finished blocks."""
        return [number for number in self.numbers if self.is_done(number)]

    def span(self, number: Sequence[int]) -> tuple[tuple[int, int], ...]:
        """First place of a block along each axis, and the first place after the block."""
        triples = zip(number, self.block, self.places, strict=True)
        return tuple((k * b, min((k + 1) * b, n)) for k, b, n in triples)

    def compute(self, number: tuple[int, ...]) -> None:
        """Compute one block of the map and write it to its chunk, as one array of `Parts`."""
        low, values = self._read(number, beside_holes=False)
        if np.isnan(values).any():
            low, values = self._read(number, beside_holes=True)
        check_finite(values, low)
        parts = self._of(self._field(values))
        inner = [
            slice(first * stride - begin, (last - 1) * stride + 1 - begin, stride)
            for (first, last), stride, begin in zip(
                self.span(number), self.stride, low, strict=True
            )
        ]
        with _writing(Path(self.path)):
            array = module("zarr", Path(self.path)).open_array(self.path, mode="r+")
            array[self._region(number)] = parts[(slice(None), *inner)]

    def _region(self, number: Sequence[int]) -> tuple[slice, ...]:
        """Slices of a block in the array."""
        return (slice(None), *(slice(*ends) for ends in self.span(number)))

    def _read(self, number: Sequence[int], beside_holes: bool) -> tuple[list[int], np.ndarray]:
        """First node along each axis, and the values of all nodes that a block needs."""
        ends = [
            self._reach(k, first * stride, (last - 1) * stride, beside_holes)
            for k, ((first, last), stride) in enumerate(
                zip(self.span(number), self.stride, strict=True)
            )
        ]
        low = [begin for begin, _ in ends]
        values = self.source.read(low, [end for _, end in ends])
        return low, values[:, : len(self.source.shape[2:])]

    def _reach(self, axis: int, first: int, last: int, beside_holes: bool) -> tuple[int, int]:
        """The first node needed by the places from first to last, and the node after the last.

        The halo of centred stencils has order / 2 - 1 nodes for circuits and order / 2 nodes for
        torsion, and none normal to the plane. Stencils are one-sided at the ends of the grid and
        next to holes.
        """
        n, slopes = self.source.shape[2:][axis], self.size == (0, 0)
        if axis not in self.plane:
            return first, last + 1
        if not slopes:
            last += self._sides[axis] - 1
        nodes = max(self.order, other_order(self.order)) + slopes
        if beside_holes:
            begin, end = first - nodes + 2 - slopes, last + nodes
            return (begin, end) if self.periodic[axis] else (max(begin, 0), min(end, n))
        begin, end = (k - (nodes - 1) // 2 for k in (first, last))
        if not self.periodic[axis]:
            begin, end = (min(max(k, 0), n - nodes) for k in (begin, end))
        return begin, end + nodes

    def _field(self, values: np.ndarray) -> Field:
        """A block with its halo as a separate field, minus the common reference."""
        grid = grid_of(values, self.steps)
        bent = values - self.reference.reshape(*self.reference.shape, *(1,) * len(self.steps))
        bent[:, :, grid.holes] = 0
        noise = None
        if self.sigma.any():
            noise = Noise.of_sigma(self.sigma.reshape(*self.sigma.shape, *(1,) * len(self.steps)))
        return Field(grid, bent, self.reference, noise, self.order, other_order(self.order), 0.0)

    def _of(self, field: Field) -> np.ndarray:
        """The map of a field: `Parts` as one array."""
        if self.size == (0, 0):
            curl, difference, sigmas = torsion(field, self.plane)
            return np.concatenate([curl, sigmas, difference.max(axis=0)[None]])
        # A block does not contain the whole ring of each hole.
        blocks = circuits(field, self.plane, self.size)
        vectors, errors = blocks.vectors, blocks.estimate()
        sigmas = np.zeros(vectors.shape)
        for i, row in enumerate(sigmas):
            row += np.sqrt(np.maximum(errors.covariance.get((i, i), 0.0), 0.0))
        unknown = np.isnan(vectors).any(axis=0)
        sigmas[:, unknown] = np.nan
        systematic = np.where(unknown, np.nan, errors.systematic)
        return np.concatenate([vectors, sigmas, systematic[None]])

    def read(self) -> np.ndarray:
        """Read the whole map, shape (rows + 1, places...): b^i (or torsion), then the error.

        Raises
        ------
        CheckpointError
            Blocks are missing.
        """
        values = np.empty((self.source.shape[0] + 1, *self.places))
        for number, parts in self:
            values[self._region(number)] = np.concatenate([parts.vectors, parts.error[None]])
        return values

    def __iter__(self) -> Iterator[tuple[tuple[int, ...], Parts]]:
        """Iterate over the indices of all blocks and their content.

        Raises
        ------
        CheckpointError
            Blocks are missing.
        """
        if len(self.done) < len(self.numbers):
            raise CheckpointError(
                f"{self.path}: expected {len(self.numbers):,} finished blocks, got "
                f"{len(self.done):,}. Call blocked_map again to compute the missing blocks."
            )
        for number in self.numbers:
            yield number, Parts.of(self.part(self._region(number)))

    def part(self, index: tuple[Any, ...]) -> np.ndarray:
        """A part of the array on disk, shape (2 * rows + 1, places...), which holds `Parts`."""
        return guarded(Path(self.path), lambda: opened(self.path, again=True)[index])

    @property
    def _digest(self) -> str:
        """SHA-256 of the nodes that the first, the middle and the last block need."""
        numbers = self.numbers
        chosen = sorted({0, len(numbers) // 2, len(numbers) - 1})
        return digest_of_arrays(self._read(numbers[k], beside_holes=False)[1] for k in chosen)

    @property
    def described(self) -> dict[str, Any]:
        """Description of the run as JSON data; a map is resumed only if it has an equal one."""
        names = ("steps", "block", "size", "plane", "order", "periodic", "stride")
        return {
            "digest": self.source.digest or self._digest,
            "shape": list(self.source.shape),
            "sigma": self.sigma.tolist(),
            "reference": [[float(x).hex() for x in row] for row in self.reference],
        } | {name: np.array(getattr(self, name)).tolist() for name in names}

    def __repr__(self) -> str:
        places = " x ".join(map(str, self.places))
        return f"BlockMap({places} places, {len(self.done)} of {len(self.numbers)} blocks done)"


def blocked_map(
    source: Any,
    path: str | Path,
    steps: Sequence[float],
    block: int | Sequence[int],
    size: int | Sequence[int] = 1,
    plane: tuple[int, int] = (0, 1),
    order: int = 4,
    *,
    periodic: Any = (),
    sigma: float | np.ndarray = 0.0,
    stride: int | Sequence[int] = 1,
    overwrite: bool = False,
    executor: Executor | None = None,
) -> BlockMap:
    """Burgers vectors of circuits at all positions of a field larger than memory, block by block.

    Blocks are dask tasks, run by `executor` or as configured in dask. A task takes about ten times
    the memory of its block and halo.

    Parameters
    ----------
    source
        The coframe, shape (rows, columns, N_1, ..., N_d), NaN in holes: the path of an .npy file or
        a Zarr array, or an array of NumPy, Zarr or dask. Circuits that meet a hole are NaN: only
        `SampledFrame.burgers_map` goes around missing nodes.
    path
        Path of the Zarr array for the map. A killed run is resumed there.
    steps
        Spacing of each axis.
    block
        Places in a block along each axis, one number or one for each. It changes the memory, not
        the values.
    size
        Cells along the sides of the circuits; 0: the torsion at all nodes instead.
    sigma
        Standard deviation of the noise of each value: one number, or one for each component, shape
        (rows, columns along the grid). The errors do not include rounding.
    stride
        Nodes from place to place, for each axis: the size gives adjacent circuits.
    overwrite
        Replace an existing map.
    executor
        Computes the blocks, see `burgers_vectors`; by default as configured in dask.

    Raises
    ------
    GridError
        Steps, size or block do not fit the grid.
    CheckpointError
        The path holds other data, or the map of another run.
    LimitError
        The disk is too small for the map, or a process ended before its work was done.
    MissingExtraError
        dask or zarr is not installed; both are in the extra `cluster`.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> y, x = np.mgrid[:40, :30].astype(float)
    >>> with TemporaryDirectory() as folder:
    ...     field = np.array([[-x, y]]) / 2
    ...     result = blocked_map(field, f"{folder}/map.zarr", (1, 1), block=16, size=4)
    ...     result, result.read()[0].round(9).max()
    (BlockMap(36 x 26 places, 6 of 6 blocks done), np.float64(16.0))
    """
    check_order(order)
    checked_executor(executor)
    place = checks.file_name(path)
    array = LargeArray.of(source)
    grid = array.shape[2:]
    d = len(grid)
    spacing = checks.numbers(steps, d, "steps", GridError)
    for k, step in enumerate(spacing):
        positive = checks.positive(step, f"steps[{k}]", GridError)
        checks.measured(positive, f"steps[{k}]", GridError, is_length=True)
    names = tuple("xyzuvw"[:d])
    wraps = periodic_axes(periodic, names)
    pair = two_axes(plane, d)
    sides = several(size, 2, "size", 0)
    if 0 in sides and sides != (0, 0):
        raise GridError(
            "size: size 0 means a map of torsion; give 0 for both axes or for neither, not "
            f"{checks.shown(size)}."
        )
    for k, side in zip(pair, sides, strict=True):
        checks.count(side, "size", GridError, 0, grid[k] - 1)
    blocks = several(block, d, "block", 1)
    check_length(names, grid, order)
    components = (array.shape[0], d)
    blocks_needed = prod(-(-n // b) for n, b in zip(grid, blocks, strict=True))
    if blocks_needed > MOST_BLOCKS:
        raise LimitError(
            f"block: expected at most {MOST_BLOCKS:,} blocks, got {blocks_needed:,} for the shape "
            f"{array.shape}. Give larger blocks, or a part of the field."
        )
    noise = checks.measured(checks.array(sigma, "sigma", GridError), "sigma", GridError)
    if noise.shape not in ((), components) or (noise < 0).any():
        raise GridError(
            f"sigma: expected 0 or more, as one number or in shape {components}, got "
            f"{checks.shown(sigma)}."
        )
    # One reference for all blocks: the integral of a constant part is exactly zero, unrounded.
    reference = np.nan_to_num(array.read((0,) * d, (1,) * d).reshape(*array.shape[:2]))[:, :d]
    block_map = BlockMap(
        array, str(place), tuple(map(float, spacing)), blocks, (sides[0], sides[1]),
        pair, order, wraps, np.broadcast_to(noise, components), reference,
        several(stride, d, "stride", 1),
    )  # fmt: skip
    _open(block_map, overwrite)
    left = [number for number in block_map.numbers if not block_map.is_done(number)]
    for number in left:
        block_map.file(number).unlink(missing_ok=True)
    _run(block_map, left, executor)
    return block_map


def run_in(path: Path) -> dict[str, Any] | None:
    """The description of the run in a Zarr array; None if there is no such array."""
    try:
        content = read_json_text(read_text(path / "zarr.json"), str(path))
    except FileFormatError:
        return None
    attributes = content.get("attributes") if isinstance(content, dict) else None
    described = attributes.get(RUN) if isinstance(attributes, dict) else None
    return described if isinstance(described, dict) else None


def _open(made: BlockMap, overwrite: bool) -> None:
    """Create the array of a map, or check that the array at its path belongs to the same run."""
    path, described = Path(made.path), made.described
    there = run_in(path)
    if there is not None and overwrite:
        with _writing(path):
            rmtree(path)
        there = None
    elif there is not None:
        differ = [key for key, value in described.items() if there.get(key) != value]
        array = opened(made.path, again=True)
        if differ or (array.shape, array.chunks) != (made.shape, made.chunks):
            raise CheckpointError(
                f"{path}: expected the map of this run, got the map of another run, which "
                f"differs in {', '.join(differ) or 'shape'}. Name another path, give the same "
                "arguments, or overwrite the map."
            )
        # A killed process leaves a partial chunk.
        for part in path.rglob("*.partial"):
            part.unlink()
    elif path.exists() and not (path.is_dir() and not any(path.iterdir())):
        raise CheckpointError(
            f"{path}: expected a map in blocks or a new path, got other files. Name another path."
        )
    with written(path.parent, is_folder=True):
        free = disk_usage(path.parent).free
    needed = 8 * prod(made.chunks) * (len(made.numbers) - len(made.done))
    if needed > free:
        raise LimitError(
            f"{path}: expected {needed:,} free bytes for the blocks of the map, got {free:,}. Free "
            "some space, name another disk, or give a part of the field."
        )
    if there is None:
        with _writing(path):
            # Zarr omits chunks that equal the fill value; a block inside a hole is all NaN.
            module("zarr", path).create_array(
                made.path, shape=made.shape, chunks=made.chunks, dtype="float64", fill_value=inf,
                compressors=None, zarr_format=3, attributes={RUN: described},
            )  # fmt: skip


@contextmanager
def _writing(path: Path) -> Iterator[None]:
    """Convert system errors while writing a Zarr array into errors of this package."""
    try:
        yield
    except OSError as error:
        if isinstance(error, FileFormatError):
            raise
        raise FileFormatError(
            f"{path}: the map cannot be written: {error.strerror or error}. Check the folder and "
            "its free space, or name another disk."
        ) from None


def _run(made: BlockMap, left: Sequence[tuple[int, ...]], executor: Executor | None) -> None:
    """Compute blocks as dask tasks."""
    dask = module("dask", Path(made.path))
    task = dask.delayed(BlockMap.compute, pure=False)
    delayed_map = dask.delayed(made, pure=False, traverse=False)
    with bar(f"{len(left)} blocks", len(left), patience=PATIENCE) as show:
        finished = count(1)

        def seen(*_: object) -> None:
            if show is not None:
                show(min(next(finished), len(left)))

        try:
            with module("dask.callbacks", Path(made.path)).Callback(posttask=seen):
                dask.compute(*[task(delayed_map, number) for number in left], scheduler=executor)
        except BrokenProcessPool:
            raise LimitError(
                "a worker process ended before its work was done, probably because memory ran out. "
                "Use fewer workers or smaller blocks; the same call resumes the run. A script that "
                'uses processes needs `if __name__ == "__main__":` around its calls.'
            ) from None
