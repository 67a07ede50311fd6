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
from geomtorsion.blocks import LEDGER, open_ledger, read_array, run_blocks, write_array
from geomtorsion.crystals.atom_slabs import AtomSlabs
from geomtorsion.crystals.block_cores import BlockCores
from geomtorsion.crystals.block_shells import BlockShells, file_of, missing
from geomtorsion.crystals.crystal import reach_of_sample
from geomtorsion.crystals.frames import (
    NEIGHBOURS,
    Fit,
    Frame,
    InFrame,
    check_apart,
    frame_of,
    nearest_points,
    sampled,
)
from geomtorsion.crystals.given import Given
from geomtorsion.crystals.method import METHOD
from geomtorsion.crystals.near_torsion import lines_of
from geomtorsion.crystals.sorted_atoms import Block, Part, SortedAtoms
from geomtorsion.crystals.specimen import Specimen, few, lies_in_many
from geomtorsion.errors import CrystalError
from geomtorsion.loops.dislocation_network import DislocationNetwork


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
        """Share of a sample of the atoms whose neighbours are all where the lattice has them."""
        return float(self._found[1].whole.mean())

    @property
    def frame(self) -> Frame:
        """Lattice, orientation and lattice constant together."""
        return self._found[0]

    @cached_property
    def _found(self) -> tuple[Frame, Fit]:
        """The frame, and how a sample of the atoms fits into it."""
        known = [x for x in map(self.kept_sample, self._sample) if x is not None]
        if len(known) < len(self._sample):
            raise missing(self.folder, len(self._sample) - len(known), len(self.atoms.blocks))
        numbers = np.concatenate([part.numbers for part in self._sample.values()])
        vectors = np.concatenate(known)[np.argsort(numbers)]
        return frame_of(vectors, self.given.lattice, self.given.orient, self.given.constant)

    @cached_property
    def _sample(self) -> dict[Block, Part]:
        """Atoms that stand for all, in the blocks in which they lie."""
        return self.atoms.chosen(sampled(self.count))

    def check_single(self) -> None:
        """Refuse more than one grain: in the frame of one the bonds of others are no lattice
        vectors, and give lines that are none."""
        frame = self.frame
        reach = 2 * METHOD.width * frame.lattice.nearest * frame.constant
        chosen = Part.joined(list(self.atoms.chosen(few(self.count)).values()))
        parts = [part for _, _, part in self.atoms.near(chosen.places, reach)]
        near = Part.joined(parts)
        check_apart(near.places, near.numbers, frame.lattice.nearest * frame.constant)
        specimen = Specimen(near.places, self.atoms.cell, frame)
        if lies_in_many(specimen, np.searchsorted(near.numbers, chosen.numbers)):
            raise CrystalError(
                "positions: in blocks a single crystal was needed, but some atoms lie in another "
                f"lattice or orientation than most; the neighbours of {self.share:.1%} fit into "
                f"one {self.lattice} crystal. Cut out one grain, or read all grains at once: "
                "Crystal(positions, cell).dislocations()."
            )

    # -- blocks -----------------------------------------------------------------------------------

    def kept_sample(self, block: Block) -> np.ndarray | None:
        """Neighbour vectors of the sample in a block, if they are there."""
        shape = (len(self._sample[block].numbers), NEIGHBOURS, 3)
        return read_array(file_of(self.folder, block, "sample"), shape)

    @property
    def done(self) -> list[Block]:
        """The blocks that are finished."""
        return [k for k in self.atoms.blocks if self._shells.kept(k) is not None]

    def sample(self, block: Block) -> None:
        """Find the neighbours of some atoms of a block."""

        def about(places: np.ndarray, distance: float) -> tuple[np.ndarray, np.ndarray, bool]:
            part = self.atoms.close(block, places, distance)
            whole = not self.periodic.any() and len(part.numbers) == self.count
            return part.places, part.numbers, whole

        reach = reach_of_sample(self.atoms.spanned, self.count)
        _, vectors = nearest_points(about, self._sample[block].places, NEIGHBOURS, reach)
        write_array(file_of(self.folder, block, "sample"), vectors)

    def compute(self, block: Block) -> None:
        """Find the atoms of a block whose neighbours do not exclude torsion."""
        self._shells.compute(block)

    @cached_property
    def _shells(self) -> BlockShells:
        """What neighbours tell, block by block."""
        return BlockShells(self.folder, self.atoms, self.frame)

    # -- dislocations -----------------------------------------------------------------------------

    def dislocations(self, partials: bool = False) -> DislocationNetwork:
        """Dislocation lines with their junctions, as of `Crystal.dislocations`.

        Raises
        ------
        CheckpointError
            Blocks are missing.
        """
        checks.flag(partials, "partials", CrystalError)
        shells = self._shells
        left = len(self.atoms.blocks) - len(self.done)
        if left:
            raise shells.missing(left)
        cores = BlockCores(shells, partials)
        cores.run()

        def places_near(points: np.ndarray, distance: float) -> np.ndarray:
            return shells.near(points, distance)[0].places

        occupied = self.count + shells.vacancies
        return lines_of(cores.faces(), self.atoms.cell, self.frame, partials, occupied, places_near)

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

    It is taken as a single crystal, in the one frame into which most of a sample fit; where a few
    of its atoms tell that it has several grains it is refused. `share` tells how many fit. Memory
    is that of a block with a layer of some twelve neighbour distances about it, some 1 kB for each
    of its atoms, under noise of 10 % some 5 kB; and of the longest line with the atoms about it,
    since a core that goes through many blocks is relaxed at once.

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
        Processes on this machine.
    client
        A `dask.distributed.Client`, which runs one task for each block on its workers.

    Raises
    ------
    CrystalError
        Positions, cell or block are none, or the atoms are no crystal, or several grains.
    CheckpointError
        The folder holds blocks of another run.
    FileFormatError
        A file is missing or damaged.

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
    place = Path(folder)
    slabs = AtomSlabs(source)
    # Blocks of version 1 were others where a cell is open, slabs of version 2 smaller, and of
    # blocks of version 3 it was kept which atoms are open by their numbers.
    said = {"source": slabs.name, "block": size, "version": 4, **given.described}
    open_ledger(place, said)
    made = BlockedCrystal(str(place), SortedAtoms.sized(place, given.box, size), given)
    made.atoms.sort(slabs)
    if made.count < 20:
        raise CrystalError(
            f"positions: 20 atoms or more were needed to tell a crystal, but {made.count} came."
        )
    missing = [k for k in made._sample if made.kept_sample(k) is None]
    run_blocks(made.sample, missing, workers, client, "blocks for the frame")
    frame = made.frame
    needed = 4 * frame.lattice.nearest * frame.constant
    narrow = np.flatnonzero(given.box.periodic & (given.box.heights < needed))
    if len(narrow):
        k = int(narrow[0])
        raise CrystalError(
            f"cell: in blocks a period of {needed:.4g} or more was needed, four neighbour "
            f"distances, but edge {k + 1} repeats after {given.box.heights[k]:.4g}. Repeat the "
            "cell, or do it at once: Crystal(positions, cell).dislocations()."
        )
    made.check_single()
    done = set(made.done)
    run_blocks(made.compute, [k for k in made.atoms.blocks if k not in done], workers, client)
    BlockCores(made._shells, partials=False).run(workers, client)
    return made


def forget_blocks(folder: Path) -> None:
    """Remove sorted atoms and blocks, and nothing else."""
    for pattern in ("slab-*.npy", "block-*.npy", "*.part", "sorted.npy", LEDGER):
        for path in folder.glob(pattern):
            path.unlink()
    if folder.is_dir() and not any(folder.iterdir()):
        folder.rmdir()
