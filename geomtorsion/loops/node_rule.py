"""Node rule: over the faces of a closed cell Burgers vectors sum to zero; where they do not."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.errors import LimitError, NetworkError
from geomtorsion.loops.arcs import shown
from geomtorsion.loops.forms import Forms, forms
from geomtorsion.loops.integrals import DISAGREE
from geomtorsion.loops.quadrature import LEVELS, PIECE, ROUNDING, gauss_rule, ray_rule, refined

if TYPE_CHECKING:
    from geomtorsion.loops.network import Network

Face = tuple[Hashable, ...]
# More cells than this are not searched for, nor more cycles listed: there are arrays for them.
MOST_LISTED = 100_000


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
        return f"cell {nodes}: sum of b = {shown(self.total)}, error {self.error:.1e}"


@dataclass(frozen=True, eq=False)
class NodeRule:
    """Whether lines of torsion are conserved in every cell.

    checked: number of cells; 0 says that nothing was checked.
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
        """True, False, or None where there was no cell to check."""
        return None if not self.checked else not self.violations

    def __str__(self) -> str:
        lines = [f"node rule: {self.checked} cells checked, {len(self.violations)} violations"]
        lines += [str(violation) for violation in self.violations[:10]]
        lines += [f"face {list(f)}: pierced, b = {shown(b)}" for f, b in self.pierced[:10]]
        return "\n".join(lines)


def node_rule(net: Network, cells: Sequence[Sequence[Sequence[Hashable]]] | None) -> NodeRule:
    """Check all cells of a network; see Network.node_rule."""
    chosen = tetrahedra(net) if cells is None else [tuple(map(tuple, cell)) for cell in cells]
    for cell in chosen:
        _check_closed(cell)
    faces = {_named(face): face for cell in chosen for face in cell}
    lines = {name: net.burgers(face) for name, face in faces.items()}
    fluxes = _fluxes(net, list(faces.values()))
    violations = []
    for cell in chosen:
        rows, errors = [], []
        for face in cell:
            name = _named(face)
            flux, error = fluxes[name]
            same = _sense(face, faces[name])
            rows.append((same * lines[name].vector, same * flux))
            errors.append((lines[name].error, error))
        for totals, bound in zip(np.sum(rows, axis=0), np.sum(errors, axis=0), strict=True):
            if not np.abs(totals).max() <= DISAGREE * bound:
                violations.append(Violation(cell, totals, float(bound)))
    pierced = []
    for name, face in faces.items():
        flux, error = fluxes[name]
        difference = lines[name].vector - flux
        if not np.abs(difference).max() <= DISAGREE * (error + lines[name].error):
            pierced.append((face, difference))
    return NodeRule(len(chosen), tuple(violations), tuple(pierced))


def tetrahedra(net: Network) -> list[tuple[Face, ...]]:
    """All sets of four nodes that are joined pairwise, with faces turned outwards."""
    neighbours: dict[int, set[int]] = {}
    for a, b in net.edges.pairs.tolist():
        neighbours.setdefault(a, set()).add(b)
        neighbours.setdefault(b, set()).add(a)
    labels, found = net.edges.labels, []
    for a in neighbours:
        for b in (x for x in neighbours[a] if x > a):
            for c in (x for x in neighbours[a] & neighbours[b] if x > b):
                for d in (x for x in neighbours[a] & neighbours[b] & neighbours[c] if x > c):
                    corners = net.edges.positions[[a, b, c, d]]
                    # Only three dimensions have an outside; elsewhere one sense is as good.
                    steps = corners[1:] - corners[0]
                    turned = steps.shape[1] == 3 and np.linalg.det(steps) < 0
                    e, f = (d, c) if turned else (c, d)
                    cell = ((a, e, b), (a, b, f), (b, e, f), (a, f, e))
                    found.append(tuple(tuple(labels[k] for k in face) for face in cell))
                    if len(found) > MOST_LISTED:
                        raise LimitError(
                            f"the network has more than {MOST_LISTED} tetrahedra. "
                            "Give the cells that shall be checked."
                        )
    return found


def _check_closed(cell: Sequence[Face]) -> None:
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


def _named(face: Face) -> frozenset[Hashable]:
    """A face without sense and starting point."""
    return frozenset(face)


def _sense(face: Face, other: Face) -> int:
    """+1 if two faces of the same nodes turn the same way, -1 if not."""
    start = other.index(face[0])
    return 1 if other[(start + 1) % len(other)] == face[1] else -1


def _fluxes(net: Network, faces: list[Face]) -> dict[frozenset[Hashable], tuple[np.ndarray, float]]:
    """Flux of torsion through each face, spanned from its first node, and its error."""
    places, numbers = net.edges.positions, net.edges.numbers
    corners = [places[[numbers[node] for node in face]] for face in faces]
    owner = np.repeat(np.arange(len(faces)), [len(face) - 2 for face in faces])
    spans = [(c[0], c[k], c[k + 1]) for c in corners for k in range(1, len(c) - 1)]
    if not spans:
        return {}
    triangles = np.array(spans).transpose(1, 2, 0)
    compiled = forms(net.frame, net.parameters)
    # As many as fit in the cache, with some 16 points each.
    blocks = [
        _triangles(compiled, triangles[:, :, start : start + PIECE // 16])
        for start in range(0, len(spans), PIECE // 16)
    ]
    values, errors = (np.concatenate(parts, axis=-1) for parts in zip(*blocks, strict=True))
    totals = np.stack([np.bincount(owner, row, len(faces)) for row in values], axis=1)
    bounds = np.bincount(owner, errors, len(faces))
    return {
        _named(face): (total, float(bound))
        for face, total, bound in zip(faces, totals, bounds, strict=True)
    }


def _triangles(forms: Forms, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
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
        (s, w), (t, u) = ray_rule(2 * level + 4), gauss_rule(2 * level + 4)
        one = s[:, None] * np.ones_like(t)
        two = s[:, None] * t
        points = (x[:, which, None] for x in (a, first, second))
        start, along, across = points
        at = start + along * one.ravel() + across * two.ravel()
        values = form.values(at.reshape(n, -1)).reshape(len(area), len(which), -1)
        return form.gather @ (values @ np.outer(w, u).ravel() * area[:, which])

    with np.errstate(all="ignore"):
        begun = [flux(level, np.arange(count)) for level in (0, 1)]
        found = refined(begun, flux, DISAGREE * ROUNDING, np.zeros(count), LEVELS)
    bad = ~np.isfinite(found.values).all(axis=0)
    values = np.where(bad, 0.0, found.values)
    return values, np.where(bad, np.inf, found.truncation) + ROUNDING * np.abs(values).max(axis=0)
