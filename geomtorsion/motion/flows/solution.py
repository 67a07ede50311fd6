"""FlowSolution: a flow that was solved, with its error, its cost and everything read off it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import TimeError, UnknownNameError
from geomtorsion.exact.names import near_names
from geomtorsion.motion.checking import CAUTION
from geomtorsion.motion.flows import reading
from geomtorsion.motion.flows.travel import Recipe
from geomtorsion.motion.solution import Cost

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np

    from geomtorsion.motion.flows.flow import Flow
    from geomtorsion.motion.flows.travel import Trip


@dataclass(frozen=True, eq=False)
class FlowMoment(Mapping[str, Any]):
    """States and outputs at one time, or at several, by name.

    time: as asked; states: shape (..., size); outputs: output -> array (...) or (..., k).
    """

    time: Any
    names: tuple[str, ...]
    states: Any
    outputs: Mapping[str, Any]

    def __getitem__(self, name: str) -> Any:
        if name in self.names:
            return self.states[..., self.names.index(name)]
        if name in self.outputs:
            return self.outputs[name]
        raise UnknownNameError(unknown(name, self))

    def __iter__(self) -> Iterator[str]:
        return iter((*self.names, *self.outputs))

    def __len__(self) -> int:
        return len(self.names) + len(self.outputs)


@dataclass(frozen=True, eq=False)
class FlowSolution:
    """A solved flow.

    flow: what was solved.
    times: shape (m,), as asked for, or 65 of them up to the time asked for; where the motion was
        stopped they end there.
    states: shape (m, size), in the order of `flow.states`.
    accuracy: what was asked for, relative to the size of the solution.
    error: estimate of the largest error at `times`, each block of states against its own largest
        size.
    engine, why: what solved it, and why that was chosen.
    cost: steps, evaluations, seconds.
    outcome: "done"; "stopped" at the condition of the flow; "stuck" where it could not go on.
    recipe: how to make it again.
    made, against: the integration, and what gives the one that it was held against (see `trips`);
        None where it was loaded.
    share: the error is this many times their difference.

    Examples
    --------
    >>> from geomtorsion.motion import flow, solve
    >>> fall = flow({"z": "v", "v": "-g"}, {"z": 20, "v": 0}, parameters={"g": 10}, stop="z")
    >>> sol = solve(fall, 5.0)
    >>> sol.outcome, round(float(sol.times[-1]), 9), round(float(sol["v"][-1]), 9)
    ('stopped', 2.0, -20.0)
    """

    flow: Flow
    times: np.ndarray
    states: np.ndarray
    accuracy: float
    error: float
    engine: str
    why: str
    cost: Cost
    outcome: str
    reason: str
    recipe: Recipe
    made: Trip | None = None
    against: Callable[[], Trip] | None = None
    share: float = CAUTION
    _loaded: Mapping[str, Any] | None = None

    @cached_property
    def trip(self) -> Trip:
        """The integration, made again where it was loaded from a file."""
        return self.recipe.trip(self.flow) if self.made is None else self.made

    @cached_property
    def trips(self) -> tuple[Trip, ...]:
        """The integration and the one that it was held against; none where it was loaded."""
        return () if self.made is None or self.against is None else (self.made, self.against())

    @property
    def complete(self) -> bool:
        """Whether the motion was followed to its end: the last time, or where it stops."""
        return self.outcome in ("done", "stopped")

    # -- at the times ----------------------------------------------------------------------------

    def __getitem__(self, name: str) -> np.ndarray:
        """A state or an output by name, shape (m,) or (m, k)."""
        names = self.flow.states
        if name in names:
            return self.states[:, names.index(name)]
        if name in self.flow.outputs:
            return self._read[name]
        raise UnknownNameError(unknown(name, (*names, *self.flow.outputs)))

    @cached_property
    def _read(self) -> Mapping[str, Any]:
        if self._loaded is not None:
            return self._loaded
        return reading.outputs(self.flow, self.times, self.states)

    # -- between the times -----------------------------------------------------------------------

    def at(self, time: Any) -> FlowMoment:
        """States and outputs at any time up to the last; arrays of times are welcome.

        Between the times these are interpolated by the engine; `error` does not cover them. Series
        (Taylor) are as good in between; RungeKutta and Stiff may be worse.

        Raises
        ------
        TimeError
            a time lies outside of what was solved.
        """
        import numpy as np

        asked = np.asarray(time, dtype=float)
        flat = np.atleast_1d(asked).ravel()
        last = float(self.times[-1])
        low, high = min(0.0, last), max(0.0, last)
        bad = ~(np.isfinite(flat) & (flat >= low) & (flat <= high))
        if bad.any():
            raise TimeError(
                f"t = {flat[bad][0]:.6g} lies outside of the solution, which runs from 0 to "
                f"{last:.6g}. Solve to a later time, or ask within."
            )
        states = reading.dense_states(self, flat)
        values = reading.outputs(self.flow, flat, states)
        shaped = {
            name: value.reshape((*asked.shape, *value.shape[1:])) for name, value in values.items()
        }
        states = states.reshape((*asked.shape, states.shape[-1]))
        return FlowMoment(time, self.flow.states, states, shaped)

    def zeros(self, term: Any, direction: int = 0) -> np.ndarray:
        """All times at which a term crosses zero, in order.

        Crossings by a jump at a switch do not count, nor a zero at the very beginning or end.

        Parameters
        ----------
        term
            the name of an output, or an expression over states, parameters and the time.
        direction
            1: only upwards; -1: only downwards; 0: both.

        Raises
        ------
        ExpressionError, UnknownNameError
            the term cannot be read, is no single number, or has no finite value somewhere.

        Examples
        --------
        >>> from geomtorsion.motion import flow, solve
        >>> swing = solve(flow({"x": "v", "v": "-x"}, [1, 0]), 10.0)
        >>> swing.zeros("x").round(6).tolist()
        [1.570796, 4.712389, 7.853982]
        """
        from geomtorsion.motion.flows.zeros import zeros

        return zeros(self, term, direction)

    # -- how good it is --------------------------------------------------------------------------

    @cached_property
    def drift(self) -> Mapping[str, float]:
        """For each invariant its largest change, relative to the size of its terms.

        Across a switch it is counted anew: a push may change what nothing else does.
        """
        return reading.drifts(self)

    def __str__(self) -> str:
        ended = {"stopped": ", where it stops", "stuck": f", stuck: {self.reason}"}
        ending, last = ended.get(self.outcome, ""), float(self.times[-1])
        lines = [
            str(self.flow),
            f"to t = {last:.6g}{ending}, {len(self.times)} times, by {self.engine} ({self.why})",
            f"error below {self.error:.2g} (asked: {self.accuracy:.2g}); {self.cost}",
        ]
        drifts = ", ".join(f"{name} {value:.1e}" for name, value in self.drift.items())
        return "\n".join([*lines, f"drift: {drifts}"] if drifts else lines)

    def __repr__(self) -> str:
        return str(self)

    # -- taking it elsewhere ---------------------------------------------------------------------

    def to_pandas(self) -> Any:
        """A pandas table: times, states, outputs (components of vectors with their number).

        Raises
        ------
        MissingExtraError
            pandas is not installed.
        """
        from geomtorsion.motion.tables import pandas_table

        return pandas_table(reading.columns(self))

    def save(self, path: str | Path) -> None:
        """Write an NPZ file with arrays (as doubles) and metadata; `load` reads it."""
        from geomtorsion.motion.flows.files import save

        save(self, path)

    @classmethod
    def load(cls, path: str | Path) -> FlowSolution:
        """Read what `save` wrote; nothing in the file is run.

        What lies between the times is integrated again when it is asked for.

        Raises
        ------
        FileFormatError
            the file is missing, or was not written by `save`.

        Examples
        --------
        >>> import tempfile, pathlib
        >>> from geomtorsion.motion import FlowSolution, flow, solve
        >>> path = pathlib.Path(tempfile.mkdtemp()) / "decay.npz"
        >>> solve(flow({"x": "-x"}, [1]), 1.0).save(path)
        >>> round(float(FlowSolution.load(path).at(0.5)["x"]), 9)
        0.60653066
        """
        from geomtorsion.motion.flows.files import engine_of, load

        found = load(path)
        made, grid = found.pop("made"), found.pop("grid")
        tolerance = float.fromhex(made["tolerance"])
        recipe = Recipe(engine_of(made["engine"]), tolerance, grid, int(made["cuts"]))
        return cls(recipe=recipe, _loaded=found.pop("outputs"), **found)


def unknown(name: str, known: Any) -> str:
    """The message that a name is neither a state nor an output."""
    near = near_names(name, known)
    hint = f"Did you mean {near}? " if near else ""
    return f"{name!r} is no state or output here. {hint}There are {', '.join(known)}."
