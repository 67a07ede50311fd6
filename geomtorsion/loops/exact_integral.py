"""Exact integral: the Burgers vector of a loop in closed form, checked by a proved integral."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import comb

import numpy as np
import sympy as sp
from flint import acb, arb

from geomtorsion.codegen import graph
from geomtorsion.codegen.balls import BallCode, exact_ball, integral
from geomtorsion.conventions import burgers
from geomtorsion.errors import (
    AllowanceError,
    ChartEdgeError,
    ExpressionError,
    LimitError,
    LoopError,
    MissingValueError,
    SingularPointError,
    UndecidedError,
)
from geomtorsion.exact import Field
from geomtorsion.exact.integration import integrated
from geomtorsion.geometry import Frame
from geomtorsion.geometry.connections import FrameLike, as_frame
from geomtorsion.geometry.real_points import RealPoints
from geomtorsion.loops.arcs import Arc, Curve, Ellipse, Parameters, Part, exact_number
from geomtorsion.loops.defects import find_defects
from geomtorsion.loops.domain import refuse_numbers_outside
from geomtorsion.loops.forms import forms
from geomtorsion.loops.integrals import refuse_other_periods
from geomtorsion.loops.loop import Loop, check_loop
from geomtorsion.loops.poles import refuse_poles
from geomtorsion.loops.symbol_values import with_values
from geomtorsion.support import checks
from geomtorsion.support.allowance import limits
from geomtorsion.support.checks import expression as expression_of
from geomtorsion.support.displays import drawn_by, latex_of
from geomtorsion.support.exclusive import exclusive
from geomtorsion.support.precision import ball_precision

# A symbol for cos(t) and one for sin(t), once all multiples of t are expanded.
COS, SIN = sp.Symbol("C", real=True), sp.Symbol("S", real=True)
Method = Callable[[sp.Expr, sp.Symbol, sp.Expr, sp.Expr], sp.Expr | None]


def definite(f: sp.Expr, t: sp.Symbol, low: sp.Expr, high: sp.Expr) -> sp.Expr | None:
    """Integral of f over t from low to high, or None if no method here finds a closed form."""
    f = tidy(f, t)
    if not f.has(t):
        return f * (high - low)
    if f.is_polynomial(t):
        return sp.integrate(sp.expand(f), (t, low, high))
    turns = (high - low) / (2 * sp.pi)
    if turns.is_Integer:
        for method in (_bessel, _residues):
            result = method(f, t)
            if result is not None:
                return turns * result
    return integrated(f, t, low, high)


def tidy(f: sp.Expr, t: sp.Symbol) -> sp.Expr:
    """The same function over a common basis of angles, if the field can read it."""
    f = f.replace(_is_shifted, lambda wave: _split(wave, t))
    # cos(3/10) and cos(1) stay what they are: their common basis would be cos(1/10).
    constants = [x for x in f.atoms(sp.cos, sp.sin) if not x.free_symbols]
    names = {x: sp.Dummy(f"k{k}", real=True) for k, x in enumerate(constants)}
    plain = f.subs(names)
    try:
        rewritten = Field([t, *sorted(plain.free_symbols - {t}, key=str)]).read(plain).sympy
    except (ExpressionError, LimitError, ZeroDivisionError):
        rewritten = plain
    return rewritten.subs({name: x for x, name in names.items()})


def _is_shifted(x: sp.Expr) -> bool:
    """Whether this is the sine or cosine of a sum."""
    return isinstance(x, sp.cos | sp.sin) and x.args[0].is_Add


def _split(wave: sp.Expr, t: sp.Symbol) -> sp.Expr:
    """cos(a + b) and sin(a + b) by the addition theorem, a free of t."""
    a, b = wave.args[0].as_independent(t, as_Add=True)
    if isinstance(wave, sp.cos):
        return sp.cos(a) * sp.cos(b) - sp.sin(a) * sp.sin(b)
    return sp.sin(a) * sp.cos(b) + sp.cos(a) * sp.sin(b)


def _in_circle(f: sp.Expr, t: sp.Symbol) -> sp.Expr | None:
    """f with symbols for cos(t) and sin(t), None if t occurs in other ways."""
    waves = [x for x in f.atoms(sp.cos, sp.sin) if x.args[0].has(t) and x.args[0].is_polynomial(t)]
    replaced = f.subs({x: sp.expand_trig(x) for x in waves})
    replaced = replaced.subs({sp.cos(t): COS, sp.sin(t): SIN})
    return None if replaced.has(t) else replaced


def _bessel(f: sp.Expr, t: sp.Symbol) -> sp.Expr | None:
    """Polynomials in cos t, sin t and waves of a cos t + b sin t, over one turn.

    integral_0^{2 pi} exp(i (a cos t + b sin t)) exp(i n t) dt
        = 2 pi i^n ((a + i b) / r)^n J_n(r),  r^2 = a^2 + b^2                  (Jacobi, Anger)
    """
    on_circle = _in_circle(f, t)
    if on_circle is None:
        return None
    waves = [x for x in on_circle.atoms(sp.cos, sp.sin) if x.has(COS, SIN)]
    flat = on_circle.subs({x: x.rewrite(sp.exp) for x in waves})
    flat = sp.powsimp(sp.expand(flat), combine="exp")
    total: list[sp.Expr] = []
    for term in sp.Add.make_args(sp.expand(flat, power_exp=False)):
        part = _term(term)
        if part is None:
            return None
        total.append(part)
    return _real(sp.Add(*total))


def _term(term: sp.Expr) -> sp.Expr | None:
    """Integral over one turn of constant * C^p * S^q * exp(linear in C and S)."""
    constant, rest = term.as_independent(COS, SIN, as_Add=False)
    p = q = 0
    a = b = sp.S.Zero
    for factor in sp.Mul.make_args(rest):
        base, exponent = factor.as_base_exp()
        if base == COS and exponent.is_Integer and exponent > 0:
            p += int(exponent)
        elif base == SIN and exponent.is_Integer and exponent > 0:
            q += int(exponent)
        elif isinstance(factor, sp.exp) and factor.args[0].is_polynomial(COS, SIN):
            linear = sp.Poly(factor.args[0], COS, SIN)
            if linear.total_degree() > 1:
                return None
            a += linear.coeff_monomial(COS) / sp.I
            b += linear.coeff_monomial(SIN) / sp.I
            constant *= sp.exp(linear.coeff_monomial(1))
        elif factor != 1:
            return None
    if not sp.expand(constant):
        return sp.S.Zero
    r = sp.sqrt(sp.factor(sp.expand(a**2 + b**2)))
    result = sp.S.Zero
    for j, k in product(range(p + 1), range(q + 1)):
        # C^p S^q as a sum of exp(i n t).
        n = p - 2 * j + q - 2 * k
        weight = sp.Rational(comb(p, j) * comb(q, k) * (-1) ** k, 2 ** (p + q)) / sp.I**q
        if r == 0:
            result += weight * (1 if n == 0 else 0)
        else:
            bessel = sp.besselj(abs(n), r) * ((-1) ** abs(n) if n < 0 else 1)
            result += weight * sp.I**n * sp.expand((a + sp.I * b) / r) ** n * bessel
    return 2 * sp.pi * constant * result


def _real(total: sp.Expr) -> sp.Expr:
    """A sum of conjugate pairs, written without I."""
    return sp.factor_terms(sp.expand(sp.expand_trig(sp.expand(total).rewrite(sp.cos))))


@exclusive
def _residues(f: sp.Expr, t: sp.Symbol) -> sp.Expr | None:
    """Rational functions of cos t and sin t with numbers in the denominator, over one turn."""
    on_circle = _in_circle(f, t)
    if on_circle is None or not on_circle.is_rational_function(COS, SIN):
        return None
    z = sp.Symbol("z")
    table = {COS: (z + 1 / z) / 2, SIN: (z - 1 / z) / (2 * sp.I)}
    above, below = sp.fraction(sp.cancel(sp.together(on_circle.subs(table) / (sp.I * z))))
    factor, below = below.as_independent(z, as_Add=False)
    if below.free_symbols - {z}:
        return None
    total = sp.S.Zero
    roots = sp.roots(sp.Poly(below, z))
    if sum(roots.values()) != sp.degree(below, z):
        return None
    for root in roots:
        if abs(complex(root.evalf(30))) < 1:
            total += sp.residue(above / (factor * below), z, root)
    return sp.simplify(sp.radsimp(2 * sp.pi * sp.I * total))


# The closed form is compared with a proved integral to this many digits, with bits to spare.
DIGITS = np.finfo(float).precision
CHECKED_BITS = 2 * np.finfo(float).nmant
# Symbols are tested at these multiples of their sample values, so that small terms become large.
SCALES = (sp.Rational(1, 64), sp.Integer(64))
Piece = tuple[tuple[sp.Expr, ...], sp.Symbol, sp.Expr, sp.Expr]


@dataclass(frozen=True, eq=False, repr=False)
class ExactBurgersVector:
    """The Burgers vector of one loop in closed form, frame components.

    frame, loop: the frame and the loop of the vector.
    vector: b^i, exact expressions in the parameters of frame and loop.
    checked_at: values at which it agrees with a proved integral to 15 digits.
    seconds: wall time.
    """

    frame: Frame
    loop: Loop
    vector: tuple[sp.Expr, ...]
    checked_at: Mapping[sp.Symbol, sp.Expr]
    seconds: float

    @property
    def magnitude(self) -> sp.Expr:
        """Length of the vector, sqrt|eta_ij b^i b^j|."""
        eta, b = sp.Matrix(self.frame.eta.to_sympy().tolist()), sp.Matrix(self.vector)
        return sp.sqrt(sp.Abs((b.T * eta * b)[0]))

    @property
    def error(self) -> sp.Expr:
        """Zero: the vector is exact."""
        return sp.S.Zero

    @exclusive
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
        symbols = sp.Tuple(*self.vector).free_symbols
        remedy = "Give {'{missing}': ...}."
        checks.check_values(
            sorted(s.name for s in symbols), names, "values", MissingValueError, remedy
        )
        table = {symbol: exact_number(names[symbol.name]) for symbol in symbols}
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
        return f"$b = {latex_of(sp.Matrix(self.vector))}$"

    _repr_html_ = drawn_by("notebook_tables", "equations_html")


def exact_burgers_vector(
    frame: FrameLike, loop: Loop, seconds: float = 20.0, *, parameters: Parameters | None = None
) -> ExactBurgersVector:
    """Burgers vector of a loop in closed form.

    The pulled-back one-forms are integrated over every arc: constants, polynomials, trigonometric
    polynomials and waves of them (Bessel functions), rational functions on the circle, and what
    sympy can integrate. The result is compared with a proved integral before it is returned.
    Decimal numbers in the loop are exact: 0.3 is 3/10. If the loop or the domain of the frame has
    symbols without a value, the caller must ensure that the loop is inside the domain: it is
    refused only if it is outside for all tried values.

    Parameters
    ----------
    seconds
        Time limit of the search for a closed form.
    parameters
        Values of parameters of frame and loop, {symbol or name: number}, substituted exactly before
        the integration; parameters without a value stay symbols.

    Raises
    ------
    BranchError
        On the loop a root of the coframe has another sign than it was read with.
    SingularPointError
        The loop passes through a point where the coframe is singular.
    ChartEdgeError
        The loop leaves the declared domain of the frame.
    UndecidedError
        No closed form was found within the time, or it does not agree with the numbers.
    LoopError
        The loop is only known numerically (a spline), or has another dimension than the frame.
    UnknownNameError
        A value is given for a name that neither frame nor loop contains.

    Examples
    --------
    >>> from geomtorsion.geometry import Frame
    >>> r = sp.Symbol("R", positive=True)
    >>> x, y, z = sp.symbols("x y z")
    >>> frame = Frame([x, y, z], [[1, 0, 0], [0, 1, 0], [-y / 2, x / 2, 1]])
    >>> exact_burgers_vector(frame, Loop.circle([0, 0, 0], r)).vector
    (0, 0, pi*R**2)
    >>> exact_burgers_vector(frame, Loop.circle([0, 0, 0], r), parameters={r: 0.3}).vector
    (0, 0, 9*pi/100)
    """
    start = time.perf_counter()
    frame = as_frame(frame)
    check_loop(loop, frame.dimension)
    checks.positive(seconds, "seconds", LoopError)
    frame, loop = with_values(frame, loop, parameters)
    total = [sp.S.Zero] * frame.dimension
    where = sample_of(frame, loop.symbols)
    _refuse_poles(frame, loop, where)
    _refuse_outside(frame, loop, where)
    _refuse_other_windings(frame, loop, where)
    numbers: list[list[acb]] = [[] for _ in range(frame.dimension)]
    try:
        with limits(seconds=seconds):
            for times, piece in pieces(loop):
                for i, f in enumerate(pulled_back(frame, piece)):
                    value = definite(f, *piece[1:])
                    if value is None:
                        raise UndecidedError(
                            f"b^{i} of this loop has no closed form that is known here: the "
                            f"integrand is {f}. For a number use gt.burgers_vector."
                        )
                    total[i] += times * value
                    numbers[i].append(times * _number(f, piece, where))
            vector = tuple(short(x) for x in total)
    except AllowanceError:
        raise UndecidedError(
            f"no closed form was found in {seconds:g} s. For a number use gt.burgers_vector."
        ) from None
    _verify(vector, numbers, where)
    return ExactBurgersVector(frame, loop, vector, where, time.perf_counter() - start)


def _refuse_poles(frame: Frame, loop: Loop, where: Mapping[sp.Symbol, sp.Expr]) -> None:
    """Refuse a loop through a pole: sympy may omit half of its integral."""
    values = {s.name: v for s, v in where.items() if s in frame.field.symbols}
    here = loop.at(where) if loop.symbols else loop
    for part in here.parts:
        if part.gap:
            refuse_other_periods(forms(frame, values), part)
    try:
        compiled = forms(frame, values)
    except MissingValueError:
        # Unknown functions have no numbers, and so no poles that could be looked for.
        return
    for part in here.parts:
        refuse_poles(compiled.poles, part)
    if frame.field.relied_on:
        # Raises where a root has another sign than the sign with which it was read.
        compiled.coframe.at(here.points())


def _refuse_outside(frame: Frame, loop: Loop, where: Mapping[sp.Symbol, sp.Expr]) -> None:
    """Refuse a loop outside the domain; with symbols, where it is outside for all values tried."""
    trials = [dict(where)]
    for symbol, scale in product(sorted(loop.symbols, key=str), SCALES):
        trials.append({**where, symbol: where[symbol] * scale})
    refusal: ChartEdgeError | None = None
    for values in trials:
        try:
            refuse_numbers_outside(frame, loop.at(values).parts if loop.symbols else loop.parts)
        except ChartEdgeError as error:
            refusal = refusal or error
        else:
            return
    if refusal is not None:
        raise refusal


def _refuse_other_windings(frame: Frame, loop: Loop, where: Mapping[sp.Symbol, sp.Expr]) -> None:
    """Refuse a loop that encloses a line for some values of the symbols and not for others."""
    lines = [line for line in find_defects(frame) if line.across is not None]
    symbols = loop.symbols | {
        s for line in lines for x in line.point for s in expression_of(x).free_symbols
    }
    if not symbols or not lines or loop.gap.any():
        return
    windings: dict[object, list[int]] = {line: [] for line in lines}
    # One symbol after the other, since two that change together may keep their ratio.
    for symbol, scale in [(None, sp.S.One), *product(sorted(symbols, key=str), SCALES)]:
        values = {s: x * scale if s == symbol else x for s, x in where.items()}
        here = loop.at(values) if loop.symbols else loop
        for line in lines:
            try:
                windings[line].append(line.winding(here, values))
            except SingularPointError:
                # This sample meets the line; the others decide.
                continue
    for line, turns in windings.items():
        if len(set(turns)) > 1:
            names = ", ".join(sorted(map(str, symbols)))
            raise UndecidedError(
                f"the winding number around the {line} depends on {names}: no single closed form "
                "holds for all values. Give numbers for these symbols."
            )


def short(x: sp.Expr) -> sp.Expr:
    """The shorter of an expression and its simplification."""
    return min((x, sp.simplify(x)), key=sp.count_ops)


def pieces(loop: Loop) -> Iterator[tuple[int, Piece]]:
    """Exact paths (coordinates, parameter, start, end) with their multiplicities."""
    for part in loop.parts:
        if part.given is None:
            raise LoopError(
                f"{loop.name}: this loop is only known numerically, so it has no closed form. "
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
    for (i, mu), value in {**frame.coframe.nonzero(), **frame.coframe.undecided()}.items():
        if slopes[mu] != 0:
            result[i] += value.subs(table, simultaneous=True) * slopes[mu]
    return result


def sample_of(frame: Frame, symbols: Collection[sp.Symbol]) -> dict[sp.Symbol, sp.Expr]:
    """Values of the parameters of a frame, and of further symbols, for the numerical check."""
    values = {s: v for s, v in frame.region.point.items() if s not in frame.coordinates}
    others = sorted(set(symbols) - set(values), key=str)
    return {**values, **next(RealPoints(others, ()).points())}


def _number(f: sp.Expr, piece: Piece, where: Mapping[sp.Symbol, sp.Expr]) -> acb:
    """The integral of f at the sample values, in a ball; it is not finite where none is proved."""
    _, t, low, high = piece
    if f == 0:
        return acb(0)
    with ball_precision(CHECKED_BITS):
        return _proved(f.subs(where), t, *(expression_of(x).subs(where) for x in (low, high)))


def _proved(f: sp.Expr, t: sp.Symbol, low: sp.Expr, high: sp.Expr) -> acb:
    """The integral of f from low to high, all of them without symbols but t."""
    code = BallCode(graph([t.name], [f], factor=False))
    function, numbers = code.complex_function(), code.numbers()
    start, width = exact_ball(low), exact_ball(high) - exact_ball(low)

    def along(s: acb, analytic: bool) -> acb:
        return function([start + width * s], numbers, analytic)[0]

    return width * integral(along, arb(10) ** (-DIGITS - 1))


@exclusive
def _verify(
    vector: tuple[sp.Expr, ...],
    numbers: Sequence[Sequence[acb]],
    where: Mapping[sp.Symbol, sp.Expr],
) -> None:
    """Refuse a closed form that is not the sum of proved integrals.

    numbers: for each component its integrals along the pieces.
    """
    for i, (expression, parts) in enumerate(zip(vector, numbers, strict=True)):
        value = expression.subs(where).evalf(DIGITS + 10)
        with ball_precision(CHECKED_BITS):
            number = sum(parts, acb(0))
            closed = acb(*(exact_ball(x) for x in value.as_real_imag()))
            if abs(closed - number) <= arb(10) ** -DIGITS * (1 + abs(number)):
                continue
            shown = number.str(DIGITS, radius=False) if number.is_finite() else "not proved"
        raise UndecidedError(
            f"the closed form {expression} for b^{i} was found, but it is {value.evalf(DIGITS)} "
            f"where the integral is {shown}. For a number use gt.burgers_vector."
        )


def verified(
    vector: tuple[sp.Expr, ...],
    forms: Sequence[sp.Expr],
    piece: Piece,
    where: Mapping[sp.Symbol, sp.Expr],
) -> tuple[sp.Expr, ...]:
    """A closed form that is the proved integral of the pulled-back forms over one piece."""
    _verify(vector, [[_number(f, piece, where)] for f in forms], where)
    return vector
