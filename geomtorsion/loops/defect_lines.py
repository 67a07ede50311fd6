"""Defect lines: very many straight ones, summed as numbers, and crystals of them as frames."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import sympy as sp

from geomtorsion.codegen import numpy_function
from geomtorsion.errors import LoopError, ShapeError
from geomtorsion.exact import Element, Field, parse_expression
from geomtorsion.geometry import Frame, validation
from geomtorsion.loops.arcs import Number, exact_number
from geomtorsion.loops.quadrature import PIECE
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property

Elements = dict[tuple[int, int], Element]


@dataclass(frozen=True, eq=False)
class Lines(Mapping[str, Elements]):
    """Data of a frame of parallel lines, for `Frame.given`; exact entries are made on first use.

    A sum over n lines has n quadratic denominators: over their product it is a polynomial of degree
    2 n, which is too large. Loops sum line by line instead, without exact entries.

    coordinates: x, y, z. field: of the frame.
    places: (x_k, y_k), exact; vectors: b_k^i, exact, none of them zero.
    """

    coordinates: tuple[sp.Symbol, ...]
    field: Field
    places: tuple[tuple[sp.Expr, ...], ...]
    vectors: tuple[tuple[sp.Expr, ...], ...]

    # -- as exact entries -------------------------------------------------------------------------

    def __getitem__(self, name: str) -> Elements:
        if name not in self:
            raise KeyError(name)
        return self._coframe if name == "coframe" else self._eta

    def __contains__(self, name: object) -> bool:
        return name in ("coframe", "eta")

    def __iter__(self) -> Iterator[str]:
        return iter(("coframe", "eta"))

    def __len__(self) -> int:
        return 2

    @cached_property
    def _eta(self) -> Elements:
        """The metric of the frame: one."""
        return {(i, i): self.field.one for i in range(3)}

    @cached_property
    def _coframe(self) -> Elements:
        """The coframe over one denominator."""
        x, y, _ = self.coordinates
        terms: dict[tuple[int, int], list[sp.Expr]] = {(i, i): [sp.S.One] for i in range(3)}
        for (a, b), vector in zip(self.places, self.vectors, strict=True):
            square = (x - a) ** 2 + (y - b) ** 2
            for i, size in enumerate(vector):
                share = size / (2 * sp.pi)
                terms.setdefault((i, 0), []).append(-share * (y - b) / square)
                terms.setdefault((i, 1), []).append(share * (x - a) / square)
        entries = {index: sp.Add(*each) for index, each in sorted(terms.items())}
        return validation.read_matrix(self.field, entries, "coframe")

    # -- as numbers -------------------------------------------------------------------------------

    @cached_property
    def parameters(self) -> tuple[sp.Symbol, ...]:
        """Symbols in places and vectors."""
        symbols = sp.Tuple(*sum(self.places + self.vectors, ())).free_symbols
        return tuple(s for s in self.field.symbols if s in symbols)

    @cached_property
    def rows(self) -> tuple[tuple[int, int], ...]:
        """Indices (i, mu) of the entries of the coframe that do not vanish."""
        bent = [any(vector[i] != 0 for vector in self.vectors) for i in range(3)]
        return tuple(
            (i, mu) for i in range(3) for mu in range(3) if i == mu or (mu < 2 and bent[i])
        )

    def numbers(self, values: Sequence[float | complex]) -> tuple[np.ndarray, np.ndarray]:
        """Places and vectors for values of the parameters, shapes (2, lines) and (3, lines)."""
        if not self.parameters:
            return self._fixed
        columns = np.asarray(self._filled(*values)).reshape(len(self.places), 5).T
        return columns[:2], columns[2:]

    @cached_property
    def _fixed(self) -> tuple[np.ndarray, np.ndarray]:
        """Places and vectors without parameters."""
        every = ([[float(x) for x in row] for row in rows] for rows in (self.places, self.vectors))
        places, vectors = (np.array(rows).T for rows in every)
        return places.reshape(2, -1), vectors.reshape(3, -1)

    @cached_property
    def _filled(self) -> Callable[..., np.ndarray]:
        """All numbers from the values of the parameters, shape (5 lines,)."""
        rows = [x for row in zip(self.places, self.vectors, strict=True) for x in sum(row, ())]
        elements = self.field.read_all([(f"line {k // 5}", x) for k, x in enumerate(rows)])
        return numpy_function(elements, self.parameters)

    def vector_at(
        self, place: Sequence[object], values: Sequence[float | complex]
    ) -> np.ndarray | None:
        """The Burgers vector of the line at an exact place, None if there is none; shape (3,)."""
        if tuple(place) not in self.places:
            return None
        return self.numbers(values)[1][:, self.places.index(tuple(place))]

    def coframe(self, chosen: Sequence[tuple[int, int]], *arguments: Any) -> np.ndarray:
        """Some entries of the coframe at points (coordinates, then parameters), shape (m, k)."""
        x, y = arguments[0], arguments[1]
        places, vectors = self.numbers(arguments[3:])
        bend = np.zeros((2, 3, len(x)), dtype=np.result_type(vectors, x))
        # So many lines at once that their terms fit in the cache.
        most = max(1, PIECE // max(1, len(x)))
        for first in range(0, len(self.places), most):
            part = slice(first, first + most)
            across, up = x - places[0, part, None], y - places[1, part, None]
            square = across * across + up * up
            bend[0] -= vectors[:, part] @ (up / square)
            bend[1] += vectors[:, part] @ (across / square)
        bend /= 2 * np.pi
        ones = np.ones_like(x)
        return np.stack([(bend[mu, i] if mu < 2 else 0) + (i == mu) * ones for i, mu in chosen])

    def squares(self, *arguments: Any) -> np.ndarray:
        """Square of the distance of points from each line, shape (lines, k)."""
        places, _ = self.numbers(arguments[3:])
        across, up = arguments[0] - places[0][:, None], arguments[1] - places[1][:, None]
        return across * across + up * up

    def square(self, number: int, *arguments: Any) -> np.ndarray:
        """The same from one line, shape (k,)."""
        places, _ = self.numbers(arguments[3:])
        across, up = arguments[0] - places[0, number], arguments[1] - places[1, number]
        return across * across + up * up

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The squares of the distances, as text."""
        x, y, _ = self.coordinates
        return tuple(f"{_square(x, a)} + {_square(y, b)}" for a, b in self.places)


def _square(symbol: sp.Symbol, place: sp.Expr) -> str:
    """(x - a)**2 as text."""
    return f"{symbol}**2" if place == 0 else f"({symbol - place})**2"


def frame_of_lines(
    coordinates: tuple[sp.Symbol, ...],
    places: Sequence[tuple[sp.Expr, ...]],
    vectors: Sequence[tuple[sp.Expr, ...]],
    name: str,
) -> Frame:
    """e^i = dx^i + sum_k b_k^i dphi_k / (2 pi), which far from all lines is regular."""
    every = {(0, k): x for k, x in enumerate((*coordinates, *sum((*places, *vectors), ())))}
    opened = validation.opened(coordinates, 3, every, None, None, False, None)
    present = [k for k, vector in enumerate(vectors) if any(x != 0 for x in vector)]
    lines = Lines(
        opened.coordinates, opened.field,
        tuple(places[k] for k in present), tuple(vectors[k] for k in present),
    )  # fmt: skip
    frame = object.__new__(Frame)
    frame.fill(opened, name, lines, (frame_of_lines, (coordinates, places, vectors, name)))
    return frame


# Numbers, expressions, or text such as "1/2".
Exact = Sequence[Number | str]
X, Y, Z = sp.symbols("x y z", real=True)


def parallel_dislocations(
    positions: Sequence[Sequence[Number | str]],
    burgers: Sequence[Sequence[Number | str]],
    name: str | None = None,
) -> Frame:
    """Straight dislocations along z through points of the plane, with any Burgers vectors.

    Equation
    --------
    e^i = dx^i + sum_k b_k^i / (2 pi) dphi_k,  dphi_k = ((x - x_k) dy - (y - y_k) dx) / r_k^2:
    torsion vanishes off the lines, and a loop has b = sum of windings times b_k.

    Parameters
    ----------
    positions
        (x_k, y_k), shape (m, 2); numbers or expressions. Floats are read as decimals: 0.1 is 1/10.
    burgers
        b_k^i, shape (m, 3).

    Raises
    ------
    ShapeError
        The numbers of Burgers vectors and positions differ, or two lines coincide.

    Examples
    --------
    >>> frame = parallel_dislocations([(0, 0), (1, 0)], [(0, 0, 1), (1, 0, 0)])
    >>> frame.anholonomy.is_zero
    True
    """
    places = [_exact(row, 2, f"positions[{k}]") for k, row in enumerate(positions)]
    vectors = [_exact(row, 3, f"burgers[{k}]") for k, row in enumerate(burgers)]
    if not places or len(places) != len(vectors):
        raise ShapeError(
            f"expected one Burgers vector for each line, got {len(places)} positions and "
            f"{len(vectors)} vectors."
        )
    if len(set(places)) < len(places):
        raise ShapeError("two lines have the same position. Add their Burgers vectors instead.")
    for k, place in enumerate(places):
        symbols = {s.name for x in (*place, *vectors[k]) for s in x.free_symbols}
        if symbols & {"x", "y", "z"}:
            raise ShapeError(
                f"positions[{k}], burgers[{k}]: a straight line needs constants, but they "
                "contain x, y or z. Rename the symbol, or make a Frame."
            )
    return frame_of_lines((X, Y, Z), places, vectors, name or "parallel dislocations")


def parallel_screws(positions: Sequence[Exact], burgers: Exact) -> Frame:
    """Straight screw dislocations along z, b_k along z.

    Examples
    --------
    >>> from geomtorsion.loops import Loop, burgers_vector
    >>> frame = parallel_screws([(-1, 0), (1, 0)], [1, -2])
    >>> b = burgers_vector(frame, Loop.circle([0, 0, 0], 3))
    >>> round(float(b.vector[2]), 12)
    -1.0
    """
    return parallel_dislocations(positions, [(0, 0, b) for b in burgers], "parallel screws")


def parallel_edges(positions: Sequence[Exact], burgers: Sequence[Exact]) -> Frame:
    """Straight edge dislocations along z, b_k in the plane across, shape (m, 2).

    Examples
    --------
    >>> parallel_edges([(0, 0)], [(1, 0)]).coframe[1, 1]
    1
    """
    return parallel_dislocations(positions, [(*b, 0) for b in burgers], "parallel edges")


def dispiration(alpha: Number | str, b: Number | str) -> Frame:
    """Dispiration: a wedge of angle 2 pi (1 - alpha) is removed, the faces joined a step b higher.

    Equation
    --------
    e^1 = cos phi dr - alpha r sin phi dphi,  e^2 = sin phi dr + alpha r cos phi dphi,
    e^3 = dz + b / (2 pi) dphi, in Cartesian coordinates: a disclination and a screw on one axis.
    With its Levi-Civita connection plus the flat one along z, a loop about the axis turns by
    2 pi (1 - alpha) and moves by b along it, whatever its shape.

    Parameters
    ----------
    alpha
        Remaining fraction of the full angle; 1: no disclination.
    b
        Step of the screw; 0: only a wedge disclination.

    Examples
    --------
    >>> dispiration(1, 0).coframe.nonzero()
    {(0, 0): 1, (1, 1): 1, (2, 2): 1}
    """
    left, step = (_expression(value, name) for name, value in (("alpha", alpha), ("b", b)))
    square = X**2 + Y**2
    # dr / r and dphi as coefficients of dx and dy.
    radial, angular = (X / square, Y / square), (-Y / square, X / square)
    rows = [
        [X * radial[k] - left * Y * angular[k] for k in range(2)] + [sp.S.Zero],
        [Y * radial[k] + left * X * angular[k] for k in range(2)] + [sp.S.Zero],
        [step / (2 * sp.pi) * angular[k] for k in range(2)] + [sp.S.One],
    ]
    return Frame(
        [X, Y, Z], [[sp.cancel(entry) for entry in row] for row in rows], name="dispiration"
    )


def _exact(row: Exact, length: int, where: str) -> tuple[sp.Expr, ...]:
    """A row of exact numbers or expressions."""
    listed = checks.entries(row, where, ShapeError, length, expected=f"{length} numbers")
    return tuple(_expression(value, f"{where}[{k}]") for k, value in enumerate(listed))


def _expression(value: object, where: str) -> sp.Expr:
    """An exact number or expression; text such as "1/2" is read as a number."""
    read = partial(parse_expression, symbols={}, functions={}, where=where)
    return exact_number(checks.expression(value, where, LoopError, read=read))
