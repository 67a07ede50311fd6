"""numpy_function: all elements at many points in one call."""

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from sympy import exp, sin

from geomtorsion import numpy_function
from geomtorsion.errors import ArgumentError, MissingValueError, SingularPointError
from geomtorsion.exact import Field
from tests.exact.symbols import POINT, number, x, y
from tests.exact.test_reading import CONSTRUCTS
from tests.rounding import ROUNDED


def test_numpy_function_is_vectorised_and_right():
    """Arrays give one array per element, and each number agrees with mpmath."""
    expressions = [e for e in CONSTRUCTS.values() if not e.atoms(sp.core.function.AppliedUndef)]
    symbols = sorted(set().union(*(e.free_symbols for e in expressions)), key=str)
    field = Field(symbols, sample=POINT)
    elements = field.read_all([(f"[{i}]", e) for i, e in enumerate(expressions)])
    function = numpy_function(elements, symbols)
    scale = np.array([0.9, 1.05])
    values = function(*(float(POINT[s]) * scale for s in symbols))
    assert values.shape == (len(elements), 2)
    for column, factor in enumerate(scale):
        point = {s: sp.Rational(float(POINT[s]) * factor) for s in symbols}
        for row, expression in enumerate(expressions):
            wanted = float(number(expression, 30, {s: _fraction(v) for s, v in point.items()}))
            assert values[row, column] == pytest.approx(wanted, rel=1e-10), expression


def _fraction(value):
    """A sympy rational as a Fraction."""
    return Fraction(int(value.p), int(value.q))


def test_numpy_function_broadcasts():
    """Grids and scalars broadcast; constants fill the shape."""
    field = Field([x, y])
    function = numpy_function([field.read(x * y), field.read(3), field.read(sin(x))], [x, y])
    grid = function(np.linspace(0, 1, 4)[:, None], np.linspace(0, 1, 5)[None, :])
    assert grid.shape == (3, 4, 5)
    assert (grid[1] == 3).all()
    single = function(0.5, 2.0)
    assert np.shape(single) == (3,)
    assert single[0] == 1.0


def test_numpy_function_of_complex_elements():
    """Complex elements give complex arrays."""
    field = Field([x, y], complex=True)
    function = numpy_function([field.read(exp(sp.I * x) / (x + sp.I * y))], [x, y])
    value = function(np.array([0.3]), np.array([0.7]))[0, 0]
    assert abs(value - np.exp(0.3j) / (0.3 + 0.7j)) < ROUNDED


def test_missing_and_singular_arguments_are_named():
    """Too few arguments, a symbol without a value, and the first singular point are named."""
    field = Field([x, y])
    with pytest.raises(MissingValueError, match="y is not among the arguments"):
        numpy_function([field.read(x * y)], [x])
    function = numpy_function([field.read(x), field.read(1 / x)], [x, y])
    with pytest.raises(MissingValueError, match="expected 2 arguments"):
        function(1.0)
    with pytest.raises(SingularPointError, match="1/x has no finite value at x = 0, y = 2"):
        function([1.0, 0.0], [1.0, 2.0])
    assert np.isinf(numpy_function([field.read(1 / x)], [x], check=False)(0.0)).all()


def test_opaque_functions_without_a_form():
    """A function that neither numpy nor scipy has is refused by name."""
    element = Field([x]).read(sp.polylog(2, x))
    with pytest.raises(MissingValueError, match="has no NumPy form here"):
        numpy_function([element], [x])


@pytest.mark.parametrize(
    "given",
    [
        "1", ["1"], True, None, {}, {1.0, 2.0}, 1j, np.array([1j, 2.0]), [[1], [1, 2]], x,
        np.array(["2020-01-01"], dtype="M8[D]"), np.array([1, None]),
    ],
)  # fmt: skip
@pytest.mark.parametrize("check", [True, False])
def test_anything_but_a_real_number_is_refused(given, check):
    """Such an argument is not read as a number, cut to its real part, or left to NumPy."""
    function = numpy_function([Field([x, y]).read(x + y)], [x, y], check=check)
    with pytest.raises(ArgumentError, match="y: expected a number or an array of real numbers"):
        function(1.0, given)


@pytest.mark.parametrize(
    "given", [np.nan, np.inf, 10**400, np.ma.array([1.0, 2.0], mask=[False, True])]
)
def test_non_finite_arguments_are_refused_where_values_are_right(given):
    """With the check such an argument is refused; without it the value is not finite."""
    read = [Field([x, y]).read(x + y)]
    with pytest.raises(ArgumentError, match=r"y(\[1\])? = (nan|inf) is not finite"):
        numpy_function(read, [x, y])(1.0, given)
    assert not np.isfinite(numpy_function(read, [x, y], check=False)(1.0, given)[0, ...]).all()


def test_arguments_that_do_not_fit():
    """Shapes that do not fit, and a symbol given twice, are refused."""
    read = [Field([x, y]).read(x + y)]
    with pytest.raises(ArgumentError, match="expected numbers or arrays of one shape"):
        numpy_function(read, [x, y])([1.0, 2.0], [1.0, 2.0, 3.0])
    with pytest.raises(ArgumentError, match=r"symbols\[2\]: x occurs twice"):
        numpy_function(read, [x, y, sp.Symbol("x", positive=True)])
