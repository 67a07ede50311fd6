"""Complex fields: values on the principal branch, conjugation, roots of one, logarithms."""

import mpmath
import pytest
import sympy as sp
from sympy import I, atan, cosh, exp, log, pi, sin, sqrt, tan

from geomtorsion.errors import ExpressionError
from geomtorsion.exact import Field
from tests.exact.symbols import POINT, a, m, number, r, x, y

CASES = {
    "rational": (x - 2 * I * y) / (r + I * m) ** 2,
    "exponential": exp(I * x) / (1 + exp(2 * I * y)),
    "exponential of a sum": exp(x + I * y) * exp(-2 * I * x),
    "sine of a complex sum": sin(x + I * y) - cosh(x - I * y),
    "tangent": tan(x + I * y),
    "root": sqrt(x + I * y),
    "root of the conjugate": sqrt(x - I * y),
    "root in the second quadrant": sqrt(-x + I * y),
    "root in the third quadrant": sqrt(-x - I * y),
    "root of a negative number": sqrt(-r) * sqrt(-m) + sqrt(-1 - r**2),
    "two conjugate roots": sqrt(x - I * y) * sqrt(x + I * y),
    "reciprocal root": 1 / sqrt(x - I * y),
    "cube root": (x + I * y) ** sp.Rational(1, 3),
    "root of an exponential": sqrt(exp(I * x) + 2),
    "root of the unit": sqrt(I) + sqrt(1 - I),
    "logarithm": log(x + I * y) - log(x - I * y),
    "logarithm of a negative number": log(-r) + log(-I * m),
    "arc tangent": atan((x + I * y) / 4),
    "power": (x + I * y) ** r,
    "power of the unit": I**r + (-1) ** m,
    "exponential of a root": exp(sqrt(x + I * y)),
    "Kerr": 1 / (r - I * a * sp.cos(x)) ** 3,
}


def field_of(expression):
    """A complex field over the symbols of an expression."""
    return Field(sorted(expression.free_symbols, key=str), complex=True, sample=POINT)


def value(element):
    """The value at POINT, 40 digits."""
    symbols = element.field.symbols
    return mpmath.mpmathify(element.evaluate({s: POINT[s] for s in symbols}, precision=140))


@pytest.mark.parametrize("label", CASES)
def test_principal_values(label):
    """Element, written form and derivative have the principal values that mpmath gives."""
    expression = CASES[label]
    element = field_of(expression).read(expression)
    wanted = number(expression, 60)
    with mpmath.workdps(50):
        assert abs(value(element) - wanted) < 1e-35
        assert abs(number(element.sympy, 60) - wanted) < 1e-35
        for symbol in sorted(expression.free_symbols, key=str):
            slope = number(sp.diff(expression, symbol), 60)
            assert abs(value(element.diff(symbol)) - slope) < 1e-32 * max(1, abs(slope))


@pytest.mark.parametrize("label", CASES)
def test_conjugation(label):
    """The conjugate has the conjugate value; its conjugate is e; e times it is real."""
    element = field_of(CASES[label]).read(CASES[label])
    conjugate = element.conjugate()
    with mpmath.workdps(50):
        assert abs(value(conjugate) - mpmath.conj(value(element))) < 1e-35
        assert abs(mpmath.im(value(element * conjugate))) < 1e-35
        assert abs(value(conjugate.conjugate()) - value(element)) < 1e-35


@pytest.mark.parametrize("label", CASES)
def test_inverses(label):
    """e * (1 / e) is one."""
    element = field_of(CASES[label]).read(CASES[label])
    assert element * element.inverse() == element.field.one


@pytest.mark.parametrize("first", [sqrt(x + I * y), sqrt(x - I * y)], ids=str)
def test_conjugate_roots_in_either_order(first):
    """sqrt(z) sqrt(conj z) = |z|, whichever is read first."""
    field = field_of(x + y)
    field.read(first)
    product = field.read(sqrt(x + I * y)) * field.read(sqrt(x - I * y))
    assert product == field.read(sqrt(x**2 + y**2))


def test_imaginary_unit():
    """I * I = -1; a real field has no imaginary unit."""
    field = field_of(x + y)
    assert field.imaginary * field.imaginary == -1
    assert field.imaginary.conjugate() == -field.imaginary
    with pytest.raises(ExpressionError, match="complex"):
        _ = Field([x]).imaginary


def test_fifth_roots_of_one():
    """The fifth root of one plus its conjugate is (sqrt(5) - 1) / 2."""
    field = field_of(x + y)
    one = field.read(exp(2 * I * pi / 5))
    assert one**5 == 1
    assert 2 * (one + one.conjugate()) == field.read(sqrt(5) - 1)
