"""Law: rates of named states, compiled once for all starts and all values of the parameters."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import sympy as sp

from geomtorsion.exact.field import Field
from geomtorsion.motion.flows.tape import Tape
from geomtorsion.motion.flows.terms import Folding
from geomtorsion.motion.flows.tree import TreeSystem, check_smooth, is_plain
from geomtorsion.motion.system import System

# Laws that are kept read; each is some kilobytes.
KEPT = 256
# The clock runs in such units of time: its number stays far below all others, and engines that
# measure errors against the largest state do not lose the small ones in it.
CLOCK = 2**40
# Less than any rounding: heyoka misses all roots after one at the very start of a step.
TINY = sp.Rational(1, 10**300)
# Names that go with the components of one vector.
_AXES = ("x", "y", "z")


@dataclass(frozen=True, eq=False)
class Law:
    """Rates as users gave them, and the system that engines integrate.

    rates: state -> sympy expression over states, parameters and time.
    parameters: names of the numbers that may be chosen for each run.
    time: the symbol that stands for the time.
    stop: expression at whose fall through zero the motion ends, or None.
    blocks: groups of states whose sizes are measured together.
    """

    rates: Mapping[str, sp.Expr]
    parameters: tuple[str, ...]
    time: str
    stop: sp.Expr | None
    blocks: tuple[tuple[str, ...], ...]

    @cached_property
    def states(self) -> tuple[str, ...]:
        """Names of the states."""
        return tuple(self.rates)

    @cached_property
    def clock(self) -> bool:
        """Whether the time stands in the equations, and is carried as one more state."""
        name = self.time
        terms = [*self.rates.values(), *([] if self.stop is None else [self.stop])]
        return any(symbol.name == name for term in terms for symbol in term.free_symbols)

    @cached_property
    def _folding(self) -> tuple[Folding, tuple[sp.Expr, ...], sp.Expr | None]:
        names = (*self.states, self.time)
        folding = Folding(sp.Symbol(name, real=True) for name in names)
        time = sp.Symbol(self.time, real=True)
        ticks = {time: CLOCK * time}
        rates = tuple(folding.folded(rate.xreplace(ticks)) for rate in self.rates.values())
        stop = None if self.stop is None else folding.folded(self.stop.xreplace(ticks))
        return folding, rates, stop

    @cached_property
    def system(self) -> System:
        """The equations for an engine; equal laws share one."""
        _, rates, stop = self._folding
        index = {name: k for k, name in enumerate(self.states)}
        blocks = tuple(tuple(index[name] for name in block) for block in self.blocks)
        return _system(self.states, rates, stop, blocks, self.time if self.clock else "")

    @cached_property
    def numbers(self) -> Tape:
        """The run-time numbers of the system, from the parameters."""
        folding, _, _ = self._folding
        known = {symbol.name: value for value, symbol in folding.names.items()}
        wanted = [known.get(name, sp.Symbol(name, real=True)) for name in self.system.parameters]
        return Tape(self.parameters, tuple(wanted))


@lru_cache(maxsize=KEPT)
def _system(
    states: tuple[str, ...],
    rates: tuple[sp.Expr, ...],
    stop: sp.Expr | None,
    blocks: tuple[tuple[int, ...], ...],
    clock: str,
) -> System:
    """Rates read exactly, or kept as they were written where that would make them longer."""
    names = (*states, clock) if clock else states
    terms = (
        *rates,
        *((sp.Rational(1, CLOCK),) if clock else ()),
        *(() if stop is None else (stop,)),
    )
    free = {symbol for term in terms for symbol in term.free_symbols}
    others = sorted(symbol.name for symbol in free if symbol.name not in names)
    where = [*(f"rate of {name}" for name in names), *(["stop"] if stop is not None else [])]
    check_smooth(terms, where)
    if clock:
        blocks = (*blocks, (len(states),))
    ticks = (clock, CLOCK) if clock else None
    if not is_plain(terms):
        trees, rim = terms[: len(names)], None if stop is None else terms[-1] + TINY
        edge = None if stop is None else ()
        return TreeSystem(names, tuple(others), (), blocks, edge, ticks, trees=trees, rim=rim)
    field = Field([sp.Symbol(name, real=True) for name in (*names, *others)])
    elements = field.read_all(list(zip(where, terms, strict=True)))
    products = [() if element.is_zero else ((element, ()),) for element in elements]
    rim = field.rational(int(TINY.p), int(TINY.q))
    edge = None if stop is None else (*products[-1], (rim, ()))
    return System(names, tuple(others), tuple(products[: len(names)]), blocks, edge, ticks)


def default_blocks(states: Sequence[str]) -> tuple[tuple[str, ...], ...]:
    """States that share a stem, as q0 ... q3, or x, y, z behind one, as vx, vy, vz.

    Examples
    --------
    >>> default_blocks(["q0", "q1", "x", "y", "vx", "vy", "m"])
    (('q0', 'q1'), ('x', 'y'), ('vx', 'vy'), ('m',))
    """
    groups: dict[str, list[str]] = {}
    for name in states:
        stem = re.sub(r"_?\d+$", "", name)
        if stem == name and name.endswith(_AXES):
            stem = name[:-1] + " axes"
        groups.setdefault(stem, []).append(name)
    return tuple(tuple(group) for group in groups.values())
