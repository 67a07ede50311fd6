"""Rational basis: the rational coefficients of a combination, also of vectors of quotients."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest
import sympy as sp

from geomtorsion.exact import Field
from geomtorsion.exact.arguments import express

x, y = sp.symbols("x y")
FACTORS = (x, x + 1, x - y, x**2 + y, sp.cos(x) + 2, sp.sqrt(x + 1) + y)


def random_vector(rng: random.Random, field: Field) -> list:
    """Two quotients whose denominators are products of a few factors."""
    rows = []
    for _ in range(2):
        above = rng.randint(1, 3) + rng.randint(0, 2) * rng.choice((x, y, sp.sin(x), sp.sqrt(x)))
        below = sp.Mul(*(rng.choice(FACTORS) ** rng.randint(0, 2) for _ in range(2)))
        rows.append(field.read(above / below))
    return rows


@pytest.mark.parametrize("seed", range(20))
def test_a_combination_is_found(seed: int) -> None:
    """The coefficients of a combination are found, also for a vector with a pole of its own."""
    rng = random.Random(seed)
    field = Field([x, y])
    basis = [random_vector(rng, field) for _ in range(5)]
    shares = [Fraction(rng.randint(-3, 3), rng.randint(1, 3)) for _ in basis]
    target = [field.sum((q, v[row]) for q, v in zip(shares, basis, strict=True)) for row in (0, 1)]
    found = express(field, target, basis)
    assert found is not None
    again = [field.sum((q, v[row]) for q, v in zip(found, basis, strict=True)) for row in (0, 1)]
    assert again == target
    # A function that occurs in no vector takes the target out of their span.
    for extra in (1 / (x + 7), 1 / x**9, sp.sin(y)):
        beyond = [target[0] + field.read(extra), target[1]]
        assert express(field, beyond, basis) is None


def test_only_a_pole_of_its_own_takes_a_vector_out() -> None:
    """1/(x (x + 1)) = 1/x - 1/(x + 1): both vectors are needed, although each has only one pole."""
    field = Field([x])
    target = [field.read(1 / (x * (x + 1)))]
    parts = [[field.read(part)] for part in (1 / x, 1 / (x + 1), 1 / (x + 2), x)]
    assert express(field, target, parts) == [1, -1, 0, 0]
    assert express(field, target, parts[:1]) is None
    assert express(field, [field.zero], parts) == [0, 0, 0, 0]
