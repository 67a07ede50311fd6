"""Public things pickle and deep-copy: a copy in another process gives the same bits."""

from __future__ import annotations

import copy
import pickle
import subprocess
import sys
from pathlib import Path

import pytest

import geomtorsion as gt
from tests.copied import answers, things

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def originals():
    """Things, and what they give."""
    made = things()
    return made, {name: answers(name, thing) for name, thing in made.items()}


def test_copies_in_a_fresh_process(originals, tmp_path):
    """What was pickled here gives the same there, to the bit."""
    made, wanted = originals
    source, target = tmp_path / "things.pickle", tmp_path / "answers.pickle"
    source.write_bytes(pickle.dumps(made))
    command = [sys.executable, "-m", "tests.copied", str(source), str(target)]
    subprocess.run(command, check=True, cwd=ROOT, timeout=300)
    found = pickle.loads(target.read_bytes())
    assert len(found) == len(wanted) >= 31
    different = [name for name in wanted if found[name] != wanted[name]]
    assert not different


def test_deep_copies(originals):
    """Copies in this process."""
    made, wanted = originals
    for name, thing in made.items():
        assert answers(name, copy.deepcopy(thing)) == wanted[name], name


def test_what_was_together_stays_together():
    """Tensors that are pickled with their frame belong to its copy, and so do exact elements."""
    frame = gt.spaces.load("so3").frame
    together = frame, frame.metric, frame.metric.element(0, 2), gt.cartan(frame)
    again, tensor, element, connection = pickle.loads(pickle.dumps(together))
    assert tensor.frame is again
    assert again.metric == tensor
    assert element == again.metric.element(0, 2)
    assert gt.cartan(again) is connection


def test_values_are_their_own_copies():
    """What never changes need not be made twice, and equality is kept."""
    frame = gt.spaces.load("so3").frame
    assert copy.deepcopy(frame) is frame
    assert copy.deepcopy(frame.metric) == frame.metric


def test_a_pickle_is_small():
    """Plain data only: no compiled code, no tables that fill with use."""
    kerr = gt.spaces.load("kerr").frame
    before = len(pickle.dumps(kerr))
    gt.levi_civita(kerr).curvature.kretschmann[()]
    assert len(pickle.dumps(kerr)) == before < 10_000
