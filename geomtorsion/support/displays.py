"""displays: hooks for the notebook display of a value; packages above register the drawing."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
import sympy as sp

from geomtorsion.support.checks import cut
from geomtorsion.support.higher import higher
from geomtorsion.support.outgoing import latex_formula

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Plot(Protocol):
    """Method that draws a value as a figure."""

    def __call__(self, **options: Any) -> Figure:
        """Draw with options of the function of pictures."""
        ...


def drawn_by(module: str, function: str) -> Callable[[Any], str]:
    """A method that gives a value as HTML or SVG: a function of a module of pictures.

    The module is named, not imported: pictures know every value, and no value knows its pictures.
    Only a notebook goes this way up.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> drawn_by("notebook_tables", "frame_html")(load("so3").frame)[:4]
    '<div'
    """

    def drawn(self: Any) -> str:
        return getattr(higher(f"pictures.{module}"), function)(self)

    drawn.__doc__ = "What a notebook shows."
    return drawn


def figure_by(module: str, function: str) -> Plot:
    """A method `plot` that draws a value: a function of a module of pictures.

    It takes the other arguments of the function, by name. `pictures.save` writes the figure.

    Examples
    --------
    >>> from geomtorsion.loops import BurgersVector
    >>> BurgersVector.plot.__doc__.partition(":")[0]
    'Draw it as a matplotlib figure'
    """

    def plot(self: object, **options: object) -> Figure:
        return getattr(higher(f"pictures.{module}"), function)(self, **options)

    plot.__doc__ = f"Draw it as a matplotlib figure: `geomtorsion.pictures.{module}.{function}`."
    return plot


def key_completions(self: Mapping[str, object]) -> list[str]:
    """Names that a notebook offers after `solution[`."""
    return list(self.keys())


def values_text(values: object) -> str:
    """Numbers in one line with six digits; a long array is shortened.

    Examples
    --------
    >>> values_text(1 / 3), values_text([1.0, 2.5])
    ('0.333333', '[1, 2.5]')
    """
    array = np.asarray(values)
    text = np.array2string(
        array, separator=", ", threshold=8, edgeitems=2, formatter={"float": lambda x: f"{x:.6g}"}
    )
    return " ".join(text.split())


def short_repr(self: Any) -> str:
    """The type of a dataclass and its fields that are not at their defaults; arrays as shapes.

    Examples
    --------
    >>> from geomtorsion.scenes import State
    >>> short_repr(State(omega=(0, 0, 1)))
    'State(omega=(0, 0, 1))'
    """
    parts = []
    for one in fields(self):
        value = getattr(self, one.name)
        plain = isinstance(value, bool | int | float | str | tuple)
        if not one.repr or value is None or (plain and value == one.default):
            continue
        array = isinstance(value, np.ndarray)
        parts.append(f"{one.name}={f'array{value.shape}' if array else cut(repr(value))}")
    return f"{type(self).__name__}({', '.join(parts)})"


def latex_of(value: object) -> str:
    r"""An expression, a matrix or a symbol in LaTeX, in which no name is obeyed.

    Examples
    --------
    >>> latex_of(sp.Symbol("phi") / 2), latex_of(sp.Symbol("\\input{b}"))
    ('\\frac{\\phi}{2}', '\\backslash{}input{b}')
    """
    return latex_formula(sp.latex(value))
