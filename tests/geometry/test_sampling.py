"""Sampling: points inside a domain, found without chance."""

from __future__ import annotations

import sympy as sp

from geomtorsion.geometry.sampling import candidate_points

x, y = sp.symbols("x y", real=True)


def test_how_far_a_domain_is_searched() -> None:
    """The last of four hundred points lie in a square of side forty: x y comes to 270 there."""
    products = [float(point[x] * point[y]) for point in candidate_points([x, y], [], [])]
    assert sum(product > 265 for product in products) > 0
    assert sum(product > 280 for product in products) == 0
