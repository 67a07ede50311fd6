"""Reading: crystals from files, with given or found crystal axes, stable over a trajectory."""

from pathlib import Path

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import CrystalError
from tests.real import real

ase_io = pytest.importorskip("ase.io")


def test_axes_that_are_given_are_taken():
    """b in the given crystal axes agrees with the truth file, with the sign of the conventions."""
    axes = np.array([[1, -1, 0], [1, 1, 1], [-1, -1, 2]], dtype=float)
    orient = (axes / np.linalg.norm(axes, axis=1)[:, None]).T
    path = real("crystal/cu_edge110.xyz")
    crystal = gt.crystals.read(path, lattice="fcc", orient=orient, constant=3.615)
    (line,) = crystal.dislocations().lines
    sense = np.sign(line.path[-1, 2] - line.path[0, 2])
    assert [sense * x for x in line.burgers_lattice or ()] == [-0.5, 0.5, 0]
    assert np.array_equal(crystal.orient, orient) or crystal.orient == pytest.approx(orient)
    alone = gt.crystals.read(path, orient=orient)
    assert alone.orient == pytest.approx(orient)


def test_b_is_the_same_in_all_frames(tmp_path: Path):
    """All frames of a noisy trajectory have one b, since they share one orientation."""
    start = ase_io.read(real("crystal/w_screw111.xyz"))
    rng = np.random.default_rng(5)
    images = []
    for _ in range(3):
        images.append(start.copy())
        images[-1].positions += 0.05 * rng.normal(size=start.positions.shape)
    ase_io.write(tmp_path / "run.xyz", images)
    found = [one.dislocations().lines for one in gt.crystals.read_all(tmp_path / "run.xyz")]
    assert [len(lines) for lines in found] == [1, 1, 1]
    along = [np.sign(lines[0].path[-1, 2] - lines[0].path[0, 2]) for lines in found]
    each = {
        tuple(sense * x for x in lines[0].burgers_lattice or ())
        for sense, lines in zip(along, found, strict=True)
    }
    assert len(each) == 1


def test_refusals_of_crystals_name_the_file(tmp_path: Path):
    """The error for random atoms or a wrong lattice names the file."""
    from ase import Atoms

    rng = np.random.default_rng(0)
    gas = Atoms("Ar500", rng.uniform(0, 20, (500, 3)), cell=[20] * 3, pbc=True)
    ase_io.write(tmp_path / "gas.xyz", gas)
    with pytest.raises(CrystalError, match=r"gas\.xyz: frame 0: .*expected a crystal"):
        _ = gt.crystals.read(tmp_path / "gas.xyz").lattice
    with pytest.raises(CrystalError, match=r"cu_perfect\.xyz.*diamond.*%"):
        _ = gt.crystals.read(real("crystal/cu_perfect.xyz"), lattice="diamond").lattice
