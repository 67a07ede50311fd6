"""Checkpoint: the finished legs of a run, kept in a file from which it can go on."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zipfile import BadZipFile

from geomtorsion.errors import CheckpointError
from geomtorsion.motion.engines.protocol import Engine, Run
from geomtorsion.motion.engines.taylor import Taylor, is_available
from geomtorsion.motion.flows.travel import run_one

if TYPE_CHECKING:
    from geomtorsion.motion.flows.flow import Flow

FORMAT = 1
# A run is cut into so many legs, always at the same times, so that it can go on from any.
LEGS = 64
# Writing may take this part of the time.
SHARE = 0.1
_FIELDS = ("steps", "evaluations", "outcome", "reason", "compile_seconds", "run_seconds")


def fingerprint(flow: Flow, times: Any, accuracy: float, engine: Engine | None) -> str:
    """What two runs share exactly when one may go on from the other's checkpoint."""
    described = {
        "rates": {name: str(rate) for name, rate in flow.law.rates.items()},
        "stop": str(flow.law.stop),
        "start": [_exactly(x) for x in flow.start],
        "parameters": {name: _exactly(x) for name, x in flow.parameters.items()},
        "switches": [
            (at.hex(), {name: _exactly(x) for name, x in values.items()})
            for at, values in flow.switches
        ],
        "blocks": [list(block) for block in flow.law.blocks],
        "unit": [list(group) for group in flow.unit],
        "times": [float(t).hex() for t in times],
        "accuracy": accuracy.hex(),
        "engine": repr(engine),
        "taylor": is_available(),
    }
    text = json.dumps(described, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def _exactly(value: Any) -> str:
    return value.hex() if isinstance(value, float) else str(value)


class Checkpoint:
    """Finished legs by engine, tolerance and number; written to a file as they come.

    path: NPZ file; key: fingerprint of the run.
    """

    def __init__(self, path: str | Path, key: str, *, overwrite: bool = False) -> None:
        self.path = Path(path)
        self.key = key
        self.metadata: dict[str, Any] = {"format": FORMAT, "key": key, "legs": {}}
        self.arrays: dict[str, Any] = {}
        self._written = time.perf_counter()
        self._took = 0.0
        if self.path.exists() and not overwrite:
            self._load()

    def _load(self) -> None:
        import numpy as np

        try:
            with np.load(self.path, allow_pickle=False) as data:
                metadata = json.loads(str(data["metadata"]))
                arrays = {name: data[name] for name in data.files if name != "metadata"}
        except (OSError, KeyError, ValueError, EOFError, BadZipFile) as error:
            raise CheckpointError(
                f"{self.path}: this is no checkpoint ({error}). Remove it, or name another file."
            ) from None
        if not isinstance(metadata, dict) or metadata.get("format") != FORMAT:
            raise CheckpointError(
                f"{self.path}: this is no checkpoint of this version. Remove it, or name another "
                "file."
            )
        if metadata.get("key") != self.key:
            raise CheckpointError(
                f"{self.path}: this is the checkpoint of another run: flow, numbers, times, "
                "accuracy or engine differ. Name another file, or give overwrite=True."
            )
        self.metadata, self.arrays = metadata, arrays

    def known(self, name: str, engine: Engine, times: Any) -> Run | None:
        """A leg that is finished already."""
        found = self.metadata["legs"].get(name)
        if found is None:
            return None
        states = _restored(engine, self.arrays[f"{name} states"])
        (last,) = _restored(engine, self.arrays[f"{name} last"])
        count = len(states)
        grid = engine.array(times) if isinstance(engine, Taylor) else times
        (reached,) = _restored(engine, self.arrays[f"{name} reached"])
        numbers = {field: found[field] for field in _FIELDS}
        return Run(grid[:count], states, reached, last, **numbers)

    def keep(self, name: str, run: Run) -> None:
        """Add a leg; write the file unless writing takes too much of the time."""
        import numpy as np

        fields = {field: getattr(run, field) for field in _FIELDS}
        # scipy counts in numbers of its own.
        fields |= {field: int(fields[field]) for field in ("steps", "evaluations")}
        self.metadata["legs"][name] = fields
        self.arrays[f"{name} states"] = _plain(np.asarray(run.states))
        self.arrays[f"{name} last"] = _plain(np.asarray(run.last)[None, :])
        self.arrays[f"{name} reached"] = _plain(np.asarray([run.reached]))
        if self._took <= SHARE * (time.perf_counter() - self._written):
            self.write()

    def write(self) -> None:
        """Replace the file at once: it is always whole, the old one or the new one."""
        import numpy as np

        began = time.perf_counter()
        parts = self.path.with_name(f".{self.path.name}.{os.getpid()}.part")
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with parts.open("wb") as file:
                np.savez(file, metadata=np.array(json.dumps(self.metadata)), **self.arrays)
                file.flush()
                os.fsync(file.fileno())
            parts.replace(self.path)
        except OSError as error:
            raise CheckpointError(
                f"{self.path}: the checkpoint cannot be written ({error}). Name another file."
            ) from None
        finally:
            with contextlib.suppress(OSError):
                parts.unlink(missing_ok=True)
        self._written = time.perf_counter()
        self._took = self._written - began


class Keeper:
    """Runs legs, keeps them in a checkpoint if there is one, and tells how far it is."""

    def __init__(
        self,
        flow: Flow,
        checkpoint: Checkpoint | None,
        legs: int,
        progress: Callable[[float], None] | None,
    ) -> None:
        self.flow = flow
        self.checkpoint = checkpoint
        self.legs = legs
        self.progress = progress
        self.trips = 0

    def __call__(
        self,
        leg: tuple[int, float],
        engine: Engine,
        start: Sequence[Any],
        numbers: Sequence[Any],
        times: Any,
        tolerance: float,
    ) -> Run:
        """The run of a leg (number, part by which its start is moved), known or made now."""
        k, moved = leg
        self.trips += k == 0
        kept = self.checkpoint
        name = f"{engine.name} {tolerance!r} {k} {moved!r}"
        run = None if kept is None else kept.known(name, engine, times)
        if run is None:
            run = run_one(self.flow, engine, start, numbers, times, tolerance)
            if kept is not None:
                kept.keep(name, run)
        # Two trips are needed at least; each takes half of what is left.
        left = 0.5 ** (self.trips - 1)
        self.tell(1 - left + 0.5 * left * (k + 1) / self.legs)
        return run

    def tell(self, part: float) -> None:
        """Report how much is done."""
        if self.progress is not None:
            self.progress(part)


def steady(engine: Engine) -> Engine:
    """An engine that computes the same whatever ran before: compiled in one way only."""
    if isinstance(engine, Taylor) and engine.optimised is None:
        return Taylor(engine.precision, True, engine.max_steps)
    return engine


def _plain(array: Any) -> Any:
    """Numbers as a file can hold them: floats as they are, longer ones as text."""
    import numpy as np

    if array.dtype.type in (np.float64, np.longdouble):
        return array
    return np.array([str(x) for x in array.ravel()]).reshape(array.shape)


def _restored(engine: Engine, array: Any) -> Any:
    """The numbers that were kept, of the engine's kind."""
    if array.dtype.kind == "f" or not isinstance(engine, Taylor):
        return array
    return engine.array([str(x) for x in array.ravel()]).reshape(array.shape)
