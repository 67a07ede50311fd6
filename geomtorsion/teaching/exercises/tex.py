"""tex: LaTeX of computed objects, for statements."""

from __future__ import annotations

from collections.abc import Sequence

import sympy

from geomtorsion.geometry import Frame
from geomtorsion.pictures.latex import latex_matrix
from geomtorsion.pictures.latex import latex_text as tex


def matrix(rows: Sequence[Sequence[sympy.Expr]]) -> str:
    """A matrix in LaTeX."""
    return latex_matrix([[tex(x) for x in row] for row in rows])


def coframe(frame: Frame) -> str:
    """The coframe of a frame as a matrix: rows are one-forms."""
    n = frame.dimension
    return matrix([[frame.coframe[i, mu] for mu in range(n)] for i in range(n)])


def symbols(frame: Frame) -> str:
    """The coordinates of a frame, in order."""
    return ", ".join(tex(symbol) for symbol in frame.coordinates)


def forms(frame: Frame) -> str:
    """The one-forms of a frame, each as a sum of differentials."""
    lines = []
    for i in range(frame.dimension):
        pairs = [(frame.coframe[i, mu], x) for mu, x in enumerate(frame.coordinates)]
        lines.append(f"e^{{{i + 1}}} = {_sum(pairs)}")
    return r",\quad ".join(lines)


def _sum(pairs: Sequence[tuple[sympy.Expr, sympy.Symbol]]) -> str:
    """A one-form as a sum of differentials."""
    text = ""
    for factor, symbol in pairs:
        if factor == 0:
            continue
        minus = factor.could_extract_minus_sign()
        size = -factor if minus else factor
        shown = rf"\left({tex(size)}\right)" if size.is_Add else tex(size)
        text += " - " if minus else " + " if text else ""
        text += ("" if size == 1 else rf"{shown}\,") + rf"\mathrm{{d}}{tex(symbol)}"
    return text.strip() or "0"
