"""Elimination: highest derivatives from equations that vanish on solutions, all exactly."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.errors import GravityError, LimitError
from geomtorsion.exact import Element, limits
from geomtorsion.gravity.jets import Jets, Place
from geomtorsion.support import checks


class ContradictionError(GravityError):
    """Residuals have no common solution, if no factor vanishes that was divided out."""


@dataclass(frozen=True, eq=False)
class Residual:
    """An expression that vanishes on solutions.

    element: over jets. unknowns: the functions that it is meant to determine.
    """

    element: Element
    unknowns: frozenset[AppliedUndef] = frozenset()


@dataclass(frozen=True, eq=False)
class Rule:
    """The highest derivative of an unknown function, or the function, by everything below it.

    order: of the derivative; 0 for a function that is eliminated.
    """

    order: int
    value: Element


@dataclass(frozen=True, eq=False)
class Eliminated:
    """Rules for unknown functions, the constraints that are left, symbols that vanish nowhere.

    residuals: numerators of all equations, before derivatives are eliminated.
    """

    rules: Mapping[AppliedUndef, Rule]
    constraints: tuple[Element, ...]
    nonzero: frozenset[sp.Symbol]
    residuals: tuple[Element, ...]


class Elimination:
    """Linear elimination of the highest derivatives from residuals, all exactly.

    A residual that is linear in a highest derivative gives its rule. All others are constraints;
    their derivatives are added until they follow from the rules and from each other.

    jets: the unknown functions and their derivatives as symbols.
    unknowns: functions to determine, the ones that are eliminated first at the front.
    nonzero: functions that vanish nowhere, such as the factors of a coframe.
    algebraic: functions that a residual without their derivatives eliminates, such as torsion.
    vanishing: those that vanish in a product, because they are a difference of connections.
    """

    def __init__(
        self,
        jets: Jets,
        unknowns: Sequence[AppliedUndef],
        nonzero: Iterable[AppliedUndef],
        algebraic: Collection[AppliedUndef],
        vanishing: Iterable[AppliedUndef],
    ) -> None:
        self.jets = jets
        self.unknowns = tuple(unknowns)
        self.nonzero = frozenset(jets.symbol(one, 0) for one in nonzero)
        self._algebraic = frozenset(algebraic)
        # In a product v (...) = 0 torsion vanishes: the brackets are as for a free connection.
        self._vanishing = frozenset(jets.symbol(one, 0) for one in vanishing)
        self.rules: dict[AppliedUndef, Rule] = {}
        self._divisors: dict[sp.Expr, None] = {}
        # Derivatives whose values are being computed.
        self._active: set[Place] = set()

    @property
    def factors(self) -> list[Element]:
        """Factors with functions of connections that were divided out, as if they never vanish."""
        own = [one for one in self._divisors if self._has_algebraic(one)]
        return [self._signed(self.jets.field.read(one)) for one in own]

    @property
    def special(self) -> set[str]:
        """The other factors that were divided out, such as a' in a' (...) = 0."""
        return {str(one) for one in self._divisors if not self._has_algebraic(one)}

    def _has_algebraic(self, factor: sp.Expr) -> bool:
        places = self.jets.places(self.jets.field.read(factor))
        return any(place.function in self._algebraic for place in places)

    def run(self, residuals: Iterable[Residual]) -> Eliminated:
        """Rules and constraints of residuals."""
        pool, done = self._simplified(residuals), set[Element]()
        first = tuple(one.element for one in pool)
        while True:
            pool = self._solved(pool, careful=True)
            if self._missing:
                pool = self._solved(self._solved(pool, careful=False), careful=True)
            new = self._prolonged(pool, done)
            if not new:
                constraints = tuple(self._independent(pool))
                return Eliminated(dict(self.rules), constraints, self.nonzero, first)
            pool = self._simplified([*pool, *new])

    @property
    def _missing(self) -> list[AppliedUndef]:
        return [one for one in self.unknowns if one not in self.rules]

    # -- residuals -------------------------------------------------------------------------------

    def _simplified(self, residuals: Iterable[Residual]) -> list[Residual]:
        """Numerators by the rules, without factors that vanish nowhere; each once, short first."""
        table: dict[str, Residual] = {}
        for one in residuals:
            element = self._numerator(self.reduced(one.element))
            if element.is_zero:
                continue
            if not self.jets.places(element):
                raise ContradictionError(
                    "reduce: expected equations that have a solution, got "
                    f"{checks.cut(str(one.element.sympy))} = 0, which leads to {element.sympy} = "
                    "0. Check the matter, the conditions and the ansatz, or add an unknown "
                    "function."
                )
            old = table.get(str(element))
            own = one.unknowns if old is None else one.unknowns | old.unknowns
            table[str(element)] = Residual(element, own)
        return sorted(table.values(), key=lambda one: (one.element.length, str(one.element)))

    def _numerator(self, element: Element) -> Element:
        """The factors of a numerator that contain unknown functions, each once."""
        element = self.jets.whole(element)
        factors = self._factors(element)
        if not factors:
            return self.jets.field.zero if element.is_zero else self.jets.field.one
        vanishing = [one for one in factors if one in self._vanishing]
        # A universe at rest, a' = 0, is not the general solution of a' (...) = 0.
        moving = [one for one in factors if one not in self.jets.symbols]
        chosen = vanishing[:1] or moving or factors
        self._divisors |= dict.fromkeys(one for one in factors if one not in chosen)
        return self._signed(self.jets.field.read(sp.Mul(*chosen).as_content_primitive()[1]))

    def _factors(self, element: Element) -> list[sp.Expr]:
        """The factors of a numerator that contain unknown functions and may vanish."""
        above, _ = sp.fraction(element.sympy)
        factors = []
        for factor in sp.Mul.make_args(above):
            base = factor.base if factor.is_Pow and factor.exp.is_Integer else factor
            symbols = base.free_symbols & self.jets.symbols
            if symbols and base not in self.nonzero:
                factors.append(base)
        return factors

    def _signed(self, element: Element) -> Element:
        """An element or its negative, whichever is written with fewer signs."""
        if element.length > limits.MOST_AT_ONCE:
            raise LimitError(f"a residual has {element.length:,} terms")
        negative = -element
        return min(element, negative, key=lambda one: (str(one).count("-"), str(one)[0] == "-"))

    def reduced(self, element: Element) -> Element:
        """An element without the derivatives for which there are rules."""
        while True:
            table = {
                place.symbol: self._value(place)
                for place in self.jets.places(element)
                if place.function in self.rules and place.order >= self.rules[place.function].order
            }
            if not table:
                return element
            element = self.jets.whole(self.jets.replaced(element, table))

    def _value(self, place: Place) -> Element:
        """A derivative by the rule of its function, not yet reduced."""
        if place in self._active:
            raise RecursionError(f"{place.symbol} refers to itself")
        self._active.add(place)
        rule = self.rules[place.function]
        value = rule.value
        for _ in range(place.order - rule.order):
            value = self.reduced(self.jets.derivative(value))
        self._active.remove(place)
        return value

    # -- rules -----------------------------------------------------------------------------------

    def _solved(self, pool: list[Residual], *, careful: bool) -> list[Residual]:
        """The residuals that remain after each linear one has given a leading derivative.

        careful: only rules with a value where all derivatives vanish.
        """
        while True:
            choice = self._choice(pool, careful)
            if choice is None:
                return pool
            residual, place, value = choice
            slope = self.jets.whole(residual.element.diff(place.symbol))
            self._divisors |= dict.fromkeys(self._factors(slope))
            rest = [one for one in pool if one is not residual]
            old = self.rules.pop(place.function, None)
            if old is not None:
                leader = self.jets.element(place.function, old.order)
                rest.append(Residual(leader - old.value, frozenset((place.function,))))
            self.rules[place.function] = Rule(place.order, value)
            for function, rule in list(self.rules.items()):
                if function != place.function:
                    self.rules[function] = replace(rule, value=self.reduced(rule.value))
            pool = self._simplified(rest)

    def _choice(
        self, pool: Sequence[Residual], careful: bool
    ) -> tuple[Residual, Place, Element] | None:
        """A residual, a derivative in which it is linear, and the value of this derivative."""
        ways = []
        for number, one in enumerate(pool):
            places = self.jets.places(one.element)
            top = max(place.order for place in places)
            for place in places:
                rank = self._rank(one, place, places, top)
                if rank is not None and (careful or place.function not in self.rules):
                    ways.append((rank, number, self.unknowns.index(place.function), place))
        for _, number, _, place in sorted(ways, key=lambda way: way[:3]):
            value = self._linear(pool[number].element, place)
            if value is not None and (not careful or self._is_regular(value)):
                return pool[number], place, value
        return None

    def _rank(
        self, residual: Residual, place: Place, places: Sequence[Place], top: int
    ) -> tuple[int, int, int] | None:
        """How early a derivative is solved for; None for never."""
        function, other = place.function, int(place.function not in residual.unknowns)
        if place.order == 0:
            highest = max(one.order for one in places if one.function == function)
            eliminated = function in self._algebraic and highest == 0
            return (0, top, other) if top == 0 or eliminated else None
        return (1, other, place.order) if place.order == top else None

    def _linear(self, element: Element, place: Place) -> Element | None:
        """The value of a derivative in which an element is linear."""
        slope = element.diff(place.symbol)
        if slope.is_zero or place.symbol in slope.symbols:
            return None
        leader = self.jets.element(place.function, place.order)
        return self.jets.whole(leader - element / slope)

    def _is_regular(self, value: Element) -> bool:
        """Whether a value exists where all derivatives vanish."""
        _, below = sp.fraction(value.sympy)
        zeros = {
            place.symbol: sp.S.Zero
            for place in self.jets.places(value)
            if place.order and place.symbol in below.free_symbols
        }
        at_rest = below.xreplace(zeros)
        return at_rest != 0 and not at_rest.has(sp.zoo, sp.nan, sp.oo)

    # -- constraints -----------------------------------------------------------------------------

    def _prolonged(self, pool: Sequence[Residual], done: set[Element]) -> list[Residual]:
        """Derivatives of constraints, unless these follow from the rules and the constraints."""
        new = []
        for one in pool:
            if one.element in done:
                continue
            done.add(one.element)
            rate = self._numerator(self.reduced(self.jets.derivative(one.element)))
            if not self._follows(rate, [other.element for other in pool]):
                new.append(Residual(rate, frozenset(self._missing)))
        return new

    def _follows(self, element: Element, constraints: Sequence[Element]) -> bool:
        """Whether an element vanishes wherever the constraints hold."""
        # Twice, because a constraint may bring back powers that an earlier one removes.
        for constraint in (*constraints, *constraints):
            if element.is_zero:
                return True
            element = self._numerator(self._remainder(element, constraint))
        return element.is_zero is True

    def _independent(self, pool: Sequence[Residual]) -> list[Element]:
        """Constraints that do not follow from shorter ones."""
        constraints: list[Element] = []
        for one in pool:
            if not self._follows(one.element, constraints):
                constraints.append(one.element)
        return constraints

    def _remainder(self, element: Element, constraint: Element) -> Element:
        """An element without the powers that a constraint removes."""
        common = [x for x in self.jets.places(constraint) if x.symbol in element.symbols]
        ways = [(self.jets.coefficients(constraint, x.symbol), x.symbol) for x in common]
        fitting = [(len(parts), str(x), parts, x) for parts, x in ways if parts is not None]
        if not fitting:
            return element
        _, _, divisor, symbol = min(fitting, key=lambda way: way[:2])
        parts = self.jets.coefficients(element, symbol)
        if parts is None:
            return element
        lead = divisor[-1]
        while len(parts) >= len(divisor):
            factor, shift = parts[-1] / lead, len(parts) - len(divisor)
            parts = [
                part - factor * divisor[k - shift] if k >= shift else part
                for k, part in enumerate(parts[:-1])
            ]
        power, total = self.jets.field.one, self.jets.field.zero
        for part in parts:
            total, power = total + part * power, power * self.jets.field.read(symbol)
        return total
