"""Node rule: over the faces of a closed cell Burgers vectors sum to zero; where they do not."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy  # loads its parts on first use

from geomtorsion.errors import LimitError, NetworkError
from geomtorsion.loops.arcs import shown
from geomtorsion.loops.cochain import Cochain
from geomtorsion.loops.complexes import Complex, sides_of
from geomtorsion.loops.edges import EdgeList
from geomtorsion.loops.forms import Forms
from geomtorsion.loops.integrals import DISAGREE
from geomtorsion.loops.quadrature import (
    LEVELS,
    MOST_POINTS,
    PIECE,
    ROUNDING,
    gauss_rule,
    ray_rule,
    refined,
)
from geomtorsion.support.outgoing import size_text

Face = tuple[Hashable, ...]
Cell = tuple[Face, ...]
# Nodes of faces: triangles as an array, others one by one.
Corners = Sequence[np.ndarray] | np.ndarray
# Each triangle and tetrahedron needs some ten points.
MOST_CELLS = MOST_POINTS // 8


@dataclass(frozen=True, eq=False)
class Violation:
    """A cell whose fluxes do not sum to zero.

    cell: its faces; total: what they sum to, shape (n,); error: bound on its largest component.
    """

    cell: tuple[Face, ...]
    total: np.ndarray
    error: float

    def __str__(self) -> str:
        nodes = sorted({node for face in self.cell for node in face}, key=str)
        return f"cell {nodes}: sum of b = {shown(self.total)}, error {size_text(self.error)}"


@dataclass(frozen=True, eq=False)
class NodeRule:
    """Check that torsion lines do not end inside a cell.

    checked: number of checked cells.
    violations: cells in which the flux of torsion out of all faces is not zero (a line ends
        there, or the frame is not smooth inside), or whose line integrals do not cancel.
    pierced: faces whose line integral is not the flux of torsion through them: a singular line
        runs through, with the difference as its Burgers vector.
    """

    checked: int
    violations: tuple[Violation, ...]
    pierced: tuple[tuple[Face, np.ndarray], ...]

    @property
    def holds(self) -> bool | None:
        """True, False, or None if there is no cell."""
        return None if not self.checked else not self.violations

    def __str__(self) -> str:
        lines = [f"node rule: {self.checked} cells checked, {len(self.violations)} violations"]
        lines += [str(violation) for violation in self.violations[:10]]
        lines += [f"face {list(f)}: pierced, b = {shown(b)}" for f, b in self.pierced[:10]]
        return "\n".join(lines)


def node_rule(
    forms: Forms,
    edges: EdgeList,
    along: Cochain,
    cells: Sequence[Sequence[Sequence[Hashable]]] | None,
    accuracy: float,
) -> NodeRule:
    """Check all cells of a network; see Network.node_rule."""
    complex_, corners = _of_tetrahedra(edges) if cells is None else _of_cells(edges.complex, cells)
    if complex_.cells is None:
        return NodeRule(0, (), ())
    lines = replace(along, complex=complex_).coboundary()
    fluxes, errors = _fluxes(forms, edges.positions, corners, accuracy)
    flux = Cochain(complex_, fluxes, np.where(np.isfinite(errors), errors, 0.0), degree=2)
    unknown = abs(complex_.cells) @ ~np.isfinite(errors) > 0
    failures: list[tuple[int, Violation]] = []
    for total, free in ((lines.coboundary(), False), (flux.coboundary(), unknown)):
        wrong = np.abs(total.values).max(axis=1) > DISAGREE * total.bounds
        for k in np.flatnonzero(wrong & ~np.asarray(free)).tolist():
            cell = _faces_of(edges, complex_, corners, k) if cells is None else _named(cells[k])
            failures.append((k, Violation(cell, total.values[k], float(total.bounds[k]))))
    difference = lines.values - fluxes
    wrong = ~(np.abs(difference).max(axis=1) <= DISAGREE * (errors + lines.bounds))
    pierced = [(_labels(edges, corners[k]), difference[k]) for k in np.flatnonzero(wrong).tolist()]
    failures.sort(key=lambda pair: pair[0])
    return NodeRule(len(total.values), tuple(one for _, one in failures), tuple(pierced))


def _labels(edges: EdgeList, nodes: Sequence[int] | np.ndarray) -> Face:
    """What the nodes of a face are called."""
    return tuple(edges.labels[int(node)] for node in nodes)


def _faces_of(edges: EdgeList, made: Complex, corners: Corners, cell: int) -> Cell:
    """The faces of a cell, turned outwards."""
    assert made.cells is not None
    row = made.cells[[cell]]
    sides = [corners[k][::sign] for k, sign in zip(row.indices, row.data, strict=True)]
    return tuple(_labels(edges, side) for side in sides)


def _named(cell: Sequence[Sequence[Hashable]]) -> Cell:
    """A cell as it was given."""
    return tuple(map(tuple, cell))


# -- cells ----------------------------------------------------------------------------------------


def _of_tetrahedra(edges: EdgeList) -> tuple[Complex, np.ndarray]:
    """All sets of four nodes that are joined pairwise, and the corners of their faces, (m, 3)."""
    plain = edges.complex
    quadruples = tetrahedra(plain)
    if not len(quadruples):
        return plain, np.zeros((0, 3), dtype=np.int64)
    places = edges.positions[quadruples]
    if places.shape[2] == 3:
        # Only three dimensions have an outside; elsewhere one sense is as good.
        turned = np.linalg.det(places[:, 1:] - places[:, :1]) < 0
        quadruples[turned, 2], quadruples[turned, 3] = quadruples[turned, 3], quadruples[turned, 2]
    corners, cells = sides_of(quadruples)
    # Each face is shown as its first cell has it: outwards.
    columns = cells.tocsc()
    sense = columns.data[columns.indptr[:-1]]
    corners[sense < 0] = corners[sense < 0][:, ::-1]
    cells.data *= sense[cells.indices]
    return replace(plain.with_faces(corners), cells=cells), corners


def tetrahedra(complex: Complex) -> np.ndarray:
    """All sets of four nodes that are joined pairwise, ascending, shape (cells, 4).

    Raises
    ------
    LimitError
        There are too many: their fluxes would take hours.
    """
    low, high, start = complex.neighbours
    cliques = np.stack([low, high], axis=1)
    for _ in range(2):
        grown = [np.zeros((0, cliques.shape[1] + 1), dtype=np.int64)]
        more = start[cliques[:, -1] + 1] - start[cliques[:, -1]]
        ends = np.cumsum(more)
        size = 0
        for first, last in _blocks(ends):
            counts = more[first:last]
            owner = np.repeat(np.arange(first, last), counts)
            offset = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
            new = high[start[cliques[owner, -1]] + offset]
            for column in range(cliques.shape[1] - 1):
                fits = complex.joins(cliques[owner, column], new)
                owner, new = owner[fits], new[fits]
            grown.append(np.column_stack([cliques[owner], new]))
            size += len(new)
            if size > MOST_CELLS:
                raise LimitError(
                    f"more than {MOST_CELLS} triangles or tetrahedra are in the network. "
                    "Give the cells that shall be checked."
                )
        cliques = np.concatenate(grown)
    return cliques


def _blocks(ends: np.ndarray) -> Iterator[tuple[int, int]]:
    """Ranges of entries whose candidates fit in memory."""
    first = 0
    while first < len(ends):
        begun = ends[first - 1] if first else 0
        last = max(first + 1, int(np.searchsorted(ends, begun + MOST_CELLS // 4, "right")))
        yield first, last
        first = last


def _of_cells(
    plain: Complex, cells: Sequence[Sequence[Sequence[Hashable]]]
) -> tuple[Complex, list[np.ndarray]]:
    """Given cells, and the corners of their faces, each once."""
    face_numbers: dict[frozenset[Hashable], int] = {}
    faces: list[Face] = []
    rows, columns, senses = [], [], []
    for k, cell in enumerate(cells):
        every = _named(cell)
        _check_closed(every)
        for face in every:
            number = face_numbers.setdefault(frozenset(face), len(faces))
            if number == len(faces):
                faces.append(face)
            rows.append(k)
            columns.append(number)
            senses.append(_sense(face, faces[number]))
    corners = [np.array([plain.number(node) for node in face]) for face in faces]
    if not rows:
        return plain, corners
    table = scipy.sparse.csr_array((senses, (rows, columns)), shape=(len(cells), len(faces)))
    return replace(plain.with_faces(faces), cells=table), corners


def _check_closed(cell: Cell) -> None:
    """Refuse a surface with a boundary: each edge must be run through once in each sense."""
    count: dict[tuple[Hashable, Hashable], int] = {}
    for face in cell:
        for a, b in zip(face, (*face[1:], face[0]), strict=True):
            count[a, b] = count.get((a, b), 0) + 1
            count[b, a] = count.get((b, a), 0) - 1
    open_ = [edge for edge, number in count.items() if number > 0]
    if open_:
        raise NetworkError(
            f"the cell {[list(face) for face in cell]} is not closed: the edge {open_[0]} bounds "
            "it. Every edge must be run through once in each sense."
        )


def _sense(face: Face, other: Face) -> int:
    """+1 if two faces of the same nodes turn the same way, -1 if not."""
    start = other.index(face[0])
    return 1 if other[(start + 1) % len(other)] == face[1] else -1


# -- fluxes ---------------------------------------------------------------------------------------


def _fluxes(
    forms: Forms, places: np.ndarray, corners: Corners, accuracy: float
) -> tuple[np.ndarray, np.ndarray]:
    """Flux of torsion through faces, each spanned from its first node, (m, n), and errors, (m,)."""
    count, n = len(corners), places.shape[1]
    if isinstance(corners, np.ndarray):
        owner, triples = np.arange(count), corners
    else:
        owner = np.repeat(np.arange(count), [len(face) - 2 for face in corners])
        fans = [(f[0], f[k], f[k + 1]) for f in corners for k in range(1, len(f) - 1)]
        triples = np.array(fans, dtype=np.int64).reshape(-1, 3)
    totals, bounds = np.zeros((count, n)), np.zeros(count)
    # As many as fit in the cache, with some 16 points each.
    for start in range(0, len(triples), PIECE // 16):
        part = slice(start, start + PIECE // 16)
        values, errors = _triangles(forms, places[triples[part]].transpose(1, 2, 0), accuracy)
        np.add.at(totals, owner[part], values.T)
        np.add.at(bounds, owner[part], errors)
    return totals, bounds


def _triangles(forms: Forms, corners: np.ndarray, accuracy: float) -> tuple[np.ndarray, np.ndarray]:
    """Fluxes through triangles, corners of shape (3, n, k), by rules of rising level.

    A triangle on which the torsion is not finite has an infinite error.
    """
    a, first, second = corners[0], corners[1] - corners[0], corners[2] - corners[1]
    n, count = a.shape
    form = forms.curl
    if form is None:
        return np.zeros((n, count)), np.zeros(count)
    m, k = forms.pairs
    area = (first[m] * second[k] - first[k] * second[m])[form.columns]

    def flux(level: int, which: np.ndarray) -> np.ndarray:
        (s, w), (t, u) = ray_rule(2 * level + 3), gauss_rule(2 * level + 3)
        one = s[:, None] * np.ones_like(t)
        two = s[:, None] * t
        points = (x[:, which, None] for x in (a, first, second))
        start, along, across = points
        at = start + along * one.ravel() + across * two.ravel()
        values = form.values(at.reshape(n, -1)).reshape(len(area), len(which), -1)
        return form.gather @ (values @ np.outer(w, u).ravel() * area[:, which])

    with np.errstate(all="ignore"):
        begun = [flux(level, np.arange(count)) for level in (0, 1)]
        # No finer than the line integrals with which they are compared.
        fluxes = refined(begun, flux, max(accuracy, DISAGREE * ROUNDING), np.zeros(count), LEVELS)
    bad = ~np.isfinite(fluxes.values).all(axis=0)
    values = np.where(bad, 0.0, fluxes.values)
    return values, np.where(bad, np.inf, fluxes.truncation) + ROUNDING * np.abs(values).max(axis=0)
