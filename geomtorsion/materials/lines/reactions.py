"""Reactions: sums of Burgers vectors, and nodes that do not conserve them."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import sympy as sp

from geomtorsion.errors import NetworkError
from geomtorsion.loops import Number
from geomtorsion.support import checks

# Exact numbers and expressions, or floats.
Entry = Fraction | float | sp.Expr
Vector = tuple[Entry, ...]


def exact_vector(values: Sequence[Number], where: str, dimension: int | None = None) -> Vector:
    """A Burgers vector with exact numbers where they were exact: ints, Fractions, sympy, floats.

    Raises
    ------
    NetworkError
        It is not a vector of finite numbers, or not of the dimension.
    """
    kind, remedy = "a Burgers vector", "Give a list of numbers."
    entries = checks.entries(values, where, NetworkError, expected=kind, remedy=remedy)
    # All of a hundred thousand lines of a simulation may have plain floats.
    most = checks.MEASURABLE.most
    plain = all(type(value) is float and abs(value) <= most for value in entries)
    result = tuple(entries) if plain else tuple(_number(value, where) for value in entries)
    if dimension is not None and len(result) != dimension:
        raise NetworkError(
            f"{where}: expected a Burgers vector of {dimension} numbers, got "
            f"{checks.shown(values)}. Give the same number of components everywhere."
        )
    return result


def _number(value: Number, where: str) -> Entry:
    """An exact number or expression, or a finite float."""
    approximate = checks.number(value, where, NetworkError)
    checks.measured(approximate, where, NetworkError)
    if type(value) is int:
        return Fraction(value)
    if isinstance(value, sp.Expr) and not isinstance(value, sp.Rational | sp.Float):
        # Roots stay exact; a symbol has no length.
        return value
    number = checks.exact_number(value, where, NetworkError)
    # Floats are compared within a tolerance: they stay floats.
    return float(number) if isinstance(number, float | sp.Float) else checks.fraction(number)


def total(vectors: Sequence[Vector]) -> Vector:
    """The sum of Burgers vectors."""
    return tuple(sum(column) for column in zip(*vectors, strict=True))


def vanishes(vector: Vector, scale: float, tolerance: float) -> bool:
    """Whether a sum is zero: exactly for exact numbers, within tolerance * scale for floats."""
    for value in vector:
        if isinstance(value, sp.Expr):
            if not sp.simplify(value).is_zero:
                return False
        elif isinstance(value, float):
            if not abs(value) <= tolerance * scale:
                return False
        elif value:
            return False
    return True


def size(vector: Vector) -> float:
    """The length of a Burgers vector."""
    return sum(float(value) ** 2 for value in vector) ** 0.5


def written(vector: Vector) -> str:
    """A Burgers vector in messages."""
    return "(" + ", ".join(f"{v:.6g}" if isinstance(v, float) else str(v) for v in vector) + ")"


@dataclass(frozen=True)
class Reaction:
    """Dislocation reaction: b_1 + b_2 + ... become other lines, all with the same sense.

    before, after: Burgers vectors, each shape (n,).
    tolerance: share of the largest vector within which floats count as equal.

    Raises
    ------
    NetworkError
        The sums differ (the message gives the difference), or a vector is invalid.

    Examples
    --------
    An fcc dislocation splits into two Shockley partials, which lowers its energy:

    >>> from fractions import Fraction as F
    >>> perfect = (F(1, 2), F(-1, 2), 0)
    >>> partials = [(F(2, 6), F(-1, 6), F(-1, 6)), (F(1, 6), F(-2, 6), F(1, 6))]
    >>> split = Reaction([perfect], partials)
    >>> str(split.energy_change), split.is_favourable
    ('-1/6', True)
    """

    before: Sequence[Sequence[Number]]
    after: Sequence[Sequence[Number]]
    tolerance: float = 1e-9

    def __post_init__(self) -> None:
        """Refuse a reaction that does not conserve b."""
        for name in ("before", "after"):
            vectors = checks.entries(getattr(self, name), name, NetworkError)
            if not vectors:
                raise NetworkError(f"{name}: expected at least one dislocation, got none.")
            object.__setattr__(self, name, vectors)
        first = exact_vector(self.before[0], "before[0]")
        sides, every = [], []
        for name, vectors in (("before", self.before), ("after", self.after)):
            read = [exact_vector(b, f"{name}[{k}]", len(first)) for k, b in enumerate(vectors)]
            object.__setattr__(self, name, tuple(read))
            sides.append(total(read))
            every += read
        missing = tuple(a - b for a, b in zip(sides[1], sides[0], strict=True))
        if not vanishes(missing, max(map(size, every)), self.tolerance):
            raise NetworkError(
                f"expected a reaction that conserves b, got {written(sides[0])} before and "
                f"{written(sides[1])} after: the difference is {written(missing)}. Give all lines "
                "the same sense (reversing a line reverses b), or add the missing dislocation."
            )

    @property
    def energy_change(self) -> Entry:
        """Sum of b^2 after minus before: Frank's measure of the energy, without interaction."""

        def square(vectors: Sequence[Sequence[Any]]) -> Any:
            return sum(x * x for vector in vectors for x in vector)

        return square(self.after) - square(self.before)

    @property
    def is_favourable(self) -> bool:
        """Whether the reaction is spontaneous by Frank's rule: b^2 decreases."""
        return bool(self.energy_change < 0)


# Numbers that ParaDiS and OpenDiS give nodes.
CONSTRAINTS = {1: "surface", 5: "surface", 6: "surface", 7: "pinned", 8: "surface"}


@dataclass(frozen=True)
class NodeViolation:
    """A node at which b is not conserved.

    node: its name; excess: sum of b of the lines that leave minus those that arrive, shape (n,).
    constraint: the number that a simulation gives the node; 7: it is pinned.
    """

    node: Hashable
    excess: Vector
    constraint: int = 0

    @property
    def missing(self) -> Vector:
        """The b of a line that would have to leave the node for b to be conserved, shape (n,)."""
        return tuple(-x if x else x for x in self.excess)

    def __str__(self) -> str:
        pinned = " (pinned)" if CONSTRAINTS.get(self.constraint) == "pinned" else ""
        return f"node {self.node!r}{pinned}: b out minus b in = {written(self.excess)}"
