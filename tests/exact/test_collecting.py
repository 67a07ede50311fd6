"""Collecting: sums are written by powers of a symbol where that is shorter."""

from __future__ import annotations

import random

import pytest
import sympy as sp
from sympy import cos, exp, sin, sqrt

import geomtorsion as gt
from geomtorsion.exact import Field

a, b, c, x, y, z = sp.symbols("a b c x y z", real=True)

SHORT = {
    "a square beside a symbol": (x**2 + 2 * x * y + y**2 + z, "z + (x + y)**2"),
    "a pair of brackets must pay": (a * x + a * y + 1, "a*x + a*y + 1"),
    "brackets that pay": (a * x + a * y + a * z + 1, "a*(x + y + z) + 1"),
    "Kerr's Delta": (x**2 - 2 * a * x + b**2, "-2*a*x + b**2 + x**2"),
    "two levels": (
        sp.expand(a * (x + y + 1) ** 2 + b * (y + z) ** 3 + c),
        "a*(x + y + 1)**2 + b*(y + z)**3 + c",
    ),
    "sines come back": (
        sp.expand(a * (x**2 + y**2 * cos(z) ** 2) ** 2 + b**2 * (1 - cos(z) ** 2)),
        "a*(x**2 + y**2*cos(z)**2)**2 + b**2*sin(z)**2",
    ),
    "exponentials": (
        sp.expand(exp(x) * (a + b + c) ** 2 + 1),
        "(a + b + c)**2*exp(x) + 1",
    ),
    "roots": (sp.expand(sqrt(x) * (a + b) ** 3 + c), "c + sqrt(x)*(a + b)**3"),
}


@pytest.mark.parametrize("label", SHORT)
def test_the_shorter_way_is_taken(label: str) -> None:
    """A sum is written as powers and brackets only if that text is shorter."""
    expression, wanted = SHORT[label]
    assert str(Field([a, b, c, x, y, z]).read(expression).short) == wanted


@pytest.mark.parametrize(("others", "is_collected"), [(9, True), (10, False)])
def test_how_long_a_sum_is_collected(others: int, is_collected: bool) -> None:
    """A sum of 1,809 terms in 11 symbols is collected; one of 1,810 terms in 12 symbols is not."""
    symbols = sp.symbols(f"s:{others}")
    table = [y**j * z**k for j in range(30) for k in range(60)]
    long = sp.Add(*((2 * k + 3) * term for k, term in enumerate(table)), *symbols)
    written = Field([y, z, *symbols]).read(long).short
    assert (len(written.args) < 100) == is_collected


@pytest.mark.parametrize("seed", range(20))
def test_collected_forms_are_equal(seed: int) -> None:
    """The collected form of a random sum equals it by sympy's expansion and is not longer."""
    numbers = random.Random(seed)
    symbols = (a, b, x, y)

    def short() -> sp.Expr:
        return sp.Add(*(numbers.randint(-3, 3) * s ** numbers.randint(0, 2) for s in symbols))

    whole = sp.expand(sp.Add(*(sp.prod(short() for _ in range(3)) for _ in range(3))))
    written = Field(symbols).read(whole).short
    assert sp.expand(written) == whole
    assert len(str(written)) <= len(str(whole))


LONG = ((0, 0), (0, 3), (3, 3))


def test_kerr_newman_de_sitter() -> None:
    """The Einstein tensor is -Lambda g plus the part of the charge, with powers of Sigma kept."""
    t, r, theta, phi = sp.symbols("t r theta phi", real=True)
    M, Q, L, k = sp.symbols("M Q Lambda a", positive=True)
    sigma = r**2 + k**2 * cos(theta) ** 2
    radial = (r**2 + k**2) * (1 - L * r**2 / 3) - 2 * M * r + Q**2
    polar, xi = 1 + L * k**2 / 3 * cos(theta) ** 2, 1 + L * k**2 / 3
    time, turn = sqrt(radial / sigma) / xi, sqrt(polar / sigma) * sin(theta) / xi
    coframe = [
        [time, 0, 0, -time * k * sin(theta) ** 2],
        [0, sqrt(sigma / radial), 0, 0],
        [0, 0, sqrt(sigma / polar), 0],
        [k * turn, 0, 0, -turn * (r**2 + k**2)],
    ]
    frame = gt.Frame([t, r, theta, phi], coframe, signature=(-1, 1, 1, 1))
    einstein = gt.levi_civita(frame).curvature.einstein
    charge = sp.diag(-1, -1, 1, 1) * Q**2 / sigma**2
    field, metric = frame.metric.element(0, 0).field, sp.Matrix(coframe)
    expected = metric.T * sp.diag(-1, 1, 1, 1) * (charge - L * sp.eye(4)) * metric
    for i in range(4):
        for j in range(4):
            element = field.read(expected[i, j])
            assert (einstein.element(i, j) - element).is_zero
            # Its text, read again, gives the same element.
            names = {str(s): s for s in (t, r, theta, phi, M, Q, L, k)}
            back = field.read(gt.parse_expression(str(einstein.element(i, j).short), names))
            assert (back - element).is_zero
    inside = "Lambda*(a**2*cos(theta)**2 + r**2)**2"
    assert str(einstein.element(2, 2).short) == (
        f"-3*({inside} - Q**2)/((a**2*cos(theta)**2 + r**2)*(Lambda*a**2*cos(theta)**2 + 3))"
    )
    assert f"G[1, 1] = 3*({inside} + Q**2)/" in str(einstein)
    # With multiplied-out numerators they had 729, 622 and 1131 letters.
    assert [len(str(einstein.element(i, j).short)) for i, j in LONG] == [347, 314, 467]


def test_a_text_with_many_roots_ends() -> None:
    """The text of a scalar with many roots is written and read back in reasonable time."""
    rows = [
        [sp.atan(sqrt(x + 1)) + 4, 0, sp.asin(y / 3) / 2],
        [0, sp.atan(z) ** 2 + 4, sp.atan(sqrt(y + 1))],
        [sp.asinh(z) / 3, sp.atan(x) ** 2, y / sqrt(y**2 + 1) + 4],
    ]
    scalar = gt.levi_civita(gt.Frame([x, y, z], rows, signature=(-1, 1, 1))).curvature.scalar
    back = gt.parse_expression(str(scalar[()]), {"x": x, "y": y, "z": z})
    element = scalar.element()
    assert (element.field.read(back) - element).is_zero
