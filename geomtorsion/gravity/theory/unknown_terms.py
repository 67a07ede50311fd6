"""Unknown terms: the coframe equation as a sum of unknown functions times tensors."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import combinations_with_replacement

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.exact import Element
from geomtorsion.geometry import Tensor
from geomtorsion.gravity.theory.catalogue import TURNING
from geomtorsion.gravity.theory.content import Content
from geomtorsion.gravity.theory.lagrangian import Reading
from geomtorsion.gravity.theory.products import HESSIAN
from geomtorsion.gravity.theory.variation import Variation
from geomtorsion.support.caching import cached_property


@dataclass(frozen=True, eq=False)
class Chain:
    """Derivatives of a Lagrangian by coordinates, with derivatives of invariants as symbols.

    reading: the Lagrangian with the values of its names.
    coordinates: those by which invariants are differentiated.
    """

    reading: Reading
    coordinates: tuple[sp.Symbol, ...]
    _symbols: dict[tuple[sp.Symbol, tuple[int, ...]], sp.Symbol] = field(default_factory=dict)

    def slope(self, expression: sp.Expr, k: int) -> sp.Expr:
        """The total derivative by coordinate k."""
        total = expression.diff(self.coordinates[k])
        for symbol in self.reading.symbols:
            total += expression.diff(symbol) * self._derivative(symbol, (k,))
        for (symbol, places), own in list(self._symbols.items()):
            if expression.has(own):
                places = tuple(sorted((*places, k)))
                total += expression.diff(own) * self._derivative(symbol, places)
        return total

    def _derivative(self, symbol: sp.Symbol, places: tuple[int, ...]) -> sp.Expr:
        """A derivative of an invariant as a symbol, or zero."""
        value = self.reading.values[symbol]
        for k in places:
            value = value.diff(self.coordinates[k])
        if value.is_zero:
            return sp.S.Zero
        # Its name decides its place in sums, so that equal calls give equal orders.
        own = sp.Dummy(f"{symbol.name} by {places}")
        return self._symbols.setdefault((symbol, places), own)

    def named(self, expression: sp.Expr) -> sp.Expr:
        """An expression with derivatives such as Derivative(T(t), t)."""
        names = {}
        for (symbol, places), own in self._symbols.items():
            value = self.reading.values[symbol]
            depends = [q for q in self.coordinates if not value.free_of(q)]
            applied = sp.Function(symbol.name)(*depends)
            names[own] = sp.Derivative(applied, *(self.coordinates[k] for k in places))
        return expression.xreplace(names)

    def split(self, expression: sp.Expr) -> Iterator[tuple[sp.Expr, sp.Expr]]:
        """Pairs of a coefficient and a product of unknown functions, whose sum is an expression."""
        own = {*self.reading.symbols, *self._symbols.values()}
        derivatives = set(self._symbols.values())
        for term in sp.Add.make_args(sp.expand(expression)):
            coefficient, unknown = sp.S.One, sp.S.One
            for factor in sp.Mul.make_args(term):
                calls = factor.atoms(AppliedUndef, sp.Subs)
                called = any(not x.free_symbols.isdisjoint(own) for x in calls)
                if called or not factor.free_symbols.isdisjoint(derivatives):
                    unknown *= factor
                else:
                    coefficient *= factor
            yield coefficient, unknown


def _order(content: Content, name: str) -> int:
    """The highest derivative of dL/dI in E."""
    metric = {str(k) for k, one in enumerate(content.geometry) if one.is_riemannian}
    factors = [x for one in content.catalogue.products(name) for x in one.factors]
    if any(x.suffix in metric and x.name in ("R", TURNING) for x in factors):
        return 2
    return int(any(x.name == "T" or x.name.startswith(HESSIAN) for x in factors))


@dataclass(frozen=True, eq=False)
class _Weighted:
    """Tensors of an invariant in E that multiply its weight and the derivatives of the weight.

    The equations are linear in the weight: its derivatives are read off from products of
    coordinates as weights.
    """

    content: Content
    name: str
    one: Element
    coordinates: Sequence[Element]

    def _of(self, weight: Element) -> Tensor:
        return Variation(self.content, {self.name: weight}).coframe

    def _times(self, tensor: Tensor, value: Element) -> Tensor:
        return tensor * self.content.catalogue.frame.scalar(lambda: value)

    @cached_property
    def base(self) -> Tensor:
        """The tensor that multiplies the weight."""
        return self._of(self.one)

    @cached_property
    def first(self) -> list[Tensor]:
        """The tensors that multiply the first derivatives of the weight."""
        return [self._of(x) - self._times(self.base, x) for x in self.coordinates]

    def second(self, k: int, m: int) -> Tensor:
        """The tensor that multiplies a second derivative of the weight, k <= m."""
        x, y = self.coordinates[k], self.coordinates[m]
        whole = self._of(x * y) - self._times(self.base, x * y)
        whole = whole - self._times(self.first[m], x) - self._times(self.first[k], y)
        return whole / 2 if k == m else whole


def terms_of(reading: Reading, content: Content) -> dict[sp.Expr, Tensor]:
    """Products of unknown functions and of derivatives of invariants -> their tensors in E."""
    frame = content.catalogue.frame
    coordinates = frame.coordinates
    chain = Chain(reading, coordinates)
    sums: dict[sp.Expr, Tensor] = {}

    def add(expression: sp.Expr, tensor: Tensor) -> None:
        for coefficient, unknown in chain.split(expression):
            value = frame.scalar(lambda c=coefficient: reading.element(c))
            share = tensor * value
            sums[unknown] = sums[unknown] + share if unknown in sums else share

    one, *elements = frame.read([("weight", x) for x in (sp.S.One, *coordinates)])
    add(reading.expression, Tensor(frame, "DU", {(k, k): 1 for k in range(frame.dimension)}))
    for symbol, name in reading.symbols.items():
        weight = reading.expression.diff(symbol)
        if weight == 0:
            continue
        own = _Weighted(content, name, one, elements)
        add(weight, own.base)
        order = _order(content, name)
        slopes = [chain.slope(weight, k) for k in range(len(coordinates))]
        for k, slope in enumerate(slopes if order > 0 else ()):
            if slope != 0:
                add(slope, own.first[k])
        for k, m in combinations_with_replacement(range(len(slopes)), 2) if order > 1 else ():
            second = sp.S.Zero if slopes[k] == 0 else chain.slope(slopes[k], m)
            if second != 0:
                add(second, own.second(k, m))
    return {chain.named(x): tensor for x, tensor in sums.items() if tensor.is_zero is not True}
