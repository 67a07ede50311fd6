"""Surroundings: neighbours do not depend on earlier queries."""

import numpy as np
import pytest

from geomtorsion.materials.crystals.surroundings import Places
from geomtorsion.materials.crystals.triangulation import Cell
from tests.materials.crystals.synthetic import block


@pytest.mark.parametrize("lattice", ["fcc", "bcc"])
def test_neighbours_do_not_depend_on_earlier_queries(lattice):
    """Among neighbours at equal distances, each query selects the same ones."""
    places, edges = block(lattice, (6, 6, 6))
    cell, atoms = Cell(np.diag(edges), np.ones(3, dtype=bool)), np.arange(len(places))
    fresh, used = (Places(places, cell, 1.5) for _ in range(2))
    # A query for 300 neighbours reaches beyond the initial radius.
    used.neighbours(atoms[:1], 300)
    used.within(2.5)
    for one, other in zip(fresh.neighbours(atoms, 15), used.neighbours(atoms, 15), strict=True):
        assert np.array_equal(one, other)
