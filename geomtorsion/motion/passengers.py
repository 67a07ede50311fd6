"""Passengers: vectors that ride along a motion, transported or as separations of neighbours."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from geomtorsion.exact.engine_code import Products
from geomtorsion.motion.equations import Equations, symbols_in
from geomtorsion.motion.system import System, derivative

if TYPE_CHECKING:
    from geomtorsion.geometry import Connection
    from geomtorsion.motion.problem import Problem


@dataclass(frozen=True, eq=False)
class Transported:
    """Vectors w^j carried parallel: w'^k = - omega_ij^k u^i w^j.

    connection: what parallel means.
    vectors: frame components at the start, one row per vector.
    """

    connection: Connection
    vectors: tuple[tuple[Any, ...], ...]

    any_chart = False

    @property
    def start(self) -> tuple[Any, ...]:
        """All components in a row."""
        return tuple(x for vector in self.vectors for x in vector)

    def names(self) -> tuple[str, ...]:
        """Names of the states."""
        n = len(self.vectors[0])
        return tuple(f"carried{v + 1}_{k + 1}" for v in range(len(self.vectors)) for k in range(n))

    def rates(self, plain: Equations) -> tuple[Products, ...]:
        """Rates of all components."""
        omega = self.connection.spin_connection.in_frame().components.nonzero
        n, names = len(self.vectors[0]), self.names()
        rows: list[list[Any]] = [[] for _ in names]
        for (i, j, k), value in omega.items():
            for v in range(len(self.vectors)):
                pair = (plain.velocities[i], names[v * n + j])
                rows[v * n + k].append((-value, pair))
        return tuple(map(tuple, rows))


@dataclass(frozen=True, eq=False)
class Separation:
    """The vector to a neighbouring motion: the equations of motion, differentiated exactly.

    It obeys D^2 xi / dt^2 = R(u, xi) u + D(T(u, xi)) / dt + ..., torsion included.

    offset: xi^mu at the start.
    rate: change of the frame velocities u^i at the start.
    """

    offset: tuple[Any, ...]
    rate: tuple[Any, ...]

    any_chart = False

    @property
    def start(self) -> tuple[Any, ...]:
        """Offset, then rate."""
        return (*self.offset, *self.rate)

    def names(self) -> tuple[str, ...]:
        """Names of the states."""
        n = len(self.offset)
        return (*(f"offset{k + 1}" for k in range(n)), *(f"turn{k + 1}" for k in range(n)))

    def rates(self, plain: Equations) -> tuple[Products, ...]:
        """The Jacobian of the rates, applied to the separation."""
        n, names = len(self.offset), self.names()
        moving = (*plain.system.states[:n], *plain.velocities)
        rates: list[Products] = list(plain.system.rates)
        rates += [()] * (2 * n - len(rates))
        return tuple(
            tuple(
                (element, (*factors, names[k]))
                for k, name in enumerate(moving)
                for element, factors in derivative(rate, name)
            )
            for rate in rates
        )


Passengers = Transported | Separation


def boarded(plain: Equations, problem: Problem) -> Equations:
    """The equations with the passengers of a problem added as states."""
    passengers = problem.passengers
    assert passengers is not None
    system, names = plain.system, passengers.names()
    first = system.size
    blocks = (*system.blocks, *_blocks(passengers, first))
    states, rates = (*system.states, *names), passengers.rates(plain)
    more = symbols_in(rates, (*states, *system.parameters))
    parameters = (*system.parameters, *more)
    extended = System(states, parameters, (*system.rates, *rates), blocks, system.edge)
    return replace(plain, system=extended, passengers=names)


def _blocks(passengers: Passengers, first: int) -> list[tuple[int, ...]]:
    """Each transported vector, or offset and rate together."""
    if isinstance(passengers, Separation):
        count = len(passengers.start)
        return [tuple(range(first, first + count))]
    n = len(passengers.vectors[0])
    return [
        tuple(range(first + v * n, first + (v + 1) * n)) for v in range(len(passengers.vectors))
    ]


def weights(problem: Problem) -> Sequence[int]:
    """For each passenger: 1 where it scales with the speed of the motion, else 0."""
    passengers = problem.passengers
    if isinstance(passengers, Separation):
        return [0] * len(passengers.offset) + [1] * len(passengers.rate)
    return [0] * (len(passengers.start) if passengers else 0)
