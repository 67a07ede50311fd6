"""notebook pictures: solutions, Burgers vectors and plans as a notebook shows them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from geomtorsion import checks
from geomtorsion.geometry import DependencyGraph, notation
from geomtorsion.outgoing import number_text, size_text
from geomtorsion.pictures.development import draw_rolled_out
from geomtorsion.pictures.loops import draw_closure, draw_map
from geomtorsion.pictures.scene_plan import layers_picture
from geomtorsion.pictures.solutions import draw_solution
from geomtorsion.pictures.style import pictured

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from geomtorsion.loops import BurgersMap, BurgersVector, Development
    from geomtorsion.ode import Ensemble, Solution


def solution_html(found: Solution | Ensemble) -> str:
    """A solution, over time."""
    return pictured(str(found), lambda: draw_solution(found))


def burgers_html(b: BurgersVector) -> str:
    """The loop and its image, with the gap."""
    return pictured(_components(b), lambda: draw_closure(b))


def _components(b: BurgersVector) -> str:
    """One component a line, with the error of all and the check."""
    lines = [f"b{i} = {number_text(x, b.error)}" for i, x in enumerate(b.vector.tolist(), 1)]
    inside = [f"enclosed: {one}" for one in b.enclosed]
    route = f"error below {size_text(b.error)}; {b.reason}"
    return "\n".join([*lines, route, b.check.text, *inside])


def map_html(survey: BurgersMap) -> str:
    """The density of Burgers vectors."""
    return pictured(str(survey), lambda: draw_map(survey))


def development_html(turn: Development) -> str:
    """The loop and its rolled-out path, with the gap and the turned frame."""
    return pictured(str(turn), lambda: draw_rolled_out(turn))


def plan_html(plan: DependencyGraph) -> str:
    """Graph of the steps of a computation, and the steps in a table.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> plan_html(load("so3").frame.plan("metric")).count("<tr>")
    3
    """
    table = notation.html_table(
        ("step", "components", "products at most", "what it is"),
        [(step.name, step.components, step.products, step.meaning) for step in plan.steps],
        f"omitted: {', '.join(plan.left_out)}",
    )
    drawn = pictured(f"plan of {plan.name}", lambda: draw_plan(plan))
    return f"{drawn}<details open=''><summary>{len(plan.steps)} steps</summary>{table}</details>"


def draw_plan(plan: DependencyGraph) -> Figure:
    """A plan as a graph: each quantity below those that it needs.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> figure = draw_plan(load("so3").frame.plan("metric"))
    >>> [text.get_text() for text in figure.axes[0].texts if text.get_text()]
    ['coframe', 'metric']
    """
    checks.instance(plan, DependencyGraph, "plan")
    depth: dict[str, int] = {}
    for step in plan.steps:
        needed = [depth[name] for name in plan.graph.predecessors(step.name)]
        depth[step.name] = 1 + max(needed, default=0)
    layers = [
        [name for name, own in depth.items() if own == k] for k in range(1, max(depth.values()) + 1)
    ]
    return layers_picture(layers, plan.graph.edges)
