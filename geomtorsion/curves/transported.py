"""Transported: vectors carried along a motion, in parallel or as deviation of a neighbour."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeAlias

from geomtorsion.codegen import Products
from geomtorsion.curves.equations import Equations, derivative, symbols_in
from geomtorsion.ode.numbers import Real

if TYPE_CHECKING:
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
        n, names = len(self.offset), self.names()
        moving = (*plain.states[:n], *plain.velocities)
        rates: list[Products] = list(plain.rates)
        rates += [()] * (2 * n - len(rates))
        return tuple(
            tuple(
                (element, (*factors, names[k]))
                for k, name in enumerate(moving)
                for element, factors in derivative(rate, name)
            )
            for rate in rates
        )


Carried: TypeAlias = TransportedVectors | Deviation


def carrying(plain: Equations, carried: Carried) -> Equations:
    """The equations with the carried quantities added as states."""
    names = carried.names()
    groups = (*plain.groups, *_groups(carried, len(plain.states)))
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


def _groups(carried: Carried, first: int) -> list[tuple[int, ...]]:
    """Each transported vector, or offset and rate together."""
    if isinstance(carried, Deviation):
        count = len(carried.start)
        return [tuple(range(first, first + count))]
    n = len(carried.vectors[0])
    return [tuple(range(first + v * n, first + (v + 1) * n)) for v in range(len(carried.vectors))]
