"""Factoring: short graphs equal their sums, and are as short as by hand."""

import random
import subprocess
import sys
from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from geomtorsion.codegen import graph
from geomtorsion.codegen.steps import MANY_QUOTIENTS
from geomtorsion.codegen.sums import MOST_COMPARED
from geomtorsion.exact import Field
from tests.codegen.systems import (
    NAMES,
    SPACES,
    SYMBOLS,
    a,
    costly,
    expanded,
    geodesic_graph,
    geodesic_rates,
    products,
    read_back,
    x,
    y,
    z,
)
from tests.rounding import ROUNDED


@pytest.mark.parametrize(
    ("rows", "most"),
    [
        # Euler angles: the quotient by sin y is shared up to its sign.
        (
            [
                [("cos(x)*cos(y)/sin(y)", ("a",)), ("-sin(x)*cos(y)/sin(y)", ("b",))],
                [("-cos(x)/sin(y)", ("a",)), ("sin(x)/sin(y)", ("b",))],
                [("sin(x)", ("a",)), ("cos(x)", ("b",))],
            ],
            4 + 4 + 2,
        ),
        # A number in front of everything costs nothing; shared sums are computed once.
        ([[("3*x", ("z",)), ("3*y", ("z",))], [("x/2", ("a",)), ("y/2", ("a",))]], 2),
        # Three terms with a common factor.
        ([[("x*y*z", ()), ("x*y*a", ()), ("x*y*b", ())]], 2),
        # Roots: their squares are the radicands in the denominator.
        ([[("1/sqrt(x**2 + 1)**3", ("y",)), ("1/sqrt(x**2 + 1)**3", ("z",))]], 4),
        # A power of a sum is not multiplied out.
        ([[("(x + y + z)**8", ())]], 3),
        # Nothing to do, and an empty sum.
        ([[("1", ("x",))], []], 0),
    ],
)
def test_products_left(rows, most):
    """The number of products is as small as by hand, and the values are exact."""
    field = Field(SYMBOLS)
    outputs = products(field, rows)
    made = graph(NAMES, outputs)
    assert costly(made) <= most
    ones = [k for k, step in enumerate(made.steps) if step.kind == "number" and step.detail == 1]
    assert not any(step.kind == "product" and set(ones) & set(step.operands) for step in made.steps)
    assert read_back(made, field) == expanded(outputs, field)


def test_squares_are_cheaper_than_products():
    """x*x is taken before x*y: both ways share a factor of x**2*y, and one is a square."""
    made = graph(NAMES, [x**2 * y * z, x**2 * a])
    assert sum(step.kind == "square" for step in made.steps) == 1
    assert costly(made) == 4


def test_a_shared_product_is_worth_more_than_a_shared_number():
    """x*y*z + x*y*a: the product x*y of states is shared, not the cheap number."""
    made = graph(NAMES, [3 * x * y * z + 2 * x * y * a], ["a"])
    assert costly(made) == 2


def test_products_with_parameters_do_not_count_as_products():
    """Products with parameters are cheap; parameters are multiplied with each other once."""
    field = Field(SYMBOLS)
    outputs = products(field, [[("a*b*x*y", ())], [("a*x*y", ("z",))]])
    made = graph(NAMES, outputs, ["a", "b"])
    assert costly(made) == 2
    assert sum(1 for step in made.steps if step.constant and step.kind == "product") == 1


@pytest.mark.parametrize(
    ("count", "quotients"), [(MANY_QUOTIENTS - 1, MANY_QUOTIENTS - 1), (MANY_QUOTIENTS, 1)]
)
def test_many_quotients_share_an_inverse(count, quotients):
    """Many quotients by one value become products with its inverse; fewer stay quotients."""
    field = Field([*SYMBOLS, *sp.symbols("c0:9")])
    names = [symbol.name for symbol in field.symbols]
    outputs = [((field.read(1 / x), (f"c{k}",)),) for k in range(count)]
    made = graph(names, outputs)
    assert sum(1 for step in made.steps if step.kind == "quotient") == quotients
    assert read_back(made, field) == [field.read(c / x) for c in field.symbols[5 : 5 + count]]


def test_nothing_new_is_divided_by():
    """Factoring adds no divisor that may be zero."""
    field = Field(SYMBOLS)
    outputs = products(field, [[("a*x", ("y",)), ("b*x", ("z",))], [("a", ("y",)), ("b", ("z",))]])
    made = graph(NAMES, outputs, ["a", "b"])
    assert not any(step.kind in ("quotient", "root") for step in made.steps)
    assert made.python()(0.0, 0.0, 2.0, 0.0, 3.0) == (0.0, 6.0)


def test_long_sums_are_not_factored():
    """Sums of hundreds of terms are not factored, and keep their values."""
    field = Field(SYMBOLS)
    output = tuple((field.read(x**i * y**j), ("z",) * k) for i in range(6) for j in range(6)
                   for k in range(6))  # fmt: skip
    made = graph(NAMES, [output])
    assert made == graph(NAMES, [output], factor=False)
    expected = sum(0.5**i * 1.5**j * 2.0**k for i in range(6) for j in range(6) for k in range(6))
    assert made.python()(0.5, 1.5, 2.0, 0.0, 0.0) == pytest.approx((expected,), rel=ROUNDED)


@pytest.mark.parametrize(("terms", "left"), [(80, 1), (95, 2)])
def test_the_limit_of_factoring(terms, left):
    """n terms have n**2/2 pairs: below a third of the limit x*y + x*z becomes x*(y + z)."""
    assert (terms**2 // 2 < MOST_COMPARED // 3) is (left == 1)
    others = sp.symbols(f"c0:{terms - 2}")
    made = graph([*NAMES, *(c.name for c in others)], [x * y + x * z + sp.Add(*others)])
    assert costly(made) == left


@pytest.mark.parametrize(("exponent", "shared"), [(24, True), (25, False)])
def test_how_high_powers_share_factors(exponent, shared):
    """Terms of x^n share factors up to n = 24; from n = 25 on the power is one value."""
    rows = [x**exponent * y + x ** (exponent - 1) * z, x**exponent]
    assert (costly(graph(["x", "y", "z"], rows)) <= 10) is shared


@pytest.mark.parametrize("exponent", [24, 25, -25, 10**4])
def test_high_powers(exponent):
    """Powers that are too high to be written out are still squares and products."""
    made = graph(["x", "y"], [x**exponent * y + x**2])
    exact = Fraction(9, 8) ** exponent * 3 + Fraction(81, 64)
    assert made.exactly([Fraction(9, 8), 3]) == [exact]
    assert costly(made) < 2.1 * len(bin(abs(exponent)))


entries = st.builds(
    lambda n, powers, waves: (
        sp.Rational(n, 3) * x ** powers[0] * y ** powers[1] * a ** powers[2] * waves
    ),
    st.integers(-6, 6).filter(bool),
    st.tuples(*[st.integers(-2, 3)] * 3),
    st.sampled_from([sp.sin(z), sp.cos(z) / (1 + x**2), sp.sqrt(1 + y**2), sp.Integer(1), x + y]),
)
rows = st.lists(
    st.lists(st.tuples(entries, st.lists(st.sampled_from(NAMES), max_size=3)), max_size=5),
    min_size=1,
    max_size=4,
)


@settings(max_examples=60, deadline=None)
@given(rows)
def test_random_sums_stay_what_they_are(drawn):
    """Random sums, factored or not, read back exactly."""
    field = Field(SYMBOLS)
    outputs = [tuple((field.read(e), tuple(names)) for e, names in row) for row in drawn]
    expected = expanded(outputs, field)
    for factor in (True, False):
        made = graph(NAMES, outputs, ["a"], factor=factor)
        for value, sum_ in zip(read_back(made, field), expected, strict=True):
            assert (value - sum_).is_zero


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10**6))
def test_random_coefficients_of_a_frame(seed):
    """Quotients as in inverse frames: factored and plain graphs agree to 47 digits."""
    rng = random.Random(seed)
    functions = [sp.Integer(1), x, sp.sin(y), sp.cos(y), sp.exp(x), 1 + z**2, sp.sqrt(1 + x**2), a]
    matrix = sp.Matrix(3, 3, lambda i, j: rng.choice(functions) * int(i == j or rng.random() < 0.3))
    matrix += 3 * sp.eye(3)
    outputs = list(matrix.adjugate() / matrix.det())
    field = Field(SYMBOLS)
    elements = [field.read(entry) for entry in outputs]
    point = [sp.Rational(2 * k + 11, 16) for k in range(5)]
    short = graph(NAMES, elements, ["a"]).exactly(point, 170)
    plain = graph(NAMES, elements, ["a"], factor=False).exactly(point, 170)
    for one, two in zip(short, plain, strict=True):
        assert abs(one - two) < 1e-47 * (1 + abs(two))


# Products of two series, and all steps, in the equations of geodesics. These numbers must not
# grow.
OPERATIONS = {
    "so3": (10, 19), "kerr": (42, 80), "schwarzschild": (23, 41), "s2": (6, 16),
    "flat_spherical": (12, 20), "goedel": (4, 26),
}  # fmt: skip


@pytest.mark.parametrize("name", SPACES)
def test_operations_of_spaces(name):
    """Geodesics of shipped spaces cost at most the recorded number of products."""
    made = geodesic_graph(name)
    assert (costly(made), len(made.steps)) <= OPERATIONS[name]
    assert costly(made) < costly(geodesic_graph(name, factor=False))


@pytest.mark.parametrize("name", ["so3", "s2", "flat_spherical"])
def test_spaces_in_their_field(name):
    """Rates of shipped spaces: the graph equals the sum exactly."""
    states, parameters, rates = geodesic_rates(name)
    made = geodesic_graph(name)
    field = Field([sp.Symbol(n, real=True) for n in (*states, *parameters)])
    renamed = [
        tuple((field.read(e.sympy.xreplace({s: sp.Symbol(s.name, real=True) for s in e.symbols})),
               names) for e, names in row)
        for row in rates
    ]  # fmt: skip
    assert read_back(made, field) == expanded(renamed, field)


PROGRAM = """
from tests.codegen.systems import geodesic_graph
print(geodesic_graph("kerr").python_source())
"""


def test_the_same_in_every_process():
    """The graph does not depend on the order of hashes."""
    found = {
        subprocess.run(
            [sys.executable, "-c", PROGRAM],
            env={"PYTHONHASHSEED": seed, "PYTHONPATH": ":".join(sys.path)},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("1", "2")
    }
    assert len(found) == 1
    assert found.pop().startswith("def values(")


def test_numbers_are_written_exactly():
    """Fractions of a power of two are written as they are, others as a quotient of integers."""
    made = graph(NAMES, [x / 4, x / 3])
    assert made.python_source().endswith("return (0.25*a0, (1.0/3.0)*a0,)")
    details = {step.detail for step in made.steps if step.kind == "number"}
    assert details == {Fraction(1, 4), Fraction(1, 3)}


def drawn_sums(seed):
    """Three sums of five terms each, of products, powers and quotients."""
    pick = random.Random(seed).choice
    powers = dict.fromkeys((x, y, z), (0, 0, 1, 1, 2, -1))

    def term():
        factors = (symbol ** pick(powers.get(symbol, (0, 0, 1))) for symbol in SYMBOLS)
        return pick([1, 1, 2, 3]) * sp.Mul(*factors)

    return [sp.Add(*(term() for _ in range(5))) for _ in range(3)]


def series_cost(seed):
    """Cost of the graph of these sums on series, by measured costs."""
    made, total = graph(NAMES, drawn_sums(seed), ["a", "b"]), 0
    for step in made.steps:
        if step.kind in COSTS and not step.constant:
            scaled = any(made.steps[place].constant for place in step.operands)
            total += COSTS["scale"] if scaled else COSTS[step.kind]
    return total


COSTS = {"product": 100, "square": 40, "quotient": 130, "scale": 10}
MOVED = [("PRODUCT", 10), ("PRODUCT", 1000), ("SQUARE", 4), ("SQUARE", 400), ("QUOTIENT", 13)]
MOVED += [("QUOTIENT", 1300), ("SCALE", 100)]


def test_costs_of_operations_pay(monkeypatch):
    """With a cost ten times as large or small, the chosen graphs would cost more."""
    seeds = range(12)
    cost = sum(map(series_cost, seeds))
    for name, value in MOVED:
        with monkeypatch.context() as patch:
            patch.setattr(f"geomtorsion.codegen.sums.{name}", value)
            assert sum(map(series_cost, seeds)) > cost, name
