"""ParaDiS files: dislocation networks as the codes ParaDiS and ExaDiS write them, and back."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import cache
from os import PathLike
from pathlib import Path

import numpy as np

from geomtorsion.errors import FileFormatError, GeomtorsionError, NetworkError
from geomtorsion.materials.lines.box import Box
from geomtorsion.materials.lines.line_arrays import LineArrays
from geomtorsion.support import checks
from geomtorsion.support.checks import cut, shown
from geomtorsion.support.files import BOUNDS, read_text
from geomtorsion.support.text_rows import TextRows

Tag = tuple[int, int]
_TAG = re.compile(r"([0-9]{1,18}),([0-9]{1,18})")


def read_paradis(path: str | PathLike[str], periodic: bool = True) -> LineArrays:
    """Read a dislocation network from a ParaDiS .data file; each line is kept once.

    A file without nodes is an empty network.

    Parameters
    ----------
    periodic
        Whether the box repeats along its edges, which such a file does not contain.

    Raises
    ------
    FileFormatError
        The file is missing, truncated or malformed, or its two descriptions of a line differ; the
        message names the line of the file.
    """
    checks.flag(periodic, "periodic")
    text = read_text(checks.file_name(path), checks.LARGEST_ARRAYS)
    rows = TextRows(Path(path).name, text.split("\n"), "#")
    header = _header(rows)
    end = rows.line

    def words_of(key: str) -> list[str]:
        if key not in header:
            rows.line = 0
            rows.fail(
                f"expected {key} above nodalData, got a file without it. Is it a ParaDiS file of "
                "dislocations?"
            )
        rows.line, words = header[key]
        return words

    if "numFileSegments" in header:
        parts = rows.whole(" ".join(words_of("numFileSegments")), "numFileSegments")
        if parts != 1:
            rows.fail(
                f"numFileSegments: expected a network in 1 file, got one in {parts}. Write it "
                "into one file, and read that."
            )
    count = rows.whole(" ".join(words_of("nodeCount")), "nodeCount")
    low, high = (
        rows.numbers(words_of(key), 3, key) for key in ("minCoordinates", "maxCoordinates")
    )
    rows.line = end
    nodes, arms = _body(rows, count)
    try:
        box = Box.of_bounds(low, high, periodic)
        return _network(rows, nodes, arms, box)
    except FileFormatError:
        raise
    except GeomtorsionError as error:
        raise FileFormatError(f"{rows.name}: {error}") from None


def _header(rows: TextRows) -> dict[str, tuple[int, list[str]]]:
    """Every key before the nodes, with its line and words."""
    entries: dict[str, tuple[int, list[str]]] = {}
    while True:
        key, equals, rest = " ".join(rows.next("nodalData")).partition("=")
        key, line, values = key.strip(), rows.line, rest.split()
        if key == "nodalData" and equals:
            return entries
        if not equals:
            # A value after a key without brackets, such as the bounds of domains, is not needed.
            continue
        if (more := values)[:1] == ["["]:
            while "]" not in more:
                more = rows.next(f"] after {cut(key)}")
                values += more
            values = values[1 : values.index("]")]
        entries[key] = line, values


@dataclass
class _Words:
    """Words of the nodes or arms of a file, one after another, with their lines.

    tags: names of the nodes, or of the nodes to which arms lead. places: positions, or b.
    rest: constraints, or normals of glide planes, whose lines are `rest_lines`.
    owners: numbers of the nodes to which arms belong.
    """

    lines: list[int] = field(default_factory=list)
    tags: list[str] = field(default_factory=list)
    places: list[str] = field(default_factory=list)
    rest: list[str] = field(default_factory=list)
    rest_lines: list[int] = field(default_factory=list)
    owners: list[int] = field(default_factory=list)


def _body(rows: TextRows, count: int) -> tuple[_Words, _Words]:
    """The words of all nodes and arms."""
    nodes, arms = _Words(), _Words()
    for k in range(count):
        words = rows.next(f"node {k + 1} of {count}")
        if len(words) < 6:
            rows.fail(
                "expected a node (tag, x, y, z, number of arms, constraint), got "
                f"{len(words)} word{'s' * (len(words) != 1)}. Is a row missing?"
            )
        name, several = words[0], rows.whole(words[4], "number of arms")
        nodes.lines.append(rows.line)
        nodes.tags.append(name)
        nodes.places += words[1:4]
        nodes.rest.append(words[5])
        for _ in range(several):
            words = rows.next(f"an arm of node {name}")
            arms.lines.append(rows.line)
            arms.tags.append(words[0])
            arms.places += words[1:4]
            normal = words[4:] or rows.next("the normal of a glide plane")
            if len(words) < 4 or len(normal) != 3:
                rows.fail(
                    "expected b and a normal of an arm, six numbers, got "
                    f"{len(words[1:4]) + len(normal)}. Is a row missing?"
                )
            arms.rest += normal
            arms.rest_lines.append(rows.line)
            arms.owners.append(k)
    if (more := rows.more()) is not None:
        rows.fail(
            f"expected the end of the file after {count} nodes (nodeCount), got "
            f"{shown(' '.join(more))}. Correct nodeCount, or remove the rest."
        )
    return nodes, arms


def _network(rows: TextRows, nodes: _Words, arms: _Words, box: Box) -> LineArrays:
    """The network of all nodes and arms, each line once."""

    @cache
    def tag(word: str) -> Tag:
        match = _TAG.fullmatch(word)
        if match is None:
            rows.fail(
                f"expected a node such as 0,12, got {shown(word)}. Is a row missing, or is there "
                "one too many?"
            )
        return int(match[1]), int(match[2])

    numbers: dict[Tag, int] = {}
    for k, (rows.line, word) in enumerate(zip(nodes.lines, nodes.tags, strict=True)):
        if numbers.setdefault(tag(word), k) != k:
            rows.fail(f"expected each node once, got node {word} again. Remove one.")
    others = []
    for k, rows.line, word in zip(arms.owners, arms.lines, arms.tags, strict=True):
        other = numbers.get(tag(word))
        if other is None:
            rows.fail(
                f"expected an arm to a node of the file, got one to {word}. Is the file complete?"
            )
        if other == k:
            rows.fail(
                f"expected an arm to another node, got one from node {word} to itself. Remove it."
            )
        others.append(other)
    places = rows.array(nodes.places, nodes.lines, 3, "a position")
    burgers = rows.array(arms.places, arms.lines, 3, "an arm")
    planes = rows.array(arms.rest, arms.rest_lines, 3, "an arm")
    constraints = [
        rows.whole(word, "constraint", -(10**18))
        for rows.line, word in zip(nodes.lines, nodes.rest, strict=True)
    ]
    zero = ~burgers.any(axis=1)
    if zero.any():
        rows.line = arms.lines[int(zero.argmax())]
        rows.fail(
            "expected b different from zero, got an arm with b = 0, which is not a dislocation. "
            "Remove it."
        )
    ends = np.array([arms.owners, others], dtype=np.int64).T
    chosen = _joined(rows, list(numbers), arms.lines, ends, burgers)
    return LineArrays(
        places, ends[chosen], burgers[chosen], box, None, list(numbers),
        np.array(constraints, dtype=np.int64), planes[chosen],
    )  # fmt: skip


def _joined(
    rows: TextRows, tags: list[Tag], lines: list[int], ends: np.ndarray, burgers: np.ndarray
) -> np.ndarray:
    """The arms that describe each line from its first node; b from the second node is opposite.

    lines: of the file, for each arm. ends: the node of an arm and the node to which it leads, shape
    (arms, 2).
    """
    keys = len(tags) * ends.min(axis=1, initial=len(tags)) + ends.max(axis=1, initial=0)
    _, group = np.unique(keys, return_inverse=True)
    is_first = ends[:, 0] < ends[:, 1]
    sizes = [np.bincount(group[side], minlength=len(ends)) for side in (is_first, ~is_first)]

    def fail(arm: int, expected: str, remedy: str) -> None:
        (a, b), (c, d) = (tags[k] for k in ends[arm].tolist())
        rows.line = lines[arm]
        rows.fail(f"expected {expected.format(f'from node {a},{b} to {c},{d}')}. {remedy}")

    odd = ((sizes[0] != sizes[1]) | (sizes[0] > BOUNDS.parallel))[group]
    if odd.any():
        arm = int(odd.argmax())
        here, back = (int(s[group[arm]]) for s in (sizes if is_first[arm] else sizes[::-1]))
        if here > BOUNDS.parallel:
            fail(
                arm, f"at most {BOUNDS.parallel} arms {{}}, got {here:,}",
                "Join lines that run side by side.",
            )  # fmt: skip
        fail(
            arm, f"as many arms {{}} as back, got {here} and {back} back",
            "Give each line at both its nodes.",
        )  # fmt: skip
    there, back = (np.flatnonzero(side) for side in (is_first, ~is_first))
    there, back = (side[np.argsort(group[side], kind="stable")] for side in (there, back))
    # Several lines may join the same two nodes: each belongs to the arm with the most opposite b.
    starts = np.cumsum(sizes[0]) - sizes[0]
    for several in np.flatnonzero(sizes[0] > 1):
        part = slice(starts[several], starts[several] + sizes[0][several])
        left = back[part].tolist()
        back[part] = [
            left.pop(int(np.abs(burgers[arm] + burgers[left]).max(axis=1).argmin()))
            for arm in there[part].tolist()
        ]
    gaps = np.abs(burgers[there] + burgers[back]).max(axis=1, initial=0)
    # Files have eleven digits; both rows must have the same b.
    odd = gaps > 1e-6 * np.abs(burgers[there]).max(axis=1, initial=0)
    if odd.any():
        k = int(odd.argmax())
        one, two = int(there[k]), int(back[k])
        fail(
            one, f"opposite b at both nodes of a line, got {burgers[one].tolist()} {{}} and "
            f"{burgers[two].tolist()} back (line {lines[two]})", "Correct one of them.",
        )  # fmt: skip
    # Lines are in the order of the file; those between the same nodes follow each other.
    return there[np.lexsort((there, there[starts[group[there]]]))]


# -- writing --------------------------------------------------------------------------------------

HEAD = """\
dataFileVersion =   4
numFileSegments =   1
minCoordinates = [
{low}
  ]
maxCoordinates = [
{high}
  ]
nodeCount =   {count}
dataDecompType =   2
dataDecompGeometry = [
  1
  1
  1
  ]

#
#  END OF DATA FILE PARAMETERS
#

domainDecomposition =
# Dom_ID  Minimum XYZ bounds   Maximum XYZ bounds
  0  {bounds}
nodalData =
#  Primary lines: node_tag, x, y, z, num_arms, constraint
#  Secondary lines: arm_tag, burgx, burgy, burgz, nx, ny, nz
"""


def paradis_text(lines: LineArrays) -> str:
    """A network as the text of a ParaDiS .data file, every number to the last digit.

    Raises
    ------
    NetworkError
        The network has no box along the coordinates, b is not of three components, or a line is
        longer than half a period: a reader of the file cannot distinguish it from a shorter one.
    """
    box = lines.box
    if box is None or np.count_nonzero(box.vectors - np.diag(np.diag(box.vectors))):
        raise NetworkError(
            "expected a box along the coordinates for a ParaDiS file, got an oblique one or none. "
            "Give Box.of_bounds(low, high)."
        )
    if lines.burgers.shape[1] != 3:
        raise NetworkError(
            f"expected three components of b for a ParaDiS file, got {lines.burgers.shape[1]}. "
            "Save the network as .json."
        )
    first, second = lines.pairs.T
    nearest = box.images(lines.positions[second] - lines.positions[first])
    far = np.flatnonzero((nearest != lines.cochain.complex.images).any(axis=1))
    if len(far):
        a, b = (lines.labels[n] for n in lines.pairs[far[0]])
        raise NetworkError(
            f"expected lines of at most half a period, since a ParaDiS file holds no images, got "
            f"the longer line {a!r} -> {b!r}. Put a node into it."
        )
    named = [_tag_of(label) for label in lines.labels]
    tags = [tag for tag in named if tag is not None]
    if len(set(tags)) < len(named):
        tags = [(0, k) for k in range(len(named))]
    names = [f"{a},{b}" for a, b in tags]
    ends = [box.origin, box.origin + np.diag(box.vectors)]
    low, high = ("\n".join(f"  {x!r}" for x in end.tolist()) for end in ends)
    bounds = " ".join(repr(x) for end in ends for x in end.tolist())
    arms: list[list[str]] = [[] for _ in names]
    normals = np.zeros((len(first), 3)) if lines.planes is None else lines.planes
    for (a, b), vector, normal in zip(
        lines.pairs.tolist(), lines.burgers.tolist(), normals.tolist(), strict=True
    ):
        plane = " ".join(map(repr, normal))
        arms[a].append(f"   {names[b]} {' '.join(map(repr, vector))}\n       {plane}\n")
        arms[b].append(f"   {names[a]} {' '.join(repr(-x) for x in vector)}\n       {plane}\n")
    rows = [HEAD.format(low=low, high=high, count=len(names), bounds=bounds)]
    for name, place, constraint, mine in zip(
        names, lines.positions.tolist(), lines.constraint_list, arms, strict=True
    ):
        rows.append(f" {name} {' '.join(map(repr, place))} {len(mine)} {constraint}\n")
        rows += mine
    return "".join(rows)


def _tag_of(label: object) -> Tag | None:
    """A name of a node in the form of such a file."""
    if not isinstance(label, tuple) or len(label) != 2:
        return None
    one, two = label
    fits = all(type(x) is int and 0 <= x < 10**18 for x in label)
    return (one, two) if fits else None
