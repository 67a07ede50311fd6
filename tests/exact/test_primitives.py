"""Primitives: logarithms and inverse functions of numbers; relations among them stay undecided."""

import pytest
import sympy as sp
from sympy import Rational, S, acos, acosh, asin, asinh, atan, atanh, cos, log, pi, sqrt

from geomtorsion.exact import Field
from tests.rounding import ROUNDED

x = sp.Symbol("x")
golden = (1 + sqrt(5)) / 2
RELATIONS = {
    "Machin": 4 * atan(Rational(1, 5)) - atan(Rational(1, 239)) - pi / 4,
    "Gauss": 12 * atan(1 / S(18)) + 8 * atan(1 / S(57)) - 5 * atan(1 / S(239)) - pi / 4,
    "one, two, three": atan(1) + atan(2) + atan(3) - pi,
    "Euler": atan(Rational(1, 2)) + atan(Rational(1, 3)) - pi / 4,
    "Pythagoras": asin(Rational(3, 5)) + asin(Rational(4, 5)) - pi / 2,
    "arc cosine of a root": 2 * acos(sqrt(Rational(2, 3))) - acos(Rational(1, 3)),
    "area tangent": atanh(Rational(1, 3)) - log(2) / 2,
    "area sine": asinh(Rational(3, 4)) - log(2),
    "area cosine": acosh(Rational(5, 4)) - log(2),
    "three primes": 2 * atanh(Rational(1, 5)) - log(3) + log(2),
    "unit": log(3 + 2 * sqrt(2)) - 2 * log(1 + sqrt(2)),
    "golden ratio": log(golden) - asinh(Rational(1, 2)),
    "conjugates": log(1 + sqrt(2)) + log(sqrt(2) - 1),
}  # fmt: skip
NOT_ZERO = {
    "another turn": atan(1) + atan(2) + atan(3),
    "Machin, one less": 4 * atan(Rational(1, 5)) - atan(Rational(1, 240)) - pi / 4,
    "half the angle": atan(Rational(1, 3)) - atan(3) / 3,
    "unlike": log(1 + sqrt(2)) - asinh(Rational(1, 2)),
}
TINY = Rational(1, 10**60)


def every(cases):
    return pytest.mark.parametrize(
        "value", cases.values(), ids=[k.replace(" ", "-") for k in cases]
    )


@every(RELATIONS)
def test_relations_are_left_open(value):
    """The zero test of such a sum is undecided, which its certainty states; its number is right."""
    for terms in (value.args, value.args[::-1]):
        field = Field([x])
        total = field.sum((1, field.read(term)) for term in terms)
        assert total.is_zero is None
        assert "undecided" in str(total.certainty)
        assert abs(total.evaluate({})) < 1e-13


def test_a_polar_angle_is_an_arc():
    """sympy writes atan2(1, 5) as atan(1/5), and both are read as the same element."""
    assert Field([x]).read(sp.atan2(1, 5) - atan(Rational(1, 5))).is_zero is True


@every({**RELATIONS, **NOT_ZERO})
def test_near_zeros_are_not_zero(value):
    """A value plus 1e-60 is not zero."""
    assert Field([x]).read(value + TINY).is_zero is False


@every(NOT_ZERO)
def test_sums_without_a_relation_are_not_zero(value):
    """Sums that are not zero are decided, also a sum of angles that is half a turn."""
    assert Field([x]).read(value).is_zero is False


def test_a_lone_one_is_written_as_it_is():
    """A single arc tangent of a number is not rewritten."""
    assert Field([x]).read(x * atan(Rational(1, 5))).sympy == x * atan(Rational(1, 5))


def test_cosine_of_an_arc_cotangent_below_zero():
    """acot(u) has the sign of u, in sympy and here, so that its cosine is positive."""
    field = Field([x], sample={x: 2})
    value = field.read(cos(sp.acot(1 - x) + pi / 3))
    point = {x: 2.0}
    assert value.evaluate(point) == pytest.approx(float(sp.cos(sp.acot(-1) + pi / 3)), rel=ROUNDED)
