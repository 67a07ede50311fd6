"""Many: lanes of equal motions through one batch integrator or one stacked system."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import GeomtorsionError, StartError
from geomtorsion.motion.engines import Engine, Taylor
from geomtorsion.motion.engines.scipy_run import error_scales
from geomtorsion.motion.equations import Equations
from geomtorsion.motion.groups import Show, groups, run_group
from geomtorsion.motion.problem import Problem
from geomtorsion.motion.reading import converted
from geomtorsion.motion.system import System

if TYPE_CHECKING:
    import numpy as np

# States in one stacked Runge-Kutta system: larger ones leave the cache and set BLAS threads off.
STACKED = 6144


@dataclass(frozen=True, eq=False)
class Lanes:
    """Starts of many motions in one chart.

    velocities: in units of speeds, shape (number, n); states: shape (number, size).
    parameters: shape (number, parameters); speeds: powers of two, shape (number,).
    place, own_velocities: the same starts in the home chart; place None: velocities alone.
    """

    problem: Problem
    chart: str
    equations: Equations
    velocities: np.ndarray
    states: np.ndarray
    parameters: np.ndarray
    speeds: np.ndarray
    place: np.ndarray | None
    own_velocities: np.ndarray

    @classmethod
    def laid_out(cls, problem: Problem, place: Any, velocities: Any) -> Lanes:
        """Starts in the home chart, moved to the chart of preference."""
        import numpy as np

        if problem.passengers is not None:
            raise StartError("batches carry no passengers; solve such problems one by one.")
        sizes = np.abs(velocities).max(axis=1)
        speeds = np.where(sizes > 0, 2.0 ** np.round(np.log2(np.where(sizes > 0, sizes, 1))), 1.0)
        scaled = velocities / speeds[:, None]
        chart = problem.charts[0] if place is not None else ""
        home = place, scaled
        if place is not None and chart != problem.atlas.home:
            place, scaled = converted(problem, problem.atlas.home, chart, place, scaled)
        equations = problem.equations(chart)
        parts = [part for part in (place, scaled if equations.moves else None) if part is not None]
        table: dict[str, Any] = dict(problem.parameters) | dict(equations.constants)
        if not equations.moves:
            table |= dict(zip(equations.velocities, scaled.T, strict=True))
        names = equations.system.parameters
        number = len(scaled)
        columns = [np.broadcast_to(np.asarray(table[x], dtype=float), number) for x in names]
        parameters = np.array(columns).T if columns else np.zeros((number, 0))
        states = np.concatenate(parts, axis=1)
        return cls(problem, chart, equations, scaled, states, parameters, speeds, *home)

    def only(self, index: Any) -> Lanes:
        """Some of the lanes."""
        return replace(
            self,
            velocities=self.velocities[index],
            states=self.states[index],
            parameters=self.parameters[index],
            speeds=self.speeds[index],
            place=None if self.place is None else self.place[index],
            own_velocities=self.own_velocities[index],
        )


def run_lanes(
    engine: Engine, lanes: Lanes, grid: Any, tolerance: float, show: Show, crossed: Any = None
) -> tuple[Any, Any, bool, float]:
    """States (number, times, size), which lanes finished, whether interrupted, compile time.

    crossed: shape (number,), set to True for lanes that come to the edge of their chart on the
    way, whether at a sample or between samples; what they give is of no use. None: not watched.
    """
    import numpy as np

    number = len(lanes.states)
    result = np.zeros((number, len(grid), lanes.equations.system.size))
    finished = np.zeros(number, dtype=bool)
    compiling, interrupted = 0.0, False
    system = lanes.equations.system.without_edge if crossed is None else _watched(lanes)
    if system.edge is None:
        crossed = None
    try:
        if isinstance(engine, Taylor):
            compiling, interrupted = _by_groups(
                engine, lanes, system, grid, tolerance, result, finished, show, crossed
            )
            if interrupted:
                raise KeyboardInterrupt
        else:
            share = max(1, STACKED // lanes.equations.system.size)
            for first in range(0, number, share):
                part = slice(first, min(first + share, number))
                _stacked(lanes, part, grid, tolerance, result, finished, crossed)
                if show is not None:
                    show(part.stop)
        for k in np.flatnonzero(~finished):
            if crossed is None:
                _alone(engine, lanes, int(k), grid, tolerance, result, finished)
    except KeyboardInterrupt:
        interrupted = True
    if crossed is not None:
        edges = _edges(system, np.moveaxis(result, 2, 0), lanes.parameters.T[:, :, None])
        crossed |= finished & (np.broadcast_to(edges, result.shape[:2]) < 0).any(axis=1)
    result[~finished] = 0.0
    return result, finished, interrupted, compiling


def _watched(lanes: Lanes) -> System:
    """The equations with the edge to watch: the margin, or the very end of the only chart."""
    system = lanes.equations.system
    return system if len(lanes.problem.charts) > 1 else system.to_the_end


def _edges(system: System, states: Any, parameters: Any) -> Any:
    """The edge function on arrays; not a number where there is none."""
    import numpy as np

    with np.errstate(all="ignore"):
        return system.edge_values(states, list(parameters))


def _by_groups(
    engine: Taylor,
    lanes: Lanes,
    system: System,
    grid: Any,
    tolerance: float,
    result: Any,
    finished: Any,
    show: Show,
    crossed: Any,
) -> tuple[float, bool]:
    """All lanes by heyoka; compile time, and whether it was interrupted."""
    import numpy as np

    pace = np.abs(lanes.velocities * lanes.speeds[:, None]).sum(axis=1)
    compiling, before = 0.0, 0
    for group in groups(lanes.equations, system, lanes.states, lanes.parameters, lanes.speeds):
        found = run_group(engine, group, pace[group.index], grid, tolerance, show, before)
        index = group.index
        result[index], finished[index] = found.states, found.finished
        if crossed is not None:
            crossed[index] |= found.crossed
        compiling, before = compiling + found.compile_seconds, before + len(index)
        if found.interrupted:
            return compiling, True
    return compiling, False


def _stacked(
    lanes: Lanes,
    part: slice,
    grid: Any,
    tolerance: float,
    result: Any,
    finished: Any,
    crossed: Any = None,
) -> None:
    """Some lanes as one system of scipy's DOP853; time in units of the fastest."""
    import numpy as np
    from scipy.integrate import solve_ivp

    y0 = lanes.states[part].T
    size, count = y0.shape
    speeds = lanes.speeds[part]
    top = float(speeds.max())
    slow = speeds / top
    parameters = list(lanes.parameters[part].T)
    function = lanes.equations.system.array_rates

    def rates(_: float, y: Any) -> Any:
        found = function(*y.reshape(size, count), *parameters)
        out = np.empty((size, count))
        for row, value in enumerate(found):
            out[row] = value
        out *= slow
        return out.ravel()

    def looked(_: float, y: Any) -> float:
        # scipy calls this after each step; it is never told of an event.
        edges = _edges(system, y.reshape(size, count), parameters)
        crossed[part] |= np.broadcast_to(edges, count) < 0
        return 1.0

    system = _watched(lanes) if crossed is not None else lanes.equations.system
    with np.errstate(all="ignore"):
        first = rates(0.0, y0.ravel()).reshape(size, count)
        if not np.isfinite(first).all():
            return
        duration = float(grid[-1]) * top
        scales = error_scales(lanes.equations.system, y0, first, duration)
        found = solve_ivp(
            rates,
            (0.0, duration),
            y0.ravel(),
            "DOP853",
            t_eval=grid * top,
            rtol=max(tolerance, 2.3e-14),
            atol=(max(tolerance, 2.3e-14) * scales).ravel(),
            events=looked if crossed is not None else None,
        )
    if found.status == 0 and np.isfinite(found.y).all():
        result[part] = found.y.reshape(size, count, len(grid)).transpose(1, 2, 0)
        finished[part] = True


def _alone(
    engine: Engine, lanes: Lanes, k: int, grid: Any, tolerance: float, result: Any, finished: Any
) -> None:
    """One lane by itself, after the batch in which it was got stuck."""
    system = lanes.equations.system.without_edge
    try:
        run = engine.run(
            system, lanes.states[k], lanes.parameters[k], grid * lanes.speeds[k], tolerance
        )
    except GeomtorsionError:
        return
    if run.outcome == "done":
        result[k] = run.states
        finished[k] = True
