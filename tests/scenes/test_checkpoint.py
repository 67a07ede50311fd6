"""The part that a stopped run has computed can be read and agrees with the whole run."""

import numpy as np
import pytest

from geomtorsion.errors import CheckpointError
from geomtorsion.ode import RungeKutta
from geomtorsion.scenes import load
from geomtorsion.scenes.checkpoint import partial_result
from geomtorsion.scenes.saving import metadata


class Enough(Exception):
    """Raised to stop a run from within."""


def stopped(scene, path, engine, share: float) -> None:
    """Run a scene until a share of it is done."""

    def stop(done: float) -> None:
        if done >= share:
            raise Enough

    with pytest.raises(Enough):
        scene.run(engine, path, stop)


@pytest.mark.parametrize("engine", [None, RungeKutta()], ids=["chosen", "rungekutta"])
@pytest.mark.parametrize("times", [1.0, (0.25, 0.5, 1.0)], ids=["samples", "own times"])
def test_part_of_a_run(tmp_path, engine, times):
    """All samples up to the stop agree with the whole run; the error is not yet known."""
    scene = load("lagrange_cusp").with_values(t=times, accuracy=1e-9)
    path = tmp_path / "run.npz"
    stopped(scene, path, engine, 0.3)
    part = partial_result(scene, path, engine)
    whole = scene.run(engine)
    assert part.outcome == "interrupted"
    assert not part.complete
    assert part.error == np.inf
    assert metadata(part)["error"] is None
    count = len(part.times)
    assert 1 <= count < len(whole.times)
    assert part.times.tolist() == whole.times[:count].tolist()
    assert np.abs(part["axis"] - whole["axis"][:count]).max() < 1e-6
    assert list(part.columns()) == list(whole.columns())


def test_runs_of_missiles_across_switches(tmp_path):
    """A partial run of a missile spans its switches."""
    scene = load("missile")
    path = tmp_path / "run.npz"
    stopped(scene, path, None, 0.45)
    part, whole = partial_result(scene, path), scene.run()
    assert part.times[-1] > 3.1
    assert np.abs(part["velocity"] - whole["velocity"][: len(part.times)]).max() < 1e-5


def test_bad_calls_are_refused(tmp_path):
    """A missing file, a file of another scene and a foreign file are refused."""
    scene = load("lagrange_cusp")
    path = tmp_path / "run.npz"
    with pytest.raises(CheckpointError, match="there is no such checkpoint"):
        partial_result(scene, path)
    stopped(scene, path, None, 0.2)
    with pytest.raises(CheckpointError, match="expected a checkpoint of this run"):
        partial_result(scene.with_values({"gravity.g": 1.0}), path)
    path.write_bytes(b"something else")
    with pytest.raises(CheckpointError, match="not a checkpoint"):
        partial_result(scene, path)
