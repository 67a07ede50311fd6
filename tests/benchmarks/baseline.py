"""Baseline: the definitions typed into sympy, with `simplify` on each component."""

from __future__ import annotations

from itertools import product

import sympy as sp

from tests.benchmarks.cases import Case
from tests.benchmarks.outcome import Outcome, Reached


def sympy_with_simplify(case: Case, reached: Reached) -> Outcome:
    """The same tensors as geomtorsion where there is a coframe, else the Riemannian part."""
    n, q, g = case.dimension, case.coordinates, case.metric
    inverse = g.inv().applyfunc(sp.simplify)

    def each(rank, formula):
        return {i: sp.simplify(formula(*i)) for i in product(range(n), repeat=rank)}

    def total(formula):
        return sum((formula(k) for k in range(n)), sp.Integer(0))

    def dg(a, b, c):
        return sp.diff(g[b, c], q[a])

    def curvature(c):
        def formula(m, v, a, k):
            rate = sp.diff(c[v, a, k], q[m]) - sp.diff(c[m, a, k], q[v])
            return rate + total(lambda t: c[v, a, t] * c[m, t, k] - c[m, a, t] * c[v, t, k])

        return each(4, formula)

    first = each(3, lambda a, b, c: (dg(a, b, c) + dg(b, a, c) - dg(c, a, b)) / 2)
    bar = each(3, lambda a, b, c: total(lambda d: inverse[c, d] * first[a, b, d]))
    reached("christoffel")
    if case.coframe is not None:
        e = case.coframe
        leg = e.inv().applyfunc(sp.simplify)
        cartan = each(3, lambda a, b, m: total(lambda i: leg[m, i] * sp.diff(e[i, b], q[a])))
        each(3, lambda a, b, c: (cartan[a, b, c] - cartan[b, a, c]) / 2)
        each(3, lambda a, b, c: cartan[a, b, c] - bar[a, b, c])
        curvature(cartan)
        reached("torsion")
    riemann = curvature(bar)
    reached("riemann")
    ricci = each(2, lambda v, a: total(lambda m: riemann[m, v, a, m]))
    reached("ricci")
    lower = each(4, lambda m, v, a, b: total(lambda k: riemann[m, v, a, k] * g[k, b]))
    up = riemann
    for k in range(3):
        up = each(4, lambda *i, k=k, up=up: total(lambda m: inverse[i[k], m] * up[_put(i, k, m)]))
    scalar = sp.simplify(sum(lower[i] * up[i] for i in lower))
    reached("kretschmann")
    return Outcome(scalar, tuple(ricci.values()))


def _put(index: tuple[int, ...], place: int, value: int) -> tuple[int, ...]:
    """The index with one position changed."""
    return (*index[:place], value, *index[place + 1 :])
