"""ParaDiS files: dislocation networks as the codes ParaDiS and ExaDiS write them, and back."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import NoReturn

import numpy as np

from geomtorsion.errors import FileFormatError, GeomtorsionError, NetworkError
from geomtorsion.materials.lines.box import Box
from geomtorsion.materials.lines.line_arrays import LineArrays
from geomtorsion.support import checks
from geomtorsion.support.checks import cut, shown
from geomtorsion.support.files import BOUNDS, finite_number, read_text

Tag = tuple[int, int]
Row = tuple[int, list[str]]
_TAG = re.compile(r"([0-9]{1,18}),([0-9]{1,18})")
_WHOLE = re.compile(r"[+-]?[0-9]{1,18}")
# Characters of the numbers of a file; the reader checks whether they are numbers.
_FLOATS = re.compile(r"[0-9eE.,+\-\s]*")
_COMMENT = re.compile(r"#[^\n]*")


class _Reader:
    """The lines of a file that are not empty, with their numbers."""

    def __init__(self, name: str, text: str) -> None:
        self.name = name
        self.rows = self._rows(text)
        self.line = 0

    @staticmethod
    def _rows(text: str) -> Iterator[Row]:
        for number, row in enumerate(text.split("\n"), 1):
            words = row.partition("#")[0].split()
            if words:
                yield number, words

    def next(self, what: str) -> list[str]:
        """The words of the next row."""
        row = next(self.rows, None)
        if row is None:
            self.fail(f"expected {what}, got the end of the file. Is the file complete?")
        self.line, words = row
        return words

    def fail(self, message: str) -> NoReturn:
        """Refuse the last row that was read."""
        raise FileFormatError(f"{self.name}: line {self.line}: {message}")

    def number(self, word: str, what: str) -> float:
        """A finite number."""
        value = finite_number(word)
        if value is not None:
            return value
        self.fail(f"{what}: expected a finite number, got {shown(word)}. Correct it.")

    def whole(self, word: str, what: str) -> int:
        """A whole number."""
        if not _WHOLE.fullmatch(word):
            self.fail(f"{what}: expected a whole number, got {shown(word)}. Correct it.")
        return int(word)

    def tag(self, word: str) -> Tag:
        """The name of a node: domain and number."""
        match = _TAG.fullmatch(word)
        if match is None:
            self.fail(
                f"expected a node such as 0,12, got {shown(word)}. Is a row missing, or is there "
                "one too many?"
            )
        return int(match[1]), int(match[2])


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
    reader = _Reader(Path(path).name, text)
    header = _header(reader)
    if "numFileSegments" in header and (parts := _single(reader, header, "numFileSegments")) != 1:
        reader.fail(
            f"numFileSegments: expected a network in 1 file, got one in {parts}. Write it into one "
            "file, and read that."
        )
    count = _single(reader, header, "nodeCount", least=0)
    low, high = (_corner(reader, header, key) for key in ("minCoordinates", "maxCoordinates"))
    table = _all_at_once(text, count) if count else None
    if table is None:
        # Something is unusual: reading line by line either succeeds or names the line.
        tags, positions, constraints, arms = _nodes(reader, count)
        pairs, burgers, planes = _joined(reader.name, tags, arms)
        places = np.array(positions).reshape(-1, 3)
        table = list(tags), places, np.array(constraints, dtype=np.int64), pairs, burgers, planes
    labels, places, numbers, pairs, burgers, planes = table
    try:
        box = Box.of_bounds(low, high, periodic)
        return LineArrays(places, pairs, burgers, box, None, labels, numbers, planes)
    except GeomtorsionError as error:
        raise FileFormatError(f"{reader.name}: {error}") from None


Table = tuple[list[Tag], np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def _all_at_once(text: str, count: int) -> Table | None:
    """Labels, positions, constraints, pairs, b and planes of a file in the usual form.

    In the usual form a node, an arm and its plane are on a line each, whole numbers are where they
    should be, and one dislocation line joins two nodes. None for any other form.
    """
    _, mark, body = text.partition("nodalData")
    body = _COMMENT.sub("", body.partition("\n")[2])
    if not mark or not _FLOATS.fullmatch(body):
        return None
    try:
        texts = body.replace(",", " ").split()
        words = list(map(float, texts))
    except ValueError:
        return None
    node, arm = 7, 8
    # Beginning of each node: two numbers name it, three are its position, then eight for each arm.
    starts, at = [], 0
    for _ in range(count):
        if at + node > len(words):
            return None
        starts.append(at)
        if not 0 <= words[at + 5] <= len(words):
            return None
        at += node + arm * int(words[at + 5])
    if at != len(words):
        return None
    values, heads = np.array(words), np.array(starts, dtype=np.int64)
    nodes = values[heads[:, None] + np.arange(node)]
    counts = nodes[:, 5].astype(np.int64)
    inner = np.ones(len(values), dtype=bool)
    inner[heads[:, None] + np.arange(node)] = False
    arms = values[inner].reshape(-1, arm)
    inside = np.flatnonzero(inner).reshape(-1, arm)[:, :2]
    named = heads[:, None] + np.array([0, 1, 5, 6])
    whole = np.concatenate([named.ravel(), inside.ravel()]).astype(np.int64)
    if not all(texts[k].isdigit() for k in whole.tolist()) or not np.isfinite(values).all():
        return None
    # Beyond this, doubles do not represent all whole numbers.
    if values[whole].max() > 2.0**53 or body.count(",") != count + len(arms):
        return None
    if sum(map(bool, map(str.strip, body.split("\n")))) != count + 2 * len(arms):
        return None
    names = np.concatenate([nodes[:, :2], arms[:, :2]]).astype(np.int64)
    places, burgers, planes = nodes[:, 2:5], arms[:, 2:5], arms[:, 5:]
    _, first_at, ids = np.unique(names, axis=0, return_index=True, return_inverse=True)
    node_of = np.full(len(first_at), -1)
    own, others = ids.ravel()[:count], ids.ravel()[count:]
    node_of[own] = np.arange(count)
    owner, other = np.repeat(np.arange(count), counts), node_of[others]
    odd = len(np.unique(own)) < count or (other < 0).any() or (owner == other).any()
    if odd or not burgers.any(axis=1).all():
        return None
    low, high = np.minimum(owner, other), np.maximum(owner, other)
    there, back = (np.flatnonzero(side) for side in (owner < other, owner > other))
    there_order = there[np.lexsort((high[there], low[there]))]
    back_order = back[np.lexsort((high[back], low[back]))]
    keys = [np.stack([low[k], high[k]], axis=1) for k in (there_order, back_order)]
    if keys[0].shape != keys[1].shape or (keys[0] != keys[1]).any():
        return None
    if len(keys[0]) > 1 and (np.diff(keys[0], axis=0) == 0).all(axis=1).any():
        return None
    gaps = np.abs(burgers[there_order] + burgers[back_order]).max(axis=1, initial=0.0)
    if (gaps > 1e-6 * np.abs(burgers[there_order]).max(axis=1, initial=0.0)).any():
        return None
    pairs = np.stack([owner[there], other[there]], axis=1)
    labels = [(a, b) for a, b in names[:count].tolist()]
    kinds = nodes[:, 6].astype(np.int64)
    return labels, places, kinds, pairs, burgers[there], planes[there]


def _header(reader: _Reader) -> dict[str, Row]:
    """Every key before the nodes, with its line and words."""
    entries: dict[str, Row] = {}
    while True:
        words = reader.next("nodalData")
        key, equals, rest = " ".join(words).partition("=")
        key = key.strip()
        if key == "nodalData" and equals:
            return entries
        if not equals:
            # A value after a key without brackets, such as the bounds of domains, is not needed.
            continue
        line, rest = reader.line, rest.split()
        values = rest
        if values[:1] == ["["]:
            while "]" not in rest:
                rest = reader.next(f"] after {cut(key)}")
                values += rest
            values = values[1 : values.index("]")]
        entries[key] = line, values


def _values(reader: _Reader, header: Mapping[str, Row], key: str, count: int) -> list[str]:
    """The words of a key, of a given count."""
    if key not in header:
        raise FileFormatError(
            f"{reader.name}: expected {key} above nodalData, got a file without it. Is it a "
            "ParaDiS file of dislocations?"
        )
    reader.line, words = header[key]
    if len(words) != count:
        reader.fail(
            f"{key}: expected {count} number{'s' * (count != 1)}, got {len(words)}. Correct it."
        )
    return words


def _single(reader: _Reader, header: Mapping[str, Row], key: str, least: int = 1) -> int:
    """The single whole number of a key."""
    (word,) = _values(reader, header, key, 1)
    value = reader.whole(word, key)
    if value < least:
        reader.fail(f"{key}: expected {least} or more, got {value}. Is the file complete?")
    return value


def _corner(reader: _Reader, header: Mapping[str, Row], key: str) -> list[float]:
    """The three numbers of a key."""
    return [reader.number(word, key) for word in _values(reader, header, key, 3)]


Arms = dict[tuple[Tag, Tag], list[tuple[int, list[float]]]]


def _nodes(
    reader: _Reader, count: int
) -> tuple[dict[Tag, int], list[list[float]], list[int], Arms]:
    """Nodes, their numbers, positions and constraints, and both descriptions of each line."""
    tags: dict[Tag, int] = {}
    positions: list[list[float]] = []
    constraints: list[int] = []
    arms: Arms = {}
    for k in range(count):
        words = reader.next(f"node {k + 1} of {count}")
        if len(words) < 6:
            reader.fail(
                "expected a node (tag, x, y, z, number of arms, constraint), got "
                f"{len(words)} word{'s' * (len(words) != 1)}. Is a row missing?"
            )
        tag = reader.tag(words[0])
        if tag in tags:
            reader.fail(f"expected each node once, got node {words[0]} again. Remove one.")
        tags[tag] = k
        positions.append([reader.number(word, "a position") for word in words[1:4]])
        count_arms = reader.whole(words[4], "number of arms")
        if count_arms < 0:
            reader.fail(f"number of arms: expected zero or more, got {count_arms}. Correct it.")
        constraints.append(reader.whole(words[5], "constraint"))
        for _ in range(count_arms):
            words = reader.next(f"an arm of node {tag[0]},{tag[1]}")
            line, neighbour = reader.line, reader.tag(words[0])
            numbers = words[1:]
            if len(numbers) == 3:
                numbers = numbers + reader.next("the normal of a glide plane")
            if len(numbers) != 6:
                reader.fail(
                    f"expected b and a normal of an arm, six numbers, got {len(numbers)}. Is a row "
                    "missing?"
                )
            values = [reader.number(word, "an arm") for word in numbers]
            reader.line = line
            if neighbour == tag:
                reader.fail(
                    f"expected an arm to another node, got one from node {tag[0]},{tag[1]} to "
                    "itself. Remove it."
                )
            if not any(values[:3]):
                reader.fail(
                    "expected b different from zero, got an arm with b = 0, which is not a "
                    "dislocation. Remove it."
                )
            arms.setdefault((tag, neighbour), []).append((line, values))
    if (more := next(reader.rows, None)) is not None:
        reader.line, words = more
        reader.fail(
            f"expected the end of the file after {count} nodes (nodeCount), got "
            f"{shown(' '.join(words))}. Correct nodeCount, or remove the rest."
        )
    return tags, positions, constraints, arms


def _joined(
    name: str, tags: Mapping[Tag, int], arms: Arms
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Lines from both their descriptions: b from the second node is minus that from the first."""
    pairs: list[tuple[int, int]] = []
    values: list[list[float]] = []
    for (one, two), here in arms.items():
        line = here[0][0]
        if len(here) > BOUNDS.parallel:
            raise FileFormatError(
                f"{name}: line {line}: expected at most {BOUNDS.parallel} arms from node "
                f"{one[0]},{one[1]} to node {two[0]},{two[1]}, got {len(here):,}. Join lines that "
                "run side by side."
            )
        if two not in tags:
            raise FileFormatError(
                f"{name}: line {line}: expected an arm to a node of the file, got one to "
                f"{two[0]},{two[1]}. Is the file complete?"
            )
        there = list(arms.get((two, one), []))
        if len(here) != len(there):
            raise FileFormatError(
                f"{name}: line {line}: expected as many arms from node {one[0]},{one[1]} to "
                f"{two[0]},{two[1]} as back, got {len(here)} and {len(there)} back. Give each line "
                "at both its nodes."
            )
        if tags[one] > tags[two]:
            continue
        for line, row in here:
            gaps = [max(abs(a + b) for a, b in zip(row[:3], x[:3], strict=True)) for _, x in there]
            best = gaps.index(min(gaps))
            # Files carry eleven digits; only both rows having the same b is checked.
            if gaps[best] > 1e-6 * max(map(abs, row[:3])):
                raise FileFormatError(
                    f"{name}: line {line}: expected opposite b at both nodes of a line, got "
                    f"{row[:3]} from node {one[0]},{one[1]} and {there[best][1][:3]} from "
                    f"{two[0]},{two[1]} (line {there[best][0]}). Correct one of them."
                )
            del there[best]
            pairs.append((tags[one], tags[two]))
            values.append(row)
    table = np.array(values).reshape(-1, 6)
    return np.array(pairs, dtype=np.int64).reshape(-1, 2), table[:, :3], table[:, 3:]


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
        There is no box along the coordinates, b has not three components, or a line is longer
        than half a period, which a reader of the file could not distinguish from a shorter one.
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
