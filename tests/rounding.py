"""Rounding: the finest tolerance of a test, which each processor and library of numbers meets."""

from __future__ import annotations

import ast
from collections.abc import Iterator

import numpy as np

# A hundred roundings of a number of size one. Libraries of linear algebra and of elementary
# functions differ by some roundings from one processor to the next.
ROUNDED = 100 * 2.0**-52
# Half of the smallest relative step between doubles: below it numbers of more digits are compared.
DOUBLES = 2.0**-53
TOLERANCES = ("rel", "abs", "rtol", "atol")


def rounded(*intermediate: object) -> float:
    """A hundred roundings of the largest of all intermediate values, which may be arrays.

    Examples
    --------
    >>> rounded([1.0, -50.0], 2.0) == 50 * ROUNDED
    True
    """
    return ROUNDED * max(float(np.nanmax(np.abs(np.asarray(x, float)))) for x in intermediate)


def tight_tolerances(code: ast.Module) -> Iterator[int]:
    """Lines that compare doubles to a written tolerance of less than a hundred roundings.

    A comparison with a reported error or drift checks a claim, and its numbers are not tolerances.

    Examples
    --------
    >>> list(tight_tolerances(ast.parse("assert abs(x - y) < 1e-15")))
    [1]
    >>> list(tight_tolerances(ast.parse("assert abs(x - y) < 1e-9\\nassert x.error < 1e-15")))
    []
    >>> list(tight_tolerances(ast.parse("assert x == approx(y, rel=1e-14)")))
    [1]
    """
    for node in ast.walk(code):
        if isinstance(node, ast.Compare) and not _is_a_claim(node):
            for bound, kind in zip(node.comparators, node.ops, strict=True):
                if isinstance(kind, ast.Lt | ast.LtE):
                    yield from _tight(bound)
        elif isinstance(node, ast.keyword) and node.arg in TOLERANCES:
            yield from _tight(node.value)


def _tight(bound: ast.expr) -> Iterator[int]:
    """Lines of the numbers in a bound that are tolerances below a hundred roundings."""
    for part in ast.walk(bound):
        value = part.value if isinstance(part, ast.Constant) else None
        if isinstance(value, float) and DOUBLES <= value < ROUNDED:
            yield part.lineno  # type: ignore[attr-defined]


def _is_a_claim(node: ast.Compare) -> bool:
    """Whether a comparison names an error or a drift that the package reports."""
    names = [
        part.attr if isinstance(part, ast.Attribute) else part.id
        for part in ast.walk(node)
        if isinstance(part, ast.Attribute | ast.Name)
    ]
    return any("error" in name or "drift" in name for name in names)
