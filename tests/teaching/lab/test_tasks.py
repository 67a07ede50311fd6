"""Tasks of the page: run in other processes, within limits, with isolated failures."""

from __future__ import annotations

import random
import sys
import threading
import time
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import pytest

from geomtorsion.teaching.exercises.worker_pool import WorkerPool
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.lab.space_info import space_of
from geomtorsion.teaching.lab.tasks import TASKS, TaskRunner, answer
from tests.laws.test_threads import in_threads
from tests.teaching.lab.maps import bomb, wall_ctf

# A metric of four unrelated functions of all coordinates takes far longer than its limit here.
SLOW = {
    "coordinates": "a b c d",
    "entries": [
        [f"sqrt(1 + a^{i + 2}*b^{k + 1} + c^{k + 3}*sin(d)^{i + 1})" for k in range(4)]
        for i in range(4)
    ],
    "show": ["weyl"],
}


@pytest.fixture(scope="module")
def runner() -> Iterator[TaskRunner]:
    """One runner for all tests; it replaces a worker that a test ends."""
    found = TaskRunner(workers=1, patience=20.0, limits={"tetrad": 2.0})
    yield found
    found.close()


def test_a_request_is_answered_and_kept(runner: TaskRunner):
    """The second of two equal requests gets the stored answer."""
    one = runner.ask("space_info", space="s2")
    assert one["coordinates"] == ["theta", "phi"]
    assert runner.ask("space_info", space="s2") is one


def test_a_request_that_takes_too_long_is_stopped(runner: TaskRunner):
    """After its time limit the worker ends, and another worker answers the next request."""
    runner.ask("space_info", space="s2")
    assert isinstance(runner.pool, WorkerPool)
    [worker] = runner.pool.workers
    assert "expected a result within 2 s, got none" in runner.ask("tetrad", **SLOW)["problem"]
    assert not worker.lives
    assert runner.ask("tetrad", coordinates="r, phi", entries=[["1", "0"], ["0", "r"]])["html"]


def test_no_module_of_the_folder_is_imported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """A worker does not import modules from its folder."""
    (tmp_path / "json.py").write_text("raise SystemExit", "utf-8")
    (tmp_path / "sympy.py").write_text("raise SystemExit", "utf-8")
    monkeypatch.chdir(tmp_path)
    runner = TaskRunner(workers=1)
    try:
        assert runner.ask("space_info", space="s2")["name"] == "s2"
    finally:
        runner.close()


def test_warming_up_leaves_a_worker_free():
    """While one worker prepares answers, the other one is free; prepared answers are stored."""
    runner = TaskRunner(workers=2, patience=30.0)
    try:
        runner.warm([("space_info", {"space": "heisenberg"})])
        assert runner.ask("space_info", space="s2")["name"] == "s2"
        for _ in range(600):
            if runner.replies.keys() >= {
                '{"task": "space_info", "arguments": {"space": "heisenberg"}}'
            }:
                break
            time.sleep(0.1)
        else:
            pytest.fail("nothing was kept of the practice")
    finally:
        runner.close()


def test_errors_come_as_messages(runner: TaskRunner):
    """An error of the package becomes a message."""
    case = {"centre": [1, 2, 3], "radius": 1, "plane": [0, 1]}
    assert "has" in runner.ask("loop", space="s2", **case)["problem"]
    assert "nobody" in runner.ask("space_info", space="nobody")["problem"]
    assert "expected the name of a task, got 'rm'" in runner.ask("rm")["problem"]


def test_a_request_that_is_too_long_is_refused(runner: TaskRunner):
    """A text beyond the limit is refused before it reaches a worker."""
    found = runner.ask("tetrad", coordinates="r", entries=[["1" * PAGE.request]])
    assert "24,000" in found["problem"]


def test_a_file_is_looked_into_by_a_worker_only(runner: TaskRunner):
    """A file is stored by its digest; a long or damaged one is refused, the next one is read."""
    content = wall_ctf()
    one = runner.ask("map_facts", content, name="wall.ctf")
    assert one["shape"] == [24, 20]
    assert runner.ask("map_facts", bytes(bytearray(content)), name="wall.ctf") is one
    assert all(len(key) < 300 for key in runner.replies)
    other = runner.ask("map_facts", content.replace(b"XStep\t1.0", b"XStep\t2.0"), name="wall.ctf")
    assert other is not one
    assert "4,000,000" in runner.ask("map_facts", bytes(PAGE.upload + 1), name="a")["problem"]
    assert "unpacked bytes" in runner.ask("map_facts", bomb(), name="a")["problem"]
    assert runner.ask("map_facts", content, name="wall.ctf") is one


def test_a_worker_that_dies_is_replaced(runner: TaskRunner):
    """The failure of a worker is reported to its request, and the next request succeeds."""
    assert "ended unexpectedly" in runner.ask("space_info", wrong="argument")["problem"]
    assert runner.ask("space_info", space="s2")["name"] == "s2"


def test_a_request_that_waits_too_long_is_refused():
    """A request that waits too long for the only worker gets a message."""
    runner = TaskRunner(workers=1, patience=0.2, limits={"tetrad": 1.0})
    busy = threading.Thread(target=lambda: runner.ask("tetrad", **SLOW))
    busy.start()
    time.sleep(0.1)
    try:
        assert (
            "the server was busy with other requests for 0.2 s"
            in runner.ask("space_info", space="s2")["problem"]
        )
    finally:
        busy.join()
        runner.close()


def test_every_task_can_be_found():
    """Each task names an existing function."""
    assert len(TASKS) > 8
    for task in TASKS.values():
        assert callable(getattr(import_module(task.module), task.function))


# Requests that share the cached spaces of one process.
REQUESTS = [
    {"task": "space_info", "arguments": {"space": "so3"}},
    {"task": "space_info", "arguments": {"space": "schwarzschild"}},
    {"task": "space_form", "arguments": {"space": "kerr"}},
    {"task": "space_info", "arguments": {"space": "s2"}},
    {"task": "tetrad", "arguments": {"coordinates": "r phi", "entries": [["1", "0"], ["0", "r"]]}},
    {"task": "listing", "arguments": {}},
]


def test_tasks_in_threads_of_one_process() -> None:
    """Eight threads that run the tasks of the page at once give the replies of one thread."""
    replies = [answer(request) for request in REQUESTS]

    def work(number: int) -> object:
        order = list(range(len(REQUESTS)))
        random.Random(number).shuffle(order)
        own = {k: answer(REQUESTS[k]) for k in order}
        return [own[k] for k in range(len(REQUESTS))]

    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    try:
        # The threads share new spaces, in which nothing is computed yet.
        space_of.cache_clear()
        assert in_threads(work) == [replies] * 8
    finally:
        sys.setswitchinterval(before)


def test_equal_requests_at_once_are_counted_once() -> None:
    """Threads that send the same request get one reply, and the cache holds it once."""
    runner = TaskRunner(workers=2, patience=60.0)
    try:
        replies = in_threads(lambda _: runner.ask("space_info", space="s2"))
        assert replies == [runner.ask("space_info", space="s2")] * 8
        counted = runner._characters
        runner.ask("space_info", space="s2")
        ((key, reply),) = runner.replies.items()
        assert counted == runner._characters == len(key) + sum(len(str(x)) for x in reply.values())
    finally:
        runner.close()
