"""Polylines: dislocation lines from junction to junction, unbroken by the box; as rows of text."""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass

import numpy as np

from geomtorsion.materials.lines.line_arrays import LineArrays
from geomtorsion.materials.lines.line_families import line_families, named_families
from geomtorsion.materials.lines.reactions import Vector, size, vanishes, written
from geomtorsion.support.caching import cached_property


@dataclass(frozen=True, eq=False)
class Polyline:
    """A dislocation line through nodes without junctions.

    nodes: their names, in the sense of the line. points: their positions, shape (k, 3), each in
        the image in which the line reaches it.
    burgers: b, exact where b of the network is, shape (n,).
    shift: whole periods from the first point to the last, where both are the same node, shape (3,).
    numbers: numbers in the network of the lines that form it, in order.
    meets: the kinds of its first and its last node: "surface", "junction", or "nothing".
    """

    nodes: tuple[Hashable, ...]
    points: np.ndarray
    burgers: Vector
    shift: tuple[int, ...]
    numbers: tuple[int, ...]
    meets: tuple[str, str]

    @property
    def returns(self) -> bool:
        """Whether it ends at the node at which it begins."""
        return self.nodes[0] == self.nodes[-1]

    @property
    def is_closed(self) -> bool:
        """Whether it is a loop: it ends at the position at which it begins."""
        return self.returns and not any(self.shift)

    @property
    def is_periodic(self) -> bool:
        """Whether it runs through the periodic box without end: it returns in another image."""
        return self.returns and any(self.shift)

    @property
    def ends(self) -> str:
        """Its ends in a word or two: closed, periodic, or the kinds of its end nodes."""
        if self.returns:
            return "closed" if self.is_closed else "periodic"
        first, last = self.meets
        return first if first == last else f"{first}, {last}"

    @cached_property
    def length(self) -> float:
        """Its length, coordinates."""
        return float(np.linalg.norm(np.diff(self.points, axis=0), axis=1).sum())

    @cached_property
    def screw(self) -> float:
        """Share of b^2 along the line, averaged over its length; the rest is edge."""
        steps = np.diff(self.points, axis=0)
        lengths = np.linalg.norm(steps, axis=1)
        there = lengths > 0
        along = (steps[there] @ np.array([float(x) for x in self.burgers])) / lengths[there]
        total = size(self.burgers) ** 2 * lengths.sum()
        return float((along**2 * lengths[there]).sum() / total) if total else 0.0


def polylines(
    lines: LineArrays,
    vectors: Sequence[Vector],
    ends: Sequence[bool] = (),
    tolerance: float = 1e-9,
) -> tuple[Polyline, ...]:
    """Lines between nodes merged where exactly two lines of one b meet.

    Parameters
    ----------
    vectors
        b of each line, exact where it is.
    ends
        Whether a line always ends at a node, because it is at a surface, shape (nodes,).
    tolerance
        Share of the largest b within which floats count as equal.

    Returns
    -------
    The polylines, in the order of their first lines; each has the sense of its line with the
    lowest number.

    Examples
    --------
    A square loop across the faces of a periodic box is one closed line:

    >>> from geomtorsion.materials.lines.box import Box
    >>> box = Box.of_bounds([0, 0, 0], [4, 4, 4])
    >>> corners = [[0, 0, 2], [1, 0, 2], [1, 3, 2], [0, 3, 2]]
    >>> sides, b = [[0, 1], [1, 2], [2, 3], [3, 0]], [(0, 0, 1)] * 4
    >>> (one,) = polylines(LineArrays(corners, sides, b, box), b)
    >>> one.is_closed, one.length, one.points[2].tolist()
    (True, 4.0, [1.0, -1.0, 2.0])
    """
    walker = _Walker(lines, vectors, ends, tolerance)
    return tuple(walker.walked(k) for k in range(len(lines.pairs)) if not walker.used[k])


class _Walker:
    """Walks along lines, each of which is used once."""

    def __init__(
        self,
        lines: LineArrays,
        vectors: Sequence[Vector],
        ends: Sequence[bool],
        tolerance: float,
    ) -> None:
        self.lines, self.vectors = lines, vectors
        self.pairs = lines.pairs.tolist()
        self.steps = lines.steps
        self.images = lines.image_list
        self.used = [False] * len(self.pairs)
        self.scale = max(map(size, vectors), default=1.0)
        self.tolerance = tolerance
        arms: list[list[int]] = [[] for _ in range(len(lines.positions))]
        for k, (a, b) in enumerate(self.pairs):
            arms[a].append(k)
            arms[b].append(k)
        self.arms = arms
        self.ends = list(ends) or [False] * len(arms)

    def walked(self, first: int) -> Polyline:
        """The polyline to which a line belongs, in the sense of that line."""
        self.used[first] = True
        start, end = self.pairs[first]
        onward = self._onward(end, first, 1)
        behind = [(line, -sense) for line, sense in self._onward(start, first, -1)]
        chain = [*reversed(behind), (first, 1), *onward]
        numbers = [self._end(k, -sense) for k, sense in chain] + [self._end(*chain[-1])]
        steps = np.array([sense * self.steps[k] for k, sense in chain])
        walked = np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
        points = self.lines.positions[numbers[0]] + walked
        rows = [[sense * x for x in self.images[k]] for k, sense in chain]
        shift = tuple(sum(column) for column in zip(*rows, strict=True))
        if numbers[0] == numbers[-1] and not any(shift):
            # Sums of steps differ from zero in their last digits.
            points[-1] = points[0]
        return Polyline(
            nodes=tuple(self.lines.labels[k] for k in numbers),
            points=points,
            burgers=self.vectors[first],
            shift=shift,
            numbers=tuple(k for k, _ in chain),
            meets=(self._met(numbers[0]), self._met(numbers[-1])),
        )

    def _met(self, node: int) -> str:
        """The kind of the node at which a line ends."""
        if self.ends[node]:
            return "surface"
        return "junction" if len(self.arms[node]) > 1 else "nothing"

    def _onward(self, node: int, line: int, sense: int) -> list[tuple[int, int]]:
        """The lines that follow from a node, each with the sense in which it is walked."""
        chain = []
        while (step := self._next(node, line, sense)) is not None:
            chain.append(step)
            line, sense = step
            node = self._end(line, sense)
        return chain

    def _end(self, line: int, sense: int) -> int:
        """The node to which a line leads when it is walked in a sense."""
        return self.pairs[line][1 if sense > 0 else 0]

    def _next(self, node: int, line: int, sense: int) -> tuple[int, int] | None:
        """The line that continues from a node, with the sense in which it is walked."""
        arms = self.arms[node]
        if len(arms) != 2 or arms[0] == arms[1] or self.ends[node]:
            return None
        next_line = arms[0] if arms[1] == line else arms[1]
        if self.used[next_line]:
            return None
        onward = 1 if self.pairs[next_line][0] == node else -1
        here, there = self.vectors[line], self.vectors[next_line]
        gap = tuple(sense * a - onward * b for a, b in zip(here, there, strict=True))
        if not vanishes(gap, self.scale, self.tolerance):
            return None
        self.used[next_line] = True
        return next_line, onward


def line_table(
    lines: LineArrays,
    curves: Sequence[Polyline],
    junctions: int,
    names: Sequence[str] | None = None,
    most: int = 40,
) -> str:
    """Counts, and a row for each line: b, family, length, share of screw, where it ends.

    names: of the families of lines, if known. most: number of rows that are shown.

    Examples
    --------
    >>> from geomtorsion.materials.lines import Box, DislocationNetwork
    >>> corners = [[1, 1, 2], [3, 1, 2], [3, 3, 2], [1, 3, 2]]
    >>> sides = [[0, 1], [1, 2], [2, 3], [3, 0]]
    >>> box = Box.of_bounds([0, 0, 0], [4, 4, 4])
    >>> net = DislocationNetwork.of_arrays(LineArrays(corners, sides, [[0, 0, 1]] * 4, box))
    >>> print(net)
    1 dislocation line, no junctions, length 8
      line  b          family     length  screw  ends
         0  (0, 0, 1)  1 <1 0 0>       8    0 %  closed
    """
    families, which = line_families(lines) if names is None else named_families(lines, names)
    length = sum(curve.length for curve in curves)
    rows = [("line", "b", "family", "length", "screw", "ends")]
    rows += [
        (
            str(k),
            _short(curve.burgers),
            families[which[curve.numbers[0]]].name,
            f"{curve.length:.6g}",
            f"{100 * curve.screw:.0f} %",
            curve.ends,
        )
        for k, curve in enumerate(curves[:most])
    ]
    head = f"{_counts(len(curves), junctions)}, length {length:.6g}"
    return "\n".join([head, *_aligned(rows, "r--rr-"), *_rest(len(curves), most)])


def node_table(
    lines: Sequence[tuple[Hashable, Hashable, Hashable, Vector]], junctions: int, most: int = 40
) -> str:
    """As `line_table`, for lines without known positions.

    Examples
    --------
    >>> print(node_table([("a", "b", 0, (1, 0))], 0))
    1 dislocation line, no junctions
      from  to  b
      a     b   (1, 0)
    """
    rows = [("from", "to", "b")]
    rows += [(str(start), str(end), written(b)) for start, end, _, b in lines[:most]]
    return "\n".join(
        [_counts(len(lines), junctions), *_aligned(rows, "---"), *_rest(len(lines), most)]
    )


def _short(vector: Vector) -> str:
    """b with six digits of its largest component, since less is rounding."""
    most = max((abs(x) for x in vector if isinstance(x, float)), default=0.0)
    if not most:
        return written(vector)
    digits = 5 - math.floor(math.log10(most))
    return written(tuple(round(x, digits) + 0.0 if isinstance(x, float) else x for x in vector))


def _counts(lines: int, junctions: int) -> str:
    return f"{_counted(lines, 'dislocation line')}, {_counted(junctions, 'junction')}"


def _counted(count: int, noun: str) -> str:
    """A number with its noun."""
    return f"{f'{count:,}' if count else 'no'} {noun}{'s' * (count != 1)}"


def _aligned(rows: list[tuple[str, ...]], sides: str) -> list[str]:
    """Rows of a table, columns of numbers ("r") to the right; none without a row below the head."""
    if len(rows) < 2:
        return []
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        ("  " + "  ".join(
            word.rjust(width) if side == "r" else word.ljust(width)
            for word, width, side in zip(row, widths, sides, strict=True)
        )).rstrip()
        for row in rows
    ]  # fmt: skip


def _rest(count: int, most: int) -> list[str]:
    """Number of rows that are not shown."""
    return [f"  and {count - most:,} more"] if count > most else []
