"""Complexes: boundaries as whole numbers; the boundary of a boundary vanishes."""

# Bad input, and results that may be None.
# pyright: reportArgumentType=false, reportOptionalMemberAccess=false

from math import comb, prod

import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.spatial import Delaunay

from geomtorsion.errors import NetworkError
from geomtorsion.loops import Complex
from tests.rounding import ROUNDED


@pytest.mark.parametrize(
    ("shape", "periodic"),
    [
        ((5,), False),
        ((4, 3), False),
        ((4, 3), (True, False)),
        ((2, 3, 4), False),
        ((3, 4, 2), True),
        ((1, 1), True),
        ((3, 2, 2, 3), (False, True, False, True)),
    ],
)
def test_grids_have_as_many_edges_faces_and_cells_as_they_should(shape, periodic):
    """Counts for each choice of axes; on a torus, binomial coefficients times the nodes."""
    around = [periodic] * len(shape) if isinstance(periodic, bool) else list(periodic)
    found = Complex.grid(shape, periodic)
    for degree in range(4):
        expected = 0
        for mask in range(2 ** len(shape)):
            along = [k for k in range(len(shape)) if mask >> k & 1]
            if len(along) == degree:
                sizes = [n - (k in along and not around[k]) for k, n in enumerate(shape)]
                expected += prod(sizes)
        assert found.size(degree) == expected
        if all(around):
            assert expected == comb(len(shape), degree) * prod(shape)
    for degree in (1, 2):
        if found.size(degree + 1):
            assert not (found.boundary(degree) @ found.boundary(degree - 1)).toarray().any()
    assert found.images.shape == (found.size(1), sum(around))


def test_faces_of_a_grid_turn_from_the_first_axis_to_the_second():
    """Faces have positive area by the shoelace formula, and cells have their faces outwards."""
    grid = Complex.grid((3, 4, 3))
    place = np.stack(np.unravel_index(np.arange(36), (3, 4, 3)), axis=1)
    middle = place[grid.pairs].mean(axis=1)
    step = np.diff(place[grid.pairs], axis=1)[:, 0]
    moment = np.cross(middle, step)
    areas = grid.faces @ moment / 2
    centres = abs(grid.faces) @ middle / 4
    counts = [(np.abs(areas[:, k]) > 0.5).sum() for k in range(3)]
    assert counts == [2 * 3 * 3, 2 * 4 * 2, 2 * 3 * 3]
    # xy and yz turn about +z and +x; xz, from x to z, about -y.
    assert (areas.sum(axis=0) == [18, -16, 18]).all()
    outward = grid.cells @ (areas * centres).sum(axis=1) / 3
    assert np.abs(outward - 1).max() < ROUNDED


@pytest.mark.parametrize("dimension", [2, 3])
def test_simplices_of_scattered_points(dimension):
    """Delaunay: Euler's number is 1, cells have all their sides, and the rim is the hull."""
    points = np.random.default_rng(3).random((60, dimension))
    corners = Delaunay(points).simplices
    found = Complex.of_simplices(corners, len(points))
    euler = sum((-1) ** k * found.size(k) for k in range(4))
    assert euler == 1
    assert (np.sort(abs(found.boundary(dimension - 1)).sum(axis=1)) == dimension + 1).all()
    rim = found.boundary(dimension - 1).T @ np.sign(
        np.linalg.det(points[corners[:, 1:]] - points[corners[:, :1]])
    ).astype(int)
    # Inner sides cancel, and the sides of the hull remain.
    assert np.abs(rim).sum() == len(Delaunay(points).convex_hull)


def test_faces_from_cycles_of_nodes():
    """Faces may be given by names or numbers of nodes; signs follow the edges."""
    plain = Complex.of_edges([[0, 1], [2, 1], [2, 0], [2, 3], [3, 0]], labels="abcd")
    named = plain.with_faces(["abca", "acd"])
    assert named.faces.toarray().tolist() == [[1, -1, 1, 0, 0], [0, 0, -1, 1, 1]]
    numbered = plain.with_faces(np.array([[0, 1, 2], [0, 2, 3]]))
    assert (numbered.faces != named.faces).nnz == 0
    assert repr(named) == "Complex(4 nodes, 5 edges, 2 faces)"
    with pytest.raises(NetworkError, match="no edge between 'b' and 'd'"):
        plain.with_faces(["abd"])
    with pytest.raises(NetworkError, match="node 'x' is not in the network"):
        plain.with_faces(["abx"])


SQUARE = [[0, 1], [1, 2], [2, 3], [3, 0]]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Complex.of_edges([[0, 1, 2]]), r"expected whole numbers of shape \(any, 2\)"),
        (lambda: Complex.of_edges([[0, 1.5]]), "pairs: expected whole numbers"),
        (lambda: Complex.of_edges([["a", "b"]]), "pairs: expected whole numbers"),
        (lambda: Complex.of_edges([[0, 1], [2]]), "pairs: expected whole numbers"),
        (lambda: Complex.of_edges([[0, 5]], 3), "from 0 to 2, got 0 to 5"),
        (lambda: Complex.of_edges([[-1, 0]]), "from 0 to 0, got -1"),
        (lambda: Complex.of_edges([[0, 1]], -1), "nodes: expected a whole number"),
        (lambda: Complex.of_edges(SQUARE, images=[[1]]), "one for each of 4 edges, got 1"),
        (lambda: Complex.of_edges(SQUARE, labels="ab"), "labels: expected one for each of 4 nodes"),
        (lambda: Complex.of_simplices([[0, 1]]), "3 or 4 corners"),
        (lambda: Complex.of_simplices([[0, 1, 1]]), "must differ"),
        (lambda: Complex.grid((2, 2), (True,)), "periodic: expected 2 truth values, got"),
        (lambda: Complex.grid((2, -1)), r"shape\[1\]: expected a whole number"),
        (lambda: Complex.of_edges(SQUARE).boundary(1), "has no faces"),
        (lambda: Complex.of_edges(SQUARE).boundary(5), "a whole number from 0 to 2"),
        (
            lambda: Complex(4, np.array(SQUARE), np.zeros((4, 0), int), csr_array([[1, 1, 1, -1]])),
            r"face 0 is not closed: its edges \[0, 1, 2, 3\]",
        ),
        (
            lambda: Complex(4, np.array(SQUARE), np.zeros((4, 0), int), csr_array([[1, 1, 1]])),
            "a column for each of 4 edges",
        ),
        (
            lambda: Complex(
                4, np.array(SQUARE), np.array([[0], [0], [0], [1]]), csr_array([[1, 1, 1, 1]])
            ),
            r"face 0 winds around a period: \[1\]",
        ),
        (
            lambda: Complex(
                4, np.array(SQUARE), np.zeros((4, 0), int), csr_array([[1, 1, 1, 1]]),
                csr_array([[1]]),
            ),
            r"cell 0 is not closed: its faces \[0\]",
        ),
    ],
)  # fmt: skip
def test_bad_complexes_are_refused(make, message):
    """Each kind of bad input has its own message."""
    with pytest.raises(NetworkError, match=message):
        make()
