"""curves: straightest and shortest curve from one start, in space, in the chart and over time."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.errors import LimitError
from geomtorsion.ode.error_estimate import combined, difference_over_samples
from geomtorsion.pictures.sphere import curve_on, globe, numbered, space_axes, towards
from geomtorsion.pictures.style import (
    FLAT,
    SERIES,
    STROKES,
    STYLE,
    Stroke,
    assigned,
    captioned,
    ends,
    legend,
    mathematics,
    new_figure,
    number,
    plot_sizes,
    quiet,
    space_box,
)
from geomtorsion.pictures.text import greek_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d import Axes3D

    from geomtorsion.ode import Solution
    from geomtorsion.spaces import Pair


def error_over_time(solution: Solution) -> np.ndarray | None:
    """Error estimate at each time, shape (m,): its largest value is `Solution.error`, if that is
    not the rounding of the engine. None if the solution came without a reference run.

    Examples
    --------
    >>> from geomtorsion.curves import geodesic
    >>> from geomtorsion.ode import RungeKutta, solve
    >>> from geomtorsion.spaces import load
    >>> p = geodesic(load("s2").frame, [1.0, 0.0], [0.0, 1.0], parameters={"R": 1})
    >>> sol = solve(p, 1.0, engine=RungeKutta())
    >>> bool(abs(error_over_time(sol).max() - sol.error) < 1e-16)
    True
    """
    if not solution.comparisons:
        return None
    first, runs = solution.trajectory, solution.comparisons
    gaps = [
        difference_over_samples(solution.problem, first, x.run, solution.accuracy) for x in runs
    ]
    return combined(gaps, runs)[len(gaps[0]) - len(solution.times) :]


# Position of a panel (rows, columns, number), and curves by name.
Place = tuple[int, int, int]
Paths = Mapping[str, np.ndarray]
# Names of the three axes of a body in legends.
NAMES = ("first axis of the body, 1", "second axis, 2", "third axis, 3")


def caption(pair: Pair) -> list[str]:
    """Where the motions start, how, and how accurate they are: lines for below a picture."""
    problem = pair.problem
    names = problem.coordinates
    start = assigned(names, [float(x) for x in problem.start or ()])
    velocity = assigned(names, problem.velocity.tolist(), "′")
    parts = [f"Start {start}", f"velocity {velocity}"]
    if pair.parameters:
        parts.append(f"with {assigned(list(pair.parameters), list(pair.parameters.values()))}")
    asked = pair.straight.accuracy
    error = max(solution.error for solution in pair.curves.values())
    parts.append(f"accuracy {number(asked)} requested, error below {number(float(f'{error:.1e}'))}")
    ends = {curve: float(pair.curves[curve].times[-1]) for curve in pair.stops}
    stops = [f"The {curve} stopped at t = {number(end)}." for curve, end in ends.items()]
    return ["; ".join(parts) + ".", *stops]


def clock(pair: Pair) -> str:
    """Name of the curve parameter on an axis: t, unless a coordinate has that name."""
    return "curve parameter" if "t" in pair.problem.coordinates else "$t$"


def paths_picture(pair: Pair) -> Figure:
    """Both paths: in the space embedded in ordinary space, and in the chart.

    Raises
    ------
    LimitError
        There are more than three coordinates and no embedding.
    MissingExtraError
        matplotlib is not installed.
    """
    views = []
    embedding = pair.embedding
    if embedding is not None and embedding.place:
        places = {
            name: embedding.places(points, pair.parameters)
            for name, points in pair.coordinates.items()
        }
        views.append((places, list(embedding.axes), embedding.title, embedding.isometric))
    names = [symbol.name for symbol in pair.symbols]
    if len(names) == 1:
        graphs = {
            name: np.column_stack([pair.curves[name].times, points])
            for name, points in pair.coordinates.items()
        }
        views.append((graphs, [clock(pair), *names], "", False))
    elif len(names) <= 3:
        views.append((pair.coordinates, names, f"in the chart {pair.chart}", False))
    if not views:
        raise LimitError(
            f"expected a path in ordinary space, got one in {len(names)} coordinates of "
            f"{pair.space.name}, which cannot be drawn in one figure. Use `coordinates_picture`."
        )
    figure = new_figure(10.0 if len(views) > 1 else 6.6, 5.2)
    shown: Axes | None = None
    for k, (paths, labels, title, equal) in enumerate(views):
        shown = _view(figure, (1, len(views), k + 1), paths, labels, title, equal)
    lines = [*caption(pair), "Dot: start; square and triangle: ends."]
    if embedding is not None and embedding.heading:
        _draw_blades(figure.axes[0], pair)
        lines.append("Bars: the blade or the wheels. A bar across its track slips sideways.")
    legend(figure, shown)
    captioned(figure, lines)
    return figure


def _draw_blades(axes: Axes, pair: Pair) -> None:
    """Bars along the blade at stations of both tracks, with a dot at the front."""
    embedding = pair.embedding
    assert embedding is not None
    tracks = {
        name: embedding.places(points, pair.parameters) for name, points in pair.coordinates.items()
    }
    length = 0.045 * float(np.ptp(np.concatenate(list(tracks.values())), axis=0).max())
    for name, track in tracks.items():
        stations = np.linspace(0, len(track) - 1, STYLE.stations).round().astype(int)
        directions = embedding.headings(pair.coordinates[name][stations], pair.parameters)
        bars = np.stack(
            [track[stations] - length * directions, track[stations] + length * directions]
        )
        axes.plot(*bars.transpose(2, 0, 1), color=STROKES[name].color, linewidth=3.6, alpha=0.55)
        axes.plot(*bars[1].T, "o", color=STROKES[name].color, markersize=3)
    axes.set_aspect("equal", adjustable="datalim")


def coordinates_picture(pair: Pair) -> Figure:
    """Each coordinate against t, both curves in one panel.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    points = pair.coordinates
    names = [symbol.name for symbol in pair.symbols]
    columns = 1 if len(names) == 1 else 2 if len(names) in (2, 4) else 3
    rows = math.ceil(len(names) / columns)
    figure = new_figure(3.1 * columns if columns > 1 else 6.0, 1.2 + 2.3 * rows)
    shown: Axes | None = None
    for k, name in enumerate(names):
        shown = figure.add_subplot(rows, columns, k + 1, sharex=shown)
        for curve, stroke in STROKES.items():
            shown.plot(pair.curves[curve].times, points[curve][:, k], **stroke.line, label=curve)
        shown.set_ylabel(mathematics(name), rotation=0, labelpad=12)
        if k < len(names) - columns:
            shown.tick_params(labelbottom=False)
        else:
            shown.set_xlabel(clock(pair))
        quiet(shown)
    legend(figure, shown)
    captioned(figure, caption(pair))
    return figure


def _view(
    figure: Figure, place: Place, paths: Paths, labels: Sequence[str], title: str, equal: bool
) -> Axes | Axes3D:
    """One panel: on a globe, in space or in a plane, as the points demand."""
    every = np.concatenate(list(paths.values()))
    radius = np.linalg.norm(every, axis=1)
    if equal and len(labels) == 3 and np.ptp(radius) < FLAT * radius.max():
        return _on_globe(figure, place, paths, float(radius.max()), title)
    stretch = np.ptp(every, axis=0)
    seen = [k for k in range(len(labels)) if stretch[k] > FLAT * stretch.max()]
    if len(labels) == 3 and len(seen) == 3:
        return _in_space(figure, place, paths, labels, title, equal)
    # Constant coordinates are omitted, but at least two directions are drawn.
    seen = (seen + [k for k in range(len(labels)) if k not in seen])[:2]
    axes = figure.add_subplot(*place)
    first, second = sorted(seen)
    for name, stroke in STROKES.items():
        points = paths[name][:, [first, second]]
        axes.plot(*points.T, **stroke.line, label=name)
    for name, stroke in STROKES.items():
        ends(axes, paths[name][:, [first, second]], stroke)
    axes.set_xlabel(mathematics(labels[first]))
    axes.set_ylabel(mathematics(labels[second]), rotation=0, labelpad=12)
    axes.set_title(title, fontsize=11)
    if equal or "flat space" in title:
        axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.08)
    quiet(axes)
    return axes


def _on_globe(figure: Figure, place: Place, paths: Paths, radius: float, title: str) -> Axes3D:
    axes = figure.add_subplot(*place, projection="3d")
    viewer = globe(axes, radius, towards(list(paths.values())))
    space_axes(axes, radius, viewer)
    for name, stroke in STROKES.items():
        curve_on(axes, paths[name], viewer, stroke, name)
    axes.set_title(title, fontsize=11)
    return axes


def _in_space(
    figure: Figure, place: Place, paths: Paths, labels: Sequence[str], title: str, equal: bool
) -> Axes3D:
    axes: Axes3D = figure.add_subplot(*place, projection="3d")
    for name, stroke in STROKES.items():
        axes.plot(*paths[name].T, **stroke.line, label=name)
    for name, stroke in STROKES.items():
        ends(axes, paths[name], stroke)
    axes.set_title(title, fontsize=11)
    every = np.concatenate(list(paths.values()))
    low, high = every.min(axis=0), every.max(axis=0)
    size, centre = high - low, (low + high) / 2
    if equal:
        # One unit is equally long on all axes; the box is not flatter than two fifths.
        size = np.maximum(size, size.max() / 2.5)
    space_box(axes, [mathematics(label) for label in labels], centre - size / 2, centre + size / 2)
    zoom = 0.84 if place[1] > 1 else 0.92
    axes.set_box_aspect(tuple(size) if equal else (1, 1, 0.85), zoom=zoom)
    turned = _azimuth((every - centre) / (1 if equal else size))
    axes.view_init(elev=STYLE.elevation, azim=turned)
    return axes


def _azimuth(points: np.ndarray) -> float:
    """The side from which curves spread over the largest area."""
    e = np.radians(STYLE.elevation)
    best, where = -1.0, -58.0
    for azimuth in range(-75, -10, 5):
        a = np.radians(azimuth)
        right = np.array([-np.sin(a), np.cos(a), 0])
        up = np.array([-np.sin(e) * np.cos(a), -np.sin(e) * np.sin(a), np.cos(e)])
        area = float(np.linalg.det(np.cov(np.array([points @ right, points @ up]))))
        if area > best * 1.02:
            best, where = area, float(azimuth)
    return where


def attitude_picture(pair: Pair) -> Figure:
    """Two globes side by side: where the body's axes point, as it turns by each of the curves.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    figure = new_figure(9.2, 5.4)
    embedding = pair.embedding
    assert embedding is not None
    first = None
    turns = {
        name: embedding.attitudes(points, pair.parameters)
        for name, points in pair.coordinates.items()
    }
    facing = towards([turn[:, :, axis] for turn in turns.values() for axis in range(3)])
    for k, (name, turn) in enumerate(turns.items()):
        axes: Axes3D = figure.add_subplot(1, 2, k + 1, projection="3d")
        first = first or axes
        viewer = globe(axes, 1.0, facing)
        space_axes(axes, 1.0, viewer)
        for axis, stroke in enumerate(SERIES[:3]):
            curve_on(axes, turn[:, :, axis], viewer, stroke, NAMES[axis])
            # The dashes of a curve with many turns fill up: the number stays legible.
            numbered(axes, turn[0, :, axis], viewer, str(axis + 1), stroke)
        axes.set_title(name, fontsize=11)
    legend(figure, first)
    lines = caption(pair)
    captioned(figure, [*lines, "Dots: start; pale: behind the globe; x, y, z are fixed in space."])
    return figure


def distance_picture(pair: Pair) -> Figure:
    """Distance of the two motions over time; equal motions beside the requested accuracy.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    figure = new_figure(6.6, 4.2)
    axes: Axes = figure.add_subplot()
    times = pair.times[: len(pair.distance)]
    stroke = SERIES[3]
    line = Stroke(stroke.color, "-", stroke.width).line
    if pair.coincide:
        # On this scale a distance below the accuracy is seen as what it is: none.
        asked = pair.straight.accuracy
        axes.plot(times, pair.distance, **line, label="distance")
        axes.axhline(
            asked,
            color="#666b73",
            linestyle=(0, (5, 1.6)),
            linewidth=1.2,
            label="requested accuracy",
        )
        largest = max(asked, float(pair.distance.max()))
        axes.set_ylim(-0.1 * largest, 1.25 * largest)
        axes.set_title("The two motions are equal within the accuracy", fontsize=11)
        legend(figure, axes)
    else:
        axes.plot(times, pair.distance, **line)
        axes.set_ylim(bottom=0)
        axes.set_title("Distance between autoparallel and geodesic", fontsize=11)
    axes.set_xlabel(clock(pair))
    axes.set_ylabel("distance")
    quiet(axes)
    captioned(figure, [*caption(pair), f"Measured by {pair.measure}."])
    return figure


def quality_picture(pair: Pair) -> Figure:
    """Error estimates of both motions, and the drift of every known invariant, over time.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    drifts = [
        (f"{curve}: {greek_words(name)}", solution.times, values)
        for curve, solution in pair.curves.items()
        for name, values in solution.invariant_changes.items()
    ]
    figure = new_figure(9.4, 4.6)
    left: Axes = figure.add_subplot(1, 2, 1)
    for curve, stroke in STROKES.items():
        solution = pair.curves[curve]
        errors = error_over_time(solution)
        if errors is not None:
            plot_sizes(left, solution.times, errors, stroke.line, curve)
    left.axhline(
        pair.straight.accuracy,
        color="#666b73",
        linestyle=(0, (1, 1.6)),
        linewidth=1.4,
        label="requested accuracy",
    )
    left.set_title("Error estimate, relative", fontsize=11)
    right: Axes = figure.add_subplot(1, 2, 2, sharey=left)
    for (label, times, values), stroke in zip(drifts, SERIES * 3, strict=False):
        plot_sizes(right, times, values, stroke.line, label)
    right.set_title("Drift of what should be constant, relative", fontsize=11)
    if not drifts:
        right.set_axis_off()
        right.text(0.5, 0.5, "no invariant is known", ha="center", transform=right.transAxes)
    for axes in (left, right):
        axes.set_yscale("log")
        axes.set_xlabel(clock(pair))
        axes.tick_params(labelleft=True)
        quiet(axes)
        if axes.get_legend_handles_labels()[0]:
            axes.legend(
                loc="upper center", bbox_to_anchor=(0.5, -0.16), frameon=False, fontsize=8.5,
                handlelength=3.2, ncols=1,
            )  # fmt: skip
    captioned(figure, [*caption(pair), "Single zeros are drawn at the bottom, at 1e−17."])
    return figure
