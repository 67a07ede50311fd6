"""Rolling: the path of a loop rolled out into one frame, with the legs as they arrive."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.errors import LoopError
from geomtorsion.loops.affine import AffineForm
from geomtorsion.loops.loop import Loop
from geomtorsion.loops.steps import collocation, increments

if TYPE_CHECKING:
    from geomtorsion.geometry import Connection

STAGES = 6


@dataclass(frozen=True, eq=False)
class RolledPath:
    """A loop and its development, step by step.

    points: along the loop, coordinates, shape (n, k).
    places: where they come to lie in the frame at the base point, shape (n, k).
    legs: the frames there, seen in the frame at the base point, shape (k, n, n); column i: leg i.
    """

    points: np.ndarray
    places: np.ndarray
    legs: np.ndarray


def roll_out(
    connection: Connection,
    loop: Loop,
    count: int = 400,
    *,
    parameters: Mapping[Any, Any] | None = None,
) -> RolledPath:
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
    >>> path = roll_out(sphere, Loop.plaquette([1, 0], (0.5, 0.5)), 40)
    >>> path.places.shape, path.legs[-1].round(3).tolist()
    ((2, 41), [[0.973, 0.233], [-0.233, 0.973]])
    """

    n = connection.frame.dimension
    if loop.dimension != n:
        raise LoopError(f"the loop has {loop.dimension} coordinates, the frame {n}.")
    form = AffineForm(connection, parameters)
    nodes, _, _ = collocation(STAGES)
    stretches = list(loop.walk())
    each = max(2, -(-count // len(stretches)))
    motions, points = [], []
    for part, side, backwards in stretches:
        ends = np.linspace(0, 1, each + 1)
        ends = ends[::-1] if backwards else ends
        width = np.diff(ends)
        s = ends[:-1, None] + width[:, None] * nodes
        omega, theta = form.along(*part.points(side, s.ravel()))
        motions.append(
            increments(
                omega.reshape(each, STAGES, n, n) * width[:, None, None, None],
                theta.reshape(each, STAGES, n) * width[:, None, None],
            )
        )
        points.append(part.points(side, ends[:-1])[0])
    points.append(np.array(loop.base)[:, None])
    total = np.eye(n + 1)
    found = [total]
    for step in np.concatenate(motions):
        total = total + total @ step
        found.append(total)
    path = np.array(found)
    return RolledPath(np.concatenate(points, axis=1), path[:, :n, n].T, path[:, :n, :n])
