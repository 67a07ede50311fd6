"""Notation: how tensors are written, in ASCII and in LaTeX, with index positions visible."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from html import escape
from itertools import groupby
from typing import TYPE_CHECKING

import sympy as sp

if TYPE_CHECKING:
    from geomtorsion.geometry.frame import Frame
    from geomtorsion.geometry.tensor import Tensor

SHOWN = 12
SHOWN_LATEX = 60


def _letters(slots: str) -> list[str]:
    """A letter for each slot: from a on for coordinate indices, from i on for frame indices."""
    frame = iter("ijklmnpqrstuvw")
    coordinate = iter("abcdefgh" if any(s in "DU" for s in slots) else "abcdefghijklmnopqr")
    return [next(frame) if slot in "DU" else next(coordinate) for slot in slots]


def _indexed(symbol: str, marks: list[str], slots: str) -> str:
    """Symbol with marks below and above, in order: S_{ab}^{c}."""
    parts = [symbol]
    pairs = list(zip(slots, marks, strict=True))
    for number, (up, run) in enumerate(groupby(pairs, key=lambda pair: pair[0] in "uU")):
        gap = "{}" if number else ""
        parts.append(f"{gap}{'^' if up else '_'}{{{''.join(mark for _, mark in run)}}}")
    return "".join(parts)


def plain_symbol(symbol: str) -> str:
    r"""A symbol of LaTeX as it is written in a line of text.

    Examples
    --------
    >>> plain_symbol(r"\bar\Gamma"), plain_symbol(r"\sqrt{g}"), plain_symbol("DR")
    ('Gamma_bar', 'sqrt(g)', 'DR')
    """
    bare = re.sub(r"\\bar ?(\\?\w+)", r"\1_bar", symbol)
    return re.sub(r"\{(.*?)\}", r"(\1)", bare).replace("\\", "")


def ascii_label(tensor: Tensor) -> str:
    """Symbol with index letters, such as S_{ab}^{c}."""
    label = _indexed(plain_symbol(tensor.symbol), _letters(tensor.slots), tensor.slots)
    return label.replace("{}", "")


def html_table(head: Sequence[str], rows: Iterable[Sequence[object]], below: str = "") -> str:
    """A table for notebooks, with a line below it."""

    def line(cells: Sequence[object], tag: str) -> str:
        written = "".join(f"<{tag}>{escape(str(cell))}</{tag}>" for cell in cells)
        return f"<tr>{written}</tr>"

    body = "".join(line(row, "td") for row in rows)
    ending = f"<p>{escape(below)}</p>" if below else ""
    return f"<table><thead>{line(head, 'th')}</thead><tbody>{body}</tbody></table>{ending}"


def text(tensor: Tensor) -> str:
    """Name, label and the first non-vanishing components, one a line."""
    independent = tensor.components.independent
    heading = f"{tensor.name or 'tensor'} {ascii_label(tensor)}".strip()
    names = ", ".join(symbol.name for symbol in tensor.frame.coordinates)
    heading += f" (coordinates {names}; slots {tensor.slots or 'none'})"
    if not independent:
        return f"{heading}: all components vanish"
    lines = [heading]
    for index in list(independent)[:SHOWN]:
        place = f"[{', '.join(map(str, index))}]" if index else ""
        lines.append(f"  {plain_symbol(tensor.symbol)}{place} = {tensor[index]}")
    total = len(tensor.components.support)
    hidden = len(independent) - min(SHOWN, len(independent))
    if hidden:
        lines.append(f"  and {hidden} more independent components")
    if total > len(independent):
        lines.append(f"  ({total} do not vanish; the others follow by symmetry)")
    return "\n".join(lines)


def _marks(tensor: Tensor, index: tuple[int, ...]) -> list[str]:
    """Index values as they are written: coordinate names, hatted numbers for the frame."""
    marks = []
    for slot, k in zip(tensor.slots, index, strict=True):
        if slot in "DU":
            marks.append(rf"\hat{{{k}}}")
        else:
            marks.append(sp.latex(tensor.frame.coordinates[k]) + " ")
    return marks


def _symbol_latex(symbol: str) -> str:
    """A symbol in LaTeX: long names upright."""
    if symbol.startswith("\\") or len(symbol) == 1:
        return symbol
    return sp.latex(sp.Symbol(symbol))


def latex(tensor: Tensor) -> str:
    """LaTeX for notebooks: a matrix for two indices, else a list of independent components."""
    symbol = _symbol_latex(tensor.symbol)
    label = _indexed(symbol, _letters(tensor.slots), tensor.slots)
    if not tensor.slots:
        return rf"$\displaystyle {symbol} = {sp.latex(tensor[()])}$"
    independent = tensor.components.independent
    if not independent:
        return rf"$\displaystyle {label} = 0$"
    if len(tensor.slots) == 2:
        n = tensor.frame.dimension
        rows = [" & ".join(sp.latex(tensor[i, j]) for j in range(n)) for i in range(n)]
        body = r" \\ ".join(rows)
        return rf"$\displaystyle {label} = \begin{{pmatrix}} {body} \end{{pmatrix}}$"
    lines = []
    for index in list(independent)[:SHOWN_LATEX]:
        left = _indexed(symbol, _marks(tensor, index), tensor.slots)
        lines.append(rf"{left} &= {sp.latex(tensor[index])}")
    hidden = len(independent) - len(lines)
    if hidden > 0:
        lines.append(rf"&\text{{and {hidden} more independent components}}")
    body = r" \\ ".join(lines)
    return rf"$\displaystyle \begin{{aligned}} {body} \end{{aligned}}$"


def frame_text(frame: Frame) -> str:
    """Name, coordinates and the one-forms of a coframe."""
    names = ", ".join(symbol.name for symbol in frame.coordinates)
    lines = [f"{frame.name or 'frame'} (coordinates {names})"]
    lines += [f"  e^{i} = {_one_form(frame, i, str, ' ')}" for i in range(frame.dimension)]
    lines += [f"  {branch}" for branch in frame.branches]
    return "\n".join(lines)


def frame_latex(frame: Frame) -> str:
    """The one-forms of a coframe in LaTeX."""
    lines = [
        rf"e^{{\hat{{{i}}}}} &= {_one_form(frame, i, sp.latex, chr(92) + ', ')}"
        for i in range(frame.dimension)
    ]
    body = r" \\ ".join(lines)
    return rf"$\displaystyle \begin{{aligned}} {body} \end{{aligned}}$"


def _one_form(frame: Frame, i: int, write: Callable[[sp.Expr], str], gap: str) -> str:
    """Row i of the coframe as a sum of coordinate differentials."""
    d = r"\mathrm{d}" if write is sp.latex else "d"
    parts = []
    for mu, symbol in enumerate(frame.coordinates):
        factor = frame.coframe[i, mu]
        if factor == 0:
            continue
        name = f"{d}{write(symbol)}"
        if factor == 1:
            parts.append(name)
        elif factor.is_Add:
            parts.append(f"({write(factor)}){gap}{name}")
        else:
            parts.append(f"{write(factor)}{gap}{name}")
    return " + ".join(parts).replace("+ -", "- ")
