"""Plane crystal: atom columns or particles in a plane, their grains, strain and dislocations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar

import numpy as np
import scipy  # loads its subpackages at first use
from numpy.typing import ArrayLike

from geomtorsion.errors import CrystalError
from geomtorsion.loops import Cochain, Complex
from geomtorsion.materials.crystals.plane_grains import (
    LEAST,
    PlaneGrain,
    angles_of,
    filled,
    grains_of,
    rotations,
)
from geomtorsion.materials.crystals.plane_lattices import (
    LATTICES,
    PlaneLattice,
    common_steps,
    directions,
    is_regular,
    name_of,
    nearest_steps,
    regular_lattice,
)
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import Plot, figure_by


@dataclass(frozen=True)
class PlaneDislocation:
    """A dislocation in a plane: a point with a Burgers vector.

    position, burgers: coordinates. burgers_lattice: in lattice vectors of its grain, exact.
    """

    position: tuple[float, float]
    burgers: tuple[float, float]
    burgers_lattice: tuple[Fraction, Fraction]
    grain: int

    def __repr__(self) -> str:
        b = ", ".join(map(str, self.burgers_lattice))
        x, y = self.position
        return f"PlaneDislocation(b = [{b}] at ({x:.6g}, {y:.6g}), grain {self.grain})"


@dataclass(frozen=True, eq=False, repr=False, init=False)
class PlaneCrystal:
    """Atoms of a crystal in a plane, and the lattice vectors of the steps between neighbours.

    Equation
    --------
    e(step) = the lattice vector nearest to the step in the local direction of the lattice; T = de
    on each Delaunay triangle. A dislocation is a group of triangles with T not zero, and b is the
    sum of their T: the closed integral of e around them, anticlockwise.

    positions: shape (atoms, 2). cell: edges as rows, shape (2, 2), or (2,) for edges along x and y;
    None where nothing is periodic. periodic: along which edges the cell repeats. lattice:
    hexagonal, square or honeycomb; determined from the atoms by default. A single crystal may have
    any other lattice with one atom in its cell.

    Raises
    ------
    CrystalError
        Positions are not atoms in a plane, the cell does not fit, or there is no lattice.

    Examples
    --------
    >>> from geomtorsion.materials.crystals import Crystal
    >>> i, j = np.mgrid[-12:13, -12:13].reshape(2, -1)
    >>> x, y = i + j / 2, j * np.sqrt(3) / 2
    >>> shift = np.arctan2(y - 0.3, x - 0.2) / (2 * np.pi)
    >>> crystal = Crystal(np.column_stack([x + shift, y]))
    >>> crystal.dislocations()
    (PlaneDislocation(b = [-1, 0] at (0.423916, 0.288675), grain 0),)
    """

    positions: np.ndarray
    cell: np.ndarray | None
    periodic: tuple[bool, bool]
    species: tuple[str, ...] | None
    _lattice: str | None
    _where: str

    def __init__(
        self,
        positions: ArrayLike,
        cell: ArrayLike | None = None,
        periodic: Sequence[bool] = (True, True),
        lattice: str | None = None,
        species: Sequence[str] | None = None,
    ) -> None:
        places = checks.array(positions, "positions", CrystalError, shape=(None, 2))
        if len(places) < LEAST:
            raise CrystalError(
                f"positions: expected {LEAST} or more atoms, so that a crystal can be recognized, "
                f"got {len(places)}. Repeat the cell."
            )
        wraps = checks.flags(periodic, 2, "periodic", CrystalError)
        if lattice is not None:
            checks.known_name(lattice, tuple(LATTICES), "lattice in a plane", CrystalError)
        names = None
        if species is not None:
            names = tuple(map(str, checks.entries(species, "species", CrystalError)))
            checks.check_one_each(names, len(places), "atoms", "species", CrystalError)
        edges = None if cell is None else _edges(cell)
        values = {
            "positions": checks.measured(places, "positions", CrystalError),
            "cell": edges,
            "periodic": tuple(bool(one) and edges is not None for one in wraps),
            "species": names,
            "_lattice": lattice,
            "_where": "",
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def from_file(self, where: str) -> PlaneCrystal:
        """The same crystal; errors of its recognition name a file and frame."""
        periodic, lattice = self.periodic, self._lattice
        crystal = PlaneCrystal(self.positions, self.cell, periodic, lattice, self.species)
        object.__setattr__(crystal, "_where", f"{where}: ")
        return crystal

    @property
    def count(self) -> int:
        """Number of atoms."""
        return len(self.positions)

    # -- neighbours -------------------------------------------------------------------------------

    @cached_property
    def _images(self) -> tuple[np.ndarray, np.ndarray]:
        """Atoms and their periodic images near the cell, and the number of the atom of each."""
        if self.cell is None or not any(self.periodic):
            return self.positions, np.arange(self.count)
        shares = self.positions @ np.linalg.inv(self.cell)
        shares[:, list(self.periodic)] %= 1.0
        area = abs(np.linalg.det(self.cell))
        heights = area / np.linalg.norm(self.cell[::-1], axis=1)
        margin = 5 * np.sqrt(area / self.count) / heights
        ranges = [range(-1, 2) if wraps else range(1) for wraps in self.periodic]
        images, numbers = [shares], [np.arange(self.count)]
        for shift in ((i, j) for i in ranges[0] for j in ranges[1] if (i, j) != (0, 0)):
            moved = shares + np.array(shift)
            near = ((moved > -margin) & (moved < 1 + margin))[:, list(self.periodic)].all(axis=1)
            images.append(moved[near])
            numbers.append(np.flatnonzero(near))
        return np.concatenate(images) @ self.cell, np.concatenate(numbers)

    @cached_property
    def _around(self) -> tuple[np.ndarray, np.ndarray]:
        """Numbers of the atoms around each, and the steps to them."""
        points, number = self._images
        near, steps = nearest_steps(points, self.count)
        return number[near], steps

    @cached_property
    def _triangles(self) -> np.ndarray:
        """Delaunay triangles with a middle in the cell, anticlockwise, as numbers of images.

        Triangles with long sides are omitted in the bays of the rim, but not in holes, where the
        labels of their sides cancel in the sum around the hole.
        """
        points, _ = self._images
        try:
            made = scipy.spatial.Delaunay(points)
        except scipy.spatial.QhullError:
            raise CrystalError(
                f"{self._where}positions: expected atoms in a plane, got all on one line. Give "
                "the columns of a plane."
            ) from None
        corners = made.simplices.astype(np.int64)
        sides = points[corners] - points[np.roll(corners, -1, axis=1)]
        reach = 2.5 * float(np.median(np.abs(self._around[1][:, 0])))
        long = (np.linalg.norm(sides, axis=2) > reach).any(axis=1)
        corners = corners[~_outside(made.neighbors, long)]
        sides = np.diff(points[corners], axis=1)
        turned = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0] < 0
        corners[turned] = corners[turned][:, ::-1]
        if self.cell is not None:
            middles = points[corners].mean(axis=1) @ np.linalg.inv(self.cell)
            wraps = list(self.periodic)
            corners = corners[((middles >= 0) & (middles < 1))[:, wraps].all(axis=1)]
        return corners

    # -- the lattice ------------------------------------------------------------------------------

    @cached_property
    def _frame(self) -> _PlaneFrame:
        """The lattice, the grain of each atom, and the steps of its lattice there."""
        numbers, steps = self._around
        common = None if self._lattice else common_steps(steps)
        if common is not None and not is_regular(common):
            # One orientation, and a lattice without a rotation that would give it locally.
            own = np.zeros(self.count, dtype=np.int64)
            base = np.broadcast_to(common, (self.count, 2, 2))
            return _PlaneFrame(None, own, base, np.zeros(self.count))
        lattice = LATTICES[self._lattice] if self._lattice else regular_lattice(steps)
        order = directions(steps, lattice)
        near = numbers[:, : lattice.neighbours]
        smooth = (order + order[near].sum(axis=1)) / (1 + lattice.neighbours)
        grain = grains_of(smooth, near, lattice)
        if not (grain >= 0).any():
            raise CrystalError(
                f"{self._where}positions: expected a lattice in a plane (hexagonal, square or "
                "honeycomb, or a single crystal), got atoms without common directions. Give atoms "
                "of one layer, or a mean over time."
            )
        angle = angles_of(smooth, near, grain, lattice)
        grain, source = filled(grain, numbers)
        angle, base = angle[source], np.empty((self.count, 2, 2))
        for number in range(grain.max() + 1):
            mine = np.flatnonzero(grain == number)
            size = float(np.median(np.abs(steps[mine][:, : lattice.neighbours])))
            base[mine] = size * rotations(angle[mine]) @ lattice.base
            angle[mine] -= angle[mine].mean()
        return _PlaneFrame(lattice, grain, base, angle)

    @cached_property
    def _labels(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Labels of the sides of each triangle within a grain, shape (triangles, 3, 2), the sides,
        and the triangles, as numbers of images."""
        points, number = self._images
        frame, corners = self._frame, self._triangles
        atoms = number[corners]
        within = (frame.grain[atoms] == frame.grain[atoms[:, :1]]).all(axis=1)
        corners, atoms = corners[within], atoms[within]
        after = np.roll(corners, -1, axis=1)
        sides = points[after] - points[corners]
        base = (frame.base[atoms] + frame.base[np.roll(atoms, -1, axis=1)]) / 2
        labels = np.rint(np.linalg.solve(base, sides[..., None])[..., 0])
        return labels.astype(np.int64), sides, corners

    @cached_property
    def _cells(self) -> np.ndarray:
        """Mean steps of each grain as columns, shape (grains, 2, 2), by least squares."""
        labels, sides, corners = self._labels
        closed = ~labels.sum(axis=1).any(axis=1)
        atoms = self._images[1][corners]
        grain = self._frame.grain[atoms[:, 0]]
        # Sides in the mean direction of the grain, which a bend would shorten otherwise.
        turn = (self._frame.turn[atoms] + self._frame.turn[np.roll(atoms, -1, axis=1)]) / 2
        sides = np.einsum("tsij,tsj->tsi", rotations(-turn), sides)
        cells = []
        for number in range(self._frame.grain.max() + 1):
            mine = closed & (grain == number)
            if not mine.any():
                raise CrystalError(
                    f"{self._where}positions: expected a lattice, got atoms in grain {number} "
                    "without closed triangles. Give atoms with less noise."
                )
            whole, found = labels[mine].reshape(-1, 2).astype(float), sides[mine].reshape(-1, 2)
            cells.append(np.linalg.lstsq(whole, found, rcond=None)[0].T)
        return np.array(cells)

    @property
    def grain(self) -> np.ndarray:
        """Number of the grain of each atom, shape (atoms,)."""
        return self._frame.grain

    @cached_property
    def grains(self) -> tuple[PlaneGrain, ...]:
        """Grains, the largest first."""
        lattice, found = self._frame.lattice, []
        for number, base in enumerate(self._cells):
            vectors = base if lattice is None else base @ lattice.cell
            name = "honeycomb" if lattice is LATTICES["honeycomb"] else name_of(vectors)
            atoms = np.flatnonzero(self.grain == number)
            found.append(PlaneGrain(number, atoms, vectors.T, name))
        return tuple(found)

    @property
    def lattice(self) -> str:
        """Name of the lattice of the largest grain."""
        return self.grains[0].lattice

    @property
    def constant(self) -> float:
        """Length of the first lattice vector of the largest grain."""
        return self.grains[0].constant

    @cached_property
    def deformation(self) -> np.ndarray:
        """F at each atom, from the mean lattice of its grain, shape (atoms, 2, 2).

        By least squares over the steps to neighbours in closed triangles; NaN where there are none.
        """
        labels, sides, corners = self._labels
        closed = ~labels.sum(axis=1).any(axis=1)
        atoms = self._images[1][corners[closed]]
        whole, found = labels[closed].astype(float), sides[closed]
        moments, products = np.zeros((2, self.count, 2, 2))
        for ends in (atoms, np.roll(atoms, -1, axis=1)):
            np.add.at(moments, ends, np.einsum("tsi,tsj->tsij", found, whole))
            np.add.at(products, ends, np.einsum("tsi,tsj->tsij", whole, whole))
        result = np.full((self.count, 2, 2), np.nan)
        full = np.linalg.det(products) > 0.5
        ideal = np.linalg.inv(self._cells)[self.grain[full]]
        result[full] = moments[full] @ np.linalg.inv(products[full]) @ ideal
        return result

    @cached_property
    def strain(self) -> np.ndarray:
        """Strain (F^T F - 1) / 2 at each atom, from the mean lattice of its grain, (atoms, 2, 2).

        NaN where the neighbours are not known.
        """
        f = self.deformation
        return (np.swapaxes(f, 1, 2) @ f - np.eye(2)) / 2

    # -- dislocations -----------------------------------------------------------------------------

    def dislocations(self) -> tuple[PlaneDislocation, ...]:
        """Dislocations inside grains, sorted by position; pairs in one core cancel.

        Vacancies and interstitial atoms have no b; a hole has the b of a circuit around it. Cores
        that touch the rim or a boundary of grains have no circuit around them and are omitted.
        """
        labels, _, corners = self._labels
        points, number = self._images
        torn = np.flatnonzero(np.any(labels.sum(axis=1), axis=1))
        if not len(torn):
            return ()
        b, atoms = labels[torn].sum(axis=1), number[corners[torn]]
        pairs = np.stack([np.repeat(np.arange(len(torn)), 3), atoms.ravel()])
        table = scipy.sparse.csr_array(
            (np.ones(3 * len(torn)), pairs), shape=(len(torn), self.count)
        )
        count, group = scipy.sparse.csgraph.connected_components(table @ table.T)
        found = []
        lattice = self._frame.lattice
        cell = np.eye(2) if lattice is None else lattice.cell
        whole = np.rint(np.linalg.det(cell))
        # Adjugate: whole numbers, so that the division is exact.
        adjugate = np.array([[cell[1, 1], -cell[0, 1]], [-cell[1, 0], cell[0, 0]]])
        at_rim: np.ndarray = np.any(self._rim[atoms], axis=1)
        for k in range(count):
            mine = group == k
            total = b[mine].sum(axis=0)
            # A core that touches the rim has no circuit around it.
            if not total.any() or at_rim[mine].any():
                continue
            places = points[corners[torn[mine]]].mean(axis=1)
            place = self._middle(places)
            of = int(self.grain[atoms[mine][0, 0]])
            exact = [Fraction(int(x), int(whole)) for x in np.rint(adjugate @ total)]
            turn = rotations(self._frame.turn[atoms[mine]].mean())
            vector = turn @ self._cells[of] @ total
            found.append(PlaneDislocation(
                (float(place[0]), float(place[1])), (float(vector[0]), float(vector[1])),
                (exact[0], exact[1]), of,
            ))  # fmt: skip
        return tuple(sorted(found, key=lambda one: one.position))

    @property
    def _rim(self) -> np.ndarray:
        """Whether each atom is at the end of a side with a triangle on one side only, (atoms,)."""
        atoms = self._images[1][self._labels[2]]
        ends = np.stack([atoms, np.roll(atoms, -1, axis=1)], axis=-1).reshape(-1, 2)
        pairs, count = np.unique(np.sort(ends, axis=1), axis=0, return_counts=True)
        rim = np.zeros(self.count, dtype=bool)
        rim[pairs[count == 1]] = True
        return rim

    def _middle(self, places: np.ndarray) -> np.ndarray:
        """Mean of places that may be on two sides of a periodic cell."""
        if self.cell is None:
            return places.mean(axis=0)
        shares = (places - places[0]) @ np.linalg.inv(self.cell)
        wraps = list(self.periodic)
        shares[:, wraps] -= np.rint(shares[:, wraps])
        place = places[0] @ np.linalg.inv(self.cell) + shares.mean(axis=0)
        place[wraps] %= 1.0
        return place @ self.cell

    @cached_property
    def bonds(self) -> Cochain:
        """Labels of the sides of triangles within grains, in steps of the lattice, as a cochain."""
        labels, _, corners = self._labels
        atoms = self._images[1][corners]
        ends = np.stack([atoms, np.roll(atoms, -1, axis=1)], axis=-1).reshape(-1, 2)
        forward = ends[:, 0] < ends[:, 1]
        pairs = np.sort(ends, axis=1)
        values = np.where(forward[:, None], 1, -1) * labels.reshape(-1, 2)
        _, first = np.unique(pairs, axis=0, return_index=True)
        return Cochain(Complex.of_edges(pairs[first], self.count), values[first])

    plot: ClassVar[Plot] = figure_by("plane_crystals", "draw_plane_crystal")

    def __repr__(self) -> str:
        size = f"{self.count:,} atoms in a plane, {len(self.grains)} grain"
        return (
            f"PlaneCrystal({size}{'s' * (len(self.grains) != 1)}, {self.lattice}, "
            f"a = {self.constant:.6g})"
        )


@dataclass(frozen=True, eq=False)
class _PlaneFrame:
    """The lattice around each atom.

    lattice: None for any lattice of a single crystal. grain: of each atom. base: shortest steps as
    columns, shape (atoms, 2, 2). turn: from the mean direction of the grain, rad, shape (atoms,).
    """

    lattice: PlaneLattice | None
    grain: np.ndarray
    base: np.ndarray
    turn: np.ndarray


def _outside(neighbours: np.ndarray, long: np.ndarray) -> np.ndarray:
    """Long triangles that are connected with the rim by long triangles, shape (triangles,).

    neighbours: of each triangle, -1 at the rim, shape (triangles, 3).
    """
    first, second = np.repeat(np.arange(len(long)), 3), neighbours.ravel()
    both = (second >= 0) & long[first] & long[second]
    graph = scipy.sparse.csr_array(
        (np.ones(int(both.sum())), (first[both], second[both])), shape=(len(long), len(long))
    )
    count, group = scipy.sparse.csgraph.connected_components(graph, directed=False)
    at_rim = np.zeros(count, dtype=bool)
    at_rim[group[long & (neighbours < 0).any(axis=1)]] = True
    return long & at_rim[group]


def _edges(given: ArrayLike) -> np.ndarray:
    """Edges of the cell as rows."""
    edges = checks.array(given, "cell", CrystalError)
    edges = np.diag(edges) if edges.shape == (2,) else edges
    if edges.shape != (2, 2) or not abs(np.linalg.det(edges)) > 0:
        raise CrystalError(
            f"cell: expected two edges that span a plane, as rows, got "
            f"{checks.shown(np.asarray(given).tolist())}. Give two lengths or two edges."
        )
    return edges


def plane_of(
    positions: Any, cell: Any, periodic: Sequence[bool]
) -> tuple[np.ndarray, Any, Any] | None:
    """Positions in a plane, cell and periodic edges, of atoms in a plane; None for others.

    Atoms in space are in a plane across a coordinate axis if they are less than a tenth of their
    distance apart along it, and are not repeated within a few distances.
    """
    places = np.asarray(positions) if isinstance(positions, np.ndarray | list | tuple) else None
    if places is None or places.ndim != 2 or places.dtype.kind not in "fiu":
        return None
    if places.shape[1] == 2:
        flags = periodic[:2] if isinstance(periodic, Sequence) and len(periodic) == 3 else periodic
        return places, cell, flags
    if places.shape[1] != 3 or len(places) < LEAST or not np.isfinite(places).all():
        return None
    return _across_an_axis(places, cell, periodic)


def _across_an_axis(
    places: np.ndarray, cell: Any, periodic: Sequence[bool]
) -> tuple[np.ndarray, Any, Any] | None:
    """The same for atoms in space, shape (n, 3)."""
    sizes = np.ptp(places, axis=0)
    k = int(sizes.argmin())
    others = [axis for axis in range(3) if axis != k]
    distance = _distance(places[:, others])
    if not sizes[k] < distance / 10:
        return None
    if cell is None:
        return places[:, others], None, (True, True)
    edges = np.asarray(cell, dtype=float)
    edges = np.diag(edges) if edges.shape == (3,) else edges
    flags = list(np.broadcast_to(np.asarray(periodic, dtype=bool), 3))
    is_flat = edges.shape == (3, 3) and not edges[others, k].any()
    if not is_flat or (flags[k] and not edges[k, k] > 4 * distance):
        return None
    return places[:, others], edges[np.ix_(others, others)], [bool(flags[j]) for j in others]


def _distance(places: np.ndarray) -> float:
    """About the distance of neighbours in a plane."""
    # The middle of the atoms decides, so that single ones far away do not.
    low, high = np.quantile(places, (0.1, 0.9), axis=0)
    return float(np.sqrt(np.prod((high - low) / 0.8) / len(places)))
