"""Public calls that take a frame, on a frame as people type it, from the point of its region."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp

import geomtorsion as gt
from geomtorsion.pictures.report import write_report
from tests.typed import Typed

# Length of motions and loops, relative to the coordinates: too short to leave the region.
SHORT = 0.01


def start(frame: gt.Frame) -> list[float]:
    """Coordinates of the point of the region."""
    return [float(frame.region.point[q]) for q in frame.coordinates]


def values(frame: gt.Frame) -> dict[str, float]:
    """Parameters at the point of the region."""
    return {str(p): float(frame.region.point[p]) for p in frame.parameters}


def calls(row: Typed, folder: Path) -> Iterator[tuple[str, Callable[[], object]]]:
    """Names and calls that must return for each frame without unknown functions."""
    frame = row.frame
    n = frame.dimension
    velocity = [1.0] + [0.0] * (n - 1)
    at: dict[str, Any] = {"parameters": values(frame)}
    connection = gt.levi_civita(frame)
    along = {"frame_velocity": velocity, **at}
    point = start(frame)
    moved = [x + SHORT * abs(x) * (k + 1) / n for k, x in enumerate(point)]

    yield "identities", lambda: gt.identities(connection)
    yield "Killing equations", lambda: gt.same.killing_equations(frame)
    yield "torsion", lambda: gt.cartan(frame).torsion.T.at(frame.region.point)
    yield "curvature", lambda: connection.curvature.scalar.at(frame.region.point)
    yield "Kretschmann scalar", lambda: connection.curvature.kretschmann.at(frame.region.point)
    yield "legs", lambda: frame.legs.at(frame.region.point)
    yield "volume", lambda: frame.volume.at(frame.region.point)
    yield "symmetries", lambda: str(gt.symmetries(frame))
    yield "symmetries of the legs", lambda: str(gt.symmetries(frame, "teleparallel"))
    yield "holonomy algebra", lambda: str(connection.holonomy_algebra)
    yield "geodesic", lambda: gt.solve(gt.geodesic(frame, point, **along), SHORT)
    yield (
        "autoparallel",
        lambda: gt.solve(gt.autoparallel(gt.cartan(frame), point, **along), SHORT),
    )
    yield (
        "transport",
        lambda: gt.solve(
            gt.parallel_transport(gt.geodesic(frame, point, **along), [velocity]), SHORT
        ),
    )
    yield (
        "exponential map",
        lambda: gt.exponential_map(connection, point, [SHORT * x for x in velocity], **at),
    )
    yield "holonomy", lambda: gt.holonomy(connection, gt.geodesic(frame, point, **along), SHORT)
    if n > 1:
        yield "development", lambda: gt.develop_path(gt.cartan(frame), [point, moved], **at)
        yield (
            "Burgers vector",
            lambda: gt.burgers_vector(frame, gt.Loop.circle(point, SHORT * abs(point[1])), **at),
        )
        rest = " ".join(map(str, frame.coordinates[:-1]))
        yield "surface", lambda: gt.surface(frame, rest).extrinsic_curvature
    yield "equations of motion", lambda: gt.equations_of_motion(frame, kinetic(frame)).accelerations
    yield "variation", lambda: gt.variation(frame)
    yield "limit", lambda: limit(frame)
    yield (
        "numbers",
        lambda: gt.numpy_function(frame.metric, list(frame.region.point))(*point_of(frame)),
    )
    yield "conserved quantities", lambda: str(gt.conserved_quantities(frame, kinetic(frame)))
    yield (
        "geodesic deviation",
        lambda: gt.solve(gt.geodesic_deviation(gt.geodesic(frame, point, **along), point), SHORT),
    )
    yield "logarithm", lambda: gt.log_map(connection, point, moved, **at)
    yield "linearized", lambda: gt.linearized(frame, kinetic(frame), at=frame.region.point)
    yield "defects", lambda: gt.loops.find_defects(frame)
    yield "tetrad file", lambda: round_trip(frame, folder)
    if n > 1:
        loop = gt.Loop.circle(point, SHORT * abs(point[1]))
        yield "enclosed defects", lambda: gt.loops.enclosed_defects(frame, loop, **at)
        yield "Killing-Yano forms", lambda: gt.gravity.killing_yano(frame)
        rows = [[x, y] for x, y in zip(point[:2], moved[:2], strict=True)]
        yield "Burgers map", lambda: gt.burgers_map(frame, rows, at=point, **at)
    yield "report", lambda: report(frame, folder)


def positive_calls(row: Typed) -> Iterator[tuple[str, Callable[[], object]]]:
    """Names and calls that must return for positive metrics and may be refused for others."""
    frame = row.frame
    yield "diffusion", lambda: gt.diffusion(gt.levi_civita(frame))
    if frame.dimension > 1:
        yield "constraint", lambda: gt.constrained(frame, [f"d{frame.coordinates[-1]}"])


def charges(row: Typed) -> Iterator[tuple[str, Callable[[], object]]]:
    """Names and calls for charges of space-times, which need a closed surface or a flat limit."""
    frame = row.frame
    if frame.dimension == 4:
        yield "mass of Komar", lambda: str(gt.gravity.charge(frame))
        yield "mass at infinity", lambda: str(gt.gravity.charge(frame, "adm"))
        yield "horizons", lambda: str(gt.gravity.horizons(frame, parameters=values(frame)))


def point_of(frame: gt.Frame) -> list[float]:
    """Values of all symbols at the point of the region."""
    return [float(x) for x in frame.region.point.values()]


def round_trip(frame: gt.Frame, folder: Path) -> None:
    """A frame from its own file has the same forms and lives in the same region."""
    folder.mkdir(exist_ok=True)
    file = folder / "typed.toml"
    file.write_text(frame.to_toml())
    again = gt.read(file).frame
    named = {s.name: value for s, value in frame.region.point.items()}
    point = {s: named[s.name] for s in again.region.point}
    # Roots may be written otherwise.
    assert np.allclose(again.coframe.at(point), frame.coframe.at(frame.region.point), rtol=1e-9)
    assert set(map(str, again.region.relations)) == set(map(str, frame.region.relations))


def kinetic(frame: gt.Frame) -> str:
    """Half of the sum of squares of the frame velocities."""
    return "(" + " + ".join(f"u{i + 1}**2" for i in range(frame.dimension)) + ")/2"


def limit(frame: gt.Frame) -> None:
    """The limit of the metric as a symbol tends to its value is the metric there."""
    symbol = (*frame.parameters, *frame.coordinates)[0]
    value = frame.region.point[symbol]
    rest = {s: x for s, x in frame.region.point.items() if s != symbol}
    limits = frame.metric.limit(symbol, value)
    for i in range(frame.dimension):
        difference = limits[i, i].subs(rest) - frame.metric[i, i].subs(frame.region.point)
        assert abs(sp.N(difference)) < 1e-9


def report(frame: gt.Frame, folder: Path) -> None:
    """The page of a frame."""
    space = gt.spaces.Space("typed", frame=frame)
    page = write_report(space, folder, pictures=False)
    assert page.stat().st_size
