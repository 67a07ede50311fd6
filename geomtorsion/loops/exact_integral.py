"""Exact integral: the Burgers vector of a loop in closed form, checked by numbers."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product

import mpmath
import numpy as np
import sympy as sp

from geomtorsion import checks
from geomtorsion.checks import expression as expression_of
from geomtorsion.conventions import burgers
from geomtorsion.errors import (
    LoopError,
    MissingValueError,
    SingularPointError,
    UndecidedError,
)
from geomtorsion.geometry import Frame
from geomtorsion.loops.arcs import Arc, Curve, Ellipse, Parameters, Part, exact_number
from geomtorsion.loops.closed_forms import OutOfTimeError, deadline, definite
from geomtorsion.loops.defects import find_defects
from geomtorsion.loops.forms import forms
from geomtorsion.loops.integrals import refuse_other_periods
from geomtorsion.loops.loop import Loop, check_loop
from geomtorsion.loops.poles import refuse_poles
from geomtorsion.precision import working_digits

# The closed form is compared with a numerical integral to this many digits.
DIGITS = np.finfo(float).precision
# Symbols are tried at so many times their sample values: what is small once is large then.
SCALES = (sp.Rational(1, 64), sp.Integer(64))
Piece = tuple[tuple[sp.Expr, ...], sp.Symbol, sp.Expr, sp.Expr]


@dataclass(frozen=True, eq=False, repr=False)
class ExactBurgersVector:
    """The Burgers vector of one loop in closed form, frame components.

    frame, loop: what it belongs to.
    vector: b^i, exact expressions in the parameters of frame and loop.
    checked_at: where it was compared with a numerical integral, to 15 digits.
    seconds: wall time.
    """

    frame: Frame
    loop: Loop
    vector: tuple[sp.Expr, ...]
    checked_at: Mapping[sp.Symbol, sp.Expr]
    seconds: float

    def at(self, values: Parameters | None = None) -> np.ndarray:
        """Numbers for given parameters, shape (n,).

        Raises
        ------
        MissingValueError
            A symbol has no value.
        SingularPointError
            The closed form has no finite value there.
        """
        names = checks.by_name(values, "values", LoopError)
        table = {}
        for symbol in sp.Tuple(*self.vector).free_symbols:
            if symbol.name not in names:
                raise MissingValueError(f"{symbol} has no value: give {{{symbol.name!r}: ...}}.")
            table[symbol] = exact_number(names[symbol.name])
        numbers = [complex(x.subs(table).evalf(17)) for x in self.vector]
        if not np.isfinite(numbers).all():
            where = ", ".join(f"{symbol} = {value}" for symbol, value in table.items())
            raise SingularPointError(
                f"the closed form has no finite value at {where}: {checks.shown(self)}. Take its "
                "limit with sympy, or a frame that is made for these values."
            )
        is_complex = any(x.imag for x in numbers)
        return np.array(numbers if is_complex else [x.real for x in numbers])

    def in_convention(self, name: str) -> tuple[sp.Expr, ...]:
        """The vector in another convention of sign, such as "FS/RH"; see `conventions.burgers`."""
        return tuple(burgers(self.vector, name))

    def __repr__(self) -> str:
        return f"ExactBurgersVector([{', '.join(map(str, self.vector))}])"

    def _repr_latex_(self) -> str:
        return f"$b = {sp.latex(sp.Matrix(self.vector))}$"


def exact_burgers_vector(frame: Frame, loop: Loop, seconds: float = 20.0) -> ExactBurgersVector:
    """Burgers vector of a loop in closed form.

    The pulled-back one-forms are integrated over every arc: constants, polynomials, trigonometric
    polynomials and waves of them (Bessel functions), rational functions on the circle, and what
    sympy can integrate. The result is compared with a numerical integral before it is given.
    Decimal numbers in the loop count as what they say: 0.3 is 3/10.

    Raises
    ------
    BranchError
        The loop goes where a root of the coframe has not the sign with which it was read.
    SingularPointError
        The loop passes through a point where the coframe is singular.
    UndecidedError
        No closed form was found within the time, or it does not agree with the numbers.
    LoopError
        The loop is known by numbers only (a spline), or has another dimension than the frame.

    Examples
    --------
    >>> from geomtorsion.geometry import Frame
    >>> r = sp.Symbol("R", positive=True)
    >>> x, y, z = sp.symbols("x y z")
    >>> frame = Frame([x, y, z], [[1, 0, 0], [0, 1, 0], [-y / 2, x / 2, 1]])
    >>> exact_burgers_vector(frame, Loop.circle([0, 0, 0], r)).vector
    (0, 0, pi*R**2)
    """
    start = time.perf_counter()
    checks.instance(frame, Frame, "frame")
    check_loop(loop, frame.dimension)
    checks.positive(seconds, "seconds", LoopError)
    total = [sp.S.Zero] * frame.dimension
    where = _sample(frame, loop)
    _refuse_poles(frame, loop, where)
    _refuse_other_windings(frame, loop, where)
    numbers = [mpmath.mpf(0)] * frame.dimension
    try:
        with deadline(seconds):
            for times, piece in pieces(loop):
                for i, f in enumerate(pulled_back(frame, piece)):
                    value = definite(f, *piece[1:])
                    if value is None:
                        raise UndecidedError(
                            f"b^{i} of this loop has no closed form that is known here: the "
                            f"integrand is {f}. Ask for numbers, without exact=True."
                        )
                    total[i] += times * value
                    numbers[i] += times * _number(f, piece, where)
            vector = tuple(_short(x) for x in total)
    except OutOfTimeError:
        raise UndecidedError(
            f"no closed form was found in {seconds:g} s. Ask for numbers, without exact=True."
        ) from None
    _verify(vector, numbers, where)
    return ExactBurgersVector(frame, loop, vector, where, time.perf_counter() - start)


def _refuse_poles(frame: Frame, loop: Loop, where: Mapping[sp.Symbol, sp.Expr]) -> None:
    """Refuse a loop through a pole: of what sympy gives there, half may be missing."""
    known = {s.name: v for s, v in where.items() if s in frame.field.symbols}
    for part in (loop.at(where) if loop.symbols else loop).parts:
        if part.gap:
            refuse_other_periods(forms(frame, known), part)
    try:
        found = forms(frame, known)
    except MissingValueError:
        # Unknown functions have no numbers, and so no poles that could be looked for.
        return
    here = loop.at(where) if loop.symbols else loop
    for part in here.parts:
        refuse_poles(found.poles, part)
    if frame.field.relied_on:
        # Raises where a root has not the sign with which it was read.
        found.coframe.at(here.points())


def _refuse_other_windings(frame: Frame, loop: Loop, where: Mapping[sp.Symbol, sp.Expr]) -> None:
    """Refuse a loop that encloses a line for some values of the symbols and not for others."""
    lines = [one for one in find_defects(frame) if one.across is not None]
    symbols = loop.symbols | {
        s for one in lines for x in one.point for s in expression_of(x).free_symbols
    }
    if not symbols or not lines or loop.gap.any():
        return
    found: dict[object, list[int]] = {one: [] for one in lines}
    # One symbol after the other, since two that change together may keep their ratio.
    for symbol, scale in [(None, sp.S.One), *product(sorted(symbols, key=str), SCALES)]:
        values = {s: x * scale if s == symbol else x for s, x in where.items()}
        here = loop.at(values) if loop.symbols else loop
        for one in lines:
            try:
                found[one].append(one.winding(here, values))
            except SingularPointError:
                # This sample meets the line; the others tell.
                continue
    for one, turns in found.items():
        if len(set(turns)) > 1:
            names = ", ".join(sorted(map(str, symbols)))
            raise UndecidedError(
                f"how often the loop winds round the {one} depends on {names}: no one closed form "
                "holds for all values. Give numbers for what decides it."
            )


def _short(x: sp.Expr) -> sp.Expr:
    """The shorter of an expression and its simplification."""
    return min((x, sp.simplify(x)), key=sp.count_ops)


def pieces(loop: Loop) -> Iterator[tuple[int, Piece]]:
    """Exact paths (coordinates, parameter, start, end) with their multiplicities."""
    for part in loop.parts:
        if part.given is None:
            raise LoopError(
                f"{loop.name}: this loop is known by numbers only, it has no closed form. "
                "Give a circle, ellipse, polygon or exact expressions."
            )
        for arc in part.arcs:
            yield part.times, _piece(part, arc)


def _piece(part: Part, arc: Arc) -> Piece:
    """Coordinates along one arc as exact expressions."""
    assert part.given is not None
    centre, size = part.given
    t = sp.Dummy("t", real=True)
    if isinstance(arc, Ellipse):
        offsets, low, high = arc.exact(t / (2 * sp.pi)), sp.S.Zero, 2 * sp.pi
    elif isinstance(arc, Curve):
        offsets = tuple(x.subs(arc.parameter, t) for x in arc.expressions)
        low, high = arc.start, arc.end
    else:
        offsets, low, high = arc.exact(t), sp.S.Zero, sp.S.One
    pairs = zip(centre, offsets, strict=True)
    return tuple(exact_number(q) + exact_number(size) * x for q, x in pairs), t, low, high


def pulled_back(frame: Frame, piece: Piece) -> list[sp.Expr]:
    """e^i_mu(q(t)) dq^mu/dt for all i."""
    path, t = piece[:2]
    table = dict(zip(frame.coordinates, path, strict=True))
    slopes = [x.diff(t) for x in path]
    result = [sp.S.Zero] * frame.dimension
    for (i, mu), value in frame.coframe.nonzero().items():
        if slopes[mu] != 0:
            result[i] += value.subs(table, simultaneous=True) * slopes[mu]
    return result


def _sample(frame: Frame, loop: Loop) -> dict[sp.Symbol, sp.Expr]:
    """Values of all parameters for the numerical check."""
    known = {s: v for s, v in frame.sample_point.items() if s not in frame.coordinates}
    others = sorted(loop.symbols - set(known), key=str)
    return known | {s: sp.Rational(7 + 4 * k, 19) for k, s in enumerate(others)}


def _number(f: sp.Expr, piece: Piece, where: Mapping[sp.Symbol, sp.Expr]) -> mpmath.mpf:
    """The integral of f by quadrature at the sample values."""
    _, t, low, high = piece
    if f == 0:
        return mpmath.mpf(0)
    function = sp.lambdify(t, f.subs(where), "mpmath")
    with working_digits(DIGITS + 10):
        bounds = [mpmath.mpmathify(expression_of(x).subs(where).evalf(40)) for x in (low, high)]
        panels = mpmath.linspace(*bounds, 9)
        return mpmath.quad(function, panels)


def _verify(
    vector: tuple[sp.Expr, ...], numbers: list[mpmath.mpf], where: Mapping[sp.Symbol, sp.Expr]
) -> None:
    """Refuse a closed form that is not what the numbers say."""
    for i, (expression, number) in enumerate(zip(vector, numbers, strict=True)):
        value = mpmath.mpmathify(expression.subs(where).evalf(DIGITS + 10))
        if not abs(value - number) <= mpmath.mpf(10) ** -DIGITS * (1 + abs(number)):
            raise UndecidedError(
                f"the closed form {expression} for b^{i} was found, but it is {mpmath.nstr(value)} "
                f"where the integral is {mpmath.nstr(number)}. Ask for numbers, without exact=True."
            )
