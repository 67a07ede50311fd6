"""Lists: converters of several values: lists, numbers, flags and arrays of a shape."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set, Sized
from dataclasses import dataclass
from types import EllipsisType
from typing import TYPE_CHECKING, Any, TypeVar

from geomtorsion.errors import ArgumentError, GeomtorsionError, LimitError
from geomtorsion.support.checks.names import ErrorClass, refuse, sentence
from geomtorsion.support.checks.values import exact_number, plain, real, whole

if TYPE_CHECKING:
    import numpy as np

# Bytes of all arrays of one result, or of one file, so that every saved file can be read.
LARGEST_ARRAYS = 2_000_000_000


def entries(
    values: object,
    subject: str,
    error: ErrorClass = ArgumentError,
    length: int | None = None,
    *,
    expected: str = "",
    remedy: str = "",
) -> list[Any]:
    """The entries of a list, tuple, array or matrix; no text, table or set is one.

    A matrix has rows as entries, and numbers if it is a column, as vectors of sympy are.
    length: how many there must be.

    Examples
    --------
    >>> import sympy as sp
    >>> entries(sp.Matrix([[1, 2]]), "coframe")
    [[1, 2]]
    >>> entries(sp.Matrix([1, 2]), "velocity")
    [1, 2]
    >>> entries([1], "interval", length=2, expected="two bounds")
    Traceback (most recent call last):
    geomtorsion.errors.ArgumentError: interval: expected two bounds, got [1].
    """
    # The most frequent case: plain lists, which need no further check.
    is_plain = type(values) in (list, tuple)
    content: Any = values if is_plain else rows(values)
    if not is_plain and (
        isinstance(content, str | bytes | Mapping | Set) or not isinstance(content, Iterable)
    ):
        wanted, what_to_do = expected or "a list", remedy or "Put it in brackets." * (not expected)
        refuse(error, subject, wanted, values, what_to_do)
    listed = list(content)
    shape = () if is_plain else getattr(values, "shape", ())
    if len(shape) == 2 and shape[1] == 1 < shape[0]:
        listed = [x for row in listed for x in row]
    if length is not None and len(listed) != length:
        wanted = expected or f"{length} entries"
        refuse(error, subject, wanted, values, remedy)
    return listed


def numbers(
    values: object,
    wanted: int | None,
    subject: str,
    error: ErrorClass,
    *,
    shape_error: ErrorClass | None = None,
    expected: str = "",
    remedy: str = "",
) -> tuple[Any, ...]:
    """A list of finite real numbers of a given length (None: any), unchanged.

    shape_error: raised for values that are not lists or have another length. The subject of an
    entry is ``subject[k]``.

    Examples
    --------
    >>> from fractions import Fraction
    >>> from geomtorsion.errors import StartError
    >>> numbers([1, Fraction(1, 2)], 2, "start", StartError)
    (1, Fraction(1, 2))
    >>> numbers([1, "2"], 2, "start", StartError)
    Traceback (most recent call last):
    geomtorsion.errors.StartError: start[1]: expected a number, got '2'.
    """
    wrong = shape_error or error
    several = expected or (f"a list of {wanted} numbers" if wanted else "a list of numbers")
    try:
        listed = tuple(entries(values, subject, wrong, expected=several, remedy=remedy))
    except TypeError:
        # An array without axes looks like a list, but has no entries.
        refuse(wrong, subject, several, values, remedy)
    if wanted is not None and len(listed) != wanted:
        if expected:
            refuse(wrong, subject, expected, values, remedy)
        raise wrong(sentence(subject, f"{wanted} numbers", len(listed), remedy))
    return tuple(exact_number(value, f"{subject}[{k}]", error) for k, value in enumerate(listed))


def indices(
    values: Sequence[object], length: int, size: int, subject: str, error: ErrorClass
) -> tuple[int, ...]:
    """A given number of whole numbers from 0 to size - 1, such as the indices of a component.

    Examples
    --------
    >>> from geomtorsion.errors import TensorIndexError
    >>> indices([0, 4], 2, 3, "g", TensorIndexError)
    Traceback (most recent call last):
    geomtorsion.errors.TensorIndexError: g: expected 2 whole numbers from 0 to 2, got [0, 4]. Give \
one for each index.
    """
    given = [k if type(k) is int else whole(k) for k in values]
    places = tuple([k for k in given if k is not None and 0 <= k < size])
    if not len(places) == len(given) == length:
        wanted = f"{length} whole numbers from 0 to {size - 1}"
        refuse(error, subject, wanted, list(values), "Give one for each index.")
    return places


def flags(
    values: object, length: int, subject: str, error: ErrorClass, *, remedy: str = ""
) -> tuple[bool, ...]:
    """A given number of truth values; 0 and 1 count as truth values.

    Examples
    --------
    >>> from geomtorsion.errors import GridError
    >>> flags([1, 0], 2, "periodic", GridError)
    (True, False)
    """
    listed = rows(values)
    is_valid = isinstance(listed, list | tuple) and len(listed) == length
    if not is_valid or not all(isinstance(plain(x), int | float) and x in (0, 1) for x in listed):
        refuse(error, subject, f"{length} truth values", values, remedy)
    return tuple(map(bool, listed))


def array(
    values: object,
    subject: str,
    error: ErrorClass,
    *,
    shape: tuple[int | EllipsisType | None, ...] | None = None,
    shape_error: ErrorClass | None = None,
    expected: str = "",
    remedy: str = "",
    infinite: str | None = "{subject}{place} = {value} is not finite. Give finite numbers.",
) -> np.ndarray:
    """An array of finite doubles; in the shape None is any length, ... first any axes before.

    Masked entries become nan, because they are unknown.

    Text, rows of different lengths and complex numbers are refused. infinite: a sentence for nan
    and infinity, with {place}, such as [0, 2]; None lets them through.

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

    table = _real_table(values, subject, shape_error or error, expected, remedy)
    if shape is not None and not _fits(table.shape, shape):
        words = {None: "any", ...: "..."}
        named = ", ".join(words.get(n, str(n)) for n in shape)
        wanted = expected or f"shape ({named})"
        came = f"shape {table.shape}" if expected else table.shape
        raise (shape_error or error)(sentence(subject, wanted, came, remedy))
    table = table.astype(float)
    if infinite is not None and not np.isfinite(table).all():
        place = tuple(int(k) for k in np.argwhere(~np.isfinite(table))[0])
        where = list(place) or ""
        raise error(infinite.format(subject=subject, value=float(table[place]), place=where))
    return table


def _real_table(
    values: object, subject: str, error: ErrorClass, expected: str, remedy: str
) -> np.ndarray:
    """An array of integers or floats in the shape in which it was given."""
    # numpy takes 0.09 s to load, which `import geomtorsion` does not need.
    import numpy as np

    kind = expected or "an array of real numbers"
    try:
        if isinstance(values, range):
            # It names numbers that it does not hold: they are counted before they are written out.
            count = len(values)
            check_room(count, f"{subject}: {count:,} numbers", "Give fewer.")
            values = np.arange(values.start, values.stop, values.step)
        table = unmasked(values)
        if table.dtype.kind == "O":
            # Fractions and sympy numbers arrive as objects; each is checked.
            sizes = [real(entry) for entry in table.ravel()]
            if None in sizes:
                refuse(error, subject, kind, values, remedy)
            table = np.array(sizes, dtype=float).reshape(table.shape)
    except (TypeError, ValueError, OverflowError, RecursionError) as reason:
        if isinstance(reason, GeomtorsionError):
            raise
        refuse(error, subject, kind, values, remedy)
    if table.dtype.kind not in "iuf":
        refuse(error, subject, kind, values, remedy)
    return table


def _fits(sizes: tuple[int, ...], shape: tuple[int | EllipsisType | None, ...]) -> bool:
    """Whether a shape fits; None is any length, ... first any axes before."""
    if shape[:1] == (...,):
        shape = shape[1:]
        sizes = sizes[-len(shape) :]
    pairs = zip(shape, sizes, strict=False)
    return len(sizes) == len(shape) and all(n in (None, m) for n, m in pairs)


def whole_array(
    values: object, subject: str, error: ErrorClass, columns: int | None = None
) -> np.ndarray:
    """An array of whole numbers with two axes, as int64; columns: None for any number of them.

    Examples
    --------
    >>> from geomtorsion.errors import NetworkError
    >>> whole_array([[0, 1]], "edges", NetworkError, 2)
    array([[0, 1]])
    >>> whole_array([[0.5, 1]], "edges", NetworkError, 2)
    Traceback (most recent call last):
    geomtorsion.errors.NetworkError: edges: expected whole numbers of shape (any, 2), got float64 \
of shape (1, 2).
    """
    # As for `array`: it takes long to load.
    import numpy as np

    try:
        table = unmasked(values)
    except (TypeError, ValueError):
        table = np.empty(0, dtype=object)
    if not table.size and table.dtype.kind == "f":
        table = table.reshape(len(table), columns or 0).astype(np.int64)
    fits = table.ndim == 2 and columns in (None, table.shape[-1])
    if not fits or table.dtype.kind not in "iu":
        wanted = f"whole numbers of shape (any, {'any' if columns is None else columns})"
        raise error(sentence(subject, wanted, f"{table.dtype} of shape {table.shape}"))
    return table.astype(np.int64, copy=False)


def check_one_each(
    values: Sized, number: int, each: str, subject: str, error: ErrorClass, remedy: str = ""
) -> None:
    """Refuse values that are not as many as the things they belong to.

    Examples
    --------
    >>> from geomtorsion.errors import GridError
    >>> check_one_each(["H"], 2, "atoms", "species", GridError)
    Traceback (most recent call last):
    geomtorsion.errors.GridError: species: expected one for each of 2 atoms, got 1.
    """
    if len(values) != number:
        wanted = f"one for each of {number:,} {each}"
        raise error(sentence(subject, wanted, f"{len(values):,}", remedy))


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
    content: Any = values
    return content.tolist() if hasattr(type(content), "tolist") else content


def unmasked(values: object) -> np.ndarray:
    """An array unchanged, real numbers with nan where they are masked.

    Raises
    ------
    TypeError, ValueError
        The value is not an array of numbers.

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


# -- sizes of arrays and of measured values -------------------------------------------------------


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
