"""Slip: slip systems (plane and Burgers vector), families of equivalent systems, densities."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.errors import OrientationError
from geomtorsion.materials.maps.phases import Phase, cell_vector, images_of
from geomtorsion.materials.structures import STRUCTURES, Indices
from geomtorsion.support import checks

FAMILIES = {name: one.slip for name, one in STRUCTURES.items() if one.slip}


@dataclass(frozen=True, eq=False, repr=False)
class SlipFamily:
    """All symmetry equivalents of a slip system.

    name: plane and Burgers vector as given. normals: of the planes, unit vectors in crystal axes,
    shape (k, 3). vectors: Burgers vectors, crystal axes, angstrom, shape (k, 3).
    """

    name: str
    normals: np.ndarray
    vectors: np.ndarray

    @classmethod
    def of(cls, phase: Phase, plane: Indices, vector: Indices) -> SlipFamily:
        """The family of a plane and a Burgers vector in the cell of the crystal.

        Parameters
        ----------
        plane
            Miller indices h, k, l, or Bravais' four indices h, k, i, l of hexagonal and trigonal
            cells.
        vector
            In units of a, b, c, such as (0.5, -0.5, 0); or with four indices.

        Raises
        ------
        OrientationError
            The vector is not in the plane, one of them is zero, or the lattice is not known.

        Examples
        --------
        >>> copper = Phase("copper", "m-3m", (3.615, 3.615, 3.615))
        >>> SlipFamily.of(copper, (1, 1, 1), (0.5, -0.5, 0))
        SlipFamily({1, 1, 1} <0.5, -0.5, 0>: 12 systems)
        """
        cell = phase.lattice
        hkl = cell_vector(plane, "plane", phase, plane=True)
        one = cell @ cell_vector(vector, "Burgers vector", phase)
        for subject, components in (("plane", hkl), ("Burgers vector", one)):
            if not components.any():
                raise OrientationError(
                    f"{subject}: expected indices that are not all 0, got only zeros. Correct them."
                )
        normal = np.linalg.solve(cell.T, hkl)
        sizes = np.linalg.norm(normal), np.linalg.norm(one)
        if abs(normal @ one) > 1e-6 * sizes[0] * sizes[1]:
            raise OrientationError(
                f"Burgers vector: expected one in the plane {_shown(plane)}, got {_shown(vector)}, "
                "which is not in it. Give u, v, w with h u + k v + l w = 0."
            )
        images = images_of(phase, np.stack([normal / sizes[0], one / sizes[1]]))
        systems: list[np.ndarray] = []
        for pair in images:
            # A normal and its opposite belong to one system; so do b and -b.
            if all(np.abs(np.einsum("ki,ki->k", pair, x)).min() < 1 - 1e-9 for x in systems):
                systems.append(pair)
        pairs = np.array(systems)
        return cls(f"{{{_shown(plane)}}} <{_shown(vector)}>", pairs[:, 0], sizes[1] * pairs[:, 1])

    def __repr__(self) -> str:
        return f"SlipFamily({self.name}: {len(self.normals)} systems)"


@dataclass(frozen=True, eq=False)
class SlipDensity:
    """The least density of dislocations of a slip family that explains a circuit.

    edge, screw: signed density of each system, lines per square of the unit of the map, shape (k,);
    edge lines are along n x b, screw lines along b. Screws of systems with equal b count once.
    """

    family: SlipFamily
    edge: np.ndarray
    screw: np.ndarray

    @property
    def total(self) -> float:
        """Sum of the absolute densities of all systems."""
        return float(np.abs(self.edge).sum() + np.abs(self.screw).sum())


def slip_families(phase: Phase, structure: str) -> tuple[SlipFamily, ...]:
    """The usual slip families of a structure: "fcc", "bcc", "diamond" or "hcp".

    Examples
    --------
    >>> zinc = Phase("zinc", "6/mmm", (2.66, 2.66, 4.95), (90, 90, 120))
    >>> [len(one.normals) for one in slip_families(zinc, "hcp")]
    [3, 3, 6, 6]
    """
    checks.known_name(structure, FAMILIES, "structure", OrientationError)
    return tuple(SlipFamily.of(phase, plane, vector) for plane, vector in FAMILIES[structure])


def least_combination(
    columns: np.ndarray, wanted: np.ndarray, costs: np.ndarray
) -> np.ndarray | None:
    """Numbers n with columns @ n = wanted and the least sum of costs * |n|; None without solution.

    columns: shape (3, k). wanted: shape (3,). costs: positive, shape (k,).

    Examples
    --------
    >>> diagonal_too = np.array([[1, 0, 1], [0, 1, 1], [0, 0, 0]])
    >>> numbers = least_combination(diagonal_too, np.array([2, 2, 0]), np.ones(3))
    >>> bool(np.allclose(numbers, [0, 0, 2]))
    True
    """
    size, scale = (float(np.abs(x).max()) or 1.0 for x in (columns, wanted))
    answer = scipy.optimize.linprog(
        np.concatenate([costs, costs]),
        A_eq=np.concatenate([columns, -columns], axis=1) / size,
        b_eq=wanted / scale,
    )
    if answer.status != 0:
        return None
    return (answer.x[: len(costs)] - answer.x[len(costs) :]) * (scale / size)


def densities(
    per_area: np.ndarray, normal: np.ndarray, families: Sequence[SlipFamily], angstrom: float
) -> tuple[SlipDensity, ...]:
    """The least density of edges and screws of slip families that gives a b per area.

    Equation
    --------
    b^i / A = sum_t rho_t b_t^i (l_t N), N the normal of the circuit, l_t along n x b of an edge
    and along b of a screw; the sum of |rho_t| is least [Pantleon, Scripta Mater. 58 (2008) 994,
    with the three components that one plane of a map has].

    per_area: in crystal axes, 1 / unit. normal: in crystal axes. angstrom: angstroms in a unit.
    """
    kinds: list[np.ndarray] = []
    place: list[tuple[int, int, bool]] = []
    screws: list[np.ndarray] = []
    for f, family in enumerate(families):
        for k, (n, b) in enumerate(zip(family.normals, family.vectors, strict=True)):
            line = b / np.linalg.norm(b)
            kinds.append(b * (np.cross(n, line) @ normal))
            place.append((f, k, True))
            if not any(abs(line @ x) > 1 - 1e-9 for x in screws):
                screws.append(line)
                kinds.append(b * (line @ normal))
                place.append((f, k, False))
    numbers = least_combination(np.array(kinds).T / angstrom, per_area, np.ones(len(place)))
    if numbers is None:
        raise OrientationError(
            "families: expected edges and screws that add up to b per area, got families that do "
            "not span it. Give another family as well."
        )
    parts = [np.zeros((2, len(family.normals))) for family in families]
    for (f, k, is_edge), number in zip(place, numbers, strict=True):
        parts[f][0 if is_edge else 1, k] = number
    return tuple(SlipDensity(family, *table) for family, table in zip(families, parts, strict=True))


def _shown(indices: Indices) -> str:
    return ", ".join(f"{float(x):.4g}" for x in indices)
