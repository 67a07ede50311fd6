"""Block cores: torsion relaxed core by core, each where a block sees all of it.

A core depends on nothing but its own tetrahedra and those that touch them, and on their atoms a
widest tetrahedron further on. A block does the cores of which it sees so much; those that go on are
put together from all the blocks through which they go, and done by themselves. Twice: the first
time for what is torn or doubtful, then for what has an atom in common with torsion that is left.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import scipy  # loads its parts when they are asked for

from geomtorsion.materials.blocks import read_array, run_blocks, write_array
from geomtorsion.materials.crystals.block_shells import BlockShells
from geomtorsion.materials.crystals.method import METHOD
from geomtorsion.materials.crystals.near_torsion import reads_around, torsion_on, widest
from geomtorsion.materials.crystals.sorted_atoms import Block, Part
from geomtorsion.materials.crystals.surroundings import Surroundings
from geomtorsion.materials.crystals.torn_faces import COLUMNS, TornFaces
from geomtorsion.materials.crystals.torsion import Torsion, components
from geomtorsion.materials.crystals.triangulation import Cell, distinct, triangulated

# Columns of tables: of an edge two atoms, the image of the second and the label; of an atom its
# number and place.
EDGE = len(("first", "second", *("image",) * 3, *("label",) * 3))
PLACE = len(("number", "x", "y", "z"))


@dataclass(frozen=True, eq=False)
class Region:
    """The torsion about some atoms, as the whole crystal has it.

    numbers: of all atoms in it, increasing, shape (k,). seeds: about which it is, and right: on
    which all tetrahedra and labels are those of the whole crystal, shape (k,).
    """

    torsion: Torsion
    numbers: np.ndarray
    seeds: np.ndarray
    right: np.ndarray


@dataclass(frozen=True, eq=False)
class BlockCores:
    """The cores of a crystal in blocks; files of its blocks are those of its shells.

    partials: whether partial dislocations are told apart.
    """

    shells: BlockShells
    partials: bool

    @property
    def _cell(self) -> Cell:
        """The cell of the atoms."""
        return self.shells.atoms.cell

    @property
    def _span(self) -> float:
        """How far apart atoms of one tetrahedron may be."""
        return widest(self.shells.frame)

    def _file(self, block: Block, what: str) -> Path:
        """What is kept of a block."""
        return self.shells.file(block, f"{what}-partials" if self.partials else what)

    def _read(self, block: Block, what: str, width: int) -> np.ndarray:
        """A table of whole numbers, empty where there is none."""
        found = read_array(self._file(block, what), (None, width), np.int64)
        return np.zeros((0, width), dtype=np.int64) if found is None else found

    def _gathered(self, blocks: Iterable[Block], what: str, width: int) -> np.ndarray:
        """The tables of several blocks one after another."""
        none = np.zeros((0, width), dtype=np.int64)
        return np.concatenate([none, *(self._read(k, what, width) for k in blocks)])

    # -- all of it --------------------------------------------------------------------------------

    def run(self, workers: int = 1, client: Any = None) -> None:
        """Do all that is not yet done."""
        blocks = self.shells.atoms.blocks
        last = self._file(blocks[0], "done")
        if read_array(last, (0,), np.int64) is not None:
            return
        self._grow(workers, client)
        for stage in ("first", "second"):
            left = [k for k in blocks if not self._is_there(k, stage)]
            run_blocks(partial(self.relax, stage), left, workers, client, "blocks of cores")
            tasks = self._long(stage)
            left = [k for k in tasks if not self._is_there(k, f"{stage}-long")]
            run_blocks(partial(self.relax_long, stage), left, workers, client, "long cores")
            if stage == "first":
                for what, width in (("", EDGE), ("-torn", PLACE)):
                    table = self._gathered(tasks, f"first-long{what}", width)
                    write_array(self._file(blocks[0], f"first-all{what}"), table)
        write_array(last, np.zeros(0, dtype=np.int64))

    def _is_there(self, block: Block, what: str) -> bool:
        """Whether a table of a block has been written."""
        width = COLUMNS if what.startswith("second") else EDGE
        return read_array(self._file(block, what), (None, width), np.int64) is not None

    def faces(self) -> TornFaces:
        """All faces that carry torsion in the end."""
        blocks = self.shells.atoms.blocks
        both = ("second", "second-long")
        return TornFaces.joined([self._gathered(blocks, what, COLUMNS) for what in both])

    # -- regions ----------------------------------------------------------------------------------

    def _region(self, places: np.ndarray, numbers: np.ndarray, about: bool = True) -> Region:
        """That of some atoms; about: right are also those that have a tetrahedron with them."""
        frame, span = self.shells.frame, self._span
        # Of atoms that are right all tetrahedra are needed, perhaps those of their neighbours.
        beside = 1 + reads_around(frame, self.partials)
        atoms, wanted = self.shells.near(places, (1 + about + beside) * span)
        wanted |= np.isin(atoms.numbers, self._more)
        seeds = np.isin(atoms.numbers, numbers)
        right = self._within(atoms.places, places, span) if about else seeds
        known = wanted & self._within(atoms.places, atoms.places[right], beside * span)
        reach = METHOD.reach * frame.lattice.nearest * frame.constant
        mesh = triangulated(atoms.places, self._cell, reach, known, atoms.numbers)
        torsion = torsion_on(frame, mesh, atoms.kinds, self.partials)
        return Region(torsion, atoms.numbers, seeds, right)

    def _within(self, places: np.ndarray, about: np.ndarray, distance: float) -> np.ndarray:
        """Which places lie as near to others as a distance."""
        points, _, _ = self._cell.with_ghosts(about, distance)
        if not len(points):
            return np.zeros(len(places), dtype=bool)
        apart, _ = scipy.spatial.cKDTree(points).query(places, distance_upper_bound=distance)
        return np.isfinite(apart)

    # -- atoms to which torsion leads on ----------------------------------------------------------

    def _grow(self, workers: int, client: Any) -> None:
        """Find the atoms that need tetrahedra since torsion leads on to them, step by step."""
        left, step = list(self.shells.atoms.blocks), 0
        while left:
            todo = [k for k in left if not self._is_step(k, step)]
            run_blocks(partial(self.lead_on, step), todo, workers, client, "blocks about torsion")
            found = self._gathered(left, f"led-{step}", PLACE)
            step += 1
            more = np.union1d(self._more, found[:, 0])
            write_array(self._file(self.shells.atoms.blocks[0], "more"), more)
            places = np.ascontiguousarray(found[:, 1:]).view(float)
            left = self.shells.atoms.blocks_near(places, 5 * self._span) if len(places) else []

    def _is_step(self, block: Block, step: int) -> bool:
        """Whether a step of a block has been done."""
        return read_array(self._file(block, f"led-{step}"), (None, PLACE), np.int64) is not None

    @property
    def _more(self) -> np.ndarray:
        """Numbers of atoms to which torsion leads on, as far as known."""
        found = read_array(self._file(self.shells.atoms.blocks[0], "more"), (None,), np.int64)
        return np.zeros(0, dtype=np.int64) if found is None else found

    def _wanted(self, block: Block) -> Part:
        """The atoms of a block that need tetrahedra, as far as known."""
        part = self.shells.atoms.inside(block)
        return part[self.shells.wanted(block) | np.isin(part.numbers, self._more)]

    def lead_on(self, step: int, block: Block) -> None:
        """Find the atoms to which torsion about atoms of a block leads on."""
        own, more = self._wanted(block), self._more
        found = np.zeros((0, PLACE), dtype=np.int64)
        if len(own.numbers):
            atoms, wanted = self.shells.near(own.places, self._span)
            others = atoms.places[~wanted & ~np.isin(atoms.numbers, more)]
            beside = self._within(own.places, others, self._span)
            own = own[beside]
        if len(own.numbers):
            region = self._region(own.places, own.numbers)
            torsion, mesh = region.torsion, region.torsion.mesh
            beyond = torsion.beyond & region.right
            cells = region.seeds[mesh.corners].any(axis=1) & beyond[mesh.corners].any(axis=1)
            atom = np.unique(mesh.corners[cells])
            atom = atom[~mesh.known[atom]]
            found = _packed(region.numbers[atom], mesh.places[atom])
        write_array(self._file(block, f"led-{step}"), found)

    # -- cores ------------------------------------------------------------------------------------

    def relax(self, stage: str, block: Block) -> None:
        """Relax the cores of which a block sees all, and tell of those that go on."""
        numbers, places = self._seeds(stage, block)
        left = np.zeros((0, 1 + PLACE), dtype=np.int64)
        if not len(numbers):
            self._write(stage, stage, block)
        else:
            region = self._region(places, numbers)
            if stage == "first":
                _ = Surroundings(region.torsion.mesh.places, region.numbers, 0.0).apart
            begun, core = self._cores(stage, region, places)
            corners = begun.mesh.corners
            mine = (core >= 0) & region.seeds[corners].any(axis=1)
            goes_on = np.isin(core, core[~region.right[corners].all(axis=1)])
            chosen = np.where(np.isin(core, core[mine]) & ~goes_on, core, -1)
            cells = np.flatnonzero(mine & goes_on)
            rows = np.column_stack([np.repeat(core[cells], 4), corners[cells].ravel()])
            rows = rows[distinct(rows.T)[0]]
            packed = _packed(region.numbers[rows[:, 1]], begun.mesh.places[rows[:, 1]])
            left = np.column_stack([rows[:, 0], packed])
            self._write(stage, stage, block, region, begun, chosen)
        write_array(self._file(block, f"{stage}-left"), left)

    def relax_long(self, stage: str, block: Block) -> None:
        """Relax cores that go on through several blocks, of which this is the first."""
        numbers, places = _unpacked(self._read(block, f"{stage}-tasks", PLACE))
        region = self._region(places, numbers, about=False)
        begun, core = self._cores(stage, region, places)
        others = np.isin(core, core[~region.right[begun.mesh.corners].all(axis=1)])
        self._write(stage, f"{stage}-long", block, region, begun, np.where(others, -1, core))

    def _seeds(self, stage: str, block: Block) -> tuple[np.ndarray, np.ndarray]:
        """Numbers and places of the atoms of a block at which its cores begin."""
        if stage == "first":
            own = self._wanted(block)
            return own.numbers, own.places
        both = ("first-torn", "first-long-torn")
        return _unpacked(np.concatenate([self._read(block, what, PLACE) for what in both]))

    def _cores(self, stage: str, region: Region, places: np.ndarray) -> tuple[Torsion, np.ndarray]:
        """The torsion of a region as a stage begins, and the core of each tetrahedron."""
        torsion, mesh = region.torsion, region.torsion.mesh
        if stage == "first":
            return torsion, torsion.cores(torsion.bad)
        near = self.shells.atoms.blocks_near(places, 5 * self._span)
        begin = self.shells.atoms.blocks[:1]
        rows = np.concatenate(
            [self._gathered(near, "first", EDGE), self._gathered(begin, "first-all", EDGE)]
        )
        begun = replace(torsion, labels=_relabelled(torsion, region.numbers, rows))
        torn = np.concatenate(
            [
                self._gathered(near, "first-torn", PLACE),
                self._gathered(begin, "first-all-torn", PLACE),
            ]
        )
        touched = np.any(np.isin(region.numbers, torn[:, 0])[mesh.corners], axis=1)
        return begun, begun.cores(touched)

    def _write(
        self, stage: str, name: str, block: Block, region: Region | None = None,
        begun: Torsion | None = None, core: np.ndarray | None = None,
    ) -> None:  # fmt: skip
        """Relax the cores of a region, and keep what is left of them; nothing without a region."""
        none = np.zeros((0, EDGE), dtype=np.int64)
        if stage == "second":
            table = np.zeros((0, COLUMNS), dtype=np.int64)
            if region is not None and begun is not None and core is not None:
                found = begun.shortest(core, region.torsion.lengths)
                table = TornFaces.of(found, region.numbers, core >= 0).table
            write_array(self._file(block, name), table)
            return
        torn, table = none[:, :PLACE], none
        if region is not None and begun is not None and core is not None:
            mesh = begun.mesh
            found = begun.descended(core).shortest(core, begun.lengths)
            pairs, images, _ = mesh.edges
            k = np.flatnonzero((found.labels != begun.labels).any(axis=1))
            table = np.column_stack([region.numbers[pairs[k]], images[k], found.labels[k]])
            atom = np.unique(mesh.corners[found.torn & (core >= 0)])
            torn = _packed(region.numbers[atom], mesh.places[atom])
        write_array(self._file(block, f"{name}-torn"), torn)
        write_array(self._file(block, name), table)

    def _long(self, stage: str) -> list[Block]:
        """Put cores together that go on from block to block; the first blocks of each."""
        blocks = self.shells.atoms.blocks
        tables = [self._read(k, f"{stage}-left", 1 + PLACE) for k in blocks]
        owner = np.repeat(np.arange(len(blocks)), list(map(len, tables)))
        rows = np.concatenate(tables)
        # Parts of one core in two blocks have atoms in common.
        part = distinct([owner, rows[:, 0]])[1].astype(np.int64)
        atom = distinct([rows[:, 1]])[1].astype(np.int64)
        count = int(part.max(initial=-1)) + 1
        whole = components(
            count + int(atom.max(initial=-1)) + 1, np.column_stack([part, count + atom])
        )[part]
        first = np.full(len(rows), len(blocks))
        np.minimum.at(first, whole, owner)
        found = []
        for k in np.unique(first[whole]).tolist():
            mine = rows[first[whole] == k, 1:]
            write_array(self._file(blocks[k], f"{stage}-tasks"), mine[distinct([mine[:, 0]])[0]])
            found.append(blocks[k])
        return found


def _relabelled(torsion: Torsion, numbers: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Labels of edges with those changed that stand in rows."""
    rows = rows[np.isin(rows[:, 0], numbers)]
    pairs, images, _ = torsion.mesh.edges
    mine = np.column_stack([numbers[pairs], images])
    which = distinct(np.concatenate([rows[:, :-3], mine]).T)[1]
    row = np.full(int(which.max(initial=-1)) + 1, -1)
    row[which[: len(rows)]] = np.arange(len(rows))
    at = row[which[len(rows) :]]
    labels = torsion.labels.copy()
    labels[at >= 0] = rows[at[at >= 0], -3:]
    return labels


def _packed(numbers: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Atoms as one table of whole numbers, to the last bit."""
    return np.column_stack([numbers, np.ascontiguousarray(places).view(np.int64)])


def _unpacked(table: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Their numbers and places."""
    return np.array(table[:, 0]), np.ascontiguousarray(table[:, 1:]).view(float)
