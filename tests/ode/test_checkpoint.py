"""Checkpoints: an interrupted run ends with the same bits as an uninterrupted one."""

import json
import os
import subprocess
import sys
import textwrap

import numpy as np
import pytest

from geomtorsion.errors import CheckpointError
from geomtorsion.ode import ODE, At, RungeKutta, Stiff, Taylor, solve
from geomtorsion.ode.checkpoint import Checkpoint
from geomtorsion.ode.numbers import PARTS
from tests.ode.engines import every_engine, needs_heyoka


def top(**more):
    """A free top with a change of w1 at t = 3.3."""
    rates = {"w1": "-w2*w3/2", "w2": "w1*w3", "w3": "-w1*w2/3"}
    return ODE.of(rates, [1, 0.1, 2.0], **more, events=[At(3.3, {"w1": 1.5})])


def interrupted_at(limit):
    """A progress callback that raises KeyboardInterrupt when this part is done."""

    def progress(part):
        assert 0 < part <= 1
        if part >= limit:
            raise KeyboardInterrupt

    return progress


def same(one, two):
    """Whether two solutions are equal to the last bit."""
    return (
        (one.states == two.states).all()
        and one.error == two.error
        and one.engine == two.engine
        and one.cost.steps == two.cost.steps
    )


@every_engine
@pytest.mark.parametrize("finished", [1, 40, PARTS + 9])
def test_interrupted_and_resumed(engine, finished, tmp_path):
    """Ctrl-C reaches the caller; finished parts are in the file and are not computed again."""
    whole = solve(top(), 10.0, 1e-8, engine, checkpoint=tmp_path / "whole.npz")
    # The first run is half of the work, the second half of the rest.
    first, second = min(finished, PARTS), max(finished - PARTS, 0)
    limit = (first + second / 2) / (2 * PARTS)
    with pytest.raises(KeyboardInterrupt):
        solve(top(), 10.0, 1e-8, engine, checkpoint=tmp_path / "part.npz",
              progress=interrupted_at(limit))  # fmt: skip
    with np.load(tmp_path / "part.npz") as data:
        parts = len(json.loads(str(data["metadata"]))["parts"])
    # The change at 3.3 divides one part of each run.
    assert finished <= parts <= finished + 2
    resumed = solve(top(), 10.0, 1e-8, engine, checkpoint=tmp_path / "part.npz")
    assert same(whole, resumed)
    assert not [name for name in os.listdir(tmp_path) if name.endswith(".part")]


@needs_heyoka
@pytest.mark.parametrize("engine", [Taylor(64), Taylor(113), Stiff("LSODA")])
def test_every_kind_of_number(engine, tmp_path):
    """Numbers longer than doubles are restored bit by bit."""
    path = tmp_path / "long.npz"
    whole = solve(top(), 4.0, 1e-8, engine, checkpoint=tmp_path / "whole.npz")
    with pytest.raises(KeyboardInterrupt):
        solve(top(), 4.0, 1e-8, engine, checkpoint=path, progress=interrupted_at(0.4))
    assert same(whole, solve(top(), 4.0, 1e-8, engine, checkpoint=path))


def test_finished_runs_are_read(tmp_path):
    """A finished run is read from its file, and progress ends at one."""
    path = tmp_path / "deep" / "done.npz"
    whole = solve(top(), 5.0, 1e-8, RungeKutta(), checkpoint=path)
    seen: list[float] = []
    # The second solve evaluates no rates: the cost stays the same.
    again = solve(top(), 5.0, 1e-8, RungeKutta(), checkpoint=path, progress=seen.append)
    assert same(whole, again)
    assert again.cost == whole.cost
    assert seen[-1] == 1.0
    assert (np.diff(seen) >= 0).all()


def test_history_does_not_matter(tmp_path):
    """Earlier solves in the same process change nothing."""
    first = solve(top(), 8.0, 1e-8, checkpoint=tmp_path / "one.npz")
    for accuracy in (1e-5, 1e-12):
        solve(top(), 8.0, accuracy)
    assert same(first, solve(top(), 8.0, 1e-8, checkpoint=tmp_path / "two.npz"))


@pytest.mark.parametrize(
    "other",
    [
        {"t": 6.0},
        {"accuracy": 1e-9},
        {"problem": top().with_start(start={"w1": 1.1})},
        {"problem": top().with_start(events=[At(3.3, {"w1": 1.6})])},
        {"engine": Stiff()},
    ],
)
def test_other_runs_are_refused(other, tmp_path):
    """Another ODE, time, accuracy or engine is refused, unless overwrite=True."""
    path = tmp_path / "run.npz"
    call = {"problem": top(), "t": 5.0, "accuracy": 1e-7, "engine": RungeKutta()}
    solve(**call, checkpoint=path)
    with pytest.raises(CheckpointError, match="expected a checkpoint of this run"):
        solve(**(call | other), checkpoint=path)
    solve(**(call | other), checkpoint=path, overwrite=True)
    solve(**(call | other), checkpoint=path)


def test_other_files_are_refused(tmp_path):
    """A file that is not a checkpoint is refused and stays unchanged."""
    path = tmp_path / "notes.npz"
    path.write_text("not yours")
    with pytest.raises(CheckpointError, match="not a checkpoint"):
        solve(top(), 1.0, engine=RungeKutta(), checkpoint=path)
    assert path.read_text() == "not yours"
    np.savez(tmp_path / "array.npz", metadata=np.array("[1]"))
    with pytest.raises(CheckpointError, match="not a checkpoint"):
        solve(top(), 1.0, engine=RungeKutta(), checkpoint=tmp_path / "array.npz")


def test_killed(tmp_path):
    """A killed run leaves a whole file, from which the run resumes."""
    script = textwrap.dedent(
        """
        import os, signal, sys
        from geomtorsion.ode import RungeKutta, solve
        from tests.ode.test_checkpoint import top
        count = [0]
        def progress(part):
            count[0] += 1
            if count[0] == 75:
                os.kill(os.getpid(), signal.SIGKILL)
        solve(top(), 20.0, 1e-10, RungeKutta(), checkpoint=sys.argv[1], progress=progress)
        """
    )
    path = tmp_path / "killed.npz"
    done = subprocess.run([sys.executable, "-c", script, str(path)], check=False, timeout=120)
    assert done.returncode < 0
    with np.load(path) as data:
        kept = len(json.loads(str(data["metadata"]))["parts"])
    assert 0 < kept <= 75
    resumed = solve(top(), 20.0, 1e-10, RungeKutta(), checkpoint=path)
    whole = solve(top(), 20.0, 1e-10, RungeKutta(), checkpoint=tmp_path / "whole.npz")
    assert same(whole, resumed)


def test_between_the_times(tmp_path):
    """Dense output and event times of a run with a checkpoint agree with a run without one."""
    sol = solve(top(), 10.0, 1e-9, RungeKutta(), checkpoint=tmp_path / "run.npz")
    plain = solve(top(), 10.0, 1e-9, RungeKutta())
    at = np.linspace(0, 10, 37)
    assert sol.at(at).states == pytest.approx(plain.at(at).states, abs=1e-7)
    assert sol.event_times("w1") == pytest.approx(plain.event_times("w1"), abs=1e-7)


@pytest.mark.parametrize(("share", "least", "most"), [(0.0, 1, 3), (1e9, 2 * PARTS, 200)])
def test_how_often_it_is_written(share, least, most, tmp_path, monkeypatch):
    """The share of time for writing sets how often the file is written, and not the result."""
    written = []

    def in_a_second(checkpoint):
        """Record a write of a large file, which takes a second."""
        written.append(checkpoint)
        checkpoint._took = 1.0

    monkeypatch.setattr(Checkpoint, "write", in_a_second)
    monkeypatch.setattr("geomtorsion.ode.checkpoint.SHARE", share)
    found = solve(top(), 10.0, 1e-7, RungeKutta(), checkpoint=tmp_path / "run.npz")
    assert least <= len(written) <= most
    monkeypatch.undo()
    assert same(found, solve(top(), 10.0, 1e-7, RungeKutta(), checkpoint=tmp_path / "other.npz"))
