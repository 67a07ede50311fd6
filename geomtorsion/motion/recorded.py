"""Recorded: a solution as plain arrays and metadata, written to and read from NPZ files."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any
from zipfile import BadZipFile

from geomtorsion.errors import FileFormatError
from geomtorsion.files import conforming

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np

    from geomtorsion.motion.solution import Solution

FORMAT = 1
ARRAYS = ("times", "coordinates", "velocity", "frame_velocity", "passengers")


@dataclass(frozen=True, eq=False)
class Recorded:
    """What a solution was, without the means to go on.

    times: shape (m,); coordinates, velocity, frame_velocity: shape (m, n); passengers.
    metadata: problem, space, coordinates, parameters, accuracy, error, engine, why, cost, drift.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> from geomtorsion.motion import Recorded, RungeKutta, geodesic, solve
    >>> from geomtorsion.spaces import load
    >>> p = geodesic(load("s2").frame, [1.0, 0.0], [0.0, 1.0], parameters={"R": 1})
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "motion.npz"
    >>> solve(p, 1.0, engine=RungeKutta()).save(path)
    >>> Recorded.load(path).metadata["space"]
    's2'
    """

    times: np.ndarray
    coordinates: np.ndarray
    velocity: np.ndarray
    frame_velocity: np.ndarray
    passengers: np.ndarray
    metadata: Mapping[str, Any]

    @property
    def error(self) -> float:
        """Error estimate of the solution that was saved."""
        return float(self.metadata["error"])

    @classmethod
    def load(cls, path: str | Path) -> Recorded:
        """Read what `Solution.save` wrote; nothing in the file is run.

        Raises
        ------
        FileFormatError
            the file is missing, or was not written by `Solution.save`.
        """
        import numpy as np

        try:
            with open(path, "rb") as file, np.load(file, allow_pickle=False) as data:
                arrays = {name: data[name] for name in ARRAYS}
                metadata = json.loads(str(data["metadata"]))
        except (OSError, KeyError, ValueError, EOFError, BadZipFile) as error:
            raise FileFormatError(
                f"{path}: this is no motion saved by Solution.save ({error}). "
                "Save the solution again."
            ) from None
        conforming(metadata, {"error": float}, str(path))
        if metadata.get("format") != FORMAT:
            raise FileFormatError(
                f"{path}: format {metadata.get('format')} was found, {FORMAT} is known. "
                "Use the version of geomtorsion that wrote it."
            )
        return cls(**arrays, metadata=metadata)


def save(solution: Solution, path: str | Path) -> None:
    """Write arrays (as doubles) and metadata."""
    import numpy as np

    moment = solution.moment
    arrays = {
        "times": solution.times,
        "coordinates": moment.coordinates,
        "velocity": moment.velocity,
        "frame_velocity": moment.frame_velocity,
        "passengers": moment.passengers,
    }
    problem = solution.problem
    metadata = {
        "format": FORMAT,
        "problem": problem.name,
        "law": problem.law.text,
        "space": problem.frame.name,
        "coordinates": list(problem.coordinates),
        "parameters": {name: str(value) for name, value in problem.parameters.items()},
        "start": None if problem.start is None else [str(x) for x in problem.start],
        "frame_velocity": [str(x) for x in problem.frame_velocity],
        "charts": list(solution.charts),
        "accuracy": solution.accuracy,
        "error": solution.error,
        "engine": solution.engine,
        "why": solution.why,
        "complete": solution.complete,
        "cost": {name: float(value) for name, value in vars(solution.cost).items()},
        "drift": {name: float(value) for name, value in solution.drift.items()},
    }
    plain = {name: np.asarray(value).astype(float) for name, value in arrays.items()}
    # Any array may be named as it likes; the type takes one name for an option.
    np.savez_compressed(path, metadata=np.array(json.dumps(metadata)), **plain)  # type: ignore[arg-type]
