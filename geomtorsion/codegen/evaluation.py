"""Evaluation: steps at one point, exactly or by ball arithmetic to all digits of a float."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from functools import partial
from typing import Any, TypeAlias

import flint
import mpmath

from geomtorsion.codegen.printers import FUNCTIONS
from geomtorsion.codegen.steps import Signed, Step
from geomtorsion.exact.evaluate import LARGEST_BITS
from geomtorsion.exact.special_values import VALUES, number
from geomtorsion.precision import ball_precision, working_precision

Exact = Fraction | mpmath.mpf


def exact_values(
    steps: Sequence[Step], outputs: Sequence[Signed], arguments: Sequence[Any], bits: int
) -> list[Exact]:
    """Outputs as fractions where they are rational, else as mpmath's numbers of so many bits."""
    with working_precision(bits):
        given = [exact_number(value, bits) for value in arguments]
        made: list[Exact] = []
        for step in steps:
            made.append(_exact(step, given, made))
        return [made[place] if sign > 0 else -made[place] for sign, place in outputs]


def _exact(step: Step, given: Sequence[Exact], made: Sequence[Exact]) -> Exact:
    """One step; whatever meets an mpmath number becomes one."""
    kind, detail = step.kind, step.detail
    if kind == "argument":
        return given[detail]
    if kind == "number":
        return detail
    if kind == "digits":
        return mpmath.mpmathify(detail.evalf(mpmath.mp.dps + 5))
    if kind == "imaginary":
        return mpmath.mpc(0, 1)
    inner = [made[place] for place in step.operands]
    if not all(isinstance(value, Fraction) for value in inner):
        inner = [_long(value) for value in inner]
    if kind == "sum":
        return sum((s * value for s, value in zip(step.signs, inner, strict=True)), Fraction(0))
    if kind == "product":
        return inner[0] * inner[1]
    if kind == "square":
        return inner[0] * inner[0]
    if kind == "quotient":
        return inner[0] / inner[1]
    long = [_long(value) for value in inner]
    if kind == "root":
        return mpmath.root(long[0], detail)
    if detail == "power":
        return mpmath.power(*long)
    return _MPMATH[detail](*long)


_MPMATH: dict[str, Callable[..., mpmath.mpf]] = {
    name: getattr(mpmath, names.mpmath) for name, names in FUNCTIONS.items()
    if name not in VALUES and hasattr(mpmath, names.mpmath)
} | {name: partial(number, name) for name in VALUES} | {"Max": max, "Min": min}  # fmt: skip


def _long(value: Exact) -> mpmath.mpf:
    """A number with the bits of the moment."""
    if isinstance(value, Fraction):
        return mpmath.mpf(value.numerator) / value.denominator
    return value


def rational(value: Any) -> Fraction | None:
    """A number as a fraction where it is one (floats are), else None."""
    if isinstance(value, int | float | Fraction):
        return Fraction(value)
    if getattr(value, "is_Rational", False):
        return Fraction(int(value.p), int(value.q))
    if hasattr(value, "dtype") and getattr(value, "shape", None) == ():
        return Fraction(value.item()) if value.dtype.kind in "fiu" else None
    return None


def exact_number(value: Any, bits: int) -> Exact:
    """A number of any kind as a fraction, or as mpmath number of so many bits.

    Examples
    --------
    >>> import sympy
    >>> exact_number(0.5, 100), mpmath.nstr(exact_number(sympy.pi, 100), 25)
    (Fraction(1, 2), '3.141592653589793238462643')
    """
    with working_precision(bits):
        # numpy's long floats give their digits as text alone; so do heyoka's.
        if type(value).__name__ in ("longdouble", "real128", "real"):
            return mpmath.mpf(str(value))
        known = rational(value)
        if known is not None:
            return known
        if hasattr(value, "evalf"):
            return mpmath.mpmathify(value.evalf(mpmath.mp.dps + 5))
        return +mpmath.mpmathify(value)


Ball: TypeAlias = Any  # an arb, or an acb where values are complex

# Functions whose names there are not those of sympy, and those of two arguments.
_RENAMED = {"ceiling": "ceil", "sign": "sgn", "Abs": "__abs__"}
_OF_TWO: dict[str, Callable[[Ball, Ball], Ball]] = {
    "atan2": flint.arb.atan2,
    "power": lambda base, exponent: base**exponent,
}


def ball_values(
    steps: Sequence[Step],
    outputs: Sequence[Signed],
    arguments: Sequence[float | complex],
    *,
    is_complex: bool = False,
) -> list[float | complex | None]:
    """Values that are right to the last digit but one of a float; None where there is none.

    The precision is doubled until the balls are small enough. What cannot be told from zero with
    the largest is zero where its ball is below the smallest float.
    """
    found: dict[int, float | complex] = {}
    bits = 128
    while bits <= LARGEST_BITS and len(found) < len(outputs):
        with ball_precision(bits):
            kind = flint.acb if is_complex else flint.arb
            waiting = [k for k in range(len(outputs)) if k not in found]
            values = _values(steps, [outputs[k][1] for k in waiting], arguments, kind)
            for k, value in zip(waiting, values, strict=True):
                if value is not None and _is_settled(value, bits):
                    number = complex(value) if is_complex else float(value.mid())
                    found[k] = outputs[k][0] * number
        bits *= 2
    return [found.get(k) for k in range(len(outputs))]


def _is_settled(value: Ball, bits: int) -> bool:
    """Whether a ball is so small that a float made of it is right to the last digit but one."""
    if not value.is_finite():
        return False
    if value.rel_accuracy_bits() > 53 or value.is_zero():
        return True
    tiny = flint.arb(2) ** -1074
    return 2 * bits > LARGEST_BITS and abs(value) < tiny


def _values(
    steps: Sequence[Step], places: Sequence[int], arguments: Sequence[float | complex], kind: Any
) -> list[Ball | None]:
    """Balls of some steps; None for what has no value."""
    made: list[Ball | None] = [None] * len(steps)
    for place in _needed(steps, places):
        step = steps[place]
        inner = [made[operand] for operand in step.operands]
        if all(ball is not None for ball in inner):
            try:
                made[place] = _ball(step, inner, arguments, kind)
            except (AttributeError, ValueError, ZeroDivisionError, TypeError):
                # There is no such function for these balls, or it has no value.
                continue
    return [made[place] for place in places]


def _needed(steps: Sequence[Step], places: Iterable[int]) -> list[int]:
    """The steps on which some depend, in order."""
    wanted, waiting = set[int](), list(places)
    while waiting:
        place = waiting.pop()
        if place not in wanted:
            wanted.add(place)
            waiting += steps[place].operands
    return sorted(wanted)


def _ball(step: Step, inner: Sequence[Ball], arguments: Sequence[Any], kind: Any) -> Ball:
    """One step."""
    name, detail = step.kind, step.detail
    if name == "argument":
        return kind(arguments[detail])
    if name == "number":
        return kind(flint.fmpq(detail.numerator, detail.denominator))
    if name == "digits":
        digits = int(flint.ctx.dps) + 10
        text = str(detail.evalf(digits))
        return kind(
            flint.arb(flint.arb(text).mid(), abs(flint.arb(text)) * flint.arb(10) ** -digits)
        )
    if name == "imaginary":
        return flint.acb(0, 1)
    if name == "sum":
        total = kind(0)
        for sign, ball in zip(step.signs, inner, strict=True):
            total = total + ball if sign > 0 else total - ball
        return total
    if name == "product":
        return inner[0] * inner[1]
    if name == "square":
        return inner[0] * inner[0]
    if name == "quotient":
        return inner[0] / inner[1]
    if name == "root":
        return inner[0].sqrt() if detail == 2 else inner[0].root(detail)
    if detail in ("Max", "Min"):
        return _extreme(inner, detail)
    if detail in VALUES:
        found = VALUES[detail](*map(flint.acb, inner))
        if kind is flint.acb:
            return found
        if not found.imag.is_zero():
            raise ValueError(f"{detail} is not real here")
        return found.real
    if detail in _OF_TWO:
        return _OF_TWO[detail](*inner)
    return getattr(inner[0], _RENAMED.get(str(detail), str(detail)))()


def _extreme(inner: Sequence[Ball], name: str) -> Ball:
    """The largest or the smallest."""
    best = inner[0]
    for ball in inner[1:]:
        best = best.max(ball) if name == "Max" else best.min(ball)
    return best
