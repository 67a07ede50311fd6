"""Triangulation: scattered points joined by Delaunay edges, with holes and walks along edges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.errors import GridError
from geomtorsion.loops import Complex, Loop
from geomtorsion.loops.arcs import shown
from geomtorsion.materials.fields.grid import numbers
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.precision import CALCULATED

if TYPE_CHECKING:
    from scipy.sparse import csr_array


@dataclass(frozen=True, eq=False)
class Triangulation:
    """Triangles or tetrahedra between scattered points.

    made: Delaunay triangulation of scipy. every: corners of all simplices, shape (k, d + 1),
    anticlockwise in the plane. kept: whether each is part of the region; the others are holes, or
    outside.
    """

    made: scipy.spatial.Delaunay
    every: np.ndarray
    kept: np.ndarray

    @classmethod
    def of(
        cls,
        points: np.ndarray,
        unknown: np.ndarray,
        longest: float | None,
        boundary: Sequence[np.ndarray],
    ) -> Triangulation:
        """Delaunay triangulation without simplices at unknown points, at long edges, or outside.

        boundary: closed polygons, shape (k, 2) each; points in an odd number of them are inside.
        """
        try:
            made = scipy.spatial.Delaunay(points)
        except scipy.spatial.QhullError:
            raise GridError(
                f"points: expected {points.shape[1] + 1} or more that are not all "
                f"{'on one line' if points.shape[1] == 2 else 'in one plane'}, got {len(points)} "
                "points without triangles. Add points."
            ) from None
        if len(made.coplanar):
            k, _, twin = made.coplanar[0].tolist()
            raise GridError(
                f"points: expected different points, got points {k} and {twin} at "
                f"{shown(points[k])}. Keep one of them."
            )
        corners = made.simplices.astype(np.int64)
        place = points[corners]
        volume = np.linalg.det(place[:, 1:] - place[:, :1])
        corners[volume < 0] = corners[volume < 0][:, [1, 0, *range(2, corners.shape[1])]]
        kept = ~unknown[corners].any(axis=1) & (volume != 0)
        if longest is not None:
            sides = place[:, :, None] - place[:, None]
            kept &= (sides**2).sum(axis=-1).max(axis=(1, 2)) <= longest**2
        if boundary:
            inside = np.zeros(len(corners), dtype=np.int64)
            for polygon in boundary:
                inside += _inside(polygon, place.mean(axis=1))
            kept &= inside % 2 == 1
        if not kept.any():
            raise GridError(
                "points: expected at least one triangle, got none: each touches an unknown point, "
                "is longer than `longest`, or is outside the boundary. Give a larger `longest` or "
                "boundary."
            )
        return cls(made, corners, kept)

    @property
    def points(self) -> np.ndarray:
        """Coordinates, shape (N, d), d = 2 or 3."""
        return self.made.points

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self.points.shape[1]

    @cached_property
    def complex(self) -> Complex:
        """The complex of the region; its nodes are all points."""
        return Complex.of_simplices(self.every[self.kept], len(self.points))

    @cached_property
    def _whole(self) -> Complex:
        """The complex of all simplices, including holes."""
        return (
            Complex.of_simplices(self.every, len(self.points)) if self.has_holes else self.complex
        )

    @property
    def has_holes(self) -> bool:
        """Whether some simplices are not part of the region."""
        return not self.kept.all()

    @cached_property
    def steps(self) -> np.ndarray:
        """Vector from the first node of each edge to the second, shape (edges, d)."""
        a, b = self.complex.pairs.T
        return self.points[b] - self.points[a]

    @cached_property
    def inner(self) -> np.ndarray:
        """Nodes of at least one simplex of the region, shape (k,)."""
        return np.unique(self.every[self.kept])

    # -- faces ------------------------------------------------------------------------------------

    @cached_property
    def corners(self) -> np.ndarray:
        """Corners of each face, in some order, shape (faces, 3)."""
        faces = abs(self.complex.boundary(1)) @ abs(self.complex.boundary(0))
        return faces.tocsr().indices.reshape(-1, 3)

    @cached_property
    def areas(self) -> np.ndarray:
        """Area of each face, positive, shape (faces,)."""
        place = self.points[self.corners]
        one, two = place[:, 1] - place[:, 0], place[:, 2] - place[:, 0]
        dots = [(x * y).sum(axis=1) for x, y in ((one, one), (two, two), (one, two))]
        return np.sqrt(np.maximum(dots[0] * dots[1] - dots[2] ** 2, 0.0)) / 2

    def stars(self, rings: int) -> csr_array:
        """The faces within a number of rings around each node, shape (nodes, faces)."""
        faces, count = len(self.corners), len(self.points)
        ones = np.ones(3 * faces, dtype=np.int64)
        owner = np.repeat(np.arange(faces), 3)
        star = scipy.sparse.csr_array((ones, (self.corners.ravel(), owner)), shape=(count, faces))
        near = abs(self.complex.boundary(0)).T @ abs(self.complex.boundary(0))
        stars = star
        for _ in range(rings - 1):
            stars = near @ stars
            stars.data[:] = 1
        return stars.tocsr()[self.inner]

    # -- holes ------------------------------------------------------------------------------------

    @cached_property
    def rims(self) -> tuple[np.ndarray, ...]:
        """Sense of each edge in the circuit along the rim of each hole, shape (edges,) each.

        A circuit turns from x to y. Holes that share a node are one hole; a gap that reaches the
        outer rim is not a hole.
        """
        chain = np.asarray(self.complex.boundary(1).sum(axis=0)).ravel().astype(np.int64)
        edges = np.flatnonzero(chain)
        a, b = self.complex.pairs[edges].T
        count = len(self.points)
        links = scipy.sparse.coo_array((np.ones(len(edges)), (a, b)), shape=(count, count))
        names = scipy.sparse.csgraph.connected_components(links, directed=False)[1][a]
        (x, y), (u, v) = self.points[a].T, self.points[b].T
        area = np.bincount(names, chain[edges] * (x * v - y * u)) / 2
        rims = []
        for name in dict.fromkeys(names.tolist()):
            if area[name] < 0:
                rim = np.zeros(len(chain), dtype=np.int64)
                rim[edges[names == name]] = -chain[edges[names == name]]
                rims.append(rim)
        return tuple(rims)

    def around(self, rim: np.ndarray, margin: int) -> np.ndarray:
        """The circuit around a hole with margin - 1 rings of triangles inside."""
        chain, faces = rim, self.complex.boundary(1)
        taken = np.zeros(len(self.corners), dtype=bool)
        nodes = np.zeros(len(self.points), dtype=bool)
        nodes[self.complex.pairs[rim != 0]] = True
        for _ in range(margin - 1):
            taken |= nodes[self.corners].any(axis=1)
            nodes[self.corners[taken]] = True
        return chain + faces.T @ taken.astype(np.int64)

    # -- walks ------------------------------------------------------------------------------------

    def walk(self, loop: Loop) -> np.ndarray:
        """The nodes nearest to the points of a loop, in order, each joined to the next.

        When a loop passes from the neighbourhood of one node to the next, a Delaunay edge joins
        these nodes.
        """
        if loop.dimension != self.dimension:
            raise GridError(
                f"loop: expected {self.dimension} coordinates, as the points have, got "
                f"{loop.dimension}. Give a loop in the coordinates of the points."
            )
        if np.abs(loop.gap).max() > 0:
            raise GridError(
                f"loop: expected a loop that closes, got one whose ends are "
                f"{shown(loop.gap)} apart. Points have no periods."
            )
        lengths = np.sqrt((self.steps**2).sum(axis=1))
        # If two points for each edge are not enough, the path between them is bisected.
        way = loop.points(max(400, round(2 * loop.length / float(np.median(lengths))))).T
        outside = self.made.find_simplex(way) < 0
        if outside.any():
            raise GridError(
                f"{loop!r} leaves the points at {shown(way[np.argmax(outside)])}. Choose a smaller "
                "loop, or move it."
            )
        tree = scipy.spatial.cKDTree(self.points)
        near = tree.query(way)[1]
        nodes = [int(near[0])]
        for k in range(len(way) - 1):
            self._step(nodes, int(near[k + 1]), way[k], way[k + 1], tree)
        path = np.array(nodes)
        if len(path) > 1 and path[0] != path[-1]:
            raise GridError(
                f"loop: expected a loop that closes, got one from point {path[0]} to point "
                f"{path[-1]}. Close the loop."
            )
        if len(set(nodes)) < 3:
            raise GridError(
                f"{loop!r} surrounds no triangle: it stays near point {nodes[0]}. Choose a larger "
                "loop."
            )
        self._refuse(path, loop)
        return path

    def _step(
        self,
        nodes: list[int],
        end: int,
        one: np.ndarray,
        other: np.ndarray,
        tree: scipy.spatial.cKDTree,
    ) -> None:
        """Extend the walk from the node nearest to `one` to the node nearest to `other`."""
        start = nodes[-1]
        if start == end:
            return
        if self._whole.joins(np.array([start]), np.array([end]))[0]:
            nodes.append(end)
            return
        middle = (one + other) / 2
        if np.abs(other - one).max() > CALCULATED * np.abs(self.points).max():
            self._step(nodes, int(tree.query(middle)[1]), one, middle, tree)
            self._step(nodes, end, middle, other, tree)
            return
        # At a point equally close to four nodes, continue through a common neighbour.
        shared = np.intersect1d(self._beside(nodes[-1]), self._beside(end))
        if not len(shared):
            raise GridError(
                f"the loop goes from point {nodes[-1]} to point {end} at {shown(one)}, but no "
                "edges join them. Move the loop a little."
            )
        nodes += [int(shared[0]), end]

    def _beside(self, node: int) -> np.ndarray:
        """Neighbours of a node."""
        pairs = self._whole.pairs
        return np.concatenate([pairs[pairs[:, 0] == node, 1], pairs[pairs[:, 1] == node, 0]])

    def _refuse(self, nodes: np.ndarray, loop: Loop) -> None:
        """Raise an error that names the points between which a walk leaves the region."""
        is_edge = self.complex.joins(nodes[:-1], nodes[1:])
        if not is_edge.all():
            k = int(np.argmin(is_edge))
            a, b = nodes[k : k + 2].tolist()
            raise GridError(
                f"{loop!r} touches a hole between point {a} at "
                f"{shown(self.points[a])} and point {b} at {shown(self.points[b])}. Choose a loop "
                "around it: .loop_around(hole) makes one."
            )

    # -- values -----------------------------------------------------------------------------------

    @cached_property
    def _neighbours(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Each edge in both directions: node, neighbour, and the step between them."""
        (a, b), steps = self.complex.pairs.T, self.steps
        return np.concatenate([a, b]), np.concatenate([b, a]), np.concatenate([steps, -steps])

    @cached_property
    def slopes(self) -> tuple[csr_array, ...]:
        """Matrices from values to derivatives at nodes, by planes through nodes and neighbours.

        One matrix for each direction, shape (nodes, nodes), by least squares, each neighbour by the
        square of its distance.
        """
        node, neighbour, step = self._neighbours
        count = len(self.points)
        squares = np.zeros((count, self.dimension, self.dimension))
        np.add.at(squares, node, step[:, :, None] * step[:, None])
        weights = np.einsum("kij,kj->ki", np.linalg.pinv(squares, hermitian=True)[node], step)
        matrices = []
        for column in weights.T:
            table = scipy.sparse.csr_array((column, (node, neighbour)), shape=(count, count))
            matrices.append((table - scipy.sparse.diags_array(table.sum(axis=1))).tocsr())
        return tuple(matrices)

    @cached_property
    def departures(self) -> tuple[csr_array, np.ndarray]:
        """Deviations from planes through the neighbours, scaled to the variance of a node.

        A matrix of shape (k, nodes), and the nodes of its rows: nodes with enough neighbours.
        """
        node, neighbour, step = self._neighbours
        count = len(self.points)
        wide = np.column_stack([np.ones(len(step)), step])
        squares = np.zeros((count, wide.shape[1], wide.shape[1]))
        np.add.at(squares, node, wide[:, :, None] * wide[:, None])
        inverse = np.linalg.pinv(squares, hermitian=True)[:, 0]
        weights = (inverse[node] * wide).sum(axis=1)
        table = scipy.sparse.csr_array((weights, (node, neighbour)), shape=(count, count))
        # A plane needs more neighbours than parameters, and not all of them on one line.
        total = np.asarray(table.sum(axis=1)).ravel()
        enough = np.bincount(node, minlength=count) > wide.shape[1]
        inside = np.flatnonzero(enough & (np.abs(total - 1) < CALCULATED**0.5))
        if not len(inside):
            raise GridError(
                f"sigma: expected points with more than {wide.shape[1]} neighbours, from which to "
                "estimate noise, got none. Give sigma as a number or an array."
            )
        rest = (scipy.sparse.eye_array(count, format="csr") - table)[inside].tocsr()
        size = np.sqrt(np.asarray(rest.power(2).sum(axis=1)).ravel())
        return (scipy.sparse.diags_array(1 / size) @ rest).tocsr(), inside


def checked_polygons(given: object) -> list[np.ndarray]:
    """Boundaries as a list of polygons; a single polygon may be given without a list."""
    if given is None:
        return []
    try:
        plain = np.ndim(np.asarray(given, dtype=float)) == 2
    except (TypeError, ValueError):
        plain = False
    listed = [given] if plain else checks.entries(given, "boundary", GridError)
    polygons = [numbers(polygon, "boundary") for polygon in listed]
    for polygon in polygons:
        if polygon.ndim != 2 or polygon.shape[1] != 2 or len(polygon) < 3:
            raise GridError(
                f"boundary: expected polygons of three corners or more, shape (k, 2), got shape "
                f"{polygon.shape}."
            )
        if not np.isfinite(polygon).all():
            raise GridError("boundary: expected polygons with finite corners, got infinity or NaN.")
    return polygons


def _inside(polygon: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Whether a ray to the right leaves a polygon an odd number of times, shape (k,)."""
    x, y = points.T
    mask = np.zeros(len(points), dtype=bool)
    for (x0, y0), (x1, y1) in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        crosses = (y0 > y) != (y1 > y)
        with np.errstate(divide="ignore", invalid="ignore"):
            mask ^= crosses & (x < x0 + (y - y0) / (y1 - y0) * (x1 - x0))
    return mask
