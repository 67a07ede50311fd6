"""Expansion: a frame whose components are power series in a small parameter."""

from __future__ import annotations

from typing import cast

import sympy as sp

from geomtorsion.errors import ArgumentError, CoframeError, CoordinateError, UnknownNameError
from geomtorsion.exact import Element, Field, Truncated, TruncatedField
from geomtorsion.geometry import validation
from geomtorsion.geometry.components import Entries, determinant, inverse
from geomtorsion.geometry.derived import derived
from geomtorsion.geometry.frame import Frame
from geomtorsion.geometry.orthonormalize import orthonormal_rows
from geomtorsion.geometry.tensor import Tensor
from geomtorsion.support import checks


def small_parameter(frame: Frame, symbol: object) -> sp.Symbol:
    """The parameter of a frame that is meant by a symbol or name."""
    symbols = {one.name: one for one in frame.parameters}
    name, kind = checks.plain(symbol), "a parameter of the frame"
    if not isinstance(name, sp.Symbol):
        remedy = "Give its symbol or name."
        name = checks.text(name, "symbol", ArgumentError, expected=kind, remedy=remedy)
    name = str(name)
    if name in {one.name for one in frame.coordinates}:
        raise CoordinateError(
            f"symbol: expected a parameter of the frame, got the coordinate {name}. For a series "
            "in a coordinate use tensor.series."
        )
    return symbols[checks.known_name(name, symbols, "symbol", UnknownNameError, expected=kind)]


@derived
def expanded(frame: Frame, symbol: sp.Symbol, order: int) -> Frame:
    """See Frame.expanded."""
    series = TruncatedField(frame.field, symbol, order)
    # Geometry uses only what both fields have.
    field = cast(Field, series)
    n, shape = frame.dimension, frame.shape

    def read(entries: Entries) -> dict[tuple[int, int], Element]:
        named = [(f"{shape}{list(index)}", x.sympy) for index, x in entries.items()]
        elements = dict(zip(entries, field.read_all(named), strict=True))
        return {index: x for index, x in elements.items() if not x.is_zero}

    matrix = read(frame.given[shape])
    first = {i: x.parts[0] for i, x in matrix.items() if isinstance(x, Truncated)}
    leading = {index: x for index, x in first.items() if not x.is_zero}
    if determinant(frame.field, leading, n).is_zero:
        raise CoframeError(
            f"expected a frame that is regular at {symbol} = 0, got one whose {shape} is singular "
            f"there. Choose another parameter, or rescale it so that {symbol} = 0 is a frame."
        )
    matrices = {shape: matrix, "eta": {i: series.raised(x) for i, x in frame.given["eta"].items()}}
    if shape == "metric":
        # Signs are taken at zero.
        points = ({**x, symbol: sp.S.Zero} for x in frame.field.sample.places.points())
        signs = tuple(int(frame.eta[i, i]) for i in range(n))
        rows, squares, eta = orthonormal_rows(field, matrix, n, points, signs)
        matrices |= {"rows": rows, "squares": squares, "eta": eta}
    elif shape == "legs":
        matrices["coframe"] = inverse(field, matrix, n)
    return _filled(frame, field, matrices, (expanded, (frame, symbol, order)))


def again(whole: Frame, series: Frame) -> Frame:
    """A frame made from the whole of an expanded one, expanded as this one was."""
    _, symbol, order = cast("tuple[Frame, sp.Symbol, int]", series._plain[1])
    return expanded(whole, symbol, order)


def whole_of(frame: Frame) -> Frame:
    """The exact frame that was expanded; an exact frame is its own."""
    if not isinstance(frame.field, TruncatedField):
        return frame
    return cast("tuple[Frame, sp.Symbol, int]", frame._plain[1])[0]


@derived
def background(frame: Frame) -> Frame:
    """The frame at order zero of an expanded frame."""
    series = frame.field
    if not isinstance(series, TruncatedField):
        raise ArgumentError(
            f"expected a tensor over an expanded frame, got one over {frame.name or 'a frame'} "
            "without a small parameter. Make one with frame.expanded(symbol, order)."
        )
    matrices = {
        name: {i: x for i, x in _at_order(matrix, 0).items() if not x.is_zero}
        for name, matrix in frame.given.items()
    }
    return _filled(frame, series.base, matrices, (background, (frame,)))


def _at_order(entries: Entries, k: int) -> dict[tuple[int, int], Element]:
    return {i: x.parts[k] for i, x in entries.items() if isinstance(x, Truncated)}


def _filled(frame: Frame, field: Field, given: dict, plain: tuple) -> Frame:
    """A frame over another field with the symbols and the domain of a given one."""
    opened = validation.Opened(
        frame.coordinates, frame.parameters, frame.domain, frame.complex, field
    )
    filled = object.__new__(type(frame))
    filled.fill(opened, frame.name, given, plain)
    return filled


def coefficient(tensor: Tensor, order: object) -> Tensor:
    """See Tensor.order."""
    frame = background(tensor.frame)
    series = tensor.frame.field
    assert isinstance(series, TruncatedField)
    k = checks.count(order, "order", ArgumentError, 0, series.order)

    def part(_: object, value: Element) -> Element:
        assert isinstance(value, Truncated)
        return value.parts[k]

    components = tensor.components.mapped(frame.field, part)
    return Tensor(
        frame,
        tensor.slots,
        components,
        tensor.symmetry,
        tensor.symbol,
        f"{tensor.name} at order {k}".strip(),
        tensor.anchored,
        tensor.writing,
    )
