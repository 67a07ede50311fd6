"""displays: hooks for the notebook display of a value; packages above register the drawing."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any

import sympy as sp

from geomtorsion.outgoing import latex_formula

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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
        return getattr(import_module(f"geomtorsion.pictures.{module}"), function)(self)

    drawn.__doc__ = "What a notebook shows."
    return drawn


def figure_by(module: str, function: str) -> Callable[..., Figure]:
    """A method `plot` that draws a value: a function of a module of pictures.

    It takes the other arguments of the function, by name. `pictures.save` writes the figure.

    Examples
    --------
    >>> from geomtorsion.loops import BurgersVector
    >>> BurgersVector.plot.__doc__.partition(":")[0]
    'Draw it as a matplotlib figure'
    """

    def plot(self: object, **options: object) -> Figure:
        return getattr(import_module(f"geomtorsion.pictures.{module}"), function)(self, **options)

    plot.__doc__ = f"Draw it as a matplotlib figure: `geomtorsion.pictures.{module}.{function}`."
    return plot


def latex_of(value: object) -> str:
    r"""An expression, a matrix or a symbol in LaTeX, in which no name is obeyed.

    Examples
    --------
    >>> latex_of(sp.Symbol("phi") / 2), latex_of(sp.Symbol("\\input{b}"))
    ('\\frac{\\phi}{2}', '\\backslash{}input{b}')
    """
    return latex_formula(sp.latex(value))
