"""Line code: the same straight line as Python and as expressions of heyoka."""

import math
import re

import pytest
import sympy as sp

from geomtorsion.exact import Field
from geomtorsion.exact.compile import python_function
from geomtorsion.exact.engine_code import array_names, scalar_names
from geomtorsion.exact.factored import factored
from geomtorsion.exact.line_code import line_expressions, line_source

x, y, z, a, b = SYMBOLS = sp.symbols("x y z a b")
NAMES = [str(symbol) for symbol in SYMBOLS]
TEXTS = (
    "a*b*x*y + a*b*y*z - a**2*x**5/7",
    "1/x + 1/(y*z) - 3/x**2",
    "sqrt(x**2 + a**2)**3*sin(y) - cos(y)**4*b",
    "exp(-x)*cosh(y) + log(1 + z**2) - sinh(a*z)",
    "(x + y)**3/(x + y + z)**2/b",
    "atan(x/2) + asin(y/4) - pi*z",
    "(1 + x**2)**(1/3)*y - 2",
    "-(x + y + z)",
    "a**2*b**3*x/3",
    "0",
)
POINT = [0.7, 1.3, 0.4, 0.6, 1.1]


def line_of(*texts):
    """The straight line of expressions, with a and b constant."""
    field = Field(SYMBOLS)
    table = dict(zip(NAMES, SYMBOLS, strict=True))
    outputs = [((field.read(sp.sympify(text, table)), ()),) for text in texts]
    line = factored(NAMES, outputs, ["a", "b"])
    assert line is not None
    return line


def expected(texts):
    """Values by sympy, to 30 digits."""
    values = dict(zip(SYMBOLS, map(sp.Rational, POINT), strict=True))
    table = dict(zip(NAMES, SYMBOLS, strict=True))
    return [float(sp.sympify(text, table).subs(values).evalf(30)) for text in texts]


@pytest.mark.parametrize("names", [scalar_names, array_names])
def test_python(names):
    """Python code on floats and on arrays gives what sympy gives."""
    source, functions = line_source(NAMES, line_of(*TEXTS))
    values = python_function(source, names(functions))(*POINT)
    assert list(values) == pytest.approx(expected(TEXTS), rel=1e-13)


def decomposition(hy, line):
    """What heyoka computes for x, y, z with these rates, as texts."""
    variables = hy.make_vars("x", "y", "z")
    known = dict(zip("xyz", variables, strict=True)) | {"a": hy.par[0], "b": hy.par[1]}
    rates = line_expressions(line, known, lambda p, q: hy.expression(p / q))
    made = hy.taylor_adaptive(list(zip(variables, rates, strict=True)), [0.0] * 3, tol=1e-9)
    return made, [str(node) for node, _ in made.decomposition]


def test_heyoka_values():
    """heyoka's expressions give what sympy gives, at each precision."""
    hy = pytest.importorskip("heyoka")
    import numpy as np

    known = dict(zip(NAMES, hy.make_vars(*NAMES), strict=True))
    line = line_of(*TEXTS)
    for kind, digits in ((float, 1e-13), (np.longdouble, 1e-13)):
        made = line_expressions(
            line, known, lambda p, q, kind=kind: hy.expression(kind(p) / kind(q))
        )
        function = hy.cfunc(made, list(known.values()), fp_type=kind)
        values = function(np.array(POINT, dtype=kind))
        assert [float(value) for value in values] == pytest.approx(expected(TEXTS), rel=digits)


def test_powers_have_derivatives_where_their_base_vanishes():
    """heyoka divides by x in its series of x**n, n > 2; ours are finite at x = 0."""
    hy = pytest.importorskip("heyoka")
    made, nodes = decomposition(hy, line_of("x**5*y + y", "x**7", "(x*y)**4 + z**3"))
    assert not any(re.search(r"\*\*(?!2\.0)", node) for node in nodes)
    made.state[:] = [0.0, 0.5, -0.25]
    made.step()
    assert made.state[0] > 0
    assert all(math.isfinite(value) for value in made.state)


def test_parameters_are_no_series():
    """Products of parameters are not computed as series, their products with one are."""
    hy = pytest.importorskip("heyoka")
    _, nodes = decomposition(hy, line_of("a*b*x*y", "a**2*x", "a*b*y*z"))
    assert not any(re.search(r"p\d.*p\d", node) for node in nodes)


def test_inverses_are_quotients():
    """1/x as a power costs more than as a quotient."""
    hy = pytest.importorskip("heyoka")
    _, nodes = decomposition(hy, line_of("1/x", "1/(1 + y**2)", "z"))
    assert not any("**-1" in node for node in nodes)
    assert sum("div" in node for node in nodes) == 2
