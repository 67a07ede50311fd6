"""Canonicity: equal expressions give equal elements, hashes and prints, in any order of reading."""

from itertools import permutations

import pytest
import sympy as sp
from sympy import (
    cbrt,
    cos,
    cosh,
    cot,
    exp,
    log,
    pi,
    sin,
    sinh,
    sqrt,
    tan,
    tanh,
)

from geomtorsion.exact import Field
from tests.exact.symbols import POINT, a, f, g, m, number, p, r, x, y

PAIRS = {
    "angles": (sin(2 * x) / (1 + cos(2 * x)), tan(x)),
    "half angles": (tan(x / 2), (1 - cos(x)) / sin(x)),
    "quotients": (1 / (1 - cos(x)), (1 + cos(x)) / sin(x) ** 2),
    "hyperbolic": (1 / (cosh(x) - 1), (cosh(x) + 1) / sinh(x) ** 2),
    "rational": (1 / (x - y) + 1 / (x + y), 2 * x / (x**2 - y**2)),
    "signs": ((x - y) / (2 - x), (y - x) / (x - 2)),
    "content": ((2 * x + 2 * y) / (4 * x - 6), (x + y) / (2 * x - 3)),
    "roots below": (1 / (sqrt(r) + 1), (sqrt(r) - 1) / (r - 1)),
    "roots above": (sqrt(r**2 - 2 * m * r) / r, sqrt(1 - 2 * m / r)),
    "two roots below": (1 / (sqrt(r) + sqrt(m)), (sqrt(r) - sqrt(m)) / (r - m)),
    "cube root below": (1 / (1 + cbrt(r)), (1 - cbrt(r) + cbrt(r) ** 2) / (1 + r)),
    "nested": (sqrt(3 + 2 * sqrt(2)) * x, x + sqrt(2) * x),
    "exponentials": (1 / (1 + exp(-x)), exp(x) / (exp(x) + 1)),
    "tanh": (tanh(x / 2), (exp(x) - 1) / (exp(x) + 1)),
    "powers": (r ** (p - 1) * (1 + r), r**p / r + r**p),
    "logs": (log(r**2 * m), 2 * log(r) + log(m)),
    "functions": ((f(r) ** 2 - g(r) ** 2) / (f(r) - g(r)), f(r) + g(r)),
    "derivatives": (
        sp.diff(f(r) / g(r), r),
        (sp.diff(f(r), r) * g(r) - f(r) * sp.diff(g(r), r)) / g(r) ** 2,
    ),
    "Kerr": (
        (r**2 + a**2 - a**2 * sin(x) ** 2) / (r**2 + a**2 * cos(x) ** 2),
        sp.Integer(1),
    ),
}


@pytest.mark.parametrize("label", PAIRS)
@pytest.mark.parametrize("swapped", [False, True])
def test_two_forms_of_one_thing_are_identical(label, swapped):
    """Both forms, read into one field one after the other, are the same element."""
    one, two = map(sp.sympify, PAIRS[label][::-1] if swapped else PAIRS[label])
    field = Field(sorted(one.free_symbols | two.free_symbols, key=str), sample=POINT)
    first, second = field.read(one), field.read(two)
    assert first == second
    assert hash(first) == hash(second)
    assert str(first) == str(second)
    assert first.sympy == second.sympy
    assert (first - second).is_zero is True


# In a field of their own, these keep the angle, argument or denominator that was entered.
OWN_BASIS = {"angles", "half angles", "tanh", "roots below", "two roots below"}


@pytest.mark.parametrize("label", sorted(PAIRS.keys() - OWN_BASIS))
def test_two_fields_print_the_same(label):
    """Read into separate fields, both forms print the same."""
    one, two = map(sp.sympify, PAIRS[label])
    symbols = sorted(one.free_symbols | two.free_symbols, key=str)
    assert str(Field(symbols, sample=POINT).read(one).sympy) == str(
        Field(symbols, sample=POINT).read(two).sympy
    )


# Expressions that extend one field step by step.
TOWERS = {
    "angles": [sin(x), cos(x / 2), tan(x / 3), sin(2 * x), cos(x + pi / 3), sin(x / 6)],
    "exponentials": [exp(x), exp(x / 2), exp(x / 3), sinh(x), cosh(x / 2), exp(-x + y)],
    "roots": [sqrt(r), sqrt(sqrt(r)), cbrt(r), sqrt(4 * r), r ** sp.Rational(1, 6), sqrt(1 / r)],
    "radicands": [
        sqrt(r**2 - m**2),
        sqrt(r - m),
        sqrt(r + m),
        sqrt(r**3 - r * m**2),
        sqrt(r),
        sqrt(1 - m / r),
    ],
    "nested": [
        sqrt(r + sqrt(r**2 - m**2)),
        sqrt(2),
        sqrt(r + m),
        sqrt(r - m),
        sqrt(r - sqrt(r**2 - m**2)),
    ],
    "logs": [log(r), log(r * m), log(2 * m), log(r**2 + r), log((r + 1) / m), log(4)],
    "numbers": [sqrt(2), sqrt(6), sqrt(3), sqrt(3 + 2 * sqrt(2)), sqrt(2 + sqrt(3)), sqrt(5)],
    "sines and roots": [
        sqrt(1 + cos(x)),
        sin(x / 2),
        sqrt(1 - cos(x)),
        sqrt(sin(x)),
        sqrt(1 - sin(x) ** 2),
        cot(x / 2),
    ],
    "powers": [r**p, r ** (2 * p), r ** (p / 2), (r * m) ** p, m**p, r ** (p + 1)],
    "bases": [2**x, 4**x, 6**x, 3 ** (x / 2), exp(x), 2 ** (x / 2)],
    "functions": [
        f(r),
        sqrt(f(r)),
        exp(f(r)),
        exp(f(r) / 2),
        sqrt(4 * f(r) * r),
        log(f(r) * r),
    ],
}


@pytest.mark.parametrize("label", TOWERS)
def test_order_of_reading_does_not_matter(label):
    """Each order of reading gives the same elements and the right sum of their squares."""
    members = TOWERS[label]
    symbols = sorted(set().union(*(e.free_symbols for e in members)), key=str)
    for order in list(permutations(range(len(members))))[:: 91 if len(members) > 5 else 17]:
        field = Field(symbols, sample=POINT)
        elements = {}
        for index in order:
            elements[index] = field.read(members[index])
        total = field.sum([(index + 1, e, e) for index, e in elements.items()])
        wanted = sum((i + 1) * e**2 for i, e in enumerate(members))
        again = field.read(wanted)
        assert total == again, [members[i] for i in order]
        assert (total - again).is_zero is True
        assert abs(number(total.sympy, 40) - number(wanted, 40)) < 1e-30
        for index, element in elements.items():
            assert element == field.read(members[index])
            assert element * element.inverse() == field.one
            assert hash(element) == hash(field.read(members[index]))


@pytest.mark.parametrize("label", TOWERS)
def test_old_elements_survive_growth(label):
    """The first element, its inverse and its derivative stay right while the field grows."""
    members = TOWERS[label]
    symbols = sorted({x}.union(*(e.free_symbols for e in members)), key=str)
    field = Field(symbols, sample=POINT)
    first = field.read(members[0])
    shifted = (first + 1).inverse()
    symbol = next((s for s in symbols if members[0].has(s)), x)
    slope = shifted.diff(symbol)
    for member in members[1:]:
        late = field.read(member)
        assert ((first + 1) * shifted - 1).is_zero is True
        assert shifted == field.read(1 / (members[0] + 1))
        assert shifted.diff(symbol) == slope
        assert (late * shifted) * (first + 1) == late


def test_equality_with_numbers():
    """Elements compare with integers and rationals by value."""
    field = Field([x])
    three = field.read(x) / field.read(x) * 3
    assert three == field.rational(3)
    assert three == 3
    assert three != 4


def test_elements_are_frozen():
    """An element's value cannot be changed."""
    element = Field([x]).read(x)
    with pytest.raises(AttributeError):
        element.value = 3  # pyright: ignore[reportAttributeAccessIssue] - that is the test
