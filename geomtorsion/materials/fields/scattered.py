"""Scattered: a coframe or a displacement known at scattered points, such as tracked particles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Self

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.errors import GridError
from geomtorsion.loops import Cochain, Loop
from geomtorsion.loops.quadrature import ROUNDING
from geomtorsion.materials.burgers import PLANE, Burgers, Section
from geomtorsion.materials.columns import checked_columns
from geomtorsion.materials.fields.displacement import checked_height, raised
from geomtorsion.materials.fields.grid import numbers, two_axes
from geomtorsion.materials.fields.grid_circuits import unexplained
from geomtorsion.materials.fields.grid_files import read_scattered
from geomtorsion.materials.fields.missing import with_holes
from geomtorsion.materials.fields.noise import EdgeNoise, NodeNoise, noise_of
from geomtorsion.materials.fields.quantities import QUANTITIES, quantity
from geomtorsion.materials.fields.samples import strain_and_rotation
from geomtorsion.materials.fields.scattered_values import (
    check_finite,
    checked_points,
    edge_rules,
    estimated_noise,
    mesh_of,
    row_of_points,
    without_jumps,
)
from geomtorsion.materials.fields.triangulation import Triangulation
from geomtorsion.materials.source import Backdrop
from geomtorsion.materials.survey import Errors, Survey
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property

# A circuit along edges: {number of the edge: signed multiplicity}.
Chain = Mapping[int, int]


@dataclass(frozen=True, eq=False, repr=False)
class ScatteredFrame:
    """A coframe between scattered points in the plane or in space, joined by Delaunay edges.

    Make it with `from_coframe`, `from_distortion`, `from_strain_rotation` (values at the points) or
    `from_displacement`. Circuits run along edges. The integrals along edges are a cochain, whose
    coboundary is the Burgers vector of each triangle.

    mesh: points and triangles. cochain: integral of the coframe along each edge, with the error of
    the interpolation. difference: between the integrals and a second rule, an error estimate, shape
    (edges, rows). noise: of the integrals, or None. sigma_source: origin of the noise. order: 2 for
    trapezoids, 4 with slopes at the points, 0 without interpolation. unit: of points. vector_unit:
    of b (by default the same).

    Options of all makers: mask, True at unknown points (equivalent to NaN); longest, the largest
    length of an edge; boundary, polygons (only for plane points), where the region consists of the
    points inside an odd number of polygons; sigma and covariance, the noise of each value,
    independent for all points, or "estimate"; unit, vector_unit, source.

    Examples
    --------
    >>> import numpy as np
    >>> from geomtorsion.loops import Loop
    >>> x, y = points = np.random.default_rng(0).uniform(-1, 1, (2, 500))
    >>> twist = np.array([[-y, x]]) / 2            # e = (x dy - y dx) / 2: torsion 1
    >>> frame = ScatteredFrame.from_coframe(points.T, twist, mask=np.hypot(x, y) < 0.3, sigma=1e-3)
    >>> frame
    ScatteredFrame(500 points, 873 triangles, 1 row, 1 hole)
    >>> b = frame.burgers(frame.loop_around())
    >>> 0.28 < b.vector[0] < 0.6, round(b.noise, 4)
    (np.True_, 0.0005)
    >>> frame.burgers_map().density.round(9).min()
    np.float64(1.0)
    """

    mesh: Triangulation
    cochain: Cochain
    difference: np.ndarray
    noise: EdgeNoise | None
    order: int
    unit: str = ""
    vector_unit: str = ""
    source: str = ""
    sigma_source: str = ""

    # -- makers -----------------------------------------------------------------------------------

    @classmethod
    def from_coframe(
        cls,
        points: np.ndarray,
        coframe: np.ndarray,
        *,
        order: int = 4,
        sigma: Any = None,
        covariance: Any = None,
        **options: Any,
    ) -> Self:
        """Frame from values e^i_mu at the points.

        Parameters
        ----------
        points
            Coordinates, shape (N, d), d = 2 or 3.
        coframe
            Shape (rows, d, N); plane points may have all three columns.
        order
            4: trapezoids, corrected by the slopes of planes through neighbours; the error is the
            correction. 2: trapezoids without correction.
        options
            mask, longest, boundary, unit, vector_unit, source.

        Raises
        ------
        GridError
            Shapes do not fit, points are collinear or coincide, no triangle remains, or the noise
            is invalid.
        """
        places, values = checked_points(points), numbers(coframe, "coframe")
        count, d = places.shape
        columns = (d, 3) if d == 2 else (d,)
        if values.ndim != 3 or values.shape[1] not in columns or values.shape[2] != count:
            raise GridError(
                f"coframe: expected shape (rows, {d}, {count}) (frame index, coordinate index, "
                f"point), got {values.shape}."
            )
        checks.choice(order, (2, 4), "order", GridError)
        values = values[:, :d]
        mesh, texts = mesh_of(places, np.asarray(np.isnan(values).any(axis=(0, 1))), options)
        check_finite(values, "coframe", mesh)
        mean, steps = values[:, :, mesh.inner].mean(axis=-1), mesh.steps
        base = edge_rules(mesh)
        bent = np.where(np.isnan(values), 0.0, values - mean[:, :, None])
        chosen, other = base if order == 2 else base[::-1]

        def along(rule: scipy.sparse.csr_array) -> np.ndarray:
            edge_values = (rule @ bent.reshape(-1, count).T).reshape(-1, *mean.shape)
            return np.einsum("em,eim->ei", steps, edge_values)

        fine, less = along(chosen), along((chosen - other).tocsr())
        grid = row_of_points(~np.isin(np.arange(count), mesh.inner))
        if "estimate" in (str(sigma), str(covariance)):
            sigma, covariance, origin = estimated_noise(mesh, values, sigma, covariance)
            noise = noise_of(sigma, covariance, values, grid)[2]
        else:
            *_, noise, origin = noise_of(sigma, covariance, values, grid)
        edge_noise = None if noise is None else NodeNoise(noise, steps, chosen, chosen - other)
        edge_values = fine + steps @ mean.T
        errors = np.abs(less).max(axis=1) + ROUNDING * np.abs(edge_values).max(axis=1, initial=0.0)
        cochain = Cochain(mesh.complex, edge_values, errors)
        return cls(mesh, cochain, less, edge_noise, order, **texts, sigma_source=origin)

    @classmethod
    def from_distortion(cls, points: np.ndarray, distortion: np.ndarray, **options: Any) -> Self:
        """Frame from a distortion beta^i_mu = d_mu u^i, shape (rows, d, N): e = 1 + beta.

        The sign of u is as in `SampledFrame.from_distortion`; options as for `from_coframe`.
        """
        values = numbers(distortion, "distortion")
        if values.ndim != 3:
            raise GridError(
                f"distortion: expected shape (rows, columns, points), got {values.shape}."
            )
        return cls.from_coframe(points, values + np.eye(*values.shape[:2])[..., None], **options)

    @classmethod
    def from_strain_rotation(
        cls, points: np.ndarray, strain: np.ndarray, rotation: np.ndarray, **options: Any
    ) -> Self:
        """Frame from strains (n, n, N) and rotations; see `SampledFrame.from_strain_rotation`."""
        return cls.from_distortion(points, strain_and_rotation(strain, rotation), **options)

    @classmethod
    def read(
        cls,
        path: str | Path,
        *,
        missing: object = None,
        columns: Mapping[str, int | str] | None = None,
        **options: Any,
    ) -> Self:
        """Frame from the values in a table or a mesh; see `grid_files.read_scattered`.

        options: as for `from_displacement`, such as branch, or for `from_distortion`, by the
        columns. missing, columns: as for `SampledFrame.read`. `source` names the axes of the
        frame of a surface in space."""
        chosen = checked_columns(columns, quantity, GridError, QUANTITIES)
        points = read_scattered(checks.file_name(path), chosen)
        values, report = with_holes(points.values, points.values.shape[-1:], missing)
        places = np.column_stack([*points.places.values()])
        texts = {**points.options, "source": "; ".join(filter(None, (points.source, report)))}
        if points.height is not None:
            options["height"] = points.height
        make = getattr(cls, f"from_{points.form}")
        return make(places, values, **{key: text for key, text in texts.items() if text} | options)

    @classmethod
    def from_displacement(
        cls,
        points: np.ndarray,
        displacement: np.ndarray,
        *,
        branch: Any = None,
        sigma: Any = None,
        height: np.ndarray | None = None,
        **options: Any,
    ) -> Self:
        """Frame from displacements u^i at the points, shape (rows, N), with jumps.

        The integral along an edge is the difference of u minus the nearest lattice vector. Without
        a jump, the displacements of neighbours must differ by less than half of a lattice vector.
        There is no interpolation, and b is a sum of whole lattice vectors.

        Parameters
        ----------
        branch
            Lattice vectors, shape (k, rows), one vector, or one length for all axes.
        sigma
            Noise of u at each point: one number, shape (N,), or "estimate". Noise changes b only if
            it shifts a difference beyond half of a lattice vector. `noise` contains the chances of
            such errors. It is somewhat too large, because wrong jumps on both sides of a point
            cancel.
        height
            Third coordinate of points of a surface, see `SampledFrame.from_displacement`.
        options
            mask, longest, boundary, unit, vector_unit, source.

        Examples
        --------
        >>> import numpy as np
        >>> from geomtorsion.loops import Loop
        >>> x, y = points = np.random.default_rng(0).uniform(-3, 3, (2, 400))
        >>> u = np.arctan2(y, x)[None] / (2 * np.pi) * 0.286
        >>> frame = ScatteredFrame.from_displacement(points.T, u, branch=0.286, unit="nm")
        >>> b = frame.burgers(Loop.circle([0, 0], 2))
        >>> b.vector.round(12).tolist(), b.unit, b.error < 1e-12
        ([0.286], 'nm', True)
        """
        places, values = checked_points(points), numbers(displacement, "displacement")
        if values.ndim != 2 or values.shape[1] != len(places):
            raise GridError(
                f"displacement: expected shape (rows, {len(places)}), got {values.shape}."
            )
        heights = checked_height(height, values)
        raised_values = values if heights is None else raised(values, heights)
        mesh, texts = mesh_of(places, np.asarray(np.isnan(raised_values).any(axis=0)), options)
        check_finite(values[:, None], "displacement", mesh)
        rows, d, (a, b) = len(values), mesh.dimension, mesh.complex.pairs.T
        steps = (values[:, b] - values[:, a]).T
        steps, noise, origin = without_jumps(mesh, values, steps, branch, sigma)
        steps = steps + mesh.steps @ np.eye(rows, d).T
        steps[:, 2:] += 0.0 if heights is None else (heights[b] - heights[a])[:, None]
        errors = ROUNDING * np.abs(steps).max(axis=1, initial=0.0)
        cochain = Cochain(mesh.complex, steps, errors)
        return cls(mesh, cochain, np.zeros_like(steps), noise, 0, **texts, sigma_source=origin)

    # -- properties -------------------------------------------------------------------------------

    @property
    def points(self) -> np.ndarray:
        """Coordinates, shape (N, d)."""
        return self.mesh.points

    @property
    def rows(self) -> int:
        """Number of frame indices."""
        return self.cochain.values.shape[1]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the axes."""
        return tuple("xyz"[: self.mesh.dimension])

    @property
    def description(self) -> tuple[str, ...]:
        """Lines of text about the size, the noise and the source of the frame."""
        noise = self.sigma_source or "not known; the errors include only the interpolation error"
        source = (f"source: {self.source}",) if self.source else ()
        return (repr(self), f"noise: {noise}", *source)

    @cached_property
    def holes(self) -> tuple[np.ndarray, ...]:
        """Numbers of the points around each hole, for points in the plane.

        Raises
        ------
        GridError
            The points are in space.
        """
        self._plane("a hole")
        pairs = self.mesh.complex.pairs
        return tuple(np.unique(pairs[rim != 0]) for rim in self.mesh.rims)

    # -- circuits ---------------------------------------------------------------------------------

    def loop_around(self, hole: int | None = None, margin: int = 1) -> dict[int, int]:
        """The circuit around a hole, {edge: multiplicity}; see `burgers`.

        Parameters
        ----------
        hole
            Number of the hole in `holes`; optional if there is only one hole.
        margin
            1 for the rim of the hole; each increment adds a ring of triangles inside the circuit.

        Raises
        ------
        GridError
            There is no such hole, or the points are in space.
        """
        self._plane("a hole")
        rims, count = self.mesh.rims, len(self.mesh.rims)
        if not rims:
            raise GridError("the points have no holes. Use .burgers(loop) with any loop.")
        if hole is None and count > 1:
            raise GridError(
                f"hole: expected the number of one of {count} holes, got none. Give a number from "
                f"0 to {count - 1}."
            )
        number = 0 if hole is None else checks.count(hole, "hole", GridError, 0, count - 1)
        chain = self.mesh.around(rims[number], checks.count(margin, "margin", GridError, 1))
        return {int(k): int(chain[k]) for k in np.flatnonzero(chain)}

    def burgers(self, circuit: Loop | Chain | Sequence[int]) -> Burgers:
        """Burgers vector of a circuit, with its errors: interpolation and noise.

        Parameters
        ----------
        circuit
            A loop, which is replaced by the nearest points along it; numbers of points, each joined
            to the next; or {edge: multiplicity}, as returned by `loop_around`.

        Raises
        ------
        GridError
            The circuit touches a hole or leaves the region; the message names the points.
        NetworkError
            Points are not joined, or an edge does not exist.
        """
        if isinstance(circuit, Mapping):
            table = self._chains(circuit)
            if np.any(table @ self.mesh.complex.boundary(0)):
                raise GridError(
                    "circuit: expected a closed chain of edges, got an open one. Add the missing "
                    "edges."
                )
        else:
            nodes = circuit
            if isinstance(circuit, Loop):
                nodes = self.mesh.walk(circuit)
            entries = checks.entries(nodes, "circuit", GridError)
            at = np.array([self.mesh.complex.number(node) for node in entries], dtype=np.int64)
            if len(at) < 3:
                raise GridError(f"circuit: expected three points or more, got {entries}.")
            ends = np.roll(at, -1)
            edges, senses = self.mesh.complex.steps(at[at != ends], ends[at != ends])
            table = np.zeros((1, len(self.difference)), dtype=np.int64)
            np.add.at(table[0], edges, senses)
        chains = scipy.sparse.csr_array(table)
        vectors, errors = chains @ self.cochain.values, self._errors(chains)
        rounding = ROUNDING * float((np.abs(table) @ np.abs(self.cochain.values)).max())
        covariance = np.zeros((self.rows, self.rows))
        for (i, j), c in errors.covariance.items():
            covariance[i, j] = covariance[j, i] = np.ravel(c)[0]
        ends = self.points[self.mesh.complex.pairs[table[0] != 0]]
        times = table[0, table[0] != 0]
        moments = np.einsum("k,km,kn->mn", times, ends[:, 0], ends[:, 1])
        section = Section.of(ends.reshape(-1, self.mesh.dimension).T, moments - moments.T)
        plane = list(section.plane)
        gaps = np.full((len(ends), 1, 2), np.nan)
        return Burgers(
            vectors[0],
            self.vector_unit or self.unit,
            covariance,
            {"interpolation": float(errors.systematic[0]), "rounding": rounding},
            name=(circuit.name if isinstance(circuit, Loop) else "") or "circuit",
            path=np.concatenate([ends[:, :, plane], gaps], axis=1).reshape(-1, 2).T,
            area=float((moments - moments.T)[section.plane] / 2),
            arrow=vectors[0, plane] if self.rows > max(plane) else None,
            section=section,
            length_unit=self.unit,
        )

    def burgers_map(self, rings: int = 0, plane: tuple[int, int] = (0, 1)) -> Survey:
        """Burgers vectors of all triangles, or of circuits with rings of triangles at all points.

        In space, the triangles are the faces of the tetrahedra. The order of the corners in
        `mesh.complex` gives the normal of each.

        Parameters
        ----------
        rings
            Number of rings of triangles around each point; 0 for single triangles.
        plane
            Two axes, for figures and tables.

        Raises
        ------
        GridError
            The number of rings is invalid, or it is not 0 for points in space.

        Examples
        --------
        >>> import numpy as np
        >>> points = np.random.default_rng(0).uniform(-1, 1, (300, 2))
        >>> twist = np.array([[-points[:, 1], points[:, 0]]]) / 2
        >>> found = ScatteredFrame.from_coframe(points, twist).burgers_map(rings=2)
        >>> found, found.density.round(9).max()
        (Survey(300 circuits of 2 rings of triangles), np.float64(1.0))
        """
        two_axes(plane, self.mesh.dimension)
        faces = self.mesh.complex.boundary(1)
        if checks.count(rings, "rings", GridError) == 0:
            chains, places = faces, self.points[self.mesh.corners].mean(axis=1)
            areas = self.mesh.areas
        else:
            self._plane("a ring")
            stars = self.mesh.stars(rings)
            chains, places = (stars @ faces).tocsr(), self.points[self.mesh.inner]
            areas = stars @ self.mesh.areas
        return Survey(
            (chains @ self.cochain.values).T,
            tuple(places.T),
            areas,
            (rings,),
            partial(self._errors, chains),
            self.names,
            (plane[0], plane[1]),
            unit=self.unit,
            vector_unit=self.vector_unit or self.unit,
        )

    def backdrop(self, section: Section = PLANE) -> Backdrop:
        """|b| per area of each triangle; in space, of triangles within an edge of the section."""
        survey = self.burgers_map(0, section.plane)
        places = np.array(survey.centres)
        others = [k for k in range(self.mesh.dimension) if k not in section.plane]
        at = np.array(section.at or [float(self.points[:, k].mean()) for k in others])
        length = float(np.median(np.linalg.norm(self.mesh.steps, axis=1)))
        near = (np.abs(places[others] - at.reshape(-1, 1)) <= length).all(axis=0)
        one, two = (line[near] for line in survey.lines)
        unit = f" ({survey.density_unit})" if survey.density_unit else ""
        return Backdrop((one, two), survey.per_area[near], "points", f"|b| per area{unit}")

    def _errors(self, chains: scipy.sparse.csr_array) -> Errors:
        """Errors of sums along chains, shape (k, edges)."""
        less = np.abs(chains @ self.difference)
        covariance = {}
        if self.noise is not None:
            table, rows = self.noise.covariance(chains), range(self.rows)
            covariance = {(i, j): table[:, i, j] for i in rows for j in rows[i:]}
            less = unexplained(less, self.noise.difference(chains))
        # Edges are irregular. Their errors may cancel in a sum by chance, which must not reduce
        # the estimated error below the root of the sum of squares.
        alone = np.maximum(chains.power(2) @ self._squares, 0.0)
        less = np.sqrt(np.maximum(less**2, alone))
        safety = 4 / 3 if self.order == 2 else 1.0
        return Errors(covariance, safety * less.max(axis=1))

    @cached_property
    def _squares(self) -> np.ndarray:
        """Squares of the differences of single edges, minus the part from noise, (edges, rows)."""
        if self.noise is None:
            return self.difference**2
        single = scipy.sparse.eye_array(len(self.difference), format="csr", dtype=np.int64)
        return self.difference**2 - self.noise.difference(single)

    def _chains(self, chain: Chain) -> np.ndarray:
        """A chain as multiples of all edges, shape (1, edges)."""
        table = np.zeros((1, len(self.difference)), dtype=np.int64)
        for edge, times in chain.items():
            number = checks.count(edge, "edge", GridError, 0, table.shape[1] - 1)
            sign = 1 if checks.number(times, f"circuit[{edge}]", GridError) >= 0 else -1
            table[0, number] = sign * checks.count(abs(times), f"circuit[{edge}]", GridError)
        return table

    def _plane(self, what: str) -> None:
        """Refuse points in space."""
        if self.mesh.dimension != 2:
            raise GridError(
                f"{what}: expected points in a plane, got points in space, where no single circuit "
                "surrounds it. Give .burgers a loop, or numbers of points."
            )

    def __repr__(self) -> str:
        count, mesh = len(self.points), self.mesh
        cells = int(mesh.kept.sum())
        kind = "triangles" if mesh.dimension == 2 else "tetrahedra"
        parts = [f"{count} points", f"{cells} {kind}", f"{self.rows} row{'s' * (self.rows != 1)}"]
        if mesh.dimension == 2 and mesh.rims:
            parts.append(f"{len(mesh.rims)} hole{'s' * (len(mesh.rims) > 1)}")
        if self.unit:
            other = self.vector_unit or self.unit
            parts.append(f"in {self.unit}" + (f", b in {other}" if other != self.unit else ""))
        return f"ScatteredFrame({', '.join(parts)})"
