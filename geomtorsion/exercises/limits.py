"""Limits: how large an answer may be, so that none keeps the examiner busy."""

from __future__ import annotations

from math import comb
from typing import Any

import sympy

from geomtorsion.errors import LimitError
from geomtorsion.exact.tokens import Limits

# What a person writes is far below these; what a machine writes to annoy is above them.
ANSWER = Limits(characters=4000, depth=30, exponent=24, digits=80)
LARGEST_ANSWER = 20_000
LARGEST_WEIGHT = 5_000_000
# Of one of several equations, which are combined to solve them.
LARGEST_EQUATION = 5000
MOST_RADICALS = 4
_CIRCULAR = (sympy.sin, sympy.cos, sympy.tan, sympy.cot, sympy.sec, sympy.csc)


def check_weight(expr: Any, where: str, largest: int = LARGEST_WEIGHT) -> None:
    """Refuse an expression that would be very long if it were multiplied out.

    Raises
    ------
    LimitError
        more than `largest` terms, or more than MOST_RADICALS roots, are to be expected.

    Examples
    --------
    >>> x, y, z = sympy.symbols("x y z")
    >>> check_weight((x + y + z) ** 6, "answer")
    >>> check_weight((x + y + z + 1) ** 24 / (x - y + 2 * z - 1) ** 24, "answer")
    Traceback (most recent call last):
    geomtorsion.errors.LimitError: answer: multiplied out, this would have more than...
    """
    radicals = {
        power.base for power in expr.atoms(sympy.Pow) if power.exp.is_Rational and power.exp.q > 1
    }
    if len({base for base in radicals if not base.is_number}) > MOST_RADICALS:
        raise LimitError(
            f"{where}: it contains more than {MOST_RADICALS} different roots. Write it shorter."
        )
    above, below = _weight(expr, {})
    if above * below > largest:
        raise LimitError(
            f"{where}: multiplied out, this would have more than {largest:,} terms. "
            "Write it shorter."
        )


def _weight(expr: Any, known: dict[Any, tuple[int, int]]) -> tuple[int, int]:
    """Bounds on the terms of numerator and denominator, multiplied out."""
    if expr not in known:
        above, below = _counted(expr, known)
        known[expr] = min(above, 10**12), min(below, 10**12)
    return known[expr]


def _counted(expr: Any, known: dict[Any, tuple[int, int]]) -> tuple[int, int]:
    if expr.is_Add:
        parts = [_weight(argument, known) for argument in expr.args]
        below = 1
        for bottom in {sympy.denom(argument) for argument in expr.args}:
            below = min(below * _weight(bottom, known)[0], 10**12)
        return sum(top for top, _ in parts) * below, below
    if expr.is_Mul:
        above = below = 1
        for argument in expr.args:
            top, bottom = _weight(argument, known)
            above, below = min(above * top, 10**12), min(below * bottom, 10**12)
        return above, below
    if expr.is_Pow and expr.exp.is_Rational:
        top, bottom = _weight(expr.base, known)
        n = min(abs(int(expr.exp)) or 1, 100)
        grown = _power(top, n), _power(bottom, n)
        return grown if expr.exp > 0 else (grown[1], grown[0])
    if isinstance(expr, _CIRCULAR):
        return _multiples(expr.args[0]), 2 if isinstance(expr, _CIRCULAR[2:]) else 1
    inner = [_weight(argument, known) for argument in expr.args]
    return max((max(pair) for pair in inner), default=1), 1


def _power(terms: int, n: int) -> int:
    """Terms of the n-th power of a sum."""
    return comb(min(terms, 10**4) + n - 1, n) if terms > 1 else 1


def _multiples(angle: Any) -> int:
    """Terms of the cosine of a sum of multiples of angles."""
    found = 1
    for term in sympy.Add.make_args(angle):
        factor = abs(term.as_coeff_Mul()[0])
        size = int(max(factor.p, factor.q)) if factor.is_Rational else 1
        found = min(2 * found * (size // 2 + 1), 10**12)
    return found // 2 if found > 1 else 1
