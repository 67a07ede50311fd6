"""Known grains: grains keep their numbers and frames from frame to frame."""

import json
from itertools import islice

import numpy as np
import pytest

from geomtorsion.errors import CheckpointError, CrystalError
from geomtorsion.materials.crystals import Crystal, read_all
from geomtorsion.materials.crystals.reports import crystal_report, followed
from geomtorsion.materials.crystals.trajectories import Wanted, reports
from tests.materials.crystals.making import xyz
from tests.materials.crystals.polycrystals import bicrystal, filled, polycrystal, turned

SIZE = 8.5
TURNS = [turned(0, (0, 0, 1)), turned(40, (0, 0, 1)), turned(45, (1, 0, 0))]


def grains_about(*seeds):
    """A polycrystal of bcc with one grain around each seed."""
    return polycrystal(["bcc"] * 3, TURNS, np.array(seeds) * SIZE / 10, SIZE, [0.8] * 3)


def test_all_grains_keep_numbers_and_frames_while_sizes_change():
    """The second and the third grain exchange their order by size: each keeps its number, its frame
    to the last bit, and the misorientations of its walls."""
    first, own = grains_about([2, 2, 2.0], [7.4, 6.4, 2.5], [3, 7, 7.5])
    later, _ = grains_about([2, 2, 2.0], [8, 6.4, 2.5], [4.2, 8, 7])
    count = min(len(first), len(later))
    rng = np.random.default_rng(0)
    crystals = [
        Crystal(places[:count] + 0.01 * rng.normal(size=(count, 3)), [SIZE] * 3)
        for places in (first, later)
    ]
    before = crystals[0].grains
    alone, after = crystals[1].grains, crystals[1].following(crystals[0]).grains
    assert len(before) == len(alone) == len(after) == 3
    made = [int(np.bincount(own[grain.atoms]).argmax()) for grain in before]
    sizes = [[len(x[k].atoms) for k in range(3)] for x in (before, after)]
    assert np.argsort(sizes[0]).tolist() != np.argsort(sizes[1]).tolist()
    for number in range(3):
        assert after[number].frame.orient.tobytes() == before[number].frame.orient.tobytes()
        assert after[number].constant == before[number].constant
        common = np.isin(after[number].atoms, before[number].atoms).mean()
        assert common > 0.5, made[number]
    for wall in after.walls:
        assert wall.degrees == before.wall(*wall.grains).degrees
    assert (after.vanished, after.used) == ((), 3)
    assert after.shares == pytest.approx(alone.shares, abs=0.01)


# Sigma 5, with an edge in the grain that is not turned.
SIGMA5 = np.array([[4, -3, 0], [3, 4, 0], [0, 0, 5]]) / 5
CELL, AXES = [80.0, 80.0, 14.4], (False, False, True)


def two_grains():
    """Atoms of a bicrystal of fcc, a = 3.6, periodic along z; `one_grain` has as many atoms."""
    places, _, size = bicrystal("fcc", SIGMA5, (0.5, 0.5, 0), size=(9, 6, 2))
    return 3.6 * (places + size / 2)


def one_grain(count):
    """Atoms of the turned grain, whose lattice fills the whole specimen."""
    sites = filled("fcc", SIGMA5, 20)
    inside = sites[(np.abs(sites) < [9.5, 6, 2]).all(axis=1)]
    order = np.argsort(np.abs(inside[:, 0]), kind="stable")
    # The surplus atoms are removed at both ends in x.
    return 3.6 * (inside[order][:count] + np.array([9, 6, 2]))


def trajectory():
    """Two grains, the same with noise, the turned grain only, and both grains again."""
    first = two_grains()
    shaken = first + 0.03 * np.random.default_rng(1).normal(size=first.shape)
    return first, shaken, one_grain(len(first)), shaken


def test_lines_keep_b_and_grains_that_vanish_are_reported(tmp_path):
    """b of a line in a grain is the same to the last bit; a grain that appears after another has
    vanished gets a new number."""
    pytest.importorskip("ase")
    frames = trajectory()
    assert {len(places) for places in frames} == {len(frames[0])}
    path = tmp_path / "atoms.xyz"
    path.write_text(xyz(*frames), "utf-8")
    crystals = list(read_all(path))
    told = [crystal_report(crystal, crystal.dislocations()) for crystal in crystals]
    numbers = [[grain.number for grain in crystal.grains] for crystal in crystals]
    assert numbers[0] == numbers[1] == [0, 1]
    (alone,) = numbers[2]
    assert numbers[3] == [alone, 2]
    assert [report["vanished"] for report in told] == [[], [], [1 - alone], []]
    (one,), (two,) = (report["lines"] for report in told[:2])
    assert one["family"] == "1/2<1 1 0>"
    assert one["grain"] == two["grain"] == 1 - alone
    one, two = (frame["lines"][0] for frame in followed(told)[:2])
    assert (one["track"], one["burgers"]) == (two["track"], two["burgers"])
    with pytest.raises(CrystalError, match=rf"expected the number of a grain \({alone}, 2\)"):
        crystals[3].grain(1 - alone)
    # A run that ends after two frames is resumed, and gives the same reports to the last bit.
    folder = tmp_path / "frames"
    next(islice(reports(path, Wanted(), folder), 1, None))
    assert sorted(one.name for one in folder.glob("0*.json")) == ["000000.json", "000001.json"]
    whole = [report for report, _ in reports(path, Wanted(), folder)]
    assert [{**report, "frame": k} for k, report in enumerate(told)] == whole
    assert json.loads((folder / "000003.json").read_text()) == whole[3]
    (folder / "000001.npy").unlink()
    with pytest.raises(CheckpointError, match="expected the grain of each of"):
        list(reports(path, Wanted(), folder))
