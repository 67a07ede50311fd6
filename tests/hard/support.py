"""Support: numbers of a tensor, and the oracle of its frame."""

from __future__ import annotations

import mpmath
import numpy as np
import sympy as sp
from hypothesis import HealthCheck, settings

import geomtorsion as gt
from tests.differences import DIGITS, numeric
from tests.differences import values as values_of
from tests.oracle import Oracle
from tests.strategies import PARAMETERS

quick = settings(
    max_examples=12,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)


def numbers(tensor: gt.Tensor, values: dict, written: bool = False) -> np.ndarray:
    """A tensor at a point: from its elements, or from the written components."""
    n, rank = tensor.frame.dimension, len(tensor.slots)
    result = np.full((n,) * rank, mpmath.mpf(0), dtype=object)
    if written:
        found = tensor.nonzero()
        with mpmath.workdps(40):
            place = {symbol: mpmath.mpf(int(v.p)) / int(v.q) for symbol, v in values.items()}
            at = values_of([settled(e) for e in found.values()], place)
        for index, value in zip(found, at, strict=True):
            result[index] = mpmath.mpmathify(value)
    else:
        for index, element in tensor.components.nonzero.items():
            result[index] = mpmath.mpmathify(element.evaluate(values, precision=120))
    return result if rank else result[()]


def settled(expression: sp.Expr) -> sp.Expr:
    """Replace unknown functions by definite smooth ones."""
    expression = sp.sympify(expression)
    names = {f.func for f in expression.atoms(sp.core.function.AppliedUndef)}
    for number, name in enumerate(sorted(names, key=str)):
        expression = expression.replace(
            name, lambda *a, c=number + 3: c + sp.sin(sum(a)) + sum(a) ** 2 / 5
        )
    return expression.doit() if names else expression


def rows(frame: gt.Frame) -> list[list[sp.Expr]]:
    """The coframe as nested lists."""
    size = range(frame.dimension)
    return [[settled(frame.coframe[i, mu]) for mu in size] for i in size]


def point(frame: gt.Frame, values: dict) -> tuple:
    """The coordinates of a point with as many digits as the oracle uses."""
    with mpmath.workdps(DIGITS):
        return tuple(mpmath.mpf(int(values[q].p)) / int(values[q].q) for q in frame.coordinates)


def oracle_of(frame: gt.Frame, values: dict, gamma: list | None = None) -> Oracle:
    """The oracle, only from the numeric coframe (and numeric connection coefficients)."""
    return Oracle(
        numeric(rows(frame), frame.coordinates, values),
        point(frame, values),
        eta=frame.eta.to_sympy().tolist(),
        coefficients=None if gamma is None else numeric(gamma, frame.coordinates, values),
    )


def values_at(coordinates, seed):
    """A point that depends on a seed, with a value for the parameters."""
    place = {q: sp.Rational(seed + 2 * n, 23) for n, q in enumerate(coordinates)}
    k, b = PARAMETERS
    return place | {k: sp.Rational(6, 5), b: sp.Rational(7, 5)}
