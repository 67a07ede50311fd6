"""Results: Burgers vector of a circuit in an orientation map, and its decomposition into lines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geomtorsion.errors import OrientationError
from geomtorsion.materials.burgers import Burgers, Json
from geomtorsion.materials.maps.phases import Phase
from geomtorsion.materials.maps.pixel_circuits import Circuit
from geomtorsion.materials.maps.slip import (
    SlipDensity,
    SlipFamily,
    densities,
    least_combination,
    slip_families,
)
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property

# Angstrom in a unit of length.
UNITS = {"angstrom": 1.0, "nm": 1e1, "um": 1e4, "mm": 1e7, "m": 1e10}


@dataclass(frozen=True, eq=False, repr=False)
class FamilyLines:
    """The least numbers of dislocation lines of a family that a circuit encloses.

    family: Burgers vector in units of a, b, c. vectors: its equivalents in crystal axes, angstrom,
    shape (k, 3). numbers: of lines for each vector, negative for opposite lines, shape (k,).
    """

    family: tuple[float, ...]
    vectors: np.ndarray
    numbers: np.ndarray

    @property
    def total(self) -> float:
        """Number of lines of all vectors."""
        return float(np.abs(self.numbers).sum())

    def __repr__(self) -> str:
        name = ", ".join(f"{x:g}" for x in self.family)
        return f"FamilyLines([{name}]: {self.total:.4g} lines)"


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class MapBurgers(Burgers):
    """Burgers vector of a circuit in an orientation map.

    Equation
    --------
    b^i = closed integral of R^i_mu dl^mu, R from specimen to crystal: the coframe of a lattice
    without strain. The circuit turns from x to y (right-handed about z), as for the integral
    weighted Burgers vector of MTEX.

    vector, covariance: in crystal axes (in the variant of the grain); b is the sum of the Burgers
        vectors of all lines through the circuit. The systematic error is the difference from a rule
        of fourth order along the steps, minus the part that noise explains.
    circuit: from pixel to pixel.
    rotation: from crystal to specimen at the first pixel of the circuit, shape (3, 3).
    grain: number of the grain. phase: of the grain.
    structure: the structure whose slip systems make up b in `facts`; empty for none.
    """

    circuit: Circuit
    rotation: np.ndarray
    grain: int
    phase: Phase
    structure: str = ""

    @property
    def specimen(self) -> np.ndarray:
        """b in specimen axes (the axes of the map), shape (3,), in `unit`."""
        return self.rotation @ self.vector

    def _errors_in(self, matrix: np.ndarray) -> np.ndarray:
        """Errors of matrix @ b, shape (3,)."""
        noise = np.einsum("ij,jk,ik->i", matrix, self.covariance, matrix)
        return np.sqrt(noise + self.systematic_error**2 * (matrix**2).sum(axis=1))

    @property
    def facts(self) -> Json:
        """b in specimen axes, grain, phase, steps; lattice coordinates and slip where known."""
        facts: Json = {
            "specimen": self.specimen.tolist(),
            "specimen_errors": self._errors_in(self.rotation).tolist(),
            "grain": self.grain,
            "phase": self.phase.name,
            "steps": len(self.circuit.starts),
        }
        if self.phase.has_lattice:
            facts["lattice"] = self.indices.tolist()
            turned = np.linalg.inv(self.phase.lattice) * angstrom_in(self.unit)
            facts["lattice_errors"] = self._errors_in(turned).tolist()
        if self.structure:
            facts["slip"] = [
                {
                    "family": one.family.name,
                    "edge": float(np.abs(one.edge).sum()),
                    "screw": float(np.abs(one.screw).sum()),
                }
                for one in self.slip(*slip_families(self.phase, self.structure))
            ]
        return facts

    @property
    def per_area(self) -> np.ndarray:
        """b^i per area, in crystal axes, shape (3,), in 1 / `unit`.

        Raises
        ------
        OrientationError
            The circuit encloses no area.
        """
        if not self.area:
            raise OrientationError(
                f"{self.circuit.name}: expected a circuit that encloses an area, got parts of "
                "opposite senses with equal areas. Choose a circuit with one sense."
            )
        return self.vector / self.area

    @cached_property
    def indices(self) -> np.ndarray:
        """b in units of the lattice vectors a, b, c, shape (3,)."""
        return np.linalg.solve(self.phase.lattice, self._angstrom)

    @property
    def _angstrom(self) -> np.ndarray:
        return self.vector * angstrom_in(self.unit)

    def lines(self, *families: Sequence[float]) -> tuple[FamilyLines, ...]:
        """The lines that add up to the vector with the least sum of number times |b|.

        Parameters
        ----------
        families
            Burgers vectors in units of a, b, c, such as (0.5, 0.5, 0); their symmetry equivalents
            are added.

        Raises
        ------
        OrientationError
            The lattice is not known, or the families do not span the vector.

        Examples
        --------
        >>> tilted = np.zeros((4, 9, 3))
        >>> tilted[:, 5:, 0] = 1.0
        >>> from geomtorsion.materials.maps import OrientationMap
        >>> iron = Phase("iron", "m-3m", (2.87, 2.87, 2.87))
        >>> wall = OrientationMap.from_euler(tilted, 1.0, iron, sigma=0)
        >>> wall.burgers(Circuit.rectangle((0, 2), 3, 5)).lines((1, 0, 0))
        (FamilyLines([1, 0, 0]: 184 lines),)
        """
        if not families:
            raise OrientationError(
                "families: expected at least one Burgers vector, got none. Give one, for example "
                "(0.5, 0.5, 0)."
            )
        members = [self.phase.family(family) for family in families]
        vectors = np.concatenate(members)
        lengths = np.linalg.norm(vectors, axis=1)
        numbers = least_combination(vectors.T, self._angstrom, lengths)
        if numbers is None:
            raise OrientationError(
                "families: expected Burgers vectors that add up to "
                f"{self.indices.round(3).tolist()} (units of a, b, c), got families that do not "
                "span it. Give another family as well."
            )
        parts = np.split(numbers, np.cumsum([len(part) for part in members])[:-1])
        return tuple(
            FamilyLines(tuple(float(x) for x in family), part, number)
            for family, part, number in zip(families, members, parts, strict=True)
        )

    def slip(self, *families: SlipFamily) -> tuple[SlipDensity, ...]:
        """The least density of edges and screws of slip families that gives this b per area.

        Parameters
        ----------
        families
            `SlipFamily.of(phase, plane, vector)`, or `slip_families(phase, "bcc")`.

        Returns
        -------
        Densities of the systems of each family, in lines per `unit` squared.

        Raises
        ------
        OrientationError
            No family is given, or the families cannot make up b.

        Examples
        --------
        A wall of edges: two parallel to z for each <100> of b.

        >>> tilted = np.zeros((11, 20, 3))
        >>> tilted[:, 10:, 0] = 1.0
        >>> from geomtorsion.materials.maps import OrientationMap
        >>> salt = Phase("salt", "m-3m", (4.0, 4.0, 4.0))
        >>> wall = OrientationMap.from_euler(tilted, 1.0, salt, sigma=0)
        >>> b = wall.burgers(Circuit.rectangle((0, 5), 10, 10))
        >>> (found,) = b.slip(SlipFamily.of(salt, (1, 0, 0), (0, 1, 0)))
        >>> round(found.total * b.area), round(b.magnitude * 1e4 / 4.0)
        (440, 436)
        """
        if not families:
            raise OrientationError(
                "families: expected at least one SlipFamily, got none. Give one, for example from "
                "slip_families."
            )
        for one in families:
            checks.instance(one, SlipFamily, "families", OrientationError)
        normal = self.rotation.T @ np.array([0.0, 0.0, 1.0])
        return densities(self.per_area, normal, families, angstrom_in(self.unit))

    def __repr__(self) -> str:
        return f"MapBurgers({self.text} in crystal axes, grain {self.grain}, {self.phase.name})"


def angstrom_in(unit: str) -> float:
    """Angstrom in a unit of length."""
    checks.known_name(unit, UNITS, "unit", OrientationError)
    return UNITS[unit]
