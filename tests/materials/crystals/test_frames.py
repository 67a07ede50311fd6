"""Frames: the mean deformation of a crystal, and its Burgers vectors in the coordinates of the file
and along the crystal axes."""

# b of a line is a tuple of numbers, exact or floating.
# pyright: reportArgumentType=false

import numpy as np
import pytest

from geomtorsion.materials.crystals import Crystal
from geomtorsion.materials.crystals.reports import crystal_report, inserted_atoms
from tests.materials.crystals.polycrystals import bicrystal, turned
from tests.materials.crystals.synthetic import block, interstitial_loop, quadrupole

# Sigma 5: 36.87 degrees about [0 0 1].
SIGMA5 = np.array([[4, -3, 0], [3, 4, 0], [0, 0, 5]]) / 5
TURN = turned(33, (1, 2, 3))
DEFORMATIONS = {
    "shorter along x": np.diag([0.85, 1, 1]),
    "longer along z": np.diag([1, 1, 1.15]),
    "sheared": np.eye(3) + 0.15 * np.outer([1, 0, 0], [0, 0, 1]),
    "all of it, turned": TURN @ np.array([[1.08, 0.06, 0], [0, 0.94, -0.07], [0, 0, 1.05]]),
}
SPECIMENS = {
    "bcc": ((14, 14, 3), 1.0),
    "fcc": ((12, 12, 3), 1.0),
    "diamond": ((9, 9, 3), 1.0),
    "hcp": ((14, 8, 3), (8 / 3) ** 0.5),
}


def off(line, b):
    """Distance of b of a line from this vector or its opposite, relative to its length."""
    found = np.array(line.burgers)
    return min(np.linalg.norm(found - sign * b) for sign in (1, -1)) / np.linalg.norm(b)


# Diamond takes longest and follows the same path: a quick run has one deformation of it.
PAIRS = [
    pytest.param(
        lattice,
        how,
        marks=pytest.mark.slow
        if (one + two) % 2 or (lattice == "diamond" and how != "sheared")
        else [],
    )
    for one, lattice in enumerate(SPECIMENS)
    for two, how in enumerate(DEFORMATIONS)
]


@pytest.mark.parametrize(("lattice", "how"), PAIRS)
def test_b_is_deformed_as_the_crystal_is(lattice, how):
    """Four screws along z: b in the coordinates of the file is the deformed lattice vector, and b
    along the crystal axes is the lattice vector itself."""
    repeats, length = SPECIMENS[lattice]
    places, cell = quadrupole(lattice, repeats, (0, 0, length))
    deformation = DEFORMATIONS[how]
    crystal = Crystal(places @ deformation.T, np.diag(cell) @ deformation.T)
    lines = crystal.dislocations().lines
    assert (crystal.lattice, len(lines)) == (lattice, 4)
    assert max(off(line, deformation[:, 2] * length) for line in lines) < 1e-3
    assert {sum(abs(x) for x in line.burgers_lattice or ()) for line in lines} == {1}
    assert len({line.family for line in lines}) == 1
    line = lines[0]
    middle, along = line.path[len(line.path) // 2], line.path[-1] - line.path[0]
    circuit = crystal.circuit.around(middle, along, 3.2)
    assert circuit.burgers_lattice == line.burgers_lattice
    assert circuit.burgers == line.burgers
    report = crystal_report(crystal, crystal.dislocations())
    assert report["deformation"] == crystal.deformation.tolist()


@pytest.mark.parametrize(("size", "right"), [((0.85, 1, 1), 3.3), ((1, 1, 1.15), 3.795)])
def test_the_length_of_b_is_that_along_the_line(size, right):
    """bcc of a = 3.3 with screws along z; a given constant or orientation does not change |b|."""
    places, cell = quadrupole("bcc", (14, 14, 3), (0, 0, 1))
    atoms, edges = 3.3 * places * size, 3.3 * cell * size
    for given in ({}, {"constant": 3.3}, {"orient": np.eye(3), "constant": 3.3}):
        for line in Crystal(atoms, edges, **given).dislocations().lines:
            assert np.linalg.norm(line.burgers) == pytest.approx(right, rel=1e-4)


@pytest.mark.parametrize("ratio", [1.35, 1.86, 2.0])
def test_hcp_of_any_ratio_is_deformed(ratio):
    """b along c follows c/a, with a strain in the basal plane."""
    places, cell = quadrupole("hcp", (14, 8, 3), (0, 0, (8 / 3) ** 0.5))
    size = np.array([1.08, 0.95, ratio / (8 / 3) ** 0.5])
    crystal = Crystal(places * size, cell * size)
    lines = crystal.dislocations().lines
    assert (crystal.lattice, len(lines)) == ("hcp", 4)
    assert max(off(line, np.array([0, 0, ratio])) for line in lines) < 1e-3


@pytest.mark.parametrize("how", ["longer along z", "all of it, turned"])
def test_grains_are_deformed(how):
    """An edge in one of two grains under one deformation has the deformed b."""
    places, _, size = bicrystal("fcc", SIGMA5, (0.5, 0.5, 0), size=(11, 8, 3))
    deformation = DEFORMATIONS[how]
    cell = np.diag([60, 60, size[2]]) @ deformation.T
    crystal = Crystal(places @ deformation.T, cell, (False, False, True))
    (line,) = crystal.dislocations().lines
    assert len(crystal.grains) == 2
    assert line.family == "1/2<1 1 0>"
    assert off(line, deformation @ [0.5, 0.5, 0]) < 5e-3


def test_b_follows_the_strain_of_a_trajectory():
    """A frame stretched after the first has the same lattice vector and a longer b in space; noise
    changes neither."""
    places, cell = quadrupole("fcc", (12, 12, 3), (0, 0, 1))
    first = Crystal(places, cell)
    stretch = np.array([1, 1, 1.1])
    later = Crystal(places * stretch, cell * stretch).following(first)
    shaken = places + 0.01 * np.random.default_rng(0).normal(size=places.shape)
    still = Crystal(shaken, cell).following(first)
    assert later.constant == still.constant == first.constant
    assert np.array_equal(later.orient, first.orient)
    before, after, noisy = (one.dislocations().lines for one in (first, later, still))
    assert [line.burgers_lattice for line in after] == [line.burgers_lattice for line in before]
    assert max(off(line, np.array([0, 0, 1.1])) for line in after) < 1e-3
    assert {line.burgers for line in noisy} == {line.burgers for line in before}


def test_atoms_of_a_strained_loop_are_counted():
    """The count uses the volume of an atom in the strained crystal."""
    places, cell, put_in = interstitial_loop(4)
    size = np.array([1.06, 1, 0.97])
    crystal = Crystal(places * size, cell * size)
    (line,) = crystal.dislocations().lines
    assert inserted_atoms(line, crystal) == pytest.approx(put_in, rel=1e-9)


@pytest.mark.parametrize(("strain", "is_found"), [(4, False), (6, True)])
def test_a_strain_below_its_error_is_omitted(strain, is_found):
    """A perfect crystal with 2 % noise, stretched along x and shortened along y by 4 or 6 standard
    errors: 4 count as no deformation, so that b of an unstrained crystal is a lattice vector."""
    places, cell = block("fcc", (8, 8, 8))
    noisy = places + 0.02 * np.random.default_rng(0).normal(size=places.shape)
    at_rest = Crystal(noisy, cell)
    assert np.array_equal(at_rest.deformation, np.eye(3))
    error = at_rest.frame.error
    assert 1e-4 < error < 1e-3
    size = 1 + strain * error * np.array([1, -1, 0])
    found = Crystal(noisy * size, cell * size).deformation
    assert found == pytest.approx(np.diag(size) if is_found else np.eye(3), abs=error * is_found)
