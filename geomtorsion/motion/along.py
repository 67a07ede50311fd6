"""Along: transport along a path that is given, not solved for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import sympy as sp

from geomtorsion.checks import expression as expression_of
from geomtorsion.checks import shown
from geomtorsion.errors import AccuracyError, ChartEdgeError, ShapeError, StartError
from geomtorsion.exact import Field
from geomtorsion.motion.checking import CAUTION
from geomtorsion.motion.engines import RungeKutta, Taylor
from geomtorsion.motion.engines.taylor import is_available
from geomtorsion.motion.solving import MARGIN, checked_accuracy, tolerances
from geomtorsion.motion.start import checked_parameters
from geomtorsion.motion.system import System

if TYPE_CHECKING:
    import numpy as np

    from geomtorsion.geometry import Connection
    from geomtorsion.motion.engines import Engine


def transport_along(
    connection: Connection,
    path: Sequence[Any],
    t: float,
    parameters: Mapping[Any, Any],
    accuracy: float,
    engine: Engine | None,
) -> np.ndarray:
    """Frame components H[k, j] after transport of all legs from s = 0 to s = t."""
    import numpy as np

    accuracy = checked_accuracy(accuracy)
    numbers = checked_parameters(connection.frame, parameters)
    system = transport_system(connection, path)
    n = connection.frame.dimension
    start = [0.0, *np.eye(n).ravel()]
    missing = [name for name in system.parameters if name not in numbers]
    if missing:
        raise StartError(f"{', '.join(missing)} has no value. Give parameters={{...}}.")
    values = [numbers[name] for name in system.parameters]
    solver: Engine = engine or (Taylor() if is_available() else RungeKutta())
    before, gap = None, np.inf
    for tolerance in tolerances(accuracy * MARGIN, solver.finest):
        run = solver.run(system, start, values, np.array([0.0, float(t)]), tolerance)
        if run.outcome != "done":
            raise ChartEdgeError(
                f"the path leaves the chart at s = {float(run.reached):.6g} ({run.reason}). "
                "Lay it inside the domain of the frame."
            )
        matrix = np.asarray(run.states[-1][1:], dtype=float).reshape(n, n)
        if before is not None:
            gap = CAUTION * float(np.abs(matrix - before).max() / np.abs(matrix).max())
            if gap <= accuracy:
                return matrix
        before = matrix
    raise AccuracyError(
        f"accuracy {accuracy:.3g} was asked for; {solver.name} gets to {gap:.2g}. Ask for less."
    )


def transport_system(connection: Connection, path: Sequence[Any]) -> System:
    """w'^k = - omega_ai^k(q(s)) q'^a(s) w^i for all legs at once, s being a state."""
    frame = connection.frame
    n = frame.dimension
    if not isinstance(path, list | tuple) or len(path) != n:
        came = len(path) if isinstance(path, list | tuple) else shown(path)
        raise ShapeError(f"path: {n} expressions were needed, {came} came.")
    curve = [
        _without_floats(expression_of(x, f"path[{k}]", StartError)) for k, x in enumerate(path)
    ]
    free = {s for x in curve for s in x.free_symbols} - set(frame.parameters)
    if len(free) > 1:
        raise StartError(
            f"path: one symbol was needed, {', '.join(sorted(map(str, free)))} came. "
            "Give q^mu(s) in one symbol s."
        )
    s = free.pop() if free else sp.Symbol("s")
    omega = connection.spin_connection.components.nonzero
    speeds = [x.diff(s) for x in curve]
    places = dict(zip(frame.coordinates, curve, strict=True))
    entries = []
    for (a, i, k), value in omega.items():
        if speeds[a] != 0:
            rate = -value.sympy.subs(places, simultaneous=True) * speeds[a]
            entries.append(((i, k), rate))
    symbols = {x for _, rate in entries for x in rate.free_symbols} - {s}
    others = tuple(sorted(symbols, key=str))
    field = Field((s, *others))
    elements = field.read_all([("path", rate) for _, rate in entries])
    names = [f"carried{k}_{j}" for k in range(n) for j in range(n)]
    rates: list[list[Any]] = [[] for _ in names]
    for ((i, k), _), element in zip(entries, elements, strict=True):
        if not element.is_zero:
            for j in range(n):
                rates[k * n + j].append((element, (names[i * n + j],)))
    blocks = ((0,), tuple(range(1, n * n + 1)))
    return System(
        (s.name, *names),
        tuple(x.name for x in others),
        (((field.one, ()),), *map(tuple, rates)),
        blocks,
    )


def _without_floats(expression: sp.Expr) -> sp.Expr:
    """Floats as the fractions that they are."""
    return expression.xreplace({x: sp.Rational(float(x)) for x in expression.atoms(sp.Float)})
