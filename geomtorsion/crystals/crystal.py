"""Crystal: atoms whose bonds are lattice vectors, and the dislocations between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from geomtorsion import checks
from geomtorsion.crystals.circuits import AtomCircuits
from geomtorsion.crystals.faults import SIXTHS, fault_shifts
from geomtorsion.crystals.frames import (
    Fit,
    Frame,
    fitted,
    likely_lattice,
    neighbour_vectors,
    sampled,
    single_frame,
)
from geomtorsion.crystals.lattices import lattice_named
from geomtorsion.crystals.method import METHOD
from geomtorsion.crystals.networks import network_of
from geomtorsion.crystals.shells import dilated, shells_of
from geomtorsion.crystals.torsion import Torsion
from geomtorsion.crystals.triangulation import Cell, Triangulation, triangulated
from geomtorsion.errors import CrystalError
from geomtorsion.loops.cochain import Cochain
from geomtorsion.loops.complexes import Complex
from geomtorsion.loops.dislocation_network import DislocationNetwork


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Crystal:
    """Atoms of a crystal, and the integer 1-cochain of their bonds.

    Equation
    --------
    e(bond) = the lattice vector nearest to the bond; T = de, the closure failure of every triangle:
    dT = 0 exactly, and dislocation lines are where T is not zero. b = closed integral of e
    (conventions.py), in the coordinates of the positions.

    positions: shape (atoms, 3), in any unit of length.
    cell: edges of the cell as rows, shape (3, 3) or (3,) where they lie along the coordinates; None
        where nothing is periodic.
    periodic: along which edges the cell repeats, shape (3,).
    species: of each atom, if known: it decides nothing here.

    lattice, orient and constant are found where they are not given.

    Raises
    ------
    CrystalError
        Positions are no atoms in space, the cell does not fit them, or they are no crystal.

    Examples
    --------
    >>> from itertools import product
    >>> sites = [np.add(cell, site) for cell in product(range(4), repeat=3)
    ...          for site in ((0, 0, 0), (0.5, 0.5, 0.5))]
    >>> crystal = Crystal(np.array(sites) * 3.2, cell=[12.8] * 3)
    >>> crystal.lattice, round(crystal.constant, 9), crystal.share, crystal.dislocations().lines
    ('bcc', 3.2, 1.0, ())
    """

    positions: np.ndarray
    cell: np.ndarray | None
    periodic: np.ndarray
    species: tuple[str, ...] | None
    _given: tuple[str | None, np.ndarray | None, float | None]

    def __init__(
        self,
        positions: ArrayLike,
        cell: ArrayLike | None = None,
        periodic: Sequence[bool] = (True, True, True),
        lattice: str | None = None,
        orient: ArrayLike | None = None,
        constant: float | None = None,
        species: Sequence[str] | None = None,
    ) -> None:
        def put(name: str, value: object) -> None:
            object.__setattr__(self, name, value)

        put("positions", checks.array(positions, "positions", CrystalError, shape=(None, 3)))
        put("cell", None if cell is None else _cell(cell))
        flags = checks.entries(checks.rows(periodic), "periodic", CrystalError)
        if len(flags) != 3 or any(flag not in (0, 1) for flag in flags):
            raise CrystalError(
                f"periodic: three truth values were needed, but {checks.shown(flags)} came."
            )
        put("periodic", np.array(flags, dtype=bool) & (cell is not None))
        if lattice is not None:
            lattice_named(lattice)
        put("_given", (lattice, _rotation(orient), _constant(constant)))
        put("species", None)
        if species is not None:
            names = checks.entries(species, "species", CrystalError)
            if len(names) != len(self.positions):
                raise CrystalError(
                    f"species: one for each of {len(self.positions)} atoms was needed, but "
                    f"{len(names)} came."
                )
            put("species", tuple(map(str, names)))

    # -- how it lies ------------------------------------------------------------------------------

    @property
    def lattice(self) -> str:
        """ "fcc", "bcc", "hcp" or "diamond"."""
        return self.frame.lattice.name

    @property
    def orient(self) -> np.ndarray:
        """Crystal axes from specimen axes, a rotation, shape (3, 3): v_crystal = orient @ v."""
        return self.frame.orient

    @property
    def constant(self) -> float:
        """Lattice constant a, in the unit of the positions."""
        return self.frame.constant

    @property
    def frame(self) -> Frame:
        """Lattice, orientation and lattice constant together."""
        return self._found[0]

    @property
    def share(self) -> float:
        """Share of the atoms whose neighbours are all where the lattice has them."""
        return float(self._found[1].whole.mean())

    @cached_property
    def _found(self) -> tuple[Frame, Fit]:
        """The frame, and how a sample of the atoms fits into it."""
        name, orient, constant = self._given
        if len(self.positions) < 20:
            raise CrystalError(
                f"positions: 20 atoms or more were needed to tell a crystal, but "
                f"{len(self.positions)} came. Repeat the cell."
            )
        numbers = sampled(len(self.positions))
        vectors = self._neighbours(16, numbers)
        if name is None:
            found = likely_lattice(vectors, orient, constant)
        else:
            found = single_frame(lattice_named(name), vectors, orient, constant)
        share = float(found[1].whole.mean())
        if name is not None and share < 0.5:
            other = likely_lattice(vectors)
            # Without a doubt it is another one.
            if other[0].lattice.name != name and other[1].whole.mean() > 2 * share:
                raise CrystalError(
                    f"lattice: the neighbours of {other[1].whole.mean():.1%} of the atoms fit into "
                    f"{other[0].lattice.name}, but {name} came, into which {share:.1%} fit. Name "
                    "that one, or none."
                )
        if share < METHOD.share:
            raise CrystalError(
                f"positions: a crystal was needed ({name or 'fcc, bcc, hcp or diamond'}), but of "
                f"only {share:.1%} of the atoms the neighbours fit, as in a liquid. Name the "
                "lattice, or cut out the part that is crystalline."
            )
        return found

    def _neighbours(self, count: int, atoms: np.ndarray) -> np.ndarray:
        """Vectors to the nearest neighbours of some atoms, shape (atoms, count, 3)."""
        places, cell = self._wrapped[0], self._box
        # As many atoms as are asked for lie within this, whatever the structure.
        volume = _spanned(self.positions, self._box)
        reach = 3 * (volume / len(places)) ** (1 / 3)
        return neighbour_vectors(places, cell, count, atoms, reach)

    @cached_property
    def _box(self) -> Cell:
        """The cell, or any where nothing is periodic."""
        vectors = np.eye(3) if self.cell is None else self.cell
        return Cell(vectors, self.periodic)

    @cached_property
    def _wrapped(self) -> tuple[np.ndarray, np.ndarray]:
        """Positions in the cell and the periods added to each."""
        return self._box.wrapped(self.positions)

    # -- bonds ------------------------------------------------------------------------------------

    @cached_property
    def mesh(self) -> Triangulation:
        """The Delaunay tetrahedra between the atoms."""
        reach = METHOD.reach * self.frame.lattice.nearest * self.constant
        return triangulated(self._wrapped[0], self._box, reach)

    @cached_property
    def kinds(self) -> np.ndarray:
        """Which of the two sublattices of hcp and diamond each atom lies on, shape (atoms,)."""
        lattice = self.frame.lattice
        if not lattice.basis:
            return np.zeros(len(self.positions), dtype=np.int64)
        vectors = self._neighbours(lattice.shells, np.arange(len(self.positions)))
        return fitted(self.frame, vectors).kind

    def labels(self, pairs: ArrayLike | None = None, images: ArrayLike | None = None) -> np.ndarray:
        """The lattice vectors of bonds, whole numbers in units of `frame.lattice.units`, (k, 3).

        Of fcc and bcc they count halves of the lattice constant.

        Parameters
        ----------
        pairs
            Numbers of the two atoms of each bond, shape (k, 2); those of `bonds` if not given.
        images
            How many periods further the second atom is meant, shape (k, 3); none if not given.
        """
        if pairs is None:
            return self.bonds.values
        made = Complex.of_edges(
            np.asarray(pairs), len(self.positions), None if images is None else np.asarray(images)
        )
        first, second = made.pairs.T
        steps = self.positions[second] - self.positions[first]
        if made.images.shape[1] == 3:
            steps = steps + made.images @ self._box.vectors
        return self._decoded(steps, first, second)

    def _decoded(self, steps: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
        """Labels of steps between atoms."""
        shift = self.kinds[second] - self.kinds[first]
        return self.frame.lattice.decode(self.frame.values(steps), shift)

    @cached_property
    def bonds(self) -> Cochain:
        """e: the label of every Delaunay edge, an integer cochain with periodic images."""
        pairs, images, _ = self.mesh.edges
        moved = self._wrapped[1]
        first, second = pairs.T
        offsets = images + moved[second] - moved[first]
        made = Complex.of_edges(pairs, len(self.positions), offsets)
        return Cochain(made, self.torsion.labels)

    @cached_property
    def torsion(self) -> Torsion:
        """T = de on the faces of the Delaunay tetrahedra."""
        return self._torsion_on(self.mesh, self.kinds)

    def _torsion_on(
        self, mesh: Triangulation, kinds: np.ndarray, partials: bool = False
    ) -> Torsion:
        """T = de on some tetrahedra."""
        pairs, images, _ = mesh.edges
        first, second = pairs.T
        places, frame = mesh.places, self.frame
        steps = places[second] - places[first] + images @ self._box.vectors
        labels = frame.lattice.decode(frame.values(steps), kinds[second] - kinds[first])
        doubtful = frame.apart(steps, labels) > frame.constant * frame.lattice.nearest / 2
        if frame.lattice.name != "fcc":
            return Torsion(mesh, frame.lattice, labels, doubtful)
        values = frame.values(steps)
        crossing, sixths = fault_shifts(frame.lattice, values, labels, pairs, len(places))
        if partials:
            return Torsion(mesh, SIXTHS, sixths, doubtful & ~crossing)
        # A fault joins its partials to one core, in which they cannot be told apart.
        return Torsion(mesh, frame.lattice, labels, doubtful | crossing)

    @cached_property
    def circuit(self) -> AtomCircuits:
        """Closed paths from atom to atom: `crystal.circuit(atoms=[...])` through atoms by number,
        `crystal.circuit.around(point, normal, radius)` along a circle; see `AtomCircuits`.

        Examples
        --------
        >>> from itertools import product
        >>> sites = np.array(list(product(range(12), repeat=3)))
        >>> crystal = Crystal(sites[sites.sum(axis=1) % 2 == 0] * 1.8, cell=[21.6] * 3)
        >>> crystal.circuit.around([10, 10, 10], [1, 1, 1], 6).burgers
        (0.0, 0.0, 0.0)
        """
        return AtomCircuits(
            self._wrapped[0], self._wrapped[1], self._box, self.frame, self._decoded
        )

    # -- dislocations -----------------------------------------------------------------------------

    def dislocations(self, partials: bool = False) -> DislocationNetwork:
        """Dislocation lines with their junctions.

        Parameters
        ----------
        partials
            Whether partial dislocations at the edges of stacking faults are told apart; if not,
            their sum is given.

        Returns
        -------
        DislocationNetwork; `.lines` have `.burgers` (coordinates), `.burgers_lattice` (lattice
        constants, exact), `.family`, `.length`, `.path`, `.kind` and `.is_closed`.
        """
        checks.flag(partials, "partials", CrystalError)
        found, vacancies = self._near_torsion(partials)
        width = METHOD.width * self.frame.lattice.nearest * self.constant
        extra = None if self._sites is None else len(self.positions) + vacancies - self._sites
        frame = replace(self.frame, lattice=found.lattice)
        return network_of(found.relaxed(), frame, width, extra)

    @cached_property
    def _sites(self) -> int | None:
        """How many sites the lattice has in a cell that is periodic along all edges."""
        if not self.periodic.all():
            return None
        lattice, values = self.frame.lattice, self.frame.values(self._box.vectors)
        periods = lattice.decode(values)
        far = self.frame.apart(self._box.vectors, periods)
        if far.max() > self.constant * lattice.nearest / 2:
            return None
        cells = abs(np.linalg.det(periods)) / abs(np.linalg.det(lattice.translations))
        return round(cells) * (2 if lattice.basis else 1)

    def _near_torsion(self, partials: bool) -> tuple[Torsion, int]:
        """The torsion, on tetrahedra where neighbours alone do not exclude it, and vacancies."""
        frame, (places, _) = self.frame, self._wrapped
        nearest = frame.lattice.nearest * frame.constant
        # In a narrow cell an atom is its own neighbour: numbers alone do not tell images.
        if (self._box.heights < 4 * nearest)[self.periodic].any():
            return self._torsion_on(self.mesh, self.kinds, partials), 0
        shells = shells_of(places, self._box, frame)
        wanted = ~shells.closed
        if wanted.mean() > 0.5:
            return self._torsion_on(self.mesh, shells.kind, partials), shells.vacancies
        while True:
            # Cores reach as far as the neighbours of what is torn.
            wanted = dilated(wanted, shells.near)
            mesh = triangulated(places, self._box, METHOD.reach * nearest, wanted)
            found = self._torsion_on(mesh, shells.kind, partials)
            beyond = found.beyond
            if not beyond.any():
                return found, shells.vacancies
            wanted |= beyond

    def __repr__(self) -> str:
        count = len(self.positions)
        axes = "".join("T" if flag else "F" for flag in self.periodic.tolist())
        return f"Crystal({count:,} atoms, {self.lattice}, a = {self.constant:.6g}, periodic {axes})"


def _cell(given: ArrayLike) -> np.ndarray:
    """Edges of the cell as rows."""
    found = checks.array(given, "cell", CrystalError)
    if found.shape == (3,):
        found = np.diag(found)
    if found.shape != (3, 3):
        raise CrystalError(
            f"cell: three edges as rows were needed, shape (3, 3), but {found.shape} came."
        )
    with np.errstate(all="ignore"):
        volume = abs(np.linalg.det(found))
        sizes = np.prod(np.linalg.norm(found, axis=1))
    if not (np.isfinite(sizes) and volume > 8 * np.finfo(float).eps * sizes):
        raise CrystalError(
            f"cell: three edges that span a volume were needed, but "
            f"{checks.shown(found.tolist())} came. Give an open box periodic=(False, False, False)."
        )
    return found


def _rotation(given: ArrayLike | None) -> np.ndarray | None:
    """A rotation, put right to the last digit."""
    if given is None:
        return None
    found = checks.array(given, "orient", CrystalError, shape=(3, 3))
    u, sizes, v = np.linalg.svd(found)
    if np.abs(sizes - 1).max() > 1e-3 or np.linalg.det(found) < 0:
        raise CrystalError(
            "orient: a rotation was needed, crystal axes from specimen axes, but "
            f"{checks.shown(found.tolist())} came. Its columns are the specimen axes in the "
            "crystal, of length one and right-handed."
        )
    return u @ v


def _constant(given: float | None) -> float | None:
    """A length."""
    return None if given is None else float(checks.positive(given, "constant", CrystalError))


def _spanned(positions: np.ndarray, cell: Cell) -> float:
    """About the volume that the atoms fill."""
    shares = positions @ cell.inverse
    sizes = np.where(cell.periodic, 1.0, np.ptp(shares, axis=0))
    return float(np.prod(sizes) * abs(np.linalg.det(cell.vectors)))
