"""Blocked: crystals of more atoms than memory holds, block by block in a folder.

Atoms are sorted into blocks of space. In each of them, with a layer of others about it, those are
found whose neighbours do not exclude torsion; about these alone tetrahedra are formed, and cores
are relaxed, again block by block. Every block sees what the whole crystal would show it: any size
of blocks gives the same lines, and so does a run that was killed and taken up again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from geomtorsion import checks
from geomtorsion.errors import CrystalError
from geomtorsion.materials.blocks import LEDGER, open_ledger, read_array, run_blocks, write_array
from geomtorsion.materials.crystals.atom_slabs import AtomSlabs
from geomtorsion.materials.crystals.block_cores import BlockCores
from geomtorsion.materials.crystals.block_grains import BlockGrains
from geomtorsion.materials.crystals.block_shells import BlockShells, file_of, missing
from geomtorsion.materials.crystals.crystal import reach_of_sample
from geomtorsion.materials.crystals.frames import (
    NEIGHBOURS,
    Fit,
    Frame,
    InFrame,
    check_turn,
    frame_of,
    sampled,
)
from geomtorsion.materials.crystals.given import Given
from geomtorsion.materials.crystals.grain_networks import network_of_grains
from geomtorsion.materials.crystals.grains import Grains, single_grain
from geomtorsion.materials.crystals.lattices import Lattice
from geomtorsion.materials.crystals.near_torsion import lines_of
from geomtorsion.materials.crystals.segmentation import segmented
from geomtorsion.materials.crystals.sorted_atoms import Block, Part, SortedAtoms
from geomtorsion.materials.crystals.specimen import Specimen, seems_many, share_of_lattices
from geomtorsion.materials.crystals.surroundings import Places, Surroundings, nearest_points
from geomtorsion.materials.lines.dislocation_network import DislocationNetwork


@dataclass(frozen=True, eq=False)
class BlockedCrystal(InFrame):
    """A crystal in blocks, one file each in a folder; lines as of a `Crystal`.

    atoms: sorted, on disk. count: how many. lattice, orient, constant, share: as of a `Crystal`.
    """

    folder: str
    atoms: SortedAtoms
    given: Given

    # -- how it lies ------------------------------------------------------------------------------

    @property
    def count(self) -> int:
        """How many atoms there are."""
        return self.atoms.count

    @property
    def cell(self) -> np.ndarray | None:
        """Edges of the cell as rows, or None where it has none."""
        return self.given.cell

    @property
    def periodic(self) -> np.ndarray:
        """Along which edges the cell repeats, shape (3,)."""
        return self.atoms.cell.periodic

    @property
    def share(self) -> float:
        """Share of a sample of the atoms whose neighbours are all where the lattice has them; of
        all atoms of a polycrystal, in their grains."""
        found = self.grains.fitting if self._seems_many else None
        return float(self._found[1].whole.mean()) if found is None else found

    @cached_property
    def frame(self) -> Frame:
        """Lattice, orientation and lattice constant together; of a polycrystal those of grain 0."""
        return self.grains.grains[0].frame if self._seems_many else self._found[0]

    @cached_property
    def _found(self) -> tuple[Frame, Fit]:
        """The frame, and how a sample of the atoms fits into it."""
        known = [x for x in map(self.kept_sample, self._sample) if x is not None]
        if len(known) < len(self._sample):
            raise missing(self.folder, len(self._sample) - len(known), len(self.atoms.blocks))
        numbers = np.concatenate([part.numbers for part in self._sample.values()])
        order = np.argsort(numbers)

        def shares(lattice: Lattice) -> dict[str, float]:
            return share_of_lattices(lattice, self._neighbours, numbers[order])

        given = self.given
        vectors = np.concatenate(known)[order]
        found = frame_of(vectors, given.lattice, given.orient, given.constant, shares)
        if given.orient is not None:
            check_turn(found[0], vectors)
        return found

    def _neighbours(self, atoms: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Numbers of the nearest neighbours of some atoms, and the vectors to them."""
        numbers, which = np.unique(atoms, return_inverse=True)
        places = Part.joined(list(self.atoms.chosen(numbers).values())).places

        def about(centres: np.ndarray, distance: float) -> Surroundings:
            near = Part.joined([part for _, _, part in self.atoms.near(centres, distance)])
            points, rows, _ = self.atoms.cell.with_ghosts(near.places, distance)
            whole = not self.periodic.any() and len(near.numbers) == self.count
            return Surroundings(points, near.numbers[rows], distance, whole)

        reach = reach_of_sample(self.atoms.spanned, self.count)
        found, vectors = nearest_points(about, places, NEIGHBOURS, reach)
        return found[which], vectors[which]

    @cached_property
    def _sample(self) -> dict[Block, Part]:
        """Atoms that stand for all, in the blocks in which they lie."""
        return self.atoms.chosen(sampled(self.count))

    # -- grains -----------------------------------------------------------------------------------

    @property
    def is_single(self) -> bool:
        """Whether it is one crystal, with no atom outside of it."""
        return self._segmented is None or self._segmented.is_single

    @cached_property
    def grains(self) -> Grains:
        """Its grains in order, and the walls between them, as of a `Crystal`."""
        found = self._segmented
        return single_grain(self._found[0], self.atoms.every()) if found is None else found

    @cached_property
    def _segmented(self) -> Grains | None:
        """The grains of what is no single crystal."""
        if self._grains.seems_single and self._grains.is_single:
            return None
        return segmented(self._specimen)

    @cached_property
    def _grains(self) -> BlockGrains:
        """What does not fit into the frame, block by block."""
        return BlockGrains(self._shells)

    @cached_property
    def _specimen(self) -> Specimen:
        """All atoms at once, and the frame into which most of them fit."""
        given = self.given.orient is not None, self.given.constant is not None
        reach = reach_of_sample(self.atoms.spanned, self.count)
        atoms = Places(self.atoms.every(), self.atoms.cell, reach)
        return Specimen(atoms, self._found[0], *given)

    @cached_property
    def _seems_many(self) -> bool:
        """Whether some atoms lie in another lattice or orientation."""
        if self.is_single:
            return False
        return seems_many(self._specimen, sampled(self.count), self._found[1].whole)

    @cached_property
    def _parts(self) -> tuple[BlockShells, ...]:
        """The atoms in the frames of their grains."""
        if self.is_single:
            return (self._shells,)
        owner = Path(self.folder, "grain-of-atoms.npy")
        write_array(owner, self.grains.number.astype(np.int64))
        atoms = self.atoms.of_grains(owner, [grain.number for grain in self.grains])
        found = []
        for grain, own in zip(self.grains, atoms, strict=True):
            folder = Path(self.folder, f"grain-{grain.number}")
            folder.mkdir(exist_ok=True)
            found.append(BlockShells(str(folder), own, grain.frame))
        return tuple(found)

    # -- blocks -----------------------------------------------------------------------------------

    def kept_sample(self, block: Block) -> np.ndarray | None:
        """Neighbour vectors of the sample in a block, if they are there."""
        shape = (len(self._sample[block].numbers), NEIGHBOURS, 3)
        return read_array(file_of(self.folder, block, "sample"), shape)

    @property
    def done(self) -> list[Block]:
        """The blocks that are finished."""
        if self.is_single:
            return [k for k in self.atoms.blocks if self._shells.kept(k) is not None]
        left = {k for shells in self._parts for k in shells.atoms.blocks if shells.kept(k) is None}
        return [k for k in self.atoms.blocks if k not in left]

    def sample(self, block: Block) -> None:
        """Find the neighbours of some atoms of a block."""

        def about(places: np.ndarray, distance: float) -> Surroundings:
            part = self.atoms.close(block, places, distance)
            whole = not self.periodic.any() and len(part.numbers) == self.count
            return Surroundings(part.places, part.numbers, distance, whole)

        reach = reach_of_sample(self.atoms.spanned, self.count)
        _, vectors = nearest_points(about, self._sample[block].places, NEIGHBOURS, reach)
        write_array(file_of(self.folder, block, "sample"), vectors)

    def compute(self, block: Block) -> None:
        """Find the atoms of a block whose neighbours do not exclude torsion."""
        self._shells.compute(block)

    @cached_property
    def _shells(self) -> BlockShells:
        """What neighbours tell, block by block."""
        return BlockShells(self.folder, self.atoms, self._found[0])

    # -- dislocations -----------------------------------------------------------------------------

    def dislocations(self, partials: bool = False) -> DislocationNetwork:
        """Dislocation lines with their junctions, as of `Crystal.dislocations`.

        Raises
        ------
        CheckpointError
            Blocks are missing.
        """
        checks.flag(partials, "partials", CrystalError)
        left = len(self.atoms.blocks) - len(self.done)
        if left:
            raise self._shells.missing(left)
        if self.is_single:
            return self._lines(self._shells, partials)
        networks = [self._lines(shells, partials) for shells in self._parts]

        def near(points: np.ndarray, distance: float) -> tuple[np.ndarray, np.ndarray]:
            whole = Part.joined([part for _, _, part in self.atoms.near(points, distance)])
            return whole.numbers, whole.places

        return network_of_grains(networks, self.grains, self.atoms.cell, near)

    def _lines(self, shells: BlockShells, partials: bool) -> DislocationNetwork:
        """The lines of a grain, or of a single crystal."""
        cores = BlockCores(shells, partials)
        cores.run()

        def near(points: np.ndarray, distance: float) -> np.ndarray:
            return shells.near(points, distance)[0].places

        # A grain does not fill its cell.
        occupied = self.count + shells.vacancies if self.is_single else None
        return lines_of(cores.faces(), self.atoms.cell, shells.frame, partials, occupied, near)

    def find(self, workers: int, client: Any) -> None:
        """Do all that is not yet done, but for partials."""
        _check_wide(self.given, self._found[0])
        if self._grains.seems_single:
            left = [k for k in self.atoms.blocks if self._shells.kept(k) is None]
            run_blocks(self.compute, left, workers, client)
            self._grains.run(workers, client)
        for shells in self._parts:
            _check_wide(self.given, shells.frame)
            left = [k for k in shells.atoms.blocks if shells.kept(k) is None]
            run_blocks(shells.compute, left, workers, client)
            BlockCores(shells, partials=False).run(workers, client)

    def __repr__(self) -> str:
        done, total = len(self.done), len(self.atoms.blocks)
        return f"BlockedCrystal({self.count:,} atoms, {done} of {total} blocks done)"


def blocked_crystal(
    source: Any,
    folder: str | Path,
    cell: ArrayLike | None,
    block: float,
    periodic: Sequence[bool] = (True, True, True),
    *,
    lattice: str | None = None,
    orient: ArrayLike | None = None,
    constant: float | None = None,
    workers: int = 1,
    client: Any = None,
) -> BlockedCrystal:
    """A crystal of more atoms than memory holds, sorted into blocks and looked through.

    Whether it is a single crystal is told block by block; `share` tells how many atoms fit. Memory
    is that of a block with a layer of some twelve neighbour distances about it, some 1 kB for each
    of its atoms, under noise of 10 % some 5 kB; and of the longest line with the atoms about it,
    since a core that goes through many blocks is relaxed at once. Of a polycrystal grains are told
    apart in all atoms at once, some 2 kB each, and read in blocks, each in its own frame.

    Parameters
    ----------
    source
        Positions, shape (atoms, 3): an array (also a mapped one); the path of an .npy file, of a
        Zarr array (extra `cluster`), or of an .npz file with the array `positions`; a list of
        these, one after another; or a function that gives an iterator of arrays.
    folder
        Where sorted atoms (40 bytes each) and blocks are kept. A run that was killed goes on there.
    cell, periodic, lattice, orient, constant
        As for `Crystal`.
    block
        Length of the sides of a block, in the unit of the positions. It decides about memory and
        time, not about lines: it should be some fifty neighbour distances or more.
    workers
        Processes on this machine. A script asks for them below ``if __name__ == "__main__":``,
        since each reads it again.
    client
        A `dask.distributed.Client`, which runs one task for each block on its workers.

    Raises
    ------
    CrystalError
        Positions, cell or block are none, or the atoms are no crystal.
    CheckpointError
        The folder holds blocks of another run.
    FileFormatError
        A file is missing or damaged.
    LimitError
        A process ended before its work was done.

    Examples
    --------
    >>> from itertools import product
    >>> from tempfile import TemporaryDirectory
    >>> sites = np.array(list(product(range(16), repeat=3)))
    >>> places = sites[sites.sum(axis=1) % 2 == 0] * 1.8
    >>> with TemporaryDirectory() as folder:
    ...     crystal = blocked_crystal(places, folder, [28.8] * 3, block=15)
    ...     crystal, crystal.lattice, crystal.dislocations().lines
    (BlockedCrystal(2,048 atoms, 8 of 8 blocks done), 'fcc', ())
    """
    given = Given.of(cell, periodic, lattice, orient, constant)
    size = float(checks.positive(block, "block", CrystalError))
    checks.count(workers, "workers", CrystalError, 1)
    place = checks.file_name(folder, "folder")
    slabs = AtomSlabs(source)
    # Blocks of version 1 were others where a cell is open, slabs of version 2 smaller, and of
    # blocks of version 3 it was kept which atoms are open by their numbers. Samples of version 4
    # have fewer neighbours.
    said = {"source": slabs.name, "digest": slabs.digest, "block": size, "version": 5}
    said |= given.described
    open_ledger(place, said)
    made = BlockedCrystal(str(place), SortedAtoms.sized(place, given.box, size), given)
    made.atoms.sort(slabs)
    if made.count < 20:
        raise CrystalError(
            f"positions: 20 atoms or more were needed to tell a crystal, but {made.count} came."
        )
    missing = [k for k in made._sample if made.kept_sample(k) is None]
    run_blocks(made.sample, missing, workers, client, "blocks for the frame")
    made.find(workers, client)
    return made


def _check_wide(given: Given, frame: Frame) -> None:
    """Refuse periods in which an atom may be its own neighbour."""
    needed = 4 * frame.lattice.nearest * frame.constant
    narrow = np.flatnonzero(given.box.periodic & (given.box.heights < needed))
    if len(narrow):
        k = int(narrow[0])
        raise CrystalError(
            f"cell: in blocks a period of {needed:.4g} or more was needed, four neighbour "
            f"distances, but edge {k + 1} repeats after {given.box.heights[k]:.4g}. Repeat the "
            "cell, or do it at once: Crystal(positions, cell).dislocations()."
        )


def forget_blocks(folder: Path) -> None:
    """Remove sorted atoms and blocks, and nothing else."""
    for part in (*folder.glob("grain-*/"), folder):
        for pattern in ("slab-*.npy", "block-*.npy", "*.part", "sorted.npy", "grain-*.npy", LEDGER):
            for path in part.glob(pattern):
                path.unlink()
        if part != folder and not any(part.iterdir()):
            part.rmdir()
    if folder.is_dir() and not any(folder.iterdir()):
        folder.rmdir()
