"""Specimen: the lattices of the atoms in a crystal, a glass, or a mixture."""

import re

import numpy as np
import pytest

from geomtorsion.errors import CrystalError
from geomtorsion.materials.crystals import LATTICES, Crystal
from geomtorsion.materials.crystals.frames import sampled
from geomtorsion.materials.crystals.specimen import share_of_lattices
from geomtorsion.materials.crystals.surroundings import Places
from geomtorsion.materials.crystals.triangulation import Cell
from tests.materials.crystals.polycrystals import amorphous, filled
from tests.materials.crystals.synthetic import with_line


def shares(places, size):
    """Share of each lattice in a sample, and the number of atoms examined."""
    cell, asked = Cell(size * np.eye(3), np.ones(3, dtype=bool)), []
    all_of_them = Places(places, cell, 3.0)

    def near(atoms):
        asked.append(len(atoms))
        return all_of_them.neighbours(atoms, 32)

    return share_of_lattices(LATTICES["fcc"], near, sampled(len(places))), sum(asked)


def test_a_glass_is_refused_by_a_few_of_its_atoms():
    """Some atoms have neighbours as in a crystal, but no common lattice; the error has their share.

    It is 0.9 %: an atom fits if all its neighbours are within half the neighbour distance of
    distinct lattice sites. Without this limit 4.9 % would fit.
    """
    places = amorphous(10, 4.0)
    found, asked = shares(places + 5, 10.0)
    assert set(found.values()) == {0.0}
    assert asked < 2000
    with pytest.raises(CrystalError, match="as in a liquid") as error:
        _ = Crystal(places, [10.0] * 3).lattice
    told = re.search(r"of only ([0-9.]+)%", str(error.value))
    assert told is not None
    assert 0.3 < float(told[1]) < 3


def test_a_crystal_in_a_glass_is_counted():
    """A ball of fcc with a fifth of all atoms has its share, and other lattices have none."""
    glass, ball = amorphous(10, 4.0), filled("fcc", np.eye(3), 3.6)
    places = np.concatenate([glass[np.linalg.norm(glass, axis=1) > 3.9], ball])
    found, asked = shares(places + 5, 10.0)
    assert asked > 2000
    # Atoms at the ball's surface lack neighbours.
    inside = (np.linalg.norm(ball, axis=1) < 2.9).sum()
    assert inside < found["fcc"] * len(places) < 1.1 * len(ball)
    assert max(found[name] for name in ("bcc", "diamond")) < 0.02


def test_noise_adds_no_region_without_a_lattice():
    """In diamond with 8 % noise few atoms fit, because their third shell mixes with the second. All
    neighbour sites are still occupied, and the screw is found."""
    places, cell = with_line("diamond", (0.5, 0.5, 0), (9, 9, 3), 0.3)
    noise = np.random.default_rng(0).normal(size=places.shape)
    moved = places + 0.08 * LATTICES["diamond"].nearest * noise
    crystal = Crystal(moved, cell, (False, False, True))
    assert crystal.grains.is_single
    assert [line.kind for line in crystal.dislocations().lines] == ["periodic"]
