"""Families of Burgers vectors, and whole multiples of lattice vectors."""

# Tests give what users give, wrong things included, and read what may be missing.
# pyright: reportOperatorIssue=false

from itertools import permutations, product

import numpy as np
import pytest

from geomtorsion.errors import NetworkError
from geomtorsion.loops import Box, DislocationNetwork, LineArrays
from geomtorsion.loops.line_families import LATTICES, lattice_coordinates

BOX = Box.of_bounds([0, 0, 0], [10, 10, 10])


def network(vectors, steps) -> DislocationNetwork:
    """One line for each b, from the origin."""
    places = [[0, 0, 0], *steps]
    pairs = [[0, k + 1] for k in range(len(vectors))]
    return DislocationNetwork.of_arrays(LineArrays(places, pairs, vectors, BOX))


def test_the_twelve_vectors_of_fcc_are_one_family():
    """All <110>, signs and orders; <100> and <112> stand apart; without symmetry six pairs."""
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
    """Length over volume; screw along, edge across, and a half of each at 45 degrees."""
    net = network([[1, 0, 0], [0, 1, 0], [2, 0, 0]], [[2, 0, 0], [3, 0, 0], [1, 1, 0]])
    long, short = net.families()
    assert (long.name, long.lines, long.length) == ("1 <1 0 0>", 2, 5)
    assert long.screw == pytest.approx(2 / 5, abs=1e-15)
    assert short.edge == pytest.approx(0.5, abs=1e-15)
    assert long.density + short.density == pytest.approx(net.density, rel=1e-15)
    assert net.density == pytest.approx((5 + np.sqrt(2)) / 1000, rel=1e-15)


def test_the_mean_nye_tensor_of_one_line():
    """b on the first index, the line on the second."""
    net = network([[1, 2, 3]], [[0, 0, 4]])
    assert net.nye.tolist() == pytest.approx(np.outer([1, 2, 3], [0, 0, 0.004]))


@pytest.mark.parametrize("name", list(LATTICES))
def test_whole_multiples_of_lattice_vectors(name):
    """Random lattice vectors come back; shortest ones have length one."""
    assert np.linalg.norm(LATTICES[name], axis=1) == pytest.approx(1)
    wanted = np.random.default_rng(3).integers(-4, 5, (40, 3))
    found = lattice_coordinates(wanted @ LATTICES[name], name, 1e-9)
    assert (found == wanted).all()


def test_what_is_no_lattice_vector_is_refused():
    """A partial, a flat lattice, a name that is none, a symmetry that is none."""
    with pytest.raises(NetworkError, match=r"b = .* is no vector of it.*units of b"):
        lattice_coordinates(np.array([[0.5, 0.5, 0]]), "sc", 1e-9)
    with pytest.raises(NetworkError, match="one plane"):
        lattice_coordinates(np.eye(3), [[1, 0, 0], [0, 1, 0], [1, 1, 0]], 1e-9)
    with pytest.raises(NetworkError, match="sc, fcc, bcc"):
        lattice_coordinates(np.eye(3), "hcp", 1e-9)
    with pytest.raises(NetworkError, match="cubic, none"):
        network([[1, 0, 0]], [[0, 0, 1]]).families("hexagonal")
