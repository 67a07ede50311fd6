"""Reduced: runs of a smaller system, momenta of cyclic coordinates being constants."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from geomtorsion.motion.engines.protocol import Engine, Run
from geomtorsion.motion.reduced.form import Opening, Reduction
from geomtorsion.motion.reduced.rates import best
from geomtorsion.motion.system import System

if TYPE_CHECKING:
    from geomtorsion.motion.equations import Equations

__all__ = ["Opening", "Reduction", "integrated", "reduction"]


def reduction(equations: Equations) -> Reduction | None:
    """The smaller system of equations, if one is found that is cheaper."""
    if not equations.moves:
        return None
    written = best(equations)
    return None if written is None else Reduction(equations.system, written)


def integrated(
    engine: Engine,
    equations: Equations,
    system: System,
    start: Sequence[Any],
    parameters: Sequence[Any],
    times: Any,
    tolerance: float,
    *,
    dense: bool = False,
) -> Run:
    """One run of equations from a full start, by their smaller system where it serves.

    system: that of the equations, or one of its variants without edge or margin.
    """
    smaller = equations.reduction
    opening = smaller.opened(engine, start, parameters) if smaller is not None else None
    if smaller is None or opening is None:
        return engine.run(system, start, parameters, times, tolerance, dense=dense)
    return _run(engine, smaller, opening, system, times, tolerance, dense)


def _run(
    engine: Engine,
    smaller: Reduction,
    opening: Opening,
    system: System,
    times: Any,
    tolerance: float,
    dense: bool,
) -> Run:
    import numpy as np

    small, bits = smaller.watching(system, opening.confined), engine.precision
    found = engine.run(small, opening.start, opening.values, times, tolerance, dense=dense)
    _, seconds = smaller.function(bits, opening.confined)

    def full(states: Any) -> Any:
        return smaller.widened(states, opening, bits)

    if found.outcome == "done":
        rows = full(found.states)
        last = rows[-1]
    else:
        rows = full(np.concatenate((found.states, np.asarray(found.last)[None, :])))
        rows, last = rows[:-1], rows[-1]
    inner = found.dense
    whole = None if inner is None else lambda t: full(np.asarray(inner(t)))
    compiling = found.compile_seconds + seconds
    return replace(found, states=rows, last=last, dense=whole, compile_seconds=compiling)
