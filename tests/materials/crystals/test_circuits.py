"""Circuits from atom to atom: exact sums of lattice vectors, compared with known dislocations."""

# The tests pass what users pass, including wrong types.
# pyright: reportArgumentType=false

from fractions import Fraction
from itertools import product

import numpy as np
import pytest

from geomtorsion.errors import CrystalError
from geomtorsion.materials.crystals import LATTICES, Crystal, read
from tests.real import real

HALF = Fraction(1, 2)


def screw(
    name: str, a: float = 3.0, radius: float = 12.0
) -> tuple[Crystal, np.ndarray, np.ndarray]:
    """A crystal with a right-handed screw along z, its b in crystal axes, and a point on the line.

    u_z = |b| angle / (2 pi), by hand: lattice sites within a cylinder, periodic along z.
    """
    lattice = LATTICES[name]
    units = np.array(lattice.units) * a
    b = {"fcc": (1, 1, 0), "bcc": (1, 1, 1), "diamond": (2, 2, 0), "hcp": (2, 0, 0)}[name] * units
    z = b / np.linalg.norm(b)
    x = np.linalg.qr(np.column_stack([z, [0.3, -0.5, 0.9]]))[0][:, 1]
    axes = np.array([x, np.cross(z, x), z])
    wide = np.ceil((radius + 3) / (np.array(lattice.period) * units)).astype(int)
    cells = np.array(list(product(*(range(-n, n + 1) for n in wide)))) * lattice.period
    points = (cells[:, None] + np.array(lattice.points)).reshape(-1, 3)
    if lattice.basis:
        points = np.concatenate([points, points + lattice.basis])
    places = (points * units) @ axes.T
    height = 2 * np.linalg.norm(b)
    kept = (
        (np.hypot(*places[:, :2].T) < radius)
        & (places[:, 2] > -0.1)
        & (places[:, 2] < height - 0.1)
    )
    places = places[kept] + [0.11, 0.17, 0.0]
    places[:, 2] += np.linalg.norm(b) * np.arctan2(places[:, 1], places[:, 0]) / (2 * np.pi)
    box = np.diag([4 * radius, 4 * radius, height])
    made = Crystal(
        places + np.array([2 * radius, 2 * radius, 0]), box, (False, False, True), name, axes.T, a
    )
    return made, b, np.array([2 * radius, 2 * radius, height / 3])


@pytest.mark.parametrize("name", ["fcc", "bcc", "diamond", "hcp"])
def test_circuit_around_a_screw(name: str):
    """SF/RH: b of a right-handed screw points against the normal; the reversed circuit has -b."""
    crystal, b, centre = screw(name)
    found = crystal.circuit.around(centre, [0, 0, 1], 6.0)
    assert found.vector == pytest.approx(-(crystal.orient.T @ b), abs=1e-9)
    back = crystal.circuit.around(centre, [0, 0, -1], 6.0)
    assert back.whole.tolist() == (-found.whole).tolist()
    assert found.in_convention("Hirth-Lothe") == pytest.approx([0, 0, np.linalg.norm(b)], abs=1e-9)
    beside = crystal.circuit.around(centre + np.array([4.6, 0, 0]), [0, 0, 1], 3.2)
    assert beside.burgers == (0.0, 0.0, 0.0)


def test_through_atoms_by_number():
    """The same atoms give the same b, reversed atoms give -b, and every fourth atom suffices."""
    crystal, _, centre = screw("bcc")
    found = crystal.circuit.around(centre, [0, 0, 1], 6.0)
    assert found.burgers_lattice == (-HALF, -HALF, -HALF)
    assert "(-1/2, -1/2, -1/2) a" in repr(found)
    again = crystal.circuit(atoms=list(found.atoms))
    assert again.whole.tolist() == found.whole.tolist()
    assert crystal.circuit(atoms=found.atoms[::-1]).whole.tolist() == (-found.whole).tolist()
    few = crystal.circuit(atoms=found.atoms[:-1:4])
    assert few.whole.tolist() == found.whole.tolist()
    assert few.atoms[0] == few.atoms[-1]


def test_labels_sum_to_what_the_steps_are():
    """The steps of a circuit equal `crystal.labels` for its pairs of atoms and their images."""
    crystal, _, centre = screw("diamond")
    found = crystal.circuit.around(centre, [0, 0, 1], 6.0)
    pairs = np.array([found.atoms[:-1], found.atoms[1:]]).T
    images = np.diff(found.images, axis=0)
    assert np.array_equal(crystal.labels(pairs, images), found.steps)


def test_positions_outside_the_cell_change_nothing():
    """Atoms given in other periodic images have the same circuit, and it reports their images."""
    crystal, _, centre = screw("fcc")
    assert crystal.cell is not None
    found = crystal.circuit.around(centre, [0, 0, 1], 6.0)
    moved = np.random.default_rng(1).integers(-2, 3, len(crystal.positions))
    places = crystal.positions + moved[:, None] * crystal.cell[2]
    other = Crystal(places, crystal.cell, crystal.periodic, "fcc", crystal.orient, crystal.constant)
    again = other.circuit.around(centre, [0, 0, 1], 6.0)
    assert again.whole.tolist() == found.whole.tolist()
    steps = np.diff(places[list(again.atoms)] + again.images @ crystal.cell, axis=0)
    assert np.linalg.norm(steps, axis=1).max() < 2 * crystal.constant
    assert steps.sum(axis=0) == pytest.approx([0, 0, 0], abs=1e-9)


def test_wrong_circuits_are_refused():
    """Refused are too few or unknown atoms, a loop through the cell, a bad centre or radius."""
    crystal, _, centre = screw("bcc")
    atoms = len(crystal.positions)
    column = np.flatnonzero(
        np.linalg.norm((crystal.positions - centre)[:, :2] - [4, 4], axis=1) < 1.2
    )
    for wrong, message in (
        ([0, 1], "expected three or more different atoms for a circuit, got 2"),
        ([0, 1, atoms], f"from 0 to {atoms - 1}"),
        ("abc", "list|whole number"),
    ):
        with pytest.raises(CrystalError, match=message):
            crystal.circuit(atoms=wrong)
    with pytest.raises(CrystalError, match="another image|three or more different"):
        crystal.circuit(atoms=column[crystal.positions[column, 2].argsort()].tolist())
    for point, normal, radius, message in (
        (centre, [0, 0, 0], 5, "a direction"),
        (centre, [0, 0, 1], 1, "distance of neighbours"),
        (centre, [0, 0, 1], -1, "positive"),
        (centre, [0, 0, 1], 1000, "got no atom within"),
        ([0, 0, float("nan")], [0, 0, 1], 5, "finite"),
    ):
        with pytest.raises(CrystalError, match=message):
            crystal.circuit.around(point, normal, radius)


@pytest.mark.parametrize("name", ["cu_edge110", "w_edge100", "w_screw111_relax", "al_edge_dipole"])
def test_circuits_agree_with_lines(name: str):
    """On shared files the b of a circuit around each line equals the b of the line exactly."""
    pytest.importorskip("ase")
    crystal = read(real(f"crystal/{name}.xyz"))
    for line in crystal.dislocations().lines:
        along = line.path[-1] - line.path[0]
        found = crystal.circuit.around(line.path[len(line.path) // 2], along, 10.0)
        assert found.burgers_lattice == line.burgers_lattice


def test_the_nearest_image_in_an_oblique_cell():
    """Two cells of one lattice have the same circuits, also where fractions of edges mislead."""
    places = np.array([x for x in product(range(16), repeat=3) if sum(x) % 2 == 0]) * 1.8
    edge = 28.8
    oblique = np.array([[1, 0, 0], [2, 1, 0], [0, 0, 1]]) * edge
    atoms = [
        int(np.linalg.norm(places - place, axis=1).argmin())
        for place in ([0, 0, 0], [0, 12.6, 0], [12.6, 12.6, 0])
    ]
    straight, found = (Crystal(places, cell).circuit(atoms) for cell in ([edge] * 3, oblique))
    assert not found.whole.any()
    assert len(found.steps) == len(straight.steps) == 14
