"""text: components as aligned lines for a terminal."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import sympy
import typer

from geomtorsion.pictures.labels import text_label, text_marks
from geomtorsion.pictures.quantities import Quantity
from geomtorsion.pictures.text import expression_text
from geomtorsion.spaces.space import Space

# Letters with bars stand first: without, their bars would be left over.
_ASCII = {
    "Γ\u0304": "Gamma_bar", "R\u0304": "R_bar", "Γ": "Gamma", "Φ": "Phi", "δ": "delta",
    "η": "eta", "ω": "omega", "∂": "d", "∧": "^", "θ": "theta",
}  # fmt: skip


def text_of(
    space: Space, quantities: Sequence[Quantity], *, greek: bool = True, every: bool = False
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
    frame, n = space.frame, space.frame.dimension

    def written(expressions: Iterable[sympy.Basic]) -> str:
        return ", ".join(expression_text(part, greek=greek) for part in expressions)

    title = space.name if space.title == space.name else f"{space.name}: {space.title}"
    facts = [f"coordinates {written(frame.coordinates)}"]
    facts += [f"parameters {written(frame.parameters)}"] * bool(frame.parameters)
    facts += [f"domain {written(frame.domain)}"] * bool(frame.domain)
    diagonal = [frame.eta[i, i] for i in range(n)]
    if len(frame.eta.components.nonzero) == n and set(diagonal) <= {1, -1}:
        facts.append("signature " + "".join("+" if sign == 1 else "-" for sign in diagonal))
    else:
        rows = ("[" + written(frame.eta[i, j] for j in range(n)) + "]" for i in range(n))
        facts.append(f"frame metric [{', '.join(rows)}]")
    facts += [
        f"root {written([b.radical])} read as {written([b.read_as])}: right where {b.condition}"
        for b in frame.field.branches
    ]
    return "\n".join([typer.style(title, bold=True), *facts])


def _paragraph(chosen: Quantity, *, greek: bool, every: bool) -> str:
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
    # Equal signs stand below each other.
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
