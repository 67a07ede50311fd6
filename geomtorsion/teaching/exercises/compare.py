"""Compare: whether two expressions are equal: exactly, everywhere, or on a part of the domain."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import sympy

from geomtorsion.checks import expression
from geomtorsion.errors import ExpressionError, GeomtorsionError, LimitError
from geomtorsion.precision import HALF
from geomtorsion.teaching.exercises.limits import check_weight
from geomtorsion.teaching.exercises.numeric import DIGITS, at_point, at_points, at_points_with_size

if TYPE_CHECKING:
    from geomtorsion.teaching.exercises.domain import Domain, Point

Index = tuple[int, ...]
Value = Mapping[Index, Any]

EQUAL, PARTLY, DIFFERENT = "equal", "partly", "different"
# Inverse functions, which have branches.
_INVERSE = (
    sympy.asin, sympy.acos, sympy.atan, sympy.acot, sympy.atan2, sympy.asinh, sympy.acosh,
    sympy.atanh, sympy.acoth, sympy.asec, sympy.acsc, sympy.asech, sympy.acsch, sympy.log,
)  # fmt: skip
# Half of the digits may have cancelled; values that differ in the remaining half are different.
SURE = 10.0 ** (-DIGITS // 2)
# Largest ratio of intermediate numbers, answer to solution: beyond it, too many digits cancel.
BEYOND = 1 / SURE


def compare(domain: Domain, one: sympy.Expr, two: sympy.Expr) -> str:
    """How two expressions are related: EQUAL, PARTLY (on a part of the domain) or DIFFERENT.

    Equal means that the difference vanishes exactly and that both have the same value at every
    sample point: sqrt(1 - cos(x)**2) is sin(x) for 0 < x < pi, but not for 0 < x < 2 pi.

    Raises
    ------
    LimitError
        They agree at all points, but are too large to be compared exactly.

    Examples
    --------
    >>> from geomtorsion.teaching.exercises.domain import Domain, Point
    >>> x = sympy.Symbol("x", real=True)
    >>> whole, half = Domain((x,), (x > 0, x < 2 * sympy.pi)), Domain((x,), (x > 0, x < sympy.pi))
    >>> root = sympy.sqrt(1 - sympy.cos(x) ** 2)
    >>> [compare(domain, root, sympy.sin(x)) for domain in (whole, half)]
    ['partly', 'equal']
    """
    one, two = expression(one), expression(two)
    # Nearly all right answers are written like the solution, or become so when they are read.
    if one == two:
        return EQUAL
    near, excess = _near(domain, one, two)
    if not any(near):
        return DIFFERENT
    if not all(near):
        # Without branches two expressions that differ agree at no generic point.
        return PARTLY if has_root(one - two) or has_inverse(one - two) else DIFFERENT
    if not excess < BEYOND:
        raise LimitError("answer: numbers beyond all size occur on the way. Write it without them.")
    return EQUAL if _is_zero(domain, one, two) else DIFFERENT


def has_root(expr: sympy.Expr) -> bool:
    """Whether a root of a symbol occurs, or an absolute value such as |x|.

    Examples
    --------
    >>> x = sympy.Symbol("x", real=True)
    >>> has_root(sympy.sqrt(1 + x)), has_root(sympy.sqrt(2) * x), has_root(sympy.Abs(x))
    (True, False, True)
    """
    return any(
        isinstance(part, sympy.Abs) or (part.is_Pow and not part.exp.is_integer)
        for part in sympy.preorder_traversal(expr)
        if part.free_symbols and not isinstance(part, sympy.exp)
    )


def has_inverse(expr: sympy.Expr) -> bool:
    """Whether an inverse function of a symbol occurs, which returns one of several values.

    Examples
    --------
    >>> x = sympy.Symbol("x", real=True)
    >>> has_inverse(sympy.acos(x)), has_inverse(sympy.cos(x)), has_inverse(sympy.acos(1) * x)
    (True, False, False)
    """
    return any(part.free_symbols for part in expr.atoms(*_INVERSE))


def compare_all(domain: Domain, given: Value, right: Value) -> dict[Index, str]:
    """`compare` for every component that occurs in one of two; a missing component is zero."""
    keys = sorted({*given, *right})
    return {key: compare(domain, given.get(key, 0), right.get(key, 0)) for key in keys}


def same(domain: Domain, given: Value, right: Value) -> bool:
    """Whether all components are equal; ends at the first difference."""
    return all(
        compare(domain, given.get(key, 0), right.get(key, 0)) == EQUAL for key in {*given, *right}
    )


def _near(domain: Domain, one: sympy.Expr, two: sympy.Expr) -> tuple[list[bool], float]:
    """At each point where both have a value, whether the values agree; and the ratio of the largest
    intermediate number of the first to the largest intermediate number of the second.

    Floats decide where the values differ by more than half of their digits and no intermediate
    number is so large that one over a difference of two such numbers may have lost more digits;
    elsewhere many digits are computed.
    """
    firsts, sizes = at_points_with_size(one, domain.columns)
    seconds, others = at_points_with_size(two, domain.columns)
    found, beyond = [], 0.0
    rows = zip(domain.places, firsts, seconds, sizes, others, strict=True)
    for point, first, second, size, other in rows:
        largest = max(size, other)
        # If the second overflows a float, the first may also overflow.
        beyond = max(beyond, size / max(other, 1.0)) if math.isfinite(other) else beyond
        difference = _size(first - second)
        # Near values are compared with many digits.
        near = difference <= HALF * (1 + _size(first) + _size(second)) < math.inf
        if near or (HALF * largest < difference < math.inf and HALF * largest * largest < 1):
            found.append(near)
        else:
            settled = _settled(point, one, two)
            found += [] if settled is None else [settled]
    return found, beyond


def _size(x: complex) -> float:
    """|x|, infinite where it overflows a float."""
    try:
        return abs(x)
    except OverflowError:
        return math.inf


def _settled(point: Point, one: sympy.Expr, two: sympy.Expr) -> bool | None:
    """Whether both have one value at a point, in many digits; None if one has no value there."""
    a, b = at_point(one, point), at_point(two, point)
    if a is None or b is None:
        return None
    return bool(abs(a - b) <= SURE * (1 + abs(a) + abs(b)))


def _is_zero(domain: Domain, one: sympy.Expr, two: sympy.Expr) -> bool:
    """Whether the difference vanishes exactly; if this is undecided, the result of many digits."""
    for expr in (one, two):
        check_weight(expr, "answer")
    try:
        first, second = domain.field().read_all(
            [("answer", _without_sizes(domain, one)), ("solution", _without_sizes(domain, two))]
        )
        verdict = (first - second).is_zero
    except (LimitError, RecursionError) as error:
        raise LimitError(f"the answer is too large to be compared exactly: {error}") from None
    except ExpressionError as error:
        raise ExpressionError(f"the answer cannot be read exactly: {error}") from None
    except GeomtorsionError:
        verdict = None
    if verdict is None:
        settled = [_settled(point, one, two) for point in domain.places]
        return False not in settled and True in settled
    return verdict


def _without_sizes(domain: Domain, expr: sympy.Expr) -> sympy.Expr:
    """|x| as x or -x, if x has one sign at all points; sympy makes it from sqrt(x**2)."""
    table = {}
    for size in expr.atoms(sympy.Abs):
        inner = [x.real for x in at_points(size.args[0], domain.columns)]
        if all(x >= 0 for x in inner):
            table[size] = size.args[0]
        elif all(x <= 0 for x in inner):
            table[size] = -size.args[0]
    return expr.xreplace(table)
