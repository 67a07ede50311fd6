"""Sorted atoms: every atom in one block; layers are what a search through all atoms gives."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from geomtorsion.materials.crystals import atom_slabs
from geomtorsion.materials.crystals.atom_slabs import AtomSlabs
from geomtorsion.materials.crystals.sorted_atoms import SortedAtoms
from geomtorsion.materials.crystals.triangulation import Cell


def cells(rng):
    """An oblique cell that repeats along some of its edges."""
    vectors = np.diag([5.0, 6.0, 4.0]) + rng.uniform(-1, 1, (3, 3))
    return Cell(vectors, rng.random(3) < 0.6)


def expected(cell, places, target, distance):
    """Numbers and images of all atoms within a distance of places, by brute force."""
    points, numbers, images = cell.with_ghosts(places, 2 * distance + 8)
    near = np.isfinite(cKDTree(target).query(points, distance_upper_bound=distance)[0])
    return set(map(tuple, np.column_stack([numbers, images])[near].tolist()))


@given(seed=st.integers(0, 2**32 - 1), size=st.floats(0.8, 9), width=st.floats(0.1, 5))
@settings(max_examples=8, deadline=None)
def test_blocks_and_layers_are_what_a_search_finds(tmp_path_factory, seed, size, width):
    """Each atom is in one block; a layer holds all that lie as near to an atom as it is wide."""
    rng = np.random.default_rng(seed)
    cell = cells(rng)
    given_places = rng.uniform(-9, 9, (200, 3))
    atoms = SortedAtoms.sized(tmp_path_factory.mktemp("atoms"), cell, size)
    with pytest.MonkeyPatch.context() as patch:
        # Four slabs, the last of which is not full.
        patch.setattr(atom_slabs, "SLAB", 60)
        atoms.sort(AtomSlabs([given_places[:50], given_places[50:]]))
    assert atoms.count == 200
    places, _ = cell.wrapped(given_places)
    assert np.array_equal(atoms.every(), places)
    inside = [atoms.inside(block) for block in atoms.blocks]
    assert sorted(np.concatenate([part.numbers for part in inside]).tolist()) == list(range(200))
    for part in inside:
        assert np.array_equal(part.places, places[part.numbers])
    for block in atoms.blocks[:: max(len(atoms.blocks) // 3, 1)]:
        part, own = atoms.around(block, width)
        assert part.numbers[own].tolist() == atoms.inside(block).numbers.tolist()
        assert part.places == pytest.approx(places[part.numbers] + part.images @ cell.vectors)
        rows = list(map(tuple, np.column_stack([part.numbers, part.images]).tolist()))
        assert rows == sorted(set(rows))
        assert expected(cell, places, part.places[own], width * (1 - 1e-9)) <= set(rows)
    some = places[rng.choice(200, 3)]
    found = np.concatenate([part.numbers for _, _, part in atoms.near(some, width)])
    points, numbers, _ = cell.with_ghosts(places, width)
    wanted = numbers[np.isfinite(cKDTree(some).query(points, distance_upper_bound=width)[0])]
    assert sorted(found.tolist()) == sorted(set(wanted.tolist()))
    # At both ends of slabs.
    some = [0, 49, 50, 109, 110, 169, 170, 199]
    chosen = atoms.chosen(np.array(some))
    assert sorted(n for part in chosen.values() for n in part.numbers.tolist()) == some
    for block, part in chosen.items():
        assert np.isin(part.numbers, atoms.inside(block).numbers).all()


def test_many_small_arrays_are_few_files(tmp_path):
    """A function that gives atoms layer by layer leaves no file for each layer to be opened."""
    rng = np.random.default_rng(0)
    layers = [rng.uniform(0, 5, (20, 3)) for _ in range(30)]
    atoms = SortedAtoms.sized(tmp_path, Cell(5 * np.eye(3), np.ones(3, dtype=bool)), 2.0)
    atoms.sort(AtomSlabs(lambda: iter(layers)))
    assert atoms.count == 600
    assert len(list(tmp_path.glob("slab-*-places.npy"))) == 1
    inside = [atoms.inside(block) for block in atoms.blocks]
    numbers = np.concatenate([part.numbers for part in inside])
    places = np.concatenate([part.places for part in inside])
    assert np.array_equal(places[np.argsort(numbers)], np.concatenate(layers))
