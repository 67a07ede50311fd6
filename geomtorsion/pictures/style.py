"""style: colours, lines, sizes, names and captions that all pictures share."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from io import BytesIO, StringIO
from os import PathLike
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from geomtorsion.errors import FileFormatError, GeomtorsionError, MissingExtraError
from geomtorsion.pictures.text import greek_name
from geomtorsion.support import checks
from geomtorsion.support.files import written
from geomtorsion.support.outgoing import figure_text, html_text, terminal_text
from geomtorsion.support.precision import EPS, PRINTED

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d import Axes3D
    from numpy.typing import ArrayLike

# Two coordinates of a point in a figure.
Point = Sequence[float] | np.ndarray
FAINT, PALE = "#c9ccd1", "#eef0f2"
FORMATS = ("png", "svg", "pdf")
# A value below this share of the largest shows in none of seven digits: it needs no axis or panel.
FLAT = PRINTED
# Below the rounding of doubles: zero on a logarithmic scale.
NOTHING = EPS / 20


@dataclass(frozen=True)
class Style:
    """Sizes of pictures.

    resolution: dots per inch. elevation: of the eye above the horizon, degrees.
    meridians, parallels: of a globe. behind: opacity of lines behind it.
    box, row, column: width of a box in a graph, and inches from one to the next.
    stations: bodies shown along a path. sides: corners of circular shapes.
    turns: about the vertical, that are drawn on a globe. rate: frames of an animation per second.
    frames: the most that an animation has. rem: of a page, per inch of a picture.
    wide: ratio of largest to smallest value from which an axis is logarithmic.
    edges: of a network; more make a picture black.
    line, half, third: letters that fit into a row of a matrix, half of a page and a third of it.
    arrows: along the longer side of a map; more of them hide it. panel: height of a map, inches.
    broad: largest ratio of its sides. spanned: percent of its nodes that the colours span, because
    the few nodes in cores of lines would hide everything else.
    unfolded: components of a list before the rest is folded away. listed: the most in a notebook.
    samples: points of a smooth line. members: lines of an ensemble that are drawn.
    """

    resolution: int = 150
    elevation: float = 24.0
    meridians: int = 12
    parallels: int = 5
    behind: float = 0.32
    box: float = 2.0
    row: float = 0.62
    column: float = 2.9
    stations: int = 13
    sides: int = 32
    turns: float = 3.0
    rate: int = 25
    frames: int = 500
    rem: float = 5.4
    wide: float = 300.0
    edges: int = 5000
    line: int = 90
    half: int = 34
    third: int = 20
    unfolded: int = 40
    listed: int = 400
    samples: int = 601
    members: int = 60
    arrows: int = 22
    panel: float = 4.4
    broad: float = 2.2
    spanned: float = 99.0


STYLE = Style()


@dataclass(frozen=True)
class Stroke:
    """A line that differs from others in colour, and without colour in dashes and width."""

    color: str
    dashes: Any
    width: float = 1.8
    end: str = "s"

    @property
    def line(self) -> dict[str, Any]:
        """Keyword arguments of `Axes.plot`."""
        return {"color": self.color, "linestyle": self.dashes, "linewidth": self.width}


# The colours of Okabe and Ito, which differ for people with any colour vision.
STROKES: Mapping[str, Stroke] = {
    "autoparallel": Stroke("#0072B2", "-", 2.0, "s"),
    "geodesic": Stroke("#D55E00", (0, (5, 1.6)), 2.0, "^"),
}
SERIES = (
    Stroke("#0072B2", "-", 1.6, "s"),
    Stroke("#D55E00", (0, (5, 1.6)), 1.6, "^"),
    Stroke("#007a59", (0, (5, 1.5, 1, 1.5)), 1.6, "D"),
    Stroke("#222222", (0, (1, 1.4)), 1.6, "v"),
    Stroke("#b04a86", (0, (9, 2)), 1.6, "P"),
    Stroke("#8a6d00", (0, (3, 1, 1, 1, 1, 1)), 1.6, "X"),
)


def new_figure(width: float, height: float) -> Figure:
    """An empty figure that lays out itself, outside of any global state.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    try:
        # Only who draws needs the extra.
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtraError(
            "pictures need matplotlib, which is not installed. "
            "Run `pip install 'geomtorsion[plots]'`; tables are written without it."
        ) from None
    figure = Figure(figsize=(width, height), layout="constrained", facecolor="white")
    # A notebook that has not loaded pyplot would show the figure as text.
    vars(figure)["_repr_png_"] = partial(_png, figure)
    return figure


def _png(figure: Figure) -> bytes:
    """A figure as a notebook shows it."""
    _plain_texts(figure)
    data = BytesIO()
    figure.savefig(data, format="png", dpi=STYLE.resolution, metadata={"Software": None})
    return data.getvalue()


def can_draw() -> bool:
    """Whether matplotlib is installed."""
    return find_spec("matplotlib") is not None


def save(figure: Figure, path: str | PathLike[str], dpi: int = STYLE.resolution) -> None:
    """Write a figure in the format of its suffix, the same bytes each time.

    Raises
    ------
    FileFormatError
        matplotlib does not have the format of this suffix.
    ArgumentError
        figure is not a figure of matplotlib, or path not a path.
    """
    # An extra: without matplotlib this module can still be imported.
    import matplotlib as mpl
    from matplotlib.figure import Figure

    checks.instance(figure, Figure, "figure")
    path = checks.file_name(path)

    _plain_texts(figure)
    blank = {"png": {"Software": None}, "svg": {"Date": None, "Creator": None}}
    kind = path.suffix.removeprefix(".").lower()
    metadata = blank.get(kind, {"CreationDate": None, "Producer": None, "Creator": None})
    with mpl.rc_context({"svg.hashsalt": "geomtorsion"}):
        try:
            with written(path) as file:
                figure.savefig(file, dpi=dpi, metadata=metadata)
        except FileFormatError:
            raise
        except ValueError as error:
            raise FileFormatError(
                f"{path.name}: expected the name of a .png, .svg or .pdf file, got another "
                f"({error}). Change the suffix."
            ) from None


def _plain_texts(figure: Figure) -> None:
    """Show a text without mathematics unchanged, dollars included; no control characters.

    Titles and labels hold names and units from files, which matplotlib would set as mathematics.
    """
    # A caller with a figure has matplotlib.
    from matplotlib.mathtext import MathTextParser

    # An extra, as above.
    from matplotlib.text import Text

    for part in figure.findobj(Text):
        shown = terminal_text(part.get_text(), styled=False)
        if "$" in shown:
            try:
                MathTextParser("path").parse(shown)
            except ValueError:
                shown = figure_text(shown)
        if shown != part.get_text():
            part.set_text(shown)


def svg_text(figure: Figure, *, outlines: bool = True) -> str:
    """A figure as an SVG file, the same each time.

    outlines: letters are drawn as curves, the same in every viewer; otherwise they are text.
    """
    # A caller with a figure has matplotlib.
    import matplotlib as mpl

    _plain_texts(figure)
    data = StringIO()
    look: Any = {"svg.hashsalt": "geomtorsion", "svg.fonttype": "path" if outlines else "none"}
    with mpl.rc_context(look):
        figure.savefig(
            data, format="svg", metadata=dict.fromkeys(("Date", "Creator", "Type", "Format"))
        )
    return data.getvalue()


def pictured(text: str, draw: Callable[[], Figure]) -> str:
    """Text with a picture below it, or with the reason for its absence.

    Examples
    --------
    >>> def nothing():
    ...     raise GeomtorsionError("no <picture>")
    >>> pictured("a < b", nothing)
    '<div><pre>a &lt; b</pre><p>no &lt;picture&gt;</p></div>'
    """
    try:
        svg = svg_text(draw())
        # A figure inside a page has no file header.
        picture = f"<div>{svg[svg.index('<svg') :]}</div>"
    except GeomtorsionError as error:
        picture = f"<p>{html_text(str(error))}</p>"
    return f"<div><pre>{html_text(text)}</pre>{picture}</div>"


def mathematics(name: str) -> str:
    """The name of a coordinate as mathematics.

    Examples
    --------
    >>> mathematics("phi1"), mathematics("x_"), mathematics("v")
    ('$\\\\phi_{1}$', '$x$', '$v$')
    """
    return f"${sp.latex(sp.Symbol(name.rstrip('_')))}$"


def number(value: float) -> str:
    """A number for people: six digits at most, no trailing zeros, a true minus.

    Examples
    --------
    >>> number(-0.5), number(1e-12)
    ('−0.5', '1e−12')
    """
    return f"{value:.6g}".replace("e-0", "e-").replace("e+0", "e").replace("-", "−")


def assigned(names: Sequence[str], values: Sequence[float], mark: str = "") -> str:
    """names = values in one line that breaks only after commas, names in Greek."""
    return ", ".join(
        f"{greek_name(name)}{mark}\xa0=\xa0{number(value)}"
        for name, value in zip(names, values, strict=True)
    )


def captioned(figure: Figure, lines: Sequence[str]) -> None:
    """Set lines below everything else, wrapped to the width of the figure."""
    width, height = figure.get_size_inches()
    rows = [row for line in lines for row in wrap(line, int(width * 15.5))]
    share = (0.07 + 0.155 * len(rows)) / height
    # Our figures are all made with the engine that may be None in others.
    figure.get_layout_engine().set(rect=(0, share, 1, 1 - share))  # type: ignore[union-attr]
    figure.text(
        0.5, 0.06 / height, "\n".join(rows), ha="center", va="bottom", size=8.5, color="#444444",
        linespacing=1.3,
    )  # fmt: skip


def visible(values: ArrayLike) -> np.ndarray:
    """Sizes for a logarithmic scale: zeros are at its bottom.

    Examples
    --------
    >>> visible([0.0, -1e-12]).tolist() == [NOTHING, 1e-12]
    True
    """
    return np.maximum(np.abs(np.asarray(values, dtype=float)), NOTHING)


def plot_sizes(
    axes: Axes, places: ArrayLike, values: ArrayLike, stroke: Mapping[str, Any], label: str
) -> bool:
    """Plot sizes on a logarithmic axis; exact zeros are named in the legend, not drawn.

    Returns
    -------
    Whether a line was drawn.
    """
    sizes = np.abs(np.asarray(values, dtype=float))
    if not np.nan_to_num(sizes).any():
        axes.plot([], [], linestyle="none", label=f"{label}: exactly zero")
        return False
    axes.plot(np.asarray(places)[: len(sizes)], visible(sizes), **stroke, label=label)
    return True


def arrow(axes: Axes, start: Point, end: Point, color: str, width: float = 1.5) -> None:
    """An arrow from one point to another, its head as large as its line is wide."""
    look = {"arrowstyle": "-|>", "color": color, "linewidth": width, "shrinkA": 0, "shrinkB": 0}
    look["mutation_scale"] = 12 + 2 * width
    axes.annotate("", xy=(end[0], end[1]), xytext=(start[0], start[1]), arrowprops=look, zorder=5)


def sense(axes: Axes, points: np.ndarray, color: str) -> None:
    """An arrow head on a curve in a plane, shape (2, m), a sixth of the way along it."""
    k = points.shape[1] // 6
    arrow(axes, points[:, k], points[:, k + 1], color)


def space_box(axes: Axes3D, labels: Sequence[str], low: np.ndarray, high: np.ndarray) -> None:
    """Axes in space with few numbers, level names and no walls, around the curves."""
    # A caller with axes has matplotlib.
    from matplotlib.ticker import MaxNLocator

    names = (axes.set_xlabel, axes.set_ylabel, axes.set_zlabel)
    limits = (axes.set_xlim, axes.set_ylim, axes.set_zlim)
    sides = (axes.xaxis, axes.yaxis, axes.zaxis)
    centre, half = (low + high) / 2, 0.54 * (high - low)
    for k, (side, name, limit) in enumerate(zip(sides, names, limits, strict=True)):
        side.set_rotate_label(False)
        name(labels[k], labelpad=11 if k == 2 else 8, rotation=0)
        side.set_pane_color((1, 1, 1, 0))
        side.set_major_locator(MaxNLocator(4))
        side._axinfo["grid"]["color"] = "#e3e5e8"
        limit(centre[k] - half[k], centre[k] + half[k])
    axes.tick_params(labelsize=8, pad=1)


def ends(axes: Axes | Axes3D, points: np.ndarray, stroke: Stroke) -> None:
    """A dot at the start, the stroke's own mark at the end."""
    look: dict[str, object] = {"edgecolors": "white", "linewidths": 0.8, "zorder": 6}
    if points.shape[1] == 3:
        look["depthshade"] = False
    axes.scatter(*points[-1], marker=stroke.end, s=46, color=stroke.color, **look)
    axes.scatter(*points[0], marker="o", s=40, color="#222222", **look)


def legend(figure: Figure, axes: Axes | Axes3D, columns: int = 4) -> None:
    """The lines of some axes above all panels."""
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(
        handles, labels, loc="outside upper center", ncols=min(columns, len(labels)),
        frameon=False, fontsize=10, handlelength=3.2,
    )  # fmt: skip


def quiet(axes: Axes | Axes3D) -> None:
    """A light grid and no box."""
    axes.grid(color=PALE, linewidth=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
