"""run: files, refusals, and stopped runs."""

import csv
import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from geomtorsion.pictures import scene_film
from geomtorsion.scenes import SceneResult, load, read_file
from geomtorsion.support.workers import Bounds, work_within
from tests.cli.running import run
from tests.processes import interruptible

SLOW = """\
watch = ["omega", "energy"]
t = 1000
accuracy = 3e-10
[body]
moments = [1, 2, 3]
[[effects]]
kind = "body_moment"
moment = ["sin(t)/10", 0, 0]
[start]
omega = [0.5, 0.4, 1]
"""


def test_a_run_leaves_what_the_library_computes(tmp_path, no_pictures):
    """The table equals the arrays to the last digit; facts and scene are written, no checkpoint."""
    folder = tmp_path / "deep" / "run"
    arguments = ("--watch", "nutation,omega", "--accuracy", "1e-9", "--t", "500 ms")
    text = run("run", "lagrange_cusp", *arguments, "--set", "gravity.g=1.62", "-o", str(folder))
    assert "No pictures: matplotlib is not installed" in text.stdout
    assert sorted(path.name for path in folder.iterdir()) == [
        "result.npz", "run.json", "scene.toml", "table.csv",
    ]  # fmt: skip
    scene = load("lagrange_cusp").with_values(
        {"watch": ("nutation", "omega"), "accuracy": 1e-9, "t": 0.5, "gravity.g": 1.62}
    )
    assert read_file(folder / "scene.toml") == scene
    loaded = SceneResult.load(folder / "result.npz")
    expected = scene.run()
    assert np.abs(loaded["nutation"] - expected["nutation"]).max() < 1e-9
    with (folder / "table.csv").open(newline="") as file:
        head, *rows = csv.reader(file)
    assert head == ["t", "nutation", "omega_1", "omega_2", "omega_3"]
    assert [float(row[1]) for row in rows] == loaded["nutation"].tolist()
    facts = json.loads((folder / "run.json").read_text())
    assert facts["error"] <= facts["accuracy"] == 1e-9
    assert facts["watch"] == ["nutation", "omega"]


def test_figures_and_animation(tmp_path, monkeypatch):
    """Figures are written and listed; the animation also works if the attitude is not watched."""
    pytest.importorskip("matplotlib")
    quick = replace(scene_film.STYLE, rate=2)
    monkeypatch.setattr(scene_film, "STYLE", quick)
    film = tmp_path / "animation" / "top.gif"
    out = str(tmp_path / "run")
    arguments = (
        "--watch",
        "axis,energy",
        "-o",
        out,
        "--picture-format",
        "svg",
        "--animate",
        str(film),
    )
    text = run("run", "lagrange_loop", *arguments, "--t", "0.3").stdout
    listed = json.loads((tmp_path / "run" / "run.json").read_text())["pictures"]
    assert listed == ["watched.svg", "axis.svg", "trust.svg", "plan.svg"]
    for name in listed:
        assert (tmp_path / "run" / name).stat().st_size > 5000
    assert film.stat().st_size > 20_000
    assert f"wrote {film}" in text


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("run", "dzanibekov"), "Did you mean dzhanibekov"),
        (("run", "none.toml"), "cannot be read"),
        (("run", "helix", "--watch", "positoin"), "positoin"),
        (("run", "helix", "--accuracy", "0"), "expected a positive number"),
        (("run", "helix", "--engine", "magic"), "got 'magic'"),
        (("run", "helix", "--t", "3 m"), "expected a value in s"),
        (("run", "helix", "--t", "inf"), "expected a finite number, got inf"),
        (("run", "helix", "--t", "nan s"), "expected a finite number, got nan s"),
        (("run", "helix", "--set", "body.mas=2"), "Did you mean mass"),
        (("run", "helix", "--set", "body.mass"), "expected PATH=NUMBER"),
        (("run", "helix", "--set", "body.mass=-1"), "positive number"),
        (("run", "helix", "--resume"), "expected a directory with a run, got none"),
        (("run", "helix", "--overwrite"), "expected a directory with a run, got none"),
        (("run", "helix", "--set", "t=1", "--set", "t=2"), "expected t once, got it twice"),
        (
            ("run", "helix", "--t", "0.1", "--animate", "top.avi"),
            "expected the name of a .gif or .mp4",
        ),
    ],
)
def test_bad_input_is_refused(arguments, words):
    """A wrong argument ends the command with code 2 and one message, without a traceback."""
    result = run(*arguments, code=2)
    assert words in result.stderr
    assert result.stderr.startswith("geomtorsion: ")
    assert "Traceback" not in result.output


def test_watch_may_be_given_several_times(tmp_path, no_pictures):
    """Quantities of several --watch are watched in their order."""
    arguments = ("--t", "0.1", "--watch", "matrix", "--watch", "energy,omega", "-o", str(tmp_path))
    run("run", "lagrange_cusp", *arguments)
    facts = json.loads((tmp_path / "run.json").read_text())
    assert facts["watch"] == ["matrix", "energy", "omega"]


def test_overwrite_restarts_a_stopped_run(tmp_path, no_pictures):
    """--overwrite removes the checkpoint of another run, and the new run succeeds."""
    checkpoint = tmp_path / "checkpoint.npz"
    checkpoint.write_bytes(b"what another run had computed")
    arguments = ("lagrange_cusp", "--t", "0.1", "-o", str(tmp_path))
    assert "--overwrite to start again" in run("run", *arguments, code=2).stderr
    assert "Give one" in run("run", *arguments, "--overwrite", "--resume", code=2).stderr
    assert checkpoint.exists()
    run("run", *arguments, "--overwrite")
    assert not checkpoint.exists()
    assert (tmp_path / "table.csv").exists()


@pytest.mark.parametrize("option", ["--resume", "--kept"])
def test_resume_without_a_stopped_run_is_refused(option, tmp_path):
    """--resume and --kept without a stopped run are refused, and no directory is created."""
    folder = tmp_path / "misspelt"
    refused = run("run", "lagrange_cusp", "--t", "0.1", option, "-o", str(folder), code=2)
    assert "expected a stopped run, got none. Omit --resume" in refused.stderr
    assert not folder.exists()


def test_errors_of_files_name_file_and_line(tmp_path):
    """The message on the command line names the file, the line and the key."""
    file = tmp_path / "bad.toml"
    file.write_text(SLOW.replace("moments", "moment"))
    assert "bad.toml: line 5: body: unknown key 'moment'" in run("run", str(file), code=2).stderr


def test_a_stuck_run_writes_its_computed_part(tmp_path, no_pictures):
    """A pole at t = 1: a message, the computed part of the table, code 1, and no checkpoint."""
    file, out = tmp_path / "pole.toml", tmp_path / "out"
    file.write_text(POLE)
    result = run("run", str(file), "-o", str(out), code=1)
    assert "cannot continue at t = " in result.stderr
    assert "`solution`" not in result.stderr
    with (out / "table.csv").open(newline="") as table:
        rows = [[float(x) for x in row] for row in list(csv.reader(table))[1:]]
    assert len(rows) > 20
    # x'' = 2 x^3 from 1 with speed 1: x = 1/(1 - t).
    assert all(abs(x * (1 - t) - 1) < 1e-6 for t, x, *_ in rows if t < 0.9)
    assert not (out / "checkpoint.npz").exists()
    file.write_text(POLE.replace("2*x**3", "log(t - 1)"))
    assert "vx' = nan" in run("run", str(file), "-o", str(out), code=2).stderr
    assert not (out / "checkpoint.npz").exists()


POLE = """watch = ["position"]
t = 2
[body]
moments = [1, 2, 2.5]
[[effects]]
kind = "custom"
force = ["2*x**3", 0, 0]
[start]
position = [1, 0, 0]
velocity = [1, 0, 0]
"""


class Started:
    """`geomtorsion run SLOW` in a process of its own, with a directory for its files."""

    def __init__(self, folder: Path, *more: str) -> None:
        self.out = folder / "out"
        file = folder / "slow.toml"
        file.write_text(SLOW)
        command = [sys.executable, "-c", HIDING, "run", str(file), "-o", str(self.out), *more]
        self.process = interruptible(
            [*command, "--engine", "rungekutta"],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
        )

    def until_kept(self) -> None:
        """Wait until the checkpoint holds a part of the run, besides its metadata."""
        path = self.out / "checkpoint.npz"
        while not path.exists() or len(np.load(path).files) < 2:
            assert self.process.poll() is None, self.process.communicate()
            time.sleep(0.005)

    def ended(self) -> tuple[int, str, str]:
        """Exit code, standard output and standard error."""
        out, err = self.process.communicate(timeout=120)
        return self.process.returncode, out, err


# Figures take longer than the run; other tests cover them.
HIDING = "import sys; sys.modules['matplotlib'] = None; from geomtorsion.cli import main; main()"


def test_stopped_runs_resume_to_the_same_result(tmp_path, no_pictures):
    """Killed, then interrupted, then resumed: the result equals an uninterrupted run bit by bit."""
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    whole.mkdir()
    parts.mkdir()
    killed = Started(parts)
    killed.until_kept()
    killed.process.kill()
    assert killed.ended()[0] == -signal.SIGKILL
    assert not (parts / "out" / "table.csv").exists()
    given = ("run", str(parts / "slow.toml"), "-o", str(parts / "out"), "--engine", "rungekutta")
    refused = run(*given, code=2).stderr
    assert "Give --resume" in refused
    assert "--overwrite to start again" in refused
    other = run(*given, "--resume", "--accuracy", "1e-9", code=2).stderr
    assert "got one with other equations" in other
    assert "give --overwrite." in other
    assert "overwrite=True" not in other

    shown = run(*given, "--kept").stdout
    assert "the computed part, to t = " in shown
    with (parts / "out" / "partial.csv").open(newline="") as file:
        partial = list(csv.reader(file))

    interrupted = Started(parts, "--resume")
    interrupted.until_kept()
    before = (parts / "out" / "checkpoint.npz").stat().st_mtime_ns
    while (parts / "out" / "checkpoint.npz").stat().st_mtime_ns == before:
        assert interrupted.process.poll() is None, interrupted.process.communicate()
        time.sleep(0.005)
    interrupted.process.send_signal(signal.SIGINT)
    code, _, said = interrupted.ended()
    assert code == 130
    assert "resume with --resume" in said

    assert "wrote" in run(*given, "--resume").stdout
    (whole / "slow.toml").write_text(SLOW)
    run("run", str(whole / "slow.toml"), "-o", str(whole / "out"), *given[-2:])
    assert not (parts / "out" / "checkpoint.npz").exists()
    one = SceneResult.load(whole / "out" / "result.npz")
    other = SceneResult.load(parts / "out" / "result.npz")
    for name in ("omega", "energy"):
        assert one[name].tobytes() == other[name].tobytes()
    assert len(partial) > 1
    expected = np.column_stack([one.times, one["omega"], one["energy"]])[: len(partial) - 1]
    assert np.abs(np.array(partial[1:], dtype=float) - expected).max() < 1e-6
    assert not (parts / "out" / "partial.csv").exists()
    assert one.times.tobytes() == other.times.tobytes()
    assert (one.error, one.drift) == (other.error, other.drift)
    tables = [(folder / "out" / "table.csv").read_bytes() for folder in (whole, parts)]
    assert tables[0] == tables[1]


def test_interrupted_while_writing(tmp_path, no_pictures, monkeypatch):
    """Ctrl-C after the last step keeps the run; --resume only writes its files."""
    given = ("run", "lagrange_cusp", "-o", str(tmp_path / "out"))

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("geomtorsion.cli.commands.run.write_run", interrupt)
        assert "resume with --resume" in run(*given, code=130).stderr
    assert "wrote" in run(*given, "--resume").stdout
    assert not (tmp_path / "out" / "checkpoint.npz").exists()


@pytest.mark.skipif(sys.platform != "linux", reason="the killed process is a fork")
@pytest.mark.parametrize(
    "scene",
    [
        pytest.param(("dzhanibekov", "--t", "1"), id="dzhanibekov"),
        pytest.param(
            ("lagrange_cusp", "--t", "0.05", "--watch", "omega"),
            id="lagrange_cusp",
            marks=pytest.mark.slow,
        ),
    ],
)
def test_a_run_is_resumed_wherever_it_is_killed(tmp_path, no_pictures, scene):
    """Killed before the k-th change of its files, a run is resumed to the same arrays."""
    run("run", *scene, "-o", str(tmp_path / "whole"))
    whole = SceneResult.load(tmp_path / "whole/result.npz")
    ends = []
    while 0 not in ends:
        out = ("-o", str(tmp_path / f"out{len(ends)}"))
        ends.append(work_within(Bounds(), partial(killed_at, len(ends), *scene, *out), 2))
        if ends[-1] == 0:
            break
        if not (tmp_path / out[1] / "checkpoint.npz").exists():
            assert "Omit --resume" in run("run", *scene, *out, "--resume", code=2).stderr
            run("run", *scene, *out)
        else:
            assert "Give --resume" in run("run", *scene, *out, code=2).stderr
            run("run", *scene, *out, "--resume")
        again = SceneResult.load(tmp_path / out[1] / "result.npz")
        assert again["omega"].tobytes() == whole["omega"].tobytes()
        files = {path.name for path in Path(out[1]).iterdir() if not path.name.startswith(".")}
        assert files == {path.name for path in (tmp_path / "whole").iterdir()}
    # The checkpoint, four files, and the end of the checkpoint.
    assert len(ends) > 6
    assert set(ends[:-1]) == {137}


def killed_at(number, *arguments_and_begun):
    """Run a command in this process, which kills itself before a change of its files."""
    *arguments, _ = arguments_and_begun
    changes = iter(range(1000))

    def kill(event, _):
        if event in ("os.rename", "os.remove") and next(changes) == number:
            os.kill(os.getpid(), signal.SIGKILL)

    sys.addaudithook(kill)
    run("run", *arguments)


def test_proved_prints_certain_digits():
    """The states at the end are printed with 15 certain digits."""
    text = run("run", "dzhanibekov", "--t", "1", "--proved").stdout
    assert "proved at t = 1, 15 digits" in text
    assert "Omega2 = 0.9999" in text
    assert "holds: proved" in text


def test_only_needed_omits_effects(tmp_path, no_pictures):
    """The influence of each effect is shown and written; the scene that is run has the others."""
    scene = load("thrown_body").with_values({"t": 1, "angular_damping.coefficient": 1e-8})
    folder = tmp_path / "thrown"
    changes = ("--t", "1", "--accuracy", "0.05", "--set", "angular_damping.coefficient=1e-8")
    text = run("run", "thrown_body", *changes, "--only-needed", "-o", str(folder)).stdout
    budget = scene.called_for(0.05)
    assert f"calls for {len(budget.effects)} of 3 effects" in text
    for key in budget.omitted:
        assert f"omitted  {key}" in text
    data = json.loads((folder / "effects.json").read_text())
    assert data["omitted"] == list(budget.omitted) == ["angular_damping"]
    assert f"wrote {folder / 'effects.json'}" in text
    assert read_file(folder / "scene.toml") == budget.chosen
    assert data["error"] <= 0.05
    everything = scene.with_values(accuracy=1e-4).run()
    loaded = SceneResult.load(folder / "result.npz")
    for name in everything:
        size = np.abs(everything[name]).max()
        assert np.abs(loaded[name] - everything[name]).max() <= 0.05 * size
