"""Rings: closed paths of present nodes around the missing nodes of a grid."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import prod

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.support.caching import cached_property

# One array of edge values for each axis of a plane.
Edges = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True, eq=False)
class Rings:
    """The rings of present nodes around the holes of a grid, in all layers of a plane.

    Only holes with one closed ring inside the grid have one, so that a circuit can pass them on
    both sides. Arrays of edges have the axes of the grid last.

    plane: two axes of the grid. missing: whether a node is missing, shape of the grid.
    hole: number of the hole of each missing node, -1 without a ring, shape (p, q, layers).
    first: entry of the first node of each ring, shape (holes + 1,).
    nodes: of all rings in order, flat numbers in (p, q, layers).
    axis, edge, sign: of the step to the next node of a ring: its axis, the flat number of its node
        with the lower number, and its direction.
    places: of the nodes of each ring relative to its first node, shape (2, entries).
    """

    plane: tuple[int, int]
    periodic: tuple[bool, bool]
    missing: np.ndarray
    hole: np.ndarray
    first: np.ndarray
    nodes: np.ndarray
    axis: np.ndarray
    edge: np.ndarray
    sign: np.ndarray
    places: np.ndarray

    @classmethod
    def of(
        cls,
        missing: np.ndarray,
        plane: tuple[int, int] = (0, 1),
        periodic: Sequence[bool] = (False, False),
        usable: Edges | None = None,
    ) -> Rings:
        """Rings around missing nodes; a ring with an edge that is not usable is omitted.

        periodic: of all axes of the grid. usable: truth values of edges along both axes.
        """
        wraps = periodic[plane[0]], periodic[plane[1]]
        turned = _turned(missing[None], plane)[0]
        layered = np.zeros((3, 3, 3))
        layered[:, :, 1] = 1
        hole = hole_numbers(turned, (*wraps, False), layered)
        count = int(hole.max(initial=-1)) + 1
        bad = np.zeros(count, dtype=bool)
        for k, wrapped in enumerate(wraps):
            if not wrapped:
                rim = np.take(hole, [0, -1], k)
                bad[rim[rim >= 0]] = True
        owner, axis, edge, sign, begin, end = _sides(hole, np.where(bad, -1, np.arange(count)))
        order = np.lexsort((begin, owner))
        owner, axis, edge, sign, begin, end = (
            x[order] for x in (owner, axis, edge, sign, begin, end)
        )
        keys = owner * turned.size + begin
        lengths = np.bincount(owner, minlength=count)
        bad |= lengths == 0
        # A ring that meets itself at a node is not a single closed path.
        bad[owner[1:][keys[1:] == keys[:-1]]] = True
        if usable is not None:
            for k, allowed in enumerate(usable):
                here = np.flatnonzero(axis == k)
                good = _turned(allowed[None], plane)[0][np.unravel_index(edge[here], turned.shape)]
                bad[owner[here[~good]]] = True
        after = np.searchsorted(keys, owner * turned.size + end)
        rank = np.full(len(keys), -1)
        start = np.cumsum(lengths) - lengths
        current, number = start[~bad], 0
        while len(current):
            rank[current] = number
            current, number = after[current], number + 1
            current = current[rank[current] < 0]
        # A hole with an island has more than one ring.
        bad[owner[rank < 0]] = True
        order = np.lexsort((rank, owner))
        order = order[~bad[owner[order]]]
        names = np.append(np.where(bad, -1, np.cumsum(~bad) - 1), -1)
        first = np.concatenate([[0], np.cumsum(lengths[~bad])])
        moves = sign[order] * (axis[order] == np.arange(2)[:, None])
        places = _sums(moves, first)
        return cls(
            plane, wraps, missing, names[hole], first, begin[order], axis[order], edge[order],
            sign[order], places,
        )  # fmt: skip

    # -- holes ------------------------------------------------------------------------------------

    @property
    def count(self) -> int:
        """Number of rings."""
        return len(self.first) - 1

    @cached_property
    def owner(self) -> np.ndarray:
        """Number of the ring of each entry."""
        return np.repeat(np.arange(self.count), np.diff(self.first))

    @cached_property
    def cells(self) -> np.ndarray:
        """Number of cells within each ring."""
        return np.rint(self.totals_of(self._areas(self.places))).astype(np.int64)

    def only(self, chosen: np.ndarray) -> Rings:
        """Some of the rings, by truth values of shape (holes,); other holes have no ring."""
        entries = chosen[self.owner]
        names = np.append(np.where(chosen, np.cumsum(chosen) - 1, -1), -1)
        first = np.concatenate([[0], np.cumsum(np.diff(self.first)[chosen])])
        return Rings(
            self.plane, self.periodic, self.missing, names[self.hole], first, self.nodes[entries],
            self.axis[entries], self.edge[entries], self.sign[entries], self.places[:, entries],
        )  # fmt: skip

    def way(self, hole: int, begin: int, end: int) -> np.ndarray | None:
        """Nodes of a ring between two of its nodes, all as flat numbers; None if one is not on it.

        The way does not lead over the step that returns to the first node.
        """
        ring = self.nodes[self.first[hole] : self.first[hole + 1]]
        at = [np.flatnonzero(ring == node) for node in (begin, end)]
        if not (len(at[0]) and len(at[1])):
            return None
        one, two = int(at[0][0]), int(at[1][0])
        return ring[one + 1 : two] if one <= two else ring[two + 1 : one][::-1]

    def relative(self, nodes: np.ndarray, number: int | np.ndarray) -> np.ndarray:
        """Places of nodes, shape (k, 3), relative to the first node of a ring, shape (k, 2)."""
        start = np.unravel_index(self.nodes[self.first[number]], self.hole.shape)
        away = nodes[:, :2] - np.stack(start, axis=-1)[..., :2]
        for k, wrapped in enumerate(self.periodic):
            if wrapped:
                n = self.hole.shape[k]
                away[:, k] = (away[:, k] + n // 2) % n - n // 2
        return away

    def _areas(self, places: np.ndarray) -> np.ndarray:
        """Area between each step of a ring and its first node, in cells."""
        after = places + self.sign * (self.axis == np.arange(2)[:, None])
        return _cross(places, after) / 2

    def totals_of(self, steps: np.ndarray) -> np.ndarray:
        """Sums over the steps of each ring, from values (..., entries)."""
        if not self.count:
            return np.zeros((*steps.shape[:-1], 0), dtype=steps.dtype)
        return np.add.reduceat(steps, self.first[:-1], axis=-1)

    def steps_of(self, values: Edges, *, signed: bool = True) -> np.ndarray:
        """Values of the steps along all rings, shape (rows, entries), from (rows, edges...)."""
        turned = [_turned(x, self.plane) for x in values]
        steps = np.zeros((len(turned[0]), len(self.nodes)), dtype=turned[0].dtype)
        for k, table in enumerate(turned):
            here = self.axis == k
            steps[:, here] = table[(slice(None), *np.unravel_index(self.edge[here], self._shape))]
        return self.sign * steps if signed else steps

    @property
    def _shape(self) -> tuple[int, ...]:
        return self.hole.shape

    # -- edges ------------------------------------------------------------------------------------

    @cached_property
    def _entries(self) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Edges that lead into a hole or out of it, for each axis of the plane.

        Flat numbers of their lower nodes, entries of their present nodes, and -1 for edges whose
        upper node is missing, or 1.
        """
        keys = self.owner * self.hole.size + self.nodes
        order = np.argsort(keys)
        absent = _turned(self.missing[None], self.plane)[0].ravel()
        lists = []
        for k in (0, 1):
            lower, upper = self._ends(k)
            parts = []
            for sign, out, node in ((-1, lower, upper), (1, upper, lower)):
                here = ~absent[out] & (self.hole.ravel()[node] >= 0)
                key = self.hole.ravel()[node[here]] * self.hole.size + out[here]
                at = np.searchsorted(keys[order], key)
                at = order[np.minimum(at, len(order) - 1)] if len(order) else at
                # A present node inside a hole is not on its ring.
                real = keys[at] == key
                parts.append((lower[here][real], at[real], np.full(int(real.sum()), sign)))
            edges, at, signs = (np.concatenate(x) for x in zip(*parts, strict=True))
            lists.append((edges, at, signs))
        return lists

    def _ends(self, axis: int) -> Edges:
        """Flat numbers of the lower and the upper nodes of all edges along an axis."""
        number = np.arange(self.hole.size).reshape(self._shape)
        upper = np.roll(number, -1, axis)
        if not self.periodic[axis]:
            number, upper = (np.delete(x, -1, axis) for x in (number, upper))
        return number.ravel(), upper.ravel()

    @cached_property
    def _inner(self) -> list[np.ndarray]:
        """Flat numbers of the lower nodes of edges within holes, for each axis of the plane."""
        flat, inner = self.hole.ravel(), []
        for k in (0, 1):
            lower, upper = self._ends(k)
            inner.append(lower[(flat[lower] >= 0) & (flat[upper] >= 0)])
        return inner

    @property
    def inner(self) -> Edges:
        """Whether both ends of each edge are in one hole, shape (edges...) for both axes."""
        one, two = self._replaced(
            self._zeros(1), lambda k, at, sign: np.zeros((1, 1)), lambda k: np.ones((1, 1))
        )
        return one[0] > 0, two[0] > 0

    @cached_property
    def blocked(self) -> Edges:
        """Whether each edge has a missing end and no detour, shape (edges...) for both axes."""
        absent = _turned(self.missing[None], self.plane)[0].ravel()
        tables = []
        for k in (0, 1):
            lower, upper = self._ends(k)
            table = np.zeros(self._shape, dtype=bool).ravel()
            table[lower] = absent[lower] | absent[upper]
            table[self._entries[k][0]] = False
            table[self._inner[k]] = False
            table = table.reshape(1, *self._shape)
            whole = table if self.periodic[k] else np.delete(table, -1, 1 + k)
            tables.append(self._back(whole)[0])
        return tables[0], tables[1]

    def _back(self, table: np.ndarray) -> np.ndarray:
        """Values (rows, p, q, layers) in the order of the axes of the grid, (rows, edges...)."""
        others = [n for k, n in enumerate(self.missing.shape) if k not in self.plane]
        table = table.reshape(*table.shape[:3], *others)
        return np.moveaxis(table, (1, 2), (1 + self.plane[0], 1 + self.plane[1]))

    def filled(self, values: Edges) -> Edges:
        """Values of edges, with the sums along detours on the edges into and out of holes.

        Each hole shrinks to the first node of its ring: an edge into the hole becomes the way along
        the ring to this node. The sum over a circuit is then the sum along its detour.

        values: shape (rows, edges...), one array for each axis of the plane.
        """
        ways = _sums(self.steps_of(values), self.first)
        return self._replaced(
            values, lambda k, at, sign: sign * ways[:, at], lambda k: np.zeros((1, 1))
        )

    def _replaced(
        self,
        values: Edges,
        entering: Callable[[int, np.ndarray, np.ndarray], np.ndarray],
        within: Callable[[int], np.ndarray],
    ) -> Edges:
        """Values of edges with other values on the edges of holes."""
        tables = []
        for k, table in enumerate(values):
            turned = _turned(table, self.plane).copy()
            edges, at, sign = self._entries[k]
            index = np.unravel_index(edges, self._shape)
            turned[(slice(None), *index)] = entering(k, at, sign)
            turned[(slice(None), *np.unravel_index(self._inner[k], self._shape))] = within(k)
            tables.append(self._back(turned))
        return tables[0], tables[1]

    def _zeros(self, rows: int) -> Edges:
        """Zeros on all edges of both axes."""
        shapes = []
        for k, wrapped in zip(self.plane, self.periodic, strict=True):
            shape = list(self.missing.shape)
            shape[k] -= not wrapped
            shapes.append(shape)
        one, two = (np.zeros((rows, *shape)) for shape in shapes)
        return one, two

    def shares(self, values: np.ndarray) -> Edges:
        """Half of a value of each hole on the edges into it and out of it, (rows, edges...).

        A circuit enters and leaves a hole at each passage.

        values: shape (rows, holes).
        """
        return self._replaced(
            self._zeros(len(values)),
            lambda k, at, sign: values[:, self.owner[at]] / 2,
            lambda k: np.zeros((1, 1)),
        )

    @cached_property
    def changes(self) -> Edges:
        """Area between detours and the edges that they replace, in cells, (1, edges...)."""
        ways = _sums(self._areas(self.places)[None], self.first)
        units = np.eye(2, dtype=np.int64)

        def entering(k: int, at: np.ndarray, sign: np.ndarray) -> np.ndarray:
            there = self.places[:, at]
            node = there - sign * units[k][:, None]
            return (sign * (ways[0, at] + _cross(there, node) / 2))[None]

        def within(k: int) -> np.ndarray:
            lower = self._inner[k]
            nodes = np.stack(np.unravel_index(lower, self._shape), axis=1)
            one = self.relative(nodes, self.hole.ravel()[lower]).T
            return -_cross(one, one + units[k][:, None])[None] / 2

        return self._replaced(self._zeros(1), entering, within)

    # -- single circuits --------------------------------------------------------------------------

    def expanded(
        self, axis: int, edges: np.ndarray, times: np.ndarray
    ) -> tuple[np.ndarray, list[tuple[int, np.ndarray, np.ndarray]], np.ndarray]:
        """Steps of rings that replace edges along an axis.

        edges: flat numbers of their lower nodes. Returns which edges have a detour; for each axis,
        flat numbers and times of steps; and the holes of edges that enter or leave.
        """
        entries, at, signs = self._entries[axis]
        order = np.argsort(entries)
        where = np.searchsorted(entries[order], edges)
        where = order[np.minimum(where, len(order) - 1)] if len(order) else where * 0
        crossing = (entries[where] == edges) if len(order) else np.zeros(len(edges), dtype=bool)
        where, signed = where[crossing], times[crossing]
        pieces: list[np.ndarray] = []
        counts: list[np.ndarray] = []
        for entry, factor in zip(at[where].tolist(), signs[where] * signed, strict=True):
            pieces.append(np.arange(int(self.first[self.owner[entry]]), entry))
            counts.append(np.full(len(pieces[-1]), factor))
        way = np.concatenate([np.zeros(0, dtype=np.int64), *pieces])
        many = np.concatenate([np.zeros(0, dtype=np.int64), *counts])
        steps = []
        for k in (0, 1):
            here = self.axis[way] == k
            steps.append((k, self.edge[way[here]], self.sign[way[here]] * many[here]))
        replaced = crossing | np.isin(edges, self._inner[axis])
        return replaced, steps, self.owner[at[where]]


def hole_numbers(
    missing: np.ndarray, periodic: Sequence[bool], structure: np.ndarray
) -> np.ndarray:
    """Number of the hole of each node in the order of their first nodes; -1 at present nodes.

    structure: which neighbours of a node belong to its hole, shape (3, ...).
    """
    # Periodic axes get one more node at each end, so that neighbours across the end are adjacent.
    ends = [(int(wraps), int(wraps)) for wraps in periodic]
    labels, count = scipy.ndimage.label(np.pad(missing, ends, mode="wrap"), structure)
    inside = labels[tuple(slice(a, n + a) for (a, _), n in zip(ends, missing.shape, strict=True))]
    if any(periodic):
        # A node that occurs twice joins its two labels.
        number = np.pad(np.arange(missing.size).reshape(missing.shape), ends, mode="wrap")
        pairs = np.stack([labels.ravel(), inside.ravel()[number.ravel()]])[:, labels.ravel() > 0]
        links = scipy.sparse.coo_array(
            (np.ones(pairs.shape[1]), (pairs[0], pairs[1])), shape=(count + 1, count + 1)
        )
        inside = scipy.sparse.csgraph.connected_components(links, directed=False)[1][inside]
    numbers = np.full(missing.shape, -1)
    _, first, which = np.unique(inside[missing], return_index=True, return_inverse=True)
    numbers[missing] = np.argsort(np.argsort(first))[which]
    return numbers


def _turned(values: np.ndarray, plane: tuple[int, int]) -> np.ndarray:
    """Values (rows, grid...) by axes of the plane and by layer, (rows, p, q, layers)."""
    moved = np.moveaxis(values, (1 + plane[0], 1 + plane[1]), (1, 2))
    return moved.reshape(*moved.shape[:3], prod(moved.shape[3:]))


def _sides(hole: np.ndarray, names: np.ndarray) -> tuple[np.ndarray, ...]:
    """The directed edges around the cells next to holes, which are on their left.

    hole: number of each node, -1 at present nodes. names: number of each hole, or -1 to omit it.
    Returns hole, axis, lower node, sign, first node and last node of each edge.
    """
    cells = np.max([np.roll(hole, (-i, -j), (0, 1)) for i in (0, 1) for j in (0, 1)], axis=0)
    cells = np.append(names, -1)[cells]
    number = np.arange(hole.size).reshape(hole.shape)
    rows = []
    for k in (0, 1):
        upper = np.roll(number, -1, k)
        beside = np.roll(cells, 1, 1 - k)
        # Edges along the first axis have their cell above, edges along the second to the left.
        for owner, other, sign in ((cells, beside, 1 - 2 * k), (beside, cells, 2 * k - 1)):
            here = (owner >= 0) & (other != owner)
            begin, end = (number, upper) if sign > 0 else (upper, number)
            count = int(here.sum())
            rows.append(
                (
                    owner[here], np.full(count, k), number[here], np.full(count, sign),
                    begin[here], end[here],
                )
            )  # fmt: skip
    return tuple(np.concatenate(x) for x in zip(*rows, strict=True))


def _sums(values: np.ndarray, first: np.ndarray) -> np.ndarray:
    """Sums from the first entry of each ring to the entry before each one, (rows, entries)."""
    if not values.shape[-1]:
        return values
    sums = np.cumsum(values, axis=-1) - values
    return sums - np.repeat(sums[:, first[:-1]], np.diff(first), axis=1)


def _cross(one: np.ndarray, two: np.ndarray) -> np.ndarray:
    """Cross product of vectors of shape (2, k)."""
    return one[0] * two[1] - one[1] * two[0]
