"""Checkpoint: the finished parts of a run, kept in a file from which it can go on."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.errors import CheckpointError, FileFormatError
from geomtorsion.files import TEXT_FORM, ArrayForm, conforming, read_json_text, read_npz, text_of
from geomtorsion.ode.engines.protocol import Engine, Run
from geomtorsion.ode.engines.taylor import Taylor, is_available
from geomtorsion.ode.trajectory import Runner, Stage, run_stage

if TYPE_CHECKING:
    from geomtorsion.ode.solution import Problem

FORMAT = 2
# A run is cut into so many parts, always at the same times, so that it can go on from any.
PARTS = 64
# Writing may take this part of the time.
SHARE = 0.1
_FIELDS = ("steps", "evaluations", "outcome", "reason", "compile_seconds", "run_seconds")
_PART = {
    "steps": int, "evaluations": int, "outcome": str, "reason": str,
    "compile_seconds": float, "run_seconds": float,
}  # fmt: skip
_METADATA = {"format": int, "key": str, "parts": {str: _PART}}
_FORMS = {"metadata": TEXT_FORM, "part *": ArrayForm(None, "fU")}
_BAD = "{path}: this is no checkpoint ({reason}). Remove it, or name another file."


def fingerprint(problem: Problem, times: np.ndarray, accuracy: float, engine: Engine | None) -> str:
    """What two runs share exactly when one may go on from the other's checkpoint."""
    described = {
        "problem": problem.described(),
        "times": [float(t).hex() for t in times],
        "accuracy": accuracy.hex(),
        "engine": repr(engine),
        "taylor": is_available(),
    }
    text = json.dumps(described, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


class Checkpoint:
    """Finished parts by engine, tolerance and number; written to a file as they come.

    path: NPZ file; key: fingerprint of the run.
    """

    def __init__(self, path: str | Path, key: str, *, overwrite: bool = False) -> None:
        self.path = Path(path)
        self.key = key
        self.metadata: dict[str, Any] = {"format": FORMAT, "key": key, "parts": {}}
        self.arrays: dict[str, np.ndarray] = {}
        self._written = time.perf_counter()
        self._took = 0.0
        if self.path.exists() and not overwrite:
            self._load()

    def _load(self) -> None:
        arrays = read_npz(self.path, _FORMS, error=CheckpointError, message=_BAD)
        try:
            found = read_json_text(text_of(arrays.pop("metadata")), self.path.name)
        except FileFormatError as error:
            raise CheckpointError(_BAD.format(path=self.path, reason=error)) from None
        if not isinstance(found, dict) or found.get("format") != FORMAT:
            raise CheckpointError(
                f"{self.path}: this is no checkpoint of this version. Remove it, or name another "
                "file."
            )
        metadata = conforming(found, _METADATA, str(self.path), CheckpointError)
        if metadata["key"] != self.key:
            raise CheckpointError(
                f"{self.path}: this is the checkpoint of another run: equations, numbers, times, "
                "accuracy or engine differ. Name another file, or give overwrite=True."
            )
        self.metadata, self.arrays = metadata, arrays

    @property
    def parts(self) -> Mapping[str, Mapping[str, Any]]:
        """Names of the finished parts, with their costs and outcomes."""
        return self.metadata["parts"]

    def known(self, name: str, engine: Engine, times: np.ndarray) -> Run | None:
        """A part that is finished already."""
        found = self.parts.get(name)
        if found is None:
            return None
        try:
            states, last, reached = (
                _restored(engine, self.arrays[f"part {name} {kind}"])
                for kind in ("states", "last", "reached")
            )
            grid = engine.array(times) if isinstance(engine, Taylor) else times
            return Run(grid[: len(states)], states, reached[0], last[0], **found)
        except (KeyError, ValueError, IndexError) as error:
            raise CheckpointError(_BAD.format(path=self.path, reason=error)) from None

    def keep(self, name: str, run: Run) -> None:
        """Add a part; write the file unless writing takes too much of the time."""
        fields = {field: getattr(run, field) for field in _FIELDS}
        # scipy counts in numbers of its own.
        fields |= {field: int(fields[field]) for field in ("steps", "evaluations")}
        self.metadata["parts"][name] = fields
        self.arrays[f"part {name} states"] = _plain(np.asarray(run.states))
        self.arrays[f"part {name} last"] = _plain(np.asarray(run.last)[None, :])
        self.arrays[f"part {name} reached"] = _plain(np.asarray([run.reached]))
        if self._took <= SHARE * (time.perf_counter() - self._written):
            self.write()

    def write(self) -> None:
        """Replace the file at once: it is always whole, the old one or the new one."""
        began = time.perf_counter()
        parts = self.path.with_name(f".{self.path.name}.{os.getpid()}.part")
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with parts.open("wb") as file:
                np.savez(file, metadata=np.array(json.dumps(self.metadata)), **self.arrays)  # type: ignore[arg-type]  # an array may be named as it likes
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


class Recorder:
    """Runs parts, keeps them in a checkpoint if there is one, and reports how far it is."""

    def __init__(
        self, checkpoint: Checkpoint | None, progress: Callable[[float], object] | None
    ) -> None:
        self.checkpoint = checkpoint
        self.progress = progress
        self.runs = 0

    def runner(self, engine: Engine, tolerance: float, perturbation: float) -> Runner:
        """What makes the parts of one run, or takes them from the file."""

        def run(k: int, stage: Stage, times: np.ndarray) -> Run:
            self.runs += k == 0
            kept, name = self.checkpoint, part_name(engine, tolerance, perturbation, k)
            found = None if kept is None else kept.known(name, engine, times)
            if found is None:
                found = run_stage(stage, times, tolerance, engine)
                if kept is not None:
                    kept.keep(name, found)
            # Two runs are needed at least; each takes half of what is left.
            left = 0.5 ** (self.runs - 1)
            self.report(1 - left + 0.5 * left * min((k + 1) / PARTS, 1.0))
            return found

        return run

    def report(self, part: float) -> None:
        """Report how much is done."""
        if self.progress is not None:
            self.progress(part)


def part_name(engine: Engine, tolerance: float, perturbation: float, k: int) -> str:
    """The name of a part of a run."""
    return f"{engine.name} {tolerance!r} {perturbation!r} {k}"


def _plain(array: np.ndarray) -> np.ndarray:
    """Numbers as a file can hold them: floats as they are, longer ones as text."""
    if array.dtype.type in (np.float64, np.longdouble):
        return array
    return np.array([str(x) for x in array.ravel()]).reshape(array.shape)


def _restored(engine: Engine, array: np.ndarray) -> np.ndarray:
    """The numbers that were kept, of the engine's kind."""
    if array.dtype.kind == "f" or not isinstance(engine, Taylor):
        return array
    return engine.array([str(x) for x in array.ravel()]).reshape(array.shape)
