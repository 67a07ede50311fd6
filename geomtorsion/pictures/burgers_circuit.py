"""Burgers circuit: a closed path of bonds in a plane crystal, and the same steps in the lattice."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.errors import CrystalError
from geomtorsion.materials.crystals import PlaneCrystal
from geomtorsion.materials.crystals.plane_lattices import LATTICES
from geomtorsion.pictures.loops import GAP, IMAGE, PATH, START
from geomtorsion.pictures.style import FAINT, arrow, captioned, new_figure, number
from geomtorsion.support import checks

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def draw_burgers_circuit(crystal: PlaneCrystal, centre: Sequence[float], radius: float) -> Figure:
    """A circuit from atom to atom around a point, and the same steps in the perfect lattice.

    The circuit runs anticlockwise along bonds, near the sides of a square, or of a hexagon in a
    lattice of triangles or hexagons. It is closed in the crystal. In the perfect lattice the steps
    are whole numbers, and they close unless the circuit encloses dislocations. The gap is the
    Burgers vector, exactly.

    Equation
    --------
    b = sum of the lattice steps along the circuit (F. C. Frank, Phil. Mag. 42, 1951, 809)

    Parameters
    ----------
    centre
        A point (x, y) in the coordinates of the atoms.
    radius
        From the point to the sides of the square, or to the corners of the hexagon.

    Returns
    -------
    A matplotlib figure. Left: the atoms, their bonds and the circuit. Right: its steps in the
    lattice, with the gap as an arrow from the start to the end.

    Raises
    ------
    CrystalError
        There are too few atoms around the point for a circuit, or a grain boundary is in the way.
    MissingExtraError
        matplotlib is not installed.

    Examples
    --------
    >>> import numpy as np
    >>> import geomtorsion as gt
    >>> x, y = (np.mgrid[-8:9, -8:9] + 0.5).reshape(2, -1)
    >>> slip = np.arctan2(y, x) / (2 * np.pi)
    >>> crystal = gt.crystals.Crystal(np.column_stack([x + slip, y]))
    >>> draw_burgers_circuit(crystal, [0, 0], 4).axes[1].get_title()
    'the same steps in the lattice: b = (−1, 0)'
    """
    checks.instance(crystal, PlaneCrystal, "crystal")
    middle = checks.array(centre, "centre", CrystalError, shape=(2,))
    half = float(checks.positive(radius, "radius", CrystalError))
    pairs, steps = np.asarray(crystal.bonds.complex.pairs), crystal.bonds.values
    lengths = np.linalg.norm(np.diff(crystal.positions[pairs], axis=1)[:, 0], axis=1)
    # Bonds between both sides of a periodic cell are not drawn, and no circuit uses them.
    inside = lengths < 2 * crystal.constant
    pairs, steps, lengths = pairs[inside], steps[inside], lengths[inside]
    path = _circuit(crystal, pairs, lengths, middle, half)
    table = {(a, b): step for (a, b), step in zip(pairs.tolist(), steps, strict=True)}
    walked = [table[a, b] if (a, b) in table else -table[b, a] for a, b in pairwise(path)]
    # In the lattice the path has whole coordinates, so that its gap is exact.
    lattice = np.concatenate([np.zeros((1, 2), dtype=np.int64), np.cumsum(walked, axis=0)])
    grain = crystal.grains[int(crystal.grain[path[0]])]
    cell = LATTICES[grain.lattice].cell if grain.lattice in LATTICES else np.eye(2)
    base = grain.vectors.T @ np.linalg.inv(cell)
    figure = new_figure(9.6, 5.2)
    left, right = figure.subplots(1, 2)
    _draw_crystal(left, crystal, pairs, path, middle, half)
    _draw_lattice(right, lattice, base, honeycomb=grain.lattice == "honeycomb")
    gap = np.linalg.solve(cell, lattice[-1])
    right.set_title(
        f"the same steps in the lattice: b = ({', '.join(number(x + 0.0) for x in gap)})"
        if gap.any()
        else "the same steps in the lattice: closed",
        fontsize=11,
    )
    size = number(float(np.linalg.norm(base @ lattice[-1])))
    ended = f" b in lattice vectors, {size} long." if gap.any() else ""
    captioned(figure, [f"{len(walked)} steps, anticlockwise from the dot.{ended}"])
    return figure


def _circuit(
    crystal: PlaneCrystal, pairs: np.ndarray, lengths: np.ndarray, middle: np.ndarray, half: float
) -> list[int]:
    """Numbers of the atoms from corner to corner, the first again at the end."""
    places = crystal.positions
    grain = crystal.grains[int(crystal.grain[np.argmin(np.linalg.norm(places - middle, axis=1))])]
    along, other = grain.vectors / np.linalg.norm(grain.vectors, axis=1)[:, None]
    across = np.array([-along[1], along[0]])
    # Rows of atoms at angles of 60 degrees, or at right angles.
    sides, first = (6, -2 * np.pi / 3) if abs(along @ other) > 0.25 else (4, -3 * np.pi / 4)
    angles = first + 2 * np.pi * np.arange(sides) / sides
    reach = half if sides == 6 else half * np.sqrt(2)
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=1) @ np.stack([along, across])
    corners = middle + reach * directions
    atoms = [int(np.argmin(np.linalg.norm(places - corner, axis=1))) for corner in corners]
    far = max(float(np.linalg.norm(places[k] - x)) for k, x in zip(atoms, corners, strict=True))
    if len(set(atoms)) < len(atoms) or far > crystal.constant:
        raise CrystalError(
            f"expected atoms near the corners of a circuit of radius {half:.6g} about "
            f"({middle[0]:.6g}, {middle[1]:.6g}), got none at one of them. Change the radius."
        )
    # The shortest way leads along rows; cubes of lengths prefer two bonds to a diagonal.
    graph = scipy.sparse.csr_array((lengths**3, pairs.T), shape=(len(places), len(places)))
    _, before = scipy.sparse.csgraph.dijkstra(
        graph, directed=False, indices=atoms, return_predecessors=True
    )
    path = [atoms[0]]
    for k, end in enumerate([*atoms[1:], atoms[0]]):
        side = [end]
        while side[-1] != atoms[k]:
            side.append(int(before[k, side[-1]]))
            if side[-1] < 0:
                raise CrystalError(
                    "expected bonds from corner to corner within one grain, got a grain boundary "
                    "or a hole between them. Change the centre or the radius."
                )
        path += side[-2::-1]
    return path


def _draw_crystal(
    axes: Axes,
    crystal: PlaneCrystal,
    pairs: np.ndarray,
    path: list[int],
    middle: np.ndarray,
    half: float,
) -> None:
    """Atoms, the bonds of nearest neighbours, and the circuit."""
    places = crystal.positions
    reach = half + 2.2 * crystal.constant
    near = np.abs(places - middle).max(axis=1) < reach
    ends = places[pairs[np.isin(pairs, np.flatnonzero(near)).all(axis=1)]]
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    # Diagonals of a square lattice are longer than its bonds.
    bonds = ends[lengths < 1.25 * float(np.quantile(lengths, 0.25))]
    axes.plot(bonds[..., 0].T, bonds[..., 1].T, color=FAINT, linewidth=1.0, zorder=1)
    axes.plot(*places[near].T, "o", color="#8b9098", markersize=3.5, zorder=2)
    _draw_path(axes, places[path], PATH)
    axes.set_title("the circuit in the crystal: closed", fontsize=11)


def _draw_lattice(axes: Axes, lattice: np.ndarray, base: np.ndarray, *, honeycomb: bool) -> None:
    """The sites of the perfect lattice around a path, the path, and the gap."""
    path = base @ lattice.T
    size = int(np.ptp(lattice)) + 3
    sites = (
        np.mgrid[-size : size + 1, -size : size + 1].reshape(2, -1)
        + lattice.mean(axis=0).astype(int)[:, None]
    )
    if honeycomb:
        # A third of the sites of the lattice of triangles is empty: a class of x - y modulo 3.
        classes = np.unique((lattice[:, 0] - lattice[:, 1]) % 3)
        sites = sites[:, np.isin((sites[0] - sites[1]) % 3, classes)]
    points = base @ sites
    edge = 2.2 * float(np.linalg.norm(base[:, 0]))
    middle = (path.min(axis=1) + path.max(axis=1))[:, None] / 2
    reach = float(np.ptp(path, axis=1).max()) / 2 + edge
    shown = points[:, np.abs(points - middle).max(axis=0) < reach]
    axes.plot(*shown, "o", color=FAINT, markersize=3.5, zorder=1)
    _draw_path(axes, path.T, IMAGE)
    if lattice[-1].any():
        arrow(axes, base @ lattice[0], base @ lattice[-1], GAP, 2.6)


def _draw_path(axes: Axes, points: np.ndarray, color: str) -> None:
    """A path with its sense on each step, and its start."""
    axes.plot(*points.T, color=color, linewidth=2.0, zorder=3)
    axes.plot(*points.T, "o", color=color, markersize=3.5, zorder=3)
    quarter = max(len(points) // 4, 1)
    for k in range(quarter // 2, len(points) - 1, quarter):
        arrow(axes, points[k], points[k + 1], color)
    axes.plot(*points[:1].T, "o", color=START, markersize=7, zorder=6)
    axes.set_aspect("equal")
    axes.axis("off")
