"""Attitude and path: directions of the axes of a moving body, and its path."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.pictures.sphere import (
    curve_on,
    globe,
    numbered,
    parted,
    space_axes,
    towards,
)
from geomtorsion.pictures.style import (
    FLAT,
    SERIES,
    STYLE,
    Stroke,
    captioned,
    ends,
    legend,
    new_figure,
    quiet,
    space_box,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d import Axes3D
    from numpy.typing import ArrayLike


TRACE = Stroke("#0072B2", "-", 1.7, "^")
LIMIT = "#D55E00"
# An axis that stays within this angle of the vertical (radians) is seen best from above.
UPRIGHT = 0.35


def axis_picture(
    times: ArrayLike,
    axis: ArrayLike,
    limits: Sequence[float] | None = None,
    title: str = "",
    notes: Sequence[str] = (),
) -> Figure:
    """The tip of a unit vector on the sphere of space, and its height against its angle.

    Parameters
    ----------
    times
        shape (m,), seconds.
    axis
        shape (m, 3): a unit vector fixed in the body, seen from space; z points up.
    limits
        angles from the vertical between which it nutates, in radians; those reached, if not given.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    tip = np.asarray(axis, dtype=float)
    tip = tip / np.linalg.norm(tip, axis=1, keepdims=True)
    theta = np.arccos(np.clip(tip[:, 2], -1, 1))
    bounds = (float(theta.min()), float(theta.max())) if limits is None else tuple(limits)
    figure = new_figure(10.4, 5.2)
    grid = figure.add_gridspec(1, 2, width_ratios=(1, 1))
    shown = tip[: _first_turns(tip)]
    ball: Axes3D = figure.add_subplot(grid[0], projection="3d")
    tilted = float(np.median(tip[:, 2]))
    viewer = globe(ball, 1.0, towards([shown]), elevation=42.0 if abs(tilted) > 0.5 else 24.0)
    space_axes(ball, 1.0, viewer)
    for bound in bounds:
        _parallel(ball, bound, viewer)
    curve_on(ball, shown, viewer, TRACE)
    ball.set_title("on the sphere", fontsize=11)
    flat: Axes = figure.add_subplot(grid[1])
    if max(bounds) < UPRIGHT:
        _from_above(flat, tip, theta, bounds)
    else:
        _unrolled(flat, tip, theta, bounds)
    if title:
        figure.suptitle(title, fontsize=12)
    lines = ["Dot: start; triangle: end; dashed: the angles between which the axis nutates."]
    if len(shown) < len(tip):
        end = float(np.asarray(times, dtype=float)[len(shown) - 1])
        lines.append(f"The sphere shows the first {STYLE.turns:g} turns, to t = {end:.4g} s.")
    captioned(figure, [*notes, *lines])
    return figure


def _azimuth(tip: np.ndarray) -> np.ndarray:
    """Angle about the vertical, carried on beyond full turns."""
    return np.unwrap(np.arctan2(tip[:, 1], tip[:, 0]))


def _first_turns(tip: np.ndarray) -> int:
    """How many samples the first turns about the vertical have."""
    phi = _azimuth(tip)
    beyond = np.flatnonzero(np.abs(phi - phi[0]) > 2 * np.pi * STYLE.turns)
    return int(beyond[0]) + 1 if len(beyond) else len(tip)


def _parallel(axes: Axes3D, theta: float, viewer: np.ndarray) -> None:
    """A circle of constant angle from the vertical."""
    turn = np.linspace(0, 2 * np.pi, 181)
    ring = np.column_stack(
        [np.sin(theta) * np.cos(turn), np.sin(theta) * np.sin(turn), np.full(181, np.cos(theta))]
    )
    for part, front in parted(ring, viewer):
        axes.plot(
            *part.T, color=LIMIT, linewidth=1.1, linestyle=(0, (4, 2)), alpha=0.9 if front else 0.3
        )


def _unrolled(axes: Axes, tip: np.ndarray, theta: np.ndarray, bounds: Sequence[float]) -> None:
    """Angle from the vertical against the angle about it, upright as on the sphere."""
    phi, tilt = np.degrees(_azimuth(tip)), np.degrees(theta)
    axes.plot(phi, tilt, **TRACE.line)
    ends(axes, np.column_stack([phi, tilt]), TRACE)
    for bound in bounds:
        axes.axhline(np.degrees(bound), color=LIMIT, linewidth=1.1, linestyle=(0, (4, 2)))
    low, high = (float(np.degrees(bound)) for bound in (min(bounds), max(bounds)))
    pad = max(0.12 * (high - low), 0.5)
    axes.set_ylim(min(high + pad, 180.0), max(low - pad, 0.0))
    axes.set_xlabel("angle about the vertical / degrees")
    axes.set_ylabel("angle from the vertical / degrees")
    axes.set_title("unrolled", fontsize=11)
    quiet(axes)


def _from_above(axes: Axes, tip: np.ndarray, theta: np.ndarray, bounds: Sequence[float]) -> None:
    """The tip seen from above: the radius is the angle from the vertical."""
    phi, tilt = np.arctan2(tip[:, 1], tip[:, 0]), np.degrees(theta)
    place = np.column_stack([tilt * np.cos(phi), tilt * np.sin(phi)])
    axes.plot(*place.T, **TRACE.line)
    ends(axes, place, TRACE)
    turn = np.linspace(0, 2 * np.pi, 181)
    for bound in bounds:
        ring = np.degrees(bound) * np.array([np.cos(turn), np.sin(turn)])
        axes.plot(*ring, color=LIMIT, linewidth=1.1, linestyle=(0, (4, 2)))
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("towards $x$ / degrees")
    axes.set_ylabel("towards $y$ / degrees")
    axes.set_title("from above", fontsize=11)
    quiet(axes)


def axes_picture(
    matrices: ArrayLike,
    title: str = "",
    notes: Sequence[str] = (),
    names: Sequence[str] = ("1", "2", "3"),
) -> Figure:
    """The three axes of a body in space: the paths of their tips on the unit sphere.

    Lines from the centre are the axes e_i(q) themselves, at the start and, pale, at the end
    ([FizievKleinert1994], Fig. 1).

    Parameters
    ----------
    matrices
        shape (m, 3, 3): rotations from body to space; column k is axis k + 1.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    turn = np.asarray(matrices, dtype=float)
    figure = new_figure(6.6, 6.4)
    axes: Axes3D = figure.add_subplot(projection="3d")
    viewer = globe(axes, 1.0, towards([turn[:, :, k] for k in range(3)]))
    space_axes(axes, 1.0, viewer)
    for k, stroke in enumerate(SERIES[:3]):
        curve_on(axes, turn[:, :, k], viewer, stroke, f"axis {names[k]} of the body")
        numbered(axes, turn[0, :, k], viewer, names[k], stroke)
        for place, alpha, width in ((turn[0, :, k], 0.95, 2.2), (turn[-1, :, k], 0.45, 1.4)):
            spoke = np.array([np.zeros(3), place])
            axes.plot(*spoke.T, color=stroke.color, linewidth=width, alpha=alpha)
    if title:
        axes.set_title(title, fontsize=12)
    legend(figure, axes)
    lines = ["Lines from the centre: the axes of the body at the start and, pale, at the end."]
    lines.append("Dots: start; pale: behind the globe; x, y, z are fixed in space.")
    captioned(figure, [*notes, *lines])
    return figure


SEPARATRIX, OTHERS = "#b04a86", "#a9cbe6"
# A direction that keeps its angle from the angular momentum within this (radians) sweeps a cone.
CONE = 0.15
POLHODE, AXIS, SPIN, MOMENTUM = (
    Stroke("#0072B2", "-", 2.0, "^"), SERIES[0], SERIES[1], SERIES[3],
)  # fmt: skip
FAMILY = (0.06, 0.2, 0.4, 0.6, 0.8, 0.94)


def cones_picture(
    moments: Sequence[float],
    omega: ArrayLike,
    matrices: ArrayLike | None = None,
    title: str = "",
    notes: Sequence[str] = (),
) -> Figure:
    """The angular momentum on its sphere in the body; axis and angular velocity in space.

    In the body, pale: all motions with this angular momentum and no torque; violet: those that
    part turning about the first from turning about the third axis.

    Parameters
    ----------
    moments
        principal moments of inertia, shape (3,).
    omega
        angular velocity, body axes, shape (m, 3).
    matrices
        rotations from body to space, shape (m, 3, 3); without them only the first panel is drawn.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    inertia = np.asarray(moments, dtype=float)
    momentum = inertia * np.asarray(omega, dtype=float)
    sizes = np.linalg.norm(momentum, axis=1, keepdims=True)
    direction = momentum / np.where(sizes > 0, sizes, 1)
    panels = 1 if matrices is None else 2
    figure = new_figure(5.6 * panels, 5.7)
    ball: Axes3D = figure.add_subplot(1, panels, 1, projection="3d")
    _in_body(ball, inertia, direction)
    lines = ["Body: direction of the angular momentum; pale: other free motions of the body."]
    if matrices is not None:
        turn = np.asarray(matrices, dtype=float)
        space: Axes3D = figure.add_subplot(1, panels, 2, projection="3d")
        _in_space(space, turn, np.asarray(omega, dtype=float), momentum)
        lines.append("Dots: start; triangle and square: ends.")
    if title:
        figure.suptitle(title, fontsize=12)
    captioned(figure, [*notes, *lines])
    return figure


def _in_body(axes: Axes3D, inertia: np.ndarray, direction: np.ndarray) -> None:
    """The sphere of angular momentum with the family of polhodes and the one that is travelled."""
    viewer = globe(axes, 1.0, towards([direction]), elevation=24.0)
    for value in _levels(inertia):
        for ring, special in polhodes(inertia, value):
            color = SEPARATRIX if special else OTHERS
            for part, front in parted(ring, viewer):
                alpha = (0.9 if special else 1.0) if front else STYLE.behind
                axes.plot(*part.T, color=color, linewidth=1.1, alpha=alpha)
    for k, pin in enumerate(np.eye(3)):
        for sign in (1, -1):
            look = {"alpha": 1.0 if sign * pin @ viewer >= 0 else STYLE.behind, "color": "#555555"}
            axes.plot(*(np.array([pin, 1.09 * pin]).T * sign), linewidth=1.4, **look)
            if sign > 0:
                axes.text(*(1.17 * pin), str(k + 1), ha="center", va="center", **look)
    curve_on(axes, direction, viewer, POLHODE)
    axes.set_title("seen from the body", fontsize=11, pad=16)


def _levels(inertia: np.ndarray) -> list[float]:
    """Values of 2 E / L^2 between the least and the largest, the middle axis among them."""
    low, middle, high = sorted(1 / inertia)
    if high - low <= 1e-9 * high:
        return []
    levels = [low + share * (middle - low) for share in FAMILY if middle - low > 1e-9 * high]
    levels += [middle + share * (high - middle) for share in FAMILY if high - middle > 1e-9 * high]
    return [*levels, float(np.float64(middle))]


def polhodes(inertia: ArrayLike, value: float) -> list[tuple[np.ndarray, bool]]:
    """Closed curves on the unit sphere on which sum l_k^2 / I_k is constant.

    Each comes with whether it is the separatrix. The sphere is cut as a function of the angle
    about the axis that the curve encircles.

    Examples
    --------
    >>> import numpy as np
    >>> rings = polhodes([1.0, 2.0, 3.0], 0.8)
    >>> len(rings), bool(abs((rings[0][0] ** 2 / [1, 2, 3]).sum(axis=1) - 0.8).max() < 1e-12)
    (2, True)
    """
    weights = 1 / np.asarray(inertia, dtype=float)
    order = np.argsort(weights)
    low, middle, high = weights[order]
    special = bool(abs(value - middle) <= 1e-12 * high) and low < middle < high
    # Curves encircle the axis of least weight below the middle, of largest weight above it.
    pole = order[2] if value >= middle else order[0]
    first, second = (k for k in range(3) if k != pole)
    turn = np.linspace(0, 2 * np.pi, 241)
    across = weights[first] * np.cos(turn) ** 2 + weights[second] * np.sin(turn) ** 2
    gap = weights[pole] - across
    with np.errstate(divide="ignore", invalid="ignore"):
        sine = np.where(gap != 0, (weights[pole] - value) / gap, 1.0)
    sine = np.sqrt(np.clip(sine, 0.0, 1.0))
    curves = []
    for sign in (1.0, -1.0):
        ring = np.empty((len(turn), 3))
        ring[:, first], ring[:, second] = sine * np.cos(turn), sine * np.sin(turn)
        ring[:, pole] = sign * np.sqrt(1 - sine**2)
        curves.append((ring, special))
    return curves


def _in_space(axes: Axes3D, turn: np.ndarray, omega: np.ndarray, momentum: np.ndarray) -> None:
    """Axis of the body, angular velocity and angular momentum as directions in space."""
    tip = turn[:, :, 2]
    spin = np.einsum("mij,mj->mi", turn, omega)
    fixed = np.einsum("mij,mj->mi", turn, momentum)
    curves = []
    for vectors in (tip, spin, fixed):
        sizes = np.linalg.norm(vectors, axis=1, keepdims=True)
        curves.append(vectors / np.where(sizes > 0, sizes, 1))
    viewer = globe(axes, 1.0, towards(curves[:2]), elevation=24.0)
    space_axes(axes, 1.0, viewer)
    names = ("axis 3 of the body", "angular velocity", "angular momentum")
    for points, stroke, name in zip(curves, (AXIS, SPIN, MOMENTUM), names, strict=True):
        curve_on(axes, points, viewer, stroke, name)
    for points, stroke in zip(curves[:2], (AXIS, SPIN), strict=True):
        angle = np.arccos(np.clip((points * curves[2]).sum(axis=1), -1, 1))
        if np.ptp(angle) > CONE:
            continue
        for place in points[:: max(len(points) // 60, 1)]:
            axes.plot(
                *np.array([np.zeros(3), place]).T, color=stroke.color, linewidth=0.5, alpha=0.25
            )
    axes.set_title("seen from space", fontsize=11, pad=16)
    axes.legend(
        loc="upper center", bbox_to_anchor=(0.5, 0.05), frameon=False, fontsize=9, ncols=3,
        handlelength=2.4, columnspacing=1.2,
    )  # fmt: skip


AXES = ("#b04a86", "#8a6d00", "#007a59")


def path_picture(
    paths: Mapping[str, ArrayLike],
    matrices: ArrayLike | None = None,
    title: str = "",
    notes: Sequence[str] = (),
) -> Figure:
    """One or several paths in space, the first with the axes of the body on its way.

    Parameters
    ----------
    paths
        name -> positions, shape (m, 3), metres.
    matrices
        rotations from body to space along the first path, shape (m, 3, 3).

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    places = {name: np.asarray(points, dtype=float) for name, points in paths.items()}
    every = np.concatenate(list(places.values()))
    stretch = np.ptp(every, axis=0)
    seen = [k for k in range(3) if stretch[k] > FLAT * max(stretch.max(), 1e-300)]
    turn = None if matrices is None else np.asarray(matrices, dtype=float)
    if len(seen) == 3:
        figure = new_figure(8.0, 6.6)
        axes: Axes3D = figure.add_subplot(projection="3d")
        _path_in_space(axes, places, turn, every)
    else:
        seen = sorted((seen + [k for k in (0, 2, 1) if k not in seen])[:2])
        wide, high = np.maximum(stretch[seen], 0.25 * stretch.max() or 1.0)
        figure = new_figure(min(1.4 + 5.2 * max(wide / high, 0.5), 9.4), _height(wide / high))
        axes = figure.add_subplot()
        _path_in_plane(axes, places, turn, seen)
    if title:
        axes.set_title(title, fontsize=12)
    if len(places) > 1:
        legend(figure, axes)
    lines = ["Dot: start; triangle and square: ends."]
    if turn is not None:
        lines.append("Short lines: axes of the body, 1 violet, 2 brown, 3 green and thicker.")
    captioned(figure, [*notes, *lines])
    return figure


def _height(ratio: float) -> float:
    """Height of a picture that is a plane this many times as wide as it is high."""
    return 6.6 if ratio <= 1.5 else 1.6 + 8.0 / ratio


def _strokes(places: Mapping[str, np.ndarray]) -> list[tuple[str, np.ndarray, Stroke]]:
    pairs = zip(places.items(), SERIES * len(places), strict=False)
    return [(name, points, stroke) for (name, points), stroke in pairs]


def _stations(points: np.ndarray) -> np.ndarray:
    """Samples at which the body is shown: at equal steps of the path, or of time where it rests."""
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    if way[-1] == 0:
        return np.array([0])
    # Equal steps of the path, not of time: slow bodies would cover each other.
    lengths = np.linspace(0, way[-1], min(STYLE.stations, len(points)))
    return np.unique(np.searchsorted(way, lengths).clip(0, len(points) - 1))


def _path_in_space(
    axes: Axes3D, places: Mapping[str, np.ndarray], turn: np.ndarray | None, every: np.ndarray
) -> None:
    low, high = every.min(axis=0), every.max(axis=0)
    # One unit is equally long on all axes; the box is not flatter than a third.
    size = np.maximum(high - low, (high - low).max() / 3)
    for name, points, stroke in _strokes(places):
        axes.plot(*points.T, **stroke.line, label=name)
    if turn is not None:
        points = next(iter(places.values()))
        length = 0.08 * float(np.ptp(points, axis=0).max())
        for station in _stations(points[: len(turn)]):
            for k in range(3):
                tip = points[station] + length * turn[station][:, k]
                axes.plot(
                    *np.array([points[station], tip]).T, color=AXES[k], linewidth=1 + (k == 2)
                )
    for _, points, stroke in _strokes(places):
        ends(axes, points, stroke)
    centre = (low + high) / 2
    labels = [f"${letter}$ / m" for letter in "xyz"]
    space_box(axes, labels, centre - size / 2, centre + size / 2)
    axes.set_box_aspect(tuple(size), zoom=0.88 if size[2] == size.max() else 1.0)
    axes.view_init(elev=22.0, azim=-56.0)


def _path_in_plane(
    axes: Axes, places: Mapping[str, np.ndarray], turn: np.ndarray | None, seen: Sequence[int]
) -> None:
    for name, points, stroke in _strokes(places):
        axes.plot(*points[:, seen].T, **stroke.line, label=name)
    flat = np.concatenate([points[:, seen] for points in places.values()])
    size = float(np.ptp(flat, axis=0).max()) or 1.0
    if turn is not None:
        points = next(iter(places.values()))
        for station in _stations(points[: len(turn)]):
            place = points[station, seen]
            for k in range(3):
                tip = place + 0.05 * size * turn[station][seen, k]
                axes.plot(*np.array([place, tip]).T, color=AXES[k], linewidth=1 + (k == 2))
    for _, points, stroke in _strokes(places):
        ends(axes, points[:, seen], stroke)
    axes.set_xlabel(f"${'xyz'[seen[0]]}$ / m")
    axes.set_ylabel(f"${'xyz'[seen[1]]}$ / m")
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.06)
    quiet(axes)
