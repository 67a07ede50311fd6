"""Crystal: atoms whose bonds are lattice vectors, and the dislocations between them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from copy import copy
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from geomtorsion.errors import CrystalError
from geomtorsion.loops import Cochain, Complex
from geomtorsion.materials.crystals.atom_circuits import AtomCircuits, GrainCircuits
from geomtorsion.materials.crystals.frames import (
    NEIGHBOURS,
    Fit,
    Frame,
    InFrame,
    check_turn,
    fitted,
    frame_of,
    sampled,
    share_within,
)
from geomtorsion.materials.crystals.given import Given, positions_of
from geomtorsion.materials.crystals.grains import Grain, Grains, in_variant, single_grain
from geomtorsion.materials.crystals.known_grains import KnownGrains
from geomtorsion.materials.crystals.lattices import Lattice
from geomtorsion.materials.crystals.method import METHOD
from geomtorsion.materials.crystals.near_torsion import Atoms, lines_of, torsion_near, torsion_on
from geomtorsion.materials.crystals.networks import network_of_grains
from geomtorsion.materials.crystals.plane_crystal import PlaneCrystal, plane_of
from geomtorsion.materials.crystals.segmentation import segmented
from geomtorsion.materials.crystals.shells import Shells, dilated, shells_of
from geomtorsion.materials.crystals.specimen import (
    Specimen,
    is_single,
    seems_many,
    share_of_lattices,
)
from geomtorsion.materials.crystals.surroundings import Places, spanned
from geomtorsion.materials.crystals.torsion import TornFaces, Torsion
from geomtorsion.materials.crystals.triangulation import Cell, Triangulation, triangulated
from geomtorsion.materials.lines.dislocation_network import DislocationNetwork
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Crystal(InFrame):
    """Atoms of a crystal, and the integer 1-cochain of their bonds.

    Equation
    --------
    e(bond) = the lattice vector nearest to the bond; T = de, the closure failure of every triangle:
    dT = 0 exactly, and dislocation lines are where T is not zero. b = closed integral of e
    (conventions.py), in the coordinates of the positions.

    positions: shape (atoms, 3), in any unit of length. For atoms in a plane, of shape (atoms, 2) or
        with one coordinate in common, the result is a `PlaneCrystal`.
    cell: edges of the cell as rows, shape (3, 3), or (3,) for edges along the coordinates; None
        where nothing is periodic.
    periodic: along which edges the cell repeats, shape (3,).
    species: of each atom, if known; not used here.

    lattice, orient and constant are determined from the atoms by default.

    Raises
    ------
    CrystalError
        Positions are not atoms in space, the cell does not fit them, or they are not a crystal.

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
    _given: Given
    _own: Grain | None
    _before: KnownGrains | None
    _where: str

    def __new__(
        cls,
        positions: ArrayLike = (),
        cell: ArrayLike | None = None,
        periodic: Sequence[bool] = (True, True, True),
        lattice: str | None = None,
        orient: ArrayLike | None = None,
        constant: float | None = None,
        species: Sequence[str] | None = None,
    ) -> Self:
        """A crystal in space, or for atoms in a plane a `PlaneCrystal`."""
        flat = plane_of(positions, cell, periodic)
        if flat is None:
            return super().__new__(cls)
        if orient is not None or constant is not None:
            raise CrystalError(
                "orient, constant: expected none of these for atoms in a plane, which have them "
                "for each grain. Omit them."
            )
        made: Any = PlaneCrystal(*flat, lattice, species)
        return made

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

        put("positions", positions_of(positions))
        inputs = Given.of(cell, periodic, lattice, orient, constant)
        put("cell", inputs.cell)
        put("periodic", inputs.box.periodic)
        put("_given", inputs)
        put("_own", None)
        put("_before", None)
        put("_where", "")
        put("species", None)
        if species is not None:
            names = checks.entries(species, "species", CrystalError)
            atoms, remedy = len(self.positions), "Give as many as positions."
            checks.check_one_each(names, atoms, "atoms", "species", CrystalError, remedy)
            put("species", tuple(map(str, names)))

    # -- its frame --------------------------------------------------------------------------------

    @property
    def count(self) -> int:
        """Number of atoms."""
        return len(self.positions)

    @property
    def frame(self) -> Frame:
        """Lattice, orientation and lattice constant together; of grain 0 in a polycrystal."""
        return self._recognized[0]

    @property
    def share(self) -> float:
        """Share of the atoms whose neighbours all fit the lattice of their grain."""
        return self._recognized[1]

    @cached_property
    def overlapping(self) -> np.ndarray:
        """Pairs of atoms at nearly one position, by number, shape (pairs, 2).

        Their distance is below a tenth of the distance of most neighbours. Circuits and lines take
        the step between them as zero.

        Examples
        --------
        >>> from itertools import product
        >>> sites = np.array(list(product(range(8), repeat=3)))
        >>> places = sites[sites.sum(axis=1) % 2 == 0] * 1.8
        >>> crystal = Crystal(np.append(places, places[:1] + 0.1, axis=0), cell=[14.4] * 3)
        >>> crystal.overlapping.tolist(), crystal.dislocations().lines
        ([[0, 256]], ())
        """
        return self._places.within(self._places.reach).overlapping

    @cached_property
    def _recognized(self) -> tuple[Frame, float]:
        """The frame, and the share of the atoms that fit, which is large enough to find lines."""
        frame, fit = self._found
        share = float(fit.whole.mean())
        if self._own is not None:
            return frame, share
        if seems_many(self._specimen, sampled(len(self.positions)), fit.whole):
            first, fitting = self.grains.grains[0].frame, self.grains.fitting
            frame, share = first, share if fitting is None else fitting
        if share < METHOD.least:
            raise CrystalError(
                f"{self._where}positions: expected a crystal, got atoms of which only {share:.1%} "
                f"have the neighbours of the likeliest lattice, {frame.lattice.name}. Give atoms "
                "with less noise, such as a cooled frame or a mean over time, or one sublattice of "
                "a compound."
            )
        return frame, share

    @cached_property
    def _found(self) -> tuple[Frame, Fit]:
        """The frame, and how well a sample of the atoms fits into it."""
        with self._naming_the_file():
            return self._in_frame()

    @contextmanager
    def _naming_the_file(self) -> Iterator[None]:
        """Errors name the file of the atoms, if they are from one."""
        try:
            yield
        except CrystalError as error:
            raise CrystalError(f"{self._where}{error}") from None

    def _in_frame(self) -> tuple[Frame, Fit]:
        """The frame that is given, or the one that is found."""
        inputs = self._given
        if self._own is not None:
            own = self._own.frame
            vectors = self._neighbours(own.lattice.shells, sampled(len(self.positions)))
            return own, fitted(own, vectors)
        if len(self.positions) < 20:
            raise CrystalError(
                f"positions: expected 20 or more atoms, so that a crystal can be recognized, got "
                f"{len(self.positions)}. Repeat the cell."
            )
        numbers = sampled(len(self.positions))
        vectors = self._neighbours(NEIGHBOURS, numbers)

        def shares(lattice: Lattice) -> dict[str, float]:
            return share_of_lattices(lattice, self._near, numbers)

        frame_and_fit = frame_of(vectors, inputs.lattice, inputs.orient, inputs.constant, shares)
        if inputs.orient is not None and self._before is None:
            check_turn(frame_and_fit[0], vectors)
        elif inputs.orient is not None and share_within(frame_and_fit[0], vectors) < METHOD.share:
            # The crystal has rotated in time: find it again, in the axes nearest to those before.
            new, _ = frame_of(vectors, inputs.lattice, None, inputs.constant, shares)
            turned = in_variant(new, frame_and_fit[0])
            return turned, fitted(turned, vectors[:, : turned.lattice.shells])
        return frame_and_fit

    def _neighbours(self, count: int, atoms: np.ndarray) -> np.ndarray:
        """Vectors to the nearest neighbours of some atoms, shape (atoms, count, 3)."""
        return self._near(atoms, count)[1]

    def _near(self, atoms: np.ndarray, count: int = NEIGHBOURS) -> tuple[np.ndarray, np.ndarray]:
        """Numbers of the nearest neighbours of some atoms, and the vectors to them."""
        return self._places.neighbours(atoms, count)

    @property
    def _box(self) -> Cell:
        """The cell, or an arbitrary one where nothing is periodic."""
        return self._given.box

    @cached_property
    def _wrapped(self) -> tuple[np.ndarray, np.ndarray]:
        """Positions in the cell and the periods added to each."""
        return self._box.wrapped(self.positions)

    @cached_property
    def _places(self) -> Places:
        """The atoms in the cell, with the atoms around each."""
        # Most atoms have as many neighbours as a frame needs within it, for any structure.
        reach = 3 * (spanned(self.positions, self._box) / len(self.positions)) ** (1 / 3)
        return Places(self._wrapped[0], self._box, reach)

    # -- grains -----------------------------------------------------------------------------------

    @cached_property
    def grains(self) -> Grains:
        """Grains in order, and the walls between them with their misorientation.

        Atoms may also belong to no grain; a single crystal is one grain. Grains with another
        lattice belong to another phase. Two orientations that differ by less than 15 degrees are
        one grain, with dislocations between them.

        Examples
        --------
        >>> from itertools import product
        >>> sites = np.array([np.add(cell, site) for cell in product(range(-9, 9), repeat=3)
        ...                   for site in ((0, 0, 0), (0.5, 0.5, 0.5))])
        >>> turn = np.array([[4, -3, 0], [3, 4, 0], [0, 0, 5]]) / 5
        >>> low, high = sites[sites[:, 1] < -0.4], sites @ turn.T
        >>> high = high[high[:, 1] > 0]
        >>> both = np.concatenate([low, high])
        >>> both = both[np.abs(both).max(axis=1) < 5.9]
        >>> Crystal(both).grains.walls
        (Wall(grains 0 and 1, misoriented by 36.87 degrees about [0 0 1]),)
        """
        grains = None
        if self._own is None:
            near = None if self._is_narrow else self._shells.near
            specimen = self._specimen
            if not is_single(specimen, near):
                with self._naming_the_file():
                    grains = segmented(specimen)
        if grains is None:
            grains = single_grain(self._found[0], self._wrapped[0])
        return grains if self._before is None else self._before.followed(grains)

    def following(self, before: Crystal | KnownGrains) -> Crystal:
        """The crystal as the next frame of a trajectory, with the grain numbers of the last one.

        Grains that hold the same atoms, by their order, as in the frame before keep their numbers
        and axes, so that Burgers vectors of their lines along these axes are the same in time. In
        the coordinates of the positions, Burgers vectors follow the deformation of the crystal. A
        grain that has turned by more than 15 degrees is a new grain; a single crystal that has
        turned so far is described along the axes nearest to those before.

        Examples
        --------
        >>> from itertools import product
        >>> sites = np.array(list(product(range(12), repeat=3)))
        >>> places = sites[sites.sum(axis=1) % 2 == 0] * 1.8
        >>> crystal = Crystal(places, cell=[21.6] * 3)
        >>> later = Crystal(places * 1.001, cell=[21.6216] * 3).following(crystal)
        >>> later.constant == crystal.constant, later.grains.vanished
        (True, ())
        """
        grains = KnownGrains.of(before.grains) if isinstance(before, Crystal) else before
        checks.instance(grains, KnownGrains, "before", CrystalError)
        frame, periodic = grains.largest, self.periodic.tolist()
        crystal = Crystal(
            self.positions, self.cell, periodic, frame.lattice.name, frame.orient, frame.constant,
            self.species,
        )  # fmt: skip
        object.__setattr__(crystal, "_before", grains)
        object.__setattr__(crystal, "_where", self._where)
        return crystal

    def from_file(self, where: str) -> Crystal:
        """The same crystal; errors of its recognition name a file and frame."""
        crystal = copy(self)
        object.__setattr__(crystal, "_where", f"{where}: ")
        return crystal

    def grain(self, number: int) -> Crystal:
        """The crystal of a single grain, in its own frame; atoms are numbered as in `grains`."""
        grain = self.grains[number]
        species = None if self.species is None else [self.species[k] for k in grain.atoms]
        periodic = self.periodic.tolist()
        crystal = Crystal(self.positions[grain.atoms], self.cell, periodic, species=species)
        object.__setattr__(crystal, "_own", grain)
        return crystal

    @property
    def _numbers(self) -> np.ndarray:
        """Numbers of the atoms; of a grain, those in the whole crystal."""
        return np.arange(len(self.positions)) if self._own is None else self._own.atoms

    @cached_property
    def _specimen(self) -> Specimen:
        """The atoms and the frame into which most of them fit."""
        flags = self._given.orient is not None, self._given.constant is not None
        return Specimen(self._places, self._found[0], *flags)

    @property
    def _is_narrow(self) -> bool:
        """Whether an atom may be its own neighbour, so that a number does not identify an image."""
        frame = self._found[0]
        width = 4 * frame.lattice.nearest * frame.constant
        return bool((self._box.heights < width)[self.periodic].any())

    @cached_property
    def _shells(self) -> Shells:
        """Neighbours of all atoms by lattice vector."""
        return shells_of(self._places, self._found[0])

    # -- bonds ------------------------------------------------------------------------------------

    @cached_property
    def mesh(self) -> Triangulation:
        """The Delaunay tetrahedra between the atoms."""
        reach = METHOD.reach * self.frame.lattice.nearest * self.constant
        return triangulated(self._wrapped[0], self._box, reach, atoms=self._numbers)

    @cached_property
    def kinds(self) -> np.ndarray:
        """The sublattice of each atom, one of `Lattice.offsets`, shape (atoms,)."""
        lattice = self.frame.lattice
        if not lattice.basis:
            return np.zeros(len(self.positions), dtype=np.int64)
        vectors = self._neighbours(lattice.shells, np.arange(len(self.positions)))
        return fitted(self.frame, vectors).kind

    def labels(self, pairs: ArrayLike | None = None, images: ArrayLike | None = None) -> np.ndarray:
        """The lattice vectors of bonds, whole numbers in units of `frame.lattice.units`, (k, 3).

        Whole numbers count halves of the lattice constant in fcc and bcc.

        Parameters
        ----------
        pairs
            Numbers of the two atoms of each bond, shape (k, 2); all pairs of `bonds` if not given.
        images
            The number of periods by which the second atom is moved, shape (k, 3); 0 if not given.
        """
        if pairs is None:
            return self.bonds.values
        edges = Complex.of_edges(
            np.asarray(pairs), len(self.positions), None if images is None else np.asarray(images)
        )
        first, second = edges.pairs.T
        steps = self.positions[second] - self.positions[first]
        if edges.images.shape[1] == 3:
            steps = steps + edges.images @ self._box.vectors
        return self._decoded(steps, first, second)

    def _decoded(self, steps: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
        """Labels of steps between atoms."""
        lattice, kinds = self.frame.lattice, self.kinds
        return lattice.decode(self.frame.values(steps), lattice.shift(kinds[first], kinds[second]))

    @cached_property
    def bonds(self) -> Cochain:
        """e: the label of every Delaunay edge, an integer cochain with periodic images."""
        pairs, images, _ = self.mesh.edges
        moved = self._wrapped[1]
        first, second = pairs.T
        offsets = images + moved[second] - moved[first]
        edges = Complex.of_edges(pairs, len(self.positions), offsets)
        return Cochain(edges, self.torsion.labels)

    @cached_property
    def torsion(self) -> Torsion:
        """T = de on the faces of the Delaunay tetrahedra."""
        return torsion_on(self.frame, self.mesh, self.kinds)

    @cached_property
    def circuit(self) -> AtomCircuits | GrainCircuits:
        """Closed paths from atom to atom.

        `crystal.circuit(atoms=[...])` runs through atoms by number, and
        `crystal.circuit.around(point, normal, radius)` along a circle; see `AtomCircuits`.

        Examples
        --------
        >>> from itertools import product
        >>> sites = np.array(list(product(range(12), repeat=3)))
        >>> crystal = Crystal(sites[sites.sum(axis=1) % 2 == 0] * 1.8, cell=[21.6] * 3)
        >>> crystal.circuit.around([10, 10, 10], [1, 1, 1], 6).burgers
        (0.0, 0.0, 0.0)
        """
        if self.grains.is_single:
            return self._circuits
        return GrainCircuits(
            self._circuits, self.grains, lambda number: self.grain(number)._circuits
        )

    @cached_property
    def _circuits(self) -> AtomCircuits:
        """Circuits in the frame of the whole crystal."""
        return AtomCircuits(
            self._wrapped[0], self._wrapped[1], self._box, self.frame, self._decoded
        )

    # -- dislocations -----------------------------------------------------------------------------

    def dislocations(self, partials: bool = False) -> DislocationNetwork:
        """Dislocation lines with their junctions.

        Parameters
        ----------
        partials
            Whether partial dislocations at the edges of stacking faults are separated: 1/6<112> in
            fcc and diamond, partials of basal faults in hcp (Shockley 1/3<1-100>, Frank
            1/6<20-23>); if not, their sum is given, and a partial whose fault reaches a surface
            is omitted.

        Returns
        -------
        DislocationNetwork; `.lines` have `.burgers` (coordinates of the positions, with the mean
        deformation of the crystal), `.burgers_lattice` (crystal axes, lattice constants, exact),
        `.family`, `.length`, `.path`, `.kind` and `.is_closed`.
        """
        checks.flag(partials, "partials", CrystalError)
        if not self.grains.is_single:
            crystals = [self.grain(grain.number) for grain in self.grains]
            networks = [one.dislocations(partials) for one in crystals]
            return network_of_grains(networks, self.grains, self._box, self._wrapped[0])
        torsion, vacancies = self._near_torsion(partials)
        # A grain does not fill its cell.
        occupied = None if self._own is not None else len(self.positions) + vacancies
        faces = TornFaces.of(torsion.relaxed(), self._numbers)
        return lines_of(faces, self._wrapped[0], self._box, self.frame, partials, occupied)

    def _near_torsion(self, partials: bool) -> tuple[Torsion, int]:
        """The torsion, on tetrahedra where neighbours do not already exclude it, and vacancies."""
        frame, (places, _) = self.frame, self._wrapped
        if self._is_narrow:
            return torsion_on(frame, self.mesh, self.kinds, partials), 0
        shells = self._shells
        open_atoms = dilated(~shells.closed, shells.near)
        atoms = Atoms(self._numbers, places, shells.kind)
        torsion = torsion_near(frame, self._box, open_atoms, atoms, partials)
        return torsion, len(shells.vacancies)

    def __repr__(self) -> str:
        count = len(self.positions)
        axes = "".join("T" if flag else "F" for flag in self.periodic.tolist())
        return f"Crystal({count:,} atoms, {self.lattice}, a = {self.constant:.6g}, periodic {axes})"
