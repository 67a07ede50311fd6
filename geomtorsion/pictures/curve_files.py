"""curve files: files that `geomtorsion curve` writes: a table, the problem, and figures."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Mapping
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

import numpy as np

from geomtorsion.pictures.curves import (
    attitude_picture,
    coordinates_picture,
    distance_picture,
    paths_picture,
    quality_picture,
)
from geomtorsion.pictures.quantities import Data
from geomtorsion.pictures.style import can_draw, save
from geomtorsion.spaces import Pair
from geomtorsion.support import checks
from geomtorsion.support.files import write_text, written
from geomtorsion.support.outgoing import csv_cell

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from geomtorsion.ode import Solution

Draw = Callable[["Pair"], "Figure"]


def curve_pictures(pair: Pair) -> dict[str, tuple[Draw, str]]:
    """Figures of this pair: name -> (function that draws it, caption).

    Examples
    --------
    >>> from geomtorsion.ode import RungeKutta
    >>> from geomtorsion.spaces.pair import solve_pair
    >>> from geomtorsion.spaces import load
    >>> list(curve_pictures(solve_pair(load("so3"), engine=RungeKutta())))
    ['paths', 'attitude', 'coordinates', 'distance', 'quality']
    """
    embedding = checks.instance(pair, Pair, "pair").embedding
    shown: dict[str, tuple[Draw, str]] = {}
    if len(pair.symbols) <= 3 or (embedding is not None and embedding.place):
        shown["paths"] = (paths_picture, "Autoparallel and geodesic from one start.")
    if embedding is not None and embedding.attitude is not None:
        shown["attitude"] = (attitude_picture, "Where the axes of the body point on their way.")
    shown["coordinates"] = (coordinates_picture, "Each coordinate over the curve parameter.")
    shown["distance"] = (distance_picture, "How far apart the two motions are.")
    shown["quality"] = (quality_picture, "Error estimate, and drift of what should be constant.")
    return shown


def write_curves(
    pair: Pair,
    directory: Path,
    form: str = "png",
    progress: Callable[[str], object] = lambda _: None,
) -> list[Path]:
    """Write curve.csv, curve.json and, where matplotlib is installed, the pictures.

    Nothing is written before everything is computed; the directory is made if it is missing.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from geomtorsion.ode import RungeKutta
    >>> from geomtorsion.spaces.pair import solve_pair
    >>> from geomtorsion.spaces import load
    >>> pair = solve_pair(load("s2"), engine=RungeKutta(), samples=5)
    >>> with TemporaryDirectory() as folder:
    ...     [path.name for path in write_curves(pair, Path(folder))][:2]
    ['curve.csv', 'curve.json']
    """
    table = pair.columns()
    figures = {}
    if can_draw():
        for name, (draw, _) in curve_pictures(pair).items():
            progress(f"drawing {name}")
            figures[f"{name}.{form}"] = draw(pair)
    facts = metadata(pair) | {"table": "curve.csv", "pictures": list(figures)}
    # From here on nothing can fail but the disk.
    paths = [directory / "curve.csv", directory / "curve.json"]
    with written(directory, is_folder=True):
        with written(paths[0]) as part, part.open("w", encoding="utf-8", newline="") as file:
            _write_csv(file, table)
        write_text(paths[1], json.dumps(facts, indent=2, ensure_ascii=False) + "\n")
        for name, figure in figures.items():
            save(figure, directory / name)
            paths.append(directory / name)
    return paths


def _write_csv(file: TextIO, table: Mapping[str, np.ndarray]) -> None:
    """Every number with all its digits; cells of a curve that stopped early stay empty."""
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(map(csv_cell, table))
    # Numbers of more than 53 bits print all their digits; floats do so only by repr.
    columns = [
        [repr(float(x)) if column.dtype == float else str(x) for x in column]
        for column in table.values()
    ]
    writer.writerows(zip_longest(*columns, fillvalue=""))


def metadata(pair: Pair) -> Data:
    """The problem, the method and the accuracy, ready for JSON."""
    problem = pair.problem
    return {
        "space": pair.space.name,
        "coordinates": list(problem.coordinates),
        "chart": pair.chart,
        "columns": "t is the curve parameter; q, q' and u^i (frame, from 0) for each curve; "
        f"distance is measured by {pair.measure}",
        "parameters": pair.parameters,
        "start": [float(x) for x in problem.start or ()],
        "velocity": problem.velocity.tolist(),
        "frame_velocity": [float(x) for x in problem.frame_velocity],
        "t": float(pair.times[-1]),
        "chosen": list(pair.chosen),
        "accuracy": pair.straight.accuracy,
        "largest_distance": float(pair.distance.max()),
        "coincide": pair.coincide,
        "curves": {name: _facts(pair, name, curve) for name, curve in pair.curves.items()},
    }


def _facts(pair: Pair, name: str, solution: Solution) -> Data:
    return {
        "law": solution.problem.law.text,
        "equations": solution.problem.text,
        "engine": solution.engine,
        "reason": solution.reason,
        "charts": list(solution.charts),
        "error": solution.error,
        "drift": {key: float(value) for key, value in solution.drift.items()},
        "cost": {key: float(value) for key, value in vars(solution.cost).items()},
        "complete": solution.complete,
        "stopped": pair.stops.get(name, ""),
    }
