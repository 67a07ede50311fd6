"""Forms: the coframe and its exact curl as NumPy functions, compiled once per frame."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.codegen import numpy_function
from geomtorsion.errors import LoopError, MissingValueError, UnknownNameError
from geomtorsion.exact import Element
from geomtorsion.exact.form import Sum, form

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame

Values = Callable[..., np.ndarray]


@dataclass(frozen=True, eq=False)
class Compiled:
    """Some elements of a frame as one function.

    function: from coordinates, then parameters, to values of shape (entries, k).
    rows: frame index of each entry; columns: coordinate, or place of the pair of coordinates.
    gather: matrix of zeros and ones, shape (n, entries), that sums entries of one row.
    """

    function: Values
    rows: np.ndarray
    columns: np.ndarray
    gather: np.ndarray


@dataclass(frozen=True, eq=False)
class Forms:
    """What loops need of a frame.

    coframe: e^i_mu. curl: (de)^i_{mn} = d_m e^i_n - d_n e^i_m for m < n; None if it vanishes.
    poles: function of what may vanish in a denominator of the coframe, or None.
    pole_names: the same as text.
    parameters: the symbols beside the coordinates that need values.
    pairs: m and n of each pair m < n, shape (2, n (n - 1) / 2).
    """

    coframe: Compiled
    curl: Compiled | None
    poles: Values | None
    pole_names: tuple[str, ...]
    parameters: tuple[sp.Symbol, ...]
    pairs: np.ndarray


def forms(frame: Frame) -> Forms:
    """The compiled forms of a frame, made on first use and then kept."""
    return frame.derived("loop forms", lambda: _made(frame))


def _made(frame: Frame) -> Forms:
    """Compile coframe and curl."""

    n = frame.dimension
    if n < 2:
        raise LoopError("a loop needs at least two coordinates; this frame has one.")
    entries = dict(frame.coframe.components.nonzero)
    needed = {symbol for element in entries.values() for symbol in element.symbols}
    parameters = tuple(s for s in frame.field.symbols if s in needed - set(frame.coordinates))
    arguments = [*frame.coordinates, *parameters]
    pairs = np.array(np.triu_indices(n, 1))
    curls = {
        (i, place): value
        for place, (a, b) in enumerate(pairs.T.tolist())
        for i in range(n)
        if (value := curl(frame, i, a, b)).is_zero is not True
    }
    poles = _denominators(frame, list(entries.values()))
    return Forms(
        coframe=_compiled(entries, arguments, n),
        curl=_compiled(curls, arguments, n) if curls else None,
        poles=numpy_function(poles, arguments, check=False) if poles else None,
        pole_names=tuple(map(str, poles)),
        parameters=parameters,
        pairs=pairs,
    )


def curl(frame: Frame, i: int, a: int, b: int) -> Element:
    """d_a e^i_b - d_b e^i_a, exactly."""
    one = frame.coframe.element(i, b).diff(frame.coordinates[a])
    two = frame.coframe.element(i, a).diff(frame.coordinates[b])
    return frame.field.sum([(1, one), (-1, two)])


def _compiled(
    entries: Mapping[tuple[int, ...], Element], arguments: Sequence[sp.Symbol], n: int
) -> Compiled:
    """Entries (row, column) -> element as one function."""

    unknown = sorted({str(f) for x in entries.values() for f in x.sympy.atoms(AppliedUndef)})
    if unknown:
        raise MissingValueError(
            f"the frame contains unknown functions ({', '.join(unknown)}), but loops need numbers: "
            "make a frame with definite functions in their place."
        )
    function = numpy_function(list(entries.values()), arguments)
    rows, columns = np.array(list(entries)).T
    gather = (rows == np.arange(n)[:, None]).astype(float)
    return Compiled(function, rows, columns, gather)


def _denominators(frame: Frame, elements: Sequence[Element]) -> list[Element]:
    """Whatever stands in a denominator and depends on a coordinate."""
    field = frame.field
    found: dict[str, Element] = {}
    for element in elements:
        for base, exponent in form(element).powers:
            if exponent > 0:
                continue
            if isinstance(base, Sum):
                terms = [
                    (value, *(field.generator_element(g) ** e for g, e in monomial))
                    for value, monomial in base.terms
                ]
                factor = field.sum(terms)
            else:
                factor = field.generator_element(base)
            if factor.symbols & set(frame.coordinates):
                found[str(factor)] = factor
    return list(found.values())


def parameter_values(
    frame: Frame, wanted: Sequence[sp.Symbol], given: Mapping[Any, Any] | None
) -> tuple[float | complex, ...]:
    """The numbers of the parameters that are wanted, in order.

    Raises
    ------
    MissingValueError
        A parameter has no value.
    UnknownNameError
        A name means nothing to this frame.
    """
    table: dict[str, Any] = {}
    known = {symbol.name for symbol in frame.field.symbols}
    for key, value in (given or {}).items():
        name = key if isinstance(key, str) else getattr(key, "name", str(key))
        if name not in known or name in {symbol.name for symbol in frame.coordinates}:
            names = [s.name for s in frame.field.symbols if s not in frame.coordinates]
            raise UnknownNameError(
                f"{name} is no parameter of this frame. Parameters are: "
                f"{', '.join(names) or 'none'}."
            )
        table[name] = value
    missing = [symbol.name for symbol in wanted if symbol.name not in table]
    if missing:
        raise MissingValueError(
            f"the frame contains {', '.join(missing)}: give values, "
            f"parameters={{{', '.join(f'{name!r}: ...' for name in missing)}}}."
        )
    return tuple(_number(table[symbol.name], symbol.name) for symbol in wanted)


def _number(value: Any, name: str) -> float | complex:
    """A finite number for a parameter."""
    try:
        result: complex = complex(value)
    except (TypeError, ValueError):
        raise LoopError(f"parameter {name}: a number was needed, but {value!r} came.") from None
    if not abs(result) < float("inf"):
        raise LoopError(f"parameter {name}: a finite number was needed, but {value!r} came.")
    return result if result.imag else result.real
