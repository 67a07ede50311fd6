"""Wanted: how sharp the balls of a proof have to be, in bits."""

from __future__ import annotations

import math
from dataclasses import dataclass

from flint import arb

from geomtorsion.codegen.ball_functions import Ball
from geomtorsion.errors import ArgumentError
from geomtorsion.support import checks

MOST_DIGITS = 1000
# Balls have this many more bits than the error that they judge.
SHARPER = 4
# Extra bits, which rounding consumes in a problem without cancellation.
SPARE = 30
# No proof takes more bits than this.
MOST_BITS = 20_000
# Numbers below this many bits of the largest number count as zero.
FAR_BELOW = -1e30


@dataclass(frozen=True)
class Wanted:
    """The sharpness of a proof.

    bits: relative, of the largest component.
    error: the error that a result reports, in the unit of the balls; 0.0 where it is to be ignored.
    """

    bits: int
    error: arb

    @classmethod
    def of(cls, digits: object, error: arb, size: arb) -> Wanted:
        """From digits, and from a reported error of something of a size.

        Raises
        ------
        ArgumentError
            digits is not a whole number from 1 to 1000.
        """
        asked = checks.count(digits, "digits", ArgumentError, 1, MOST_DIGITS)
        bits = math.ceil(asked * math.log2(10)) + 1
        if error > 0 and size > error:
            judged = math.ceil(log2(size) - log2(error)) + SHARPER
            bits = max(bits, min(judged, math.ceil(MOST_DIGITS * math.log2(10))))
        return cls(bits, error)


def upper(x: Ball) -> arb:
    """An upper bound of the size of a ball, as an exact number."""
    return abs(x).upper()


def around_zero(radius: arb) -> arb:
    """The ball about zero of a radius, itself a ball."""
    return arb(0, radius.upper())


def log2(x: Ball) -> float:
    """About the logarithm of the largest size in a ball: it chooses steps, and is not a bound."""
    size = upper(x)
    if size.is_zero():
        return FAR_BELOW
    return float(size.log()) / math.log(2) if size.is_finite() else -FAR_BELOW


def upper_float(x: arb) -> float:
    """A float that is no smaller than anything in a ball."""
    bound = x.upper()
    if not bound.is_finite():
        return math.inf
    value = float(bound)
    return value if arb(value) >= bound else math.nextafter(value, math.inf)
