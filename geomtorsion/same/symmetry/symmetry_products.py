"""Products: functions of all coordinates that occur in the components of symmetries."""

from __future__ import annotations

from itertools import combinations, combinations_with_replacement, product
from math import prod

import sympy as sp

from geomtorsion.exact import Element, Specialization, limits, reduced
from geomtorsion.geometry import Frame
from geomtorsion.same.symmetry.symmetry_algebra import AtPoint

# More unknowns than these take minutes; then the vectors are integrated.
MOST_UNKNOWNS = limits.MOST_AT_ONCE // 2

PARTNERS = {sp.cos: sp.sin, sp.sin: sp.cos, sp.cosh: sp.sinh, sp.sinh: sp.cosh}

Lists = dict[sp.Symbol, list[sp.Expr]]


def products(frame: Frame, lists: Lists, degree: int, constants: bool) -> list[sp.Expr]:
    """Products with a factor of each coordinate, none where they are too many.

    lists: the functions of a coordinate of which the metric is free (see `waves`).
    degree: how many functions of one other coordinate are multiplied.
    constants: whether each is multiplied by each parameter, and by its inverse.
    """
    own = [*functions_of_coordinates(frame, lists, degree).values(), _mixed_roots(frame)]
    if constants:
        own.append([sp.S.One, *(c for one in frame.parameters for c in (one, 1 / one))])
    if frame.dimension * prod(map(len, own)) > MOST_UNKNOWNS:
        return []
    return list(dict.fromkeys(sp.Mul(*one) for one in product(*own)))


def functions_of_coordinates(frame: Frame, lists: Lists, degree: int) -> Lists:
    """The functions of each coordinate that are multiplied."""
    return {q: lists.get(q) or _functions(frame, q, degree) for q in frame.coordinates}


def _functions(frame: Frame, q: sp.Symbol, degree: int) -> list[sp.Expr]:
    """1 and products of functions of one coordinate in the metric and the coframe."""
    names = set(frame.coordinates)
    shown = [g.shown for g in _generators(frame) if g.shown.free_symbols & names == {q}]
    # sin belongs to cos, although a metric may contain only one of them.
    shown += [PARTNERS[one.func](*one.args) for one in shown if one.func in PARTNERS]
    shown += _factors_of_coframe(frame, q)
    inverse = [1 / one for one in shown if isinstance(one, sp.exp)]
    functions = list(dict.fromkeys([*shown, *inverse]))
    if not any(isinstance(one, sp.cos | sp.sin | sp.cosh | sp.sinh | sp.exp) for one in functions):
        functions = list(dict.fromkeys([q, *functions]))
    every = [sp.S.One, *functions]
    return list(dict.fromkeys(sp.Mul(*one) for one in combinations_with_replacement(every, degree)))


def _factors_of_coframe(frame: Frame, q: sp.Symbol) -> list[sp.Expr]:
    """The factor of each entry of the coframe that depends on one coordinate only."""
    names = set(frame.coordinates)
    parts = [
        sp.Mul(*(x for x in sp.Mul.make_args(value.sympy) if x.free_symbols & names == {q}))
        for value in frame.coframe.components.independent.values()
    ]
    return [one for one in parts if one != 1]


def _mixed_roots(frame: Frame) -> list[sp.Expr]:
    """1, and roots that depend on several coordinates, with their inverses."""
    names = set(frame.coordinates)
    roots = [g.shown for g in _generators(frame) if g.kind == "root"]
    mixed = [one for one in roots if len(one.free_symbols & names) > 1]
    return [sp.S.One, *mixed, *(1 / one for one in mixed)]


def _generators(frame: Frame) -> list:
    """The generators in the metric and in the coframe, each once."""
    values: list[Element] = [
        *frame.metric.components.independent.values(),
        *frame.coframe.components.independent.values(),
    ]
    return list(dict.fromkeys(g for x in values for g in frame.field.generators_of(x)))


def waves(frame: Frame, point: AtPoint) -> Lists:
    """How symmetries depend on each coordinate of which the metric is free.

    Where d/dq is a symmetry, the others are sums of q**k exp(lambda q) with the eigenvalues lambda
    of its adjoint matrix. Coordinates whose eigenvalues need higher roots are omitted.
    """
    metric = frame.metric.components
    n, field, q = frame.dimension, frame.field, frame.coordinates
    lists: Lists = {}
    for a in range(n):
        if not all(x.free_of(q[a]) for x in metric.independent.values()):
            continue
        shift = [field.one if a == b else field.zero for b in range(n)]
        turns = [
            (metric.get((c, a)).diff(q[b]) - metric.get((b, a)).diff(q[c])) / 2
            for b, c in combinations(range(n), 2)
        ]
        values = [*shift, *turns]
        values += [field.zero] * (point.functions.width - len(values))
        own = _waves(point, point.components(values), q[a])
        if own is not None:
            lists[q[a]] = own
    return lists


def _waves(point: AtPoint, element: list[Element], q: sp.Symbol) -> list[sp.Expr] | None:
    """q**k exp(lambda q) for the eigenvalues lambda of the adjoint matrix of an element."""
    algebra, place = point.algebra, point.place
    exact, field = algebra.exact, algebra.exact.field
    n = exact.dimension
    columns = [exact.bracket(element, exact.unit(j)) for j in range(n)]
    matrix = sp.Matrix(n, n, lambda i, j: columns[j][i].sympy)
    z = sp.Dummy("z")
    functions: list[sp.Expr] = []
    for factor, _ in sp.Poly(matrix.charpoly().all_coeffs(), z).factor_list()[1]:
        power = _power(field, columns, factor, n)
        if factor.degree() > 2:
            return None
        own = _exponentials(factor, q, place)
        functions += [q**k * one for one in own for k in range(power)]
    return list(dict.fromkeys([sp.S.One, *functions]))


def _exponentials(factor: sp.Poly, q: sp.Symbol, place: Specialization) -> list[sp.Expr]:
    """Solutions of factor(d/dq) f = 0."""
    lead, *rest = factor.all_coeffs()
    if len(rest) == 1:
        return [sp.exp(sp.cancel(-rest[0] / lead) * q)]
    half, square = sp.cancel(rest[0] / lead / 2), sp.cancel(rest[1] / lead)
    inside = sp.cancel(half**2 - square)
    sign = place.field.sample.value(place.field.read(inside))
    rate = sp.sqrt(sp.factor(inside if sign > 0 else -inside))
    damping = sp.exp(-half * q)
    if sign > 0:
        return [damping * sp.exp(rate * q), damping * sp.exp(-rate * q)]
    return [damping * sp.cos(rate * q), damping * sp.sin(rate * q)]


def _power(field, columns: list[list[Element]], factor: sp.Poly, n: int) -> int:
    """The power of a factor in the minimal polynomial of a matrix, given by its columns."""
    rows = [[columns[j][i] for j in range(n)] for i in range(n)]
    identity = [[field.one if i == j else field.zero for j in range(n)] for i in range(n)]
    value = [[field.zero] * n for _ in range(n)]
    for coefficient in factor.all_coeffs():
        c = field.read(coefficient)
        value = [
            [x + c * y for x, y in zip(one, two, strict=True)]
            for one, two in zip(_times(field, value, rows), identity, strict=True)
        ]
    power, current, rank = 0, identity, n
    while True:
        current = _times(field, current, value)
        lower = reduced(field, current, n).rank
        if lower == rank:
            return power
        rank, power = lower, power + 1


def _times(field, first: list[list[Element]], second: list[list[Element]]) -> list[list[Element]]:
    n = range(len(first))
    return [[field.sum([(1, first[i][k], second[k][j]) for k in n]) for j in n] for i in n]
