"""Writing: short forms as a person would write them, JSON and NumPy functions of equal value."""

import json

import pytest
import sympy as sp
from sympy import cos, cosh, cot, exp, log, sin, sinh, sqrt, tan

from geomtorsion.exact import Field, parse_expression
from tests.exact.symbols import POINT, a, f, g, m, p, r, theta, x, y
from tests.exact.test_reading import CONSTRUCTS

phi2 = sp.Symbol("phi2", real=True)

SHORT = {
    "cotangent of the paper": (cos(phi2) / sin(phi2), "cos(phi2)/sin(phi2)"),
    "cotangent": (cot(phi2), "cos(phi2)/sin(phi2)"),
    "reciprocal sine": (-1 / sin(phi2), "-1/sin(phi2)"),
    "one minus cosine squared": (1 - cos(x) ** 2, "sin(x)**2"),
    "product to sine squared": ((1 - cos(x)) * (1 + cos(x)), "sin(x)**2"),
    "one minus sine squared": (1 - sin(x) ** 2, "cos(x)**2"),
    "r squared sine squared": (r**2 - r**2 * cos(x) ** 2, "r**2*sin(x)**2"),
    "reciprocal of one minus cosine squared": (1 / (1 - cos(x) ** 2), "sin(x)**(-2)"),
    "cosh squared minus one": (cosh(x) ** 2 - 1, "sinh(x)**2"),
    "double angle kept": (sin(2 * x) / 2, "sin(2*x)/2"),
    "double angle beside the single": (sin(2 * x) + sin(x), "(2*cos(x) + 1)*sin(x)"),
    "tangent": (tan(x), "sin(x)/cos(x)"),
    "difference": (x - y, "x - y"),
    "Kerr's Sigma": (r**2 + a**2 * cos(theta) ** 2, "a**2*cos(theta)**2 + r**2"),
    "derivative": (sp.diff(f(r), r) / f(r), "Derivative(f(r), r)/f(r)"),
    "half": (x / 2, "x/2"),
    "power": (r**p, "r**p"),
    "root": (sqrt(r**2 + a**2), "sqrt(a**2 + r**2)"),
    "exponential": (exp(2 * x) * y, "y*exp(2*x)"),
    "reciprocal exponential": (exp(-x), "exp(-x)"),
    "zero": (sin(x) ** 2 + cos(x) ** 2 - 1, "0"),
}


@pytest.mark.parametrize("label", SHORT)
def test_short_forms(label):
    """Each expression prints as a person would write it, up to sympy's order of terms."""
    expression, wanted = SHORT[label]
    expression = sp.sympify(expression)
    field = Field(sorted(expression.free_symbols | {x, y}, key=str), sample=POINT)
    assert str(field.read(expression).sympy) == str(
        sp.sympify(
            wanted,
            locals={str(s): s for s in expression.free_symbols | {x, y}} | {"f": f, "g": g},
        )
    )


def test_schwarzschild_stays_short():
    """1 - 2M/r, its inverse and its root print at about the length of the textbook form."""
    field = Field([r, m], sample=POINT)
    for expression in (
        1 - 2 * m / r,
        1 / (1 - 2 * m / r),
        sqrt(1 - 2 * m / r),
        1 / sqrt(1 - 2 * m / r),
        m / (r**2 * sqrt(1 - 2 * m / r)),
    ):
        printed = str(field.read(expression).sympy)
        assert len(printed) <= len(str(expression)) + 8, printed


def test_factors_are_kept():
    """A product of many factors is not multiplied out."""
    field = Field([x, y])
    product = field.read((x + y) ** 9 * (x - 2 * y) ** 7 / (1 + x**2) ** 5)
    assert len(str(product.sympy)) < 60


@pytest.mark.parametrize("label", CONSTRUCTS)
def test_json_round_trip(label):
    """to_json survives json.dumps and gives the same element back."""
    expression = CONSTRUCTS[label]
    field = Field(sorted(expression.free_symbols, key=str), sample=POINT)
    element = field.read(expression)
    data = json.loads(json.dumps(element.to_json()))
    assert field.from_json(data, functions=("f", "g", "h")) == element


def test_parsed_text_is_read_like_sympy():
    """Text from the whitelist parser and sympy's own expression give the same element."""
    field = Field([r, m, theta], sample=POINT)
    names = {"r": r, "m": m, "theta": theta}
    text = "sqrt(1 - 2*m/r)*sin(theta)**2 + f(r)/r"
    parsed = parse_expression(text, symbols=names, functions={"f": f})
    assert field.read(parsed) == field.read(sqrt(1 - 2 * m / r) * sin(theta) ** 2 + f(r) / r)


def test_conversion_is_memoised():
    """The second conversion returns the same object."""
    element = Field([x]).read(log(1 + sinh(x) ** 2))
    assert element.sympy is element.sympy


def test_a_common_number_is_written_in_front():
    """A number that all terms share is written in front; even powers of a root contain no root."""
    r, M, Q, L = sp.symbols("r M Q Lambda", positive=True)
    field = Field([r, M, Q, L])
    root = field.read(sp.sqrt(1 - 2 * M / r + Q**2 / r**2 - L * r**2 / 3))
    inside = L * r**4 + 6 * M * r - 3 * Q**2 - 3 * r**2
    assert (-root * root).sympy == inside / (3 * r**2)
    assert (root**-4).sympy == 9 * r**4 / (-inside).expand() ** 2
    assert root.sympy == sp.sqrt((-3 * inside).expand()) / (3 * r)


def test_exponentials_are_joined():
    """exp(2 a) exp(-2 b) is one exponential, in products and in the terms of sums."""
    x, y = sp.symbols("x y", real=True)
    a, b = sp.Function("a"), sp.Function("b")
    field = Field([x, y])
    product = field.read(sp.exp(2 * a(x)) * sp.exp(-2 * b(x)))
    assert str(product.sympy) == "exp(2*a(x) - 2*b(x))"
    assert field.read(product.sympy) == product
    assert str(field.read(3 * sp.exp(x) * sp.exp(-y) * x).sympy) == "3*x*exp(x - y)"
    assert str(field.read(sp.exp(x) * sp.exp(y) + sp.sin(x)).sympy) == "exp(x + y) + sin(x)"


def test_long_quotients_have_their_numbers():
    """Values are right for a numerator of thousands of terms over a root with a zero conjugate."""
    x, y, z = sp.symbols("x y z")
    written = (1 + x + 2 * y + 3 * z) ** 22 / (x - sp.sqrt(y + z))
    element = Field([x, y, z]).read(sp.expand((1 + x + 2 * y + 3 * z) ** 22) / (x - sp.sqrt(y + z)))
    assert len(element._num) > 2000
    for place in ({x: -2, y: 3, z: sp.Rational(1, 7)}, {x: -2, y: 3, z: 1}):
        want = written.subs(place).evalf(40)
        have = element.evaluate(place, precision=120)
        assert abs(have - want) < sp.Float(10) ** -30 * abs(want)


ORDERED = {
    "symbols and powers": "x**2*y + 3*x*y**2 - x/2 + 7 - y*r**3 + x*y*r",
    "functions": "x*sin(x)*cos(y) + sin(x)**3 - 2*cos(y)*y + log(x)*sin(x) - 1/3 + cosh(r)*x",
    "derivatives": "f(r)*x**2 + g(r)*x - 3*f(r)**2 + y*g(r) - f(r)*g(r)*cos(x) + x",
}


@pytest.mark.parametrize("text", ORDERED.values(), ids=ORDERED.keys())
@pytest.mark.parametrize("slope", [False, True], ids=["itself", "derivative"])
def test_sums_and_products_have_the_order_of_sympy(text, slope):
    """Terms and factors have sympy's order, also after other expressions were written."""
    field = Field([x, y, r])
    element = field.read(parse_expression(text, {"x": x, "y": y, "r": r}))
    _ = (element * element).sympy
    shown = (element.diff(r) if slope else element).sympy
    assert shown.args == shown.func(*shown.args).args
    for part in sp.preorder_traversal(shown):
        if isinstance(part, sp.Add | sp.Mul):
            assert part == part.func(*part.args)


H = sp.Function("h")
SLOPES = {
    "second": (f(x), (x, x)),
    "mixed": (H(y, x), (y, y, x)),
    "at a composite place": (f(x * y), (x, y)),
    "of two composite places": (H(x + y, x * y), (x, y)),
    "of equal places": (H(x, x), (x,)),
    "inside": (f(g(x) + 1), (x, x)),
}


@pytest.mark.parametrize("label", SLOPES)
def test_slopes_are_read_back(label):
    """Derivatives of unknown functions are read back from text and from JSON."""
    function, symbols = SLOPES[label]
    field = Field([x, y])
    element = field.read(function)
    for symbol in symbols:
        element = element.diff(symbol)
    known = {"f": f, "g": g, "h": H}
    assert field.read(parse_expression(str(element), {"x": x, "y": y}, known)) == element
    assert field.from_json(json.loads(json.dumps(element.to_json())), tuple(known)) == element


def test_equal_slopes_are_written_alike():
    """A mixed derivative is written like sympy's, whichever argument comes first."""
    element = Field([x, y]).read(H(y, x)).diff(x).diff(y)
    assert element.sympy == H(y, x).diff(y, x)
    assert element.evaluate({H(y, x).diff(x, y): 3}) == 3.0
