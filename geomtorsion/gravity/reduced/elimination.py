"""Elimination: highest derivatives from equations that vanish on solutions, all exactly."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.errors import GravityError, LimitError
from geomtorsion.exact import Element, limits
from geomtorsion.gravity.reduced.jets import Jets, Place
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
    denominators: of the equations; their factors vanish nowhere.
    """

    def __init__(
        self,
        jets: Jets,
        unknowns: Sequence[AppliedUndef],
        nonzero: Iterable[AppliedUndef],
        algebraic: Collection[AppliedUndef],
        vanishing: Iterable[AppliedUndef],
        denominators: Iterable[Element] = (),
    ) -> None:
        self.jets = jets
        self.unknowns = tuple(unknowns)
        self.nonzero = frozenset(jets.symbol(one, 0) for one in nonzero)
        self._algebraic = frozenset(algebraic)
        # In a product v (...) = 0 torsion vanishes: the brackets are as for a free connection.
        self._vanishing = frozenset(jets.symbol(one, 0) for one in vanishing)
        below = (piece for one in denominators for piece in _pieces(one.sympy))
        self._regular = frozenset(one for one in below if one.free_symbols & jets.symbols)
        self.rules: dict[AppliedUndef, Rule] = {}
        self._constraints: tuple[Element, ...] = ()
        self._omitted: dict[sp.Expr, None] = {}
        self._leading: dict[sp.Expr, None] = {}
        self._zero: frozenset[sp.Expr] = frozenset()
        # Derivatives whose values are being computed.
        self._active: set[Place] = set()

    @property
    def factors(self) -> tuple[list[Element], list[Element]]:
        """Factors that were divided out, as if they never vanish.

        First those with functions of connections, then other factors of products, a' (...) = 0.
        """
        every = {**self._omitted, **self._leading}
        own = [one for one in every if self._has_algebraic(one)]
        others = [one for one in self._omitted if not self._has_algebraic(one)]
        first, second = ([self._read(x) for x in part] for part in (own, others))
        return first, second

    @property
    def leading(self) -> set[str]:
        """Other leading coefficients, which were divided out also."""
        names = (one for one in self._leading if not self._has_algebraic(one))
        return {str(one) for one in names if one not in self._omitted}

    def _read(self, factor: sp.Expr) -> Element:
        """A factor as an element, with the sign of residuals."""
        return self._signed(self.jets.field.read(factor.as_content_primitive()[1]))

    def _has_algebraic(self, factor: sp.Expr) -> bool:
        return any(place.function in self._algebraic for place in self._places(factor))

    def run(self, residuals: Iterable[Residual], factors: Iterable[Residual] = ()) -> Eliminated:
        """Rules and constraints of residuals, and of factors by which products vanish."""
        factors = tuple(factors)
        self._zero = frozenset(one.element.sympy for one in factors)
        pool, done = self._simplified([*residuals, *factors]), set[Element]()
        first = tuple(one.element for one in pool)
        while True:
            pool = self._solved(pool, careful=True)
            if self._missing:
                pool = self._solved(self._solved(pool, careful=False), careful=True)
            rest = self._with_common_roots(pool)
            if rest is not pool:
                pool = rest
                continue
            new = self._prolonged(pool, done)
            if not new:
                self._constraints = tuple(self._independent(pool))
                return Eliminated(dict(self.rules), self._constraints, self.nonzero, first)
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
        chosen = self._chosen(factors)
        self._omitted |= dict.fromkeys(one for one in factors if one not in chosen)
        return self._read(sp.Mul(*chosen))

    def _chosen(self, factors: Sequence[sp.Expr]) -> Sequence[sp.Expr]:
        """The factors of a product that vanish, the others being divided out."""
        if self._zero:
            zero = [one for one in factors if self._read(one).sympy in self._zero]
            if zero:
                return zero[:1]
        vanishing = [one for one in factors if one in self._vanishing]
        rates = [one for one in factors if any(x.order for x in self._places(one))]
        # A universe at rest, a' = 0, is not the general solution of a' (...) = 0.
        moving = [one for one in rates if one not in self.jets.symbols]
        return vanishing[:1] or moving or rates or factors

    def _places(self, factor: sp.Expr) -> list[Place]:
        """The derivatives in a factor."""
        return self.jets.places(self.jets.field.read(factor))

    def _factors(self, element: Element) -> list[sp.Expr]:
        """The factors of a numerator that contain unknown functions and may vanish."""
        above, _ = sp.fraction(element.sympy)
        factors = []
        for factor in sp.Mul.make_args(above):
            base = factor.base if factor.is_Pow and factor.exp.is_Integer else factor
            symbols = base.free_symbols & self.jets.symbols
            if symbols and base not in self.nonzero and not self._is_regular_factor(base):
                factors.append(base)
        return factors

    def _is_regular_factor(self, base: sp.Expr) -> bool:
        """Whether a factor vanishes nowhere, because the equations divide by its parts."""
        return all(
            isinstance(one, sp.exp) or one in self._regular
            for one in _pieces(base)
            if one.free_symbols & self.jets.symbols and one not in self.nonzero
        )

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
            self._leading |= dict.fromkeys(self._factors(slope))
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
            rest = self._modulo(rate, [other.element for other in pool])
            if not rest.is_zero:
                new.append(Residual(rest, frozenset(self._missing)))
        return new

    def _with_common_roots(self, pool: list[Residual]) -> list[Residual]:
        """Residuals without the second of two in the same single unknown: Euclid's algorithm."""
        single: dict[sp.Symbol, Residual] = {}
        for one in pool:
            places = self.jets.places(one.element)
            if len(places) != 1:
                continue
            first = single.setdefault(places[0].symbol, one)
            if first is one:
                continue
            short, long = sorted((first, one), key=lambda x: self._degree(x.element))
            remainder = self._remainder(long.element, short.element)
            if remainder is not long.element:
                rest = [x for x in pool if x is not long]
                return self._simplified([*rest, replace(long, element=remainder)])
        return pool

    def _degree(self, element: Element) -> int:
        """The degree in the single unknown of an element; 0 if it is not a polynomial in it."""
        (place,) = self.jets.places(element)
        return len(self.jets.coefficients(element, place.symbol) or [])

    def contains(self, other: Eliminated) -> bool:
        """Whether all solutions of this elimination are regular solutions of another one."""
        pool = [
            self.jets.element(function, rule.order) - rule.value
            for function, rule in other.rules.items()
        ]
        own = self._constraints
        try:
            return all(self._vanishes(one, own) for one in (*pool, *other.constraints))
        except GravityError:
            # A leading coefficient of the other one vanishes here.
            return False

    def _vanishes(self, element: Element, constraints: Sequence[Element]) -> bool:
        """Whether an element is zero by the rules and these constraints, with all its factors."""
        element = self.jets.whole(self.reduced(element))
        for constraint in (*constraints, *constraints):
            if element.is_zero:
                return True
            numerator = self.jets.field.read(sp.fraction(element.sympy)[0])
            element = self.jets.whole(self._remainder(numerator, constraint))
        return element.is_zero is True

    def _modulo(self, element: Element, constraints: Sequence[Element]) -> Element:
        """The rest of an element where constraints hold: zero if it follows from them."""
        # Twice, because a constraint may bring back powers that an earlier one removes.
        for constraint in (*constraints, *constraints):
            if element.is_zero:
                break
            element = self._numerator(self._remainder(element, constraint))
        return element

    def _independent(self, pool: Sequence[Residual]) -> list[Element]:
        """Constraints that do not follow from shorter ones."""
        constraints: list[Element] = []
        for one in pool:
            if not self._modulo(one.element, constraints).is_zero:
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


def _pieces(expression: sp.Expr) -> list[sp.Expr]:
    """The factors below powers and roots, each up to its sign."""
    if expression.is_Mul:
        return [one for factor in expression.args for one in _pieces(factor)]
    if expression.is_Pow and expression.exp.is_Rational:
        return _pieces(expression.base)
    expression = expression.as_content_primitive()[1]
    return [-expression if expression.could_extract_minus_sign() else expression]
