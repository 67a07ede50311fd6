"""Families of Burgers vectors, and whole multiples of lattice vectors."""

# The tests pass what users pass, including wrong types, and read optional values.
# pyright: reportOperatorIssue=false

from itertools import permutations, product

import numpy as np
import pytest

from geomtorsion.errors import NetworkError
from geomtorsion.materials.lines import Box, DislocationNetwork, LineArrays
from geomtorsion.materials.lines.line_families import LATTICES, lattice_coordinates
from tests.rounding import ROUNDED

BOX = Box.of_bounds([0, 0, 0], [10, 10, 10])


def network(vectors, steps) -> DislocationNetwork:
    """One line for each b, from the origin."""
    places = [[0, 0, 0], *steps]
    pairs = [[0, k + 1] for k in range(len(vectors))]
    return DislocationNetwork.of_arrays(LineArrays(places, pairs, vectors, BOX))


def test_the_twelve_vectors_of_fcc_are_one_family():
    """All <110> are one family, <100> and <112> others; without symmetry <110> has six pairs."""
    glide = {
        tuple(s * x for s, x in zip(signs, row, strict=True))
        for row in permutations((1.0, 1.0, 0.0)) for signs in product((1, -1), repeat=3)
    }  # fmt: skip
    glide = sorted({tuple(x + 0.0 for x in row) for row in glide})
    assert len(glide) == 12
    vectors = [*glide, (0, 0, -2.0), (1, -2.0, 1.0)]
    net = network(np.array(vectors) / np.sqrt(2), [[0, 0, 1]] * 14)
    names = {one.name: one.lines for one in net.families()}
    assert names == {"0.7071 <1 1 0>": 12, "1.414 <1 0 0>": 1, "0.7071 <2 1 1>": 1}
    assert [one.lines for one in net.families("none")].count(2) == 6


def test_densities_add_up_and_characters_are_known():
    """Densities are length over volume; a line at 45 degrees to b is half screw, half edge."""
    net = network([[1, 0, 0], [0, 1, 0], [2, 0, 0]], [[2, 0, 0], [3, 0, 0], [1, 1, 0]])
    long, short = net.families()
    assert (long.name, long.lines, long.length) == ("1 <1 0 0>", 2, 5)
    assert long.screw == pytest.approx(2 / 5, abs=ROUNDED)
    assert short.edge == pytest.approx(0.5, abs=ROUNDED)
    assert long.density + short.density == pytest.approx(net.density, rel=ROUNDED)
    assert net.density == pytest.approx((5 + np.sqrt(2)) / 1000, rel=ROUNDED)


def test_the_mean_nye_tensor_of_one_line():
    """The first index is b, the second the line."""
    net = network([[1, 2, 3]], [[0, 0, 4]])
    assert net.nye.tolist() == pytest.approx(np.outer([1, 2, 3], [0, 0, 0.004]))


@pytest.mark.parametrize("name", list(LATTICES))
def test_whole_multiples_of_lattice_vectors(name):
    """Random lattice vectors read back; the shortest vectors have length one."""
    assert np.linalg.norm(LATTICES[name], axis=1).min() == pytest.approx(1)
    wanted = np.random.default_rng(3).integers(-4, 5, (40, 3))
    found = lattice_coordinates(wanted @ LATTICES[name], name, 1e-9)
    assert (found == wanted).all()


def test_bad_lattice_vectors_are_refused():
    """A partial, a flat lattice, an unknown lattice and unknown or wrong symmetries fail."""
    with pytest.raises(NetworkError, match=r"nearest to b = .* away.*units of b"):
        lattice_coordinates(np.array([[0.5, 0.5, 0]]), "sc", 1e-9)
    with pytest.raises(NetworkError, match="lattice: expected independent vectors"):
        lattice_coordinates(np.eye(3), [[1, 0, 0], [0, 1, 0], [1, 1, 0]], 1e-9)
    with pytest.raises(NetworkError, match="sc, fcc, bcc, hcp"):
        lattice_coordinates(np.eye(3), "wurtzite", 1e-9)
    with pytest.raises(NetworkError, match="cubic, hexagonal, none"):
        network([[1, 0, 0]], [[0, 0, 1]]).families("trigonal")
    with pytest.raises(NetworkError, match="got a matrix that is not orthogonal"):
        network([[1, 0, 0]], [[0, 0, 1]]).families(2 * np.eye(3)[None])


def test_families_of_bcc():
    """All <111>/2 and all <100>, in units of the shortest, each with its density."""
    glide = np.array(list(product((1, -1), repeat=3))) / np.sqrt(3)
    cubes = np.concatenate([np.eye(3), -np.eye(3)]) * 2 / np.sqrt(3)
    net = network(np.concatenate([glide, cubes]), [[0, 0, 2]] * 14)
    found = {one.name: (one.lines, one.density) for one in net.families()}
    assert found == {
        "0.5774 <1 1 1>": (8, pytest.approx(0.016)),
        "1.155 <1 0 0>": (6, pytest.approx(0.012)),
    }


def test_families_of_hcp():
    """<a>, <c> and <c + a> are three families; a cubic symmetry would mix and split them."""
    turns = np.radians(60 * np.arange(6))
    a = np.stack([np.cos(turns), np.sin(turns), 0 * turns], axis=1)
    c = np.array([[0, 0, 1.59], [0, 0, -1.59]])
    both = np.concatenate([a + c[0], a + c[1]])
    net = network(np.concatenate([a, c, both]), [[0, 0, 1]] * 20)
    found = net.families("hexagonal")
    assert sorted(one.lines for one in found) == [2, 6, 12]
    longest = {one.lines: one for one in found}
    assert longest[6].burgers == pytest.approx((1, 0, 0))
    assert longest[2].burgers == pytest.approx((0, 0, 1.59))
    assert longest[12].burgers == pytest.approx((1, 0, 1.59))
    assert longest[6].name == "1 <1 0 0>"
    assert len(net.families()) > 3
    # The same group as matrices: a rotation by 60 degrees, its powers, and mirrors.
    turn = np.array([[0.5, -np.sqrt(0.75), 0], [np.sqrt(0.75), 0.5, 0], [0, 0, 1]])
    matrices = [np.linalg.matrix_power(turn, k) for k in range(6)]
    matrices += [m @ np.diag([1, -1, 1]) for m in matrices]
    matrices += [m @ np.diag([1, 1, -1]) for m in matrices]
    again = net.families(np.array(matrices))
    assert [(one.lines, one.length) for one in again] == [(one.lines, one.length) for one in found]
