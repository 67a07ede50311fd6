"""Exponential map and holonomy: end of an autoparallel, and a frame carried along a path."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from geomtorsion.curves.constructors import autoparallel, parallel_transport
from geomtorsion.curves.problem import CurveProblem, checked_parameters
from geomtorsion.errors import ChartEdgeError, ShapeError, StartError, StuckError, TimeError
from geomtorsion.geometry import Connection
from geomtorsion.geometry.connections import ConnectionLike, as_connection
from geomtorsion.ode.numbers import Numbers
from geomtorsion.ode.problem import ODE
from geomtorsion.ode.solve import solve
from geomtorsion.support import checks

if TYPE_CHECKING:
    from geomtorsion.ode.engines import Engine


def exponential_map(
    connection: ConnectionLike,
    start: Numbers,
    vector: Numbers,
    *,
    parameters: Mapping[Any, Any] | None = None,
    accuracy: float = 1e-10,
    engine: Engine | None = None,
) -> np.ndarray:
    """The point reached after unit time along the autoparallel with a given velocity.

    Parameters
    ----------
    connection
        whose autoparallels are followed: Cartan, Levi-Civita, ...
    start
        q^mu, shape (n,).
    vector
        frame components u^i of the initial velocity, shape (n,).
    parameters
        values of the parameters of the frame, by name.
    accuracy, engine
        as in `solve`.

    Returns
    -------
    Coordinates of the end, shape (n,).

    Examples
    --------
    >>> from geomtorsion.geometry import levi_civita
    >>> from geomtorsion.spaces import load
    >>> plane = levi_civita(load("flat_polar").frame)
    >>> [round(float(x), 9) for x in exponential_map(plane, [1, 0], [1, 0])]
    [2.0, 0.0]
    """
    problem = autoparallel(connection, start, frame_velocity=vector, parameters=parameters)
    return solve(problem, [1.0], accuracy, engine).coordinates[-1]


def holonomy(
    connection: ConnectionLike,
    path: CurveProblem | Sequence[Any],
    t: float = 1.0,
    *,
    parameters: Mapping[Any, Any] | None = None,
    accuracy: float = 1e-10,
    engine: Engine | None = None,
) -> np.ndarray:
    """Holonomy of a path: the matrix of parallel transport, in frame components.

    Parameters
    ----------
    connection
        the connection of the transport.
    path
        a motion, followed up to t; or expressions q^mu(s) as a list of sympy expressions in one
        symbol s, followed from s = 0 to s = t.
    t
        end of the path.
    parameters
        values of the parameters of the frame, by name, for a path of expressions; a motion has its
        own.
    accuracy, engine
        as in `solve`.

    Returns
    -------
    H[k, j], shape (n, n): a vector with frame components w^j at the start arrives as H w.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import levi_civita
    >>> from geomtorsion.spaces import load
    >>> s = sp.Symbol("s")
    >>> sphere = levi_civita(load("s2").frame)
    >>> circle = [sp.pi / 3, 2 * sp.pi * s]
    >>> (holonomy(sphere, circle, parameters={"R": 1}).round(6) + 0.0).tolist()
    [[-1.0, 0.0], [0.0, -1.0]]
    """
    connection = as_connection(connection)
    n = connection.frame.dimension
    end = checks.number(t, "t", TimeError)
    unit = np.eye(n).tolist()
    if isinstance(path, CurveProblem):
        carried = parallel_transport(path, unit, connection)
        return solve(carried, [end], accuracy, engine).transported[-1].reshape(n, n).T
    kind = "a curve or a list of expressions"
    expressions = checks.entries(path, "path", ShapeError, expected=kind)
    values = checks.table(parameters, "parameters")
    return transport_along(connection, expressions, end, values, accuracy, engine)


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
            f"the path leaves the chart at {problem.time_name} = {reached:.6g} ({reason}). Move "
            "the path inside the domain of the frame."
        ) from None


def transport_equations(
    connection: Connection, path: Sequence[object], numbers: Mapping[str, object]
) -> ODE:
    """w'^k = - omega_ai^k(q(s)) q'^a(s) w^i for all frame vectors at once; s is the time."""
    frame = connection.frame
    n = frame.dimension
    checks.check_one_each(path, n, "coordinates", "path", ShapeError)
    curve = [
        _without_floats(checks.expression(x, f"path[{k}]", StartError)) for k, x in enumerate(path)
    ]
    free = {s for x in curve for s in x.free_symbols} - set(frame.parameters)
    if len(free) > 1:
        raise StartError(
            f"path: expected one symbol, got {', '.join(sorted(map(str, free)))}. Give q^mu(s) in "
            "one symbol s."
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
    needed, remedy = sorted(used - set(rates) - {s.name}), "Give parameters={'{missing}': ...}."
    checks.check_values(needed, numbers, "parameters", StartError, remedy)
    return ODE.of(
        rates,
        np.eye(n).ravel().tolist(),
        parameters={name: x for name, x in numbers.items() if name in used},
        time=s.name,
        norm_groups=[list(rates)],
        name="parallel transport",
    )


def _without_floats(expression: sp.Expr) -> sp.Expr:
    """Floats as exact fractions."""
    return expression.xreplace({x: sp.Rational(float(x)) for x in expression.atoms(sp.Float)})
