"""Deeply nested functions: read, decided and evaluated correctly."""

from __future__ import annotations

from collections.abc import Callable

import mpmath
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.exact.modular import ModularPoint

x, y = sp.symbols("x y", positive=True)
Function = Callable[[sp.Expr], sp.Expr]
# Each function with its value and slope, from value and slope of its argument.
NESTED: dict[str, tuple[Function, Callable]] = {
    "logarithms": (lambda e: sp.log(2 + e), lambda v, d, at: (mpmath.log(2 + v), d / (2 + v))),
    "sines of sums": (
        lambda e: sp.sin(x + e),
        lambda v, d, at: (mpmath.sin(at + v), (1 + d) * mpmath.cos(at + v)),
    ),
    "exponentials": (
        lambda e: sp.exp(x - e / 2),
        lambda v, d, at: (mpmath.exp(at - v / 2), (1 - d / 2) * mpmath.exp(at - v / 2)),
    ),
    "roots": (
        lambda e: sp.sqrt(1 + e),
        lambda v, d, at: (mpmath.sqrt(1 + v), d / (2 * mpmath.sqrt(1 + v))),
    ),
}


@pytest.mark.parametrize("name", NESTED)
def test_thirty_levels(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """e(x)**2 dx**2 + x**2 dy**2 has R = 2 e'/(x e**3), with e of thirty functions nested.

    Common denominators and texts would grow like 2**30, and points with all roots be as rare.
    """
    # A point modulo a prime with thirty roots is searched as long as one with a single root.
    monkeypatch.setattr(ModularPoint, "_degrees", lambda self: [2])
    function, number = NESTED[name]
    e: sp.Expr = x
    for _ in range(30):
        e = function(e)
    frame = gt.Frame([x, y], [[e, 0], [0, x]])
    scalar = gt.levi_civita(frame).curvature.scalar
    assert scalar.is_zero is False
    with mpmath.workdps(60):
        at = mpmath.mpf("0.4")
        value, slope = at, mpmath.mpf(1)
        for _ in range(30):
            value, slope = number(value, slope, at)
        have = scalar.at({x: sp.Rational(2, 5), y: 0}, digits=40).item()
        assert abs(have - 2 * slope / (at * value**3)) < abs(have) * mpmath.mpf(10) ** -38
