"""Separate: parts of one symbol each, coefficients of powers, and what clears quotients."""

import pytest
import sympy as sp

from geomtorsion.exact import Field
from geomtorsion.exact.separate import additive_parts, by_powers, clearing, specialised

R, THETA, Z, M, A = sp.symbols("r theta z M a")

APART = [
    R**2 + A**2 * sp.cos(THETA) ** 2,
    M / R - 1 / sp.sin(THETA) ** 2 + 7,
    (R * sp.sin(THETA) ** 2 + 1) / (R * sp.sin(THETA) ** 2),
    sp.exp(R) * M + sp.sinh(THETA) / sp.cosh(THETA),
    R / (R**2 - 2 * M * R + A**2) + sp.sin(THETA) * sp.cos(THETA),
    sp.sqrt(1 + R**2) + THETA**3,
    sp.Integer(3),
]


@pytest.mark.parametrize("expression", APART)
def test_parts_add_up(expression):
    """To all that there is, each part with its own symbol alone."""
    element = Field((R, THETA, M, A)).read(expression)
    found = additive_parts(element, [R, THETA])
    if expression == APART[2]:
        assert found is None
        return
    assert found is not None
    one, two = found
    assert one + two == element
    assert THETA not in one.symbols
    assert R not in two.symbols


def test_three_symbols():
    """Each of three, in any order."""
    field = Field((R, THETA, Z, M, A))
    element = field.read(R**2 / (1 + M) + sp.cos(THETA) ** 2 / sp.sin(THETA) + sp.exp(Z) - 4)
    for order in ([R, THETA, Z], [Z, R, THETA], [THETA, Z, R]):
        found = additive_parts(element, order)
        assert found is not None
        for part, symbol in zip(found, order, strict=True):
            assert not part.symbols & ({R, THETA, Z} - {symbol})
        assert found[0] + found[1] + found[2] == element
    assert additive_parts(field.read(R * THETA + Z), [R, THETA, Z]) is None


@pytest.mark.parametrize("expression", [1 / (R - 0) + THETA, 1 / (R * (R - 1)) + THETA])
def test_places_without_a_value_are_avoided(expression):
    """Zero and one are poles here."""
    element = Field((R, THETA)).read(expression)
    assert specialised(element, [R]) is not None
    assert specialised(Field((R, THETA)).read(sp.sqrt(R**2 + THETA)), [R]) is None


def test_coefficients_of_powers():
    """Sums of coefficient times power give the element back; no coefficient moves."""
    field = Field((R, THETA, M, A))
    element = field.read((A * R**3 - M * R + A**2 - 2 * A * M * R**3) / (1 + M) / (R - M) ** 2)
    pairs = by_powers(element, [R])
    total = field.zero
    for coefficient, power in pairs:
        assert R not in coefficient.symbols
        total = total + coefficient * power
    assert total == element
    assert len(pairs) == 3


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        (M / sp.sin(THETA) ** 2 - 1, sp.sin(THETA)),
        (1 / R**3 + 1 / R, R**2),
        (1 / (M * R), R),
        (R**2 - M, 1),
    ],
)
def test_what_clears_quotients(expression, expected):
    """Its square times the element has no quotient; parameters below stay."""
    field = Field((R, THETA, M, A))
    found = clearing([field.read(expression)], [R, THETA])
    assert found in (field.read(expected), -field.read(expected))
