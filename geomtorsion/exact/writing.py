"""Writing: elements as short sympy expressions."""

from __future__ import annotations

from functools import cmp_to_key
from typing import TYPE_CHECKING

import sympy

from geomtorsion.exact.form import LONGEST_FACTORED, Sum, form
from geomtorsion.exact.generators import Generator

if TYPE_CHECKING:
    from flint import fmpq

    from geomtorsion.exact.element import Element

    # Powers that have been made.
    Powers = dict[tuple[Generator | Sum, int], sympy.Expr]

# Generators that sympy never merges with others in a product, as it does exp(x)*exp(y).
_PLAIN = frozenset(("symbol", "cos", "sin", "cosh", "sinh", "log", "jet"))
_ORDER = cmp_to_key(sympy.Basic.compare)


def to_sympy(element: Element) -> sympy.Expr:
    """The element in its short form: factored, radicals and sin**2 restored."""
    written = form(element)
    known = element.field.tables.setdefault("sympy", {})
    factors = [_power(known, base, exponent) for base, exponent in written.powers]
    sums = sum(isinstance(base, Sum) for base, _ in written.powers)
    plain = all(isinstance(base, Sum) or base.kind in _PLAIN for base, _ in written.powers)
    # sympy distributes a number over a lone sum; then its own product is taken.
    return _product(written.coefficient, factors, plain and (len(factors) > 1 or not sums))


def _number(value: fmpq) -> sympy.Expr:
    return sympy.Rational(int(value.p), int(value.q)) if value.q != 1 else sympy.Integer(int(value))


def _product(value: fmpq, factors: list[sympy.Expr], plain: bool) -> sympy.Expr:
    """value * factors; plain ones are put together without sympy's search for like bases."""
    if not factors:
        return _number(value)
    if value == 1 and len(factors) == 1:
        return factors[0]
    if not plain:
        return sympy.Mul(_number(value), *factors)
    # sympy wants its own order, also where it is not asked to look at the factors.
    ordered = sorted(factors, key=_ORDER)
    if value != 1:
        ordered.insert(0, _number(value))
    return sympy.Mul._from_args(ordered, is_commutative=True)


def _power(known: Powers, base: Generator | Sum, exponent: int) -> sympy.Expr:
    """base**exponent, made once."""
    key = (base, exponent)
    found = known.get(key)
    if found is None:
        plain = base.shown if isinstance(base, Generator) else _sum(known, base)
        found = known[key] = plain if exponent == 1 else plain**exponent
    return found


def _sum(known: Powers, base: Sum) -> sympy.Expr:
    """A sum of monomials."""
    terms = []
    all_plain = True
    for value, monomial in base.terms:
        factors = [_power(known, generator, exponent) for generator, exponent in monomial]
        plain = all(generator.kind in _PLAIN for generator, _ in monomial)
        all_plain = all_plain and plain
        terms.append(_product(value, factors, plain))
    if not all_plain:
        return sympy.Add(*terms)
    # Longer sums stay in their own order: sorting them takes sympy minutes.
    if len(terms) <= LONGEST_FACTORED:
        terms.sort(key=lambda term: (not term.is_Number, _ORDER(term)))
    return sympy.Add._from_args(terms, is_commutative=True)
