"""Block shells: what a block tells of its atoms is what the whole crystal tells of them."""

import numpy as np
import pytest

from geomtorsion.materials.crystals import LATTICES
from geomtorsion.materials.crystals.atom_slabs import AtomSlabs
from geomtorsion.materials.crystals.block_shells import BlockShells
from geomtorsion.materials.crystals.frames import Frame
from geomtorsion.materials.crystals.shells import dilated, reach_of_shells, shells_of
from geomtorsion.materials.crystals.sorted_atoms import SortedAtoms
from geomtorsion.materials.crystals.surroundings import Places
from geomtorsion.materials.crystals.triangulation import Cell
from tests.materials.crystals.synthetic import block


@pytest.mark.parametrize(
    ("vacant", "seed", "height"), [(0.05, 0, 16), (0.12, 10, 16), (0.2, 1, 16), (0.04, 455, 40)]
)
def test_a_block_sees_all_on_which_its_atoms_depend(tmp_path, vacant, seed, height):
    """In a bar of bcc with many vacancies: which atoms need tetrahedra depends on vacancies beside
    vacancies on the other side of the face of a block. In the second and third bar holes of
    vacancies lie at a face of the cell, which are no surface, on either side of it. In the long one
    an atom depends on another more than three times as far away as neighbours are."""
    places, edges = block("bcc", (4, 4, height))
    places = places[np.random.default_rng(seed).random(len(places)) > vacant]
    cell = Cell(np.diag(edges.astype(float)), np.array([False, False, True]))
    frame = Frame(LATTICES["bcc"], np.eye(3), 1.0)
    shells = shells_of(Places(places, cell, reach_of_shells(frame)), frame)
    wanted = dilated(~shells.closed, shells.near)
    atoms = SortedAtoms.sized(tmp_path, cell, 4.5)
    atoms.sort(AtomSlabs(places))
    made = BlockShells(str(tmp_path), atoms, frame)
    assert len(atoms.blocks) == {16: 4, 40: 9}[height]
    for one in atoms.blocks:
        made.compute(one)
        assert np.array_equal(made.wanted(one), wanted[atoms.inside(one).numbers])
    assert made.vacancies == len(shells.vacancies)
