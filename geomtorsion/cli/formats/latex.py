"""latex: components as aligned equations, ready for a document."""

from __future__ import annotations

from collections.abc import Sequence

import sympy

from geomtorsion.pictures.labels import latex_label, latex_marks
from geomtorsion.pictures.quantities import Quantity
from geomtorsion.spaces.space import Space


def latex_of(space: Space, quantities: Sequence[Quantity], *, every: bool = False) -> str:
    """One align* environment for each quantity; needs amsmath."""
    parts = [f"% {space.name}: {space.title}\n% needs \\usepackage{{amsmath}}"]
    parts += [_equations(chosen, every=every) for chosen in quantities]
    return "\n\n".join(parts)


def _equations(chosen: Quantity, *, every: bool) -> str:
    entry, tensor = chosen.entry, chosen.tensor
    components = chosen.nonzero if every else chosen.independent
    lines = []
    for index, element in components.items():
        left = latex_label(entry.latex, latex_marks(tensor, index), tensor.slots)
        lines.append(f"  {left} &= {sympy.latex(element.sympy)}")
    if not lines:
        lines = [f"  {latex_label(entry.latex, chosen.letters, tensor.slots)} &= 0"]
    body = " \\\\\n".join(lines)
    return f"% {entry.title}\n\\begin{{align*}}\n{body}\n\\end{{align*}}"
