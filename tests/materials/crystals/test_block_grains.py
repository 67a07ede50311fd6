"""Block grains: one crystal is known as one, whatever noise does to single atoms."""

from functools import cache

import numpy as np

from geomtorsion.materials.crystals import LATTICES, Crystal, crystal
from geomtorsion.materials.crystals.atom_slabs import AtomSlabs
from geomtorsion.materials.crystals.block_grains import BlockGrains
from geomtorsion.materials.crystals.block_shells import BlockShells
from geomtorsion.materials.crystals.frames import Frame
from geomtorsion.materials.crystals.sorted_atoms import SortedAtoms
from geomtorsion.materials.crystals.triangulation import Cell
from tests.materials.crystals.synthetic import block

FCC = LATTICES["fcc"]


@cache
def noisy() -> np.ndarray:
    """fcc in which noise of 14 % turns single atoms by more than the angle of a wall: one of the
    few that are looked at first, four of those whose neighbours do not fit either."""
    places, _ = block("fcc", (5, 5, 5))
    noise = np.random.default_rng(5).normal(size=places.shape)
    return places + 2 + 0.14 * FCC.nearest * noise


def never(*_: object) -> None:
    """What takes all atoms at once."""
    raise AssertionError("a single crystal was segmented")


def test_turned_atoms_are_no_grain(monkeypatch):
    """Nothing is segmented, as it would be for every atom that is turned."""
    monkeypatch.setattr(crystal, "segmented", never)
    assert Crystal(noisy()).grains.is_single


def test_turned_atoms_are_no_grain_in_blocks(tmp_path):
    """Neither among a few atoms nor among all: a crystal in blocks is never looked at at once."""
    atoms = SortedAtoms.sized(tmp_path, Cell(np.eye(3), np.zeros(3, dtype=bool)), 100)
    atoms.sort(AtomSlabs(noisy()))
    shells = BlockShells(str(tmp_path), atoms, Frame(FCC, np.eye(3), 1.0))
    found = BlockGrains(shells)
    for one in atoms.blocks:
        shells.compute(one)
        found.judge(one)
        assert 1 < np.load(shells.file(one, "judged"))[0] <= FCC.shells
    assert found.seems_single
    assert found.is_single
