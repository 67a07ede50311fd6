"""Trajectories: reports that are kept, one file a frame, and what else lies in their folder."""

import json
from pathlib import Path

import pytest

from geomtorsion.crystals.trajectories import Wanted, forget, is_begun, reports
from geomtorsion.errors import CheckpointError, GeomtorsionError
from tests.crystals.making import copper_screw, written

pytest.importorskip("ase")
WANTED = Wanted(lattice="fcc", constant=3.6)


def test_kept_frames_are_taken_as_they_are(tmp_path: Path):
    """Nothing is computed again: a report that somebody changed comes back changed."""
    file, folder = written(tmp_path, copper_screw(), copper_screw(1.5)), tmp_path / "frames"
    done: list[tuple[int, int]] = []
    first = [one for one, _ in reports(file, WANTED, folder, lambda *x: done.append(x))]
    assert done == [(0, 2), (1, 2), (2, 2)]
    assert is_begun(folder)
    kept = folder / "000001.json"
    assert json.loads(kept.read_text()) == first[1]
    kept.write_text(json.dumps({**first[1], "share": 0.5}))
    again = list(reports(file, WANTED, folder))
    assert [one["share"] for one, _ in again] == [first[0]["share"], 0.5]
    # Lines are there all the same.
    assert len(again[1][1]().lines) == 1


def test_other_settings_or_files_are_refused(tmp_path: Path):
    """A folder belongs to one file and one set of options; damage in it is told."""
    file, folder = written(tmp_path, copper_screw()), tmp_path / "frames"
    list(reports(file, WANTED, folder))
    with pytest.raises(CheckpointError, match="other settings"):
        list(reports(file, Wanted(lattice="fcc"), folder))
    (folder / "000000.json").write_text("{")
    with pytest.raises(GeomtorsionError, match=r"000000\.json.*no JSON"):
        list(reports(file, WANTED, folder))


def test_forgetting_leaves_what_is_not_ours(tmp_path: Path):
    """Reports are removed, other files stay and are told."""
    file, folder = written(tmp_path, copper_screw()), tmp_path / "frames"
    list(reports(file, WANTED, folder))
    (folder / "notes.txt").write_text("mine")
    with pytest.raises(GeomtorsionError, match="holds other files"):
        forget(folder)
    assert [path.name for path in folder.iterdir()] == ["notes.txt"]
    assert not is_begun(folder)
