"""Assumption: the region that was assumed for a frame, as a remark beside printed results."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.errors import CoordinateError
from geomtorsion.exact import Element
from geomtorsion.support.displays import latex_of

if TYPE_CHECKING:
    from geomtorsion.geometry.frame import Frame

# Generators of a field that are real, or have one sign, in a part of the space only.
SIGNED = ("root", "log", "primitive")


def assumption_of(frame: Frame, values: Iterable[Element | sp.Basic] | None = None) -> str:
    """The region in which signs of a frame are read, if it was assumed; else empty.

    values: a printed result, which may depend on these signs; without roots and logarithms it
    depends on none, and the remark is empty.

    Examples
    --------
    >>> from geomtorsion.geometry import Frame
    >>> frame = Frame("x y", [["sqrt(x)", 0], [0, 1]])
    >>> assumption_of(frame)
    'for x > 0, assumed; declare domain=[...] for another region'
    >>> assumption_of(frame, [frame.coframe[0, 0]]) != "", assumption_of(frame, [sp.Integer(1)])
    (True, '')
    """
    return "" if not _depends(frame, values) else _region(frame)


def assumption_latex(frame: Frame, values: Iterable[Element | sp.Basic] | None = None) -> str:
    r"""The same remark in LaTeX.

    Examples
    --------
    >>> from geomtorsion.geometry import Frame
    >>> assumption_latex(Frame("x y", [["sqrt(x)", 0], [0, 1]]))
    '\\text{for } x > 0 \\text{, assumed}'
    """
    if not assumption_of(frame, values):
        return ""
    relations = r",\; ".join(map(latex_of, frame.region.relations))
    return rf"\text{{for }} {relations} \text{{, assumed}}"


def _region(frame: Frame) -> str:
    """The assumed region in words; empty where it is declared or where there is none."""
    try:
        return frame.region.assumption
    except CoordinateError:
        return ""


def _depends(frame: Frame, values: Iterable[Element | sp.Basic] | None) -> bool:
    """Whether values depend on signs that a frame has in a part of the space only."""
    return values is None or bool(frame.branches) or any(map(_is_signed, values))


def _is_signed(value: Element | sp.Basic) -> bool:
    """Whether a value contains a root or a function that is real in a part of the space only."""
    if isinstance(value, Element):
        kinds = value.field.generators_of(value)
        return any(one.kind in SIGNED and one.depends for one in kinds)
    roots = (x for x in value.atoms(sp.Pow) if x.base.free_symbols and x.exp.is_integer is not True)
    return any(True for _ in roots) or any(x.free_symbols for x in value.atoms(sp.log, sp.acosh))
