"""Copies: public objects pickle and deep-copy; a copy in another process gives the same bits."""

from __future__ import annotations

import copy
import pickle
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import geomtorsion as gt
from tests.copied import answers, things
from tests.golden.record import MOVED_FILE, read
from tests.public_values import values

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def originals():
    """Objects and their answers, by name."""
    made = things()
    return made, {name: answers(name, thing) for name, thing in made.items()}


def test_copies_in_a_fresh_process(originals, tmp_path):
    """An unpickled object in a fresh process gives the same answers, to the bit."""
    made, wanted = originals
    source, target = tmp_path / "things.pickle", tmp_path / "answers.pickle"
    source.write_bytes(pickle.dumps(made))
    command = [sys.executable, "-m", "tests.copied", str(source), str(target)]
    subprocess.run(command, check=True, cwd=ROOT, timeout=300)
    found = pickle.loads(target.read_bytes())
    assert len(found) == len(wanted) >= 31
    different = [name for name in wanted if found[name] != wanted[name]]
    assert not different


def there_and_back(name, thing):
    """The answers of an object in a worker process, and the object to send back."""
    return answers(name, thing), thing


AGAIN = ("frame", "solved curve", "scene", "burgers vector")
# The test above sends all to a fresh process; workers of other libraries receive the same copies.
SENT = pytest.mark.parametrize(
    "many", [len(AGAIN), pytest.param(31, marks=pytest.mark.slow)], ids=["some", "all"]
)


def sent(originals, many):
    """The objects to send, by name."""
    made = originals[0] if many > len(AGAIN) else {name: originals[0][name] for name in AGAIN}
    assert len(made) >= many
    return made


def check_sent(originals, made, found):
    """Answers from the worker, and answers of the returned objects, are the same to the bit."""
    _, wanted = originals
    different = [name for name, (said, _) in zip(made, found, strict=True) if said != wanted[name]]
    assert not different
    for name in AGAIN:
        [again] = [thing for key, (_, thing) in zip(made, found, strict=True) if key == name]
        assert answers(name, again) == wanted[name], name


@SENT
def test_joblib_sends_them(originals, many, monkeypatch):
    """Objects survive the way to processes of loky, joblib's default, and back."""
    joblib = pytest.importorskip("joblib")
    loky = pytest.importorskip("joblib.externals.loky")
    monkeypatch.syspath_prepend(str(ROOT))
    made = sent(originals, many)
    try:
        with joblib.parallel_config(backend="loky", n_jobs=2):
            tasks = (joblib.delayed(there_and_back)(*one) for one in made.items())
            # One batch, so that only one process loads the package; dask receives single objects.
            check_sent(originals, made, joblib.Parallel(batch_size=len(made))(tasks))
    finally:
        loky.get_reusable_executor().shutdown(wait=True)


@SENT
def test_dask_sends_them(originals, many, monkeypatch):
    """Objects survive the way to worker processes of dask and back."""
    distributed = pytest.importorskip("dask.distributed")
    monkeypatch.syspath_prepend(str(ROOT))
    made = sent(originals, many)
    options = {"n_workers": 1, "threads_per_worker": 1, "dashboard_address": None}
    with distributed.Client(processes=True, **options) as client:
        found = client.map(there_and_back, list(made), list(made.values()), pure=False)
        # A worker that cannot read what it is sent would be waited for without end.
        distributed.wait(found, timeout=300)
        check_sent(originals, made, client.gather(found))


def test_deep_copies(originals):
    """Deep copies in this process give the same answers."""
    made, wanted = originals
    for name, thing in made.items():
        assert answers(name, copy.deepcopy(thing)) == wanted[name], name


def test_parts_copied_together_stay_together():
    """Tensors and exact elements that are pickled with their frame belong to its copy."""
    frame = gt.spaces.load("so3").frame
    together = frame, frame.metric, frame.metric.element(0, 2), gt.cartan(frame)
    again, tensor, element, connection = pickle.loads(pickle.dumps(together))
    assert tensor.frame is again
    assert again.metric == tensor
    assert element == again.metric.element(0, 2)
    assert gt.cartan(again) is connection


def test_values_are_their_own_copies():
    """The deep copy of an immutable value is the value itself."""
    frame = gt.spaces.load("so3").frame
    assert copy.deepcopy(frame) is frame
    assert copy.deepcopy(frame.metric) == frame.metric


def test_a_pickle_is_small():
    """A pickle holds plain data only: no compiled code and no cached results."""
    kerr = gt.spaces.load("kerr").frame
    before = len(pickle.dumps(kerr))
    gt.levi_civita(kerr).curvature.kretschmann[()]
    assert len(pickle.dumps(kerr)) == before < 10_000


VALUES = values()
# Protocols, errors, and small plain results that are parts of copied results.
PARTS = {
    "AffineMap", "Chart", "Defect", "EdgeList", "EnclosedDefect", "Engine", "GeomtorsionError",
    "LatticeBurgers", "Network", "NodeRule", "Phase", "PriceList", "PriceRow", "Reaction",
    "SceneCost", "TransitionMap",
}  # fmt: skip


def text(value):
    """Text of a value without memory addresses."""
    return re.sub(r" at 0x[0-9a-f]+", "", str(value))


@pytest.mark.parametrize("name", VALUES)
def test_public_values_pickle_and_copy(name):
    """A copy of a value has the same class and the same text."""
    value = VALUES[name]()
    assert type(value).__name__ == name
    for again in (pickle.loads(pickle.dumps(value)), copy.deepcopy(value)):
        assert type(again) is type(value)
        assert text(again) == text(value)


def test_every_public_class_is_copied(originals):
    """Each public class is copied in a test or listed in PARTS."""
    copied = {*VALUES, *(type(thing).__name__ for thing in originals[0].values())}
    homes = dict.fromkeys(gt.__all__, gt)
    homes |= {name: import_module(f"geomtorsion.{x}") for name, x in read(MOVED_FILE).items()}
    public = {name for name, home in homes.items() if isinstance(getattr(home, name), type)}
    assert public - copied == PARTS
