"""Values: converters of one number or expression, and the limits of their sizes.

Nothing here reads text. A text or a list instead of a number is refused, because sympy would run it
as code. Callers that accept text first read it with `geomtorsion.exact.parse_expression`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import Any

import sympy as sp

from geomtorsion.errors import ArgumentError, CoordinateError, ExpressionError, LimitError
from geomtorsion.support.checks.names import ErrorClass, cut, refuse

# Assumption of a symbol in sympy, and the property that its values need. Zero is the limit of
# positive values.
DECLARED = {
    "positive": "nonnegative",
    "negative": "nonpositive",
    "nonnegative": "nonnegative",
    "nonpositive": "nonpositive",
    "real": "real",
    "integer": "integer",
    "even": "even",
    "odd": "odd",
}
# A number of each sign that is a half, odd or even.
_LIKE: dict[tuple[int, float], sp.Expr] = {
    (sign, rest): sp.Rational(sign) * size
    for sign in (-1, 0, 1)
    for rest, size in ((0.5, sp.Rational(1, 2)), (1, sp.Integer(1)), (0, sp.Integer(2)))
}


def number(
    value: object, subject: str, error: ErrorClass, *, expected: str = "", remedy: str = ""
) -> float:
    """A finite float.

    Examples
    --------
    >>> from geomtorsion.errors import LoopError
    >>> number(Fraction(1, 2), "radius", LoopError)
    0.5
    >>> number(["1"], "radius", LoopError)
    Traceback (most recent call last):
    geomtorsion.errors.LoopError: radius: expected a number, got ['1'].
    """
    size = real(value)
    if size is None:
        refuse(error, subject, expected or "a number", value, remedy)
    if not math.isfinite(size):
        refuse(error, subject, expected or "a finite number", value, remedy)
    return size


def exact_number(
    value: object, subject: str, error: ErrorClass, *, expected: str = "", remedy: str = ""
) -> Any:
    """A finite real number, unchanged: fractions, sympy numbers and exact elements stay.

    NumPy's numbers become Python's.

    Examples
    --------
    >>> import numpy as np
    >>> from geomtorsion.errors import StartError
    >>> exact_number(Fraction(1, 3), "mass", StartError), exact_number(np.int64(3), "m", StartError)
    (Fraction(1, 3), 3)
    """
    number(value, subject, error, expected=expected, remedy=remedy)
    return plain(value) if hasattr(type(value), "dtype") else value


def positive(
    value: object,
    subject: str,
    error: ErrorClass,
    *,
    expected: str = "a positive number",
    remedy: str = "",
) -> float:
    """A positive finite float.

    Examples
    --------
    >>> from geomtorsion.errors import LoopError
    >>> positive(0, "radius", LoopError)
    Traceback (most recent call last):
    geomtorsion.errors.LoopError: radius: expected a positive number, got 0.
    """
    size = real(value)
    if size is None or not 0 < size < math.inf:
        refuse(error, subject, expected, value, remedy)
    return size


def not_negative(
    value: object,
    subject: str,
    error: ErrorClass,
    *,
    expected: str = "0 or a positive number",
    remedy: str = "",
) -> float:
    """A finite float that is 0 or positive.

    Examples
    --------
    >>> from geomtorsion.errors import GridError
    >>> not_negative(-1, "core", GridError)
    Traceback (most recent call last):
    geomtorsion.errors.GridError: core: expected 0 or a positive number, got -1.
    """
    size = real(value)
    if size is None or not 0 <= size < math.inf:
        refuse(error, subject, expected, value, remedy)
    return size


def count(
    value: object,
    subject: str,
    error: ErrorClass,
    low: int = 0,
    high: int | None = None,
    *,
    expected: str = "",
    remedy: str = "",
) -> int:
    """A whole number from low to high.

    Examples
    --------
    >>> from geomtorsion.errors import TimeError
    >>> count(7, "samples", TimeError, 1)
    7
    >>> count(2.5, "seed", TimeError, 1, 10**6)
    Traceback (most recent call last):
    geomtorsion.errors.TimeError: seed: expected a whole number from 1 to 1,000,000, got 2.5.
    """
    size = whole(value)
    if size is not None and low <= size and (high is None or size <= high):
        return size
    bounds = f"from {low:,} on" if high is None else f"from {low:,} to {high:,}"
    wanted = expected or f"a whole number {bounds}"
    refuse(error, subject, wanted, value, remedy)


def rational(
    value: object,
    subject: str,
    error: ErrorClass,
    *,
    decimal: bool = False,
    expected: str = "a finite number",
    remedy: str = "",
) -> sp.Expr:
    """A finite real number as an exact sympy number; roots and pi stay as they are.

    decimal: 0.3 means 3/10; otherwise it means its exact binary fraction.

    Examples
    --------
    >>> from geomtorsion.errors import SceneError
    >>> rational(0.25, "g", SceneError), rational(0.3, "g", SceneError, decimal=True)
    (1/4, 3/10)
    """
    size = number(value, subject, error, expected=expected, remedy=remedy)
    inner = plain(value)
    if isinstance(inner, sp.Expr) and not inner.is_Float:
        return inner
    exact = fraction(repr_fraction(size) if decimal and isinstance(inner, float) else inner)
    if exact is None:
        exact = Fraction(size)
    return sp.Rational(exact.numerator, exact.denominator)


def flag(
    value: object,
    subject: str,
    error: ErrorClass = ArgumentError,
    *,
    expected: str = "True or False",
    remedy: str = "",
) -> bool:
    """True or False, and nothing merely equivalent.

    Examples
    --------
    >>> flag("no", "complex")
    Traceback (most recent call last):
    geomtorsion.errors.ArgumentError: complex: expected True or False, got 'no'.
    """
    inner = plain(value)
    if isinstance(inner, bool):
        return inner
    refuse(error, subject, expected, value, remedy)


def expression(
    value: object,
    subject: str = "expression",
    error: ErrorClass = ExpressionError,
    *,
    read: Callable[[str], sp.Expr] | None = None,
    expected: str = "one expression",
    remedy: str = "",
) -> sp.Expr:
    """One sympy expression: a number, an expression or an exact element.

    Used instead of ``sympify``, which runs text as Python, also text in lists, and the text that
    ``str`` makes of unknown objects.

    read: reads text, such as a `parse_expression` that knows the names; without it text is refused.

    Examples
    --------
    >>> import sympy as sp
    >>> expression(Fraction(1, 2)), expression(sp.pi)
    (1/2, pi)
    >>> expression(["1"], "curve[0]")
    Traceback (most recent call last):
    geomtorsion.errors.ExpressionError: curve[0]: expected one expression, got ['1'].
    """
    inner = plain(value)
    if isinstance(inner, sp.Expr) and not getattr(inner, "is_Matrix", False):
        if inner.args and inner.is_number:
            check_constant(inner)
        return inner
    if isinstance(inner, str) and read is not None:
        return read(inner)
    if isinstance(inner, int) and not isinstance(inner, bool):
        return sp.Integer(inner)
    if isinstance(inner, Fraction):
        return sp.Rational(inner.numerator, inner.denominator)
    if isinstance(inner, complex):
        return sp.Float(inner.real) + sp.I * sp.Float(inner.imag)
    if isinstance(inner, float) or hasattr(inner, "_mpf_"):
        return sp.Float(inner)
    if real(inner) is not None:
        return sp.Float(float(inner))
    refuse(error, subject, expected, value, remedy)


def check_declared(symbol: sp.Symbol, value: object) -> None:
    """Refuse a value that contradicts the assumptions of a parameter.

    sympy has used the assumption already: sqrt(M**2) is M, which would be silently wrong.

    Raises
    ------
    CoordinateError
        The value does; the message names the assumption.

    Examples
    --------
    >>> check_declared(sp.Symbol("k", real=True), 1j)
    Traceback (most recent call last):
    geomtorsion.errors.CoordinateError: k: expected a value that is real, as declared, got 1j. \
Give another value, or declare k without it.
    """
    found = plain(value)
    if isinstance(found, complex) and not found.imag:
        found = found.real
    size = None if isinstance(found, sp.Expr) else real(found)
    if size is None:
        like = expression(found, symbol.name, CoordinateError)
    else:
        # Sign and rest decide, which sympy knows of these at once, but not of a new float.
        exact = found if isinstance(found, int) else size
        like = _LIKE[(size > 0) - (size < 0), exact % 2 if exact == exact // 1 else 0.5]
    if words := against(symbol, like):
        raise CoordinateError(
            f"{symbol}: expected a value that is {', '.join(words)}, as declared, got {found}. "
            f"Give another value, or declare {symbol} without it."
        )


def against(symbol: sp.Symbol, value: sp.Expr) -> list[str]:
    """The assumptions of a symbol that a value contradicts.

    Zero is accepted as the limit of positive values.

    Examples
    --------
    >>> M = sp.Symbol("M", positive=True)
    >>> against(M, sp.Integer(-1)), against(M, sp.Integer(0))
    (['positive', 'nonnegative'], [])
    """
    return [
        word
        for word, allowed in DECLARED.items()
        if getattr(symbol, f"is_{word}") and getattr(value, f"is_{allowed}") is False
    ]


# -- numbers of all libraries ---------------------------------------------------------------------


def plain(value: object) -> Any:
    """A NumPy number, or an array without axes, as the Python number in it; an exact element as
    its sympy expression; everything else as it came.
    """
    inner: Any = value
    # The most frequent case: Python numbers, which need no further check.
    if type(inner) in (float, int):
        return inner
    if hasattr(type(inner), "dtype") and getattr(inner, "shape", None) == ():
        # A masked value is unknown, whatever number is under the mask.
        inner = math.nan if bool(getattr(inner, "mask", False)) else inner.item()
    exact = getattr(inner, "sympy", None) if hasattr(type(inner), "sympy") else None
    return exact if isinstance(exact, sp.Expr) else inner


def real(value: object) -> float | None:
    """The size of a real number as a float, perhaps nan or infinite; None for anything else.

    Real numbers are int, float, Fraction, mpmath's, NumPy's and sympy's, and exact elements. Text,
    truth values, complex numbers, lists and expressions with symbols are not real numbers.

    Examples
    --------
    >>> import sympy as sp
    >>> real(Fraction(1, 4)), real(sp.pi), real(10**400)
    (0.25, 3.141592653589793, inf)
    >>> real("1"), real([1]), real(True), real(sp.Symbol("x"))
    (None, None, None, None)
    """
    inner: Any = plain(value)
    if type(inner) is float:
        return inner
    if isinstance(inner, bool | str | bytes | complex) or hasattr(inner, "__len__"):
        return None
    if not hasattr(type(inner), "__float__"):
        return None
    if isinstance(inner, sp.Expr) and inner.args and inner.is_number:
        check_constant(inner)
    try:
        return float(inner)
    except OverflowError:
        return math.inf
    except (TypeError, ValueError, RecursionError):
        return None


def whole(value: object) -> int | None:
    """A whole number of Python, NumPy or sympy as an int; None for others and truth values.

    Examples
    --------
    >>> import sympy as sp
    >>> whole(-3), whole(sp.Integer(2)), whole(2.0), whole(True)
    (-3, 2, None, None)
    """
    inner = plain(value)
    is_whole = isinstance(inner, int | sp.Integer) and not isinstance(inner, bool)
    return int(inner) if is_whole else None


def fraction(value: object) -> Fraction | None:
    """A rational number or a float as an exact fraction; None for other values.

    Examples
    --------
    >>> import sympy as sp
    >>> fraction(sp.Rational(1, 3)), fraction(0.5), fraction(sp.pi), fraction("1/2")
    (Fraction(1, 3), Fraction(1, 2), None, None)
    """
    inner: Any = plain(value)
    if isinstance(inner, bool):
        return None
    if isinstance(inner, sp.Rational):
        return Fraction(int(inner.p), int(inner.q))
    if isinstance(inner, int | Fraction):
        return Fraction(inner)
    if isinstance(inner, float | Decimal) and math.isfinite(inner):
        return Fraction(inner)
    # A number of mpmath: sign, mantissa, exponent, bits. Its repr would lose digits.
    parts = getattr(inner, "_mpf_", None)
    if isinstance(parts, tuple) and real(inner) not in (None, math.inf, -math.inf):
        sign, mantissa, exponent, _ = parts
        return Fraction(-int(mantissa) if sign else int(mantissa)) * Fraction(2) ** exponent
    return None


def repr_fraction(value: float) -> Fraction:
    """The shortest decimal that a float is written as, as a fraction: 0.1 is 1/10."""
    return Fraction(repr(float(value)))


# -- numbers that would take forever --------------------------------------------------------------


@dataclass(frozen=True)
class LargestArgument:
    """Largest argument of a function of numbers; a larger one would be computed forever.

    elementary: of exp, sin and their like. mpmath works with all digits of such a number before
    the point; a machine word has 64 bits.
    special: of Bessel, gamma and their like: sympy writes them out as sums of so many terms, and
    mpmath finds no end for some of a high order.
    power: limit of exponents that are not whole numbers.
    """

    elementary: float = 2.0**64
    special: float = 100.0
    power: float = 2.0**64


LARGEST_ARGUMENT = LargestArgument()
# Functions that shrink their argument: any number is allowed.
_SHRINKING = frozenset(("sqrt", "cbrt", "log", "ln"))
_ELEMENTARY = frozenset(
    f"{inverse}{name}{hyperbolic}"
    for name in ("sin", "cos", "tan", "cot", "sec", "csc")
    for inverse in ("", "a", "arc")
    for hyperbolic in ("", "h")
) | {"exp", "atan2", "floor", "ceiling", "Abs", "sign", "Min", "Max", "re", "im"}


def check_constant(value: sp.Expr) -> None:
    """Refuse a number whose value would take forever, before it is computed.

    Raises
    ------
    LimitError
        It has a function or a power of a number that is too large.

    Examples
    --------
    >>> check_constant(sp.exp(sp.exp(sp.exp(99))))
    Traceback (most recent call last):
    geomtorsion.errors.LimitError: exp(exp(exp(99))): expected functions of smaller numbers, got \
exp of a number above 18,446,744,073,709,551,616, the limit. Write the number shorter.
    """
    for part in sp.postorder_traversal(value):
        reason = ""
        if part.is_Pow or isinstance(part, sp.exp):
            base, exponent = part.as_base_exp()
            reason = too_large("exp", [exponent]) if base is sp.E else exponent_too_large(exponent)
        elif part.is_Function:
            reason = too_large(type(part).__name__, part.args)
        if reason:
            raise LimitError(
                f"{cut(str(value))}: expected functions of smaller numbers, got {reason}. "
                "Write the number shorter."
            )


def too_large(
    name: str, arguments: Iterable[sp.Basic], largest: LargestArgument = LARGEST_ARGUMENT
) -> str:
    """Why a function of these arguments is refused, or nothing.

    Only numbers count, and their parts have been checked before.

    Examples
    --------
    >>> too_large("exp", [sp.exp(99)]), too_large("exp", [sp.Integer(99)])
    ('exp of a number above 18,446,744,073,709,551,616, the limit', '')
    """
    if name in _SHRINKING:
        return ""
    most = largest.elementary if name in _ELEMENTARY else largest.special
    if any(_is_above(argument, most) for argument in arguments):
        return f"{name[:20]} of a number above {most:,.0f}, the limit"
    return ""


def exponent_too_large(exponent: sp.Basic, largest: LargestArgument = LARGEST_ARGUMENT) -> str:
    """Why a power with this exponent is refused, or nothing; whole numbers are not looked at."""
    if exponent.is_Integer or not _is_above(exponent, largest.power):
        return ""
    return f"a power above {largest.power:,.0f}, the limit of powers that are not whole"


def _is_above(value: sp.Basic, most: float) -> bool:
    """Whether a number is larger than this in size; expressions with symbols are not."""
    if not value.is_number:
        return False
    if isinstance(value, sp.Rational):
        return abs(int(value.p)) > most * int(value.q)
    try:
        real, imaginary = value.evalf(15).as_real_imag()
        return bool(abs(real) > most or abs(imaginary) > most)
    # Too many digits, or not a number, such as 0/0.
    except OverflowError:
        return True
    except TypeError:
        return False
