"""Hilbert: gauge symmetries and phase space from the growth of the number of free coefficients."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product

import numpy as np


def fitted(
    numbers: Sequence[int],
    shorter: Sequence[int],
    geometry: str,
    gauge: tuple[tuple[int, int], ...],
    n: int,
    fields: tuple[int, int],
) -> tuple[tuple[tuple[int, int], ...], int | None]:
    """The gauge symmetry that fits H, and the order from which the fit holds.

    fields: numbers of vector fields and of two-forms.

    The fit holds for all numbers that are the same with one order less, from some order on. These
    are at least n + 1 numbers, one more than the phase space determines, and at least four, because
    three numbers fit too easily. A known symmetry has as many functions of n variables. No later
    number is below the fit, because numbers only fall where the order grows.
    """
    known = _symmetries(geometry, gauge, n, *fields)
    same = confirmed(numbers, shorter)
    for place in range(same - max(n, 3)):
        heads = [int(np.diff(numbers, k)[place]) for k in range(n + 1)]
        values = [polynomial(heads, q) for q in range(len(numbers) - place)]
        pairs = list(zip(numbers[place:], values, strict=True))
        is_same = all(number == value for number, value in pairs[: same - place])
        if heads[-1] in known and is_same and all(number >= value for number, value in pairs):
            return known[heads[-1]], place
    return gauge, None


def confirmed(numbers: Sequence[int], shorter: Sequence[int]) -> int:
    """How many of the first numbers are the same with one order less."""
    return next((q for q, x in enumerate(shorter) if x != numbers[q]), len(shorter))


def polynomial(heads: Sequence[int], q: int) -> int:
    """The polynomial with these differences at 0, by Newton's formula."""
    return sum(math.comb(q, k) * head for k, head in enumerate(heads))


def _symmetries(
    geometry: str, gauge: tuple[tuple[int, int], ...], n: int, vectors: int, two_forms: int
) -> dict[int, tuple[tuple[int, int], ...]]:
    """Number of functions of n variables -> the gauge symmetries with this number.

    Diffeomorphisms change coframe and metric by first derivatives, rotations of a tetrad change it
    without a derivative, and a gradient changes a vector field. A two-form is changed by the
    derivative of n functions, less the gradient of one function, which changes nothing.
    """
    further: list[tuple[tuple[int, int], ...]] = [()]
    if geometry == "teleparallel":
        further.append(((n * (n - 1) // 2, 0),))
    if geometry == "symmetric teleparallel":
        further.append(((n, 1),))
    table: dict[int, tuple[tuple[int, int], ...]] = {}
    for extra in further:
        for k, forms in product(range(vectors + 1), range(two_forms + 1)):
            pairs = (*gauge, *extra, *(((k, 1),) if k else ()))
            pairs += ((n * forms, 1), (-forms, 2)) if forms else ()
            table.setdefault(sum(m for m, _ in pairs), pairs)
    return table
