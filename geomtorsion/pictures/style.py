"""ink: colours, line styles, names and captions that all pictures share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import sympy as sp

from geomtorsion.errors import MissingExtraError
from geomtorsion.pictures.text import greek_name

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure

    from geomtorsion.pictures.pair import Pair

FAINT, PALE = "#c9ccd1", "#eef0f2"
FORMATS = ("png", "svg", "pdf")
RESOLUTION = 150


@dataclass(frozen=True)
class Stroke:
    """A line that is told from others by colour, and without colour by dashes and width."""

    color: str
    dashes: Any
    width: float = 1.8
    end: str = "s"

    @property
    def line(self) -> dict[str, Any]:
        """Keyword arguments of `Axes.plot`."""
        return {"color": self.color, "linestyle": self.dashes, "linewidth": self.width}


# The colours of Okabe and Ito, which people with any colour vision tell apart.
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
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtraError(
            "pictures need matplotlib, which is not installed. "
            "Run `pip install geomtorsion[plots]`; tables are written without it."
        ) from None
    return Figure(figsize=(width, height), layout="constrained", facecolor="white")


def save(figure: Figure, path: Path, dpi: int = RESOLUTION) -> None:
    """Write a figure in the format of its suffix, the same bytes each time."""
    import matplotlib as mpl

    blank = {"png": {"Software": None}, "svg": {"Date": None, "Creator": None}}
    kind = path.suffix.removeprefix(".")
    metadata = blank.get(kind, {"CreationDate": None, "Producer": None, "Creator": None})
    with mpl.rc_context({"svg.hashsalt": "geomtorsion"}):
        figure.savefig(path, dpi=dpi, metadata=metadata)


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


def caption(pair: Pair) -> list[str]:
    """Where the motions start, how, and how accurate they are: lines for below a picture."""
    problem = pair.problem
    names = problem.coordinates
    start = assigned(names, [float(x) for x in problem.start or ()])
    velocity = assigned(names, problem.velocity.tolist(), "′")
    parts = [f"Start {start}", f"velocity {velocity}"]
    if pair.parameters:
        parts.append(f"with {assigned(list(pair.parameters), list(pair.parameters.values()))}")
    asked = pair.straight.accuracy
    error = max(solution.error for solution in pair.curves.values())
    parts.append(f"accuracy {number(asked)} asked, error below {number(float(f'{error:.1e}'))}")
    ends = {curve: float(pair.curves[curve].times[-1]) for curve in pair.stops}
    stops = [f"The {curve} stopped at t = {number(end)}." for curve, end in ends.items()]
    return ["; ".join(parts) + ".", *stops]


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


def legend(figure: Figure, axes: Any, columns: int = 4) -> None:
    """The lines of some axes above all panels."""
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(
        handles, labels, loc="outside upper center", ncols=min(columns, len(labels)),
        frameon=False, fontsize=10, handlelength=3.2,
    )  # fmt: skip


def quiet(axes: Any) -> None:
    """A light grid and no box."""
    axes.grid(color=PALE, linewidth=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)


def clock(pair: Pair) -> str:
    """What the curve parameter is called on an axis: t, unless a coordinate has that name."""
    return "curve parameter" if "t" in pair.problem.coordinates else "$t$"
