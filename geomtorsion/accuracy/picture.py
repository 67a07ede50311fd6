"""Picture: time against error, log-log, one line per engine."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import MissingExtraError

if TYPE_CHECKING:
    from geomtorsion.accuracy.cost import CostTable


def work_precision(table: CostTable) -> Any:
    """A matplotlib figure: achieved error to the left, time upwards."""
    try:
        figure_module = import_module("matplotlib.figure")
    except ImportError:
        raise MissingExtraError(
            "pictures need matplotlib, which is not installed. "
            "Run `pip install geomtorsion[plots]`."
        ) from None
    figure = figure_module.Figure(figsize=(6.4, 4.2), layout="constrained")
    axes = figure.add_subplot()
    for name in dict.fromkeys(row.engine for row in table.rows):
        rows = [r for r in table.rows if r.engine == name and r.achieved and r.total_seconds]
        if not rows:
            continue
        errors = [row.achieved for row in rows]
        (line,) = axes.loglog(
            errors, [1e3 * (row.total_seconds or 0) for row in rows], "o-", label=name
        )
        alone = [1e3 * (row.seconds or 0) for row in rows]
        axes.loglog(errors, alone, ":", color=line.get_color(), linewidth=1)
    axes.invert_xaxis()
    axes.set_xlabel(f"achieved error (against {table.truth})")
    axes.set_ylabel("time in ms (dotted: without error estimate)")
    axes.set_title(f"{table.problem}, t = {table.t:g}", fontsize=10)
    axes.grid(True, which="major", linewidth=0.4)
    axes.legend(frameon=False)
    return figure
