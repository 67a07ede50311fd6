"""Constructors: one function for each kind of curve."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp

from geomtorsion.codegen import rational
from geomtorsion.curves.atlas import Atlas, atlas_of
from geomtorsion.curves.atlas_check import check_atlas
from geomtorsion.curves.equations import (
    Autoparallel,
    CartanAutoparallel,
    Geodesic,
    Law,
    velocity_names,
)
from geomtorsion.curves.forces import Forced, forced
from geomtorsion.curves.problem import (
    CurveProblem,
    check_causal,
    checked_parameters,
    checked_start,
    frame_velocities,
)
from geomtorsion.curves.stops import Stops, read_stops
from geomtorsion.curves.transported import Deviation, TransportedVectors
from geomtorsion.errors import MetricError, ShapeError, StartError
from geomtorsion.exact.reading import checked
from geomtorsion.geometry import Connection, Frame, levi_civita
from geomtorsion.geometry.components import determinant
from geomtorsion.geometry.connections import (
    ConnectionLike,
    FrameLike,
    as_connection,
    frame_of,
)
from geomtorsion.geometry.derived import derived
from geomtorsion.geometry.homes import over_frame
from geomtorsion.ode.numbers import Numbers, Real, checked_numbers, floats
from geomtorsion.support import arguments, checks
from geomtorsion.support.hints import argument_hints
from geomtorsion.support.precision import CALCULATED


@argument_hints(q0="start", v0="velocity", x0="start")
def autoparallel(
    connection: ConnectionLike,
    start: Numbers | Mapping[Any, Real] | None = None,
    velocity: Numbers | Mapping[Any, Real] | None = None,
    *,
    frame_velocity: Numbers | Mapping[Any, Real] | None = None,
    parameters: Mapping[Any, Any] | None = None,
    causal: str | None = None,
    atlas: Atlas | None = None,
    stop: Stops | None = None,
    force: arguments.Forces | None = None,
    potential: arguments.Entry | None = None,
) -> CurveProblem:
    """Autoparallel, or straightest line: its velocity is parallel-transported along itself.

    Equation
    --------
    q''^m + Gamma_ab^m q'^a q'^b = F^m, solved as q'^mu = E_i^mu u^i,
    u'^k = -omega_ij^k u^i u^j + F^k

    Parameters
    ----------
    connection
        any connection; for the Cartan connection u is constant. A space, or the name of a shipped
        one, contributes its own connection, or the Cartan connection if it has none.
    start
        q^mu, shape (n,), or {"r": 1, "theta": 0}; None on a Lie group where only u is needed.
    velocity, frame_velocity
        q'^mu, or u^i = e^i_mu q'^mu, shape (n,): exactly one of them; by name {"r": 0, "theta": 1}
        or {"u1": 1, "u2": 0}.
    parameters
        values of the parameters of the frame, by name.
    causal
        "timelike", "null" or "spacelike", if that is to be checked.
    atlas
        charts of the space; None: the charts that the frame has. A given atlas is checked: its maps
        must be inverse to each other and pull back the metric (and the frame, where charts keep
        it).
    stop
        an expression over coordinates, frame velocities u1, u2, ... and parameters (text, sympy or
        `When`), or a list of them: the curve ends where one of them falls through zero, and
        `Solution.stopped_by` names it. The curve is followed only in charts whose maps give the
        terms of the expression without jumps.
    force
        F_k in the frame, n functions (expressions or text) of the coordinates, of the velocities
        u1, u2, ... along the legs (u^i = e^i_mu q'^mu; in Cartesian coordinates u1 = x'), of the
        curve parameter t and of parameters: drag ["-k*u1", "-k*u2"], a magnetic field
        ["B*u2", "-B*u1"], ["cos(w*t)", 0]. F_k u^k is the power where g(v, v)/2 is the kinetic
        energy. Zero if not given. Under constraints only the parts along the permitted legs act.
        Several forces have names: {"push": [...], "drag": [...]}. Where t is a coordinate, the
        curve parameter is tau. A name that the frame does not have is a parameter if `parameters`
        has its value.
    potential
        V, a function of the coordinates, t and parameters, which adds F_k = -E_k^mu dV/dq^mu;
        several have names: {"sun": "-1/r", "flattening": "J/r**3"}. Piecewise forces and
        potentials, and tables, need `CurveProblem.to_ode`.

    Raises
    ------
    StartError
        the start is singular, not finite, or incomplete, or the constraints of the connection
        forbid its velocity.
    ExpressionError
        `stop` cannot be read.
    ShapeError
        a list does not have one number per coordinate.
    ArgumentError
        two forces have one name.
    CoordinateError
        a map of the atlas is wrong, or a value contradicts the declaration of a parameter.

    Examples
    --------
    >>> from geomtorsion.geometry import cartan
    >>> from geomtorsion.spaces import load
    >>> p = autoparallel(cartan(load("flat_polar").frame), [1.0, 0.0], [1.0, 0.5])
    >>> print(p.text)
    r' = (1)*u1
    phi' = (1/r)*u2
    u1' = 0
    u2' = 0

    The same curve up to r = 3:

    >>> from geomtorsion.ode import solve
    >>> p = autoparallel(cartan(load("flat_polar").frame), [1.0, 0.0], [1.0, 0.5], stop="3 - r")
    >>> solution = solve(p, 5.0)
    >>> solution.outcome, solution.stopped_by, round(float(solution.times[-1]), 9)
    ('stopped', '3 - r', 2.0)
    """
    connection = as_connection(connection)
    law: Law = Autoparallel(connection)
    if connection.kind == "cartan":
        law = CartanAutoparallel()
    elif connection.kind == "levi-civita":
        law = Geodesic()
    names = checks.by_name(parameters, "parameters", StartError)
    law = forced(law, connection, force, potential, names)
    problem = _posed(
        "autoparallel", connection.frame, law, start, velocity, frame_velocity, parameters, causal,
        atlas, stop,
    )  # fmt: skip
    _check_permitted(connection, problem)
    return problem


@argument_hints(q0="start", v0="velocity", x0="start")
def geodesic(
    space: FrameLike | Connection,
    start: Numbers | Mapping[Any, Real] | None = None,
    velocity: Numbers | Mapping[Any, Real] | None = None,
    *,
    frame_velocity: Numbers | Mapping[Any, Real] | None = None,
    metric: Any = None,
    parameters: Mapping[Any, Any] | None = None,
    causal: str | None = None,
    atlas: Atlas | None = None,
    stop: Stops | None = None,
    force: arguments.Forces | None = None,
    potential: arguments.Entry | None = None,
) -> CurveProblem:
    """Geodesic of the metric of the frame, or of a kinetic metric G_ij e^i e^j.

    Equation
    --------
    G_kl u'^l = C_kj^i u^j G_im u^m + F_k           [FizievKleinert1994], eq. (1), (2)

    Parameters
    ----------
    space
        a frame, a space or the name of a shipped one; a connection contributes only its frame.
    start, velocity, frame_velocity, parameters, causal, atlas, stop, force, potential
        as in `autoparallel`; F_k u^k is the power where G_ij u^i u^j / 2 is the kinetic energy.
    metric
        kinetic metric in the frame, constant: n moments I_i, or a symmetric n x n matrix, of
        numbers or exact constants such as sqrt(2); None takes eta.

    Raises
    ------
    MetricError
        the kinetic metric is not symmetric or not regular.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> top = geodesic(load("so3").frame, frame_velocity=[1, 2, 3], metric=[1, 2, 3])
    >>> print(top.text)
    u1' = (-1)*u2*u3
    u2' = (1)*u1*u3
    u3' = (-1/3)*u1*u2

    The same top with friction:

    >>> damped = geodesic(load("so3").frame, frame_velocity=[1, 2, 3], metric=[1, 2, 3],
    ...                   force=["-k*u1", "-k*u2", "-k*u3"], parameters={"k": 0.1})
    >>> print(damped.text)
    u1' = (-1)*u2*u3 + (-k*u1)
    u2' = (1)*u1*u3 + (-k*u2/2)
    u3' = (-1/3)*u1*u2 + (-k*u3/3)
    """
    frame = space if isinstance(space, Frame) else frame_of(space, "space")
    names = checks.by_name(parameters, "parameters", StartError)
    law = Geodesic(None if metric is None else kinetic_metric(metric, frame))
    law = forced(law, frame, force, potential, names)
    return _posed(
        "geodesic", frame, law, start, velocity, frame_velocity, parameters, causal, atlas, stop
    )


def parallel_transport(
    problem: CurveProblem, vectors: Any, connection: ConnectionLike | None = None
) -> CurveProblem:
    """A curve together with vectors that are parallel-transported along it.

    Equation
    --------
    w'^k = - omega_ij^k u^i w^j, all indices in the frame

    Parameters
    ----------
    problem
        the curve along which the vectors are transported.
    vectors
        frame components w^k at the start: shape (n,) or (number, n).
    connection
        the connection of the transport; the Levi-Civita connection of the frame if not given.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> p = geodesic(load("s2").frame, [1.0, 0.0], [0.0, 1.0], parameters={"R": 1})
    >>> parallel_transport(p, [1, 0]).carried.start
    (1, 0)
    """
    checks.instance(problem, CurveProblem, "problem")
    if connection is not None:
        connection = as_connection(connection)
    if problem.start is None:
        raise StartError(
            "parallel transport: expected a curve with coordinates, got one without. Give it a "
            "start."
        )
    n = problem.frame.dimension
    rows = checks.entries(vectors, "vector", ShapeError, expected="a list of numbers")
    nested = bool(rows) and isinstance(rows[0], list | tuple | np.ndarray)
    carried = tuple(checked_numbers(row, n, "vector") for row in (rows if nested else [rows]))
    metric_one = connection or levi_civita(problem.frame)
    carrier = over_frame(problem.frame, metric_one, "connection", ShapeError)
    return problem.carry(TransportedVectors(carrier, carried))


def geodesic_deviation(
    problem: CurveProblem, offset: Numbers, rate: Numbers | None = None
) -> CurveProblem:
    """A curve together with the deviation vector to a neighbouring curve.

    Parameters
    ----------
    problem
        an autoparallel or geodesic.
    offset
        xi^mu at the start, coordinates, shape (n,).
    rate
        change of the frame velocities u^i at the start, shape (n,); zero if not given. Both are in
        `Solution.transported`, shape (m, 2 n), in the units of the problem.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> p = geodesic(load("s2").frame, [1.0, 0.0], [0.0, 1.0], parameters={"R": 1})
    >>> geodesic_deviation(p, [0, 0], [1, 0]).carried.names()
    ('offset1', 'offset2', 'turn1', 'turn2')
    """
    n = checks.instance(problem, CurveProblem, "problem").frame.dimension
    if problem.start is None:
        raise StartError(
            "deviation: expected a problem with coordinates, got one without. Give it a start."
        )
    deviation = Deviation(
        checked_numbers(offset, n, "offset"),
        checked_numbers([0] * n if rate is None else rate, n, "rate"),
    )
    return problem.carry(deviation)


def kinetic_metric(metric: Any, frame: Frame) -> tuple[tuple[Fraction | sp.Expr, ...], ...]:
    """Moments or a matrix as exact numbers; symmetric and regular.

    A root or pi is kept as it is.
    """
    n = frame.dimension
    kind = "moments or a matrix of numbers"
    rows = checks.entries(metric, "metric", ShapeError, expected=kind)
    if not any(isinstance(row, list | tuple | np.ndarray) for row in rows):
        moments = checked_numbers(rows, n, "metric (moments)")
        rows = [[x if i == j else 0 for j in range(n)] for i, x in enumerate(moments)]
    checks.check_one_each(rows, n, "rows", "metric", ShapeError)
    table = []
    for i, row in enumerate(rows):
        entries = checked_numbers(row, n, f"metric[{i}]")
        table.append(tuple(_constant(x, f"metric[{i}, {j}]") for j, x in enumerate(entries)))
    read = frame.field.read
    for i in range(n):
        for j in range(i):
            if not (read(table[i][j]) - read(table[j][i])).is_zero:
                raise MetricError(
                    f"the kinetic metric is not symmetric: [{i}, {j}] is {table[i][j]}, "
                    f"[{j}, {i}] is {table[j][i]}. Make them equal."
                )
    entries = {(i, j): read(x) for i, row in enumerate(table) for j, x in enumerate(row) if x != 0}
    if determinant(frame.field, entries, n).is_zero:
        raise MetricError("the kinetic metric is singular. Give moments that do not vanish.")
    return tuple(table)


def _constant(value: Any, subject: str) -> Fraction | sp.Expr:
    """A number as a fraction, or an exact constant such as sqrt(2)."""
    number = rational(value)
    return checked(subject, value) if number is None else Fraction(number)


def _check_permitted(connection: Connection, problem: CurveProblem) -> None:
    """Refuse a start whose velocity the constraints forbid."""
    if connection.allowed is None:
        return
    speeds = np.array(floats(problem.frame_velocity))
    permitted = np.isin(np.arange(len(speeds)), connection.allowed)
    forbidden = np.abs(speeds[~permitted]).max(initial=0.0)
    if forbidden > CALCULATED * np.abs(speeds).max():
        nearest = np.where(permitted, speeds, 0.0).tolist()
        raise StartError(
            "expected a velocity that the constraints permit, got one with a part of "
            f"{forbidden:.3g} along the forbidden legs. The closest permitted one is "
            f"frame_velocity={[float(f'{x:.6g}') for x in nearest]}."
        )


def _posed(
    name: str,
    frame: Frame,
    law: Law,
    start: Any,
    velocity: Any,
    frame_velocity: Any,
    parameters: Any,
    causal: str | None,
    atlas: Atlas | None,
    stop: object,
) -> CurveProblem:
    """A problem from checked input."""
    if frame.complex:
        raise StartError(
            f"expected a real frame, got {frame.name or 'a frame'}, which is complex (a null "
            "tetrad). Take a real one of the same metric: "
            "gt.Frame.from_metric(frame.coordinates, frame.metric.to_sympy())."
        )
    if atlas is not None:
        checks.instance(atlas, Atlas, "atlas")
        if frame not in atlas.checked_for:
            check_atlas(frame, atlas)
            atlas.checked_for.add(frame)
    # A law may bring parameters of its own into the field (a blend, a spin connection).
    law.rates(frame, [f"u{k}" for k in range(frame.dimension)])
    more = law.parameters if isinstance(law, Forced) else ()
    numbers = checked_parameters(frame, parameters, more)
    place = None if start is None else checked_start(frame, start, numbers)
    speeds, rates = frame_velocities(frame, place, velocity, frame_velocity, numbers)
    check_causal(frame, speeds, causal)
    written: dict[tuple[str, ...], Any] = {} if atlas else _written(frame, law_key(law))
    names = () if place is None else [symbol.name for symbol in frame.coordinates]
    stops = () if stop is None else read_stops(stop, names, velocity_names(frame), numbers)
    problem = CurveProblem(
        name, frame, law, place, speeds, numbers, atlas or atlas_of(frame), None, rates, stops,
        written,
    )  # fmt: skip
    problem.check_parameters(problem.charts[0])
    return problem


@derived
def _written(frame: Frame, key: str) -> dict[tuple[str, ...], Any]:
    """The equations of a law by charts, filled as they are written; key: see law_key."""
    return {}


def law_key(law: Law) -> str:
    """Key that two laws share exactly when they have the same equations."""
    if isinstance(law, Autoparallel):
        # The law holds its connection, so that this number stays its own.
        return f"equations of {id(law.connection)}"
    if isinstance(law, Forced):
        return f"{law_key(law.law)} with {law.content} {law.clock}"
    return f"equations of {law}"
