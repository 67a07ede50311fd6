"""Reduced system: equations of first order with shorthands and one common factor."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from geomtorsion.exact.engine_code import Products
from geomtorsion.motion.system import System, derivative

if TYPE_CHECKING:
    from geomtorsion.exact import Element


# What a state costs by itself, in products.
PER_STATE = 3


@dataclass(frozen=True, eq=False)
class Reduced(System):
    """A system whose rates may name sums of products of states and parameters.

    given: names and the sums that they stand for, each worked out once.
    scale: a factor of all rates, multiplied last; None: one.
    """

    given: tuple[tuple[str, Products], ...] = ()
    scale: Element | None = None

    @cached_property
    def _first(self) -> System:
        """The sums that have names, and the factor of all rates."""
        factor: list[Products] = [((self.scale, ()),)] if self.scale is not None else []
        sums = (*(sums for _, sums in self.given), *factor)
        return System(self.states, self.parameters, sums, ())

    @cached_property
    def _second(self) -> System:
        """The rates, with names for those sums among the states."""
        names = (name for name, _ in self.given)
        return System((*self.states, *names), self.parameters, self.rates, (), self.edge)

    @cached_property
    def code(self) -> tuple[str, set[str]]:
        """Python source of the rates, the named sums before them, and the functions it calls."""
        if not self._first.rates:
            return self._second.code
        (first, one), (second, two) = self._first.code, self._second.code
        size, count = self.size, len(self.given)
        states = ", ".join(f"a{k}" for k in range(size))
        rest = "".join(f", a{k}" for k in range(size, size + len(self.parameters)))
        more = "".join(f", g{k}" for k in range(count))
        scaled = "s" if self.scale is not None else ""
        lines = [
            first.replace("def values", "def given", 1),
            second.replace("def values", "def rates", 1),
            f"def values({states}{rest}):",
            f"    {more[2:]}{', ' * bool(count and scaled)}{scaled}, = given({states}{rest})",
        ]
        if scaled:
            rates = [f"x{k}" for k in range(size)]
            lines += [
                f"    {', '.join(rates)}, = rates({states}{more}{rest})",
                f"    return ({', '.join(f's*{x}' for x in rates)},)",
            ]
        else:
            lines.append(f"    return rates({states}{more}{rest})")
        return "\n".join(lines), one | two

    @cached_property
    def plain(self) -> tuple[Products, ...]:
        """The rates with the sums in place of their names, multiplied out."""
        table = dict(self.given)
        rows = tuple(substituted(row, table) for row in self.rates)
        if self.scale is None:
            return rows
        scale = self.scale
        return tuple(tuple((value * scale, names) for value, names in row) for row in rows)

    @cached_property
    def jacobian_system(self) -> tuple[Products, ...]:
        """d rate_i / d state_j, row by row."""
        return tuple(derivative(rate, name) for rate in self.plain for name in self.states)

    def written(
        self, known: Mapping[str, Any], number: Callable[[int, int], Any]
    ) -> tuple[list[Any], Any]:
        """Rates and edge as heyoka expressions of the known ones; number: p, q -> p/q."""
        sums = self._first.written(known, number)[0]
        names = [name for name, _ in self.given]
        rates, edge = self._second.written(
            dict(known) | dict(zip(names, sums, strict=False)), number
        )
        if self.scale is not None:
            rates = [x * sums[-1] if row else x for x, row in zip(rates, self.rates, strict=True)]
        return rates, edge


def substituted(products: Products, table: Mapping[str, Products]) -> Products:
    """A sum of products with sums in place of the names that stand for them, like terms added."""
    waiting = list(products)
    found: dict[tuple[str, ...], list[Any]] = {}
    while waiting:
        value, names = waiting.pop()
        hit = next((name for name in names if name in table), None)
        if hit is None:
            found.setdefault(tuple(sorted(names)), []).append((1, value))
            continue
        rest = list(names)
        rest.remove(hit)
        waiting += [(value * other, (*rest, *more)) for other, more in table[hit]]
    return gathered(found)


def gathered(found: Mapping[tuple[str, ...], Sequence[Any]]) -> Products:
    """Collected terms of a field's `sum`, added up; what vanishes is left out."""
    totals = []
    for names, terms in sorted(found.items(), key=lambda item: item[0]):
        value = terms[0][1].field.sum(terms)
        if not value.is_zero:
            totals.append((value, names))
    return tuple(totals)


def names_in(every: Sequence[Products]) -> set[str]:
    """All names that multiply something in some sums."""
    return {name for sums in every for _, names in sums for name in names}


def effort(system: System) -> int:
    """What an evaluation of the rates costs, in products; each state costs some, too."""
    code = system.code[0]
    calls = sum([code.count(f"{name}(") for name in system.code[1]])
    return code.count("*") + 2 * code.count("/") + 4 * calls + PER_STATE * system.size
