"""typed expressions: text of a field, in the notation of the library or of paper."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import sympy as sp

from geomtorsion.errors import ExpressionError, LimitError
from geomtorsion.exact import parse_expression
from geomtorsion.exact.names import NOT_SMOOTH
from geomtorsion.exact.tokens import Limits
from geomtorsion.teaching.exercises.notation import written_out

# A text typed by hand stays far below these.
LIMITS = Limits(characters=600, depth=20, exponent=32, digits=40)


def read_typed(
    text: str, symbols: Mapping[str, sp.Symbol], functions: Mapping[str, Any], where: str
) -> sp.Expr:
    """An expression; zero for an empty text.

    A text that the library reads keeps its meaning. Any other text is read like an answer to
    an exercise: products without a sign, functions without brackets, LaTeX, signs of other keys.

    Raises
    ------
    ExpressionError
        It can be read in no way, or in two ways.
    LimitError
        It is longer or deeper than what a person types.

    Examples
    --------
    >>> r, theta = sp.symbols("r theta")
    >>> names = {"r": r, "theta": theta}
    >>> read_typed("-2r² sin^2 θ", names, {}, "here") == -2 * r**2 * sp.sin(theta) ** 2
    True
    """
    text = text.strip() or "0"
    try:
        return parse_expression(text, symbols, functions, where=where, limits=LIMITS)
    except LimitError:
        raise
    except ExpressionError as error:
        if NOT_SMOOTH.keys() & set(re.findall(r"\w+", text)):
            raise
        # Raises if the text is ambiguous: that message is better than one about a missing sign.
        plain = written_out(text, symbols, where)
        try:
            return parse_expression(plain, symbols, functions, where=where, limits=LIMITS)
        except (ExpressionError, LimitError):
            # The first error shows the text as typed.
            raise error from None
