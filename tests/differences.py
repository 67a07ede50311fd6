"""Differences: central differences and arrays of mpmath numbers, for the oracle."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cached_property, wraps
from itertools import permutations
from math import factorial
from typing import Any

import mpmath
import numpy as np
import sympy as sp

DIGITS = 90
INNER_STEP = mpmath.mpf(10) ** -25
OUTER_STEP = mpmath.mpf(10) ** -15

Point = Sequence[Any]
Field = Callable[[Point], np.ndarray]


def array(rows: Any) -> np.ndarray:
    """Any nested sequence of numbers as an object array of mpmath numbers."""
    return np.vectorize(mpmath.mpmathify, otypes=[object])(np.array(rows, dtype=object))


def difference(field: Field, step: mpmath.mpf) -> Field:
    """Gradient by central differences; the new index comes first."""

    def gradient(point: Point) -> np.ndarray:
        slopes = []
        for axis in range(len(point)):
            ahead, behind = list(point), list(point)
            ahead[axis] += step
            behind[axis] -= step
            slopes.append((field(ahead) - field(behind)) / (2 * step))
        return np.array(slopes, dtype=object)

    return gradient


def inverse(matrix: np.ndarray) -> np.ndarray:
    """Inverse of a square matrix at the working precision."""
    return np.array((mpmath.matrix(matrix.tolist()) ** -1).tolist(), dtype=object).reshape(
        matrix.shape
    )


def quantity(compute: Callable[[Any], Any]) -> cached_property:
    """Property computed once, with DIGITS digits."""

    @wraps(compute)
    def at_full_precision(self: Any) -> Any:
        with mpmath.workdps(DIGITS):
            return compute(self)

    return cached_property(at_full_precision)


def antisymmetrised(tensor: np.ndarray) -> np.ndarray:
    """Totally antisymmetric part of a rank-3 array, weight one."""
    total = 0 * tensor
    for order in permutations(range(3)):
        sign = (order[1] - order[0]) * (order[2] - order[0]) * (order[2] - order[1]) // 2
        total = total + sign * tensor.transpose(order)
    return total / factorial(3)


def numeric(entries: Any, coordinates: Sequence[Any], values: dict) -> Callable[[Point], Any]:
    """Nested lists of sympy expressions as an mpmath function of a point, with parameters set."""
    numbers = {s: sp.Rational(v) for s, v in values.items() if s not in coordinates}

    def settled(part: Any) -> Any:
        if isinstance(part, list):
            return [settled(entry) for entry in part]
        return sp.sympify(part).xreplace(numbers)

    return sp.lambdify([list(coordinates)], settled(entries), modules="mpmath")


def values(expressions: Iterable[sp.Expr], point: dict) -> list[Any]:
    """Values of expressions at one point, at the working precision; shared parts computed once."""
    done = {symbol: mpmath.mpmathify(number) for symbol, number in point.items()}

    def value(part: sp.Basic) -> Any:
        if part not in done:
            done[part] = _combined(part, [value(arg) for arg in part.args])
        return done[part]

    return [value(sp.sympify(expression)) for expression in expressions]


def _combined(part: Any, parts: list[Any]) -> Any:
    """The value of an expression from the values of its arguments."""
    if part.is_Rational:
        return mpmath.mpf(int(part.p)) / int(part.q)
    if part.is_Add:
        return mpmath.fsum(parts)
    if part.is_Mul:
        return mpmath.fprod(parts)
    if part.is_Pow:
        twice = 2 * part.exp
        if part.exp.is_Integer or not twice.is_Integer:
            return parts[0] ** (int(part.exp) if part.exp.is_Integer else parts[1])
        return mpmath.sqrt(parts[0]) ** int(twice)
    if part.is_Function:
        return getattr(mpmath, type(part).__name__)(*parts)
    if part is sp.I:
        return mpmath.mpc(0, 1)
    return mpmath.mpmathify(part.evalf(mpmath.mp.dps + 5))


def largest(numbers: Any) -> float:
    """Largest modulus in an array."""
    flat = np.array(numbers, dtype=object).ravel()
    return max((float(abs(x)) for x in flat), default=0.0)


def agrees(exact: Any, witness: Any, tolerance: float = 1e-11) -> bool:
    """Whether floats of the package equal the oracle's, relative to the oracle's largest value."""
    exact, witness = np.array(exact, dtype=object), np.array(witness, dtype=object)
    if exact.shape != witness.shape:
        return False
    return largest(exact - witness) <= tolerance * max(1.0, largest(witness))
