"""Evaluation: steps at one point, exactly or as numbers of a given precision."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import partial
from typing import Any

import mpmath

from geomtorsion.codegen.printers import FUNCTIONS
from geomtorsion.codegen.steps import Signed, Step
from geomtorsion.exact.special_values import VALUES, number
from geomtorsion.support.precision import working_precision

Exact = Fraction | mpmath.mpf
# Types of numpy and heyoka that keep more digits than floats.
LONG_FLOATS = ("longdouble", "real128", "real")


def exact_values(
    steps: Sequence[Step], outputs: Sequence[Signed], arguments: Sequence[Any], bits: int
) -> list[Exact]:
    """Outputs as fractions where they are rational, else as mpmath numbers of a given precision."""
    with working_precision(bits):
        numbers = [exact_number(value, bits) for value in arguments]
        values: list[Exact] = []
        for step in steps:
            values.append(_exact(step, numbers, values))
        return [values[place] if sign > 0 else -values[place] for sign, place in outputs]


def _exact(step: Step, given: Sequence[Exact], made: Sequence[Exact]) -> Exact:
    """One step; if any operand is an mpmath number, the result is one."""
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
    """A number as an exact fraction, also for floats of any length; None for other numbers.

    Examples
    --------
    >>> from numpy import longdouble
    >>> rational(longdouble(0.5)), rational(longdouble("0.1")) == Fraction(1, 10)
    (Fraction(1, 2), False)
    """
    if isinstance(value, int | float | Fraction):
        return Fraction(value)
    if type(value).__name__ in LONG_FLOATS:
        return _long_ratio(value)
    if getattr(value, "is_Rational", False):
        return Fraction(int(value.p), int(value.q))
    if hasattr(value, "dtype") and getattr(value, "shape", None) == ():
        return Fraction(value.item()) if value.dtype.kind in "fiu" else None
    return None


def _long_ratio(value: Any) -> Fraction | None:
    """The exact ratio of a long float, None where it is not finite.

    Its digits as text are rounded; it is the sum of the floats that are split off it in turn.
    """
    total, unit, rest = Fraction(0), Fraction(1), value
    if rest != rest or (rest != 0 and rest == rest / 2):
        return None
    while rest != 0:
        # Powers of two change no digit and lead back to where floats keep all of theirs.
        size = abs(rest)
        if size < 2.0**-500:
            rest, unit = rest * 2.0**500, unit / 2**500
        elif size > 2.0**500:
            rest, unit = rest / 2.0**500, unit * 2**500
        else:
            part = float(rest)
            total, rest = total + Fraction(part) * unit, rest - part
    return total


def exact_number(value: Any, bits: int) -> Exact:
    """A number of any kind as a fraction, or as an mpmath number of a given precision.

    Examples
    --------
    >>> import sympy
    >>> exact_number(0.5, 100), mpmath.nstr(exact_number(sympy.pi, 100), 25)
    (Fraction(1, 2), '3.141592653589793238462643')
    """
    with working_precision(bits):
        fraction = rational(value)
        if type(value).__name__ in LONG_FLOATS:
            if fraction is None:
                return mpmath.mpf(float(value))
            return mpmath.mpf(fraction.numerator) / fraction.denominator
        if fraction is not None:
            return fraction
        if hasattr(value, "evalf"):
            return mpmath.mpmathify(value.evalf(mpmath.mp.dps + 5))
        return +mpmath.mpmathify(value)
