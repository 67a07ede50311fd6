"""Trajectories: stored reports, one file per frame, and other files in their folder."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from geomtorsion.errors import CheckpointError, CrystalError, GeomtorsionError
from geomtorsion.materials.crystals.trajectories import Wanted, forget, is_begun, reports
from geomtorsion.materials.lines import DislocationNetwork
from tests.cli.running import run
from tests.materials.crystals.making import copper_screw, written

ROOT = Path(__file__).parents[3]
pytest.importorskip("ase")
WANTED = Wanted(lattice="fcc", constant=3.6)


def test_kept_frames_are_taken_as_they_are(tmp_path: Path):
    """Stored reports are not computed again: an edited report is returned as edited."""
    file, folder = written(tmp_path, copper_screw(), copper_screw(1.5)), tmp_path / "frames"
    done: list[tuple[float, int, str]] = []
    first = [one for one, _ in reports(file, WANTED, folder, lambda *x: done.append(x))]
    assert done == [
        (0, 2, "lattice"), (0.5, 2, "lines"), (1, 2, "lines"), (1, 2, "lattice"), (1.5, 2, "lines"),
        (2, 2, "lines"),
    ]  # fmt: skip
    assert is_begun(folder)
    kept = folder / "000001.json"
    assert json.loads(kept.read_text()) == first[1]
    kept.write_text(json.dumps({**first[1], "share": 0.5}))
    again = list(reports(file, WANTED, folder))
    assert [one["share"] for one, _ in again] == [first[0]["share"], 0.5]
    # The lines can still be computed.
    lines = again[1][1]()
    assert isinstance(lines, DislocationNetwork)
    assert len(lines.lines) == 1


def test_other_settings_or_files_are_refused(tmp_path: Path):
    """A folder belongs to one file and one set of options; damaged reports are refused."""
    file, folder = written(tmp_path, copper_screw()), tmp_path / "frames"
    list(reports(file, WANTED, folder))
    with pytest.raises(CheckpointError, match="other settings"):
        list(reports(file, Wanted(lattice="fcc"), folder))
    content = file.read_bytes()
    file.write_bytes(content[:-3] + b"9" + content[-2:])
    assert file.stat().st_size == len(content)
    with pytest.raises(CheckpointError, match="another file"):
        list(reports(file, WANTED, folder))
    file.write_bytes(content)
    (folder / "000000.json").write_text("{")
    with pytest.raises(GeomtorsionError, match=r"000000\.json.*expected JSON"):
        list(reports(file, WANTED, folder))


def test_a_run_without_a_frame_leaves_nothing(tmp_path: Path):
    """If the first frame fails, nothing is stored, and the corrected file starts a new run."""
    folder = tmp_path / "frames"
    broken = copper_screw()
    broken[1::2] = broken[::2][: len(broken[1::2])]
    with pytest.raises(CrystalError, match="expected atoms at different positions"):
        list(reports(written(tmp_path, broken), WANTED, folder))
    assert not is_begun(folder)
    mended = written(tmp_path, copper_screw(), copper_screw(1.5))
    assert len(list(reports(mended, WANTED, folder))) == 2
    assert is_begun(folder)


def test_forgetting_leaves_foreign_files(tmp_path: Path):
    """Reports are removed, other files stay and are named in the error."""
    file, folder = written(tmp_path, copper_screw()), tmp_path / "frames"
    list(reports(file, WANTED, folder))
    (folder / "notes.txt").write_text("mine")
    with pytest.raises(GeomtorsionError, match="got one that cannot be removed.*other files"):
        forget(folder)
    assert [path.name for path in folder.iterdir()] == ["notes.txt"]
    assert not is_begun(folder)


def thermal(frames: int) -> list[np.ndarray]:
    """A screw that glides by half a neighbour distance per frame, in vibrating atoms.

    The displacements decorrelate over a few frames, as for springs in a heat bath [Uhlenbeck and
    Ornstein]; their standard deviation is 6 % of the neighbour distance.
    """
    rng = np.random.default_rng(2)
    sigma, kept = 0.06 * 3.6 / np.sqrt(2), 0.8
    shaken = sigma * rng.normal(size=copper_screw().shape)
    found = []
    for frame in range(frames):
        found.append(copper_screw(1.3 * (frame - frames // 2)) + shaken)
        shaken = kept * shaken + np.sqrt(1 - kept**2) * sigma * rng.normal(size=shaken.shape)
    return found


KILLED = """
import os, signal, sys
from geomtorsion.materials.crystals import trajectories
from geomtorsion.cli import main
made, calls = trajectories.crystal_report, []
def dying(*arguments):
    calls.append(1)
    if len(calls) == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return made(*arguments)
trajectories.crystal_report = dying
sys.argv = ["geomtorsion", "crystal", *sys.argv[1:]]
main()
"""


def test_a_trajectory_keeps_its_axes_and_its_line_and_survives_a_kill(tmp_path: Path):
    """One set of axes, one b and one moving track in all frames. After SIGKILL in the third frame,
    --resume writes the same files, byte for byte, as an uninterrupted run."""
    file = written(tmp_path, *thermal(4))
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    run("crystal", str(file), "-o", str(whole))
    frames = json.loads((whole / "crystal.json").read_text())["frames"]
    assert len(frames) == 4
    for key in ("lattice", "orient", "constant"):
        assert len({json.dumps(frame[key]) for frame in frames}) == 1, key
    lines = [line for frame in frames for line in frame["lines"]]
    assert [line["track"] for line in lines] == [0] * 4
    assert len({tuple(line["burgers_lattice"]) for line in lines}) == 1
    places = [np.mean(line["path"], axis=0)[0] for line in lines]
    # The line moved as far as in the construction, within a core width.
    assert places[-1] - places[0] == pytest.approx(3 * 1.3, abs=3)
    dying = [sys.executable, "-c", KILLED, str(file), "-o", str(parts)]
    done = subprocess.run(dying, cwd=ROOT, timeout=300, check=False, capture_output=True)
    assert done.returncode == -9
    kept = sorted((parts / "frames").glob("0*.json"))
    assert [path.name for path in kept] == ["000000.json", "000001.json"]
    run("crystal", str(file), "-o", str(parts), "--resume")
    names = sorted(path.name for path in whole.iterdir())
    assert sorted(path.name for path in parts.iterdir()) == names
    for name in names:
        assert (parts / name).read_bytes() == (whole / name).read_bytes(), name
