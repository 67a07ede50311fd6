"""Torsion: the coboundary of bond labels, and the shortest lines that carry it.

A label that noise has turned into a neighbouring lattice vector puts a ring of torsion around its
bond. Other labels inside a core are as good as long as no circuit on its surface changes. The ones
with the least energy b^2 are taken, which leaves no rings and makes dislocations straight lines.
No label of a bond that reaches out of a core is changed, so that Burgers vectors stay.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy  # loads its parts on first use

from geomtorsion.materials.crystals.lattices import Lattice
from geomtorsion.materials.crystals.method import METHOD
from geomtorsion.materials.crystals.triangulation import Triangulation

# Boundary of a face with its edges (ij, ik, jk).
BOUNDARY = np.array([1, -1, 1])


@dataclass(frozen=True, eq=False)
class Torsion:
    """Labels on the edges of a triangulation and their closure failure around each face.

    labels: lattice vectors, whole numbers, shape (edges, 3).
    doubtful: edges further from their label than half the neighbour distance, (edges,).
    """

    mesh: Triangulation
    lattice: Lattice
    labels: np.ndarray
    doubtful: np.ndarray

    @property
    def values(self) -> np.ndarray:
        """T = de: closure failure of each face, shape (faces, 3)."""
        rows = self.mesh.faces[0]
        return self.labels[rows[:, 0]] - self.labels[rows[:, 1]] + self.labels[rows[:, 2]]

    @property
    def beyond(self) -> np.ndarray:
        """Atoms with torsion where not all tetrahedra are known, shape (atoms,)."""
        complete, (pairs, _, _) = self.mesh.known, self.mesh.edges
        rows = self.mesh.faces[0]
        corners = pairs[rows].reshape(len(rows), 6)
        chosen = self.values.any(axis=1) & ~complete[corners].any(axis=1)
        mask = np.zeros(len(complete), dtype=bool)
        mask[corners[chosen].ravel()] = True
        return mask

    @property
    def leading_on(self) -> np.ndarray:
        """Atoms around which all tetrahedra are also needed, shape (atoms,).

        Cores reach as far as the neighbours of torn tetrahedra where not all are known.
        """
        beyond, corners = self.beyond, self.mesh.corners
        mask = np.zeros(len(beyond), dtype=bool)
        if beyond.any():
            mask[corners[beyond[corners].any(axis=1)].ravel()] = True
        return mask & ~self.mesh.known

    @property
    def torn(self) -> np.ndarray:
        """Tetrahedra with torsion in a face, shape (cells,) of truth values."""
        _, sides, _ = self.mesh.faces
        mask = np.zeros(len(self.mesh.corners), dtype=bool)
        touched = sides[self.values.any(axis=1)].ravel()
        mask[touched[touched >= 0]] = True
        return mask

    def relaxed(self) -> Torsion:
        """The same torsion on the shortest lines, up to parts that close on the surfaces of cores.

        Cores are first the torn or doubtful tetrahedra; then all tetrahedra with an atom in common
        with the remaining torsion. A ring that no circuit outside its own atoms detects is a
        point defect.
        """
        if not self.torn.any():
            return self
        lengths = self.lengths
        core = self.cores(self.bad)
        torsion = self.descended(core).shortest(core, lengths)
        return torsion.shortest(torsion.cores(torsion.touched), lengths)

    @property
    def bad(self) -> np.ndarray:
        """Tetrahedra with torsion in a face or a doubtful edge, shape (cells,)."""
        return self.torn | np.any(self.doubtful[self.mesh.edges[2]], axis=1)

    @property
    def touched(self) -> np.ndarray:
        """Tetrahedra with an atom in common with one with torsion, shape (cells,)."""
        return np.any(self.torn_atoms[self.mesh.corners], axis=1)

    @property
    def torn_atoms(self) -> np.ndarray:
        """Corners of tetrahedra with torsion, shape (atoms,)."""
        mask = np.zeros(len(self.mesh.places), dtype=bool)
        mask[self.mesh.corners[self.torn].ravel()] = True
        return mask

    @property
    def lengths(self) -> Lengths:
        """Lengths of the lines from cell to cell through each face."""
        rows, sides, images = self.mesh.faces
        a, b = sides.T
        steps = self.mesh.centres[b] - self.mesh.centres[a] + self.mesh.cell.shifts(images)
        sizes = np.where((sides < 0).any(axis=1), 0.0, np.linalg.norm(steps, axis=1))
        sound = ~(np.any(self.values, axis=1) | np.any(self.doubtful[rows], axis=1))
        return Lengths(sizes, sound)

    def cores(self, bad: np.ndarray) -> np.ndarray:
        """The core of each tetrahedron, -1 where there is none, shape (cells,).

        A core consists of bad tetrahedra that are connected by faces, with torsion in them.
        """
        _, sides, _ = self.mesh.faces
        inner_faces = (sides >= 0).all(axis=1) & bad[sides].all(axis=1)
        number = components(len(bad), sides[inner_faces])
        real = np.zeros(number.max(initial=-1) + 1, dtype=bool)
        real[number[self.torn]] = True
        return np.where(bad & real[number], number, -1)

    def free(self, core: np.ndarray) -> np.ndarray:
        """Edges inside of one core, shape (edges,)."""
        of_cell = self.mesh.edges[2]
        owner = np.full(len(self.labels), -1)
        owner[of_cell] = core[:, None]
        mask = owner >= 0
        # One tetrahedron suffices to exclude an edge in two cores, or in the surface of one.
        mask[of_cell[owner[of_cell] != core[:, None]]] = False
        # Other edges do not have all their tetrahedra here.
        return mask & self.mesh.known[self.mesh.edges[0]].any(axis=1)

    def descended(self, core: np.ndarray) -> Torsion:
        """The torsion reduced in cores: most effects of noise are undone, one bond at a time."""
        rows, free, labels = self.mesh.faces[0], self.free(core), self.labels.copy()
        _descend(labels, rows[free[rows].any(axis=1)], free, self.lattice)
        return replace(self, labels=labels)

    def shortest(self, core: np.ndarray, lengths: Lengths) -> Torsion:
        """Labels of free edges with the shortest lines, by a linear program for each core.

        Torsion in each direction of a basis is as long as the faces that it runs through; the
        matrix of boundaries makes the best solution whole. A vector outside the basis counts as
        several that may part: the basis consists of the vectors that most faces carry.
        """
        rows, sides, _ = self.mesh.faces
        values, free = self.values, self.free(core)
        torn = np.any(values, axis=1)
        touched = np.unique(core[sides[torn]].ravel())
        touched = touched[touched >= 0]
        labels = self.labels.copy()
        inside = free[rows].any(axis=1)
        of_face = np.where(sides[:, 0] >= 0, core[sides[:, 0]], core[sides[:, 1]])
        behind = np.where(sides[:, 1] >= 0, core[sides[:, 1]], of_face)
        of_face = np.maximum(of_face, behind)
        order = np.flatnonzero(inside & np.isin(of_face, touched))
        order = order[np.argsort(of_face[order], kind="stable")]
        breaks = np.flatnonzero(np.diff(of_face[order])) + 1
        for mine in np.split(order, breaks):
            if not torn[mine].any():
                continue
            weights = lengths.weights(mine)
            change = _program(values[mine], rows[mine], free, weights, self.lattice)
            if change is not None:
                labels[change[0]] -= change[1]
        return replace(self, labels=labels)


@dataclass(frozen=True, eq=False)
class Lengths:
    """Lengths of lines through each face.

    sizes: from the centre of one tetrahedron to the next, coordinates; 0 at a surface, (faces,).
    sound: faces without torsion or doubt, shape (faces,).
    """

    sizes: np.ndarray
    sound: np.ndarray

    def weights(self, faces: np.ndarray) -> np.ndarray:
        """Weights of lines through the faces of one core, with a mean of 1, shape (k,)."""
        sizes = self.sizes[faces]
        inner = sizes > 0
        mean = sizes[inner].mean() if inner.any() else 1.0
        # Slivers have no length at all: a share of the mean keeps lines from moving back and forth.
        return (sizes / mean + 0.1) * np.where(self.sound[faces], METHOD.sound, 1.0)


@dataclass(frozen=True, eq=False)
class TornFaces:
    """Faces with torsion, in the order of their atoms.

    cells: the tetrahedra at both sides, 4 atoms and 12 images, -1 where there is none, (n, 2, 16).
    centres: of these, shape (n, 2, 3). images: of the second relative to the first, (n, 3).
    values: torsion, whole numbers, shape (n, 3).
    """

    cells: np.ndarray
    centres: np.ndarray
    images: np.ndarray
    values: np.ndarray

    @classmethod
    def of(cls, torsion: Torsion, numbers: np.ndarray) -> TornFaces:
        """Torn faces of a torsion on atoms with these numbers, increasing."""
        mesh, values = torsion.mesh, torsion.values
        _, sides, images = mesh.faces
        torn = np.flatnonzero(values.any(axis=1) & (sides >= 0).any(axis=1))
        cells = sides[torn]
        offsets = mesh.offsets[cells].reshape(len(torn), 2, 12)
        there = np.concatenate([numbers[mesh.corners[cells]], offsets], axis=2)
        return cls(
            np.where(cells[..., None] < 0, -1, there), mesh.centres[cells], images[torn],
            values[torn],
        )  # fmt: skip


def components(count: int, pairs: np.ndarray) -> np.ndarray:
    """Number of the connected component of each of so many nodes."""
    # Keys of both ends in one number need 64 bits: scipy keeps rows and columns apart.
    table = scipy.sparse.coo_array(
        (np.ones(len(pairs), dtype=np.int8), (pairs[:, 0], pairs[:, 1])), shape=(count, count)
    )
    return scipy.sparse.csgraph.connected_components(table, directed=False)[1].astype(np.int64)


def _program(
    values: np.ndarray, rows: np.ndarray, free: np.ndarray, weights: np.ndarray, lattice: Lattice
) -> tuple[np.ndarray, np.ndarray] | None:
    """Free edges and what to subtract from their labels for the shortest lines of one core."""
    vectors = lattice.basis_of(values)
    parts = np.rint(values @ np.linalg.inv(vectors))
    edges, local = np.unique(rows, return_inverse=True)
    local = local.reshape(rows.shape)
    use = free[edges]
    number = np.cumsum(use) - 1
    face, side = np.nonzero(use[local])
    count, many = int(use.sum()), len(rows)
    matrix = scipy.sparse.coo_array(
        (BOUNDARY[side].astype(float), (face, number[local[face, side]])), shape=(many, count)
    )
    identity = scipy.sparse.eye_array(many)
    table = scipy.sparse.hstack([matrix, identity, -identity]).tocsc()
    cost = np.concatenate([np.zeros(count), weights, weights])
    bounds = np.array([(-np.inf, np.inf)] * count + [(0, np.inf)] * (2 * many))
    solution = np.zeros((count, 3))
    for k in range(3):
        if not parts[:, k].any():
            continue
        done = scipy.optimize.linprog(cost, A_eq=table, b_eq=parts[:, k], bounds=bounds)
        if done.status != 0:
            return None
        solution[:, k] = done.x[:count]
    whole = np.rint(solution)
    after = parts - matrix @ whole
    if (weights @ np.abs(after)).sum() >= (weights @ np.abs(parts)).sum() - 1e-9:
        return None
    return edges[use], (whole @ vectors).astype(np.int64)


def _descend(labels: np.ndarray, faces: np.ndarray, free: np.ndarray, lattice: Lattice) -> None:
    """Change labels of free edges while the sum of squares of torsion falls.

    Changing one by d changes the sum by n d^2 - 2 d.S, with S the torsion of its n faces along the
    edge: the best d is the lattice vector nearest to S/n. Edges without a common face change
    together.
    """
    scale = np.array(lattice.units) ** 2
    used, local = np.unique(faces, return_inverse=True)
    local = local.reshape(faces.shape)
    open_edge = free[used]
    values = labels[used]
    degree = np.bincount(local.ravel(), minlength=len(used))
    while True:
        torsion = values[local[:, 0]] - values[local[:, 1]] + values[local[:, 2]]
        torn = np.flatnonzero(torsion.any(axis=1))
        near = np.unique(local[torn])
        near = near[open_edge[near]]
        if not len(near):
            break
        total = np.zeros((len(used), 3))
        for k in range(3):
            np.add.at(total, local[torn, k], BOUNDARY[k] * torsion[torn])
        change = lattice.decode(total[near] / degree[near, None])
        gain = 2 * (change * total[near] * scale).sum(axis=1)
        gain -= degree[near] * (change**2 * scale).sum(axis=1)
        good = gain > 1e-9
        if not good.any():
            break
        near, change, gain = near[good], change[good], gain[good]
        # The best edge of each face is changed first; its number decides between equals.
        rank = np.empty(len(near), dtype=np.int64)
        rank[np.lexsort((near, gain))] = np.arange(1, len(near) + 1)
        of_edge = np.zeros(len(used), dtype=np.int64)
        of_edge[near] = rank
        best = of_edge[local].max(axis=1)
        beaten = np.zeros(len(used), dtype=bool)
        for k in range(3):
            beaten[local[of_edge[local[:, k]] < best, k]] = True
        chosen = ~beaten[near]
        values[near[chosen]] -= change[chosen]
    labels[used] = values
