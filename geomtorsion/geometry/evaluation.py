"""Evaluation: the numbers that a tensor's components are at points."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import mpmath
import sympy as sp

from geomtorsion.errors import (
    CoordinateError,
    GeomtorsionError,
    MissingValueError,
    ShapeError,
    SingularPointError,
)
from geomtorsion.exact import Element, Field
from geomtorsion.exact.element import inside_out
from geomtorsion.exact.evaluate import arguments, made_of
from geomtorsion.exact.generators import Generator
from geomtorsion.geometry.components import Index
from geomtorsion.geometry.derived import derived
from geomtorsion.geometry.real_points import RationalPoint
from geomtorsion.support import checks

if TYPE_CHECKING:
    import numpy as np

    from geomtorsion.geometry.frame import Frame
    from geomtorsion.geometry.tensor import Number, Point, Tensor


def is_several(value: object) -> bool:
    """Whether a value is a list or an array with axes."""
    return isinstance(value, list | tuple) or bool(getattr(value, "shape", ()))


def at_points(
    tensor: Tensor, point: Point, several: Mapping[Any, Any], digits: int | None
) -> np.ndarray:
    """Arrays of a tensor's components at all points, their shape first."""
    # See at_point.
    import numpy as np

    # By rows: a plain array would lose the mask, and masked values are unknown.
    columns = [np.array(checks.rows(value), dtype=object) for value in several.values()]
    try:
        columns = np.broadcast_arrays(*columns)
    except ValueError:
        shapes = ", ".join(str(column.shape) for column in columns)
        raise ShapeError(
            f"point: expected values of one shape, got the shapes {shapes}. Give lists of equal "
            "length, or single numbers."
        ) from None
    arrays = [
        at_point(tensor, {**point, **dict(zip(several, values, strict=True))}, digits)
        for values in zip(*(column.ravel() for column in columns), strict=True)
    ]
    n, rank = tensor.frame.dimension, len(tensor.slots)
    return np.array(arrays).reshape(*columns[0].shape, *(n,) * rank)


def at_point(tensor: Tensor, point: Point, digits: int | None) -> np.ndarray:
    """Array of a tensor's components at a point (see Tensor.at)."""
    # numpy takes 0.09 s to load, which exact work does not need.
    import numpy as np

    bits = 53
    if digits is not None:
        digit_count = checks.count(digits, "digits", CoordinateError, 1, 1000)
        # From 54 on elements are evaluated to numbers of mpmath.
        bits = max(mpmath.libmp.dps_to_prec(digit_count), 54)
    n, rank = tensor.frame.dimension, len(tensor.slots)
    result = np.zeros((n,) * rank, dtype=complex if tensor.frame.complex else float)
    if digits is not None:
        result = np.full((n,) * rank, mpmath.mpf(0), dtype=object)
    numbers = numbers_at(tensor, point, bits)
    for index in tensor.components.support:
        sign, representative = tensor.components.representative(index)
        number = numbers[representative]
        # A product would be rounded to the digits that mpmath has at the moment.
        result[index] = number if sign > 0 else _opposite(number)
    return result


def numbers_at(tensor: Tensor, point: Point, bits: int = 53) -> dict[Index, Number]:
    """The independent components at a point; equal ones are evaluated once."""
    values = _named_values(tensor, point)
    _check_branches(tensor.frame, values)
    numbers: dict = {}
    independent = tensor.components.independent
    return {i: _number(tensor, i, v, values, bits, numbers) for i, v in independent.items()}


def _check_branches(frame: Frame, values: Mapping[sp.Expr, Number]) -> None:
    """Refuse a point at which a root has another sign than it was read with."""
    if not frame.field.relied_on:
        return
    # Loads numpy.
    from geomtorsion.codegen.expression_graph import branch_check

    point = {str(key): complex(number) for key, number in values.items()}
    check = branch_check([frame.field.exact], list(point))
    if check is not None:
        real = {name: number if frame.complex else number.real for name, number in point.items()}
        check.refuse(*real.values())


def _opposite(number: complex | mpmath.mpf) -> complex | mpmath.mpf:
    """Minus a number, with all its digits."""
    exact = isinstance(number, mpmath.mpf | mpmath.mpc)
    return mpmath.fneg(number, exact=True) if exact else -number


def sign_of(frame: Frame, symbol: sp.Symbol) -> int:
    """Declared sign of a coordinate, 1 or -1, if the frame may rely on it; else 0.

    sympy has written x for Abs(x) and sqrt(x**2) then. Where the frame repeats itself after a full
    turn of the coordinate, or does not depend on it, there was nothing to be written otherwise.
    """
    sign = 1 if symbol.is_nonnegative else -1 if symbol.is_nonpositive else 0
    return 0 if sign and repeats(frame, symbol) else sign


@derived
def repeats(frame: Frame, symbol: sp.Symbol) -> bool:
    """Whether a frame is the same after a full turn of a coordinate, or does not depend on it."""
    field, by_name = frame.field, dict[str, bool | None]()
    for entry in (value for matrix in frame.given.values() for value in matrix.values()):
        verdicts: set[bool | None] = set()
        for generator in field.generators_of(entry):
            for part in inside_out(generator, made_of, lambda inner: inner.name in by_name):
                by_name[part.name] = _generator_repeats(field, part, symbol, by_name)
            verdicts.add(by_name[generator.name])
        if False in verdicts:
            return False
        # Two that change their signs may make a product that does not.
        if None in verdicts and entry.sympy.subs(symbol, symbol + 2 * sp.pi) != entry.sympy:
            return False
    return True


def _generator_repeats(
    field: Field, generator: Generator, symbol: sp.Symbol, known: Mapping[str, bool | None]
) -> bool | None:
    """Whether a generator is the same after a full turn; None where that takes two, as cos(x/2)."""
    if symbol not in generator.depends:
        return True
    parts, is_wave = arguments(generator), generator.kind in ("cos", "sin")
    inner = [one for part in parts for one in field.generators_of(part)]
    # A wave repeats itself though its angle, the symbol times a whole number, does not.
    verdicts = {known[one.name] for one in inner if not (is_wave and one.shown == symbol)}
    if not parts or False in verdicts:
        return False
    if is_wave:
        (angle,) = parts
        if angle.is_kept or angle._den:
            return False
        place = next(k for k, one in enumerate(field.generators) if one.shown == symbol)
        slope = field.lift(angle).derivative(place)
        if slope and slope.total_degree():
            return False
        if slope and slope.leading_coefficient().q != 1:
            return None
    return None if None in verdicts else True


def _named_values(tensor: Tensor, point: Point) -> dict[sp.Expr, Number]:
    """The point with symbols as keys; a name that means nothing here is refused."""
    symbols = {symbol.name: symbol for symbol in tensor.frame.field.symbols}
    entries = {key: _single(number) for key, number in checks.table(point, "point").items()}
    for key, number in entries.items():
        plain = checks.plain(number)
        # Neither nan nor infinity ends an evaluation to many digits.
        for part in (plain.real, plain.imag) if isinstance(plain, complex) else (number,):
            checks.number(part, f"point: {checks.cut(str(key))}", CoordinateError)
    named = {key: number for key, number in entries.items() if isinstance(key, (str, sp.Symbol))}
    values = {key: number for key, number in entries.items() if key not in named}
    for name, number in checks.by_name(named, "point", CoordinateError).items():
        kind = "coordinates and parameters of this frame"
        checks.known_name(name, symbols, "point", CoordinateError, expected=kind)
        symbol = symbols[name]
        try:
            checks.check_declared(symbol, number)
        except GeomtorsionError:
            if symbol not in tensor.frame.coordinates or sign_of(tensor.frame, symbol):
                raise
        values[symbol] = number
    return values


def _single(number: Number) -> Number:
    """A number, also from an array without axes; a masked one becomes nan."""
    return checks.plain(number) if getattr(number, "shape", None) == () else number


def _number(
    tensor: Tensor, index: Index, element: Element, values: Point, bits: int, known: dict
) -> complex | mpmath.mpf:
    """Value of one component, with an error that names it where it is not finite."""
    try:
        number = element.evaluate(values, bits, known)
    except (ZeroDivisionError, SingularPointError):
        number = float("nan")
    except MissingValueError as error:
        raise MissingValueError(f"{tensor.label}{list(index) or ''}: {error}") from None
    if mpmath.isfinite(number) and (tensor.frame.complex or number.imag == 0):
        return number
    place = ", ".join(f"{symbol} = {value}" for symbol, value in values.items())
    raise SingularPointError(
        f"{tensor.label}{list(index) or ''} has no finite real value at {place}. "
        "Choose a point inside the domain of the frame."
    )


def sample_point(frame: Frame) -> RationalPoint:
    """See Frame.sample_point."""
    return dict(frame.region.point)
