"""Path transport: parallel transport along a path that is given, not solved for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp

from geomtorsion import checks
from geomtorsion.curves.start import checked_parameters
from geomtorsion.errors import ChartEdgeError, ShapeError, StartError, StuckError
from geomtorsion.ode.problem import ODE
from geomtorsion.ode.solve import solve

if TYPE_CHECKING:
    from geomtorsion.geometry import Connection
    from geomtorsion.ode.engines import Engine


def transport_along(
    connection: Connection,
    path: Sequence[object],
    t: float,
    parameters: Mapping[object, object],
    accuracy: float,
    engine: Engine | None,
) -> np.ndarray:
    """Frame components H[k, j] after transport of all frame vectors from s = 0 to s = t."""
    n = connection.frame.dimension
    problem = transport_equations(
        connection, path, checked_parameters(connection.frame, parameters)
    )
    try:
        return solve(problem, [float(t)], accuracy, engine).states[-1].reshape(n, n)
    except StuckError as stuck:
        reached, reason = 0.0, str(stuck)
        if stuck.solution is not None:
            trajectory = stuck.solution.trajectory
            reached, reason = trajectory.reached, trajectory.reason
        raise ChartEdgeError(
            f"the path leaves the chart at {problem.time_name} = {reached:.6g} ({reason}). "
            "Lay it inside the domain of the frame."
        ) from None


def transport_equations(
    connection: Connection, path: Sequence[object], numbers: Mapping[str, object]
) -> ODE:
    """w'^k = - omega_ai^k(q(s)) q'^a(s) w^i for all frame vectors at once; s is the time."""
    frame = connection.frame
    n = frame.dimension
    if len(path) != n:
        raise ShapeError(f"path: {n} expressions were needed, {len(path)} came.")
    curve = [
        _without_floats(checks.expression(x, f"path[{k}]", StartError)) for k, x in enumerate(path)
    ]
    free = {s for x in curve for s in x.free_symbols} - set(frame.parameters)
    if len(free) > 1:
        raise StartError(
            f"path: one symbol was needed, {', '.join(sorted(map(str, free)))} came. "
            "Give q^mu(s) in one symbol s."
        )
    s = free.pop() if free else sp.Symbol("s")
    speeds = [x.diff(s) for x in curve]
    places = dict(zip(frame.coordinates, curve, strict=True))
    states = [[sp.Symbol(f"carried{k}_{j}", real=True) for j in range(n)] for k in range(n)]
    rates = {symbol.name: sp.Integer(0) for row in states for symbol in row}
    for (a, i, k), value in connection.spin_connection.components.nonzero.items():
        if speeds[a] == 0:
            continue
        factor = -value.sympy.subs(places, simultaneous=True) * speeds[a]
        for j in range(n):
            rates[states[k][j].name] += factor * states[i][j]
    used = {x.name for rate in rates.values() for x in rate.free_symbols}
    missing = sorted(used - set(rates) - {s.name} - set(numbers))
    if missing:
        raise StartError(f"{', '.join(missing)} has no value. Give parameters={{...}}.")
    return ODE.of(
        rates,
        np.eye(n).ravel().tolist(),
        parameters={name: x for name, x in numbers.items() if name in used},
        time=s.name,
        norm_groups=[list(rates)],
        name="parallel transport",
    )


def _without_floats(expression: sp.Expr) -> sp.Expr:
    """Floats as the fractions that they are."""
    return expression.xreplace({x: sp.Rational(float(x)) for x in expression.atoms(sp.Float)})
