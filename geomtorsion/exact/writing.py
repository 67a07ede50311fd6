"""Writing: elements as short sympy expressions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import sympy

from geomtorsion.exact.form import Sum, form
from geomtorsion.exact.generators import Generator

if TYPE_CHECKING:
    from flint import fmpq

    from geomtorsion.exact.element import Element


def to_sympy(element: Element) -> sympy.Expr:
    """The element in its short form: factored, radicals and sin**2 restored."""
    written = form(element)
    known = element.field.tables.setdefault("sympy", {})
    factors = [_power(known, base, exponent) for base, exponent in written.powers]
    value = written.coefficient
    if value != 1 or not factors:
        factors.insert(0, _number(value))
    return sympy.Mul(*factors) if len(factors) > 1 else factors[0]


def _number(value: fmpq) -> sympy.Expr:
    return sympy.Rational(int(value.p), int(value.q)) if value.q != 1 else sympy.Integer(int(value))


def _power(known: dict[Any, sympy.Expr], base: Generator | Sum, exponent: int) -> sympy.Expr:
    """base**exponent, made once."""
    key = (base, exponent)
    found = known.get(key)
    if found is None:
        plain = base.shown if isinstance(base, Generator) else _sum(known, base)
        found = known[key] = plain if exponent == 1 else plain**exponent
    return found


def _sum(known: dict[Any, sympy.Expr], base: Sum) -> sympy.Expr:
    """A sum of monomials."""
    terms = []
    for value, monomial in base.terms:
        factors = [_power(known, generator, exponent) for generator, exponent in monomial]
        if value != 1 or not factors:
            factors.insert(0, _number(value))
        terms.append(sympy.Mul(*factors) if len(factors) > 1 else factors[0])
    return sympy.Add(*terms)
