"""sections: one quantity of a report each: a matrix, a list of components or a single value."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import TYPE_CHECKING

import sympy

from geomtorsion.exact import TexPrinter
from geomtorsion.geometry.notation import OPEN
from geomtorsion.pictures.formula import mathml
from geomtorsion.pictures.latex import (
    equation_latex,
    latex_label,
    latex_marks,
    latex_matrix,
    latex_symbol,
    latex_text,
)
from geomtorsion.pictures.style import STYLE
from geomtorsion.pictures.text import expression_text
from geomtorsion.support.outgoing import html_text

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.pictures.quantities import Quantity


# (name of a note, count=number where it counts) -> its text.
Note = Callable[..., str]
_NOTES = {
    "folded": "{count} more components",
    "symmetric_one": "1 more component follows by symmetry.",
    "symmetric": "{count} more components follow by symmetry.",
    "undecided": "Undecided whether zero:",
}


def english_note(name: str, **values: object) -> str:
    """A note below components in English.

    Examples
    --------
    >>> english_note("symmetric", count=3), english_note("undecided")
    ('3 more components follow by symmetry.', 'Undecided whether zero:')
    """
    return _NOTES[name].format(**values)


def section(quantity: Quantity, title: str = "", note: Note = english_note) -> str:
    """A quantity with its heading, its definition and its nonzero components, as HTML.

    title: the heading, if it is not the English name of the quantity. note: texts of the notes.
    """
    entry = quantity.entry
    head = (
        f'<div class="head"><h3>{html_text(title or entry.title)}</h3>'
        f"{mathml(equation_latex(entry.equation))}</div>"
    )
    return f'<section class="card" id="{entry.name}">{head}{_body(quantity, note)}</section>'


def _displayed(latex: str) -> str:
    """A displayed formula that scrolls sideways when it is too long."""
    return f'<div class="scroll">{mathml(latex, display=True)}</div>'


def _body(quantity: Quantity, note: Note) -> str:
    slots = quantity.tensor.slots
    label = latex_label(latex_symbol(quantity.entry.symbol), quantity.letters, slots)
    if not quantity.independent:
        return f'<div class="zero">{_displayed(f"{label} = 0")}</div>'
    if not slots:
        [value] = quantity.independent.values()
        shown = _displayed(f"{label} = {latex_text(quantity.written(value))}")
        return shown + _undecided(quantity, note)
    if len(slots) == 2 and _fits(quantity):
        return _displayed(f"{label} = {_matrix(quantity)}") + _undecided(quantity, note)
    return _listed(quantity, note)


def _fits(quantity: Quantity) -> bool:
    """Whether a matrix is narrow enough to be read."""
    n = quantity.tensor.frame.dimension
    widths = [0] * n
    for (_, column), value in quantity.nonzero.items():
        widths[column] = max(widths[column], _width(quantity, value))
    return sum(widths) + 2 * n <= STYLE.line


def _matrix(quantity: Quantity) -> str:
    n = range(quantity.tensor.frame.dimension)
    texts = {
        index: latex_text(quantity.written(value)) for index, value in quantity.nonzero.items()
    }
    return latex_matrix([[texts.get((i, j), "0") for j in n] for i in n])


def _listed(quantity: Quantity, note: Note) -> str:
    """Components in columns; the later ones of a long list are folded away."""
    tensor = quantity.tensor
    lines = []
    narrow = all(_width(quantity, value) <= STYLE.third for value in quantity.independent.values())
    columns = "components" if narrow else "components two"
    for index, value in quantity.independent.items():
        label = latex_label(
            latex_symbol(quantity.entry.symbol), latex_marks(tensor, index), tensor.slots
        )
        wide = " wide" if _width(quantity, value) > STYLE.half else ""
        formula = mathml(f"{label} = {latex_text(quantity.written(value))}", tall=True)
        lines.append(f'<div class="scroll{wide}">{formula}</div>')
    shown = f'<div class="{columns}">{"".join(lines[: STYLE.unfolded])}</div>'
    if len(lines) > STYLE.unfolded:
        rest = "".join(lines[STYLE.unfolded :])
        more = html_text(note("folded", count=len(lines) - STYLE.unfolded))
        shown += f'<details><summary>{more}</summary><div class="{columns}">{rest}</div></details>'
    hidden = len(quantity.nonzero) - len(quantity.independent)
    if hidden:
        text = note("symmetric_one") if hidden == 1 else note("symmetric", count=hidden)
        shown += f'<p class="note">{html_text(text)}</p>'
    return shown + _undecided(quantity, note)


def _undecided(quantity: Quantity, note: Note) -> str:
    """A line that names the components that may vanish or not."""
    if not quantity.undecided:
        return ""
    tensor = quantity.tensor
    labels = ", ".join(
        mathml(
            latex_label(
                latex_symbol(quantity.entry.symbol), latex_marks(tensor, index), tensor.slots
            )
        )
        for index in quantity.undecided
    )
    return f'<p class="note">{html_text(note("undecided"))} {labels}.</p>'


def aligned(chosen: Quantity, *, every: bool = False) -> str:
    """The components as LaTeX, one align* environment; needs amsmath."""
    entry, tensor = chosen.entry, chosen.tensor
    components = chosen.nonzero if every else chosen.independent
    lines, write = [], TexPrinter().doprint
    for index, element in components.items():
        left = latex_label(latex_symbol(entry.symbol), latex_marks(tensor, index), tensor.slots)
        mark = rf"\quad\text{{{OPEN}}}" if index in chosen.undecided else ""
        lines.append(f"  {left} &= {write(chosen.written(element))}{mark}")
    if not lines:
        lines = [f"  {latex_label(latex_symbol(entry.symbol), chosen.letters, tensor.slots)} &= 0"]
    body = " \\\\\n".join(lines)
    return f"% {entry.title}\n\\begin{{align*}}\n{body}\n\\end{{align*}}"


def _width(quantity: Quantity, value: Element) -> int:
    """About how many letters wide a value is, a fraction being as wide as its longer half."""
    halves = sympy.fraction(quantity.written(value))
    return max(len(re.sub(r"sqrt|[*^ ]", "", expression_text(half))) for half in halves)
