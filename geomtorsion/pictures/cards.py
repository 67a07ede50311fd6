"""Cards: one quantity each, as a matrix, a list of components or a single value."""

from __future__ import annotations

import re
from html import escape
from typing import TYPE_CHECKING

import sympy

from geomtorsion.pictures.equations import equation_mathml
from geomtorsion.pictures.labels import mathml_label, mathml_marks
from geomtorsion.pictures.mathml import mathml
from geomtorsion.pictures.text import expression_text

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.pictures.chosen import Chosen

# A matrix or component longer than this, in letters, gets more room.
_LONGEST_ROW = 90
_LONGEST_OF_THREE = 20
_LONGEST_OF_TWO = 34
_MOST_SHOWN = 40


def card(chosen: Chosen) -> str:
    """A quantity with its heading, its definition and its nonzero components."""
    entry = chosen.entry
    head = (
        f'<div class="head"><h3>{escape(entry.title)}</h3>'
        f"<math>{equation_mathml(entry.equation)}</math></div>"
    )
    return f'<section class="card" id="{entry.name}">{head}{_body(chosen)}</section>'


def block(inner: str) -> str:
    """A displayed formula that scrolls sideways when it is too long."""
    return f'<div class="scroll"><math display="block">{inner}</math></div>'


def _body(chosen: Chosen) -> str:
    symbol = equation_mathml(chosen.entry.symbol)
    slots = chosen.tensor.slots
    marks = [f"<mi>{letter}</mi>" for letter in chosen.letters]
    label = mathml_label(symbol, marks, slots)
    if not chosen.independent:
        return f'<div class="zero">{block(f"{label}<mo>=</mo><mn>0</mn>")}</div>'
    if not slots:
        [value] = chosen.independent.values()
        return block(f"{label}<mo>=</mo>{mathml(value.sympy)}")
    if len(slots) == 2 and _fits(chosen):
        return block(f"{label}<mo>=</mo>{_matrix(chosen)}")
    return _listed(chosen, symbol)


def _fits(chosen: Chosen) -> bool:
    """Whether a matrix is narrow enough to be read."""
    n = chosen.tensor.frame.dimension
    widths = [0] * n
    for (_, column), value in chosen.nonzero.items():
        widths[column] = max(widths[column], _width(value))
    return sum(widths) + 2 * n <= _LONGEST_ROW


def _matrix(chosen: Chosen) -> str:
    n = chosen.tensor.frame.dimension
    rows = []
    for i in range(n):
        cells = (chosen.nonzero.get((i, j)) for j in range(n))
        written = ("<mn>0</mn>" if cell is None else mathml(cell.sympy) for cell in cells)
        rows.append(f"<mtr>{''.join(f'<mtd>{cell}</mtd>' for cell in written)}</mtr>")
    return f"<mrow><mo>(</mo><mtable>{''.join(rows)}</mtable><mo>)</mo></mrow>"


def _listed(chosen: Chosen, symbol: str) -> str:
    """Components in columns; the later ones of a long list are folded away."""
    tensor = chosen.tensor
    lines = []
    three = all(_width(value) <= _LONGEST_OF_THREE for value in chosen.independent.values())
    columns = "components" if three else "components two"
    for index, value in chosen.independent.items():
        label = mathml_label(symbol, mathml_marks(tensor, index), tensor.slots)
        wide = " wide" if _width(value) > _LONGEST_OF_TWO else ""
        formula = f'<math displaystyle="true">{label}<mo>=</mo>{mathml(value.sympy)}</math>'
        lines.append(f'<div class="scroll{wide}">{formula}</div>')
    shown = f'<div class="{columns}">{"".join(lines[:_MOST_SHOWN])}</div>'
    if len(lines) > _MOST_SHOWN:
        rest = "".join(lines[_MOST_SHOWN:])
        shown += (
            f"<details><summary>{len(lines) - _MOST_SHOWN} more components</summary>"
            f'<div class="{columns}">{rest}</div></details>'
        )
    hidden = len(chosen.nonzero) - len(chosen.independent)
    if hidden:
        follow = "component follows" if hidden == 1 else "components follow"
        shown += f'<p class="note">{hidden} more {follow} by symmetry.</p>'
    return shown


def _width(value: Element) -> int:
    """About how many letters wide a value is, a fraction being as wide as its longer half."""
    halves = sympy.fraction(value.sympy)
    return max(len(re.sub(r"sqrt|[*^ ]", "", expression_text(half))) for half in halves)
