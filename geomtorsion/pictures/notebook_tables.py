"""notebook tables: frames, tensors and connections as a notebook shows them, formulas in MathML."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Protocol

from geomtorsion.errors import ExpressionError, LimitError
from geomtorsion.geometry.assumption import assumption_of
from geomtorsion.geometry.notation import letters, open_mark, plain_symbol, short
from geomtorsion.pictures.formula import mathml
from geomtorsion.pictures.latex import latex_label, latex_matrix, latex_name, latex_text
from geomtorsion.pictures.style import STYLE
from geomtorsion.support.outgoing import html_text

if TYPE_CHECKING:
    import sympy

    from geomtorsion.geometry import (
        Connection,
        Curvature,
        Frame,
        HolonomyAlgebra,
        LieAlgebra,
        Tensor,
        Torsion,
    )
    from geomtorsion.geometry.notation import ComponentTable
    from geomtorsion.same import Equivalence, Symmetries
    from geomtorsion.spaces import Space


class Written(Protocol):
    """Something with equations in LaTeX."""

    def _repr_latex_(self) -> str: ...


# In a form that is also valid XML.
_OPEN = '<details open="">'
_LEFT = ' style="text-align:left"'


def tensor_html(tensor: Tensor) -> str:
    """The components of a tensor that do not vanish; above them a matrix if it has two indices.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> shown = tensor_html(load("so3").frame.metric)
    >>> shown.count("<mtr>"), shown.count("<tr>")  # three rows, and one for each component
    (3, 5)
    """
    table = table_html(tensor.table())
    if len(tensor.slots) != 2 or not tensor.nonzero():
        return table
    n = range(tensor.frame.dimension)
    try:
        texts = [[short(tensor, (i, j)) for j in n] for i in n]
    except LimitError:
        return table
    if sum(max(len(str(row[j])) for row in texts) + 2 for j in n) > STYLE.line:
        return table
    matrix = latex_matrix([[latex_text(value) for value in row] for row in texts])
    label = latex_label(_symbol(tensor), letters(tensor.slots), tensor.slots)
    return f"<div>{_math(f'{label} = {matrix}', display=True)}{table}</div>"


def torsion_html(torsion: Torsion) -> str:
    """Components of S."""
    return tensor_html(torsion.S)


def curvature_html(curvature: Curvature) -> str:
    """Components of the curvature with its last index up."""
    return tensor_html(curvature.riemann)


def table_html(table: ComponentTable) -> str:
    """A table that folds away; the later rows of a long table are folded.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> table_html(load("so3").frame.metric.table("abc")).count("<details")
    1
    """
    heading = _heading(table)
    if not table.indices:
        return f"<div>{heading}</div>"
    rows = list(table.indices)
    shown = _rows(table, rows[: STYLE.unfolded])
    if len(rows) > STYLE.unfolded:
        rest = _rows(table, rows[STYLE.unfolded : STYLE.listed])
        count = len(rows) - STYLE.unfolded
        beyond = len(rows) - STYLE.listed
        left = f"<p>{beyond} more: print(tensor.table())</p>" if beyond > 0 else ""
        shown += f"<details><summary>{count} more components</summary>{rest}{left}</details>"
    remarks = filter(None, [table.ending, table.assumption])
    ending = "".join(f"<p>{html_text(remark)}</p>" for remark in remarks)
    return f"{_OPEN}<summary>{heading}</summary>{shown}{ending}</details>"


def connection_html(connection: Connection) -> str:
    """The coefficients of a connection, to be chosen by the upper index.

    Examples
    --------
    >>> from geomtorsion.geometry import cartan
    >>> from geomtorsion.spaces import load
    >>> connection_html(cartan(load("so3").frame)).count("<details")
    3
    """
    whole = connection.table()
    tensor = connection.coefficients
    parts = []
    for c, name in enumerate(whole.names):
        table = connection.table(where={2: c}, every=True)
        slots = letters(tensor.slots)
        label = _math(latex_label(_symbol(tensor), [*slots[:2], latex_name(name)], tensor.slots))
        if not table.indices:
            parts.append(f"<div>{label} = 0</div>")
            continue
        opened = ' open=""' if c == 0 or len(whole.indices) <= STYLE.unfolded else ""
        count = f"{len(table.indices)} of {connection.frame.dimension**2} do not vanish"
        rows = _rows(table, table.indices)
        parts.append(f"<details{opened}><summary>{label}: {count}</summary>{rows}</details>")
    label = _math(latex_label(_symbol(tensor), letters(tensor.slots), tensor.slots))
    parts += [f"<p>{html_text(connection.assumption)}</p>"] * bool(connection.assumption)
    return f"<div>{html_text(connection.name)} {label}: {whole.count}{''.join(parts)}</div>"


def equations_html(found: Written) -> str:
    """Equations in MathML, which a notebook shows without MathJax; below a heading if there is one.

    Examples
    --------
    >>> from geomtorsion.action import variation
    >>> from geomtorsion.spaces import load
    >>> equations_html(variation(load("so3").frame)).count("<mtr>")
    3
    """
    latex = found._repr_latex_().strip("$").removeprefix(r"\displaystyle ")
    return f"<div>{_math(latex, display=True)}</div>"


def frame_html(frame: Frame) -> str:
    """Name, coordinates, one-forms, signs, branches and assumed region of a frame.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> frame_html(load("so3").frame).count("<tr>")
    3
    """
    names = ", ".join(_math(latex_name(symbol.name)) for symbol in frame.coordinates)
    rows = []
    for i in range(frame.dimension):
        form = [
            (frame.coframe[i, mu], latex_name(symbol.name))
            for mu, symbol in enumerate(frame.coordinates)
        ]
        rows.append((_math(rf"e^{{\hat{{{i + 1}}}}}"), f"= {_one_form(form)}"))
    table = _table((), rows)
    remarks = [*map(str, frame.branches), *filter(None, [assumption_of(frame)])]
    branches = "".join(f"<p>{html_text(remark)}</p>" for remark in remarks)
    name = html_text(frame.name or "frame")
    return f"<div><b>{name}</b> (coordinates {names}; {_signature(frame)}){table}{branches}</div>"


def _signature(frame: Frame) -> str:
    """The constant metric of the legs: its diagonal, or the whole where there is more."""
    n = range(frame.dimension)
    rows = [[latex_text(frame.eta[i, j]) for j in n] for i in n]
    if all(i == j for i, j in frame.eta.nonzero()):
        diagonal = ", ".join(rows[i][i] for i in n)
        return _math(rf"\eta = \operatorname{{diag}}\left({diagonal}\right)")
    return _math(rf"\eta = {latex_matrix(rows)}")


def space_html(space: Space) -> str:
    """Description of a space, its source and its frame.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> space_html(load("so3"))[:11]
    '<div><b>so3'
    """
    source = f"<p>Source: {html_text(space.source)}</p>" if space.source else ""
    notes = f"<p><i>{html_text(space.notes)}</i></p>" if space.notes else ""
    title = f"<b>{html_text(space.name)}</b>: {html_text(space.title)}"
    return (
        f"<div>{title}<p>{html_text(space.story)}</p>{source}{notes}</div>{frame_html(space.frame)}"
    )


def _one_form(form: Sequence[tuple[sympy.Expr, str]]) -> str:
    """A sum of differentials; factors that are not formulas stay text."""
    parts = []
    for factor, name in form:
        if factor == 0:
            continue
        differential = rf"\mathrm{{d}}{name}"
        if factor == 1:
            parts.append(differential)
            continue
        written = latex_text(factor)
        bracketed = rf"\left({written}\right)" if factor.is_Add else written
        parts.append(rf"{bracketed}\,{differential}")
    return _math(" + ".join(parts).replace("+ -", "- "))


def _heading(table: ComponentTable) -> str:
    """Name of a tensor and its number of components."""
    tensor = table.tensor
    label = latex_label(_symbol(tensor), letters(tensor.slots), tensor.slots)
    words = f"{html_text(tensor.name or 'tensor')} {_math(label)}"
    if table.count:
        return f"{words}: {table.count}"
    return f"{words} = {_value(table, ())}"


def _rows(table: ComponentTable, indices: Iterable[tuple[int, ...]]) -> str:
    """Rows: the component and its value."""
    tensor = table.tensor
    if not tensor.slots:
        return ""
    rows = []
    for index in indices:
        marks = [
            rf"\hat{{{latex_name(mark)}}}" if slot in "DU" else latex_name(mark)
            for slot, mark in zip(tensor.slots, table.marks(index), strict=True)
        ]
        label = latex_label(_symbol(tensor), marks, tensor.slots)
        rows.append((_math(label), _value(table, index)))
    return _table(("component", "value"), rows)


def _symbol(tensor: Tensor) -> str:
    """The symbol of a tensor in LaTeX; a word is upright."""
    symbol = tensor.symbol
    return symbol if symbol.startswith("\\") else latex_name(plain_symbol(symbol))


def _value(table: ComponentTable, index: tuple[int, ...]) -> str:
    """The value of a component as a formula; the reason where it is too long to be written."""
    try:
        return _math(latex_text(short(table.tensor, index))) + open_mark(table.tensor, index)
    except LimitError as error:
        return f"<i>{html_text(str(error))}</i>"


def _math(latex: str, *, display: bool = False) -> str:
    """A formula; a formula that our writer does not know stays text."""
    try:
        return mathml(latex, display=display, tall=not display)
    except ExpressionError:
        return f"<code>{html_text(latex)}</code>"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table of cells that are HTML already."""

    def line(cells: Sequence[str], tag: str) -> str:
        return f"<tr>{''.join(f'<{tag}{_LEFT}>{cell}</{tag}>' for cell in cells)}</tr>"

    above = f"<thead>{line(head, 'th')}</thead>" if head else ""
    return f"<table>{above}<tbody>{''.join(line(row, 'td') for row in rows)}</tbody></table>"


def algebra_html(algebra: LieAlgebra) -> str:
    """Name, brackets and series of a Lie algebra.

    Examples
    --------
    >>> from geomtorsion.geometry import LieAlgebra
    >>> algebra_html(LieAlgebra({(0, 1, 2): 1})).count("<tr>")
    1
    """
    rows: dict[tuple[int, int], list[str]] = {}
    for (i, j, k), value in algebra.brackets().items():
        written = latex_text(value)
        if value.is_Add:
            written = rf"\left({written}\right)"
        size = {"1": "", "-1": "-"}.get(written, rf"{written}\,")
        rows.setdefault((i, j), []).append(f"{size}X_{{{k}}}")
    table = _table(
        (),
        [
            (
                _math(rf"\left[X_{{{i}}}, X_{{{j}}}\right]"),
                _math("= " + " + ".join(terms).replace("+ -", "- ")),
            )
            for (i, j), terms in rows.items()
        ],
    )
    lines = "".join(f"<p>{html_text(line)}</p>" for line in algebra.lines()[-2:])
    return f"<div><b>{html_text(algebra.heading)}</b>{table}{lines}</div>"


def holonomy_html(holonomy: HolonomyAlgebra) -> str:
    """Name, dimensions, parallel tensors and generators of a holonomy algebra.

    Examples
    --------
    >>> from geomtorsion.geometry import levi_civita
    >>> from geomtorsion.spaces import load
    >>> "parallel vectors: 0" in holonomy_html(levi_civita(load("s2").frame).holonomy_algebra)
    True
    """
    lines = "".join(f"<li>{html_text(line)}</li>" for line in holonomy.lines())
    generators = "".join(tensor_html(one) for one in holonomy.generators)
    folded = f"<details><summary>generators</summary>{generators}</details>" if generators else ""
    return f"<div><b>{html_text(repr(holonomy))}</b><ul>{lines}</ul>{folded}</div>"


def symmetries_html(symmetries: Symmetries) -> str:
    """Dimension, algebra and vectors of the symmetries of a geometry.

    Examples
    --------
    >>> from geomtorsion.gravity import symmetries
    >>> "so(3)" in symmetries_html(symmetries("s2"))
    True
    """
    heading, *lines = str(symmetries).splitlines()
    rest = "".join(f"<li>{html_text(line.strip())}</li>" for line in lines)
    return f"<div><b>{html_text(heading)}</b><ul>{rest}</ul></div>"


def equivalence_html(result: Equivalence) -> str:
    """The verdict on two geometries, with its reason and certainty.

    Examples
    --------
    >>> from geomtorsion.same import same_geometry
    >>> "same" in equivalence_html(same_geometry("s2", "s2"))
    True
    """
    (_, verdict), *rest = result.rows().items()
    cells = "".join(
        f"<tr><td{_LEFT}>{html_text(name)}</td><td{_LEFT}>{html_text(text)}</td></tr>"
        for name, text in rest
    )
    return f"<div><b>{html_text(verdict)}</b><table>{cells}</table></div>"
