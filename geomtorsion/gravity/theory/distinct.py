"""Distinct: the field equations that differ, as numerators without common factors."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.exact import Element
from geomtorsion.geometry import Tensor


def distinct(
    tensors: Mapping[str, Tensor],
    written: Callable[[Element], sp.Expr],
    nonzero: Collection[sp.Basic],
) -> dict[str, sp.Expr]:
    """Expressions that vanish where tensors do, each once, by labels such as E_1^1.

    Legs count from 1. Numbers, denominators and factors that vanish nowhere are omitted, and so are
    factors without an unknown function beside one with it.

    written: an element as it is printed. nonzero: functions that vanish nowhere.
    """
    result: dict[str, sp.Expr] = {}
    for name, tensor in tensors.items():
        for index in tensor.components.independent:
            numerator = _numerator(written(tensor.element(*index)), nonzero)
            if numerator != 0 and numerator not in result.values():
                result[name + marks(index, tensor.slots)] = numerator
    return result


def _numerator(expression: sp.Expr, nonzero: Collection[sp.Basic]) -> sp.Expr:
    """The factors of a numerator that may vanish, up to the sign."""
    above = sp.fraction(sp.factor_terms(sp.together(expression)))[0]
    factors = []
    for factor in sp.Mul.make_args(above):
        base = factor.base if factor.is_Pow and factor.exp.is_positive else factor
        if base not in nonzero and base.has(AppliedUndef):
            factors.append(base)
    numerator = (sp.Mul(*factors) if factors else above).as_content_primitive()[1]
    return -numerator if numerator.could_extract_minus_sign() else numerator


def marks(index: Sequence[int], slots: str) -> str:
    """Marks of an index, _1^1 or ^12_3."""
    marks, last = "", ""
    for place, slot in zip(index, slots.upper(), strict=True):
        sign = "^" if slot == "U" else "_"
        marks += f"{sign if sign != last else ''}{place + 1}"
        last = sign
    return marks
