"""Rates: first-order equations as users give them, and the system that engines integrate."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import sympy as sp

from geomtorsion.codegen import Graph, graph
from geomtorsion.errors import ExpressionError
from geomtorsion.ode.pieces import BranchedGraph, term_graph
from geomtorsion.ode.system import System
from geomtorsion.ode.terms import KINKED, STEPS
from geomtorsion.support.caching import cached_property
from geomtorsion.support.copies import ByContent, content
from geomtorsion.support.precision import EPS

# Number of kept equations with their compiled code, some hundred kilobytes each. Dropped ones are
# compiled again to the same code.
KEPT = 128
# The clock counts in such units of time: its number is a rounding of others, and engines that
# measure errors against the largest state do not lose the small ones in it. A power of two rounds
# nothing.
CLOCK = int(1 / EPS)
# Less than any rounding: heyoka misses all roots after one at the very start of a step.
TINY = sp.Rational(1, 10**300)
# Fractions p/q with no larger p, and a power of two up to this as q, are compiled in, for they are
# held exactly. All other numbers are given at run time: a perturbed run shows what rounding them
# does, and one compiled integrator serves all of them. Results are the same.
SMALL = 64
# Names that go with the components of one vector.
_AXES = ("x", "y", "z")


@dataclass(frozen=True, eq=False)
class Rates(ByContent):
    """Rates of named states, compiled once for all starts and all values of the parameters.

    expressions: state -> sympy expression over states, parameters and time.
    parameters: names of the numbers that may be chosen for each run.
    time: the symbol of the time.
    stops: the motion stops when one of these expressions falls to zero.
    norm_groups: groups of states whose errors are measured against their common size.
    declared: the parameters of the input, with their assumptions.
    guards: expressions that are positive up to the next change of the equations.
    is_clocked: whether the time is a state although no rate depends on it.
    domain: quantities that are positive where the equations hold, each with its end in words.
    """

    expressions: Mapping[str, sp.Expr]
    parameters: tuple[str, ...]
    time: str
    stops: tuple[sp.Expr, ...]
    norm_groups: tuple[tuple[str, ...], ...]
    declared: tuple[sp.Symbol, ...] = ()
    guards: tuple[sp.Expr, ...] = ()
    is_clocked: bool = False
    domain: tuple[tuple[sp.Expr, str], ...] = ()

    def __eq__(self, other: object) -> bool:
        # The order of the states is the order of the start.
        if not isinstance(other, Rates):
            return NotImplemented
        return self is other or (self.states, content(self)) == (other.states, content(other))

    __hash__ = ByContent.__hash__

    @cached_property
    def states(self) -> tuple[str, ...]:
        """Names of the states."""
        return tuple(self.expressions)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Everything that may occur in an expression: states, parameters, time."""
        return (*self.states, *self.parameters, self.time)

    @cached_property
    def has_clock(self) -> bool:
        """Whether the equations depend on time, which is then one more state."""
        terms = [*self.expressions.values(), *self.stops, *self.guards]
        depends = any(symbol.name == self.time for term in terms for symbol in term.free_symbols)
        return self.is_clocked or depends

    @cached_property
    def _folding(
        self,
    ) -> tuple[_Folding, tuple[sp.Expr, ...], tuple[sp.Expr, ...], tuple[sp.Expr, ...]]:
        names = (*self.states, self.time)
        folding = _Folding(sp.Symbol(name, real=True) for name in names)
        time = sp.Symbol(self.time, real=True)
        ticks = {time: CLOCK * time}
        rates = tuple(folding.folded(x.xreplace(ticks)) for x in self.expressions.values())
        watched = (*self.stops, *self.guards)
        watched = tuple(folding.folded(x.xreplace(ticks)) for x in watched)
        edges = tuple(folding.folded(x.xreplace(ticks)) for x in self.edges)
        return folding, rates, watched, edges

    @cached_property
    def system(self) -> System:
        """The equations for an engine; equal ones share it."""
        _, rates, watched, edges = self._folding
        index = {name: k for k, name in enumerate(self.states)}
        groups = tuple(tuple(index[name] for name in group) for group in self.norm_groups)
        clock = self.time if self.has_clock else ""
        return _system(self.states, rates, watched, edges, groups, clock, len(self.stops))

    @cached_property
    def numbers(self) -> Graph:
        """The run-time numbers of the system, from the parameters."""
        folding, *_ = self._folding
        values = {symbol.name: value for value, symbol in folding.names.items()}
        terms = [values.get(name, sp.Symbol(name, real=True)) for name in self.system.parameters]
        return graph(self.parameters, terms, factor=False)

    @cached_property
    def stop_graph(self) -> Graph | BranchedGraph | None:
        """The stops over states, parameters and time."""
        return term_graph(self.names, self.stops) if self.stops else None

    @cached_property
    def edges(self) -> Mapping[sp.Expr, str]:
        """Quantities that are positive until a function in the equations ends; its name."""
        terms = (*self.expressions.values(), *self.stops, *self.guards)
        return {**dict(self.domain), **edges_of(terms, {*self.states, self.time})}

    def needed_by(
        self, terms: Iterable[sp.Expr], groups: Iterable[Sequence[str]] = ()
    ) -> frozenset[str]:
        """The states on which some terms and the stop depend; states of a group are together."""
        left = [*terms, *self.stops]
        needed: set[str] = set()
        while left:
            names = names_in(left)
            names |= {name for group in groups if names & {*group} for name in group}
            new = names & self.expressions.keys() - needed
            needed |= new
            left = [self.expressions[name] for name in new]
        return frozenset(needed)

    def restricted(self, states: Collection[str]) -> Rates:
        """The rates of some states, on which all of them depend."""
        groups = (tuple(x for x in group if x in states) for group in self.norm_groups)
        return replace(
            self,
            expressions={name: x for name, x in self.expressions.items() if name in states},
            norm_groups=tuple(group for group in groups if group),
        )

    @cached_property
    def guard_graph(self) -> Graph:
        """The stops, the guards and the edges, over states, parameters and time."""
        return graph(self.names, [*self.stops, *self.guards, *self.edges], factor=False)

    @cached_property
    def rate_graph(self) -> Graph | BranchedGraph:
        """The rates over states, parameters and time."""
        return term_graph(self.names, list(self.expressions.values()))


def names_in(terms: Iterable[sp.Expr]) -> set[str]:
    """Names of the symbols in some expressions."""
    return {str(symbol) for term in terms for symbol in term.free_symbols}


@lru_cache(maxsize=KEPT)
def _system(
    states: tuple[str, ...],
    rates: tuple[sp.Expr, ...],
    watched: tuple[sp.Expr, ...],
    edges: tuple[sp.Expr, ...],
    groups: tuple[tuple[int, ...], ...],
    clock: str,
    stops: int,
) -> System:
    """The equations, with a clock as last state where one is named."""
    names = (*states, clock) if clock else states
    terms = (*rates, *((sp.Rational(1, CLOCK),) if clock else ()))
    every = (*terms, *watched)
    free = {symbol.name for term in (*every, *edges) for symbol in term.free_symbols}
    others = tuple(sorted(free - set(names)))
    where = [*(f"rate of {name}" for name in names), *(["stop"] * len(watched))]
    check_smooth(every, where)
    if clock:
        groups = (*groups, (len(states),))
    arguments = (*names, *others)
    guards = [*(term + TINY for term in watched), *edges]
    guard = graph(arguments, guards, others) if guards else None
    rate_graph = graph(arguments, list(terms), others)
    ticks = (clock, CLOCK) if clock else None
    return System(names, others, rate_graph, groups, guard, None, ticks, tuple(range(stops)))


def check_smooth(terms: Sequence[sp.Expr], where: Sequence[str]) -> None:
    """Refuse functions with kinks or jumps."""
    for term, place in zip(terms, where, strict=True):
        for part in sp.preorder_traversal(term):
            if type(part).__name__ in {**KINKED, **STEPS}:
                raise ExpressionError(
                    f"{place}: {part} is not smooth. Write the expression of one side (and stop or "
                    "switch where it ends), or pieces(x, a, 1, b) for a below x = 1 and b above."
                )


def default_groups(states: Sequence[str]) -> tuple[tuple[str, ...], ...]:
    """States that share a stem, as q0 ... q3, or x, y, z behind one, as vx, vy, vz.

    Examples
    --------
    >>> default_groups(["q0", "q1", "x", "y", "vx", "vy", "m"])
    (('q0', 'q1'), ('x', 'y'), ('vx', 'vy'), ('m',))
    """
    groups: dict[str, list[str]] = {}
    for name in states:
        stem = re.sub(r"_?\d+$", "", name)
        if stem == name and name.endswith(_AXES):
            stem = name[:-1] + " axes"
        groups.setdefault(stem, []).append(name)
    return tuple(tuple(group) for group in groups.values())


class _Folding:
    """Replaces subexpressions that depend only on parameters by numbers given at run time.

    The rest depends on the states; small fractions stay. The numbers are computed exactly and
    rounded once.
    """

    def __init__(self, states: Iterable[sp.Symbol]) -> None:
        self.states = frozenset(states)
        self.names: dict[sp.Expr, sp.Symbol] = {}
        self._free: dict[sp.Basic, bool] = {}
        self._done: dict[sp.Expr, sp.Expr] = {}

    def folded(self, expr: sp.Expr) -> sp.Expr:
        """The expression with its numbers named."""
        folded = self._done.get(expr)
        if folded is None:
            folded = self._done[expr] = self._fold(expr)
        return folded

    def _is_free(self, expr: sp.Basic) -> bool:
        """Whether no state occurs; each part is looked at once."""
        is_free = self._free.get(expr)
        if is_free is None:
            inside = all(self._is_free(arg) for arg in expr.args)
            is_free = self._free[expr] = inside and expr not in self.states
        return is_free

    def _fold(self, expr: sp.Expr) -> sp.Expr:
        if self._is_free(expr):
            return self._number(expr)
        if isinstance(expr, sp.Symbol):
            return expr
        if isinstance(expr, sp.Add | sp.Mul):
            free = [arg for arg in expr.args if self._is_free(arg)]
            bound = [self.folded(arg) for arg in expr.args if not self._is_free(arg)]
            if free:
                bound.append(self._number(expr.func(*free)))
            return expr.func(*bound)
        if isinstance(expr, sp.Pow):
            exponent = expr.exp
            if isinstance(exponent, sp.Float):
                exponent = sp.Rational(exponent)
            if exponent.is_Rational and abs(exponent.p) <= SMALL and exponent.q <= SMALL:
                return self.folded(expr.base) ** exponent
        return expr.func(*(self.folded(arg) for arg in expr.args))

    def _number(self, expr: sp.Expr) -> sp.Expr:
        value = sp.Rational(expr) if isinstance(expr, sp.Float) else expr
        held = value.is_Rational and value.q <= SMALL and value.q & (value.q - 1) == 0
        if held and abs(value.p) <= SMALL:
            return value
        if value not in self.names:
            # With a blank in it no user can have given this name.
            self.names[value] = sp.Symbol(f"number {len(self.names) + 1}", real=True)
        return self.names[value]


# Quantity that is positive as long as an inverse function of u has a valid series.
_INSIDE: Mapping[str, Callable[[sp.Expr], sp.Expr]] = {
    "acos": lambda u: 1 - u**2,
    "asin": lambda u: 1 - u**2,
    "atanh": lambda u: 1 - u**2,
    "acosh": lambda u: u - 1,
    "asec": lambda u: 1 - u**-2,
    "acsc": lambda u: 1 - u**-2,
    "acoth": lambda u: 1 - u**-2,
    "asech": lambda u: 1 / u - 1,
    "log": lambda u: u,
}


def edges_of(terms: Iterable[sp.Expr], moving: set[str]) -> Mapping[sp.Expr, str]:
    """Quantity that is positive until a function in some terms ends -> the reason, in words.

    Roots are watched themselves, and so is the root of what other functions need: where it is
    touched, as 1 - x**2 is by x = cos(t), it has a double zero and its root a simple one, beyond
    which series continue unchanged, but roots and inverse functions do not.

    moving: names of what changes on the way.

    Examples
    --------
    >>> x, y = sp.symbols("x y", real=True)
    >>> edges_of([sp.sqrt(x) + sp.acos(y)], {"x", "y"})
    {sqrt(x): 'sqrt(x) = 0', sqrt(1 - y**2): '1 - y**2 = 0, where acos(y) ends'}
    """
    edges: dict[sp.Expr, str] = {}
    for term in terms:
        for part in dict.fromkeys(sp.preorder_traversal(term)):
            if not part.args or not _moves(part.args[0], moving):
                continue
            inside = _INSIDE.get(type(part).__name__)
            if inside is not None:
                room = inside(part.args[0])
                root = sp.sqrt(room)
                if not root.has(sp.Abs):
                    edges.setdefault(root, f"{room} = 0, where {part} ends")
            elif isinstance(part, sp.Pow):
                root = sp.sqrt(part.base)
                if part.exp.is_Rational or isinstance(part.exp, sp.Float):
                    if _is_even_root(part.exp) and _may_end(term, part, moving):
                        edges[root] = f"{root} = 0"
                elif not (part.exp.is_integer or part.base.is_positive or root.has(sp.Abs)):
                    room = _unless_whole(part.base, part.exp, moving)
                    edges[sp.sqrt(room)] = f"{part.base} = 0, in {part}"
    return edges


def _moves(expr: sp.Basic, moving: set[str]) -> bool:
    """Whether an expression changes on the way."""
    return any(symbol.name in moving for symbol in expr.free_symbols)


def _is_even_root(exponent: sp.Expr) -> bool:
    """Whether a power has no value where its base is below zero, but a series may have one."""
    return sp.Rational(exponent).q % 2 == 0


def _unless_whole(base: sp.Expr, exponent: sp.Expr, moving: set[str]) -> sp.Expr:
    """The base of a power, but one if the exponent, known at run time, is a whole number."""
    if _moves(exponent, moving):
        return base
    broken = sp.sign(exponent - sp.floor(exponent))
    return broken * base + 1 - broken


def _may_end(term: sp.Expr, root: sp.Pow, moving: set[str]) -> bool:
    """Whether a root may vanish with a finite term around it that its other sign would change.

    The root of a term that may be negative always may; the root of a sum of squares only touches
    zero, and not if one of the squares is constant.
    """
    base = root.base
    if not base.is_nonnegative:
        return True
    if base.is_positive or root.exp < -sp.S.Half:
        return False
    if base.is_Add and not all(_moves(square, moving) for square in base.args):
        return False
    return changes_with_sign(term, base)


def changes_with_sign(term: sp.Expr, base: sp.Expr) -> bool:
    """Whether a term is another one when the square root of a part of it changes its sign.

    Examples
    --------
    >>> x, y = sp.symbols("x y")
    >>> radius = sp.sqrt(x**2 + y**2)
    >>> [changes_with_sign(term, x**2 + y**2) for term in (x / radius, sp.cos(radius))]
    [True, False]
    """
    positive = sp.Dummy(positive=True)
    powers = [power for power in term.atoms(sp.Pow) if power.base == base]

    def with_root(value: sp.Expr) -> sp.Expr:
        return term.xreplace({power: value ** (2 * power.exp) for power in powers})

    return with_root(positive) != with_root(-positive)
