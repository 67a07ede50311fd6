"""Sampling: points inside a domain, found without chance."""

from __future__ import annotations

import pytest
import sympy as sp

from geomtorsion.geometry import Frame
from geomtorsion.geometry.validation import candidate_points

x, y = sp.symbols("x y", real=True)


def test_how_far_a_domain_is_searched() -> None:
    """The last of four hundred points lie in a square of side forty: x y comes to 270 there."""
    products = [float(point[x] * point[y]) for point in candidate_points([x, y], [], [])]
    assert sum(product > 265 for product in products) > 0
    assert sum(product > 280 for product in products) == 0


@pytest.mark.parametrize("sign", ["positive", "negative", "real"])
def test_whole_numbers_are_sampled(sign: str) -> None:
    """What is declared integer is one, not zero, and within its bounds: a point that `at` takes."""
    n = sp.Symbol("n", integer=True, **{sign: True})
    frame = Frame([x, y], [[1, 0], [0, n + n * x**2]])
    assert frame.sample_point[n] in ({-1} if sign == "negative" else {1, -1})
    assert frame.metric.at(frame.sample_point)[1, 1] > 0
    first = next(candidate_points([], [n], [n < 9, n > -9, sp.Ne(n, 1), sp.Ne(n, -1)]))
    assert abs(first[n]) != 1
    assert first[n].is_integer
