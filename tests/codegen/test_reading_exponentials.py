"""Exponentials: sums of cosh and sinh that merge, and sums that do not."""

import mpmath
import numpy as np
import pytest
import sympy as sp

from geomtorsion.codegen import graph
from geomtorsion.codegen.reading import merged
from geomtorsion.exact import Field
from geomtorsion.exact.form import Sum, form
from tests.rounding import ROUNDED

X, Y = sp.symbols("x y", real=True)
SHORTER = {
    "difference": sp.cosh(X) - sp.sinh(X),
    "two arguments": (sp.cosh(X) - sp.sinh(X)) * Y + sp.cosh(Y) + sp.sinh(Y),
    "square": sp.cosh(X) ** 2 - 2 * sp.sinh(X) * sp.cosh(X) + sp.sinh(X) ** 2 + Y,
}
AS_LONG = {
    "one": sp.sinh(X) + 1,
    "no merging": 2 * sp.cosh(X) - sp.sinh(X),
    "other arguments": sp.cosh(X) - sp.sinh(Y),
}


def sums(expression):
    """The sums among the factors of an expression."""
    element = Field([X, Y]).read(expression)
    return [base for base, _ in form(element).powers if isinstance(base, Sum)]


@pytest.mark.parametrize("expression", SHORTER.values(), ids=SHORTER.keys())
def test_fewer_terms(expression):
    """At x = 20 the merged form has the digits that cosh - sinh loses in doubles."""
    assert any(merged(base) for base in sums(expression))
    found = graph(["x", "y"], [Field([X, Y]).read(expression)]).python()(20.0, 1.5)
    with mpmath.workdps(40):
        exact = sp.lambdify([X, Y], expression, "mpmath")(mpmath.mpf(20), mpmath.mpf("1.5"))
    assert found[0] == pytest.approx(float(exact), rel=ROUNDED)


@pytest.mark.parametrize("expression", AS_LONG.values(), ids=AS_LONG.keys())
def test_what_exp_does_not_shorten_stays(expression):
    """sinh is not rewritten, because exp(x) - exp(-x) loses its digits near zero."""
    assert not any(merged(base) for base in sums(expression))


def test_small_arguments_keep_their_digits():
    """sinh and tanh keep their digits near zero, beside a sum that merges."""
    elements = [Field([X]).read(e) for e in (sp.sinh(X), sp.tanh(X), sp.cosh(X) + sp.sinh(X) - 1)]
    small = 1e-9
    values = graph(["x"], elements).numpy()(np.array([small]))
    assert values[0] == pytest.approx(small, rel=ROUNDED)
    assert values[1] == pytest.approx(small, rel=ROUNDED)
    assert values[2] == pytest.approx(small, rel=1e-6)


@pytest.mark.parametrize(
    "expression",
    [
        1 / (1 + sp.exp(-(Y**2))),
        (3 + sp.exp(-(Y**2))) ** 2 / (2 + 5 * sp.exp(-2 * Y**2)) + X,
        (X + sp.exp(-(Y**2) / (2 * X**2))) / (1 + sp.exp(-(Y**2) / (2 * X**2)) * X),
        sp.exp(Y**2) / (sp.exp(Y**2) + sp.exp(X**2)),
    ],
    ids=["one", "powers", "width", "two"],
)
def test_ratios_of_what_overflows(expression):
    """exp(y**2) overflows at y = 40, but its ratios are right, and also near zero."""
    found = graph(["x", "y"], [Field([X, Y]).read(expression)])
    for x, y in ((1.5, 40.0), (1.5, 0.3), (1.0, 1000.0)):
        with mpmath.workdps(40):
            exact = sp.lambdify([X, Y], expression, "mpmath")(mpmath.mpf(x), mpmath.mpf(y))
        assert found.python()(x, y)[0] == pytest.approx(float(exact), rel=1e-13)
        assert found.numpy()(x, y)[0] == pytest.approx(float(exact), rel=1e-13)
