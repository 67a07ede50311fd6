"""Lattices: nearest lattice vectors in closed form, as whole numbers."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, product
from math import sqrt

import numpy as np

from geomtorsion.errors import CrystalError
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property

# No lattice vector is perpendicular to it: its sign decides whether v or -v is decoded.
_SIDE = np.array([1.0, np.sqrt(2) - 1, np.sqrt(3) - np.sqrt(2)])


@dataclass(frozen=True)
class Lattice:
    """Lattice, described by a rectangular cell with several points, and perhaps a basis.

    name: "fcc", "bcc", "hcp", "diamond" or "hexagonal diamond".
    units: unit of whole numbers along each crystal axis, in lattice constants a, shape (3,).
    period: the rectangular cell in these units, shape (3,).
    points: the lattice points in it, in these units.
    basis: from an atom of the first kind to the nearest of the second, or () where all are alike.
    shells: number of neighbours of an atom in each shell that determines the lattice.
    screw: from an atom to the nearest one with the same surroundings turned by half a turn about
        c; () if there is none. Kinds 0 and 1 of atoms differ by the basis, 2 and 3 by a screw more.

    Examples
    --------
    >>> LATTICES["fcc"].decode(np.array([[0.9, 0.2, 0.1], [2.2, 0.1, -0.1]])).tolist()
    [[1, 1, 0], [2, 0, 0]]
    """

    name: str
    units: tuple[float, float, float]
    period: tuple[int, int, int]
    points: tuple[tuple[int, int, int], ...]
    basis: tuple[int, ...]
    shells: int
    screw: tuple[int, ...] = ()

    @property
    def is_hexagonal(self) -> bool:
        """Whether its third axis is c, at right angles to a hexagonal net."""
        return self.units[0] != self.units[1]

    @property
    def ratio(self) -> float:
        """c/a of a hexagonal lattice."""
        return self.units[2] * self.heights

    @property
    def heights(self) -> int:
        """Number of units in c: whole numbers along c count c over this number."""
        return 8 if self.screw else 2

    @cached_property
    def offsets(self) -> np.ndarray:
        """Position of an atom of each kind in a primitive cell, whole numbers, shape (kinds, 3)."""
        offsets = [np.zeros(3, dtype=np.int64)]
        for step in (self.basis, self.screw):
            offsets += [place + step for place in offsets] if step else []
        return np.array(offsets)

    def shift(self, first: np.ndarray, second: np.ndarray) -> np.ndarray:
        """Value of `shift` in `decode` for the kinds of two atoms.

        The basis counts as 1, the screw as 3, and the reverse directions are negative.
        """
        codes = np.array([0, 1, 3, 4])
        return codes[second] - codes[first]

    def decode(self, values: np.ndarray, shift: np.ndarray | None = None) -> np.ndarray:
        """The nearest lattice vectors, shape (k, 3), whole numbers.

        A rectangular lattice with several points in its cell takes the best of one rounding for
        each point. decode(-v) = -decode(v), also in ties.

        Parameters
        ----------
        values
            Vectors along the crystal axes in units of `units`, shape (k, 3).
        shift
            From the sublattice of the first atom to the sublattice of the second: -1, 0 or 1
            without a screw, else as `shift` has it, shape (k,).
        """
        side = np.where(values @ _SIDE < 0, -1.0, 1.0)
        y = values * side[:, None]
        move = None
        if self.basis and shift is not None:
            move = side[:, None] * self._moves[shift]
            y = y - move
        period, best, nearest = np.array(self.period, dtype=float), None, y
        scale = np.array(self.units)
        for point in np.array(self.points, dtype=float):
            near = np.rint((y - point) / period) * period + point
            distances = (((near - y) * scale) ** 2).sum(axis=1)
            if best is None:
                best, nearest = distances, near
            else:
                closer = distances < best
                best = np.where(closer, distances, best)
                nearest = np.where(closer[:, None], near, nearest)
        if move is not None:
            nearest = nearest + move
        return (nearest * side[:, None]).astype(np.int64)

    @cached_property
    def _moves(self) -> np.ndarray:
        """Offset for each shift; negative shifts count from the end and have minus the offset."""
        moves = np.zeros((9, 3))
        for kind, place in enumerate(self.offsets):
            code = int(self.shift(np.array(0), np.array(kind)))
            moves[code], moves[-code] = place, -place
        if self.screw:
            # From the second sublattice to the first, one screw further.
            moves[2] = self.offsets[2] - self.offsets[1]
            moves[-2] = -moves[2]
        return moves

    @cached_property
    def neighbours(self) -> tuple[np.ndarray, ...]:
        """Vectors to the neighbours in `shells`, for each kind of atom, shape (shells, 3)."""
        near = self._near(self.shells)
        if self.screw:
            # Between atoms of the two kinds of a pair along c there is a mirror.
            signs = ((1, 1, 1), (1, 1, -1), (-1, -1, 1), (-1, -1, -1))
            return tuple(near * sign for sign in signs)
        return (near, -near) if self.basis else (near,)

    @cached_property
    def ideal(self) -> tuple[np.ndarray, ...]:
        """The vectors of `neighbours` in lattice constants."""
        return tuple(vectors * np.array(self.units) for vectors in self.neighbours)

    @cached_property
    def nearest(self) -> float:
        """Distance of nearest neighbours over the lattice constant."""
        return float(np.linalg.norm(self.neighbours[0][0] * self.units))

    @cached_property
    def atom_volume(self) -> float:
        """Volume of an atom over the cube of the lattice constant."""
        cell = float(np.prod(np.array(self.period) * self.units))
        return cell / (len(self.points) * len(self.offsets))

    @cached_property
    def translations(self) -> np.ndarray:
        """Three short vectors that span the lattice, as rows, shape (3, 3), whole numbers."""
        return _shortest_basis(self._around(np.zeros(3)), np.array(self.units), self._cell)

    def basis_of(self, values: np.ndarray) -> np.ndarray:
        """Three vectors among some that span the lattice, shape (3, 3).

        The most frequent ones, up to their signs, come first.

        Examples
        --------
        >>> LATTICES["fcc"].basis_of(np.array([[1, -1, 0], [1, 1, 0], [-1, 1, 0]])).tolist()
        [[1, -1, 0], [1, 1, 0], [0, -1, -1]]
        """
        some = values[values.any(axis=1)]
        side = np.where(some @ _SIDE < 0, -1, 1)[:, None]
        vectors, counts = np.unique(side * some, axis=0, return_counts=True)
        sizes = np.linalg.norm(vectors * self.units, axis=1).round(9)
        order = np.lexsort((*vectors.T, sizes, -counts))
        every = [*vectors[order].tolist(), *self.translations.tolist()]
        return np.array(next(x for x in combinations(every, 3) if self._spans(*x)))

    def _spans(self, a: list[int], b: list[int], c: list[int]) -> bool:
        """Whether three lattice vectors span a primitive cell."""
        volume = a[0] * (b[1] * c[2] - b[2] * c[1])
        volume += a[1] * (b[2] * c[0] - b[0] * c[2])
        volume += a[2] * (b[0] * c[1] - b[1] * c[0])
        return abs(volume) == round(self._cell)

    @property
    def _cell(self) -> float:
        """Volume of a primitive cell, in units."""
        return float(np.prod(self.period)) / len(self.points)

    def _around(self, offset: np.ndarray) -> np.ndarray:
        """Lattice vectors plus an offset in the cells next to the origin."""
        cells = np.array(list(product((-2, -1, 0, 1, 2), repeat=3))) * self.period
        return (cells[:, None] + np.array(self.points) + offset).reshape(-1, 3)

    def _near(self, count: int) -> np.ndarray:
        """The nearest neighbours of an atom of the first kind, whole numbers."""
        every = np.concatenate([self._around(place) for place in self.offsets])
        sizes = np.linalg.norm(every * self.units, axis=1)
        order = np.lexsort((*every.T, sizes.round(9)))
        # The first is the atom itself.
        return every[order[1 : count + 1]].astype(np.int64)

    def fractions(self, values: np.ndarray) -> tuple[Fraction, ...]:
        """A lattice vector in lattice constants; of hexagonal lattices along a1, a2 and c."""
        x = [Fraction(int(v)) for v in values]
        if self.is_hexagonal:
            # Units are a/2 and sqrt(3) a/6 in the plane; a2 is at 120 degrees to a1.
            second = x[1] / 3
            return (x[0] / 2 + second / 2, second, x[2] / self.heights)
        return tuple(
            v * Fraction(u).limit_denominator(12) for v, u in zip(x, self.units, strict=True)
        )


def _shortest_basis(vectors: np.ndarray, units: np.ndarray, volume: float) -> np.ndarray:
    """The first three of the shortest vectors that span a cell of a volume."""
    sizes = np.linalg.norm(vectors * units, axis=1)
    short = vectors[np.lexsort((*vectors.T, sizes.round(9)))][1:60]
    first = short[0]
    for second in short:
        for third in short:
            if abs(abs(np.linalg.det(np.array([first, second, third]))) - volume) < 0.5:
                return np.array([first, second, third], dtype=np.int64)
    raise AssertionError("a lattice has a basis of short vectors")


def _hcp(ratio: float) -> Lattice:
    """hcp in its rectangular cell a, sqrt(3) a, c."""
    return Lattice(
        "hcp",
        (0.5, sqrt(3) / 6, ratio / 2),
        (2, 6, 2),
        ((0, 0, 0), (1, 3, 0)),
        (0, 2, 1),
        12,
    )


def _hexagonal_diamond(ratio: float) -> Lattice:
    """Hexagonal diamond, the lattice of wurtzite with one species: hcp with pairs along c."""
    return Lattice(
        "hexagonal diamond",
        (0.5, sqrt(3) / 6, ratio / 8),
        (2, 6, 8),
        ((0, 0, 0), (1, 3, 0)),
        (0, 0, 3),
        # The one atom of its third shell, along c, is 2 % further away than the second shell.
        17,
        (0, 2, 4),
    )


_CORNERS = ((0, 0, 0), (0, 1, 1), (1, 0, 1), (1, 1, 0))
LATTICES = {
    "fcc": Lattice("fcc", (0.5, 0.5, 0.5), (2, 2, 2), _CORNERS, (), 12),
    "bcc": Lattice("bcc", (0.5, 0.5, 0.5), (2, 2, 2), ((0, 0, 0), (1, 1, 1)), (), 14),
    "hcp": _hcp(sqrt(8 / 3)),
    "diamond": Lattice(
        "diamond",
        (0.25, 0.25, 0.25),
        (4, 4, 4),
        tuple((2 * x, 2 * y, 2 * z) for x, y, z in _CORNERS),
        (1, 1, 1),
        16,
    ),
    "hexagonal diamond": _hexagonal_diamond(sqrt(8 / 3)),
}
_OF_RATIO = {"hcp": _hcp, "hexagonal diamond": _hexagonal_diamond}


def lattice_named(name: object, ratio: float | None = None) -> Lattice:
    """The lattice with a name; ratio: c/a of a hexagonal one, the ideal one if not given.

    Raises
    ------
    CrystalError
        No lattice has this name.
    """
    checks.choice(name, tuple(LATTICES), "lattice", CrystalError)
    if ratio is not None and name in _OF_RATIO:
        return _OF_RATIO[str(name)](ratio)
    return LATTICES[str(name)]
