"""Field equations: a section of a report, and the equations as data."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from geomtorsion.geometry import Tensor
from geomtorsion.geometry.notation import short
from geomtorsion.geometry.quantities import Entry
from geomtorsion.gravity import FieldEquations
from geomtorsion.pictures.formula import mathml
from geomtorsion.pictures.latex import (
    latex_label,
    latex_marks,
    latex_name,
    latex_text,
    text_label,
    text_marks,
)
from geomtorsion.pictures.quantities import Quantity
from geomtorsion.pictures.sections import section
from geomtorsion.pictures.text import expression_text, plain_text
from geomtorsion.support.outgoing import html_text

TITLE = "Field equations"
ENTRIES = {
    "E": Entry(
        name="coframe_equation", title="Coframe equation", symbol="E",
        equation="E_i^n = (1/e) δ(e L)/δe^i_n", section=TITLE,
    ),
    "E_[ij]": Entry(
        name="antisymmetric_equation", title="Antisymmetric part of the coframe equation",
        symbol="E\u0303", equation="E\u0303_ij = E_[ij]", section=TITLE,
    ),
    "C": Entry(
        name="connection_equation", title="Connection equation", symbol="C",
        equation="C^{ni}_j = (1/e) δ(e L)/δω_{ni}^j", section=TITLE,
    ),
    "M": Entry(
        name="metric_equation", title="Metric equation", symbol="M",
        equation="2 M_ij = E_ji + (1/e) D_n (e C^n_ij)", section=TITLE,
    ),
}  # fmt: skip


def field_equations_html(equations: FieldEquations) -> str:
    """Lagrangian, its invariants and the left side of each equation as HTML.

    Examples
    --------
    >>> import geomtorsion as gt
    >>> from geomtorsion import gravity
    >>> frame = gt.spaces.load("frw").frame
    >>> field_equations_html(gravity.equations(gt.cartan(frame), "T")).count("<section")
    3
    """
    names = html_text(", ".join(one.name for one in equations.connections))
    constants = html_text(
        f"Constants: {', '.join(equations.constants)}. " * bool(equations.constants)
    )
    lagrangian = latex_text(equations.expression)
    values = [
        mathml(f"{latex_name(name)} = {latex_text(value)}", display=True)
        for name, value in equations.scalars.items()
    ]
    for name, tensor in equations.matter_equations.items():
        for index in tensor.components.independent:
            label = latex_label(name, latex_marks(tensor, index), tensor.slots)
            written = latex_text(short(tensor, index))
            values.append(mathml(f"{label}: \\quad {written} = 0", display=True))
    quantities = [Quantity(ENTRIES[name], x) for name, x in equations.tensors.items()]
    return (
        f'<section class="card"><p>Left sides of the field equations of '
        f"{mathml(f'L = {lagrangian}')} ({names}). {constants}The space is "
        f"a solution where they vanish.</p>"
        f'<div class="scroll">{"".join(values)}</div></section>'
        f"{''.join(map(section, quantities))}"
    )


def field_equations_data(equations: FieldEquations) -> dict[str, Any]:
    """Lagrangian, invariants and equations as text.

    Indices count from 0; vanishing components are omitted.
    """
    return {
        "lagrangian": str(equations.lagrangian.expression),
        "connections": [one.name for one in equations.connections],
        "constants": list(equations.constants),
        "scalars": {name: plain_text(value) for name, value in equations.scalars.items()},
        "equations": {
            name: {",".join(map(str, i)): plain_text(x) for i, x in tensor.nonzero().items()}
            for name, tensor in equations.tensors.items()
        },
        "matter_equations": {
            name: {",".join(map(str, i)): plain_text(x) for i, x in tensor.nonzero().items()}
            for name, tensor in equations.matter_equations.items()
        },
    }


def field_equations_lines(equations: FieldEquations, *, greek: bool) -> Iterator[str]:
    """Connections, constants, invariants and equations, line by line.

    Indices count from 1. Equal components, such as E_2^2 = E_3^3, are written once.

    greek: whether Greek letters may be written.

    Examples
    --------
    >>> import geomtorsion as gt
    >>> frame = gt.spaces.load("frw_flat").frame
    >>> equations = gt.gravity.equations(gt.cartan(frame), "T")
    >>> list(field_equations_lines(equations, greek=False))[3]
    'E_1^1 = -6*diff(a(t), t)^2/a(t)^2'
    """
    yield ", ".join(one.name for one in equations.connections)
    if equations.constants:
        yield f"constants: {' '.join(equations.constants)}"
    for name, value in equations.scalars.items():
        yield f"{name} = {expression_text(value, greek=greek)}"
    for remark in equations.remarks:
        yield f"{remark}; choose another one by --connection"
    for name, tensor in equations.tensors.items():
        yield ""
        yield from (
            [f"{name} = 0"] if tensor.is_zero else _components(equations, name, tensor, greek)
        )
    for name, tensor in equations.matter_equations.items():
        yield ""
        yield from _of_matter(equations, name, tensor, greek)
    yield ""


def _components(equations: FieldEquations, name: str, tensor: Tensor, greek: bool) -> Iterator[str]:
    """The components of a tensor that differ, in the names of invariants."""
    labels: dict[str, list[str]] = {}
    for index in tensor.components.independent:
        marks = text_marks(tensor, index, greek=greek)
        label = text_label(name[0], marks, tensor.slots)
        if name != name[0]:
            label = label.replace("{", "{[").replace("}", "]}")
        text = expression_text(equations.readable(name, *index), greek=greek)
        labels.setdefault(text, []).append(label)
    for text, equal in labels.items():
        yield f"{' = '.join(equal)} = {text}"


def _of_matter(equations: FieldEquations, name: str, tensor: Tensor, greek: bool) -> Iterator[str]:
    """The equations of one matter field."""
    if tensor.is_zero:
        yield f"equation of {name}: holds"
        return
    for index in tensor.components.independent:
        label = text_label(name, text_marks(tensor, index, greek=greek), tensor.slots)
        text = expression_text(equations.written(tensor.element(*index)), greek=greek)
        yield f"equation of {label}: {text} = 0"
