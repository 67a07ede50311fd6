"""Checkpoint: the finished parts of a run, in a file from which the run can be resumed."""

from __future__ import annotations

import hashlib
import json
import os
import time
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.errors import CheckpointError, FileFormatError
from geomtorsion.ode.engines.taylor import Taylor, is_available
from geomtorsion.ode.roundings import Roundings
from geomtorsion.ode.system import Engine, Run
from geomtorsion.ode.trajectory import Runner, Stage, run_stage
from geomtorsion.support.checks import cut
from geomtorsion.support.files import written
from geomtorsion.support.npz import TEXT_FORM, ArrayForm, json_in, read_npz, write_npz

if TYPE_CHECKING:
    from geomtorsion.ode.solution import Problem

# Files of format 3 may hold runs in which constants of the equations were 0.
FORMAT = 5
# Writing may take this part of the time; how often it is done changes no result.
SHARE = 0.1
_FIELDS = ("steps", "evaluations", "outcome", "reason", "compile_seconds", "run_seconds",
           "longest_step")  # fmt: skip
# No run has more steps than a day of a core could take.
_COUNT = range(10**12)
_PART = {
    "steps": _COUNT, "evaluations": _COUNT, "outcome": frozenset({"done", "edge", "stuck"}),
    "reason": str, "compile_seconds": float, "run_seconds": float, "longest_step": float,
}  # fmt: skip
_METADATA = {"format": int, "key": str, "parts": {str: _PART}}
# Two axes, times and states; the place where a part ended is one number.
_FORMS = {"metadata": TEXT_FORM, "part *": ArrayForm((None, ...), "fU")}
_BAD = "{path}: this is not a checkpoint ({reason}). Remove it, or name another file."


def fingerprint(problem: Problem, times: np.ndarray, accuracy: float, engine: Engine | None) -> str:
    """Digest of a run; it may be resumed only from a checkpoint with the same digest."""
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
    """A file that holds the finished parts of a long run, so that a stopped run can continue.

    path: NPZ file; key: a hash of the problem, times and accuracy.
    """

    def __init__(self, path: str | Path, key: str, *, overwrite: bool = False) -> None:
        self.path: Path = Path(path)
        self.key = key
        self.metadata: dict[str, Any] = {"format": FORMAT, "key": key, "parts": {}}
        self.arrays: dict[str, np.ndarray] = {}
        self._written = time.perf_counter()
        self._took = 0.0
        if self.path.exists() and not overwrite:
            self._load()

    def _load(self) -> None:
        arrays = read_npz(self.path, _FORMS, error=CheckpointError, message=_BAD)
        options: dict[str, Any] = {"path": self.path, "error": CheckpointError, "message": _BAD}
        header = json_in(arrays, "metadata", {"format?": int}, **options)
        if header.get("format") != FORMAT:
            raise CheckpointError(
                f"{self.path}: expected a checkpoint of this version, got another file. Remove it, "
                "or name another file."
            )
        metadata = json_in(arrays, "metadata", _METADATA, **options)
        del arrays["metadata"]
        if metadata["key"] != self.key:
            raise CheckpointError(
                f"{self.path}: expected a checkpoint of this run, got one with other equations, "
                "numbers, times, accuracy or engine. Name another file, or give overwrite=True."
            )
        self.metadata, self.arrays = metadata, arrays

    @property
    def parts(self) -> Mapping[str, Mapping[str, Any]]:
        """Names of the finished parts, with their costs and outcomes."""
        return self.metadata["parts"]

    def known(self, name: str, engine: Engine, stage: Stage, times: np.ndarray) -> Run | None:
        """A part that an earlier run finished, or None."""
        record = self.parts.get(name)
        if record is None:
            return None
        part = ""
        try:
            read = {}
            for part, shape in (
                ("states", (None, len(stage.start))), ("last", (1, len(stage.start))),
                ("reached", (1,)),
            ):  # fmt: skip
                read[part] = _restored(engine, self.arrays[f"part {name} {part}"], shape)
            states, last, reached = read["states"], read["last"][0], read["reached"][0]
            low, high = sorted((float(times[0]), float(times[-1])))
            if not low <= float(reached) <= high:
                raise ValueError(f"{reached} is not between {low} and {high}")
            part, done = "states", record["outcome"] == "done"
            if len(states) > len(times) or (done and len(states) < len(times)):
                raise ValueError(f"{len(states)} states came with {len(times)} times")
        except (KeyError, ValueError) as error:
            reason = f"part {name} {part}: {cut(str(error))}"
            raise CheckpointError(_BAD.format(path=self.path, reason=reason)) from None
        grid = times if engine.precision == 53 else Taylor(engine.precision).array(times)
        return Run(grid[: len(states)], states, reached, last, **record)

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

    def begin(self) -> None:
        """Write the file if there is none, so that it also exists after an early stop."""
        if not self.path.exists():
            self.write()

    def write(self) -> None:
        """Replace the file in one step: a reader sees the old file or the new one, never a part."""
        began = time.perf_counter()
        try:
            with written(self.path.parent, is_folder=True), written(self.path) as part:
                write_npz(
                    part, {"metadata": json.dumps(self.metadata), **self.arrays}, packed=False
                )
                # On the disk before it takes the place of the file that is there.
                with part.open("r+b") as file:
                    os.fsync(file.fileno())
        except FileFormatError as error:
            raise CheckpointError(str(error)) from None
        self._written = time.perf_counter()
        self._took = self._written - began

    def runner(
        self,
        engine: Engine,
        tolerance: float,
        perturbation: float,
        longest: float,
        roundings: Roundings | None,
        fineness: int = 1,
    ) -> Runner:
        """A function that computes the parts of one run, or reads them from the file.

        fineness: the factor by which the parts are shorter.
        """

        pattern = 0 if roundings is None else roundings.pattern

        def run(k: int, stage: Stage, times: np.ndarray) -> Run:
            name = part_name(engine, tolerance, perturbation, k, pattern, fineness)
            result = self.known(name, engine, stage, times)
            if result is None:
                result = run_stage(
                    stage, times, tolerance, engine, longest=longest, roundings=roundings
                )
                self.keep(name, result)
            return result

        return run


def part_name(
    engine: Engine,
    tolerance: float,
    perturbation: float,
    k: int,
    pattern: int = 0,
    fineness: int = 1,
) -> str:
    """The name of a part of a run.

    pattern: of the signs of changes on the way; fineness: of the parts, in which they are shorter.
    """
    number = f"{k}/{pattern}" if pattern else f"{k}"
    number = f"{number} of {fineness}" if fineness > 1 else number
    return f"{engine.name} {tolerance!r} {perturbation!r} {number}"


def _plain(array: np.ndarray) -> np.ndarray:
    """Numbers as a file can hold them: floats as they are, longer ones as text."""
    if array.dtype.type in (np.float64, np.longdouble):
        return array
    return np.array([str(x) for x in array.ravel()]).reshape(array.shape)


def _restored(engine: Engine, array: np.ndarray, shape: tuple[int | None, ...]) -> np.ndarray:
    """The numbers that were kept, of the engine's kind and of the shape that is needed."""
    fits = len(array.shape) == len(shape) and all(
        length in (None, came) for length, came in zip(shape, array.shape, strict=True)
    )
    if not fits:
        raise ValueError(f"expected shape {shape}, got {array.shape}")
    if array.dtype.kind == "U":
        if engine.precision == 53:
            raise ValueError("expected numbers, got text")
        # Refuses text that is not a number; heyoka would raise another error.
        as_floats = np.array([float(x) for x in array.ravel()])
        texts = [str(x) for x in array.ravel()]
        array = Taylor(engine.precision).array(texts).reshape(array.shape)
    else:
        as_floats = array
    if not np.isfinite(as_floats.astype(float)).all():
        raise ValueError("a number in it is not finite")
    return array
