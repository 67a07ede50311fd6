"""Sorted atoms: positions on disk by blocks of space, of which any neighbourhood can be read."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from pathlib import Path

import numpy as np
import scipy  # loads its parts when they are asked for

from geomtorsion.errors import CheckpointError
from geomtorsion.materials.blocks import read_array, write_array
from geomtorsion.materials.crystals.atom_slabs import AtomSlabs
from geomtorsion.materials.crystals.triangulation import Cell

Block = tuple[int, int, int]


@dataclass(frozen=True, eq=False)
class Part:
    """Some atoms, in the order of their numbers and then of their images.

    numbers: shape (k,); places: positions with their images, shape (k, 3); images: how many periods
    further each is, shape (k, 3).
    """

    numbers: np.ndarray
    places: np.ndarray
    images: np.ndarray

    def __getitem__(self, chosen: np.ndarray) -> Part:
        """Some of them."""
        return Part(self.numbers[chosen], self.places[chosen], self.images[chosen])

    @property
    def order(self) -> np.ndarray:
        """That of their numbers and then of their images: rows, shape (k,)."""
        if not len(self.numbers):
            return self.numbers
        low = self.images.min(axis=0)
        x, y, z = (self.images - low).T
        _, b, c = (self.images.max(axis=0) - low + 1).tolist()
        code = (x * b + y) * c + z
        # Parts are in order: to merge them is much faster than to sort by four columns.
        return np.argsort(self.numbers * (int(code.max()) + 1) + code, kind="stable")

    @classmethod
    def stacked(cls, parts: list[Part]) -> Part:
        """Several, one after another."""
        none = np.zeros((0, 3))
        numbers = np.concatenate([np.zeros(0, dtype=np.int64), *(x.numbers for x in parts)])
        places = np.concatenate([none, *(x.places for x in parts)])
        images = np.concatenate([none.astype(np.int64), *(x.images for x in parts)])
        return cls(numbers, places, images)

    @classmethod
    def joined(cls, parts: list[Part]) -> Part:
        """Several, put in order."""
        whole = cls.stacked(parts)
        return whole[whole.order]


@dataclass(frozen=True, eq=False)
class Only:
    """Some of the atoms in blocks, those of one grain.

    owner: path of the grain of each atom, by number. grain: which. blocks: those where it is.
    """

    owner: str
    grain: int
    blocks: tuple[Block, ...]


@dataclass(frozen=True, eq=False)
class SortedAtoms:
    """Atoms on disk, sorted into blocks of space slab by slab.

    folder: of the files. cell: the cell. counts: blocks along each edge of the cell, a whole number
    where it repeats, since the same size goes on outside of it where it is open. only: of all these
    atoms those that are meant, if not all.
    """

    folder: str
    cell: Cell
    counts: tuple[float, float, float]
    only: Only | None = None

    @classmethod
    def sized(cls, folder: Path, cell: Cell, block: float) -> SortedAtoms:
        """With blocks about as wide as a length."""
        shares = cell.heights / block
        x, y, z = np.where(cell.periodic, np.maximum(np.rint(shares), 1), shares).tolist()
        return cls(str(folder), cell, (x, y, z))

    def _file(self, number: int, what: str) -> Path:
        """A file of a slab."""
        return Path(self.folder, f"slab-{number:06}-{what}.npy")

    def sort(self, slabs: AtomSlabs) -> None:
        """Sort all that is not yet sorted."""
        done = Path(self.folder, "sorted.npy")
        if read_array(done, (1,), np.int64) is not None:
            return
        first = last = 0
        for last, positions in enumerate(slabs, 1):
            # The index comes last: where it is, all is.
            if read_array(self._file(last - 1, "index"), (None, 5), np.int64) is None:
                self._sort_one(last - 1, first, positions)
            first += len(positions)
        write_array(done, np.array([last], dtype=np.int64))

    def _sort_one(self, number: int, first: int, positions: np.ndarray) -> None:
        """One slab, whose first atom has a number."""
        places, _ = self.cell.wrapped(positions)
        shares = places @ self.cell.inverse
        blocks = np.floor(shares * self.counts).astype(np.int64)
        # Rounding may leave an atom on the face at which the next period begins.
        inner = np.clip(blocks, 0, np.array(self.counts) - 1)
        blocks = np.where(self.cell.periodic, inner, blocks).astype(np.int64)
        order = np.lexsort((*blocks.T[::-1],))
        blocks = blocks[order]
        new = np.flatnonzero(np.r_[True, (np.diff(blocks, axis=0) != 0).any(axis=1)])
        index = np.column_stack([blocks[new], new, np.append(new[1:], len(order))])
        ends = np.stack([shares.min(axis=0), shares.max(axis=0)])
        write_array(self._file(number, "places"), places[order])
        write_array(self._file(number, "numbers"), first + order)
        write_array(self._file(number, "ends"), ends)
        write_array(self._file(number, "index"), index)

    def _whole(self, path: Path, shape: tuple[int | None, ...], dtype: type = float) -> np.ndarray:
        """A file that must be there."""
        found = read_array(path, shape, dtype)
        if found is None:
            raise CheckpointError(
                f"{path}: sorted atoms were needed, but the file is missing or damaged. Take an "
                "empty folder."
            )
        return found

    @cached_property
    def _slabs(self) -> int:
        """How many slabs there are."""
        return int(self._whole(Path(self.folder, "sorted.npy"), (1,), np.int64)[0])

    @cached_property
    def _index(self) -> dict[Block, list[tuple[int, int, int]]]:
        """Where the atoms of each block are: slab, first row, and first row behind."""
        found: dict[Block, list[tuple[int, int, int]]] = {}
        for slab in range(self._slabs):
            index = self._whole(self._file(slab, "index"), (None, 5), np.int64)
            # Block, first row, and first row behind.
            for x, y, z, start, end in index.tolist():
                found.setdefault((x, y, z), []).append((slab, start, end))
        return dict(sorted(found.items()))

    @property
    def blocks(self) -> tuple[Block, ...]:
        """All blocks with atoms in them."""
        return tuple(self._index) if self.only is None else self.only.blocks

    @cached_property
    def count(self) -> int:
        """How many atoms there are."""
        return sum(end - start for rows in self._index.values() for _, start, end in rows)

    @cached_property
    def spanned(self) -> float:
        """About the volume that the atoms fill: that of the cell without empty layers of blocks, or
        of a box about them."""
        ends = np.array([self._whole(self._file(k, "ends"), (2, 3)) for k in range(self._slabs)])
        taken = [len(np.unique(layers)) for layers in np.array(list(self._index)).T]
        held = np.minimum(np.array(taken) / self.counts, 1.0)
        spans = ends[:, 1].max(axis=0) - ends[:, 0].min(axis=0)
        sizes = np.where(self.cell.periodic, held, spans)
        return float(np.prod(sizes) * abs(np.linalg.det(self.cell.vectors)))

    def inside(self, block: Block) -> Part:
        """The atoms of a block."""
        parts = []
        for slab, start, end in self._index.get(block, []):
            places = self._whole(self._file(slab, "places"), (None, 3))[start:end]
            numbers = self._whole(self._file(slab, "numbers"), (None,), np.int64)[start:end]
            none = np.zeros((end - start, 3), dtype=np.int64)
            parts.append(Part(np.asarray(numbers), np.asarray(places), none))
        # In a slab, and from one to the next, their numbers increase.
        whole = Part.stacked(parts)
        if self.only is None:
            return whole
        owner = self._whole(Path(self.only.owner), (None,), np.int64)
        return whole[owner[whole.numbers] == self.only.grain]

    def every(self) -> np.ndarray:
        """The places of all atoms in the order of their numbers, shape (atoms, 3)."""
        found = np.empty((self.count, 3))
        for slab in range(self._slabs):
            numbers = self._whole(self._file(slab, "numbers"), (None,), np.int64)
            found[numbers] = self._whole(self._file(slab, "places"), (None, 3))
        return found

    def of_grains(self, owner: Path, grains: Sequence[int]) -> list[SortedAtoms]:
        """The atoms of each grain; owner: path of the grain of each atom, by number."""
        known = self._whole(owner, (None,), np.int64)
        held: dict[int, list[Block]] = {grain: [] for grain in grains}
        for block in self.blocks:
            for grain in np.unique(known[self.inside(block).numbers]).tolist():
                if grain in held:
                    held[grain].append(block)
        return [
            replace(self, only=Only(str(owner), grain, tuple(blocks)))
            for grain, blocks in held.items()
        ]

    def chosen(self, numbers: np.ndarray) -> dict[Block, Part]:
        """Atoms by number, in order, in the blocks in which they lie."""
        found: dict[Block, list[Part]] = {}
        first = 0
        for slab in range(self._slabs):
            given = self._whole(self._file(slab, "numbers"), (None,), np.int64)
            some = numbers[(numbers >= first) & (numbers < first + len(given))]
            first += len(given)
            if not len(some):
                continue
            rows = np.flatnonzero(np.isin(given, some))
            places = self._whole(self._file(slab, "places"), (None, 3))[rows]
            index = self._whole(self._file(slab, "index"), (None, 5), np.int64)
            which = np.searchsorted(index[:, 3], rows, side="right") - 1
            for k in np.unique(which).tolist():
                mine = which == k
                none = np.zeros((int(mine.sum()), 3), dtype=np.int64)
                part = Part(np.array(given[rows[mine]]), places[mine], none)
                x, y, z, *_ = index[k].tolist()
                found.setdefault((x, y, z), []).append(part)
        return {block: Part.joined(parts) for block, parts in sorted(found.items())}

    def _layer(self, block: Block, width: float) -> Iterator[tuple[Part, bool]]:
        """The atoms of a block, and those in a layer about it, part by part in their images, and
        whether a part is the block itself."""
        margin = width / self.cell.heights * self.counts
        low, high = np.floor(block - margin), np.ceil(block + margin)
        wraps = [
            range(int(a // n), int(b // n) + 1) if flag else (0,)
            for a, b, n, flag in zip(low, high, self.counts, self.cell.periodic, strict=True)
        ]
        every = np.array(self.blocks)
        seen: dict[Block, list[tuple[int, ...]]] = {}
        for image in product(*wraps):
            shift = np.where(self.cell.periodic, np.array(image) * self.counts, 0.0)
            # They are in order of their first number.
            ends = np.searchsorted(every[:, 0], [low[0] - shift[0], high[0] - shift[0] + 0.5])
            some = every[slice(*ends)]
            near = ((some >= low - shift) & (some <= high - shift)).all(axis=1)
            for x, y, z in some[near].tolist():
                seen.setdefault((x, y, z), []).append(image)
        for other, images in seen.items():
            part = self.inside(other)
            at = (part.places @ self.cell.inverse * self.counts - block).T
            # Along each edge, for each image. Rounding at the faces is far less than any layer.
            inside = [
                {m: (-margin[k] < (x := at[k] + m * n)) & (x < 1 + margin[k]) for m in wrap}
                for k, (wrap, n) in enumerate(zip(wraps, self.counts, strict=True))
            ]
            for image in images:
                if other == block and not any(image):
                    yield part, True
                    continue
                a, b, c = (inside[k][m] for k, m in enumerate(image))
                near = np.flatnonzero(a & b & c)
                if len(near):
                    some = part[near]
                    places = self.cell.moved(some.places, image)
                    yield Part(some.numbers, places, some.images + np.array(image)), False

    def around(self, block: Block, width: float) -> tuple[Part, np.ndarray]:
        """The atoms of a block with a layer of others about it, and which of them are its own."""
        parts, own = zip(*self._layer(block, width), strict=True)
        whole, counts = Part.stacked(list(parts)), [len(part.numbers) for part in parts]
        order = whole.order
        return whole[order], np.repeat(own, counts)[order]

    def close(self, block: Block, places: np.ndarray, distance: float) -> Part:
        """All atoms, in their images, as near to some places in a block as a distance."""
        tree = scipy.spatial.cKDTree(places)
        parts = []
        for part, _ in self._layer(block, distance):
            apart, _ = tree.query(part.places, distance_upper_bound=distance)
            parts.append(part[np.isfinite(apart)])
        return Part.joined(parts)

    def blocks_near(self, places: np.ndarray, distance: float) -> list[Block]:
        """Blocks that may have atoms as near to some places in the cell as a distance."""
        return [block for block, _ in self._beside(places, distance)]

    def near(self, places: np.ndarray, distance: float) -> Iterator[tuple[Block, np.ndarray, Part]]:
        """All atoms as near to some places in the cell as a distance: block, rows in it, atoms."""
        for block, points in self._beside(places, distance):
            part = self.inside(block)
            # Most atoms lie outside of a box about the places, which costs less than a search.
            low, high = points.min(axis=0) - distance, points.max(axis=0) + distance
            boxed = np.ones(len(part.numbers), dtype=bool)
            for k in range(3):
                boxed &= (part.places[:, k] > low[k]) & (part.places[:, k] < high[k])
            some = np.flatnonzero(boxed)
            apart, _ = scipy.spatial.cKDTree(points).query(
                part.places[some], distance_upper_bound=distance
            )
            rows = some[np.isfinite(apart)]
            yield block, rows, part[rows]

    def _beside(self, places: np.ndarray, distance: float) -> Iterator[tuple[Block, np.ndarray]]:
        """Blocks near to some places, and those of the places, in their images, that are near."""
        points, _, _ = self.cell.with_ghosts(places, distance)
        at = points @ self.cell.inverse * self.counts
        order = at[:, 0].argsort()
        points, at = points[order], at[order]
        margin = distance / self.cell.heights * self.counts
        for block in self.blocks:
            low, high = block - margin, np.array(block) + 1 + margin
            some = slice(*np.searchsorted(at[:, 0], [low[0], high[0]]))
            mine = ((at[some] > low) & (at[some] < high)).all(axis=1)
            if mine.any():
                yield block, points[some][mine]
