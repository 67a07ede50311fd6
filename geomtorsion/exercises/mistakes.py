"""Mistakes: wrong answers computed from the right one and from what an exercise expects."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import permutations
from math import degrees, radians
from typing import TYPE_CHECKING, Any

import sympy

from geomtorsion.exercises.numbers import deviation
from geomtorsion.exercises.question import Mistake, normal

if TYPE_CHECKING:
    from geomtorsion.exercises.compare import Value
    from geomtorsion.exercises.question import Question

HALF = sympy.Rational(1, 2)
BOTH = "It is off by a factor 2, and the sign is wrong as well."
ANGLES = ("rad", "deg")


def all_mistakes(question: Question) -> tuple[Mistake, ...]:
    """What the exercise expects, then what can happen everywhere; none equals the solution."""
    found: list[Mistake] = []
    for mistake in (*question.errors(), *_generic(question)):
        value = normal(mistake.value)
        if _is_other(question, value) and not _repeats(found, mistake.code, value):
            found.append(Mistake(mistake.code, value, mistake.message))
    return tuple(found)


def _is_other(question: Question, value: Value) -> bool:
    """Whether a wrong answer can be told from the right one."""
    if question.kind == "number":
        return deviation(question, value, question.solution) > 1
    return value != question.solution


def _repeats(found: Iterable[Mistake], code: str, value: Value) -> bool:
    return any(known.code == code and known.value == value for known in found)


def _generic(question: Question) -> Iterator[Mistake]:
    """Sign, factor 2, permuted indices, and degrees for radians."""
    if question.kind == "choice":
        return
    right = question.solution
    wanted = question.generic
    if question.unit in ANGLES:
        for turned in (degrees, radians):
            yield Mistake("degrees", {key: turned(float(x)) for key, x in right.items()})
    if "sign" in wanted:
        yield Mistake("sign", scaled(right, -1))
    if "factor" in wanted:
        yield Mistake("factor", scaled(right, 2))
        yield Mistake("factor", scaled(right, HALF))
    if {"sign", "factor"} <= set(wanted):
        yield from (Mistake("factor", scaled(right, x), BOTH) for x in (-2, -HALF))
    if "permuted" in wanted and question.kind == "components":
        yield from (Mistake("permuted", value) for value in permuted(right, question.shape))


def scaled(value: Any, factor: Any) -> Value:
    """Every component times a factor.

    Examples
    --------
    >>> scaled([1, 0, 3], 2)
    {(0,): 2, (2,): 6}
    """
    return {
        key: float(factor) * x if isinstance(x, float) else factor * x
        for key, x in normal(value).items()
    }


def permuted(value: Value, shape: tuple[int, ...]) -> Iterator[Value]:
    """The components with their indices in every other order."""
    rank = len(shape)
    if rank < 2 or len(set(shape)) > 1:
        return
    for order in permutations(range(rank)):
        if order != tuple(range(rank)):
            yield reordered(value, order)


def reordered(value: Any, order: tuple[int, ...]) -> Value:
    """Components with their indices in another order; order[k] comes k-th.

    Examples
    --------
    >>> reordered([[1, 2], [0, 3]], (1, 0))
    {(0, 0): 1, (1, 0): 2, (1, 1): 3}
    """
    return {tuple(key[k] for k in order): x for key, x in normal(value).items()}
