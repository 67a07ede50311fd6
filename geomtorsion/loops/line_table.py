"""Line table: dislocation lines as rows of text, for people."""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence

from geomtorsion.loops.line_arrays import LineArrays
from geomtorsion.loops.line_families import line_families, named_families
from geomtorsion.loops.polylines import Polyline
from geomtorsion.loops.reactions import Vector, written


def line_table(
    lines: LineArrays,
    curves: Sequence[Polyline],
    junctions: int,
    names: Sequence[str] | None = None,
    most: int = 40,
) -> str:
    """Counts, and a row for each line: b, family, length, share of screw, where it ends.

    names: of the families of lines, if they are known. most: as many rows as a screen shows.

    Examples
    --------
    >>> from geomtorsion.loops import Box, DislocationNetwork
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
    """The same for lines of which no places are known.

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
    """b with six digits of its largest component: less is rounding."""
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
    """Rows of a table, columns of numbers ("r") to the right; nothing where there is none."""
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
    """How many rows are not shown."""
    return [f"  and {count - most:,} more"] if count > most else []
