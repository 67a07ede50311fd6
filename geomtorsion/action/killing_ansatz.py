"""Killing ansatz: vector fields along which a Lagrangian may be the same, to be tried."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.checks import expression
from geomtorsion.errors import GeomtorsionError
from geomtorsion.geometry.groups import exponential

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame

# More candidates than this take seconds.
_MOST = 160
_LINE = sp.Symbol("_along")


def right_invariant(frame: Frame) -> list[list[sp.Expr]] | None:
    """Components xi^i in the frame of n fields that commute with all legs of a Lie group.

    Equation
    --------
    [E_k, xi] = 0:  d_mu xi^i = e^k_mu C_kj^i xi^j

    solved along the coordinate lines from the origin, one after the other, in an order in which
    the matrix on the right is constant up to a factor. None where C_ij^k depends on coordinates
    or no such order exists.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> right_invariant(load("ax_plus_b").frame)
    [[1, b/a], [0, 1/a]]
    """
    return frame.derived("right invariant fields", lambda: _right_invariant(frame))


def _right_invariant(frame: Frame) -> list[list[sp.Expr]] | None:
    table = frame.anholonomy.components.nonzero
    if any(value.symbols & set(frame.coordinates) for value in table.values()):
        return None
    n, q = frame.dimension, frame.coordinates
    coefficients = {index: value.sympy for index, value in table.items()}
    columns = [[frame.coframe[k, mu] for k in range(n)] for mu in range(n)]
    left, order = set(range(n)), []
    while left:
        ready = [
            mu
            for mu in sorted(left, reverse=True)
            if all(not entry.has(q[nu]) for entry in columns[mu] for nu in set(order))
        ]
        if not ready:
            return None
        # Those on which others depend must wait: they are moved last.
        mu = max(ready, key=lambda m: sum(e.has(q[nu]) for e in columns[m] for nu in left - {m}))
        order.append(mu)
        left.discard(mu)
    whole = sp.eye(n)
    for place, mu in enumerate(order):
        still = {q[nu]: _base(columns, q[nu]) for nu in order[place + 1 :]}
        column = [expression(entry).xreplace(still) for entry in columns[mu]]
        step = _step(column, coefficients, n, q[mu])
        if step is None:
            return None
        whole = step * whole
    return [[sp.expand(whole[i, a]) for i in range(n)] for a in range(n)]


def _base(columns: Sequence[Sequence[sp.Expr]], symbol: sp.Symbol) -> sp.Expr:
    """Where a coordinate line begins: at zero, or at one where the coframe ends at zero."""
    entries = [expression(entry).subs(symbol, 0) for column in columns for entry in column]
    singular = any(entry.has(sp.zoo, sp.oo, sp.nan) for entry in entries)
    return sp.Integer(1 if singular else 0)


def _step(
    column: Sequence[sp.Expr],
    coefficients: Mapping[tuple[int, ...], sp.Expr],
    n: int,
    symbol: sp.Symbol,
) -> sp.Matrix | None:
    """exp of the integral of e^k C_kj^i along one line, from the base to the coordinate."""
    forms = [entry for entry in column if entry != 0]
    if not forms:
        return sp.eye(n)
    shape = forms[0]
    ratios = [sp.cancel(entry / shape) for entry in column]
    if any(ratio.free_symbols for ratio in ratios):
        return None
    matrix = sp.zeros(n, n)
    for (k, j, i), value in coefficients.items():
        matrix[i, j] += value * ratios[k]
    length = _length(shape, symbol)
    if length is None:
        return None
    try:
        found = exponential(matrix, _LINE)
    except GeomtorsionError:
        return None
    return found.xreplace({_LINE: length}).applyfunc(sp.powsimp)


def _length(shape: sp.Expr, symbol: sp.Symbol) -> sp.Expr | None:
    """The integral of a constant, a power or an exponential from the base."""
    if not shape.has(symbol):
        return shape * symbol
    factor, rest = shape.as_independent(symbol)
    power = rest.as_base_exp()
    if power[0] == symbol and power[1] == -1:
        return factor * sp.log(symbol)
    if power[0] == symbol and power[1].is_Integer:
        return factor * symbol ** (power[1] + 1) / (power[1] + 1)
    slope = sp.diff(rest, symbol) / rest
    if isinstance(rest, sp.exp) and not slope.has(symbol):
        return factor * (rest - 1) / slope
    return None


def ansatz_functions(frame: Frame, entries: Sequence[sp.Expr]) -> list[sp.Expr]:
    """Functions f(q) for an ansatz xi = sum c f E_k: products of those that fit each coordinate.

    An angle has 1, cos, sin; a coordinate that occurs nowhere also itself; other ones 1 and q.
    None at all where there would be too many.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> frame = load("flat_polar").frame
    >>> ansatz_functions(frame, [frame.coframe[1, 1]])
    [1, phi, cos(phi), sin(phi), r, phi*r, r*cos(phi), r*sin(phi)]
    """
    choices = []
    for symbol in frame.coordinates:
        one, inside = sp.S.One, [entry for entry in entries if entry.has(symbol)]
        angles = {a for e in inside for a in e.atoms(sp.sin, sp.cos) if a.has(symbol)}
        waves = [sp.cos(symbol), sp.sin(symbol)]
        if not inside:
            choices.append([one, symbol, *waves])
        elif angles:
            choices.append([one, *waves])
        else:
            choices.append([one, symbol])
    count = 1
    for row in choices:
        count *= len(row)
    if count * frame.dimension > _MOST:
        return []
    return [sp.Mul(*factors) for factors in product(*choices)]
