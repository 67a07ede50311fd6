"""Sampling: points inside a domain, without random numbers."""

from __future__ import annotations

import pytest
import sympy as sp

from geomtorsion.geometry import Frame

x, y = sp.symbols("x y", real=True)


@pytest.mark.parametrize("bound", [10, 10**4, 10**9])
def test_a_domain_far_from_the_origin_is_reached(bound: int) -> None:
    """Numbers in the relations are sizes at which points are tried."""
    point = Frame([x, y], sp.diag(1, 1), domain=[x * y > bound]).region.point
    assert point[x] * point[y] > bound


@pytest.mark.parametrize("sign", ["positive", "negative", "real"])
def test_whole_numbers_are_sampled(sign: str) -> None:
    """A symbol declared integer gets a non-zero integer within its bounds, which `at` accepts."""
    n = sp.Symbol("n", integer=True, **{sign: True})
    frame = Frame([x, y], [[1, 0], [0, n + n * x**2]])
    assert frame.sample_point[n] in ({-1} if sign == "negative" else {1, -1})
    assert frame.metric.at(frame.sample_point)[1, 1] > 0
    bounds = [n < 9, n > -9, sp.Ne(n, 1), sp.Ne(n, -1)]
    first = Frame([x], [[1]], parameters=[n], domain=bounds).region.point
    assert abs(first[n]) != 1
    assert first[n].is_integer


@pytest.mark.parametrize("sign", ["positive", "negative", "real"])
@pytest.mark.parametrize(("kind", "rest"), [("even", 0), ("odd", 1)])
def test_even_and_odd_numbers_are_sampled(sign: str, kind: str, rest: int) -> None:
    """A symbol declared even or odd gets such a number, as `at` refuses others."""
    n = sp.Symbol("n", **{kind: True, sign: True})
    frame = Frame([x, y], [[1, 0], [0, n + n * x**2]])
    assert frame.sample_point[n] % 2 == rest
    assert frame.metric.at(frame.sample_point)[1, 1] > 0


@pytest.mark.parametrize(
    "domain",
    [
        [x**2 > 4],
        [x**2 > 4, x < y],
        [x**2 - 41 * x + 9 > 0, x > 20],
        [sp.Abs(x) > 30],
        [x**2 > 4e8],
        [x > y + 1000],
        [sp.cos(x) < -sp.Rational(9, 10)],
    ],
    ids=str,
)
def test_every_relation_holds_at_the_sample(domain: list[sp.Basic]) -> None:
    """Each relation holds, also one that is not a bound and one that holds only far away."""
    point = Frame([x, y], sp.diag(1, 2 + x**2), domain=domain).sample_point
    assert all(relation.subs(point) == sp.true for relation in domain)


def test_roots_are_read_where_the_domain_is() -> None:
    """A radicand that is positive wherever x**2 > 4 is read as positive."""
    frame = Frame([x, y], sp.diag(sp.sqrt(x**2 - 4), 1), domain=[x**2 > 4])
    assert sp.expand(frame.metric[0, 0]) == x**2 - 4
