"""Transported: vectors carried along a motion, in parallel, as deviations or as derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeAlias

from geomtorsion.codegen import Products
from geomtorsion.curves.equations import Equations, derivative, symbols_in
from geomtorsion.ode.derivatives import derivative_name
from geomtorsion.ode.numbers import Real

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.geometry import Connection


@dataclass(frozen=True)
class TransportedVectors:
    """Vectors w^j carried parallel: w'^k = - omega_ij^k u^i w^j.

    connection: defines the transport.
    vectors: frame components at the start, one row per vector.
    """

    connection: Connection
    vectors: tuple[tuple[Real, ...], ...]

    any_chart = False

    @property
    def start(self) -> tuple[Real, ...]:
        """All components in a row."""
        return tuple(x for vector in self.vectors for x in vector)

    @property
    def speed_powers(self) -> tuple[int, ...]:
        """For each component: 1 where it scales with the speed of the motion, else 0."""
        return (0,) * len(self.start)

    def names(self) -> tuple[str, ...]:
        """Names of the states."""
        n = len(self.vectors[0])
        return tuple(f"carried{v + 1}_{k + 1}" for v in range(len(self.vectors)) for k in range(n))

    def rates(self, plain: Equations) -> tuple[Products, ...]:
        """Rates of all components."""
        omega = self.connection.spin_connection.in_frame().components.nonzero
        n, names = len(self.vectors[0]), self.names()
        rows: list[list] = [[] for _ in names]
        for (i, j, k), value in omega.items():
            for v in range(len(self.vectors)):
                pair = (plain.velocities[i], names[v * n + j])
                rows[v * n + k].append((-value, pair))
        return tuple(map(tuple, rows))

    def groups(self, plain: Equations) -> list[tuple[int, ...]]:
        """Each vector by itself."""
        first, n = len(plain.states), len(self.vectors[0])
        starts = range(first, first + len(self.vectors) * n, n)
        return [tuple(range(k, k + n)) for k in starts]


@dataclass(frozen=True)
class Deviation:
    """The vector to a neighbouring motion: the equations of motion, differentiated exactly.

    It obeys D^2 xi / dt^2 = R(u, xi) u + D(T(u, xi)) / dt + ..., torsion included.

    offset: xi^mu at the start.
    rate: change of the frame velocities u^i at the start.
    """

    offset: tuple[Real, ...]
    rate: tuple[Real, ...]

    any_chart = False

    @property
    def start(self) -> tuple[Real, ...]:
        """Offset, then rate."""
        return (*self.offset, *self.rate)

    @property
    def speed_powers(self) -> tuple[int, ...]:
        """See `TransportedVectors.speed_powers`."""
        return (*(0 for _ in self.offset), *(1 for _ in self.rate))

    def names(self) -> tuple[str, ...]:
        """Names of the states."""
        n = len(self.offset)
        return (*(f"offset{k + 1}" for k in range(n)), *(f"turn{k + 1}" for k in range(n)))

    def rates(self, plain: Equations) -> tuple[Products, ...]:
        """The Jacobian of the rates, applied to the deviation."""
        return linearized(plain, self.names())

    def groups(self, plain: Equations) -> list[tuple[int, ...]]:
        """Offset and rate together."""
        first = len(plain.states)
        return [tuple(range(first, first + len(self.start)))]


@dataclass(frozen=True)
class Derivatives:
    """Derivatives of coordinates and frame velocities by parameters and numbers at the start.

    by: what to differentiate by.
    varied: coordinates (none without a start), then frame velocities; names.
    columns: for each of `by` the derivatives of these at the start.
    width: number of coordinates.
    """

    by: tuple[str, ...]
    varied: tuple[str, ...]
    columns: tuple[tuple[Real, ...], ...]
    width: int

    any_chart = False

    @property
    def start(self) -> tuple[Real, ...]:
        """All columns in a row."""
        return tuple(x for column in self.columns for x in column)

    @property
    def speed_powers(self) -> tuple[int, ...]:
        """See `TransportedVectors.speed_powers`."""
        one = (0,) * self.width + (1,) * (len(self.varied) - self.width)
        return one * len(self.by)

    def names(self) -> tuple[str, ...]:
        """Names of the states."""
        return tuple(derivative_name(name, by) for by in self.by for name in self.varied)

    def rates(self, plain: Equations) -> tuple[Products, ...]:
        """The Jacobian of the rates, applied to each column, and their slopes in a parameter."""
        return tuple(
            rate
            for by in self.by
            for rate in linearized(plain, [derivative_name(x, by) for x in self.varied], by)
        )

    def groups(self, plain: Equations) -> list[tuple[int, ...]]:
        """Each column in the groups of the motion."""
        groups = list(plain.groups)
        if not plain.moves:
            groups.append(tuple(range(self.width, len(self.varied))))
        first, size = len(plain.states), len(self.varied)
        return [
            tuple(first + size * column + k for k in group)
            for column in range(len(self.by))
            for group in groups
        ]


Carried: TypeAlias = TransportedVectors | Deviation | Derivatives


def linearized(plain: Equations, names: Sequence[str], by: str = "") -> tuple[Products, ...]:
    """Rates of small changes of coordinates and velocities, and of a parameter by one.

    names: of the changes. Velocities that are constant have changes that are constant.
    """
    moving = (*plain.states[: plain.width], *plain.velocities)
    rates: list[Products] = list(plain.rates[: len(names)])
    rates += [()] * (len(names) - len(rates))
    rows = []
    for rate in rates:
        terms: list[tuple[Element, tuple[str, ...]]] = [
            (element, (*factors, name))
            for symbol, name in zip(moving, names, strict=True)
            for element, factors in derivative(rate, symbol)
        ]
        if by and by not in moving:
            terms += derivative(rate, by)
        rows.append(tuple(terms))
    return tuple(rows)


def carrying(plain: Equations, carried: Carried) -> Equations:
    """The equations with the carried quantities added as states."""
    names = carried.names()
    groups = (*plain.groups, *carried.groups(plain))
    states, rates = (*plain.states, *names), carried.rates(plain)
    more = symbols_in(rates, (*states, *plain.parameters))
    return replace(
        plain,
        states=states,
        parameters=(*plain.parameters, *more),
        rates=(*plain.rates, *rates),
        groups=groups,
        carried=names,
    )
