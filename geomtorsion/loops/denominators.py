"""Denominators: the irreducible factors at whose zeros a coframe is singular."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.exact.form import Sum, form

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.exact.generators import Generator
    from geomtorsion.geometry import Frame


def factors(frame: Frame) -> tuple[sp.Expr, ...]:
    """Denominators of the coframe and factors of its determinant, those that contain coordinates.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> factors(load("screw_dislocation").frame)
    (x**2 + y**2,)
    """
    found: dict[sp.Expr, None] = {}
    for element in frame.coframe.components.independent.values():
        found.update(dict.fromkeys(_bases(element, below=True)))
    determinant = frame.determinant.element()
    found.update(dict.fromkeys(_bases(determinant, below=True)))
    found.update(dict.fromkeys(_bases(determinant, below=False)))
    coordinates = set(frame.coordinates)
    return tuple(factor for factor in found if factor.free_symbols & coordinates)


def _bases(element: Element, below: bool) -> list[sp.Expr]:
    """The factors of a denominator, or of a numerator."""
    return [_expression(base) for base, exponent in form(element).powers if (exponent < 0) is below]


def _expression(base: Generator | Sum) -> sp.Expr:
    """A factor as sympy; of a root what stands under it, which has the same zeros."""
    if not isinstance(base, Sum):
        if base.kind == "root" and base.tail is not None:
            return base.tail.sympy
        return base.shown
    terms = []
    for value, monomial in base.terms:
        powers = [generator.shown**exponent for generator, exponent in monomial]
        terms.append(sp.Mul(sp.Rational(int(value.p), int(value.q)), *powers))
    return sp.Add(*terms)
