"""plot: figures of the page, as svg elements that fit into its columns."""

from __future__ import annotations

from functools import cache
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from geomtorsion.pictures.style import Point, new_figure, quiet, svg_text
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.texts import ENGLISH, texts

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def save(language: str = ENGLISH) -> str:
    """Buttons that save the picture before them; the script of the page listens to them."""
    text = texts("figures", "figure", language)
    buttons = (
        f'<button type="button" class="copy" data-save="{kind}">{escape(text(kind))}</button>'
        for kind in ("svg", "png")
    )
    return f'<div class="save">{" ".join(buttons)}</div>'


@cache
def saving() -> str:
    """The script that saves pictures; turnable pictures also contain it."""
    return Path(__file__).with_name("save.js").read_text("utf-8")


def plane(
    title: str, labels: tuple[str, str], *, equal: bool = False, height: float = PAGE.height
) -> tuple[Figure, Axes]:
    """An empty figure with one pair of axes.

    labels: of the axes. equal: one unit is equally long on both axes. height: in inches.
    """
    figure = new_figure(PAGE.width, height)
    axes: Axes = figure.add_subplot()
    axes.set_title(title, fontsize=11)
    axes.set_xlabel(labels[0])
    axes.set_ylabel(labels[1])
    axes.margins(0.08)
    if equal:
        axes.set_aspect("equal", adjustable="datalim")
    quiet(axes)
    return figure, axes


def mark(axes: Axes, point: Point, color: str, shape: str, text: str = "") -> None:
    """A mark at a point, with a text next to it."""
    axes.plot(point[0], point[1], shape, color=color, markersize=7, markeredgecolor="white")
    beside(axes, point, color, text)


def beside(axes: Axes, point: Point, color: str, text: str) -> None:
    """A text next to a point."""
    axes.annotate(text, (point[0], point[1]), (6, 5), textcoords="offset points", color=color)


def key(figure: Figure, axes: Axes) -> None:
    """The legend of some axes, below them."""
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(
        handles, labels, loc="outside lower center", frameon=False, handlelength=3.6, fontsize=10
    )


def svg(figure: Figure, language: str = ENGLISH) -> str:
    """A figure as an svg element, named by its title, with buttons that save it."""
    text = svg_text(figure, outlines=False)
    title = escape(figure.axes[0].get_title())
    attributes = text[text.index("<svg") + len("<svg") :]
    return f'<svg class="plot" role="img" aria-label="{title}"{attributes}{save(language)}'
