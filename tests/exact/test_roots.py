"""Roots: squares in the field are recognised under a root, without long norms."""

from __future__ import annotations

import pytest
import sympy as sp

from geomtorsion.exact import Field
from geomtorsion.exact.points import point_of

x, y = sp.symbols("x y", positive=True)


def sum_of_roots(count: int) -> sp.Expr:
    """Sum of square roots of different sums."""
    return sp.Add(*(sp.sqrt(x + k * y + k**2) for k in range(1, count + 1)))


def test_a_root_of_a_sum_of_ten_roots() -> None:
    """The norm over ten roots has millions of terms; a value shows that it is not a square."""
    field, inner = Field([x, y]), sum_of_roots(10)
    root = field.read(sp.sqrt(1 + inner))
    assert field.all_sure
    assert field.generators[0].kind == "root"
    assert (root * root - 1 - field.read(inner)).is_zero is True
    assert (root - field.read(inner)).is_zero is False


@pytest.mark.parametrize("count", [2, 4, pytest.param(5, marks=pytest.mark.slow)])
def test_a_square_of_a_sum_of_roots(count: int) -> None:
    """The root of a square adds no generator; the square plus one is not called a square."""
    field, inner = Field([x, y]), sum_of_roots(count)
    square = field.read(sp.expand((1 + inner) ** 2))
    known = len(field.generators)
    assert square.sqrt() == field.read(1 + inner)
    assert len(field.generators) == known
    assert field.square_class(square, ()) == ()
    assert field.square_class(square + 1, ()) is None


def test_roots_that_are_products_of_others() -> None:
    """The root of a square is a product of known roots; norms over all eleven would be too long."""
    field, inner = Field([x, y]), sum_of_roots(2)
    field.read(sum_of_roots(9) + sp.sqrt(x + sp.sqrt(y)))
    known = len(field.generators)
    wanted = (1 + inner) * sp.sqrt(x + 7 * y + 49) * sp.sqrt(x + 9 * y + 81)
    wanted = field.read(wanted * sp.sqrt(x + sp.sqrt(y)))
    found = (wanted * wanted).sqrt()
    assert len(field.generators) == known
    assert (found - wanted).is_zero is True
    # One term more, and it is not a square.
    assert (wanted * wanted + 1).sqrt() not in (wanted, found)
    assert len(field.generators) == known + 1


def test_asking_often_takes_no_place_from_decisions() -> None:
    """Many square tests use up no points: later decisions have as many points as the first."""
    field = Field([x, y])
    square = field.read(sp.expand((1 + sum_of_roots(2)) ** 2))
    for _ in range(4):
        assert field.square_class(square, ()) == ()
    long = field.read(sp.sqrt(x + 3) + y) ** 3
    zero = field.sum([(1, long, square), (-1, square, long)])
    assert zero.is_zero is True
    assert point_of(field).image(square * long - long * square) == 0
