"""Triangulation: some atoms have the tetrahedra of the full mesh, in a few kilobytes per atom."""

import tracemalloc

import numpy as np
import pytest

from geomtorsion.materials.crystals import Crystal
from geomtorsion.materials.crystals.triangulation import Cell, triangulated
from tests.materials.crystals.synthetic import block


def test_lines_in_much_noise_take_little_memory():
    """Under 10 % noise all atoms need tetrahedra; NumPy uses less than 3.5 kB per atom."""
    places, cell = block("bcc", (14, 14, 14))
    noise = 0.1 * np.sqrt(0.75) * np.random.default_rng(0).normal(size=places.shape)
    crystal = Crystal(places + noise, cell, lattice="bcc")
    assert crystal.grains.is_single
    tracemalloc.start()
    try:
        assert crystal.dislocations().lines == ()
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 3500 * len(places)


@pytest.mark.parametrize("periodic", [(True, True, True), (True, False, False), (False,) * 3])
def test_tetrahedra_of_some_atoms_agree_with_all(periodic):
    """Each tetrahedron with one of these atoms appears once, with its first corner in the cell."""
    places, edges = block("bcc", (7, 6, 5))
    places = places + 0.1 * np.random.default_rng(1).normal(size=places.shape)
    cell = Cell(np.diag(edges), np.array(periodic))
    places = cell.wrapped(places)[0]
    wanted = places[:, 0] < 2
    every, some = (triangulated(places, cell, 1.3, which) for which in (None, wanted))
    chosen = wanted[every.corners].any(axis=1)
    assert 100 < chosen.sum() < len(every.corners) / 2
    for name in ("corners", "offsets", "senses"):
        assert (getattr(every, name)[chosen] == getattr(some, name)).all()
    if all(periodic):
        # The tetrahedra fill the cell.
        ends = places[every.corners] + cell.shifts(every.offsets.reshape(-1, 3)).reshape(-1, 4, 3)
        volumes = np.abs(np.linalg.det(ends[:, 1:] - ends[:, :1])) / 6
        assert volumes.sum() == pytest.approx(np.prod(edges))
