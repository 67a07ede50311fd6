"""Expansion: expressions to second order around a point, with exact coefficients."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.errors import LagrangianError
from geomtorsion.support import checks
from geomtorsion.support.allowance import check_limits

if TYPE_CHECKING:
    from geomtorsion.exact import Element, Field


@dataclass(frozen=True, eq=False)
class Jet:
    """Value, first and second derivatives with respect to numbered variables; zeros are omitted.

    first: i -> df/dx_i; second: (i, j) with i <= j -> d2f/dx_i dx_j.
    """

    field: Field
    value: Element
    first: Mapping[int, Element]
    second: Mapping[tuple[int, int], Element]

    def slope(self, i: int, j: int) -> Element:
        """d2f/dx_i dx_j."""
        return self.second.get((min(i, j), max(i, j)), self.field.zero)


@dataclass(frozen=True, eq=False)
class Expansion:
    """Jets of expressions at one point, each part expanded once.

    field: of the coefficients.
    variables: symbols with respect to which is differentiated.
    values: symbol -> expression over the symbols of the field; all others are kept.

    Examples
    --------
    >>> from geomtorsion.exact import Field
    >>> x, y, k = sp.symbols("x y k")
    >>> jet = Expansion(Field([k]), [x, y], {x: sp.S.Zero, y: k}).of(sp.cos(x) * y**2)
    >>> jet.value, jet.first, jet.second
    (Element(k**2), {1: Element(2*k)}, {(0, 0): Element(-k**2), (1, 1): Element(2)})
    """

    field: Field
    variables: Sequence[sp.Symbol]
    values: Mapping[sp.Symbol, sp.Expr]
    _known: dict[sp.Expr, Jet] = dataclasses.field(default_factory=dict, repr=False)

    def of(self, term: sp.Expr) -> Jet:
        """The jet of an expression.

        Raises
        ------
        LagrangianError
            A part has no derivative, or no finite value at the point.
        """
        waiting = [term]
        while waiting:
            part = waiting[-1]
            if part in self._known:
                waiting.pop()
                continue
            if not isinstance(part, sp.Expr):
                raise self._not_smooth(part)
            parts = part.args if set(self.variables) & part.free_symbols else ()
            missing = [x for x in parts if x not in self._known]
            if missing:
                waiting += missing
                continue
            check_limits()
            self._known[waiting.pop()] = self._made(part)
        return self._known[term]

    def _constant(self, value: sp.Expr) -> Jet:
        return Jet(self.field, self.field.read(value), {}, {})

    def _made(self, part: sp.Expr) -> Jet:
        """The jet of a part whose own parts are known."""
        if part in self.variables:
            place = self.variables.index(part)
            value = self.field.read(self.values.get(part, part))
            return Jet(self.field, value, {place: self.field.one}, {})
        if not set(self.variables) & part.free_symbols:
            return self._constant(part.xreplace(dict(self.values)))
        jets = [self._known[x] for x in part.args]
        if isinstance(part, sp.Add):
            return self._sum(jets)
        if isinstance(part, sp.Mul):
            product = jets[0]
            for jet in jets[1:]:
                product = self._product(product, jet)
            return product
        if isinstance(part, sp.Pow) and part.exp == 2:
            return self._product(jets[0], jets[0])
        if isinstance(part, sp.Pow | sp.Function):
            return self._function(part, jets)
        raise self._not_smooth(part)

    def _sum(self, jets: Sequence[Jet]) -> Jet:
        first: dict[int, list] = {}
        second: dict[tuple[int, int], list] = {}
        for jet in jets:
            for i, value in jet.first.items():
                first.setdefault(i, []).append((1, value))
            for place, value in jet.second.items():
                second.setdefault(place, []).append((1, value))
        total = self.field.sum([(1, jet.value) for jet in jets])
        return Jet(self.field, total, self._summed(first), self._summed(second))

    def _summed(self, terms: Mapping) -> dict:
        """Sums that do not vanish."""
        sums = {place: self.field.sum(parts) for place, parts in sorted(terms.items())}
        return {place: value for place, value in sums.items() if not value.is_zero}

    def _product(self, one: Jet, two: Jet) -> Jet:
        first: dict[int, list] = {}
        second: dict[tuple[int, int], list] = {}
        for a, b in ((one, two), (two, one)):
            if not a.value.is_zero:
                for i, value in b.first.items():
                    first.setdefault(i, []).append((1, a.value, value))
                for place, value in b.second.items():
                    second.setdefault(place, []).append((1, a.value, value))
        for i, left in one.first.items():
            for j, right in two.first.items():
                place = (min(i, j), max(i, j))
                second.setdefault(place, []).append((2 if i == j else 1, left, right))
        return Jet(self.field, one.value * two.value, self._summed(first), self._summed(second))

    def _function(self, part: sp.Expr, jets: Sequence[Jet]) -> Jet:
        """The chain rule for a function of any number of arguments."""
        moving = [k for k, jet in enumerate(jets) if jet.first or jet.second]
        names = {k: sp.Dummy(f"a{k}") for k in moving}
        # Constants keep their values in it: x**4 has a second derivative at 0, x**n may have none.
        function = part.func(*(names.get(k, jet.value.sympy) for k, jet in enumerate(jets)))
        table = {name: jets[k].value.sympy for k, name in names.items()}
        slopes = {k: self._at(function.diff(names[k]), table, part) for k in moving}
        first: dict[int, list] = {}
        second: dict[tuple[int, int], list] = {}
        for k in moving:
            for i, value in jets[k].first.items():
                first.setdefault(i, []).append((1, slopes[k], value))
            for place, value in jets[k].second.items():
                second.setdefault(place, []).append((1, slopes[k], value))
        for k, m in combinations_with_replacement(moving, 2):
            bend = self._at(function.diff(names[k]).diff(names[m]), table, part)
            if bend.is_zero:
                continue
            for i, left in jets[k].first.items():
                for j, right in jets[m].first.items():
                    if k == m and i > j:
                        continue
                    place = (min(i, j), max(i, j))
                    count = 2 if k != m and i == j else 1
                    second.setdefault(place, []).append((count, bend, left, right))
        value = self._at(function, table, part)
        return Jet(self.field, value, self._summed(first), self._summed(second))

    def _at(self, term: sp.Expr, table: Mapping[sp.Symbol, sp.Expr], part: sp.Expr) -> Element:
        """A derivative at the point."""
        # Derivatives of an unknown function have no value.
        if term.has(sp.Derivative, sp.Subs):
            raise self._not_smooth(part)
        derivative = term.xreplace(dict(table)).doit()
        if derivative.has(sp.nan, sp.zoo, sp.oo, -sp.oo):
            raise self._not_smooth(part)
        return self.field.read(derivative)

    def _not_smooth(self, part: sp.Basic) -> LagrangianError:
        return LagrangianError(
            f"expected an expression that is smooth at this state, got {checks.cut(str(part))}. "
            "Linearise at another state, or write it without its singularity."
        )
