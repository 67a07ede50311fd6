"""notebook pictures: solutions, Burgers vectors and plans as a notebook shows them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from geomtorsion.geometry import DependencyGraph, notation
from geomtorsion.pictures.development import draw_rolled_out
from geomtorsion.pictures.fits import draw_fit
from geomtorsion.pictures.loops import draw_closure, draw_loop, draw_map
from geomtorsion.pictures.scene_plan import layers_picture
from geomtorsion.pictures.solutions import draw_solution
from geomtorsion.pictures.style import pictured
from geomtorsion.support import checks
from geomtorsion.support.displays import values_text
from geomtorsion.support.outgoing import html_text, number_text, size_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from geomtorsion.fits import Fit
    from geomtorsion.loops import BurgersMap, BurgersVector, Development, Loop
    from geomtorsion.ode import Ensemble, Moment, Solution
    from geomtorsion.proofs import ClosedOrbit, Proof


def solution_html(found: Solution | Ensemble) -> str:
    """A solution, over time."""
    return pictured(str(found), lambda: draw_solution(found))


def fit_html(fit: Fit) -> str:
    """Values with errors, data and residuals."""
    return pictured(str(fit), lambda: draw_fit(fit))


def burgers_html(b: BurgersVector) -> str:
    """The loop and its image, with the gap."""
    return pictured(_components(b), lambda: draw_closure(b))


def _components(b: BurgersVector) -> str:
    """One component per line, with the error of all and the check."""
    lines = [f"b{i} = {number_text(x, b.error)}" for i, x in enumerate(b.vector.tolist(), 1)]
    inside = [f"enclosed: {one}" for one in b.enclosed]
    route = f"error below {size_text(b.error)}; {b.reason}"
    return "\n".join([*lines, route, b.check.text, *inside])


def loop_html(loop: Loop) -> str:
    """A loop in coordinates."""
    return pictured(str(loop), lambda: draw_loop(loop))


def proof_html(proof: Proof | ClosedOrbit) -> str:
    """Each value with its certain digits, and the last line: the error, or the stability.

    Examples
    --------
    >>> from geomtorsion.loops import Loop, burgers_vector
    >>> from geomtorsion.proofs import prove
    >>> proof_html(prove(burgers_vector("so3", Loop.circle([0.3, 1, 0.2], 0.1)))).count("<tr>")
    4
    """
    heading, *_, verdict = str(proof).splitlines()
    rows = [line.split(" = ", 1) for line in proof.lines()]
    table = notation.html_table(("value", "certain digits"), rows, verdict.strip())
    return f"<div><p>{html_text(heading)}</p>{table}</div>"


def moment_html(moment: Moment) -> str:
    """Each quantity of a motion by name: its value, or its values in the first and last row.

    Examples
    --------
    >>> from geomtorsion.curves import geodesic
    >>> from geomtorsion.ode import solve
    >>> moment = solve(geodesic("flat_polar", [1, 0], [1, 0.5]), 1.0).at(0.5)
    >>> moment_html(moment).count("<tr>")
    5
    """
    rows = [(name, values_text(moment[name])) for name in moment]
    below = f"at the time {values_text(moment.time)}"
    return f"<div>{notation.html_table(('name', 'value'), rows, below)}</div>"


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
