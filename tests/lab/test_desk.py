"""The desk: work is done elsewhere, within limits, and one failure is nobody else's."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from geomtorsion import exercises
from geomtorsion.exercises.prompts import shown_name
from geomtorsion.lab.desk import Desk
from geomtorsion.lab.problems import LONGEST, answer, statement
from geomtorsion.lab.tasks import LONGEST_REQUEST, TASKS
from tests.lab.serving import ROOT

# A metric of four unrelated functions of everything takes far longer than its limit here.
SLOW = {
    "coordinates": "a b c d",
    "entries": [
        [f"sqrt(1 + a^{i + 2}*b^{k + 1} + c^{k + 3}*sin(d)^{i + 1})" for k in range(4)]
        for i in range(4)
    ],
    "show": ["weyl"],
}


@pytest.fixture
def desk() -> Iterator[Desk]:
    found = Desk(workers=1, patience=20.0, limits={"tetrad": 3.0})
    yield found
    found.close()


def test_a_request_is_answered_and_kept(desk: Desk):
    """The second of two equal requests is the same answer, not a second computation."""
    one = desk.ask("facts", space="s2")
    assert one["coordinates"] == ["theta", "phi"]
    assert desk.ask("facts", space="s2") is one


def test_a_request_that_takes_too_long_is_stopped(desk: Desk):
    """After its time the worker is ended; the next request is answered by another."""
    desk.ask("facts", space="s2")
    [worker] = desk._all
    assert "takes longer than the 3 s" in desk.ask("tetrad", **SLOW)["problem"]
    assert not worker.lives
    assert desk.ask("tetrad", coordinates="r, phi", entries=[["1", "0"], ["0", "r"]])["html"]


def test_nothing_that_lies_about_is_imported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """A folder with a module named like one that is needed does not mislead a worker."""
    (tmp_path / "json.py").write_text("raise SystemExit", "utf-8")
    (tmp_path / "sympy.py").write_text("raise SystemExit", "utf-8")
    monkeypatch.chdir(tmp_path)
    desk = Desk(workers=1)
    try:
        assert desk.ask("facts", space="s2")["name"] == "s2"
    finally:
        desk.close()


def test_warming_up_leaves_a_worker_free():
    """While one worker practises, the other answers; what was practised is kept."""
    desk = Desk(workers=2, patience=30.0)
    try:
        desk.warm([("facts", {"space": "heisenberg"})])
        assert desk.ask("facts", space="s2")["name"] == "s2"
        for _ in range(600):
            if desk._kept.keys() >= {'{"task": "facts", "arguments": {"space": "heisenberg"}}'}:
                break
            time.sleep(0.1)
        else:
            pytest.fail("nothing was kept of the practice")
    finally:
        desk.close()


def test_errors_come_as_messages(desk: Desk):
    """An error of the package is a message, and is not kept."""
    case = {"centre": [1, 2, 3], "radius": 1, "plane": [0, 1]}
    assert "has" in desk.ask("loop", space="s2", **case)["problem"]
    assert "nobody" in desk.ask("facts", space="nobody")["problem"]
    assert "no task is called" in desk.ask("rm")["problem"]


def test_a_request_that_is_too_long_is_refused(desk: Desk):
    """Long texts do not even reach a worker."""
    found = desk.ask("tetrad", coordinates="r", entries=[["1" * LONGEST_REQUEST]])
    assert "24,000" in found["problem"]


def test_a_worker_that_dies_is_replaced(desk: Desk):
    """What goes wrong in one worker is told to whoever asked, and to nobody else."""
    assert "worker ended" in desk.ask("facts", wrong="argument")["problem"]
    assert desk.ask("facts", space="s2")["name"] == "s2"


@pytest.mark.skipif(sys.platform == "win32", reason="parents are not seen to end there")
def test_a_worker_ends_with_its_parent():
    """Whoever starts workers and is killed leaves none behind, even one that is at work."""
    code = (
        "import threading, time; from geomtorsion.lab.desk import Worker; w = Worker();"
        "print(w.process.pid, flush=True); from tests.lab.test_desk import SLOW; import json;"
        "w.ask(json.dumps({'task': 'tetrad', 'arguments': SLOW}), 60)"
    )
    parent = subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, text=True, cwd=ROOT
    )
    assert parent.stdout is not None
    worker = int(parent.stdout.readline())
    time.sleep(3)
    parent.kill()
    parent.wait()
    parent.stdout.close()
    for _ in range(200):
        try:
            os.kill(worker, 0)
        except ProcessLookupError:
            return
        time.sleep(0.1)
    os.kill(worker, signal.SIGKILL)
    pytest.fail("the worker was still at work")


def test_a_crowd_that_waits_too_long_is_told():
    """One worker, busy: the next in the queue is told to come back, and is not lost."""
    desk = Desk(workers=1, patience=0.2, limits={"tetrad": 4.0})
    busy = threading.Thread(target=lambda: desk.ask("tetrad", **SLOW))
    busy.start()
    time.sleep(0.1)
    try:
        assert "not your turn" in desk.ask("facts", space="s2")["problem"]
    finally:
        busy.join()
        desk.close()


def test_every_task_can_be_found():
    """The list names functions that are there."""
    from importlib import import_module

    assert len(TASKS) > 8
    for task in TASKS.values():
        assert callable(getattr(import_module(task.module), task.function))


@pytest.mark.parametrize("number", exercises.names()[::5])
def test_an_exercise_right_and_wrong(number):
    """Its own solution is right; hints and prompts come as HTML with mathematics."""
    posed = exercises.load(number)
    shown = statement(number)
    assert "$" not in shown["statement"]
    assert [question["name"] for question in shown["questions"]] == [
        question.name for question in posed.questions
    ]
    for told, question in zip(shown["questions"], posed.questions, strict=True):
        if question.kind not in ("number", "choice"):
            assert all(shown_name(symbol.name) in told["how"] for symbol in question.domain.symbols)
    assert answer(number, 0, posed.answers())["right"]
    first = posed.questions[0].name
    found = answer(number, 0, {first: "17*17"})
    assert not found["right"]
    assert [one["name"] for one in found["questions"]] == [first]


def test_an_endless_answer_is_refused():
    """An answer is no novel."""
    with pytest.raises(ValueError, match="enough for every exercise"):
        answer("1.1", 0, {"legs": "1" * (LONGEST + 1)})
