"""Crystal Analysis files: dislocation lines as OVITO writes and reads them (.ca)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion.errors import FileFormatError, GeomtorsionError, NetworkError
from geomtorsion.materials.lines.box import Box
from geomtorsion.materials.lines.line_arrays import DislocationLine, LineArrays
from geomtorsion.materials.lines.polylines import Polyline
from geomtorsion.materials.lines.reactions import CONSTRAINTS
from geomtorsion.materials.structures import STRUCTURES
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.checks import shown
from geomtorsion.support.files import finite_number, read_text
from geomtorsion.support.text_rows import TextRows

# A number that ParaDiS gives to nodes at which a line leaves the crystal.
AT_SURFACE = max(number for number, kind in CONSTRAINTS.items() if kind == "surface")

NAMES = tuple(name for name, one in STRUCTURES.items() if one.number)


# -- writing --------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Cluster:
    """A grain, in the form that OVITO uses.

    lattice: one of NAMES, by whose families OVITO names and colours lines.
    matrix: takes a vector in units of the lattice to one in space, shape (3, 3); OVITO calls it the
        orientation of the cluster. The file has b in units of the lattice.
    atoms: number of atoms.
    """

    lattice: str = ""
    matrix: np.ndarray = field(default_factory=lambda: np.eye(3))
    atoms: int = 0

    def __post_init__(self) -> None:
        """Check the input."""
        checks.choice(self.lattice, NAMES, "lattice", NetworkError)
        matrix = checks.array(self.matrix, "matrix", NetworkError, shape=(3, 3))
        if np.linalg.matrix_rank(matrix) < 3:
            raise NetworkError(
                "matrix: expected three independent columns, got columns in one plane. Correct it."
            )
        object.__setattr__(self, "matrix", matrix)

    @cached_property
    def inverse(self) -> np.ndarray:
        """Takes a vector in space to a vector in units of the lattice."""
        return np.linalg.inv(self.matrix)


# Grains, the grain of each curve, and pairs of grains that touch.
Clusters = tuple[Sequence[Cluster], Sequence[int], Sequence[tuple[int, int]]]


def clusters_of(
    known: Mapping[str, Any],
    lines: Sequence[DislocationLine],
    owners: Sequence[int],
    curves: Sequence[Polyline],
) -> Clusters:
    """The grains of a network, the grain of each polyline, and pairs of grains that touch.

    known: clusters by number of the grain, and walls, pairs of these, where there are any. owners:
    number of the line to which each straight piece belongs.
    """
    clusters: Mapping[int | None, Cluster] = known.get("clusters") or {None: Cluster()}
    if None not in clusters:
        # Clusters have the numbers of grains: a grain that no longer exists has no atoms.
        gone = Cluster(next(iter(clusters.values())).lattice)
        numbers = [number for number in clusters if number is not None]
        clusters = {number: clusters.get(number, gone) for number in range(max(numbers) + 1)}
    place = {number: k for k, number in enumerate(clusters)}
    mine = [place.get(lines[owners[curve.numbers[0]]].grain, 0) for curve in curves]
    walls = [(place[one], place[other]) for one, other in known.get("walls", ())]
    return list(clusters.values()), mine, walls


def crystal_analysis_text(
    lines: LineArrays,
    curves: Sequence[Polyline],
    clusters: Sequence[Cluster] = (),
    owners: Sequence[int] | None = None,
    walls: Sequence[tuple[int, int]] = (),
) -> str:
    """Lines as the text of a Crystal Analysis file, every number to the last digit.

    Parameters
    ----------
    curves
        The polylines of the lines; their b in the coordinates of the nodes.
    clusters, owners
        Grains, and the grain of each curve, counted from 0; all curves are in the first grain if
        not given, and this grain has no lattice if there are no clusters.
    walls
        Pairs of clusters that touch. The transition from one to the other takes a vector in units
        of the lattice of the first to the same vector in space in units of the second lattice.

    Raises
    ------
    NetworkError
        The network has no box, or b does not have three components.
    """
    if lines.box is None:
        raise NetworkError(
            "expected a network with a box for a Crystal Analysis file, got one without. Give the "
            "cell of the simulation: DislocationNetwork(graph, box=Box(vectors))."
        )
    if lines.burgers.shape[1] != 3:
        raise NetworkError(
            f"expected three components of b for a Crystal Analysis file, got "
            f"{lines.burgers.shape[1]}. Save the network as .json."
        )
    clusters = clusters or (Cluster(),)
    lattices = list(dict.fromkeys(cluster.lattice for cluster in clusters))
    head = [
        "CA_FILE_VERSION 6", "CA_LIB_VERSION 0.0.0", f"STRUCTURE_TYPES {len(lattices)}",
        *(row for lattice in lattices for row in _structure(lattice)),
    ]  # fmt: skip
    vectors, origin = np.asarray(lines.box.vectors), np.asarray(lines.box.origin)
    head += [
        f"SIMULATION_CELL_ORIGIN {_row(origin)}", "SIMULATION_CELL_MATRIX",
        *map(_row, vectors.T),
        f"PBC_FLAGS {' '.join(str(int(flag)) for flag in lines.box.periodic)}",
        f"CLUSTERS {len(clusters)}",
    ]  # fmt: skip
    for k, cluster in enumerate(clusters, 1):
        head += [
            f"CLUSTER {k}", f"CLUSTER_STRUCTURE {STRUCTURES[cluster.lattice].number}",
            "CLUSTER_ORIENTATION", *map(_row, cluster.matrix), "CLUSTER_COLOR 1 1 1",
            f"CLUSTER_SIZE {cluster.atoms}", "END_CLUSTER",
        ]  # fmt: skip
    head.append(f"CLUSTER_TRANSITIONS {len(walls)}")
    for one, other in walls:
        between = clusters[other].inverse @ clusters[one].matrix
        head += [f"TRANSITION {one} {other}", _row(between.ravel())]
    head.append(f"DISLOCATIONS {len(curves)}")
    for k, curve in enumerate(curves):
        mine = 0 if owners is None else owners[k]
        local = _row(clusters[mine].inverse @ np.array([float(x) for x in curve.burgers]))
        head += [str(k), local, str(1 + mine), str(len(curve.points)), *map(_row, curve.points)]
    return "\n".join([*head, "DISLOCATION_JUNCTIONS", *_rings(curves)]) + "\n"


def _structure(lattice: str) -> Iterator[str]:
    """A lattice with its families."""
    one = STRUCTURES[lattice]
    yield from (
        f"STRUCTURE_TYPE {one.number}", f"NAME {lattice or 'unknown'}", f"FULL_NAME {one.title}",
        "COLOR 0.4 0.4 1", "TYPE LATTICE", f"BURGERS_VECTOR_FAMILIES {1 + len(one.families)}",
        "BURGERS_VECTOR_FAMILY ID 0", "Other", "0 0 0", "0.9 0.2 0.2",
    )  # fmt: skip
    for k, family in enumerate(one.families, 1):
        yield from (f"BURGERS_VECTOR_FAMILY ID {k}", *family)
    yield "END_STRUCTURE_TYPE"


def _row(values: np.ndarray) -> str:
    """Numbers with all their digits; minus zero is zero."""
    return " ".join(repr(float(x) + 0.0) for x in values)


def _rings(curves: Sequence[Polyline]) -> Iterator[str]:
    """The next end in the ring around their node, for the end and the start of each line."""
    arms: dict[object, list[tuple[int, int]]] = {}
    for k, curve in enumerate(curves):
        arms.setdefault(curve.nodes[-1], []).append((1, k))
        arms.setdefault(curve.nodes[0], []).append((0, k))
    after = {
        arm: ring[(place + 1) % len(ring)]
        for ring in arms.values()
        for place, arm in enumerate(ring)
    }
    for k in range(len(curves)):
        for end in (1, 0):
            other, line = after[end, k]
            yield f"{other} {line}"


# -- reading --------------------------------------------------------------------------------------


def read_crystal_analysis(path: str | PathLike[str]) -> LineArrays:
    """Read the dislocation lines of a Crystal Analysis file; b in space, each line once.

    Each of several clusters is a grain, numbered from 0 in their order. Line ends where no other
    line begins (at a surface, a grain boundary) are marked as such.

    Raises
    ------
    FileFormatError
        The file is missing, truncated or malformed; the message names the line of the file.
    """
    text = read_text(path, checks.LARGEST_ARRAYS)
    rows = TextRows(Path(path).name, text.splitlines())
    first = rows.next("CA_FILE_VERSION")
    if first[:1] != ["CA_FILE_VERSION"]:
        rows.fail(
            f"expected CA_FILE_VERSION, got {shown(' '.join(first))}. Is it a Crystal Analysis "
            "file?"
        )
    if rows.whole(_last(first), "the version of the format", below=7) < 5:
        rows.fail(
            f"expected version 5 or 6 of the format, got {shown(first[-1])}. Write the file again "
            "with OVITO."
        )
    body = _Contents()
    while (words := rows.more()) is not None:
        body.read(rows, words)
    for key, flag in (("DISLOCATIONS", body.listed), ("DISLOCATION_JUNCTIONS", body.joined)):
        if not flag:
            rows.fail(f"expected {key}, got the end of the file. Is the file complete?")
    try:
        return body.lines()
    except GeomtorsionError as error:
        raise FileFormatError(f"{rows.name}: {error}") from None


def _last(words: list[str]) -> str:
    """The last word of a row."""
    return words[-1] if words else ""


def _matrix(rows: TextRows, what: str) -> np.ndarray:
    """Three rows of three numbers; OVITO may write the size of the core after a point."""
    return np.array([rows.numbers(rows.next(what), 3, what, more=True) for _ in range(3)])


class _Contents:
    """The contents of the file, part by part."""

    def __init__(self) -> None:
        self.origin = np.zeros(3)
        self.vectors: np.ndarray | None = None
        self.periodic: list[bool] = []
        self.cluster = self.structure = 0
        self.names: dict[int, str] = {}
        self.lattices: dict[int, int] = {}
        self.sizes: dict[int, int] = {}
        self.walls: list[tuple[int, int]] = []
        self.owners: list[int] = []
        self.matrices: dict[int, np.ndarray] = {}
        self.curves: list[np.ndarray] = []
        self.burgers: list[np.ndarray] = []
        self.rings: list[tuple[int, int]] = []
        self.listed = self.joined = False

    def read(self, rows: TextRows, words: list[str]) -> None:
        """A part of the file from its first row; a row without a known keyword is skipped."""
        key, *values = words or [""]
        match key:
            case "SIMULATION_CELL_ORIGIN":
                self.origin = np.array(rows.numbers(values, 3, key, more=True))
            case "SIMULATION_CELL_MATRIX":
                # Columns are the edges.
                self.vectors = _matrix(rows, key).T
            case "PBC_FLAGS":
                if len(values) != 3 or not {"0", "1"}.issuperset(values):
                    rows.fail(
                        f"{key}: expected 0 or 1 for each of three edges, got {shown(values)}. "
                        "Write 1 for an edge along which the cell repeats."
                    )
                self.periodic = [value == "1" for value in values]
            case "STRUCTURE_TYPE":
                self.structure = rows.whole(words[-1], key)
            case "NAME":
                self.names[self.structure] = " ".join(values)
            case "CLUSTER":
                self.cluster = rows.whole(words[-1], key)
            case "CLUSTER_STRUCTURE":
                self.lattices[self.cluster] = rows.whole(words[-1], key)
            case "CLUSTER_SIZE":
                self.sizes[self.cluster] = rows.whole(words[-1], key)
            case "CLUSTER_ORIENTATION":
                self.matrices[self.cluster] = _matrix(rows, key)
            case "TRANSITION":
                # They are counted from 0.
                one, other = (
                    rows.whole(_last(words[: k + 1]), key, below=len(self.matrices)) for k in (1, 2)
                )
                self.walls.append((one, other))
            case "DISLOCATIONS":
                self._dislocations(rows, words)
            case "DISLOCATION_JUNCTIONS":
                self._junctions(rows)

    def _dislocations(self, rows: TextRows, words: list[str]) -> None:
        for k in range(rows.whole(_last(words), words[0], below=len(rows.lines))):
            what = f"dislocation {k}"
            number = rows.whole(_last(rows.next(what)), what)
            if number != k:
                rows.fail(f"expected {what}, got number {number}. Is a row missing or repeated?")
            local = rows.numbers(rows.next(what), 3, f"b of {what}", more=True)
            cluster = rows.whole(_last(rows.next(what)), f"cluster of {what}")
            if cluster not in self.matrices:
                rows.fail(
                    f"cluster of {what}: expected a cluster of the file, got {cluster}. Is the "
                    "file complete?"
                )
            count = rows.whole(_last(rows.next(what)), f"points of {what}", 2, len(rows.lines))
            points = [
                rows.numbers(rows.next(what), 3, f"a point of {what}", more=True)
                for _ in range(count)
            ]
            self.curves.append(np.array(points))
            self.burgers.append(self.matrices[cluster] @ local)
            self.owners.append(cluster)
        rest = rows.lines[rows.line].split() if rows.line < len(rows.lines) else []
        if rest and finite_number(rest[0]) is not None:
            rows.more()
            rows.fail(
                f"expected a keyword after {len(self.curves)} dislocations, got "
                f"{shown(' '.join(rest))}. Do the dislocations have a row too many?"
            )
        self.listed = True

    def _junctions(self, rows: TextRows) -> None:
        for k in range(2 * len(self.curves)):
            what = f"junction of dislocation {k // 2}"
            pair = rows.next(what)
            if len(pair) != 2 or pair[0] not in ("0", "1"):
                rows.fail(
                    f"{what}: expected 0 or 1 and the number of a dislocation, got {shown(pair)}. "
                    "Is the file complete?"
                )
            self.rings.append((rows.whole(pair[1], what, below=len(self.curves)), int(pair[0])))
        self.joined = True

    def lines(self) -> LineArrays:
        """All lines: ends that belong to one ring are one node."""
        if self.vectors is None:
            raise FileFormatError(
                "expected SIMULATION_CELL_MATRIX, got a file without it. Is the file complete?"
            )
        if not self.periodic:
            raise FileFormatError(
                "expected PBC_FLAGS, got a file without it. Write it below the cell, with 1 for "
                "each edge along which the cell repeats, or else 0."
            )
        box = Box(self.vectors, self.origin, self.periodic)
        places: list[np.ndarray] = []
        pairs: list[tuple[int, int]] = []
        vectors: list[np.ndarray] = []
        steps: list[np.ndarray] = []
        grains: list[int | None] = []
        clusters = self._known()
        number_of = {cluster: k for k, cluster in enumerate(self.matrices)}
        ends, sizes = self._ends()
        node_of: dict[int, int] = {}
        constraints: list[int] = []

        def node(place: np.ndarray, constraint: int = 0) -> int:
            places.append(place)
            constraints.append(constraint)
            return len(places) - 1

        for k, (points, b) in enumerate(zip(self.curves, self.burgers, strict=True)):
            for end, place in ((0, points[0]), (1, points[-1])):
                ring = ends[k, end]
                if ring not in node_of:
                    node_of[ring] = node(place, AT_SURFACE if sizes[ring] == 1 else 0)
            inner = [node(place) for place in points[1:-1]]
            chain = [node_of[ends[k, 0]], *inner, node_of[ends[k, 1]]]
            pairs += pairwise(chain)
            vectors += [b] * (len(chain) - 1)
            grain = None if None in clusters["clusters"] else number_of[self.owners[k]]
            grains += [grain] * (len(chain) - 1)
            steps += list(np.diff(points, axis=0))
        positions = np.array(places).reshape(-1, 3)
        numbers = np.array(pairs, dtype=np.int64).reshape(-1, 2)
        gaps = positions[numbers[:, 1]] - positions[numbers[:, 0]]
        # The node is moved by so many periods: the step less the difference of positions.
        images = -box.images(np.array(steps).reshape(-1, 3) - gaps)
        table = np.array(vectors).reshape(-1, 3)
        return LineArrays(
            positions, numbers, table, box, images, constraints=constraints, grains=grains,
            known=clusters,
        )  # fmt: skip

    def _known(self) -> dict[str, Any]:
        """Clusters by number of the grain, None for a single one, and pairs that touch."""
        clusters = []
        for cluster, matrix in self.matrices.items():
            name = self.names.get(self.lattices.get(cluster, -1), "")
            # A cluster without lines may have no orientation.
            whole = matrix if np.linalg.matrix_rank(matrix) == 3 else np.eye(3)
            lattice = name if name in NAMES else ""
            clusters.append(Cluster(lattice, whole, self.sizes.get(cluster, 0)))
        if len(clusters) < 2:
            return {"clusters": {None: (clusters or [Cluster()])[0]}}
        return {"clusters": dict(enumerate(clusters)), "walls": self.walls}

    def _ends(self) -> tuple[dict[tuple[int, int], int], dict[int, int]]:
        """The ring to which each end of a line belongs, and how many ends each ring has.

        Rows of the file are for the end (1) and then for the start (0) of each line.
        """
        after = {(k // 2, 1 - k % 2): (line, int(end)) for k, (line, end) in enumerate(self.rings)}
        ring_of: dict[tuple[int, int], int] = {}
        sizes: dict[int, int] = {}
        for arm in after:
            if arm in ring_of:
                continue
            ring = len(sizes)
            sizes[ring] = 0
            while arm not in ring_of:
                ring_of[arm] = ring
                sizes[ring] += 1
                arm = after[arm]
            if ring_of[arm] != ring:
                raise FileFormatError(
                    f"expected a closed ring of junctions at dislocation {arm[0]}, got an open "
                    "chain. Is the file complete?"
                )
        return ring_of, sizes
