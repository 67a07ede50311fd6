"""Evaluation: numbers of a tensor's components at points, and points in the domain of a frame."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import mpmath
import sympy as sp

from geomtorsion import checks
from geomtorsion.errors import CoordinateError, MissingValueError, ShapeError, SingularPointError
from geomtorsion.exact import Element
from geomtorsion.geometry.components import Index
from geomtorsion.precision import EPS

if TYPE_CHECKING:
    import numpy as np

    from geomtorsion.geometry.frame import Frame
    from geomtorsion.geometry.tensor import Number, Point, Tensor

# So many points are tried, in ranges that become ten times as wide on the way.
TRIES = 400
# As fine as doubles: at small fractions two symbols may coincide, and with them two expressions
# that differ everywhere else.
FINE = round(1 / EPS)
# Fractional parts of multiples of their square roots fill a cube evenly.
PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71)

RationalPoint = dict[sp.Symbol, sp.Rational]


def is_several(value: object) -> bool:
    """Whether a value is a list or an array with axes."""
    return isinstance(value, list | tuple) or bool(getattr(value, "shape", ()))


def at_points(
    tensor: Tensor, point: Point, several: Mapping[Any, Any], digits: int | None
) -> np.ndarray:
    """Arrays of a tensor's components at all points, their shape first."""
    # See at_point.
    import numpy as np

    # By rows, since an array would lose its mask, and what is masked is not known.
    columns = [np.array(checks.rows(value), dtype=object) for value in several.values()]
    try:
        columns = np.broadcast_arrays(*columns)
    except ValueError:
        shapes = ", ".join(str(column.shape) for column in columns)
        raise ShapeError(
            f"point: values of one shape were needed, but shapes {shapes} came. "
            "Give lists of equal length, or single numbers."
        ) from None
    found = [
        at_point(tensor, {**point, **dict(zip(several, values, strict=True))}, digits)
        for values in zip(*(column.ravel() for column in columns), strict=True)
    ]
    n, rank = tensor.frame.dimension, len(tensor.slots)
    return np.array(found).reshape(*columns[0].shape, *(n,) * rank)


def at_point(tensor: Tensor, point: Point, digits: int | None) -> np.ndarray:
    """Array of a tensor's components at a point (see Tensor.at)."""
    # numpy takes 0.09 s to load, which exact work does not need.
    import numpy as np

    bits = 53
    if digits is not None:
        wanted = checks.count(digits, "digits", CoordinateError, 1, 1000)
        # From 54 on elements are evaluated to numbers of mpmath.
        bits = max(mpmath.libmp.dps_to_prec(wanted), 54)
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
    """The independent components at a point; those that are equal are evaluated once."""
    values = _named_values(tensor, point)
    _check_branches(tensor.frame, values)
    known: dict = {}
    independent = tensor.components.independent
    return {i: _number(tensor, i, v, values, bits, known) for i, v in independent.items()}


def _check_branches(frame: Frame, values: Mapping[sp.Expr, Number]) -> None:
    """Refuse a point at which a root has not the sign with which it was read."""
    if not frame.field.relied_on:
        return
    # Loads numpy.
    from geomtorsion.codegen.expression_graph import branch_check

    point = {str(key): complex(number) for key, number in values.items()}
    check = branch_check([frame.field], list(point))
    if check is not None:
        real = {name: number if frame.complex else number.real for name, number in point.items()}
        check.refuse(*real.values())


def _opposite(number: complex | mpmath.mpf) -> complex | mpmath.mpf:
    """Minus a number, with all its digits."""
    exact = isinstance(number, mpmath.mpf | mpmath.mpc)
    return mpmath.fneg(number, exact=True) if exact else -number


def _named_values(tensor: Tensor, point: Point) -> dict[sp.Expr, Number]:
    """The point with symbols as keys; a name that means nothing here is refused."""
    symbols = {symbol.name: symbol for symbol in tensor.frame.field.symbols}
    given = checks.table(point, "point")
    for key, number in given.items():
        found = checks.plain(number)
        # Neither nan nor infinity ends an evaluation to many digits.
        for part in (found.real, found.imag) if isinstance(found, complex) else (number,):
            checks.number(part, f"point: {checks.cut(str(key))}", CoordinateError)
    named = {key: number for key, number in given.items() if isinstance(key, (str, sp.Symbol))}
    values = {key: number for key, number in given.items() if key not in named}
    for name, number in checks.by_name(named, "point", CoordinateError).items():
        if name not in symbols:
            raise CoordinateError(
                f"{checks.cut(name)} is neither a coordinate nor a parameter of this frame. "
                f"Known are {', '.join(symbols)}."
            )
        symbol = symbols[name]
        if symbol not in tensor.frame.coordinates:
            checks.check_declared(symbol, number)
        values[symbol] = number
    return values


def _number(
    tensor: Tensor, index: Index, element: Element, values: Point, bits: int, known: dict
) -> complex | mpmath.mpf:
    """Value of one component, with an error that names it where it is not finite."""
    try:
        number = element.evaluate(values, bits, known)
    except (ZeroDivisionError, SingularPointError):
        number = float("nan")
    except MissingValueError as error:
        raise MissingValueError(f"{tensor.label}{list(index)}: {error}") from None
    if mpmath.isfinite(number) and (tensor.frame.complex or number.imag == 0):
        return number
    place = ", ".join(f"{symbol} = {value}" for symbol, value in values.items())
    raise SingularPointError(
        f"{tensor.label}{list(index)} has no finite real value at {place}. "
        "Choose a point inside the domain of the frame."
    )


def sample_point(frame: Frame) -> RationalPoint:
    """See Frame.sample_point."""
    determinant = frame.determinant.element()
    for point in candidate_points(frame.coordinates, frame.parameters, frame.domain):
        for fill in (with_functions, with_generic_functions):
            values = fill(determinant, point)
            try:
                size = abs(complex(determinant.evaluate(values)))
                numbers_at(frame.coframe, values)
            except ArithmeticError:
                continue
            # One so small or so large may be rounding; the next point is as good.
            if 1e-12 < size < 1e12:
                return point
    raise CoordinateError(
        f"no point inside the domain was found in {TRIES} tries. State the domain "
        "more simply, as bounds of each coordinate by numbers: 0 < theta, theta < pi."
    )


def domain_relations(domain: object) -> tuple[sp.Basic, ...]:
    """A domain as relations that all hold: from one relation, And(...), a sequence or None."""
    if domain is None:
        return ()
    relations = "{subject}: relations were needed, but {value} came. Give r > 2*M, 0 < theta."
    items = (
        [domain]
        if isinstance(domain, sp.Basic | bool)
        else checks.entries(domain, "domain", CoordinateError, message=relations)
    )
    found: list[sp.Basic] = []
    item: Any
    for item in items:
        parts = item.args if isinstance(item, sp.And) else (item,)
        for part in parts:
            if part is True or part == sp.true:
                continue
            if not isinstance(part, sp.core.relational.Relational):
                raise CoordinateError(
                    f"domain: {checks.shown(part)} is no relation. "
                    "Give relations such as r > 2*M, 0 < theta."
                )
            found.append(part)
    return tuple(found)


def candidate_points(
    coordinates: Sequence[sp.Symbol],
    parameters: Sequence[sp.Symbol],
    relations: Iterable[sp.Basic],
    fineness: int = 97,
) -> Iterator[RationalPoint]:
    """Points that satisfy the relations and the assumptions of the symbols, in a fixed order."""
    relations = tuple(relations)
    symbols = [*coordinates, *parameters]
    ranges = {symbol: _interval(symbol, relations) for symbol in symbols}
    if any(low is not None and high is not None and low >= high for low, high in ranges.values()):
        return
    whole = {symbol for symbol in symbols if symbol.is_integer}
    several = [x for x in relations if len(x.free_symbols) > 1 or whole & x.free_symbols]
    for number in range(TRIES):
        # Domains far from the origin are reached by wider and wider ranges.
        stretch = 1 + 10 * number // TRIES
        point = {}
        for k, symbol in enumerate(symbols):
            root = math.sqrt(PRIMES[k % len(PRIMES)]) * (number + 1 + k // len(PRIMES))
            share = Fraction(int((root % 1) * fineness) + 1, fineness + 2)
            low, high = _finite(ranges[symbol], symbol in parameters, stretch)
            value = low + (high - low) * share
            if symbol.is_integer:
                # The next one on the side where zero is not.
                value = Fraction(math.floor(value) + (ranges[symbol][0] is not None))
            point[symbol] = sp.Rational(value.numerator, value.denominator)
        if all(relation.subs(point) == sp.true for relation in several):
            yield point


def with_functions(element: Element, point: RationalPoint) -> dict[Any, Any]:
    """A point, with unknown functions set to one and their derivatives to zero."""
    values: dict[Any, Any] = dict(point)
    for generator in element.field.generators:
        if generator.kind == "jet":
            values[generator.shown] = 0 if isinstance(generator.shown, sp.Derivative) else 1
    return values


def with_generic_functions(element: Element, point: RationalPoint) -> dict[Any, Any]:
    """A point, with unknown functions as they are where the signs of roots were read."""
    field = element.field
    jets = [generator for generator in field.generators if generator.kind == "jet"]
    return {**point, **{g.shown: field.sample.value(field.generator_element(g)) for g in jets}}


def _interval(
    symbol: sp.Symbol, relations: Iterable[sp.Basic]
) -> tuple[Fraction | None, Fraction | None]:
    """Bounds of a symbol from its assumptions and from relations to numbers."""
    low = Fraction(0) if symbol.is_nonnegative else None
    high = Fraction(0) if symbol.is_nonpositive else None
    for relation in relations:
        if relation.free_symbols != {symbol}:
            continue
        less, greater = (relation.lts, relation.gts) if hasattr(relation, "lts") else (None, None)
        if less == symbol and greater is not None and greater.is_finite:
            bound = Fraction(float(greater)).limit_denominator(10**6)
            high = bound if high is None else min(high, bound)
        elif greater == symbol and less is not None and less.is_finite:
            bound = Fraction(float(less)).limit_denominator(10**6)
            low = bound if low is None else max(low, bound)
    return low, high


def _finite(
    bounds: tuple[Fraction | None, Fraction | None], parameter: bool, stretch: int
) -> tuple[Fraction, Fraction]:
    """A finite range: coordinates reach further out than parameters."""
    low, high = bounds
    width = Fraction(3, 4) if parameter else Fraction(4)
    width *= stretch
    if low is None and high is None:
        return -width / 2, width / 2
    if low is None:
        assert high is not None
        return high - width, high
    return low, low + width if high is None else high
