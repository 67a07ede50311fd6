"""maxima: names, expressions and tables of components as Maxima reads them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import sympy

from geomtorsion.pictures.text import expression_text
from geomtorsion.support import checks
from geomtorsion.teaching.exercises.answers import component_text
from geomtorsion.teaching.exercises.compare import Value

_CONSTANTS = {sympy.pi: "%pi", sympy.E: "%e", sympy.I: "%i"}


def maxima_name(name: str) -> str:
    """The name of a symbol: digits last, as STACK requires; rates with a d for each prime in front.

    Examples
    --------
    >>> [maxima_name(name) for name in ("phi1", "phi1_d", "r_dd", "Omega1'")]
    ['phi1', 'dphi1', 'ddr', 'dOmega1']
    """
    bare = name.rstrip("'")
    head, _, rates = bare.rpartition("_")
    if head and set(rates) == {"d"}:
        return rates + head
    return "d" * (len(name) - len(bare)) + bare


def maxima_text(value: object) -> str:
    """An expression, or a number, to twelve digits if it is a float.

    Examples
    --------
    >>> phi_d = sympy.Symbol("phi_d")
    >>> maxima_text(sympy.pi * phi_d**2 / 2), maxima_text(sympy.exp(phi_d) + sympy.E)
    ('%pi*dphi^2/2', '%e + exp(dphi)')
    """
    if isinstance(value, float):
        return component_text(value)
    expr = checks.expression(value)
    table: dict[sympy.Basic, sympy.Basic] = {
        symbol: sympy.Symbol(maxima_name(symbol.name))
        for symbol in expr.free_symbols
        if isinstance(symbol, sympy.Symbol)
    }
    table |= {constant: sympy.Symbol(name) for constant, name in _CONSTANTS.items()}
    return expression_text(expr.xreplace(table), greek=False)


def maxima_list(value: Value, size: int) -> str:
    """Components by one index as a list.

    Examples
    --------
    >>> maxima_list({(1,): sympy.Rational(1, 2)}, 3)
    '[0,1/2,0]'
    """
    return f"[{','.join(maxima_text(value.get((k,), 0)) for k in range(size))}]"


def maxima_matrix(value: Value, shape: Sequence[int]) -> str:
    """Components as a matrix: one row for one index; for three, the matrices stacked.

    Examples
    --------
    >>> maxima_matrix({(0, 0): 1, (1, 1): 2}, (2, 2)), maxima_matrix({(0,): 1}, (3,))
    ('matrix([1,0],[0,2])', 'matrix([1,0,0])')
    >>> maxima_matrix({(0, 1, 1): 5}, (2, 2, 2))
    'matrix([0,0],[0,5],[0,0],[0,0])'
    """
    *above, last = shape
    rows = (
        {(k,): value.get((*key, k), 0) for k in range(last)} for key in product(*map(range, above))
    )
    return f"matrix({','.join(maxima_list(row, last) for row in rows)})"
