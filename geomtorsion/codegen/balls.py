"""Balls: a graph as functions of balls (arb, acb) and of power series in balls (arb_series).

A ball contains the true value despite rounding.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import count
from typing import Any, Literal

import sympy as sp
from flint import acb, arb, arb_series, ctx, fmpq, fmpz

from geomtorsion.codegen.ball_functions import COMPLEX, NAN, REAL, UNIT, Ball
from geomtorsion.codegen.evaluation import rational
from geomtorsion.codegen.expression_graph import Graph, graph
from geomtorsion.codegen.printers import function_of
from geomtorsion.codegen.steps import Signed, Step
from geomtorsion.errors import ExpressionError
from geomtorsion.exact.evaluate import LARGEST_BITS
from geomtorsion.support.caching import cached_property
from geomtorsion.support.precision import ball_precision

Kind = Literal["real", "complex"]
# (arguments, numbers of the graph) -> outputs; complex functions take the flag `analytic` as well.
BallFunction = Callable[..., list[Ball]]

# -- numbers ---------------------------------------------------------------------------------------

_CONSTANTS: dict[sp.Expr, Callable[[], arb]] = {
    sp.pi: arb.pi,
    sp.E: arb.const_e,
    sp.EulerGamma: arb.const_euler,
    sp.Catalan: arb.const_catalan,
    sp.GoldenRatio: lambda: (1 + arb(5).sqrt()) / 2,
}


def exact_ball(value: Any) -> arb:
    """A number as a ball at the precision in use: floats are exact binary fractions.

    Raises
    ------
    ExpressionError
        no enclosure of it is known.

    Examples
    --------
    >>> exact_ball(0.1) == 0.1, exact_ball(sp.Rational(1, 10)) == 0.1
    (True, False)
    >>> print(exact_ball(sp.sqrt(2)).str(10))
    [1.414213562 +/- 3.74e-10]
    """
    if isinstance(value, arb):
        return value
    if hasattr(value, "_mpf_"):
        # Numbers of mpmath and floats of sympy store the sign apart from the mantissa.
        return _dyadic(*value._mpf_[:3])
    fraction = rational(value)
    if fraction is not None:
        return arb(fmpq(fraction.numerator, fraction.denominator))
    if isinstance(value, sp.Expr) and value.is_number:
        return expression_ball(value)
    raise ExpressionError(
        f"expected a number of which a ball is known, got {value!r}. Write it with fractions, "
        "roots and functions, or as text."
    )


def _dyadic(sign: int, mantissa: Any, exponent: int) -> arb:
    """(-1)^sign mantissa 2^exponent."""
    whole = arb(fmpz(int(mantissa)))
    return (-whole if sign else whole) * arb(2) ** exponent


def expression_ball(value: sp.Expr) -> arb:
    """A constant expression of sympy as a ball at the precision in use."""
    # Floats in it are dyadic numbers as well.
    exact = value.xreplace({x: sp.Rational(x) for x in value.atoms(sp.Float)})
    return BallCode(graph([], [exact], factor=False)).real([])[0]


@lru_cache(maxsize=256)
def _constant(value: sp.Expr, bits: int) -> arb:
    """An irrational number, to the number of bits in use."""
    assert bits == ctx.prec
    if value in _CONSTANTS:
        return _CONSTANTS[value]()
    if isinstance(value, sp.Add | sp.Mul):
        parts = [exact_ball(part) for part in value.args]
        total = parts[0]
        for part in parts[1:]:
            total = total + part if isinstance(value, sp.Add) else total * part
        return total
    if isinstance(value, sp.Pow) and value.base.is_positive:
        return exact_ball(value.base) ** exact_ball(value.exp)
    name = type(value).__name__
    if len(value.args) == 1 and name in REAL:
        return REAL[name](exact_ball(value.args[0]))
    raise ExpressionError(
        f"expected a constant of which a ball is known, got {value}. Known are pi, E, EulerGamma, "
        "Catalan, GoldenRatio, and roots and functions of them."
    )


def constants(steps: Sequence[Step]) -> list[arb]:
    """The numbers of a graph in the order of its steps, at the precision in use."""
    numbers = []
    for step in steps:
        if step.kind == "number":
            numbers.append(arb(fmpq(step.detail.numerator, step.detail.denominator)))
        elif step.kind == "digits":
            numbers.append(_constant(step.detail, ctx.prec))
    return numbers


def coefficient(x: Ball, order: int) -> arb:
    """A coefficient of a series, or of a constant."""
    if isinstance(x, arb_series):
        # Beyond its end FLINT gives zeros.
        return x[order] if order < x.prec else arb("nan")
    return x if order == 0 or not x.is_finite() else arb(0)


# -- the printer -----------------------------------------------------------------------------------


def source(steps: Sequence[Step], outputs: Sequence[Signed], kind: Kind) -> str:
    """Source of `values(a, n)`, or of `values(a, n, analytic)` for complex balls.

    a: arguments; n: the numbers of the graph, at any precision.
    """
    lines: list[str] = []
    numbers = count()
    pairs = _pairs(steps)
    for place, step in enumerate(steps):
        if step.kind == "call" and step.detail in ("sin", "cos") and step.operands[0] in pairs:
            both = pairs[step.operands[0]]
            if place == min(both):
                lines.append(f"t{both[0]}, t{both[1]} = t{step.operands[0]}.sin_cos()")
        else:
            lines.append(f"t{place} = {_code(step, numbers, kind)}")
    results = ", ".join(("" if sign > 0 else "-") + f"t{place}" for sign, place in outputs)
    header = f"def values(a, n{', analytic=False' if kind == 'complex' else ''}):"
    return "\n    ".join([header, *lines, f"return [{results}]"])


def _code(step: Step, numbers: Iterator[int], kind: Kind) -> str:
    """The right side of a step; numbers: places of the numbers of the graph that are next."""
    inner = [f"t{operand}" for operand in step.operands]
    detail, is_complex = step.detail, kind == "complex"
    flag = ", analytic" if is_complex else ""
    match step.kind:
        case "argument":
            return f"ball(a[{detail}])" if is_complex else f"a[{detail}]"
        case "number" | "digits":
            return f"ball(n[{next(numbers)}])" if is_complex else f"n[{next(numbers)}]"
        case "imaginary":
            return "unit"
        case "sum":
            signed = zip(step.signs, inner, strict=True)
            terms = "".join(f" {'+' if sign > 0 else '-'} {x}" for sign, x in signed)
            return terms.removeprefix(" + ").lstrip()
        case "product":
            return f"{inner[0]} * {inner[1]}"
        case "square":
            return f"{inner[0]} * {inner[0]}"
        case "quotient":
            return f"{inner[0]} / {inner[1]}" if is_complex else f"over({inner[0]}, {inner[1]})"
        case "root":
            return f"root({inner[0]}, {detail}{flag})"
        case _:
            return f"{detail}({', '.join(inner)}{flag})"


def _pairs(steps: Sequence[Step]) -> dict[int, tuple[int, int]]:
    """Places of sine and cosine of one argument, where both occur."""
    by_argument: dict[int, dict[str, int]] = {}
    for place, step in enumerate(steps):
        if step.kind == "call" and step.detail in ("sin", "cos"):
            by_argument.setdefault(step.operands[0], {})[step.detail] = place
    return {inner: (x["sin"], x["cos"]) for inner, x in by_argument.items() if len(x) == 2}


@lru_cache(maxsize=1024)
def _compiled(text: str, kind: Kind) -> BallFunction:
    table: dict[str, Any] = dict(COMPLEX if kind == "complex" else REAL)
    # Methods of acb that are handed an arb would read memory that is not theirs.
    return function_of(text, table | {"unit": UNIT, "ball": acb})


@dataclass(frozen=True, eq=False)
class BallCode:
    """A graph as functions of balls.

    Examples
    --------
    >>> x = sp.Symbol("x")
    >>> code = BallCode(graph(["x"], [sp.sqrt(x)]))
    >>> print(code.real([arb(2)])[0].str(10))
    [1.414213562 +/- 3.74e-10]
    >>> code.complex([acb(arb(0, 1))], analytic=True)[0].is_finite()
    False
    """

    graph: Graph

    def numbers(self) -> list[arb]:
        """The numbers of the graph at the precision in use."""
        return constants(self.graph.steps)

    @cached_property
    def _real(self) -> BallFunction:
        return _compiled(source(self.graph.steps, self.graph.outputs, "real"), "real")

    @cached_property
    def _complex(self) -> BallFunction:
        return _compiled(source(self.graph.steps, self.graph.outputs, "complex"), "complex")

    def real_function(self) -> BallFunction:
        """(arguments, numbers) -> outputs, of arb and of arb_series."""
        return self._real

    def complex_function(self) -> BallFunction:
        """(arguments, numbers, analytic) -> outputs, of acb."""
        return self._complex

    def real(self, arguments: Sequence[Ball]) -> list[Ball]:
        """Outputs at real balls, or at series of them."""
        return self.real_function()(arguments, self.numbers())

    def complex(self, arguments: Sequence[acb], *, analytic: bool) -> list[acb]:
        """Outputs at complex balls."""
        return self.complex_function()(arguments, self.numbers(), analytic)


# -- integrals -------------------------------------------------------------------------------------


def integral(function: Callable[[acb, bool], acb], tolerance: arb, most: int | None = None) -> acb:
    """The integral of a function (s, analytic) from 0 to 1, at the precision in use.

    It is not finite where there is no enclosure. tolerance: absolute; most: evaluations.

    Examples
    --------
    >>> root = integral(lambda s, analytic: (1 + s).sqrt(analytic=analytic), arb(0))
    >>> root.real.str(10, radius=False), root.imag.contains(0)
    ('1.218951416', True)
    """
    raised: list[BaseException] = []
    value = NAN

    def guarded(s: acb, analytic: bool) -> acb:
        # An error raised inside of FLINT would come out as a SystemError.
        if raised:
            return NAN
        try:
            return function(s, analytic)
        except BaseException as error:  # noqa: BLE001  # limits and Ctrl-C come out below
            raised.append(error)
            return NAN

    share = arb(2) ** (5 - ctx.prec)
    try:
        value = acb.integral(guarded, 0, 1, rel_tol=share, abs_tol=tolerance, eval_limit=most)
    except SystemError as error:
        raised.append(error)
    if raised:
        raise innermost(raised[0])
    return value


def innermost(error: BaseException) -> BaseException:
    """The error raised inside of FLINT, out of the SystemErrors around it."""
    while isinstance(error, SystemError) and error.__cause__ is not None:
        error = error.__cause__
    return error


# -- balls as floats -------------------------------------------------------------------------------


def float_values(code: BallCode, arguments: Sequence[Any]) -> list[float | complex | None]:
    """Values with all but the last digit of a float correct; None without a value.

    The precision is doubled until the balls are small enough. A value indistinguishable from zero
    at the largest is zero if its ball is below the smallest float.

    Examples
    --------
    >>> x = sp.Symbol("x")
    >>> float_values(BallCode(graph(["x"], [1 - sp.cos(x), sp.log(x)])), [0.0])
    [0.0, None]
    """
    settled: dict[int, float | complex] = {}
    bits = 128
    while bits <= LARGEST_BITS and len(settled) < code.graph.size:
        with ball_precision(bits):
            if code.graph.is_complex:
                values = code.complex([acb(x) for x in arguments], analytic=False)
            else:
                values = code.real([arb(x) for x in arguments])
            for k, value in enumerate(values):
                if k not in settled and _is_settled(value, bits):
                    settled[k] = _number(value)
        bits *= 2
    return [settled.get(k) for k in range(code.graph.size)]


def _number(value: Ball) -> float | complex:
    return complex(value) if isinstance(value, acb) else float(value.mid())


def _is_settled(value: Ball, bits: int) -> bool:
    """Whether a ball is so small that a float made of it is right to the last digit but one."""
    if not value.is_finite():
        return False
    if value.rel_accuracy_bits() > 53 or value.is_zero():
        return True
    tiny = arb(2) ** -1074
    return 2 * bits > LARGEST_BITS and abs(value) < tiny
