"""Arcs: the smooth pieces of which a loop is made, as offsets from its centre."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, Protocol

import numpy as np
import sympy as sp

from geomtorsion.codegen import graph
from geomtorsion.errors import LoopError, MissingValueError
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property

Vector = tuple[float, ...]
# What users give: numbers exact or not, points, planes by two coordinates or two vectors, and
# values by the names of parameters or by their symbols.
Number = int | float | complex | Fraction | sp.Basic
Point = Sequence[Number] | np.ndarray
Plane = Sequence[int] | Sequence[str] | Sequence[Point] | np.ndarray
Parameters = Mapping[str, Number] | Mapping[sp.Symbol, Number] | Mapping[sp.Basic, Number]


class Arc(Protocol):
    """One smooth arc, s from 0 to 1; offsets are counted in units of the size of its loop."""

    @property
    def is_periodic(self) -> bool:
        """Whether it closes smoothly on itself, so that the trapezoid rule is spectral."""
        ...

    @property
    def waves(self) -> int:
        """The highest frequency of its offsets, which an integration rule must resolve."""
        ...

    def shape(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Offsets and their derivatives by s, shape (n, k) each, at k values of s."""
        ...

    def exact(self, s: sp.Symbol) -> tuple[sp.Expr, ...]:
        """The offsets as exact expressions in s."""
        ...


def exact_number(value: Any) -> sp.Expr:
    """A number as it was meant: 0.3 is 3/10, for exact integrals; expressions stay."""
    if isinstance(value, sp.Expr) and not value.is_Float:
        return value
    return checks.rational(value, "number", LoopError, decimal=True)


def dyadic_number(value: Any) -> sp.Expr:
    """The exact value of a number: floats are binary fractions; expressions stay."""
    return checks.rational(value, "number", LoopError)


@dataclass(frozen=True)
class Ellipse:
    """The closed curve u cos(2 pi s) + v sin(2 pi s).

    first, second: the vectors u and v, shape (n,).
    meant: gives them exactly, where floats cannot; read: how it takes numbers, `exact_number` or
        `dyadic_number`.
    """

    first: Vector
    second: Vector
    meant: Callable[..., tuple[Sequence[Number], Sequence[Number]]] | None = field(
        default=None, compare=False
    )
    is_periodic: bool = field(default=True, init=False)
    waves: int = field(default=1, init=False)

    def shape(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Offsets and their derivatives by s."""
        u, v = self._columns
        angle = 2 * np.pi * s
        cos, sin = np.cos(angle), np.sin(angle)
        return u * cos + v * sin, 2 * np.pi * (v * cos - u * sin)

    @cached_property
    def _columns(self) -> tuple[np.ndarray, np.ndarray]:
        """u and v as columns."""
        return np.array(self.first)[:, None], np.array(self.second)[:, None]

    def exact(self, s: sp.Symbol) -> tuple[sp.Expr, ...]:
        """The offsets as exact expressions in s."""
        cos, sin = sp.cos(2 * sp.pi * s), sp.sin(2 * sp.pi * s)
        pairs = zip(*(self.meant() if self.meant else (self.first, self.second)), strict=True)
        return tuple(exact_number(u) * cos + exact_number(v) * sin for u, v in pairs)


@dataclass(frozen=True)
class Segment:
    """The straight arc from start to end, in coordinates.

    start, end: offsets, shape (n,).
    given: both ends as the user gave them, where these were coordinates.
    held: both ends, with floats as exact binary fractions, where `given` is calculated.
    """

    start: Vector
    end: Vector
    given: tuple[tuple[Number, ...], tuple[Number, ...]] | None = field(default=None, compare=False)
    held: tuple[tuple[Number, ...], tuple[Number, ...]] | None = field(default=None, compare=False)
    is_periodic: bool = field(default=False, init=False)
    waves: int = field(default=0, init=False)

    def shape(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Offsets and their derivatives by s."""
        start, end = np.array(self.start)[:, None], np.array(self.end)[:, None]
        step = end - start
        return start + step * s, np.broadcast_to(step, (len(step), len(s)))

    def exact(self, s: sp.Symbol) -> tuple[sp.Expr, ...]:
        """The offsets as exact expressions in s."""
        ends = self.given or (self.start, self.end)
        pairs = [(exact_number(a), exact_number(b)) for a, b in zip(*ends, strict=True)]
        return tuple(a + (b - a) * s for a, b in pairs)


@dataclass(frozen=True)
class Cubic:
    """One piece of a spline: a polynomial of third degree in s.

    coefficients: highest power first, shape (n, 4).
    given: its first point as the user gave it, where that was in coordinates.
    """

    coefficients: tuple[Vector, ...]
    given: tuple[Number, ...] | None = field(default=None, compare=False)
    is_periodic: bool = field(default=False, init=False)
    waves: int = field(default=0, init=False)

    def shape(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Offsets and their derivatives by s."""
        a, b, c, d = np.array(self.coefficients).T[:, :, None]
        return ((a * s + b) * s + c) * s + d, (3 * a * s + 2 * b) * s + c

    def exact(self, s: sp.Symbol) -> tuple[sp.Expr, ...]:
        """The offsets as exact expressions in s."""
        return tuple(
            sum(exact_number(c) * s ** (3 - k) for k, c in enumerate(row))
            for row in self.coefficients
        )


@dataclass(frozen=True)
class Curve:
    """An arc given by exact expressions.

    expressions: offsets as sympy expressions in the parameter, shape (n,).
    parameter: the symbol they depend on; start, end: its exact bounds.
    is_periodic: whether the expressions repeat after end - start.
    waves: the highest frequency, found by `constructors.parametric`.
    """

    expressions: tuple[sp.Expr, ...]
    parameter: sp.Symbol
    start: sp.Expr
    end: sp.Expr
    is_periodic: bool = False
    waves: int = 0

    @property
    def symbols(self) -> frozenset[sp.Symbol]:
        """Symbols other than the parameter."""
        symbols = sp.Tuple(*self.expressions, self.start, self.end).free_symbols
        return frozenset(symbols - {self.parameter})

    def shape(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Offsets and their derivatives by s."""
        low, width = float(self.start), float(self.end - self.start)
        values = self._function(low + width * s).reshape(2, len(self.expressions), len(s))
        return values[0], values[1] * width

    @cached_property
    def _function(self) -> Callable[[np.ndarray], np.ndarray]:
        """Offsets and derivatives as a NumPy function.

        The graph is made of the expressions, not of elements: a field has one basis for all
        angles, and cos(1000 s) next to cos(s) would become a polynomial of degree 1000 that no
        floating point can sum.
        """
        if self.symbols:
            names = ", ".join(sorted(symbol.name for symbol in self.symbols))
            raise MissingValueError(
                f"the loop contains {names}: give it values first, loop.at({{...}})."
            )
        derivatives = [expression.diff(self.parameter) for expression in self.expressions]
        outputs = [*self.expressions, *derivatives]
        return graph([self.parameter.name], outputs, factor=False).numpy()

    def exact(self, s: sp.Symbol) -> tuple[sp.Expr, ...]:
        """The offsets as exact expressions in s."""
        inner = self.start + (self.end - self.start) * s
        return tuple(expression.subs(self.parameter, inner) for expression in self.expressions)


@dataclass(frozen=True)
class Part:
    """One closed path, run through `times` times: q(s) = centre + size * offset(s).

    centre: coordinates q0^mu, shape (n,).
    size: how large it is, in coordinates; offsets are of order one.
    arcs: smooth arcs in the order in which they are run through, s from 0 to 1 on each.
    times: how often; negative: backwards.
    given: centre and size as the user gave them, for exact integrals.
    periods: (coordinate, period) of coordinates that are angles.
    gap: whole periods from its start to its end, in units of the size, shape (n,); empty where it
        closes without them.
    assumed: whether these are undeclared turns of 2 pi, which the frame must then have as periods.
    """

    centre: tuple[float, ...]
    size: float
    arcs: tuple[Arc, ...]
    times: int = 1
    given: tuple[tuple[Number, ...], Number] | None = None
    periods: tuple[tuple[int, float], ...] = ()
    gap: tuple[float, ...] = ()
    assumed: bool = False

    def points(self, arc: Arc, s: float | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Coordinates and their derivatives by s on an arc, shape (n, k) each."""
        offsets, slopes = arc.shape(np.atleast_1d(np.asarray(s, dtype=float)))
        return np.array(self.centre)[:, None] + self.size * offsets, self.size * slopes

    @property
    def base_offset(self) -> np.ndarray:
        """Offset of the point where it starts and ends, shape (n,)."""
        return self.arcs[0].shape(np.zeros(1))[0][:, 0]

    @property
    def base(self) -> np.ndarray:
        """Coordinates of the point where it starts and ends, shape (n,)."""
        return np.array(self.centre) + self.size * self.base_offset


def shown(vector: Iterable[float]) -> str:
    """A vector in messages."""
    return "(" + ", ".join(f"{float(x):.6g}" for x in vector) + ")"


def at_arcs(arcs: Sequence[Arc], owner: np.ndarray, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Offsets and slopes at s, shape (m, k), on the arcs of each row; shape (n, m * k) each."""
    if len(arcs) == 1:
        return arcs[0].shape(s.ravel())
    straight = [(arc.start, arc.end) for arc in arcs if isinstance(arc, Segment)]
    if len(straight) == len(arcs):
        # A polygon may have very many sides: all of them in one expression.
        start, end = np.array(straight).transpose(1, 2, 0)
        step = (end - start)[:, owner, None]
        offsets = start[:, owner, None] + step * s
        slopes = np.repeat(step, s.shape[1], axis=2)
        return offsets.reshape(len(start), -1), slopes.reshape(len(start), -1)
    order = np.argsort(owner, kind="stable")
    numbers, starts = np.unique(owner[order], return_index=True)
    parts = [
        arcs[int(number)].shape(s[rows].ravel())
        for number, rows in zip(numbers, np.split(order, starts[1:]), strict=True)
    ]
    back = np.argsort(order)
    shape = (-1, *s.shape)
    both = (np.concatenate(arrays, axis=1) for arrays in zip(*parts, strict=True))
    offsets, slopes = (x.reshape(shape)[:, back].reshape(len(x), -1) for x in both)
    return offsets, slopes
