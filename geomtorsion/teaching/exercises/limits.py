"""limits: the largest size of an answer, so that no answer blocks the examiner."""

from __future__ import annotations

from dataclasses import dataclass
from math import comb

import sympy

from geomtorsion.errors import LimitError
from geomtorsion.exact.limits import LARGEST_MULTIPLE
from geomtorsion.exact.tokens import Limits
from geomtorsion.support.checks import LargestArgument

# What a person writes is far below these; what a machine writes to annoy is above them. Powers are
# as high as exact work takes them: how long they are multiplied out is what `check_weight` counts.
ANSWER = Limits(
    characters=4000, depth=30, exponent=LARGEST_MULTIPLE, digits=80,
    argument=LargestArgument(elementary=1e4, power=100),
)  # fmt: skip


@dataclass(frozen=True)
class Most:
    """Largest sizes of answers that are read, compared and shown.

    characters: of one answer with all its components. entries: of one answer.
    levels: of nested lists, more than any tensor here has indices. equations: of one.
    terms: of an answer, multiplied out; equation_terms: of one of several equations, which are
    combined to solve them. roots: different ones.
    file: bytes of a file of answers. name: letters of a student's. seed: the largest variant.
    remark: letters of a cell in the table of marks. named: wrong components that are named.
    mistakes: that are listed with a solution. preview: letters of an answer as it was read.
    """

    characters: int = 20_000
    entries: int = 500
    levels: int = 6
    equations: int = 12
    terms: int = 5_000_000
    equation_terms: int = 5000
    roots: int = 4
    file: int = 200_000
    name: int = 200
    seed: int = 10**9
    remark: int = 300
    named: int = 4
    mistakes: int = 6
    preview: int = 300


MOST = Most()
_CIRCULAR = (sympy.sin, sympy.cos, sympy.tan, sympy.cot, sympy.sec, sympy.csc)


def check_weight(expr: sympy.Expr, where: str, largest: int = MOST.terms) -> None:
    """Refuse an expression that would be very long when multiplied out.

    Raises
    ------
    LimitError
        more than `largest` terms, or more than MOST.roots roots, are expected.

    Examples
    --------
    >>> x, y, z = sympy.symbols("x y z")
    >>> check_weight((x + y + z) ** 6, "answer")
    >>> check_weight((x + y + z + 1) ** 24 / (x - y + 2 * z - 1) ** 24, "answer")
    Traceback (most recent call last):
    geomtorsion.errors.LimitError: answer: expected at most 5,000,000 terms when multiplied...
    """
    radicals = {
        power.base for power in expr.atoms(sympy.Pow) if power.exp.is_Rational and power.exp.q > 1
    }
    if len({base for base in radicals if not base.is_number}) > MOST.roots:
        raise LimitError(
            f"{where}: expected at most {MOST.roots} different roots, got more. Write it shorter."
        )
    # Counted without expanding, because expanding is the expensive step.
    above, below = _weight(expr, {})
    if above * below > largest:
        raise LimitError(
            f"{where}: expected at most {largest:,} terms when multiplied out, got more. "
            "Write it shorter."
        )


def _weight(expr: sympy.Expr, known: dict[sympy.Expr, tuple[int, int]]) -> tuple[int, int]:
    """Bounds on the terms of numerator and denominator, multiplied out."""
    if expr not in known:
        above, below = _counted(expr, known)
        known[expr] = min(above, 10**12), min(below, 10**12)
    return known[expr]


def _counted(expr: sympy.Expr, known: dict[sympy.Expr, tuple[int, int]]) -> tuple[int, int]:
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
        # What a root reduces to stays below its degree.
        n = max(abs(int(expr.exp)), int(expr.exp.q), 1)
        grown = _power(top, n), _power(bottom, n)
        return grown if expr.exp > 0 else (grown[1], grown[0])
    if isinstance(expr, _CIRCULAR):
        return _multiples(expr.args[0]), 2 if isinstance(expr, _CIRCULAR[2:]) else 1
    inner = [_weight(argument, known) for argument in expr.args]
    return max((max(pair) for pair in inner), default=1), 1


def _power(terms: int, n: int) -> int:
    """Terms of the n-th power of a sum."""
    return comb(min(terms, 10**4) + n - 1, n) if terms > 1 else 1


def _multiples(angle: sympy.Expr) -> int:
    """Terms of the cosine of a sum of multiples of angles."""
    count = 1
    for term in sympy.Add.make_args(angle):
        factor = abs(term.as_coeff_Mul()[0])
        size = int(max(factor.p, factor.q)) if factor.is_Rational else 1
        count = min(2 * count * (size // 2 + 1), 10**12)
    return count // 2 if count > 1 else 1
