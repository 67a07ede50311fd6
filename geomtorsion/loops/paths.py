"""Paths: development along open paths, around periodic coordinates, and point by point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from geomtorsion.errors import LoopError
from geomtorsion.geometry.connections import ConnectionLike, as_connection
from geomtorsion.loops.affine_form import AffineForm, line_rate
from geomtorsion.loops.affine_map import AffineMap
from geomtorsion.loops.arcs import Parameters, Part, Segment, shown
from geomtorsion.loops.development import back_by
from geomtorsion.loops.loop import Loop, check_loop
from geomtorsion.loops.symbol_values import with_numbers
from geomtorsion.loops.transport import STAGES, collocation, increments, transported
from geomtorsion.loops.validation import number, vector
from geomtorsion.support import checks
from geomtorsion.support.precision import CALCULATED


def develop_path(
    connection: ConnectionLike,
    points: Sequence[Sequence[float]],
    accuracy: float = 1e-12,
    *,
    parameters: Parameters | None = None,
) -> AffineMap:
    """Development of an open path through points, straight in the coordinates between them.

    Returns
    -------
    AffineMap: rotation and position of the frame at the end, seen from the frame at the start. The
    development of a loop, seen from the end of the path, is `turn.seen_from(path)`.

    Raises
    ------
    LoopError
        There are fewer than two points, or two neighbours coincide.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame, levi_civita
    >>> r, phi = sp.symbols("r phi", positive=True)
    >>> plane = levi_civita(Frame([r, phi], [[1, 0], [0, r]]))
    >>> quarter = develop_path(plane, [[2, 0], [2, sp.pi / 2]])
    >>> quarter.burgers.round(12).tolist(), round(quarter.angle, 12)
    ([-2.0, 2.0], -1.570796326795)
    """
    connection = as_connection(connection)
    n = connection.frame.dimension
    entries = checks.entries(points, "points", LoopError)
    rows = [vector(point, f"points[{k}]", n) for k, point in enumerate(entries)]
    if len(rows) < 2 or any(one == two for one, two in pairwise(rows)):
        raise LoopError(
            f"path: expected two points or more, each different from the next, got {len(rows)}: "
            f"{rows}."
        )
    centre = rows[0]
    offsets = [tuple(x - c for x, c in zip(row, centre, strict=True)) for row in rows]
    sides = tuple(Segment(a, b) for a, b in pairwise(offsets))
    part = Part(centre, 1.0, sides)
    form = AffineForm(connection, parameters)
    return transported(sides, line_rate(form, part), accuracy).motion


def develop_period(
    connection: ConnectionLike,
    points: Sequence[Sequence[float]],
    periods: Parameters,
    accuracy: float = 1e-12,
    *,
    parameters: Parameters | None = None,
) -> AffineMap:
    """Development of a path that closes only because coordinates are periodic, such as angles.

    If the frame is multivalued, the rotation of the legs is part of the result.

    Parameters
    ----------
    points
        Corners of the path, straight in the coordinates between them; the last corner is the first
        one shifted by whole periods.
    periods
        {coordinate or its name: period}.

    Returns
    -------
    AffineMap: Burgers vector and rotation in the frame at the start, as of a closed loop.

    Raises
    ------
    LoopError
        The path does not end whole periods from its start, and the message names the gap; or a
        period is not positive.

    Examples
    --------
    Around the tip of a cone from which a sixth was cut out, in polar coordinates:

    >>> import math
    >>> from geomtorsion.geometry import levi_civita
    >>> from geomtorsion.spaces import load
    >>> cone = levi_civita(load("wedge_disclination").frame)
    >>> circle = [[2, 0, 0], [2, 2 * math.pi, 0]]
    >>> turn = develop_period(cone, circle, {"phi": 2 * math.pi}, parameters={"alpha": 5 / 6})
    >>> round(math.degrees(turn.angle), 9), turn.burgers.round(9).tolist()
    (60.0, [-1.0, -1.732050808, 0.0])
    """
    connection = as_connection(connection)
    frame = connection.frame
    names = {symbol.name: k for k, symbol in enumerate(frame.coordinates)}
    lengths: dict[int, float] = {}
    for name, value in checks.by_name(periods, "periods", LoopError).items():
        checks.known_name(name, names, "periods", LoopError, expected="a coordinate")
        period = number(value, f"period of {name}")
        if not period:
            raise LoopError(f"periods: expected the change of {name} in one turn, got 0.")
        lengths[names[name]] = period
    entries = checks.entries(points, "points", LoopError)
    rows = [vector(point, f"points[{k}]", frame.dimension) for k, point in enumerate(entries)]
    open_ = develop_path(connection, rows, accuracy, parameters=parameters)
    gap = np.array(rows[-1]) - np.array(rows[0])
    for k, period in lengths.items():
        gap[k] -= period * round(gap[k] / period)
    sizes = np.array([lengths.get(k, 1.0) for k in range(frame.dimension)])
    if (np.abs(gap) > CALCULATED * np.maximum(np.abs(sizes), np.abs(rows[0]))).any():
        raise LoopError(
            f"the path does not close: up to whole periods, its end misses its start "
            f"{shown(rows[0])} by {shown(gap)}. Let it end at its start, or a whole number of "
            "periods away from it."
        )
    form = AffineForm(connection, parameters)
    start, end = (np.array(row) for row in (rows[0], rows[-1]))
    return open_ @ back_by(form, start, end - start)


@dataclass(frozen=True, eq=False)
class DevelopedPath:
    """A loop and its development as points along both.

    points: along the loop, coordinates, shape (n, k).
    places: their images in the frame at the base point, shape (n, k).
    legs: the frames there, seen in the frame at the base point, shape (k, n, n); column i: leg i.
    """

    points: np.ndarray
    places: np.ndarray
    legs: np.ndarray


def developed_path(
    connection: ConnectionLike,
    loop: Loop,
    count: int = 400,
    *,
    parameters: Parameters | None = None,
) -> DevelopedPath:
    """The development of a loop at about `count` points along it, for pictures.

    Raises
    ------
    LoopError
        The loop has another dimension than the frame.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame, levi_civita
    >>> theta, phi = sp.symbols("theta phi")
    >>> sphere = levi_civita(Frame([theta, phi], [[1, 0], [0, sp.sin(theta)]]))
    >>> path = developed_path(sphere, Loop.plaquette([1, 0], (0.5, 0.5)), 40)
    >>> path.places.shape, path.legs[-1].round(3).tolist()
    ((2, 41), [[0.973, 0.233], [-0.233, 0.973]])
    """
    connection = as_connection(connection)
    frame = connection.frame
    n = frame.dimension
    check_loop(loop, n)
    loop, parameters = with_numbers(frame, loop, parameters)
    form = AffineForm(connection, parameters)
    nodes, _, _ = collocation(STAGES)
    stretches = list(loop.arcs())
    each = max(2, -(-count // len(stretches)))
    motions, points = [], []
    for part, arc, backwards in stretches:
        ends = np.linspace(0, 1, each + 1)
        ends = ends[::-1] if backwards else ends
        width = np.diff(ends)
        s = ends[:-1, None] + width[:, None] * nodes
        omega, theta = form.along(*part.points(arc, s.ravel()))
        motions.append(
            increments(
                omega.reshape(each, STAGES, n, n) * width[:, None, None, None],
                theta.reshape(each, STAGES, n) * width[:, None, None],
            )
        )
        points.append(part.points(arc, ends[:-1])[0])
    points.append(np.array(loop.base)[:, None])
    total = np.eye(n + 1)
    totals = [total]
    for step in np.concatenate(motions):
        total = total + total @ step
        totals.append(total)
    path = np.array(totals)
    return DevelopedPath(np.concatenate(points, axis=1), path[:, :n, n].T, path[:, :n, :n])
