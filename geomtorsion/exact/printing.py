"""Printing: expressions as text and as LaTeX, where equal parts occur many times."""

from __future__ import annotations

from typing import Any

import sympy as sp
from sympy.printing.latex import LatexPrinter
from sympy.printing.printer import Printer
from sympy.printing.str import StrPrinter

from geomtorsion.support.allowance import check_limits
from geomtorsion.support.outgoing import latex_formula


class PrintedOnce(Printer):
    """A printer that writes each part once, however often it occurs.

    Components of dense frames are made of few different parts: 4,000 at a million places.
    """

    def __init__(self, settings: dict[str, Any] | None = None) -> None:
        super().__init__(settings)
        self._texts: dict[sp.Basic, str] = {}

    def _print(self, expr: Any, **kwargs: object) -> str:
        # A part in an exponent or in another style has another text.
        if kwargs or not isinstance(expr, sp.Basic) or not expr.args:
            return super()._print(expr, **kwargs)
        if expr not in self._texts:
            check_limits()
            self._texts[expr] = super()._print(expr)
        return self._texts[expr]


class TextPrinter(PrintedOnce, StrPrinter):
    """What `str` gives of an expression.

    Examples
    --------
    >>> x, y = sp.symbols("x y")
    >>> TextPrinter().doprint(x**2 * sp.sin(x * y))
    'x**2*sin(x*y)'
    """


class TexPrinter(PrintedOnce, LatexPrinter):
    r"""Print an expression as `sympy.latex` does.

    Examples
    --------
    >>> x, y = sp.symbols("x y")
    >>> TexPrinter().doprint(x**2 * sp.sin(x * y))
    'x^{2} \\sin{\\left(x y \\right)}'
    """

    def doprint(self, expr: sp.Basic) -> str:
        """The formula; a name in it is text, never a LaTeX command."""
        return latex_formula(super().doprint(expr))
