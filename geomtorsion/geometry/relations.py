"""Relations: inequalities of a domain, read from text, and those that a point violates."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping

import sympy as sp

from geomtorsion.errors import GeomtorsionError
from geomtorsion.support import checks

_COMPARISON = re.compile(r"(<=|>=|<|>)")
_RELATIONS = {"<": sp.Lt, ">": sp.Gt, "<=": sp.Le, ">=": sp.Ge}


def relations_in(
    text: str, read: Callable[[str], sp.Expr], where: str, error: type[GeomtorsionError]
) -> list[sp.Rel]:
    """The relations of a text such as "0 < theta < pi"; read: reads each side."""
    first, *rest = _COMPARISON.split(text)
    if not rest:
        raise error(
            f"{where}: expected a comparison, got {checks.shown(text)}. "
            'Write "r > 2*M" or "0 < theta < pi".'
        )
    relations, left = [], read(first)
    for sign, side in zip(rest[::2], rest[1::2], strict=True):
        right = read(side)
        relations.append(_RELATIONS[sign](left, right))
        left = right
    return relations


def broken_relations(
    relations: Iterable[sp.Basic], values: Mapping[sp.Symbol, float]
) -> list[sp.Basic]:
    """Relations that a point violates; a point exactly on the edge violates none.

    Examples
    --------
    >>> r, M = sp.symbols("r M")
    >>> broken_relations([r > 2 * M, r > 0], {r: 1.5, M: 1})
    [r > 2*M]
    >>> broken_relations([r > 2 * M], {r: 2, M: 1})
    []
    """
    return [
        relation
        for relation in relations
        if relation.subs(values) == sp.false
        and float((relation.args[0] - relation.args[1]).subs(values)) != 0.0
    ]
