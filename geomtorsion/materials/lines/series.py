"""Series: dislocation networks in time, from the files of a simulation."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.errors import FileFormatError, NetworkError
from geomtorsion.materials.lines.dislocation_network import DislocationNetwork
from geomtorsion.materials.lines.line_families import Symmetry
from geomtorsion.materials.lines.reactions import Vector, exact_vector, size, written
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.checks import shown
from geomtorsion.support.files import ending

# File endings of networks in a folder.
ENDINGS = (".data", ".ca", ".json")
_NUMBER = re.compile(r"(\d+)")


@dataclass(frozen=True)
class JunctionChange:
    """Junction that forms or dissolves between two times.

    times: before and after. position: of the node, coordinates. burgers: b of the lines that leave
    it, sorted, up to a common sign; their sum is zero. has_formed: otherwise it has dissolved.
    """

    times: tuple[float, float]
    position: tuple[float, ...]
    burgers: tuple[Vector, ...]
    has_formed: bool

    @property
    def reaction(self) -> str:
        """The lines that meet, in words: b1 + b2 + b3 = 0."""
        return f"{' + '.join(map(written, self.burgers))} = 0"

    def __str__(self) -> str:
        verb = "forms" if self.has_formed else "dissolves"
        return f"{self.times[0]:g} to {self.times[1]:g}: {self.reaction} {verb}"


@dataclass(frozen=True, eq=False)
class DislocationSeries:
    """Dislocation networks of one crystal at increasing times.

    times: one for each network, shape (n,), in any unit. networks: one for each time.

    Raises
    ------
    NetworkError
        There is no network, or the times are not increasing.

    Examples
    --------
    A ring that shrinks in a box of side 4:

    >>> from geomtorsion.materials.lines import Box, LineArrays
    >>> box, sides = Box.of_bounds([0, 0, 0], [4, 4, 4]), [[0, 1], [1, 2], [2, 3], [3, 0]]
    >>> corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    >>> rings = [LineArrays(size * corners + 2, sides, [[0, 0, 1]] * 4, box) for size in (1, 0.5)]
    >>> series = DislocationSeries([0, 10], [DislocationNetwork.of_arrays(one) for one in rings])
    >>> series.density.tolist(), series.changes
    ([0.125, 0.0625], ())
    """

    times: np.ndarray | Sequence[float]
    networks: Sequence[DislocationNetwork]

    def __post_init__(self) -> None:
        """Check the times and the networks once."""
        networks = tuple(checks.entries(self.networks, "networks", NetworkError))
        for k, one in enumerate(networks):
            checks.instance(one, DislocationNetwork, f"networks[{k}]", NetworkError)
        times = checks.array(self.times, "times", NetworkError, shape=(None,))
        if not networks or len(times) != len(networks) or (np.diff(times) <= 0).any():
            raise NetworkError(
                f"times: expected {max(len(networks), 1)} increasing times, one for each network, "
                f"got {len(times)} for {len(networks)} networks: {shown(times.tolist()[:5])}. Sort "
                "the files, or give times."
            )
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "networks", networks)

    @classmethod
    def read(
        cls,
        source: str | Path | Sequence[str | Path],
        periodic: bool = True,
        times: Sequence[float] | None = None,
    ) -> DislocationSeries:
        """Read the networks of a folder, of a pattern such as "run/*.data", or of a list of files.

        Files are sorted by the numbers in their names.

        Parameters
        ----------
        periodic
            As for `DislocationNetwork.read`.
        times
            One for each file in this order. By default the number in which the names differ, such
            as 100 of config.00100.data, or 0, 1, ... if they differ otherwise.

        Raises
        ------
        FileFormatError
            There is no such file, or one of them cannot be read.
        NetworkError
            The times are not increasing.
        """
        files = _files(source)
        if times is None:
            times = _times(files)
        return cls(times, [DislocationNetwork.read(file, periodic) for file in files])

    def __len__(self) -> int:
        return len(self.networks)

    def __iter__(self) -> Iterator[DislocationNetwork]:
        return iter(self.networks)

    def __getitem__(self, index: int) -> DislocationNetwork:
        return self.networks[index]

    def __repr__(self) -> str:
        first, last = self.times[0], self.times[-1]
        return f"DislocationSeries({len(self)} networks, times {first:g} to {last:g})"

    # -- measures ---------------------------------------------------------------------------------

    @cached_property
    def density(self) -> np.ndarray:
        """Length of all lines over the volume of the box at each time, shape (n,)."""
        return np.array([one.density if one.lines else 0.0 for one in self.networks])

    @cached_property
    def junctions(self) -> np.ndarray:
        """Number of junctions at each time, shape (n,)."""
        return np.array([len(one.junctions) for one in self.networks])

    def densities(self, symmetry: Symmetry = "cubic") -> dict[str, np.ndarray]:
        """Density of each family at each time, shape (n,); the largest in the sum first.

        symmetry: as for `DislocationNetwork.families`.
        """
        found: dict[str, np.ndarray] = {}
        for k, one in enumerate(self.networks):
            for family in one.families(symmetry) if one.lines else ():
                row = found.setdefault(family.name, np.zeros(len(self)))
                row[k] = family.density or 0.0
        return dict(sorted(found.items(), key=lambda item: -item[1].sum()))

    @cached_property
    def changes(self) -> tuple[JunctionChange, ...]:
        """Junctions that form and dissolve from each time to the next.

        Junctions of the same reaction at two times are one if they are less than half of the mean
        distance of lines apart, 1 / (2 sqrt(density)), and nearest to each other in the sum; the
        others dissolve or form. Save times more often if lines move farther than that.
        """
        found: list[JunctionChange] = []
        nodes = [_junctions(one) for one in self.networks]
        for k in range(len(self) - 1):
            before, after = nodes[k], nodes[k + 1]
            times = float(self.times[k]), float(self.times[k + 1])
            largest = max(self.density[k], self.density[k + 1])
            reach = 0.5 / np.sqrt(largest) if largest else 0.0
            for key in sorted({*before, *after}, key=str):
                old, new = before.get(key, []), after.get(key, [])
                kept = _paired(self.networks[k], old, new, reach)
                for places, one_side, has_formed in ((old, 0, False), (new, 1, True)):
                    same = {pair[one_side] for pair in kept}
                    found += [
                        JunctionChange(times, place, key, has_formed)
                        for j, place in enumerate(places)
                        if j not in same
                    ]
        return tuple(found)

    def reactions(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Numbers of junctions that form and dissolve in each interval, by reaction.

        Returns
        -------
        Reaction in words -> two arrays of shape (n - 1,): formed, dissolved.
        """
        counts: dict[str, tuple[np.ndarray, np.ndarray]] = {}
        number = {float(time): k for k, time in enumerate(self.times)}
        for one in self.changes:
            zeros = np.zeros(len(self) - 1, dtype=int), np.zeros(len(self) - 1, dtype=int)
            row = counts.setdefault(one.reaction, zeros)
            row[0 if one.has_formed else 1][number[one.times[0]]] += 1
        return counts


def _files(source: str | Path | Sequence[str | Path]) -> list[Path]:
    """The files of a series, sorted by the numbers in their names."""
    if isinstance(source, str | Path):
        path = checks.file_name(source)
        if path.is_dir():
            files = [file for file in path.iterdir() if ending(file) in ENDINGS and file.is_file()]
        elif "*" in path.name:
            files = list(path.parent.glob(path.name))
        else:
            files = [path]
    else:
        given = checks.entries(source, "source", FileFormatError)
        files = [checks.file_name(file) for file in given]
    if not files:
        raise FileFormatError(
            f"{shown(str(source))}: expected files of networks ({', '.join(ENDINGS)}), got none. "
            "Give a folder, a pattern such as run/*.data, or a list of files."
        )
    return sorted(files, key=lambda file: (_parts(file.name)[1], file.name))


def _parts(name: str) -> tuple[list[str], list[int]]:
    """The texts in a name and the numbers between them."""
    words = _NUMBER.split(name)
    return words[::2], [int(word[-18:]) for word in words[1::2]]


def _times(files: Sequence[Path]) -> list[float]:
    """The number in which names differ, or 0, 1, ... if they differ otherwise."""
    parts = [_parts(file.name) for file in files]
    same = all(texts == parts[0][0] for texts, _ in parts)
    table = np.array([numbers for _, numbers in parts]) if same else np.zeros((len(files), 0))
    wide = [column for column in table.T if len(set(column.tolist())) > 1]
    if len(wide) == 1 and len(set(wide[0].tolist())) == len(files):
        return [float(x) for x in wide[0].tolist()]
    return [float(k) for k in range(len(files))]


def _junctions(net: DislocationNetwork) -> dict[tuple[Vector, ...], list[tuple[float, ...]]]:
    """Positions of the junctions of each kind: b of the lines that leave, up to a common sign."""
    found: dict[tuple[Vector, ...], list[tuple[float, ...]]] = {}
    names: dict[tuple[int, ...], Vector] = {}
    scale = max((size(one.burgers) for one in net.lines), default=1.0) * 1e-6

    def named(b: Sequence[float]) -> Vector:
        # Floats that differ by rounding are one vector.
        key = tuple(round(float(x) / scale) for x in b)
        return names.setdefault(key, exact_vector([x + 0 for x in b], "b"))

    for node in net.junctions:
        place = net.graph.nodes[node].get("position")
        if place is None:
            raise NetworkError(
                f"node {node!r}: expected a position, got none. Give positions of the nodes."
            )
        leaving = [b for *_, b in net.graph.out_edges(node, data="burgers")]
        leaving += [tuple(-x for x in b) for *_, b in net.graph.in_edges(node, data="burgers")]
        ways = [
            tuple(sorted((named([sign * x for x in b]) for b in leaving), key=_floats))
            for sign in (1, -1)
        ]
        key = max(ways, key=lambda way: [_floats(b) for b in way])
        found.setdefault(key, []).append(tuple(float(x) for x in place))
    return found


def _floats(vector: Vector) -> list[float]:
    return [float(x) for x in vector]


def _paired(
    net: DislocationNetwork,
    old: Sequence[tuple[float, ...]],
    new: Sequence[tuple[float, ...]],
    reach: float,
) -> list[tuple[int, int]]:
    """Pairs of positions that are one junction, by the least sum of distances."""
    if not old or not new:
        return []
    gaps = np.array(old)[:, None] - np.array(new)[None]
    if net.box is not None:
        shares = gaps @ np.linalg.inv(np.asarray(net.box.vectors))
        gaps = gaps - np.where(net.box.periodic, np.rint(shares), 0.0) @ np.asarray(net.box.vectors)
    distances = np.linalg.norm(gaps, axis=2)
    # A pair beyond the reach is no better than none.
    costs = np.minimum(distances, 2 * reach)
    rows, columns = scipy.optimize.linear_sum_assignment(costs)
    pairs = zip(rows.tolist(), columns.tolist(), strict=True)
    return [(a, b) for a, b in pairs if distances[a, b] < reach]
