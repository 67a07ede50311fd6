"""Limits and series: known results, comparison with fifty digits, and refusals with a reason."""

from __future__ import annotations

import mpmath
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError, SingularPointError, UndecidedError
from geomtorsion.exact import Field
from geomtorsion.exact.expansion import Approach, Expansion, limit

r, M, g = sp.symbols("r M g", positive=True)
x, y, k = sp.symbols("x y k", real=True)
f = sp.Function("f")

# expression, symbol, point, side, limit by hand.
LIMITS = [
    (sp.sin(x) / x, x, 0, 1, 1),
    (sp.sin(x) / x, x, 0, -1, 1),
    ((1 - sp.cos(x)) / x**2, x, 0, 1, sp.Rational(1, 2)),
    ((sp.tan(x) - x) / x**3, x, 0, 1, sp.Rational(1, 3)),
    ((x**2 - 1) / (x - 1), x, 1, 1, 2),
    (sp.sqrt(r**2 + M * r) - r, r, sp.oo, 1, M / 2),
    (sp.sqrt(1 - 2 * M / r), r, 2 * M, 1, 0),
    (sp.sqrt(r) / (sp.sqrt(r) + r), r, 0, 1, 1),
    ((1 + 1 / r) ** 3, r, sp.oo, 1, 1),
    (x * y, y, M, 1, M * x),
    (f(x) / (1 + x), x, 0, 1, f(0)),
    ((f(x) - f(0)) / x, x, 0, 1, sp.Derivative(f(x), x).subs(x, 0)),
    # Without series in powers: limits by comparison of growth.
    (sp.exp(-g * r), r, sp.oo, 1, 0),
    (r * sp.log(r), r, 0, 1, 0),
    (sp.tanh(x), x, sp.oo, 1, 1),
    (sp.atan(x), x, -sp.oo, -1, -sp.pi / 2),
    (sp.exp(1 / x), x, 0, -1, 0),
    (sp.exp(-1 / x**2), x, 0, 1, 0),
    (sp.cosh(x) / sp.exp(x), x, sp.oo, 1, sp.Rational(1, 2)),
    (1 / sp.log(r), r, 0, 1, 0),
]  # fmt: skip
# expression, symbol, point, order, series by hand.
SERIES = [
    (sp.sin(x) / x, x, 0, 4, 1 - x**2 / 6 + x**4 / 120),
    (1 / sp.sin(x), x, 0, 3, 1 / x + x / 6 + 7 * x**3 / 360),
    (sp.sqrt(1 - 2 * M / r), r, sp.oo, 3, 1 - M / r - M**2 / (2 * r**2) - M**3 / (2 * r**3)),
    (sp.sqrt(r + r**2), r, 0, 2, sp.sqrt(r) + r ** sp.Rational(3, 2) / 2),
    (1 / (x - k), x, k, 2, 1 / (x - k)),
    (sp.log(x), x, 1, 3, (x - 1) - (x - 1) ** 2 / 2 + (x - 1) ** 3 / 3),
    (1 / r**3, r, 0, 0, 1 / r**3),
    (1 / r**3, r, sp.oo, 2, 0),
    (x**2 + 1 / x, x, 0, 1, 1 / x),
    (sp.exp(x), x, 0, 0, 1),
    (f(x), x, 0, 1, f(0) + x * sp.Derivative(f(x), x).subs(x, 0)),
]  # fmt: skip


def expansion(expression, symbol, point, side=1):
    """Expansion in a field over the symbols that occur."""
    symbols = sorted(expression.free_symbols | {symbol} | sp.sympify(point).free_symbols, key=str)
    return Expansion(Field(symbols), expression, Approach(symbol, sp.sympify(point), side))


@pytest.mark.parametrize(("expression", "symbol", "point", "side", "value"), LIMITS)
def test_known_limits(expression, symbol, point, side, value):
    """Each limit equals the limit found by hand, exactly."""
    found = expansion(expression, symbol, point, side).limit()
    assert sp.simplify(found - value) == 0


@pytest.mark.parametrize(("expression", "symbol", "point", "order", "value"), SERIES)
def test_known_series(expression, symbol, point, order, value):
    """Each series equals the series found by hand, exactly."""
    found = expansion(expression, symbol, point).series(order)
    assert sp.simplify((found - value).doit()) == 0


@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_the_remainder_is_of_the_next_order(order):
    """The error of a series falls like the next power, measured with fifty digits."""
    entry = sp.sqrt(1 - 2 * M / r + k**2 / r**2) * sp.cos(x) / sp.sqrt(r**2 + k**2 * sp.cos(x) ** 2)
    values = {r: sp.Rational(7), M: sp.Rational(3, 2), x: sp.Rational(2, 3)}
    series = expansion(entry, k, 0).series(order)
    with mpmath.workdps(50):
        gaps = [
            abs(mpmath.mpmathify((entry - series).subs({**values, k: near}).evalf(50)))
            for near in (sp.Rational(1, 10**4), sp.Rational(1, 10**5))
        ]
        slope = mpmath.log10(gaps[0] / gaps[1])
    # The entry is even in k, so the next power is even.
    assert float(slope) == pytest.approx(order + 2 - order % 2, abs=1e-3)


def test_roots_keep_the_sign_that_they_have_near_the_point():
    """The root of a square has the sign that it has next to the point of expansion."""
    shape = (r - M) / sp.sqrt(sp.expand((r - M) ** 2))
    assert expansion(shape, r, M, 1).limit() == 1
    assert expansion(shape, r, M, -1).limit() == -1
    # Far from 0 this root is 2 x - 1, near it 1 - 2 x.
    assert expansion(sp.sqrt(1 - 4 * x + 4 * x**2), x, 0).series(1) == 1 - 2 * x
    # With a real symbol sympy writes the root of a square as an absolute value.
    assert expansion(sp.sqrt(x**2 + y**2) / x, y, 0).limit() == 1


@pytest.mark.parametrize(
    ("expression", "symbol", "point", "error", "message"),
    [
        (1 / x, x, 0, SingularPointError, "grows without bound as x -> 0 from above"),
        (sp.exp(x) / x**5, x, sp.oo, SingularPointError, "grows without bound as x -> oo"),
        (sp.sin(1 / x), x, 0, SingularPointError, "does not settle"),
        (sp.sin(x), x, sp.oo, SingularPointError, "does not settle"),
        (sp.exp(-k * r), r, sp.oo, UndecidedError, "cannot be computed. Declare the domain"),
        (f(x), x, sp.oo, UndecidedError, "cannot be computed"),
    ],
)
def test_expressions_without_a_limit_are_refused(expression, symbol, point, error, message):
    """The error states how the expression behaves at the point, or which signs to declare."""
    with pytest.raises(error, match=message):
        expansion(expression, symbol, point).limit()


@pytest.mark.parametrize("expression", [sp.log(x), sp.exp(1 / x), sp.sin(1 / x), r**g])
def test_expressions_without_a_series_are_refused(expression):
    """A function without finite derivatives at the point has no series in powers."""
    symbol = r if expression.has(r) else x
    with pytest.raises(SingularPointError, match="has no series in powers at"):
        expansion(expression, symbol, 0).series(2)


def test_two_sides_have_to_agree():
    """The error at a jump names both limits."""
    ways = [Approach(x, sp.S.Zero, side) for side in (1, -1)]
    assert limit(Field([x]), sp.sin(x) / x, ways) == 1
    with pytest.raises(SingularPointError, match=r"two limits: 1/\w+ as .* above, 0 as .* below"):
        limit(Field([x]), 1 / (2 + sp.exp(-1 / x)), ways, "g[0, 0]")
    with pytest.raises(GeomtorsionError, match=r"g\[0, 0\] = 1/x grows"):
        limit(Field([x]), 1 / x, ways, "g[0, 0]")


def test_a_wrong_answer_of_the_program_would_be_found(monkeypatch):
    """A wrong limit by sympy is detected, because numbers next to the point contradict it."""
    monkeypatch.setattr(sp, "limit", lambda *_: sp.Rational(1, 3))
    with pytest.raises(UndecidedError, match="cannot be computed"):
        expansion(sp.tanh(x), x, sp.oo).limit()


def test_names_do_not_clash():
    """A symbol of the user may have the name of the internal expansion symbol."""
    w, w_ = sp.symbols("w w_", real=True)
    assert expansion(w_ * sp.sin(w) / w, w, 0).series(2) == w_ - w_ * w**2 / 6


def test_a_limit_does_not_hold_the_variable_of_its_expansion():
    """Metric of Kerr and Schild: a root of x**2 + y**2 + z**2 beside roots that hold the mass."""
    mass, *places = sp.symbols("M x y z")
    root = sp.sqrt(sum(s**2 for s in places))
    null = [1, *(s / root for s in places)]
    rows = [[2 * mass / root * a * b for b in null] for a in null]
    for i, sign in enumerate((-1, 1, 1, 1)):
        rows[i][i] += sign
    frame = gt.Frame.from_metric(["t", *places], rows, parameters=[mass])
    third, point = sp.Rational(1, 3), dict(zip(places, (2, 3, 6), strict=True))
    value = frame.metric.limit(mass, third)
    for i, row in enumerate(rows):
        for k, entry in enumerate(row):
            assert value[i, k].free_symbols <= {*places, mass}
            assert sp.simplify(value[i, k].subs(point) - entry.subs(mass, third).subs(point)) == 0
