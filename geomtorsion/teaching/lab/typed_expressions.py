"""typed expressions: text of a field, in the notation of the library or of paper."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import sympy as sp

from geomtorsion.exact import parse_expression
from geomtorsion.exact.names import NOT_SMOOTH
from geomtorsion.exact.tokens import Limits
from geomtorsion.teaching.exercises import notation

# A text typed by hand stays far below these.
LIMITS = Limits(characters=600, depth=20, exponent=32, digits=40)


def read_typed(
    text: str, symbols: Mapping[str, sp.Symbol], functions: Mapping[str, Any], where: str
) -> sp.Expr:
    """An expression, read like an answer to an exercise; zero for an empty text.

    Raises
    ------
    ExpressionError
        It cannot be read, can be read in two ways, or is not smooth.
    LimitError
        It is longer or deeper than people type.

    Examples
    --------
    >>> r, theta = sp.symbols("r theta")
    >>> names = {"r": r, "theta": theta}
    >>> read_typed("-2r² sin^2 θ", names, {}, "here") == -2 * r**2 * sp.sin(theta) ** 2
    True
    """
    if NOT_SMOOTH.keys() & set(re.findall(r"\w+", text)):
        # An answer may have steps, a frame may not: the parser refuses them.
        return parse_expression(text, symbols, functions, where=where, limits=LIMITS)
    return notation.read_typed(
        text.strip() or "0", symbols, where, LIMITS, functions, decimals=False
    )
