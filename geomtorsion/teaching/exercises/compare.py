"""Compare: whether two expressions are equal: exactly, everywhere, or on a part of the domain."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import sympy
from flint import acb, arb

from geomtorsion.codegen import graph
from geomtorsion.codegen.balls import BallCode
from geomtorsion.errors import ExpressionError, GeomtorsionError, LimitError
from geomtorsion.support.checks import expression
from geomtorsion.support.precision import ball_precision
from geomtorsion.teaching.exercises.limits import check_weight

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from geomtorsion.teaching.exercises.domain import Domain
    from geomtorsion.teaching.exercises.question import Question

Index = tuple[int, ...]
Value = Mapping[Index, Any]

EQUAL, PARTLY, DIFFERENT = "equal", "partly", "different"
# Inverse functions, which have branches.
_INVERSE = (
    sympy.asin, sympy.acos, sympy.atan, sympy.acot, sympy.atan2, sympy.asinh, sympy.acosh,
    sympy.atanh, sympy.acoth, sympy.asec, sympy.acsc, sympy.asech, sympy.acsch, sympy.log,
)  # fmt: skip
# Decimal digits of a sure agreement; as many more may cancel on the way.
DIGITS = 100
# Bits of twice as many digits.
_BITS = 2 * DIGITS * 10 // 3


def compare(domain: Domain, one: sympy.Expr, two: sympy.Expr) -> str:
    """How two expressions are related: EQUAL, PARTLY (on a part of the domain) or DIFFERENT.

    Equal means that the difference vanishes exactly and that the values differ at no sample
    point: sqrt(1 - cos(x)**2) is sin(x) for 0 < x < pi, but not for 0 < x < 2 pi. Points at which
    one of them has no finite value are skipped.

    Raises
    ------
    LimitError
        They differ at no point, but are too large to be compared exactly.

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
    values = [pair for pair in _values(domain, one, two) if all(x.is_finite() for x in pair)]
    # Balls that share no point prove that the values differ.
    differences = [not a.overlaps(b) for a, b in values]
    if all(differences):
        return DIFFERENT
    if any(differences):
        # Without branches two expressions that differ agree at no generic point.
        return PARTLY if has_root(one - two) or has_inverse(one - two) else DIFFERENT
    zero = _is_zero(domain, one, two)
    if zero is None:
        # No exact rule decides: many digits do.
        share = arb(10) ** -DIGITS
        if not all(abs(a - b) < share * (1 + abs(a) + abs(b)) for a, b in values):
            raise LimitError(
                f"answer: more than {DIGITS} digits cancel in it. Write it with smaller numbers."
            )
        zero = True
    return EQUAL if zero else DIFFERENT


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


def agreement(question: Question, given: Value, right: Value) -> Mapping[Index, str]:
    """EQUAL, PARTLY or DIFFERENT for each component of two answers; a missing component is zero.

    Options of a choice are compared as they are, numbers within the tolerance of the question
    (relative to the largest number of `right`), all others by `compare`.

    Examples
    --------
    >>> from geomtorsion.teaching.exercises import load
    >>> [agreement(load("4.4").question("compass"), {(): x}, {(): 2.0}) for x in (2.001, 2.5)]
    [{(): 'equal'}, {(): 'different'}]
    """
    return dict(_states(question, given, right))


def agrees(question: Question, given: Value, right: Value) -> bool:
    """Whether all components of two answers agree; ends at the first difference."""
    return all(state == EQUAL for _, state in _states(question, given, right))


def _states(question: Question, given: Value, right: Value) -> Iterator[tuple[Index, str]]:
    """`agreement`, one component after another."""
    allowed = question.tolerance * largest(right) if question.kind == "number" else 0.0
    for key in sorted({*given, *right}):
        one, two = given.get(key, 0), right.get(key, 0)
        if question.kind == "choice":
            yield key, EQUAL if one == two else DIFFERENT
        elif question.kind == "number":
            yield key, EQUAL if abs(float(one) - float(two)) <= allowed else DIFFERENT
        else:
            yield key, compare(question.domain, one, two)


def largest(value: Value) -> float:
    """Size of the largest number, which sets the scale of a tolerance; 1 if all are zero.

    Examples
    --------
    >>> largest({(0,): -3.0, (1,): 2.0}), largest({})
    (3.0, 1.0)
    """
    return max((abs(float(x)) for x in value.values()), default=0.0) or 1.0


def _values(domain: Domain, *expressions: sympy.Expr) -> list[Sequence[acb]]:
    """Balls around the values of expressions, at each sample point."""
    symbols = domain.symbols
    code = BallCode(graph([symbol.name for symbol in symbols], expressions, factor=False))
    with ball_precision(_BITS):
        function, numbers = code.complex_function(), code.numbers()
        points = [[point[symbol] for symbol in symbols] for point in domain.places]
        return [
            function([acb(arb(int(x.p)) / int(x.q)) for x in point], numbers, False)
            for point in points
        ]


def _is_zero(domain: Domain, one: sympy.Expr, two: sympy.Expr) -> bool | None:
    """Whether the difference vanishes exactly; None if no exact rule decides."""
    for expr in (one, two):
        check_weight(expr, "answer")
    try:
        first, second = domain.field().read_all(
            [("answer", _without_sizes(domain, one)), ("solution", _without_sizes(domain, two))]
        )
        return (first - second).is_zero
    except (LimitError, RecursionError) as error:
        raise LimitError(f"the answer is too large to be compared exactly: {error}") from None
    except ExpressionError as error:
        raise ExpressionError(f"the answer cannot be read exactly: {error}") from None
    except GeomtorsionError:
        return None


def _without_sizes(domain: Domain, expr: sympy.Expr) -> sympy.Expr:
    """|x| as x or -x, if x has one sign at all points; sympy makes it from sqrt(x**2)."""
    table = {}
    for size in expr.atoms(sympy.Abs):
        inner = [x.real for (x,) in _values(domain, size.args[0])]
        if all(x >= 0 for x in inner):
            table[size] = size.args[0]
        elif all(x <= 0 for x in inner):
            table[size] = -size.args[0]
    return expr.xreplace(table)
