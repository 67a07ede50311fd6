"""Line families: lines whose Burgers vectors are equivalent by a symmetry of the lattice."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations, product

import numpy as np

from geomtorsion.errors import NetworkError
from geomtorsion.materials.lines.line_arrays import LineArrays
from geomtorsion.materials.structures import STRUCTURES
from geomtorsion.support import checks

LATTICES = {name: np.array(one.rows, dtype=float) for name, one in STRUCTURES.items() if one.rows}
SYMMETRIES = ("cubic", "hexagonal", "none")
Lattice = str | Sequence[Sequence[float]] | np.ndarray
Symmetry = str | Sequence[Sequence[Sequence[float]]] | np.ndarray


@dataclass(frozen=True)
class LineFamily:
    """Lines of one family.

    name: its Burgers vectors, as 0.7071 <1 1 0>; burgers: one of them, shape (n,).
    lines: number of lines; length: of all of them, coordinates.
    density: length over volume of the box, None without a box.
    screw: share of b^2 along the line, averaged over length; the rest is edge.
    """

    name: str
    burgers: tuple[float, ...]
    lines: int
    length: float
    density: float | None
    screw: float

    @property
    def edge(self) -> float:
        """Share of b^2 perpendicular to the line."""
        return 1.0 - self.screw


def line_families(
    lines: LineArrays, symmetry: Symmetry = "cubic", tolerance: float = 1e-6
) -> tuple[tuple[LineFamily, ...], np.ndarray]:
    """Families, the longest first, and the number of the family of each line, shape (lines,).

    Parameters
    ----------
    symmetry
        "cubic": the 48 operations that permute and reverse axes (fcc, bcc, diamond);
        "hexagonal": the 24 of a prism about z whose edge is along x (hcp: a along x); "none": only
        b and -b, since both describe one line. Or matrices, shape (k, n, n), such as the
        operations of a crystal with another orientation in the box; -1 is added.
    tolerance
        Share of the largest b within which components count as equal.

    Examples
    --------
    A screw of length 2 and an edge of length 3, both with b along x or y:

    >>> corners, sides = [[0, 0, 0], [2, 0, 0], [2, 0, 3]], [[0, 1], [1, 2]]
    >>> (found,), _ = line_families(LineArrays(corners, sides, [[1, 0, 0], [0, -1, 0]]))
    >>> found.name, found.length, found.screw
    ('1 <1 0 0>', 5.0, 0.4)
    """
    # Even very many lines have few different b.
    vectors, which = np.unique(lines.burgers, axis=0, return_inverse=True)
    dimension = vectors.shape[1]
    near = tolerance * float(np.abs(vectors).max(initial=0.0))
    orbit = _operations(symmetry, dimension)
    family = np.full(len(vectors), -1)
    # Members of a family are equally long: only vectors of equal length are compared.
    sizes = np.linalg.norm(vectors, axis=1)
    order = np.argsort(sizes, kind="stable")
    breaks = np.flatnonzero(np.diff(sizes[order]) > 2 * near * np.sqrt(dimension)) + 1
    count = 0
    for group in np.split(order, breaks):
        left = group
        while len(left):
            images = orbit @ vectors[left[0]]
            distances = np.abs(vectors[left, None] - images[None]).max(axis=2).min(axis=1)
            family[left[distances <= near]] = count
            left = left[distances > near]
            count += 1
    family = family[which.ravel()]
    titles, kinds = [], []
    for k in range(count):
        one = lines.burgers[family == k][0]
        shown = _largest(orbit @ one) if len(orbit) > 2 else one
        kinds.append(tuple(shown.tolist()))
        titles.append(_name(kinds[-1], "<>" if len(orbit) > 2 else "[]"))
    return _measured(lines, family, titles, kinds)


def named_families(
    lines: LineArrays, names: Sequence[str]
) -> tuple[tuple[LineFamily, ...], np.ndarray]:
    """Families of lines whose families are known by name, such as 1/2<1 1 0> of a crystal.

    Examples
    --------
    >>> corners, sides = [[0, 0, 0], [2, 0, 0], [2, 0, 3]], [[0, 1], [1, 2]]
    >>> lines = LineArrays(corners, sides, [[1, 0, 0], [0, 0, 2]])
    >>> [(one.name, one.length) for one in named_families(lines, ["<1 0 0>", "<2 0 0>"])[0]]
    [('<2 0 0>', 3.0), ('<1 0 0>', 2.0)]
    """
    titles, family = np.unique(np.array(names, dtype=str), return_inverse=True)
    kinds = [tuple(lines.burgers[family == k][0].tolist()) for k in range(len(titles))]
    return _measured(lines, family.ravel(), titles.tolist(), kinds)


def _measured(
    lines: LineArrays,
    family: np.ndarray,
    titles: Sequence[str],
    kinds: Sequence[tuple[float, ...]],
) -> tuple[tuple[LineFamily, ...], np.ndarray]:
    """Families with lengths, the longest first, and the number of the family of each line."""
    screws, lengths = lines.screw_shares, lines.lengths
    volume = None if lines.box is None else lines.box.volume
    families = []
    for k, title in enumerate(titles):
        mine = family == k
        length = float(lengths[mine].sum())
        screw = float(screws[mine] @ lengths[mine]) / length if length else 0.0
        density = None if volume is None else length / volume
        families.append(LineFamily(title, kinds[k], int(mine.sum()), length, density, screw))
    rank = sorted(range(len(families)), key=lambda k: (-families[k].length, families[k].name))
    place = np.argsort(np.array(rank, dtype=np.int64))
    return tuple(families[k] for k in rank), place[family] if families else family


def _operations(symmetry: Symmetry, dimension: int) -> np.ndarray:
    """Operations of a symmetry, shape (k, n, n)."""
    if not isinstance(symmetry, str):
        shape = (None, dimension, dimension)
        matrices = checks.array(symmetry, "symmetry", NetworkError, shape=shape)
        gram = np.einsum("kij,kil->kjl", matrices, matrices)
        if not np.allclose(gram, np.eye(dimension), atol=1e-6):
            raise NetworkError(
                "symmetry: expected rotations and reflections, got a matrix that is not "
                "orthogonal. Give them in the axes of b."
            )
        return np.concatenate([matrices, -matrices, [np.eye(dimension), -np.eye(dimension)]])
    checks.choice(symmetry, SYMMETRIES, "symmetry", NetworkError)
    if symmetry == "none":
        return np.array([np.eye(dimension), -np.eye(dimension)])
    if symmetry == "hexagonal":
        if dimension != 3:
            raise NetworkError(
                f"symmetry: expected three components of b for 'hexagonal', got {dimension}. Give "
                "the symmetry as matrices."
            )
        angles = np.pi / 3 * np.arange(6)
        turns = np.array([[[np.cos(t), -np.sin(t)], [np.sin(t), np.cos(t)]] for t in angles])
        flat = np.concatenate([turns, turns @ np.diag([1.0, -1.0])])
        group = np.zeros((24, 3, 3))
        group[:, :2, :2], group[:12, 2, 2], group[12:, 2, 2] = np.tile(flat, (2, 1, 1)), 1.0, -1.0
        return group
    rows = permutations(np.eye(dimension))
    signs = list(product((1.0, -1.0), repeat=dimension))
    return np.array([np.array(row) * np.array(sign)[:, None] for row in rows for sign in signs])


def _largest(images: np.ndarray) -> np.ndarray:
    """The last image in lexicographic order, independent of rounding."""
    shown = np.round(images / np.abs(images).max(), 6)
    return images[np.lexsort(shown.T[::-1])[-1]] + 0.0


def _name(vector: Sequence[float], marks: str) -> str:
    """A Burgers vector as a length times small whole numbers, if possible."""
    least = min(abs(x) for x in vector if abs(x) > 1e-6 * max(map(abs, vector)))
    ratios = [x / least for x in vector]
    if all(abs(x - round(x)) < 1e-4 * max(map(abs, ratios)) and abs(x) < 10 for x in ratios):
        inner = " ".join(str(round(x)) for x in ratios)
        return f"{least:.4g} {marks[0]}{inner}{marks[1]}"
    return marks[0] + " ".join(f"{x:.4g}" for x in vector) + marks[1]


def lattice_vectors(lattice: Lattice, dimension: int) -> np.ndarray:
    """Lattice vectors as rows, shape (n, n), of a lattice given by name or by vectors.

    Raises
    ------
    NetworkError
        There is no such lattice, or the vectors have another shape or are in one plane.
    """
    if isinstance(lattice, str):
        checks.choice(lattice, tuple(LATTICES), "lattice", NetworkError)
        lattice = LATTICES[lattice]
    rows = checks.array(lattice, "lattice", NetworkError, shape=(dimension, dimension))
    if np.linalg.matrix_rank(rows) < dimension:
        raise NetworkError(
            "lattice: expected independent vectors as rows, got dependent ones. Correct them."
        )
    return rows


def lattice_coordinates(vectors: np.ndarray, lattice: Lattice, tolerance: float) -> np.ndarray:
    """Burgers vectors as whole multiples of lattice vectors, shape (k, n).

    Parameters
    ----------
    lattice
        Lattice vectors as rows, shape (n, n), or "sc", "fcc", "bcc", "hcp" in units of the
        shortest.
    tolerance
        Largest difference from lattice vectors, as a share of the largest vector.

    Raises
    ------
    NetworkError
        A vector is not in the lattice; the message names it and its distance from the lattice.

    Examples
    --------
    >>> import numpy as np
    >>> lattice_coordinates(np.array([[0.5, 0.5]]), [[1, 0], [0.5, 0.5]], 1e-9).tolist()
    [[0, 1]]
    """
    rows = lattice_vectors(lattice, vectors.shape[1])
    whole = np.rint(np.linalg.solve(rows.T, vectors.T).T)
    gaps = np.abs(whole @ rows - vectors).max(axis=1, initial=0.0)
    scale = float(np.abs(vectors).max(initial=0.0))
    if (gaps > tolerance * scale).any() or (np.abs(whole) > 2.0**31).any():
        worst = int(gaps.argmax())
        raise NetworkError(
            f"lattice: expected a lattice that contains each b, got one whose vector nearest to "
            f"b = {checks.shown(vectors[worst].tolist())} is {gaps[worst]:.3g} away. Give the "
            "lattice in the units of b."
        )
    return whole.astype(np.int64)
