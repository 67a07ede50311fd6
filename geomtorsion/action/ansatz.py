"""Ansatz: functions and fields of which invariants of a motion may be made."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations_with_replacement, product
from math import prod
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.errors import GeomtorsionError
from geomtorsion.geometry.derived import derived
from geomtorsion.geometry.groups import exponential
from geomtorsion.support.checks import expression

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame

# More candidates than this take seconds.
_MOST = 400
_LINE = sp.Symbol("_along")


@derived
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
    table = frame.anholonomy.components.nonzero
    if any(value.symbols & set(frame.coordinates) for value in table.values()):
        return None
    n, q = frame.dimension, frame.coordinates
    coefficients = {index: value.sympy for index, value in table.items()}
    columns = [[frame.coframe[k, mu] for k in range(n)] for mu in range(n)]
    order = _order_of_lines(columns, q)
    if order is None:
        return None
    whole = sp.eye(n)
    for place, mu in enumerate(order):
        still = {q[nu]: _base(columns, q[nu]) for nu in order[place + 1 :]}
        column = [expression(entry).xreplace(still) for entry in columns[mu]]
        step = _step(column, coefficients, n, q[mu], _base(columns, q[mu]))
        if step is None:
            return None
        whole = step * whole
    return [[sp.expand(whole[i, a]) for i in range(n)] for a in range(n)]


def _order_of_lines(
    columns: Sequence[Sequence[sp.Expr]], q: Sequence[sp.Symbol]
) -> list[int] | None:
    """The coordinate lines in an order in which none depends on one before it, or None."""
    left, order = set(range(len(q))), list[int]()
    while left:
        ready = [
            mu
            for mu in sorted(left, reverse=True)
            if all(not entry.has(q[nu]) for entry in columns[mu] for nu in set(order))
        ]
        if not ready:
            return None
        # Variables on which others depend are moved last.
        mu = max(ready, key=lambda m: sum(e.has(q[nu]) for e in columns[m] for nu in left - {m}))
        order.append(mu)
        left.discard(mu)
    return order


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
    base: sp.Expr,
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
    length = _length(shape, symbol, base)
    if length is None:
        return None
    try:
        flow = exponential(matrix, _LINE)
    except GeomtorsionError:
        return None
    return flow.xreplace({_LINE: length}).applyfunc(sp.powsimp)


def _length(shape: sp.Expr, symbol: sp.Symbol, base: sp.Expr) -> sp.Expr | None:
    """The integral of a constant, a power or an exponential from the base."""
    if not shape.has(symbol):
        return shape * (symbol - base)
    factor, rest = shape.as_independent(symbol)
    power = rest.as_base_exp()
    if power[0] == symbol and power[1] == -1:
        return factor * sp.log(symbol)
    if power[0] == symbol and power[1].is_Integer:
        more = power[1] + 1
        return factor * (symbol**more - base**more) / more
    slope = sp.diff(rest, symbol) / rest
    if isinstance(rest, sp.exp) and not slope.has(symbol):
        return factor * (rest - rest.subs(symbol, base)) / slope
    return None


def fitting_functions(frame: Frame, entries: Sequence[sp.Expr]) -> list[list[sp.Expr]]:
    """For each coordinate the functions that an ansatz xi = sum c f E_k takes as factors of f.

    An angle has 1, cos, sin; a coordinate that occurs in no entry also itself; other ones 1 and q.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> frame = load("flat_polar").frame
    >>> fitting_functions(frame, [frame.coframe[1, 1]])
    [[1, r], [1, phi, cos(phi), sin(phi)]]
    """
    choices = []
    for symbol in frame.coordinates:
        unit, inside = sp.S.One, [entry for entry in entries if entry.has(symbol)]
        angles = {a for e in inside for a in e.atoms(sp.sin, sp.cos) if a.has(symbol)}
        waves = [sp.cos(symbol), sp.sin(symbol)]
        if not inside:
            choices.append([unit, symbol, *waves])
        elif angles:
            choices.append([unit, *waves])
        else:
            choices.append([unit, symbol])
    return choices


def ansatz_functions(
    frame: Frame, choices: Sequence[Sequence[sp.Expr]]
) -> tuple[list[sp.Expr], str]:
    """Functions f(q) for an ansatz xi = sum c f E_k, and the same in words.

    They are the products of one function of each list; where these make too many candidates f E_k,
    1 and the coordinates.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> r, phi = (frame := load("flat_polar").frame).coordinates
    >>> ansatz_functions(frame, [[sp.S.One, r], [sp.S.One, sp.cos(phi)]])
    ([1, cos(phi), r, r*cos(phi)], 'a product of one of each (1, r) (1, cos(phi))')
    """
    if prod(map(len, choices)) * frame.dimension > _MOST:
        linear = [sp.S.One, *frame.coordinates]
        return linear, f"one of ({listed(linear)})"
    words = " ".join(f"({listed(row)})" for row in choices)
    products = [sp.Mul(*factors) for factors in product(*choices)]
    return products, f"a product of one of each {words}"


def powers(frame: Frame) -> tuple[list[sp.Expr], str]:
    """Functions f(q) for an ansatz xi = sum c f d_mu, and the same in words.

    They are 1, the coordinates and the products of two of them, where these are not too many.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> powers(load("flat_polar").frame)
    ([1, r, phi, r**2, phi*r, phi**2], 'of degree 2 in r, phi')
    """
    n, q = frame.dimension, frame.coordinates
    squares = [one * two for one, two in combinations_with_replacement(q, 2)]
    degree = 2 if n * (1 + n + len(squares)) <= _MOST else 1
    functions = [sp.S.One, *q, *(squares if degree == 2 else ())]
    return functions, f"of degree {degree} in {listed(q)}"


def separable_functions(frame: Frame) -> list[sp.Expr]:
    """Functions f(q) for an ansatz sum c f p_k p_l: 1, and terms that the coframe is made of.

    They are the terms of sums in the entries of the coframe, below roots and in denominators also,
    and squares of its factors. In spaces in which Hamilton and Jacobi's equation separates, the
    tensor that separates it is made of these.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> separable_functions(load("schwarzschild").frame)
    [1, r**2, M*r, r, sin(theta)**2]
    """
    inside, functions = set(frame.coordinates), {sp.S.One: None}
    for entry in frame.coframe.nonzero().values():
        for factor in sp.Mul.make_args(expression(entry)):
            base = sp.expand(factor.as_base_exp()[0])
            terms = base.args if isinstance(base, sp.Add) else [base**2]
            for term in terms:
                function = term.as_coeff_Mul()[1]
                if function.free_symbols & inside:
                    functions.setdefault(function)
    n = frame.dimension
    return list(functions) if len(functions) * n * (n + 1) // 2 <= _MOST else [sp.S.One]


def listed(functions: Sequence[sp.Expr]) -> str:
    """Functions with commas between them.

    Examples
    --------
    >>> listed(sp.symbols("x y"))
    'x, y'
    """
    return ", ".join(map(str, functions))
