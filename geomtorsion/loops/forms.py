"""Forms: the coframe and its exact curl as NumPy functions, compiled once per frame."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.codegen import numpy_function
from geomtorsion.errors import (
    LoopError,
    MissingValueError,
    SingularPointError,
    UnknownNameError,
)
from geomtorsion.exact import Element, unknown_functions
from geomtorsion.exact.form import form, of_factor
from geomtorsion.geometry.derived import derived
from geomtorsion.loops.arcs import Parameters, shown
from geomtorsion.loops.chains import pairs_of
from geomtorsion.loops.defect_lines import Lines
from geomtorsion.loops.quadrature import ROUNDING
from geomtorsion.loops.validation import VALUES
from geomtorsion.support import checks
from geomtorsion.support.precision import EXACT_BITS

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame

Values = Callable[..., np.ndarray]
# Functions u -> f(u) that are nearly constant far from u = 0.
STEEP = (sp.exp, sp.atan, sp.tanh, sp.erf)


@dataclass(frozen=True, eq=False)
class Form:
    """Some components of a one-form (coframe) or two-form (its curl) with values in the frame.

    function: from coordinates, then parameters, to values of shape (entries, k).
    rows: frame index of each entry; columns: coordinate, or place of the pair of coordinates.
    gather: matrix of zeros and ones, shape (n, entries), that sums entries of one row.
    components: the same for each column by itself, shape (n, columns, entries).
    numbers: values of the parameters.
    refuse: the same function, that raises SingularPointError where a value is not finite.
    """

    function: Values
    rows: np.ndarray
    columns: np.ndarray
    gather: np.ndarray
    components: np.ndarray
    refuse: Callable[[], Values]
    numbers: tuple[float | complex, ...] = ()

    def values(self, points: np.ndarray) -> np.ndarray:
        """Entries at points of shape (n, k), shape (entries, k); finite or not."""
        return self.function(*points, *self.numbers)

    def at(self, points: np.ndarray) -> np.ndarray:
        """Entries at points, shape (entries, k).

        Raises
        ------
        SingularPointError
            An entry is not finite; the message names the entry and the point.
        """
        entries = self.values(points)
        return entries if np.isfinite(entries).all() else self.refuse()(*points, *self.numbers)

    def along(self, values: np.ndarray, slopes: np.ndarray) -> np.ndarray:
        """e^i_mu dq^mu/ds of a one-form, from its entries and from slopes, shape (n, k) each."""
        return self.gather @ (values * slopes[self.columns])

    def noise(self, points: np.ndarray, values: np.ndarray, centre: np.ndarray) -> np.ndarray:
        """How far rounding of the coordinates and of the evaluation may move the entries there."""
        near = perturbed(points, centre)
        moved = self.values(near)
        if not np.isfinite(moved).all():
            # Such as sinh(x)/cosh(x) at 1000, which the exact function evaluates.
            with suppress(SingularPointError):
                moved = self.at(near)
        return np.abs(moved - values) + ROUNDING * np.abs(values)


def perturbed(points: np.ndarray, centre: np.ndarray | float = 0.0) -> np.ndarray:
    """Points a few roundings away: what a form changes by there is what rounding does to it.

    centre: from which the points were computed; near the origin, its digits
        determine the rounding error.
    """
    up = np.arange(points.size).reshape(points.shape) * 7 % 3 == 1
    scale = np.maximum(np.abs(points), np.abs(centre))
    return points + scale * np.where(up, ROUNDING, -ROUNDING)


@dataclass(frozen=True, eq=False)
class Forms:
    """One-forms and curl of a frame for integrals along loops.

    coframe: e^i_mu. curl: (de)^i_{mn} = d_m e^i_n - d_n e^i_m for m < n; None if it vanishes.
    poles: what may vanish in a denominator of the coframe, or None.
    parameters: the symbols other than coordinates that need values; numbers: their values.
    pairs: m and n of each pair m < n, shape (2, n (n - 1) / 2).
    constants: denominators of the coframe that contain only parameters.
    """

    coframe: Form
    curl: Form | None
    poles: Poles | None
    parameters: tuple[sp.Symbol, ...]
    pairs: np.ndarray
    numbers: tuple[float | complex, ...] = ()
    constants: tuple[Element, ...] = ()


@dataclass(frozen=True, eq=False)
class Poles:
    """Denominators, at whose zeros forms have no finite values.

    function: from coordinates, then parameters, to their values, shape (poles, k).
    names: their expressions as text. owner: the quantity that has no finite value there.
    numbers: values of the parameters.
    single: the same for a single pole, by its number, where that is cheaper.
    sizes: from coordinates and parameters of one point to the sizes of all forms, exactly.
    """

    function: Values
    names: tuple[str, ...]
    owner: str = "coframe"
    numbers: tuple[float | complex, ...] = ()
    single: Callable[..., np.ndarray] | None = None
    sizes: Callable[..., np.ndarray] | None = None

    def grows(self, far: np.ndarray, near: np.ndarray) -> bool:
        """Whether a form becomes larger from one point, of shape (n,), to another near a zero.

        Roots in a denominator are cleared by factors of which the numerator has the same: where
        those vanish nothing happens.
        """
        if self.sizes is None:
            return True
        try:
            far_sizes, near_sizes = (self.sizes(*point, *self.numbers) for point in (far, near))
        except (ArithmeticError, TypeError):
            return True
        return bool((near_sizes > 2 * far_sizes).any())

    def values(self, points: np.ndarray) -> np.ndarray:
        """All denominators at points of shape (n, k), shape (poles, k)."""
        return self.function(*points, *self.numbers)

    def one(self, number: int, points: np.ndarray) -> np.ndarray:
        """One denominator at points, shape (k,)."""
        if self.single is None:
            return self.values(points)[number]
        return self.single(number, *points, *self.numbers)


def forms(
    frame: Frame, parameters: Parameters | None, columns: tuple[int, ...] | None = None
) -> Forms:
    """The compiled one-forms of a frame, kept after first use, with values for its parameters.

    Parameters
    ----------
    columns
        Coordinates along which loops run at all; all of them if not given.

    Raises
    ------
    LoopError
        The frame has one coordinate only, or a parameter is not a finite number.
    MissingValueError
        A parameter has no value.
    UnknownNameError
        The frame has no parameter of this name.
    CoordinateError
        A value contradicts the assumptions of its parameter.
    SingularPointError
        The coframe has no finite value anywhere, for these parameters.
    """
    chosen = tuple(range(frame.dimension)) if columns is None else columns
    compiled = _compiled(frame, chosen)
    numbers = parameter_values(frame, compiled.parameters, parameters)
    refuse_parameters(compiled.constants, parameters)
    if not numbers:
        return compiled
    curl_ = compiled.curl and replace(compiled.curl, numbers=numbers)
    coframe = replace(compiled.coframe, numbers=numbers)
    poles = compiled.poles and replace(compiled.poles, numbers=numbers)
    return replace(compiled, coframe=coframe, curl=curl_, poles=poles, numbers=numbers)


@derived
def _compiled(frame: Frame, chosen: tuple[int, ...]) -> Forms:
    """Compile coframe and curl."""
    n = frame.dimension
    if n < 2:
        raise LoopError("a loop needs at least two coordinates; this frame has one.")
    if isinstance(frame.given, Lines):
        return _of_lines(frame.given, chosen)
    every = frame.coframe.components.nonzero.items()
    entries = {(i, mu): value for (i, mu), value in every if mu in chosen}
    needed = {symbol for element in entries.values() for symbol in element.symbols}
    parameters = tuple(s for s in frame.field.symbols if s in needed - set(frame.coordinates))
    arguments = [*frame.coordinates, *parameters]
    pairs = pairs_of(n)
    curls = {
        (i, place): value
        for place, (a, b) in enumerate(pairs.T.tolist())
        if a in chosen and b in chosen
        for i in range(n)
        if (value := curl(frame, i, a, b)).is_zero is not True
    }
    return Forms(
        coframe=_form(entries, arguments, n, n),
        curl=_form(curls, arguments, n, pairs.shape[1]) if curls else None,
        poles=poles_of(frame, list(entries.values()), arguments),
        parameters=parameters,
        pairs=pairs,
        constants=constant_poles(frame, list(entries.values())),
    )


def _of_lines(lines: Lines, chosen: tuple[int, ...]) -> Forms:
    """The forms of a frame of parallel lines, whose torsion vanishes off them."""
    entries = [(i, mu) for i, mu in lines.rows if mu in chosen]
    finite = partial(lines.coframe, entries)

    def checked(*arguments: np.ndarray) -> np.ndarray:
        values = finite(*arguments)
        bad = np.flatnonzero(~np.isfinite(values).all(axis=0))
        if len(bad):
            point = shown(float(x[bad[0]]) for x in arguments[:3])
            raise SingularPointError(
                f"the coframe has no finite value at {point}: a line runs through it. Move the "
                "point away from the line."
            )
        return values

    rows, columns = np.array(entries).T
    gather = (rows == np.arange(3)[:, None]).astype(float)
    components = gather[:, None, :] * (columns == np.arange(3)[:, None])
    poles = Poles(lines.squares, lines.names, single=lines.square) if lines.places else None
    form = Form(finite, rows, columns, gather, components, lambda: checked)
    return Forms(form, None, poles, lines.parameters, pairs_of(3))


def curl(frame: Frame, i: int, a: int, b: int) -> Element:
    """d_a e^i_b - d_b e^i_a, exactly."""
    one = frame.coframe.element(i, b).diff(frame.coordinates[a])
    two = frame.coframe.element(i, a).diff(frame.coordinates[b])
    return frame.field.sum([(1, one), (-1, two)])


def _form(
    entries: Mapping[tuple[int, ...], Element], arguments: Sequence[sp.Symbol], n: int, width: int
) -> Form:
    """Entries (row, column) -> element as one function."""
    unknown = [str(function) for function in unknown_functions(entries.values())]
    if unknown:
        raise MissingValueError(
            f"the frame contains unknown functions ({', '.join(unknown)}), but loops need numbers: "
            "make a frame with explicit functions instead."
        )
    elements = list(entries.values())
    function = numpy_function(elements, arguments, check=False)
    rows, columns = np.array(list(entries)).T
    gather = (rows == np.arange(n)[:, None]).astype(float)
    components = gather[:, None, :] * (columns == np.arange(width)[:, None])
    refuse = cache(lambda: numpy_function(elements, arguments))
    return Form(function, rows, columns, gather, components, refuse)


def poles_of(
    frame: Frame,
    elements: Sequence[Element],
    arguments: Sequence[sp.Symbol],
    owner: str = "coframe",
) -> Poles | None:
    """Factors in denominators of the elements that depend on a coordinate, and narrow peaks."""
    coordinates = set(frame.coordinates)
    peaks, denominators = (
        {k: x for k, x in every.items() if x.symbols & coordinates}
        for every in (_arguments(frame, elements), _denominators(frame, elements))
    )
    if not peaks and not denominators:
        return None

    def sizes(*values: float) -> np.ndarray:
        point, levels = dict(zip(arguments, values, strict=True)), {}
        return np.array([float(abs(x.evaluate(point, EXACT_BITS, levels))) for x in elements])

    factors = [*peaks.values(), *denominators.values()]
    plain = numpy_function(factors, arguments, check=False)

    def rooted(*values: np.ndarray) -> np.ndarray:
        rows = plain(*values)
        rows[: len(peaks)] = np.sqrt(np.hypot(1.0, np.abs(rows[: len(peaks)])))
        return rows

    names = (*(f"sqrt(1 + |{u}|)" for u in peaks), *denominators)
    return Poles(rooted if peaks else plain, names, owner, sizes=sizes)


def _denominators(frame: Frame, elements: Sequence[Element]) -> dict[str, Element]:
    """The factors of all denominators, each once, by their text."""
    field = frame.field
    denominators: dict[str, Element] = {}
    for element in elements:
        for base, exponent in form(element).powers:
            if exponent < 0:
                factor = of_factor(field, base)
                denominators[str(factor)] = factor
    return denominators


def _arguments(frame: Frame, elements: Sequence[Element]) -> dict[str, Element]:
    """Real arguments u of functions that change near u = 0 only, each once, by their text.

    (1 + u^2)^(1/4) is small where such a function changes, as a denominator is near a pole.
    """
    found = {function.args[0] for x in elements for function in x.sympy.atoms(*STEEP)}
    real = [u for u in found if not u.has(sp.I) and not u.atoms(AppliedUndef)]
    return {str(u): frame.field.read(u) for u in sorted(real, key=str)}


def constant_poles(frame: Frame, elements: Sequence[Element]) -> tuple[Element, ...]:
    """Factors of denominators that contain only parameters, and vanish everywhere if at all."""
    coordinates = set(frame.coordinates)
    denominators = _denominators(frame, elements).values()
    return tuple(x for x in denominators if x.symbols and not x.symbols & coordinates)


def refuse_parameters(poles: Sequence[Element], parameters: Parameters | None) -> None:
    """Refuse values at which a denominator vanishes, whatever the coordinates.

    Raises
    ------
    SingularPointError
        One does; the message names it.
    """
    if not poles:
        return
    by_name = {str(key): value for key, value in (parameters or {}).items()}
    for pole in poles:
        if any(symbol.name not in by_name for symbol in pole.symbols):
            continue
        here = {symbol: by_name[symbol.name] for symbol in pole.symbols}
        if not pole.evaluate(here):
            values = ", ".join(f"{name} = {value}" for name, value in sorted(here.items(), key=str))
            raise SingularPointError(
                f"parameters: {pole} vanishes at {values}, and the coframe has no finite value "
                "anywhere. Give another value, or a frame that is made for this one (its limit)."
            )


def parameter_values(
    frame: Frame, wanted: Sequence[sp.Symbol], given: Parameters | None
) -> tuple[float | complex, ...]:
    """The numbers of the parameters that are wanted, in order.

    Raises
    ------
    MissingValueError
        A parameter has no value.
    UnknownNameError
        The frame has no parameter of this name.
    CoordinateError
        A value contradicts the assumptions of its parameter.
    """
    table = checks.by_name(given, "parameters", UnknownNameError)
    refuse_unknown(frame, table)
    numbers = {name: _number(value, name) for name, value in table.items()}
    for symbol in frame.field.symbols:
        if symbol.name in table:
            checks.check_declared(symbol, table[symbol.name])
    names = [symbol.name for symbol in wanted]
    checks.check_values(names, table, "parameters", MissingValueError, VALUES)
    return tuple(numbers[symbol.name] for symbol in wanted)


def refuse_unknown(frame: Frame, names: Iterable[str]) -> None:
    """Refuse names that are not parameters of a frame.

    Raises
    ------
    UnknownNameError
        A name is not; the message lists the parameters.
    """
    symbol_names = [s.name for s in frame.field.symbols if s not in frame.coordinates]
    kind = "a parameter of this frame"
    for name in names:
        checks.known_name(name, symbol_names, "parameters", UnknownNameError, expected=kind)


def _number(value: object, name: str) -> float | complex:
    """A finite number for a parameter, complex if it has an imaginary part."""
    number = checks.plain(value)
    where = f"parameter {name}"
    if isinstance(number, sp.Expr) and number.is_number and number.is_real is False:
        number = complex(number)
    if not isinstance(number, complex):
        return checks.number(number, where, LoopError)
    checks.number(abs(number), where, LoopError)
    return number if number.imag else number.real
