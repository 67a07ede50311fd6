"""orbits: a proved closed orbit, and the box in which it is the only one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.errors import ArgumentError
from geomtorsion.pictures.style import STYLE, captioned, mathematics, new_figure, quiet
from geomtorsion.proofs import ClosedOrbit
from geomtorsion.support import checks

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw_closed_orbit(found: ClosedOrbit) -> Figure:
    """Draw an orbit in its first two states, and the box around its start.

    The second panel is drawn in units of the half sides of the box. The ball of the start is there
    where the box is wide enough, otherwise a point.

    Raises
    ------
    ArgumentError
        found is not a ClosedOrbit.
    MissingExtraError
        matplotlib is not installed.

    Examples
    --------
    >>> from geomtorsion.ode import ODE
    >>> from geomtorsion.proofs import closed_orbit
    >>> spring = ODE.of({"x": "v", "v": "-x"}, [1, 0], invariants={"E": "x**2 + v**2"})
    >>> orbit = closed_orbit(spring, 6, section="v", conserved=["E"])
    >>> [axes.get_xlabel() for axes in draw_closed_orbit(orbit).axes]
    ['$x$', '($x$ - middle) / 5.8e-11']
    """
    if not isinstance(found, ClosedOrbit):
        raise ArgumentError(f"found: expected a ClosedOrbit, got {checks.shown(found)}.")
    solution = found.solution
    one, two = (*found.start, "t")[:2]
    figure = new_figure(8.4, 4.2)
    path, near = figure.subplots(1, 2)
    times = np.linspace(0, solution.times[-1], STYLE.samples)
    moment = solution.at(times)
    across, up = moment[one], times if two == "t" else moment[two]
    path.plot(across, up)
    path.plot(across[:1], up[:1], "o")
    path.set_xlabel(mathematics(one))
    path.set_ylabel(mathematics(two))
    # The box has a side for each unknown start, and for the period.
    sides = {**found.box, "period": found.period_box}
    balls = {**found.start, "period": found.period}
    first, second = list(sides)[:2]
    radii = [float(sides[name].rad()) for name in (first, second)]
    widths = [float(balls[name].rad()) / r for name, r in zip((first, second), radii, strict=True)]
    offs = [
        float(balls[name].mid() - sides[name].mid()) / r
        for name, r in zip((first, second), radii, strict=True)
    ]
    near.fill([-1, 1, 1, -1], [-1, -1, 1, 1], alpha=STYLE.behind, label="box")
    near.errorbar(offs[:1], offs[1:], xerr=widths[:1], yerr=widths[1:], fmt="o", label="ball")
    near.set_xlim(-1.5, 1.5)
    near.set_ylim(-1.5, 1.5)
    near.set_xlabel(f"({mathematics(first)} - middle) / {radii[0]:.2g}")
    near.set_ylabel(f"({mathematics(second)} - middle) / {radii[1]:.2g}")
    for axes in (path, near):
        quiet(axes)
    period = f"period {float(found.period.mid()):.10g}, {found.stability}"
    captioned(figure, [f"{period}: exactly one closed orbit starts in the box"])
    return figure
