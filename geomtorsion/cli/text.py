"""text: components as aligned lines for a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import sympy
import typer

from geomtorsion.pictures.labels import text_label, text_marks
from geomtorsion.pictures.text import expression_text, greek_name

if TYPE_CHECKING:
    from geomtorsion.pictures.chosen import Chosen
    from geomtorsion.spaces.space import Space

_ASCII = {
    "Γ\u0304": "Gamma_bar", "R\u0304": "R_bar", "Γ": "Gamma", "Φ": "Phi", "δ": "delta",
    "η": "eta", "ω": "omega", "∂": "d", "∧": "^", "θ": "theta",
}  # fmt: skip


def text_of(
    space: Space, quantities: Sequence[Chosen], *, greek: bool = True, every: bool = False
) -> str:
    """A heading and the quantities, one paragraph each; `every` shows what symmetry repeats."""
    parts = [_heading(space, greek=greek)]
    parts += [_paragraph(chosen, greek=greek, every=every) for chosen in quantities]
    return "\n\n".join(parts)


def in_ascii(text: str) -> str:
    """Symbols of the catalogue in letters that every terminal has."""
    for symbol, name in _ASCII.items():
        text = text.replace(symbol, name)
    return text


def _heading(space: Space, *, greek: bool) -> str:
    frame = space.frame

    def named(symbols: Sequence[sympy.Symbol]) -> str:
        return ", ".join(greek_name(x.name) if greek else x.name for x in symbols)

    title = typer.style(f"{space.name}: {space.title}", bold=True)
    lines = [title, f"coordinates {named(frame.coordinates)}"]
    if frame.parameters:
        parameters = [symbol.name for symbol in frame.parameters]
        lines[-1] += "; parameters " + ", ".join(
            map(greek_name, parameters) if greek else parameters
        )
    entries = frame.eta.components.nonzero
    if all(i == j for i, j in entries):
        signs = "".join("+" if frame.eta[i, i] == 1 else "-" for i in range(frame.dimension))
        lines[-1] += f"; signature {signs}"
    lines += [f"root {branch}" for branch in frame.field.branches]
    return "\n".join(lines)


def _paragraph(chosen: Chosen, *, greek: bool, every: bool) -> str:
    entry, tensor = chosen.entry, chosen.tensor
    adapted = str if greek else in_ascii
    symbol, label = adapted(entry.symbol), adapted(chosen.text_label)
    title = typer.style(entry.title, bold=True)
    components = chosen.nonzero if every else chosen.independent
    if not components:
        return f"{title}  {label} = 0"
    if not tensor.slots:
        value = expression_text(components[()].sympy, greek=greek)
        return f"{title}  {symbol} = {value}"
    lines = [f"{title}  {label}   [{adapted(entry.equation)}]"]
    labels = {
        index: text_label(symbol, text_marks(tensor, index, greek=greek), tensor.slots)
        for index in components
    }
    width = max(map(_width, labels.values()))
    for index, element in components.items():
        gap = " " * (width - _width(labels[index]))
        lines.append(f"  {labels[index]}{gap} = {expression_text(element.sympy, greek=greek)}")
    total = len(chosen.nonzero)
    if total > len(components):
        rest = total - len(components)
        lines.append(f"  ({rest} more follow{'s' * (rest == 1)} by symmetry)")
    return "\n".join(lines)


def _width(label: str) -> int:
    """Columns that a label takes: a bar above a letter takes none."""
    return len(label) - label.count("\u0304")
