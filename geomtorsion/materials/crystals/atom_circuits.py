"""Circuits: closed paths from atom to atom in a crystal or a grain, and their closure failure."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product

import numpy as np
import scipy  # loads its parts on first use
from numpy.typing import ArrayLike

from geomtorsion.errors import CrystalError
from geomtorsion.loops.validation import once_round
from geomtorsion.materials.burgers import Burgers
from geomtorsion.materials.crystals.frames import Frame
from geomtorsion.materials.crystals.grains import Grains, Nowhere
from geomtorsion.materials.crystals.shells import reach_of_shells
from geomtorsion.materials.crystals.triangulation import Cell
from geomtorsion.materials.lines.reactions import Vector, written
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property

# An atom, and the number of periods by which it is moved.
Site = tuple[int, int, int, int]


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class AtomCircuit(Burgers):
    """A closed path from atom to atom; b is the exact sum of the lattice vectors of its steps.

    atoms: the path, numbers of the atoms, the first again at its end. images: the number of periods
        by which each atom is moved, shape (k, 3).
    steps: lattice vectors of the bonds between them, whole numbers in units of
        `crystal.frame.lattice.units`, shape (k - 1, 3). `whole` is their sum.
    vector: in the coordinates of the positions, with the mean deformation of the crystal.
    frame: lattice and orientation of the crystal.
    """

    atoms: tuple[int, ...]
    images: np.ndarray
    steps: np.ndarray
    frame: Frame

    @classmethod
    def of(
        cls, atoms: tuple[int, ...], images: np.ndarray, steps: np.ndarray, frame: Frame
    ) -> AtomCircuit:
        """The circuit along some steps."""
        whole = steps.sum(axis=0)
        # Zeros times turned axes may be -0.0.
        vector = frame.vectors(whole[None])[0] + 0.0
        return cls(
            vector=vector,
            whole=whole,
            lattice=frame.vectors(np.eye(3, dtype=np.int64)),
            atoms=atoms,
            images=images,
            steps=steps,
            frame=frame,
        )

    @property
    def burgers_lattice(self) -> Vector:
        """b along the axes of the crystal in lattice constants, exact, shape (3,)."""
        return self.frame.lattice.fractions(self.steps.sum(axis=0))

    @property
    def burgers(self) -> Vector:
        """b in the coordinates of the positions, as for lines, shape (3,)."""
        return tuple(self.vector.tolist())

    def __repr__(self) -> str:
        return (
            f"AtomCircuit({len(self.steps)} steps, b = {written(self.burgers_lattice)} a = "
            f"{written(self.burgers)})"
        )


@dataclass(frozen=True, eq=False)
class AtomCircuits:
    """Makes circuits in a crystal: call it with atoms, or call `around` with a point.

    places: of the atoms in the cell, shape (atoms, 3). moved: periods from the given positions to
        these places. cell: the cell. frame: lattice and orientation of the crystal.
    decoded: lattice vectors of steps between pairs of atoms.
    """

    places: np.ndarray
    moved: np.ndarray
    cell: Cell
    frame: Frame
    decoded: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]

    def __call__(self, atoms: Sequence[int]) -> AtomCircuit:
        """The circuit through atoms, from each to the nearest image of the next along bonds.

        Parameters
        ----------
        atoms
            Numbers of atoms, from 0; it closes by itself.

        Raises
        ------
        CrystalError
            An atom does not exist, fewer than three are named, the circuit ends in another image,
            or some of its bonds belong to a core and have no nearest lattice vector.
        """
        numbers = [
            checks.count(k, f"atoms[{j}]", CrystalError, 0, len(self.places) - 1)
            for j, k in enumerate(checks.entries(checks.rows(atoms), "atoms", CrystalError))
        ]
        numbers = once_round(numbers, "atoms")
        if len(set(numbers)) < 3:
            raise CrystalError(
                f"atoms: expected three or more different atoms for a circuit, got "
                f"{len(set(numbers))}. Name more."
            )
        sites: list[Site] = [(numbers[0], 0, 0, 0)]
        for number in [*numbers[1:], numbers[0]]:
            here = self._place(sites[-1])
            sites.append((number, *self._nearest_image(self.places[number] - here)))
        if sites[-1] != sites[0]:
            raise CrystalError(
                f"atoms: expected a closed circuit, got one that runs around the cell: it ends at "
                f"atom {numbers[0]} in another image, {sites[-1][1:]} periods away. Name atoms on "
                "the way back."
            )
        return self._through(sites)

    def around(self, point: ArrayLike, normal: ArrayLike, radius: float) -> AtomCircuit:
        """The circuit from atom to atom along a circle, right-handed about a normal.

        Parameters
        ----------
        point
            Its centre, shape (3,).
        normal
            Shape (3,), of any length.
        radius
            In the unit of the positions; a few neighbour distances, so that it meets no core.

        Raises
        ------
        CrystalError
            Values that are not numbers, a zero normal or radius, or no atoms or a core on the way.
        """
        rim = self.rim(point, normal, radius)
        nearest = [self.nearest(place) for place in rim]
        sites = [one for k, one in enumerate(nearest) if one != nearest[k - 1]]
        if len(sites) < 3:
            raise CrystalError(
                f"radius: expected a circle with three or more atoms next to it, got "
                f"{len(sites)}. Take a larger radius."
            )
        return self._through([*sites, sites[0]])

    def rim(self, point: ArrayLike, normal: ArrayLike, radius: float) -> np.ndarray:
        """Positions on the circle of `around`, as far apart as neighbours, shape (k, 3)."""
        centre = checks.array(point, "point", CrystalError, shape=(3,))
        axis = checks.array(normal, "normal", CrystalError, shape=(3,))
        size = checks.positive(radius, "radius", CrystalError)
        for values, name in ((centre, "point"), (axis, "normal")):
            checks.measured(values, name, CrystalError)
        checks.measured(size, "radius", CrystalError)
        if not np.linalg.norm(axis) > 0:
            raise CrystalError(
                "normal: expected a direction, got (0, 0, 0). Give a vector that is not zero."
            )
        nearest = self.frame.lattice.nearest * self.frame.constant
        if size < nearest:
            raise CrystalError(
                f"radius: expected at least the distance of neighbours, {nearest:.4g}, got "
                f"{size:.4g}. Take a larger radius."
            )
        # Two columns perpendicular to the axis, right-handed with it.
        across = np.linalg.qr(np.column_stack([axis, np.eye(3)[np.abs(axis).argsort()[:2]].T]))[0]
        first = across[:, 1]
        second = np.cross(axis / np.linalg.norm(axis), first)
        angles = np.linspace(0, 2 * np.pi, max(int(2 * np.pi * size / nearest), 6), endpoint=False)
        return centre + size * (np.outer(np.cos(angles), first) + np.outer(np.sin(angles), second))

    # -- the way ----------------------------------------------------------------------------------

    @cached_property
    def _reach(self) -> float:
        """Largest length of a bond: the one between perfect neighbours, and half a step more."""
        return reach_of_shells(self.frame)

    @cached_property
    def _images(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, scipy.spatial.cKDTree]:
        """Atoms and their images around the cell: positions, numbers, images; and their tree."""
        points, numbers, offsets = self.cell.with_ghosts(self.places, 2 * self._reach)
        return points, numbers, offsets, scipy.spatial.cKDTree(points)

    def _place(self, site: Site) -> np.ndarray:
        """Position of an atom in one of its images."""
        return self.places[site[0]] + np.array(site[1:]) @ self.cell.vectors

    def _nearest_image(self, gap: np.ndarray) -> tuple[int, int, int]:
        """Periods that make a step the shortest; in oblique cells rounding does not suffice."""
        near = np.where(self.cell.periodic, -np.rint(gap @ self.cell.inverse), 0)
        # The shortest is no longer than this one: the heights bound its fractional coordinates.
        length = np.linalg.norm(gap + near @ self.cell.vectors)
        reach = np.ceil(length / self.cell.heights - 0.5) * self.cell.periodic
        ranges = [range(-n, n + 1) for n in np.maximum(reach, 0).astype(int).tolist()]
        more = np.array(sorted(product(*ranges), key=lambda one: sum(map(abs, one))))
        sizes = np.linalg.norm(gap + (near + more) @ self.cell.vectors, axis=1)
        # Rounding does not decide between equals: the one found by rounding stays.
        best = more[int((sizes <= sizes.min() * (1 + 1e-9)).argmax())]
        x, y, z = (near + best).astype(int).tolist()
        return x, y, z

    def nearest(self, place: np.ndarray) -> Site:
        """The atom nearest to a position."""
        inside, moved = self.cell.wrapped(place[None])
        _, numbers, offsets, tree = self._images
        distance, k = tree.query(inside[0])
        if distance > self._reach:
            raise CrystalError(
                f"expected a circle among atoms, got no atom within {self._reach:.4g} of "
                f"{checks.shown(place.round(6).tolist())}. Is the centre in the crystal, and the "
                "radius in the unit of the positions?"
            )
        image = (offsets[k] - moved[0]).tolist()
        return int(numbers[k]), image[0], image[1], image[2]

    def _through(self, sites: Sequence[Site]) -> AtomCircuit:
        """The circuit along bonds from site to site."""
        path, steps = [sites[0]], []
        for start, end in pairwise(sites):
            on, labels = self._way(start, end)
            path += on
            steps += labels
        return AtomCircuit.of(
            tuple(site[0] for site in path),
            # Images refer to the positions as given.
            np.array([site[1:] for site in path]) + self.moved[[site[0] for site in path]],
            np.array(steps, dtype=np.int64).reshape(-1, 3),
            self.frame,
        )

    def _way(self, one: Site, two: Site) -> tuple[list[Site], list[np.ndarray]]:
        """The shortest path along bonds next to the straight line, and the labels of its bonds."""
        start, end = self._place(one), self._place(two)
        sites = self._near(start, end)
        place_of = {site: k for k, site in enumerate(sites)}
        points = np.array([self._place(site) for site in sites])
        pairs = scipy.spatial.cKDTree(points).query_pairs(self._reach, output_type="ndarray")
        atoms = np.array([site[0] for site in sites])
        # Only one sense of each bond is read, so that the two senses are opposite whole numbers.
        first, second = np.where(
            atoms[pairs[:, :1]] <= atoms[pairs[:, 1:]], pairs, pairs[:, ::-1]
        ).T
        vectors = points[second] - points[first]
        labels = self.decoded(vectors, atoms[first], atoms[second])
        limit = self.frame.lattice.nearest / 2
        clear = (self.frame.apart(vectors, labels) < limit) & labels.any(axis=1)
        first, second, labels = first[clear], second[clear], labels[clear]
        lengths = np.linalg.norm(vectors[clear], axis=1)
        # Before 1.15, scipy finds paths only in tables with short indices.
        ends = (first.astype(np.int32), second.astype(np.int32))
        table = scipy.sparse.coo_array((lengths, ends), shape=(len(sites),) * 2)
        source, target = place_of[one], place_of[two]
        _, before = scipy.sparse.csgraph.dijkstra(
            table.tocsr(), directed=False, indices=source, return_predecessors=True
        )
        back = [target]
        while back[-1] != source:
            previous = int(before[back[-1]])
            if previous < 0:
                raise CrystalError(
                    f"atoms {one[0]} and {two[0]}: expected bonds between them that are lattice "
                    "vectors, got a core, a void or a stacking fault. Lead the circuit around it. "
                    "Where a fault reaches the surface, dislocations(partials=True) finds the "
                    "partial dislocation at its edge."
                )
            back.append(previous)
        way = back[::-1]
        bonds = {(a, b): v for a, b, v in zip(first.tolist(), second.tolist(), labels, strict=True)}
        path_labels = [bonds[a, b] if (a, b) in bonds else -bonds[b, a] for a, b in pairwise(way)]
        return [sites[k] for k in way[1:]], path_labels

    def _near(self, start: np.ndarray, end: np.ndarray) -> list[Site]:
        """Atoms, with their images, next to a straight line."""
        _, numbers, offsets, tree = self._images
        count = max(int(np.linalg.norm(end - start) / self._reach * 2), 1)
        line = start + np.linspace(0, 1, count + 1)[:, None] * (end - start)
        inside, moved = self.cell.wrapped(line)
        sites = {
            (int(numbers[k]), *(offsets[k] - shift).tolist())
            for near, shift in zip(tree.query_ball_point(inside, self._reach), moved, strict=True)
            for k in near
        }
        return sorted(sites)


@dataclass(frozen=True, eq=False)
class GrainCircuits:
    """Makes circuits in a polycrystal, as `AtomCircuits` does in a single crystal.

    whole: of all atoms. grains: the grain of each atom. single: circuits in each single grain.

    A circuit through a wall has no Burgers vector: bonds there are vectors of neither lattice.
    """

    whole: AtomCircuits
    grains: Grains
    single: Callable[[int], AtomCircuits]

    def __call__(self, atoms: Sequence[int]) -> AtomCircuit:
        """The circuit through atoms of one grain, from each to the nearest image of the next.

        Raises
        ------
        CrystalError
            As in a single crystal, or atoms are in two grains or in none.
        """
        last = len(self.grains.number) - 1
        numbers = [
            checks.count(k, f"atoms[{j}]", CrystalError, 0, last)
            for j, k in enumerate(checks.entries(checks.rows(atoms), "atoms", CrystalError))
        ]
        number = self._one_grain(numbers)
        inside = self.grains[number].atoms
        return self._named(number, self.single(number)(np.searchsorted(inside, numbers).tolist()))

    def around(self, point: ArrayLike, normal: ArrayLike, radius: float) -> AtomCircuit:
        """The circuit along a circle within one grain; as in a single crystal.

        Raises
        ------
        CrystalError
            As in a single crystal, or the circle meets a wall.
        """
        rim = self.whole.rim(point, normal, radius)
        number = self._one_grain([self.whole.nearest(place)[0] for place in rim])
        return self._named(number, self.single(number).around(point, normal, radius))

    def _one_grain(self, atoms: Sequence[int]) -> int:
        """The common grain of all these atoms."""
        atom = {int(self.grains.number[k]): k for k in reversed(atoms)}
        inside = sorted(number for number in atom if number >= 0)
        if len(inside) > 1:
            one, other = inside[:2]
            how = self.grains.wall(one, other).description
            raise CrystalError(
                f"expected a circuit within one grain, got atom {atom[one]} in grain {one} and "
                f"atom {atom[other]} in grain {other}, {how}. Lead the circuit through one of "
                "them: it cannot cross the wall between them."
            )
        if len(inside) < len(atom):
            code = max(number for number in atom if number < 0)
            where = "a region without a lattice"
            if code == Nowhere.wall:
                where = self._where(atom[code])
            raise CrystalError(
                f"expected a circuit within one grain, got atom {atom[code]} in {where}. Lead "
                "the circuit through a grain."
            )
        if not inside:
            raise CrystalError("atoms: expected three or more different atoms, got none.")
        return inside[0]

    def _where(self, atom: int) -> str:
        """The wall that contains an atom, in words."""
        for wall in self.grains.walls:
            if (wall.atoms == atom).any():
                one, other = wall.grains
                return f"the wall between grains {one} and {other}, {wall.description}"
        return "a wall"

    def _named(self, number: int, circuit: AtomCircuit) -> AtomCircuit:
        """The circuit with the atom numbers of the polycrystal."""
        inside = self.grains[number].atoms
        return replace(circuit, atoms=tuple(int(inside[k]) for k in circuit.atoms))
