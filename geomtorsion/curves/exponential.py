"""Exponential map and holonomy: what an autoparallel and a path do to a point and a frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion import checks
from geomtorsion.curves.constructors import autoparallel, parallel_transport
from geomtorsion.curves.path_transport import transport_along
from geomtorsion.curves.problem import CurveProblem
from geomtorsion.errors import ShapeError, TimeError
from geomtorsion.geometry import Connection
from geomtorsion.ode.numbers import Numbers
from geomtorsion.ode.solve import solve

if TYPE_CHECKING:
    from geomtorsion.ode.engines import Engine


def exponential_map(
    connection: Connection,
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
    connection: Connection,
    path: CurveProblem | Sequence[Any],
    t: float = 1.0,
    *,
    parameters: Mapping[Any, Any] | None = None,
    accuracy: float = 1e-10,
    engine: Engine | None = None,
) -> np.ndarray:
    """The matrix by which parallel transport along a path turns the frame.

    Parameters
    ----------
    connection
        what parallel means.
    path
        a motion, followed up to t; or expressions q^mu(s) as a list of sympy expressions in one
        symbol s, followed from s = 0 to s = t.
    t
        end of the path.

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
    >>> holonomy(sphere, circle, parameters={"R": 1}).round(6).tolist()
    [[-1.0, 0.0], [-0.0, -1.0]]
    """
    n = checks.instance(connection, Connection, "connection").frame.dimension
    end = checks.number(t, "t", TimeError)
    unit = np.eye(n).tolist()
    if isinstance(path, CurveProblem):
        carried = parallel_transport(path, unit, connection)
        return solve(carried, [end], accuracy, engine).transported[-1].reshape(n, n).T
    needed = "{subject}: a curve or a list of expressions was needed, but {value} came."
    expressions = checks.entries(path, "path", ShapeError, message=needed)
    given = checks.table(parameters, "parameters")
    return transport_along(connection, expressions, end, given, accuracy, engine)
