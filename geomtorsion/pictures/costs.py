"""costs: achieved error against time, of motions and of rules of quadrature."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

from geomtorsion.pictures.style import NOTHING, SERIES, captioned, new_figure, quiet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MARKS = "osD^vP"


class Row(Protocol):
    """One engine at one accuracy, as `accuracy_cost` measures it."""

    @property
    def engine(self) -> str:
        """Its name."""
        ...

    @property
    def asked(self) -> float:
        """Requested accuracy."""
        ...

    @property
    def achieved(self) -> float | None:
        """True error; None where there is no answer."""
        ...

    @property
    def seconds(self) -> float | None:
        """Time of the answer without its error estimate."""
        ...

    @property
    def total_seconds(self) -> float | None:
        """Time with the error estimate."""
        ...


class Table(Protocol):
    """Result of `accuracy_cost`."""

    @property
    def problem(self) -> str:
        """Name of the problem."""
        ...

    @property
    def t(self) -> float:
        """How far."""
        ...

    @property
    def truth(self) -> str:
        """Reference for the errors."""
        ...

    @property
    def rows(self) -> Sequence[Row]:
        """One per engine and accuracy."""
        ...


def work_precision_picture(table: Table) -> Figure:
    """Time upwards, accuracy to the right: lower and further right is better.

    Full lines: time with error estimate; thin lines: time of only the answer. A small bar leads
    from each mark to the requested accuracy.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    figure = new_figure(7.0, 5.0)
    axes: Axes = figure.add_subplot()
    names = list(dict.fromkeys(row.engine for row in table.rows))
    for name, stroke, mark in zip(names, SERIES * len(names), MARKS * len(names), strict=False):
        rows = [
            row for row in table.rows if row.engine == name and row.seconds and row.total_seconds
        ]
        if not rows:
            continue
        errors = [max(row.achieved or 0.0, NOTHING) for row in rows]
        total = [1e3 * (row.total_seconds or 0.0) for row in rows]
        alone = [1e3 * (row.seconds or 0.0) for row in rows]
        axes.plot(errors, total, **stroke.line, marker=mark, markersize=7, label=name)
        axes.plot(
            errors, alone, color=stroke.color, linewidth=0.8, linestyle=stroke.dashes, marker=mark,
            markersize=4, markerfacecolor="white", label=f"{name}, without error estimate",
        )  # fmt: skip
        asked = [row.asked for row in rows]
        axes.hlines(total, asked, errors, color=stroke.color, linewidth=0.8, alpha=0.45)
        axes.plot(asked, total, linestyle="", marker="|", color=stroke.color, alpha=0.6)
    axes.set_xscale("log")
    axes.set_yscale("log")
    # Better is further right, as in work-precision diagrams of the field.
    axes.invert_xaxis()
    axes.set_xlabel(f"error, relative, against {table.truth}")
    axes.set_ylabel("time in ms")
    axes.grid(axis="both", which="major")
    quiet(axes)
    if names:
        axes.legend(
            loc="lower center", bbox_to_anchor=(0.5, 1.01), ncols=2, frameon=False, fontsize=9,
            handlelength=3.6,
        )  # fmt: skip
    captioned(
        figure,
        [
            f"{table.problem}; to t = {table.t:g}.",
            "Bars extend to the requested accuracy; lower and further right is better.",
        ],
    )
    return figure


class RuleRow(Protocol):
    """Row of a figure: one rule with one number of points."""

    @property
    def rule(self) -> str:
        """Name of the rule."""
        ...

    @property
    def points(self) -> int:
        """Number of evaluations."""
        ...

    @property
    def error(self) -> float:
        """Measured relative error."""
        ...

    @property
    def seconds(self) -> float:
        """Wall time."""
        ...

    @property
    def asked(self) -> float | None:
        """Requested accuracy, where the rule is adaptive."""
        ...


class LoopCosts(Protocol):
    """Result of `geomtorsion.accuracy.loops.loop_costs`."""

    @property
    def name(self) -> str:
        """Which loop in which frame."""
        ...

    @property
    def rows(self) -> Sequence[RuleRow]:
        """Rule by rule, points rising."""
        ...


def draw_loop_costs(costs: LoopCosts) -> Figure:
    """Error against number of points and against time, one line for each rule.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    figure = new_figure(9.6, 4.4)
    left, right = figure.add_subplot(121), figure.add_subplot(122)
    for axes, what in ((left, "points"), (right, "milliseconds")):
        for number, rule in enumerate(dict.fromkeys(row.rule for row in costs.rows)):
            rows = [row for row in costs.rows if row.rule == rule]
            spent = [row.points if what == "points" else row.seconds * 1e3 for row in rows]
            errors = [max(row.error, NOTHING) for row in rows]
            stroke = SERIES[number % len(SERIES)]
            axes.loglog(spent, errors, marker=stroke.end, markersize=4, label=rule, **stroke.line)
        axes.set_xlabel(what)
        axes.set_ylabel("relative error" if axes is left else "")
        quiet(axes)
    right.legend(fontsize=8, frameon=False, handlelength=3.2)
    figure.suptitle(costs.name, fontsize=11)
    return figure
