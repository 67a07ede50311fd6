"""Loop costs: error of quadrature rules against points and against time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

from geomtorsion.pictures.style import SERIES, new_figure, quiet

# An error of zero still has a place in the picture.
LEAST_ERROR = 1e-17


class Row(Protocol):
    """What is drawn of one rule with one number of points."""

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
        """Accuracy asked for, where the rule is adaptive."""
        ...


class Costs(Protocol):
    """What `geomtorsion.accuracy.loops.loop_costs` gives."""

    @property
    def name(self) -> str:
        """Which loop in which frame."""
        ...

    @property
    def rows(self) -> Sequence[Row]:
        """Rule by rule, points rising."""
        ...


def draw_loop_costs(costs: Costs) -> Any:
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
            errors = [max(row.error, LEAST_ERROR) for row in rows]
            stroke = SERIES[number % len(SERIES)]
            axes.loglog(spent, errors, marker=stroke.end, markersize=4, label=rule, **stroke.line)
        axes.set_xlabel(what)
        axes.set_ylabel("relative error" if axes is left else "")
        quiet(axes)
    right.legend(fontsize=8, frameon=False, handlelength=3.2)
    figure.suptitle(costs.name, fontsize=11)
    return figure
