"""Checks: validators of all input: numbers, arrays, names, words.

Every function takes the value, the subject (its name in messages: "radius", "start[2]") and the
class of error to raise. If the usual sentence does not fit, pass another: a text with
``{subject}``, ``{value}`` and the other fields that the function lists.

Nothing here reads text. A text or a list instead of a number is refused, because sympy would run it
as code. Callers that accept text first read it with `geomtorsion.exact.parse_expression`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence, Set
from dataclasses import dataclass
from decimal import Decimal
from difflib import get_close_matches
from fractions import Fraction
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

import sympy as sp

from geomtorsion.errors import (
    LONGEST_SHOWN,
    ArgumentError,
    CoordinateError,
    ExpressionError,
    GeomtorsionError,
    LimitError,
)

if TYPE_CHECKING:
    import numpy as np

ErrorClass = type[GeomtorsionError]
# Bytes of all arrays of one result, or of one file, so that every saved file can be read.
LARGEST_ARRAYS = 2_000_000_000
Kind = TypeVar("Kind")

NUMBER = "{subject}: expected a number, got {value}."
FINITE = "{subject}: expected a finite number, got {value}."
POSITIVE = "{subject}: expected a positive number, got {value}."
LISTED = "{subject}: expected a list of numbers, got {value}."
COUNTED = "{subject}: expected {wanted} numbers, got {came}."
SHAPED = "{subject}: expected shape {wanted}, got {came}."
WHOLE = "{subject}: expected a whole number {range}, got {value}."
FLAG = "{subject}: expected True or False, got {value}."
WORD = "{subject}: expected one of {known}, got {value}."
TEXT = "{subject}: expected text, got {value}."
UNKNOWN = "{subject}: {value} is not known. {hint}Known are {known}."
EXPRESSION = "{subject}: expected one expression, got {value}."
# Remedy where a zero cannot be decided.
KNOWN_IDENTITIES = "Use functions whose identities the library knows (roots, sin, exp, ...)."
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

_SMALL: dict[str, str] = dict(
    zip(
        "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi omicron pi rho "
        "sigma tau upsilon phi chi psi omega".split(),
        "αβγδεζηθικλμνξοπρστυφχψω",
        strict=True,
    )
)
# Name -> Greek letter, small and capital.
GREEK = _SMALL | {name.capitalize(): letter.upper() for name, letter in _SMALL.items()}


# -- what messages show ---------------------------------------------------------------------------


def cut(text: str, most: int = LONGEST_SHOWN) -> str:
    """A text, shortened for a message.

    Examples
    --------
    >>> cut("abcdefgh", 6), cut("abc", 6)
    ('abc...', 'abc')
    """
    return text if len(text) <= most else f"{text[: most - 3]}..."


def shown(value: object) -> str:
    """The repr of a value, shortened for a message; never an error of its own.

    Examples
    --------
    >>> shown("r"), len(shown("r" * 10**6))
    ("'r'", 200)
    """
    try:
        # The beginning of a long text is enough; its repr would be as long as the text.
        start = value[: LONGEST_SHOWN + 1] if isinstance(value, str | bytes) else value
        return cut(repr(start))
    except Exception:  # noqa: BLE001
        # A whole number of 5,000 digits has no repr, and __repr__ of others may do anything.
        return f"a value of type {type(value).__name__}"


def _fail(error: ErrorClass, message: str, subject: str, value: object, **more: object) -> NoReturn:
    raise error(message.format(subject=subject, value=shown(value), **more)) from None


# -- numbers --------------------------------------------------------------------------------------


def plain(value: object) -> Any:
    """A NumPy number, or an array without axes, as the Python number in it; an exact element as
    its sympy expression; everything else as it came.
    """
    found: Any = value
    # The most frequent case: Python numbers, which need no further check.
    if type(found) in (float, int):
        return found
    if hasattr(type(found), "dtype") and getattr(found, "shape", None) == ():
        # A masked value is unknown, whatever number is under the mask.
        found = math.nan if bool(getattr(found, "mask", False)) else found.item()
    inner = getattr(found, "sympy", None) if hasattr(type(found), "sympy") else None
    return inner if isinstance(inner, sp.Expr) else found


def real(value: object) -> float | None:
    """The size of a real number as a float, perhaps nan or infinite; None for anything else.

    Real numbers are int, float, Fraction, mpmath's, NumPy's and sympy's, and exact elements. Text,
    truth values, complex numbers, lists and expressions with symbols are none.

    Examples
    --------
    >>> import sympy as sp
    >>> real(Fraction(1, 4)), real(sp.pi), real(10**400)
    (0.25, 3.141592653589793, inf)
    >>> real("1"), real([1]), real(True), real(sp.Symbol("x"))
    (None, None, None, None)
    """
    found: Any = plain(value)
    if type(found) is float:
        return found
    if isinstance(found, bool | str | bytes | complex) or hasattr(found, "__len__"):
        return None
    if not hasattr(type(found), "__float__"):
        return None
    if isinstance(found, sp.Expr) and found.args and found.is_number:
        check_constant(found)
    try:
        return float(found)
    except OverflowError:
        return math.inf
    except (TypeError, ValueError, RecursionError):
        return None


@dataclass(frozen=True)
class LargestArgument:
    """How large a number may be that a function is taken of: beyond, its value would not end.

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


def number(
    value: object, subject: str, error: ErrorClass, *, message: str = NUMBER, infinite: str = FINITE
) -> float:
    """A finite float.

    message, infinite: the messages for values that are not real numbers, and for nan and infinity.

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
        _fail(error, message, subject, value)
    if not math.isfinite(size):
        _fail(error, infinite, subject, value)
    return size


def exact_number(
    value: object, subject: str, error: ErrorClass, *, message: str = NUMBER, infinite: str = FINITE
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
    number(value, subject, error, message=message, infinite=infinite)
    return plain(value) if hasattr(type(value), "dtype") else value


def positive(
    value: object,
    subject: str,
    error: ErrorClass,
    *,
    message: str = POSITIVE,
    number_message: str = NUMBER,
    infinite: str = FINITE,
) -> float:
    """A positive finite float.

    Examples
    --------
    >>> from geomtorsion.errors import LoopError
    >>> positive(0, "radius", LoopError)
    Traceback (most recent call last):
    geomtorsion.errors.LoopError: radius: expected a positive number, got 0.
    """
    size = number(value, subject, error, message=number_message, infinite=infinite)
    if size <= 0:
        _fail(error, message, subject, value)
    return size


def whole(value: object) -> int | None:
    """A whole number of Python, NumPy or sympy as an int; None for others and truth values.

    Examples
    --------
    >>> import sympy as sp
    >>> whole(-3), whole(sp.Integer(2)), whole(2.0), whole(True)
    (-3, 2, None, None)
    """
    found = plain(value)
    is_whole = isinstance(found, int | sp.Integer) and not isinstance(found, bool)
    return int(found) if is_whole else None


def count(
    value: object,
    subject: str,
    error: ErrorClass,
    low: int = 0,
    high: int | None = None,
    *,
    message: str = WHOLE,
) -> int:
    """A whole number from low to high; the message may use {range}.

    Examples
    --------
    >>> from geomtorsion.errors import TimeError
    >>> count(7, "samples", TimeError, 1)
    7
    >>> count(2.5, "seed", TimeError, 1, 10**6)
    Traceback (most recent call last):
    geomtorsion.errors.TimeError: seed: expected a whole number from 1 to 1,000,000, got 2.5.
    """
    found = whole(value)
    if found is not None and low <= found and (high is None or found <= high):
        return found
    bounds = f"from {low:,} on" if high is None else f"from {low:,} to {high:,}"
    _fail(error, message, subject, value, range=bounds)


def fraction(value: object) -> Fraction | None:
    """A rational number or a float as an exact fraction; None for other values.

    Examples
    --------
    >>> import sympy as sp
    >>> fraction(sp.Rational(1, 3)), fraction(0.5), fraction(sp.pi), fraction("1/2")
    (Fraction(1, 3), Fraction(1, 2), None, None)
    """
    found: Any = plain(value)
    if isinstance(found, bool):
        return None
    if isinstance(found, sp.Rational):
        return Fraction(int(found.p), int(found.q))
    if isinstance(found, int | Fraction):
        return Fraction(found)
    if isinstance(found, float | Decimal) and math.isfinite(found):
        return Fraction(found)
    # A number of mpmath: sign, mantissa, exponent, bits. Its repr would lose digits.
    parts = getattr(found, "_mpf_", None)
    if isinstance(parts, tuple) and real(found) not in (None, math.inf, -math.inf):
        sign, mantissa, exponent, _ = parts
        return Fraction(-int(mantissa) if sign else int(mantissa)) * Fraction(2) ** exponent
    return None


def rational(
    value: object,
    subject: str,
    error: ErrorClass,
    *,
    decimal: bool = False,
    message: str = FINITE,
    infinite: str = FINITE,
) -> sp.Expr:
    """A finite real number as an exact sympy number; roots and pi stay as they are.

    decimal: 0.3 means 3/10; otherwise it means the fraction of powers of two that it is.

    Examples
    --------
    >>> from geomtorsion.errors import SceneError
    >>> rational(0.25, "g", SceneError), rational(0.3, "g", SceneError, decimal=True)
    (1/4, 3/10)
    """
    size = number(value, subject, error, message=message, infinite=infinite)
    found = plain(value)
    if isinstance(found, sp.Expr) and not found.is_Float:
        return found
    exact = fraction(repr_fraction(size) if decimal and isinstance(found, float) else found)
    if exact is None:
        exact = Fraction(size)
    return sp.Rational(exact.numerator, exact.denominator)


def repr_fraction(value: float) -> Fraction:
    """The shortest decimal that a float is written as, as a fraction: 0.1 is 1/10."""
    return Fraction(repr(float(value)))


def expression(
    value: object,
    subject: str = "expression",
    error: ErrorClass = ExpressionError,
    *,
    read: Callable[[str], sp.Expr] | None = None,
    message: str = EXPRESSION,
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
    found = plain(value)
    if isinstance(found, sp.Expr) and not getattr(found, "is_Matrix", False):
        if found.args and found.is_number:
            check_constant(found)
        return found
    if isinstance(found, str) and read is not None:
        return read(found)
    if isinstance(found, int) and not isinstance(found, bool):
        return sp.Integer(found)
    if isinstance(found, Fraction):
        return sp.Rational(found.numerator, found.denominator)
    if isinstance(found, complex):
        return sp.Float(found.real) + sp.I * sp.Float(found.imag)
    if isinstance(found, float) or hasattr(found, "_mpf_"):
        return sp.Float(found)
    if real(found) is not None:
        return sp.Float(float(found))
    _fail(error, message, subject, value)


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


def check_declared(symbol: sp.Symbol, value: object) -> None:
    """Refuse a value that contradicts the assumptions of a parameter.

    sympy has used that already: sqrt(M**2) is M, which would be wrong without a word.

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


def instance(
    value: object, kind: type[Kind], subject: str, error: ErrorClass = ArgumentError
) -> Kind:
    """An instance of a class, such as a frame; the message names the class.

    Examples
    --------
    >>> instance([1], sp.Symbol, "symbol")
    Traceback (most recent call last):
    geomtorsion.errors.ArgumentError: symbol: expected a Symbol, got [1].
    """
    if isinstance(value, kind):
        return value
    article = "an" if kind.__name__[0] in "AEIOU" else "a"
    raise error(f"{subject}: expected {article} {kind.__name__}, got {shown(value)}.")


def file_name(value: object, subject: str = "path", error: ErrorClass = ArgumentError) -> Path:
    """The name of a file or a folder.

    Examples
    --------
    >>> file_name("a.npz").name
    'a.npz'
    >>> file_name(None)
    Traceback (most recent call last):
    geomtorsion.errors.ArgumentError: path: expected the name of a file, got None.
    """
    found = value.__fspath__() if isinstance(value, PathLike) else value
    if isinstance(found, str):
        return Path(found)
    raise error(f"{subject}: expected the name of a file, got {shown(value)}.")


def flag(
    value: object, subject: str, error: ErrorClass = ArgumentError, *, message: str = FLAG
) -> bool:
    """True or False, and nothing merely equivalent.

    Examples
    --------
    >>> flag("no", "complex")
    Traceback (most recent call last):
    geomtorsion.errors.ArgumentError: complex: expected True or False, got 'no'.
    """
    found = plain(value)
    if isinstance(found, bool):
        return found
    _fail(error, message, subject, value)


def entries(
    values: object,
    subject: str,
    error: ErrorClass = ArgumentError,
    *,
    message: str = "{subject}: expected a list, got {value}. Put it in brackets.",
) -> list[Any]:
    """The entries of a list, tuple, array or matrix (by rows); no text, table or set is one.

    Examples
    --------
    >>> entries(sp.Matrix([[1, 2]]), "coframe")
    [[1, 2]]
    """
    found = rows(values)
    if isinstance(found, str | bytes | Mapping | Set) or not isinstance(found, Iterable):
        _fail(error, message, subject, values)
    return list(found)


def is_list(value: object) -> bool:
    """Whether a value has entries in an order: no text, no table, no array without axes.

    Examples
    --------
    >>> import numpy as np
    >>> is_list([1]), is_list(np.array(1.0)), is_list("12"), is_list({1: 2})
    (True, False, False, False)
    """
    if isinstance(value, str | bytes | Mapping | Set) or getattr(value, "shape", None) == ():
        return False
    return hasattr(value, "__len__")


def rows(values: object) -> Any:
    """An array or a matrix as nested lists; anything else unchanged."""
    given: Any = values
    return given.tolist() if hasattr(type(given), "tolist") else given


def table(values: object, subject: str, error: ErrorClass = ArgumentError) -> dict[Any, Any]:
    """A mapping as a dictionary; nothing for None.

    Examples
    --------
    >>> table(None, "parameters"), table({"M": 1}, "parameters")
    ({}, {'M': 1})
    """
    if values is None:
        return {}
    if isinstance(values, Mapping):
        return dict(values)
    _fail(error, "{subject}: expected names with values, got {value}.", subject, values)


def check_room(numbers: int, subject: str, remedy: str) -> None:
    """Refuse, before memory is allocated, more doubles than a file may hold.

    numbers: total count of all arrays in memory together. remedy: advice for the message.

    Raises
    ------
    LimitError
        They would take more than LARGEST_ARRAYS bytes.

    Examples
    --------
    >>> check_room(10**10, "t: 10,000,000,000 times", "Give fewer.")
    Traceback (most recent call last):
    geomtorsion.errors.LimitError: t: 10,000,000,000 times would take 80 GB of memory; the limit \
is 2 GB. Give fewer.
    """
    if 8 * numbers > LARGEST_ARRAYS:
        raise LimitError(
            f"{subject} would take {8e-9 * numbers:.3g} GB of memory; the limit is "
            f"{1e-9 * LARGEST_ARRAYS:.3g} GB. {remedy}"
        )


def by_name(values: object, subject: str, error: ErrorClass = ArgumentError) -> dict[str, Any]:
    """A mapping with names for keys: symbols count by theirs; no name may come twice.

    Examples
    --------
    >>> by_name({sp.Symbol("M"): 1, "a": 2}, "at")
    {'M': 1, 'a': 2}
    >>> by_name({sp.Symbol("M"): 1, "M": 2}, "at")
    Traceback (most recent call last):
    geomtorsion.errors.ArgumentError: at: expected M once, got Symbol('M') and 'M'. Give one.
    """
    found: dict[str, Any] = {}
    keys: dict[str, object] = {}
    for key, value in table(values, subject).items():
        name = key if isinstance(key, str) else getattr(key, "name", str(key))
        if name in keys:
            raise error(
                f"{subject}: expected {cut(name)} once, got {_written(keys[name])} and "
                f"{_written(key)}. Give one."
            )
        found[name], keys[name] = value, key
    return found


def _written(key: object) -> str:
    """A key as text, with the assumptions of a symbol."""
    return cut(sp.srepr(key)) if isinstance(key, sp.Symbol) else shown(key)


# -- several numbers ------------------------------------------------------------------------------


def numbers(
    values: object,
    wanted: int | None,
    subject: str,
    error: ErrorClass,
    *,
    shape_error: ErrorClass | None = None,
    listed: str = LISTED,
    counted: str = COUNTED,
    message: str = NUMBER,
    infinite: str = FINITE,
) -> tuple[Any, ...]:
    """A list of finite real numbers of a given length (None: any), unchanged.

    shape_error: raised for values that are not lists or have another length. listed, counted: its
    messages; they may use {wanted} and {came}. The subject of an entry is ``subject[k]``.

    Examples
    --------
    >>> from geomtorsion.errors import StartError
    >>> numbers([1, Fraction(1, 2)], 2, "start", StartError)
    (1, Fraction(1, 2))
    >>> numbers([1, "2"], 2, "start", StartError)
    Traceback (most recent call last):
    geomtorsion.errors.StartError: start[1]: expected a number, got '2'.
    """
    wrong = shape_error or error
    more = {"wanted": wanted, "came": ""}
    if isinstance(values, str | bytes | Mapping) or not isinstance(values, Iterable):
        _fail(wrong, listed, subject, values, **more)
    try:
        found = tuple(values)
    except TypeError:
        # An array without axes looks like a list, but has no entries.
        _fail(wrong, listed, subject, values, **more)
    if wanted is not None and len(found) != wanted:
        _fail(wrong, counted, subject, values, **more | {"came": len(found)})
    return tuple(
        exact_number(value, f"{subject}[{k}]", error, message=message, infinite=infinite)
        for k, value in enumerate(found)
    )


def array(
    values: object,
    subject: str,
    error: ErrorClass,
    *,
    shape: tuple[int | None, ...] | None = None,
    shape_error: ErrorClass | None = None,
    message: str = "{subject}: expected an array of real numbers, got {value}.",
    shaped: str = SHAPED,
    infinite: str | None = "{subject}{place} = {value} is not finite. Give finite numbers.",
) -> np.ndarray:
    """An array of finite doubles; None in the shape means any length.

    Masked entries become nan, because they are unknown.

    message is used for values that are not arrays of real numbers: text, rows of different
    lengths, complex numbers. shaped may use {wanted} and {came}; infinite may use {place}, such as
    [0, 2], its value being the entry there; infinite=None lets nan and infinity through.

    Examples
    --------
    >>> from geomtorsion.errors import StartError
    >>> array([[1, 2], [3, 4]], "starts", StartError, shape=(None, 2)).sum()
    np.float64(10.0)
    >>> array([[1, 2], [3, float("nan")]], "starts", StartError)
    Traceback (most recent call last):
    geomtorsion.errors.StartError: starts[1, 1] = nan is not finite. Give finite numbers.
    """
    # numpy takes 0.09 s to load, which `import geomtorsion` does not need.
    import numpy as np

    wrong = shape_error or error
    try:
        if isinstance(values, range):
            # It names numbers that it does not hold: they are counted before they are written out.
            count = len(values)
            check_room(count, f"{subject}: {count:,} numbers", "Give fewer.")
            values = np.arange(values.start, values.stop, values.step)
        found = unmasked(values)
        if found.dtype.kind == "O":
            # Fractions and sympy numbers arrive as objects; each is checked.
            sizes = [real(entry) for entry in found.ravel()]
            found = np.array([np.nan if x is None else x for x in sizes]).reshape(found.shape)
            if None in sizes:
                _fail(wrong, message, subject, values)
    except (TypeError, ValueError, OverflowError, RecursionError) as reason:
        if isinstance(reason, GeomtorsionError):
            raise
        _fail(wrong, message, subject, values)
    if found.dtype.kind not in "iuf":
        _fail(wrong, message, subject, values)
    fits = shape is None or (
        found.ndim == len(shape)
        and all(n in (None, m) for n, m in zip(shape, found.shape, strict=True))
    )
    if not fits:
        named = ", ".join("any" if n is None else str(n) for n in shape or ())
        _fail(wrong, shaped, subject, values, wanted=f"({named})", came=found.shape)
    found = found.astype(float)
    if infinite is not None and not np.isfinite(found).all():
        place = tuple(int(k) for k in np.argwhere(~np.isfinite(found))[0])
        _fail(error, infinite, subject, float(found[place]), place=list(place) or "")
    return found


@dataclass(frozen=True)
class Measurable:
    """Sizes of measured numbers: products of four are finite, products of lengths are not zero."""

    least: float = 1e-70
    most: float = 1e70


MEASURABLE = Measurable()
Measured = TypeVar("Measured", float, "np.ndarray")


def measured(
    values: Measured, subject: str, error: ErrorClass, *, is_length: bool = False
) -> Measured:
    """Numbers of measured data, unchanged, refused outside of MEASURABLE.

    values: a checked float or array; nan and infinity in it pass, since `array` decides about them.
    is_length: whether they are lengths, which may not be too short either; of an array the largest
    entry counts, and zero passes, since other checks decide about it.

    Examples
    --------
    >>> from geomtorsion.errors import GridError
    >>> measured(1e200, "step", GridError)
    Traceback (most recent call last):
    geomtorsion.errors.GridError: step: expected numbers between -1e+70 and 1e+70, got 1e+200. \
Give them in another unit.
    >>> measured(1e-90, "step", GridError, is_length=True)
    Traceback (most recent call last):
    geomtorsion.errors.GridError: step: expected lengths between 1e-70 and 1e+70, got 1e-90. Give \
them in another unit.
    """
    # As for `array`: it takes long to load.
    import numpy as np

    given = np.asarray(values)
    flat = given.ravel()
    ends = [float(end.reduce(flat, initial=0.0)) for end in (np.fmin, np.fmax)]
    if not np.isfinite(ends).all():
        finite = flat[np.isfinite(flat)]
        ends = [float(finite.min(initial=0.0)), float(finite.max(initial=0.0))]
    size = max(ends, key=abs)
    is_short = is_length and 0 < abs(size) < MEASURABLE.least
    if abs(size) > MEASURABLE.most or is_short:
        what = (
            f"lengths between {MEASURABLE.least:g} and"
            if is_length
            else f"numbers between {-MEASURABLE.most:g} and"
        )
        raise error(
            f"{subject}: expected {what} {MEASURABLE.most:g}, got "
            f"{abs(size) if is_length else size:.3g}. Give them in another unit."
        )
    return values


def unmasked(values: object) -> np.ndarray:
    """An array unchanged, real numbers with nan where they are masked.

    Raises
    ------
    TypeError, ValueError
        It is none.

    Examples
    --------
    >>> import numpy as np
    >>> unmasked(np.ma.array([1, 2, 3], mask=[False, True, False])), unmasked([1, 2])
    (array([ 1., nan,  3.]), array([1, 2]))
    """
    # As for `array`: it takes long to load.
    import numpy as np

    if not isinstance(values, np.ma.MaskedArray) or values.dtype.kind not in "iufO":
        return np.asarray(values)
    if not np.ma.is_masked(values):
        return np.asarray(values)
    return np.where(np.ma.getmaskarray(values), np.nan, values.data.astype(float))


# -- names and words ------------------------------------------------------------------------------


def close_names(name: str, known: Iterable[str], most: int = 1, cutoff: float = 0.65) -> list[str]:
    """Known names that may have been meant, the likeliest first.

    Examples
    --------
    >>> close_names("kerr_schildd", ["kerr", "kerr_schild", "flat"], most=2)
    ['kerr_schild']
    """
    # Long texts are not misspelt names, and would take long to compare.
    return get_close_matches(name[:LONGEST_SHOWN], list(known), n=most, cutoff=cutoff)


def near_names(name: object, known: Iterable[str]) -> str:
    """Return the known name that was probably meant, or an empty text.

    Examples
    --------
    >>> near_names("thetta", ["r", "theta", "phi"])
    'theta'
    >>> near_names("θ", ["r", "theta", "phi"])
    'theta'
    >>> near_names("Ω", ["Omega"])
    'Omega'
    >>> near_names("banana", ["r", "theta", "phi"])
    ''
    """
    known = list(known)
    if not isinstance(name, str):
        return ""
    for candidate in known:
        if candidate.lower() == name.lower():
            return candidate
        if GREEK.get(candidate) == name or GREEK.get(name) == candidate:
            return candidate
    return next(iter(close_names(name, known)), "")


def did_you_mean(name: object, known: Iterable[str]) -> str:
    """The question "Did you mean ...? " with a space behind it, or an empty text.

    Examples
    --------
    >>> did_you_mean("thetta", ["theta"])
    'Did you mean theta? '
    """
    near = near_names(name, known)
    return f"Did you mean {near}? " if near else ""


def known_name(
    name: object, known: Iterable[str], subject: str, error: ErrorClass, *, message: str = UNKNOWN
) -> str:
    """A name that is known; the message may use {name}, {hint} (did you mean) and {known}.

    Symbols count by their names.

    Examples
    --------
    >>> from geomtorsion.errors import StartError
    >>> known_name("omga", ["omega"], "start", StartError)
    Traceback (most recent call last):
    geomtorsion.errors.StartError: start: 'omga' is not known. Did you mean omega? Known are omega.
    """
    words = list(known)
    text = str(name) if isinstance(name, sp.Symbol) else name
    if isinstance(text, str) and text in words:
        return text
    hint = did_you_mean(text, words) if isinstance(text, str) else ""
    called = cut(text) if isinstance(text, str) else shown(text)
    listed = ", ".join(words) or "none"
    _fail(error, message, subject, text, hint=hint, known=listed, name=called)


def known_keys(
    given: object, known: Iterable[str], subject: str, error: ErrorClass, *, message: str = UNKNOWN
) -> dict[str, Any]:
    """A mapping whose keys are all known, by name; see `known_name`.

    Examples
    --------
    >>> from geomtorsion.errors import StartError
    >>> known_keys({sp.Symbol("M"): 1}, ["M", "a"], "parameters", StartError)
    {'M': 1}
    """
    if not isinstance(given, Mapping):
        _fail(error, "{subject}: expected names with values, got {value}.", subject, given)
    words = list(known)
    for key in given:
        known_name(key, words, subject, error, message=message)
    return by_name(given, subject, error)


def choice(value: object, words: Sequence[str], subject: str, error: ErrorClass) -> str:
    """One of several words.

    Examples
    --------
    >>> from geomtorsion.errors import LoopError
    >>> choice("lines", ["line", "flux"], "method", LoopError)
    Traceback (most recent call last):
    geomtorsion.errors.LoopError: method: expected one of line, flux, got 'lines'.
    """
    if isinstance(value, str) and value in words:
        return value
    _fail(error, WORD, subject, value, known=", ".join(words))


def text(
    value: object, subject: str, error: ErrorClass, *, longest: int = 10**6, message: str = TEXT
) -> str:
    """A text up to a maximal length.

    Examples
    --------
    >>> from geomtorsion.errors import SceneError
    >>> text(3, "name", SceneError)
    Traceback (most recent call last):
    geomtorsion.errors.SceneError: name: expected text, got 3.
    """
    if isinstance(value, str) and len(value) <= longest:
        return value
    _fail(error, message, subject, value)
