"""Triangulation: memory of tetrahedra, edges and faces is a few kilobytes an atom."""

import tracemalloc

import numpy as np

from geomtorsion.crystals import Crystal
from tests.crystals.synthetic import block


def test_lines_in_much_noise_take_little_memory():
    """Under 10 % noise every atom has its tetrahedra: NumPy needs less than 3.5 kB for each."""
    places, cell = block("bcc", (20, 20, 20))
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
