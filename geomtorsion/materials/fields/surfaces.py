"""Surfaces: measured points on a surface in space, as by two cameras, over two of its axes."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.materials.fields.point_values import PointValues


def over_two_axes(points: PointValues) -> PointValues:
    """Points on a surface in space, over the two axes to which it is most nearly parallel.

    The frame of the deformed surface is e^i_mu = d_mu (X^i + u^i), with three rows i and the two
    coordinates mu, such as x and y. Its columns are tangent vectors of the surface, e^T e is the
    metric, and its integral around a circuit is the Burgers vector in space. The third row is
    d (z + w). Other points are returned unchanged: a plane, or a volume.

    It is a surface if neighbours over the two axes are mostly less far apart along the
    third axis than along these two.
    """
    if len(points.places) != 3 or points.form != "displacement" or len(points.values) != 3:
        return points
    place = np.array([*points.places.values()])
    # Programs write failed points at one position, such as the origin.
    failed = np.isnan(points.values).any(axis=0)
    _, first, group = np.unique(place, axis=1, return_index=True, return_inverse=True)
    shared = np.bincount(group, minlength=len(first))[group] > 1
    used = ~(failed & shared) & np.isfinite(place).all(axis=0)
    place, values = place[:, used], points.values[:, used]
    slopes = {
        pair: _slope(place[list(pair)], place[3 - sum(pair)]) for pair in combinations(range(3), 2)
    }
    pair = min(slopes, key=lambda one: slopes[one])
    if not slopes[pair] < 1:
        return points
    names, order = [*points.places], [*pair, 3 - sum(pair)]
    source = (
        f"a surface in space over {names[order[0]]} and {names[order[1]]}; components along "
        f"{', '.join(names[k] for k in order)}"
    )
    return replace(
        points, places={names[k]: place[k] for k in pair}, values=values[order],
        height=place[order[2]],
        where=[points.where[k] for k in np.flatnonzero(used).tolist()],
        source=source,
    )  # fmt: skip


def _slope(plane: np.ndarray, height: np.ndarray) -> float:
    """Median slope from each point to its nearest neighbour in the plane; infinite for a volume."""
    if plane.shape[1] < 4 or np.linalg.matrix_rank(plane - plane.mean(axis=1, keepdims=True)) < 2:
        return np.inf
    distances, nearest = scipy.spatial.cKDTree(plane.T).query(plane.T, 2)
    # Where two points have one place, they are not on a surface over these axes.
    if not distances[:, 1].all():
        return np.inf
    return float(np.median(np.abs(height - height[nearest[:, 1]]) / distances[:, 1]))
