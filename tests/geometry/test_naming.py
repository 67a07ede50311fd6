"""Names: text printed with names means the same quantity and is short."""

from __future__ import annotations

import pickle
import random

import pytest
import sympy as sp
from sympy import cos, sin, sqrt

import geomtorsion as gt
from geomtorsion.errors import ArgumentError, ExpressionError, GeomtorsionError, UnknownNameError
from tests.chosen import one_in

t, r, theta, phi = sp.symbols("t r theta phi", real=True)
M, Q, L, a = sp.symbols("M Q Lambda a", positive=True)
SIGMA = r**2 + a**2 * cos(theta) ** 2
RADIAL = (r**2 + a**2) * (1 - L * r**2 / 3) - 2 * M * r + Q**2
POLAR = 1 + L * a**2 / 3 * cos(theta) ** 2
XI = 1 + L * a**2 / 3
QUANTITIES = {"Sigma": SIGMA, "Delta_r": RADIAL, "Delta_theta": POLAR, "Xi": XI}


def kerr_newman_de_sitter():
    """Carter's tetrad, without names."""
    time, turn = sqrt(RADIAL / SIGMA) / XI, sqrt(POLAR / SIGMA) * sin(theta) / XI
    coframe = [
        [time, 0, 0, -time * a * sin(theta) ** 2],
        [0, sqrt(SIGMA / RADIAL), 0, 0],
        [0, 0, sqrt(SIGMA / POLAR), 0],
        [a * turn, 0, 0, -turn * (r**2 + a**2)],
    ]
    return gt.Frame([t, r, theta, phi], coframe, signature=(-1, 1, 1, 1))


@pytest.fixture(scope="module")
def plain():
    """The frame without names."""
    return kerr_newman_de_sitter()


@pytest.fixture(scope="module")
def frame(plain):
    """The frame with the four names of the textbook."""
    return plain.named(**QUANTITIES)


def same(frame, written, element):
    """Whether a text with its names replaced is an element, decided exactly."""
    return (frame.field.read(written.subs(frame.names)) - element).is_zero


def test_einstein_tensor_as_a_person_writes_it(frame):
    """The tensor is -Lambda g plus the charge, in Sigma, Delta_r, Delta_theta and Xi."""
    einstein = gt.levi_civita(frame).curvature.einstein
    lines = str(einstein).splitlines()
    assert lines[1].strip() == (
        "G[0, 0] = (Delta_r*(Lambda*Sigma**2 + Q**2) + Delta_theta*a**2*(-Lambda*Sigma**2 + Q**2)"
        "*sin(theta)**2)/(Sigma**3*Xi**2)"
    )
    assert "G[1, 1] = -(Lambda*Sigma**2 + Q**2)/(Delta_r*Sigma)" in str(einstein)
    shown = einstein.to_sympy(short=True)
    assert [len(str(shown[i, j])) for i, j in ((0, 0), (0, 3), (3, 3))] == [110, 121, 140]


@pytest.mark.parametrize("name", ["coframe", "legs", "metric", "einstein", "torsion"])
def test_printed_forms_equal_the_quantity(frame, plain, name):
    """With names replaced each component is exact; text, LaTeX and HTML contain the same."""
    tensor, same_plain = frame.quantity(name), plain.quantity(name)
    shown = tensor.to_sympy(short=True)
    for index in tensor.components.support:
        assert same(frame, shown[index], tensor.element(*index))
        assert tensor.element(*index) == same_plain.element(*index)
        assert tensor[index] == same_plain[index]
        assert len(str(shown[index])) <= len(str(same_plain.to_sympy(short=True)[index]))
    for row in tensor.table():
        assert f"  {shown[row.index]}" in str(tensor.table())
    assert r"\Sigma" in tensor._repr_latex_()
    assert "Σ" in tensor._repr_html_()


def test_derivatives_see_through_names(frame, plain):
    """The derivative in r of a text with names replaced is the derivative of the component."""
    element = gt.levi_civita(frame).curvature.einstein.element(1, 1)
    shown = frame.written(element)
    slope = sp.diff(shown.subs(frame.names), r)
    assert (plain.field.read(slope) - element.diff(r)).is_zero


def test_texts_are_read_back(frame):
    """Our own reader reads printed text, with the names as symbols."""
    known = {s.name: s for s in (*frame.field.symbols, *frame.names)}
    for index, element in frame.metric.components.independent.items():
        back = gt.parse_expression(str(frame.written(element)), known)
        assert same(frame, back, element), index


def test_names_are_in_the_text_of_the_frame(frame):
    """The text of a frame lists the expressions of the names."""
    assert f"\n  Sigma = {SIGMA}\n" in repr(frame)
    assert "e^2 = sqrt(Delta_r*Sigma)/Delta_r dr" in repr(frame)
    assert frame.names[sp.Symbol("Xi")] == XI


def test_copies_and_equal_names(frame, plain):
    """Equal calls return the same frame, and a copy keeps the names."""
    assert plain.named(**QUANTITIES) is frame
    again = pickle.loads(pickle.dumps(frame.metric))
    assert str(again) == str(frame.metric)
    assert plain.names == {}


def test_names_in_names_and_texts(plain):
    """Earlier names may be used in later ones, in texts and in expressions."""
    longer = plain.named(rho2="r**2 + a**2*cos(theta)**2", u="rho2*(1 + Lambda*a**2/3)")
    assert longer.names[sp.Symbol("u")] == SIGMA * XI
    more = longer.named(v=sp.Symbol("rho2", positive=True) + M)
    assert list(map(str, more.names)) == ["rho2", "u", "v"]
    assert more.names[sp.Symbol("v")] == SIGMA + M


def test_quotients_and_roots():
    """f = 1 - 2 M/r in Schwarzschild's tetrad, in denominators and under roots."""
    x = sp.Symbol("r", positive=True)
    time, polar, angle = sp.symbols("t theta phi")
    f = 1 - 2 * M / x
    rows = sp.diag(sqrt(f), 1 / sqrt(f), x, x * sin(polar))
    hole = gt.Frame([time, x, polar, angle], rows, signature=(-1, 1, 1, 1)).named(f="1 - 2*M/r")
    assert str(hole.metric.to_sympy(short=True)[1, 1]) == "1/f"
    assert str(hole.coframe.to_sympy(short=True)[0, 0]) == "sqrt(f)"
    bar = gt.levi_civita(hole)
    shown = bar.coefficients.to_sympy(short=True)
    assert str(shown[0, 0, 1]) == "M*f/r**2"
    for index in bar.coefficients.components.support:
        assert same(hole, shown[index], bar.coefficients.element(*index))


def test_values_go_into_names_too(frame):
    """Values are also put into the expressions of names; a name of a number is dropped."""
    still = frame.subs({"a": sp.Rational(1, 2), "Lambda": 0})
    assert list(map(str, still.names)) == ["Sigma", "Delta_r"]
    assert still.names[sp.Symbol("Sigma")] == r**2 + cos(theta) ** 2 / 4
    assert str(still.metric.to_sympy(short=True)[1, 1]) == "Sigma/Delta_r"


@pytest.mark.parametrize("seed", one_in(2, range(30)))
def test_random_sums_and_names(seed):
    """Random polynomials of named expressions, with the names replaced, have their values."""
    numbers = random.Random(seed)
    x, y, z = sp.symbols("x y z", real=True)

    def short():
        """A sum of two or three terms, perhaps over a power."""
        terms = [
            numbers.randint(1, 3) * numbers.choice((x, y, z)) ** numbers.randint(1, 2)
            * numbers.choice((1, 1, sin(y), cos(y), sqrt(x**2 + 1), sp.exp(z)))
            for _ in range(numbers.randint(2, 3))
        ]  # fmt: skip
        return sp.Add(*terms) / numbers.choice((1, 1, x, x**2 + y**2))

    given = {"A": short(), "B": short(), "C": short()}
    A, B, C = given.values()
    base = gt.Frame([x, y, z], sp.eye(3))
    named = base.named(**given)
    for value in (A * B + C, (A**2 - B) / C, x * A - z * B**2, A * B * C + 1, (x + y) * A + B):
        element = base.field.read(value)
        shown = named.written(element)
        assert same(named, shown, element)
        assert len(str(shown)) <= len(str(element.sympy))


BAD = {
    "a coordinate": ({"r": "a + 1"}, ArgumentError, "r: expected a new name"),
    "a parameter": ({"M": "r + 1"}, ArgumentError, "M: expected a new name"),
    "a function": ({"sin": "r + 1"}, ArgumentError, "sin: expected a new name"),
    "no name": ({"2 x": "r + 1"}, ArgumentError, "2 x: expected a new name"),
    "an unknown symbol in a text": ({"S": "r + beta"}, ExpressionError, "beta"),
    "an unknown symbol": ({"S": r + sp.Symbol("beta")}, UnknownNameError, "got beta. Known are"),
    "zero": ({"S": "r - r"}, ArgumentError, "got a number"),
    "zero by an identity": ({"S": "sin(r)**2 + cos(r)**2 - 1"}, ArgumentError, "got a number"),
    "a number": ({"S": 3}, ArgumentError, "got a number"),
    "itself": ({"S": "S + r"}, ExpressionError, "S"),
    "a ring": ({"S": "T + r", "T": "S + r"}, ExpressionError, "T"),
    "a list": ({"S": [r]}, ExpressionError, "one expression"),
    "a float": ({"S": 0.5 * r}, GeomtorsionError, "0.5"),
    "code": ({"S": "__import__('os')"}, ExpressionError, "S"),
    "too long": ({"S": "(r + a + M + Q + 1)**20*(r - a + M*Q)**20"}, GeomtorsionError, "."),
}


@pytest.mark.parametrize("label", BAD)
def test_bad_names(plain, label):
    """Each bad name or expression is refused with its own message."""
    quantities, error, message = BAD[label]
    with pytest.raises(error, match=message):
        plain.named(**quantities)


def test_a_name_is_given_once(frame):
    """A name of the frame cannot be defined again."""
    with pytest.raises(ArgumentError, match="occurs twice"):
        frame.named(Sigma="r + 1")
