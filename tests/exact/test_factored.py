"""Factored: short straight lines equal the sums that they were made of."""

import subprocess
import sys
from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from geomtorsion.exact import Field
from geomtorsion.exact.compile import python_function
from geomtorsion.exact.engine_code import python_source
from geomtorsion.exact.factored import factored
from geomtorsion.exact.line_code import line_source
from geomtorsion.exact.straight_line import MANY_QUOTIENTS
from geomtorsion.geometry import Frame
from geomtorsion.motion.equations import velocity_names
from geomtorsion.motion.laws import Hamel
from geomtorsion.motion.system import System
from geomtorsion.spaces import load

x, y, z, a, b = SYMBOLS = sp.symbols("x y z a b")
NAMES = [str(symbol) for symbol in SYMBOLS]
# What costs as much as a product of two series.
DEAR = ("product", "square", "quotient", "root", "call")


def read_back(line, field):
    """The outputs of a straight line, worked out again in a field."""
    values = []
    names = {symbol.name: field.read(symbol) for symbol in field.symbols}
    for step in line.steps:
        inner = [values[p] for p in step.operands] if step.kind != "sum" else []
        if step.kind == "symbol":
            values.append(names[step.detail])
        elif step.kind == "number":
            values.append(field.rational(step.detail.numerator, step.detail.denominator))
        elif step.kind == "sum":
            total = field.zero
            for sign, place in step.operands:
                total = total + sign * values[place]
            values.append(total)
        elif step.kind == "product":
            values.append(inner[0] * inner[1])
        elif step.kind == "square":
            values.append(inner[0] * inner[0])
        elif step.kind == "quotient":
            values.append(inner[0] / inner[1])
        elif step.kind == "root":
            assert step.detail == 2
            values.append(inner[0].sqrt())
        else:
            function = getattr(sp, step.detail)
            values.append(field.read(function(*(value.sympy for value in inner))))
    return [sign * values[place] for sign, place in line.outputs]


def dear(line):
    """How many steps cost a product of two series."""
    return sum(
        1
        for step in line.steps
        if step.kind in DEAR and not any(line.steps[p].constant for p in step.operands)
    )


def products(field, rows):
    """Sums of products from texts."""
    return [
        tuple((field.read(sp.sympify(entry, dict(zip(NAMES, SYMBOLS, strict=True)))), factors)
              for entry, factors in row)
        for row in rows
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("rows", "most"),
    [
        # Euler angles: what stands over sin y is shared up to its sign.
        (
            [
                [("cos(x)*cos(y)/sin(y)", ("a",)), ("-sin(x)*cos(y)/sin(y)", ("b",))],
                [("-cos(x)/sin(y)", ("a",)), ("sin(x)/sin(y)", ("b",))],
                [("sin(x)", ("a",)), ("cos(x)", ("b",))],
            ],
            4 + 4 + 2,
        ),
        # A number in front of everything costs nothing, shared sums are made once.
        ([[("3*x", ("z",)), ("3*y", ("z",))], [("x/2", ("a",)), ("y/2", ("a",))]], 2),
        # Three terms with one factor in common.
        ([[("x*y*z", ()), ("x*y*a", ()), ("x*y*b", ())]], 2),
        # Roots: their squares are what stands below them.
        ([[("1/sqrt(x**2 + 1)**3", ("y",)), ("1/sqrt(x**2 + 1)**3", ("z",))]], 4),
        # A sum to a power is not multiplied out.
        ([[("(x + y + z)**8", ())]], 3),
        # Nothing to do, and nothing at all.
        ([[("1", ("x",))], []], 0),
    ],
)
def test_products_left(rows, most):
    """As few products as by hand; the values are those of the sums, exactly."""
    field = Field(SYMBOLS)
    outputs = products(field, rows)
    line = factored(NAMES, outputs)
    assert line is not None
    assert dear(line) <= most
    ones = [k for k, step in enumerate(line.steps) if step.kind == "number" and step.detail == 1]
    assert not any(step.kind == "product" and set(ones) & set(step.operands) for step in line.steps)
    for value, output in zip(read_back(line, field), outputs, strict=True):
        expected = field.zero
        for element, factors in output:
            for name in factors:
                element = element * field.read(SYMBOLS[NAMES.index(name)])
            expected = expected + element
        assert value == expected


def test_products_with_parameters_are_no_products():
    """What parameters multiply is shared first; parameters are multiplied with each other once."""
    field = Field(SYMBOLS)
    outputs = products(field, [[("a*b*x*y", ())], [("a*x*y", ("z",))]])
    line = factored(NAMES, outputs, ["a", "b"])
    assert line is not None
    assert dear(line) == 2
    assert sum(1 for step in line.steps if step.constant and step.kind == "product") == 1


def test_many_quotients_share_an_inverse():
    """So many quotients by one value become products with its inverse; fewer stay."""
    field = Field([*SYMBOLS, *sp.symbols("c0:9")])
    names = [symbol.name for symbol in field.symbols]
    for count, quotients in ((MANY_QUOTIENTS - 1, MANY_QUOTIENTS - 1), (MANY_QUOTIENTS, 1)):
        outputs = [((field.read(1 / x), (f"c{k}",)),) for k in range(count)]
        line = factored(names, outputs)
        assert line is not None
        assert sum(1 for step in line.steps if step.kind == "quotient") == quotients
        assert read_back(line, field) == [
            field.read(symbol / x) for symbol in field.symbols[5 : 5 + count]
        ]


def test_nothing_new_is_divided_by():
    """A coefficient that is zero, or a factor that vanishes, divides nothing."""
    field = Field(SYMBOLS)
    outputs = products(field, [[("a*x", ("y",)), ("b*x", ("z",))], [("a", ("y",)), ("b", ("z",))]])
    line = factored(NAMES, outputs, ["a", "b"])
    assert line is not None
    assert not any(step.kind in ("quotient", "root") for step in line.steps)
    function = python_function(line_source(NAMES, line)[0], {})
    assert function(0.0, 0.0, 2.0, 0.0, 3.0) == (0.0, 6.0)


def test_what_is_too_long_is_left_alone():
    """Sums of hundreds of terms are refused, at once."""
    field = Field(SYMBOLS)
    output = tuple((field.read(x**i * y**j), ("z",) * k) for i in range(6) for j in range(6)
                   for k in range(6))  # fmt: skip
    assert factored(NAMES, [output]) is None


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
    """Random sums, read back exactly; and their code against the plain one."""
    field = Field(SYMBOLS)
    outputs = [tuple((field.read(e), tuple(names)) for e, names in row) for row in drawn]
    line = factored(NAMES, outputs, ["a"])
    assert line is not None
    for value, output in zip(read_back(line, field), outputs, strict=True):
        expected = field.zero
        for element, names in output:
            for name in names:
                element = element * field.read(SYMBOLS[NAMES.index(name)])
            expected = expected + element
        assert (value - expected).is_zero
    check_codes(NAMES, outputs, line)


def check_codes(names, outputs, line):
    """Both codes at one point, to 40 digits; numbers such as 1/3 are rounded in neither."""
    import mpmath

    with mpmath.workdps(50):
        table = {name: getattr(mpmath, name) for name in ("sin", "cos", "sqrt", "exp")}
        point = [mpmath.mpf(2 * k + 11) / 16 for k in range(len(names))]
        results = []
        for source, _ in (python_source(names, outputs), line_source(names, line)):
            table["mpf"] = mpmath.mpf
            exact = source.replace("1.0/3.0", "mpf(1)/3").replace("2.0/3.0", "mpf(2)/3")
            results.append(python_function(exact, table)(*point))
        for plain, short in zip(*results, strict=True):
            assert abs(plain - short) <= mpmath.mpf(10) ** -14 * (1 + abs(plain))


def frame_system(frame):
    """Legs and rates of geodesics of a frame."""
    names = velocity_names(frame)
    law = Hamel().rates(frame, names)
    assert law is not None
    legs = [tuple((v, (names[i],)) for i, v in row) for row in frame.legs.components.rows]
    rates = [*legs, *law.products]
    states = (*(symbol.name for symbol in frame.coordinates), *names)
    found = {s.name for row in rates for element, _ in row for s in element.symbols}
    return System(states, tuple(sorted(found - set(states))), tuple(rates), ())


@pytest.mark.parametrize("name", ["so3", "kerr", "schwarzschild", "s2", "flat_spherical", "goedel"])
def test_spaces_in_their_field(name):
    """Rates of shipped spaces, and their derivatives: the straight line is the sum, exactly."""
    frame = load(name).frame
    system = frame_system(frame)
    names = (*system.states, *system.parameters)
    known = {s.name: s for s in frame.field.symbols}
    field = Field([known.get(n, sp.Symbol(n, real=True)) for n in names])
    for outputs in (system.rates, system.jacobian_system[::5]):
        line = factored(names, outputs, system.parameters)
        assert line is not None
        plain = sum(len(factors) for output in outputs for _, factors in output)
        assert dear(line) < plain + 60
        check_codes(names, outputs, line)
        if name in ("so3", "s2", "flat_spherical"):
            for value, output in zip(read_back(line, field), outputs, strict=True):
                expected = field.zero
                for element, factors in output:
                    moved = field.read(element.sympy)
                    for factor in factors:
                        moved = moved * field.read(known.get(factor, sp.Symbol(factor, real=True)))
                    expected = expected + moved
                assert (value - expected).is_zero


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10**6))
def test_random_frames(seed):
    """Frames of random functions: both codes agree to the last digits."""
    import random

    rng = random.Random(seed)
    functions = [sp.Integer(1), x, sp.sin(y), sp.cos(y), sp.exp(x), 1 + z**2, sp.sqrt(1 + x**2), a]
    rows_ = [[rng.choice(functions) if i == j or rng.random() < 0.3 else sp.Integer(0)
             for j in range(3)] for i in range(3)]  # fmt: skip
    for i in range(3):
        rows_[i][i] += 3
        for j in range(i):
            rows_[i][j] = sp.Integer(0)
    system = frame_system(Frame([x, y, z], rows_))
    names = (*system.states, *system.parameters)
    line = factored(names, system.rates, system.parameters)
    assert line is not None
    check_codes(names, system.rates, line)


PROGRAM = """
from tests.exact.test_factored import frame_system, load
print(frame_system(load("kerr").frame).code[0])
"""


def test_the_same_in_every_process():
    """The order of hashes plays no part."""
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
    """Fractions of a power of two as they are, others as quotient of whole numbers."""
    field = Field(SYMBOLS)
    outputs = products(field, [[("x/4", ())], [("x/3", ())]])
    line = factored(NAMES, outputs)
    assert line is not None
    source, _ = line_source(NAMES, line)
    assert source.endswith("return (0.25*a0, (1.0/3.0)*a0,)")
    details = {step.detail for step in line.steps if step.kind == "number"}
    assert details == {Fraction(1, 4), Fraction(1, 3)}
