"""Worker pool: processes with limits of time and memory, each replaced when it ends."""

import io
import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from geomtorsion.teaching.exercises.worker_pool import PoolBusyError, WorkerPool, serve

ROOT = Path(__file__).parents[3]
PARENT_LIVES = 0.5


def sleepy(request):
    """Task of the workers in these tests: sleep, allocate, recurse, or return the process id."""
    time.sleep(request.get("sleep", 0.0))
    # Only address space is allocated: nothing is written.
    taken = np.empty(request.get("bytes", 0), dtype=np.uint8)
    if request.get("deep"):
        return sleepy(request)
    return {"pid": os.getpid(), "bytes": len(taken)}


@pytest.fixture(scope="module")
def pool():
    """One pool for all tests; it replaces a worker that a test ends."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", str(ROOT))
        with WorkerPool(f"{__name__}:sleepy", patience=0.2) as made:
            made.ask({}, 60)
            yield made


def test_one_process_answers_all(pool):
    """A worker remains while it answers in time, and it is another process."""
    first = pool.ask({}, 60)["pid"]
    assert first == pool.ask({}, 60)["pid"] != os.getpid()


def test_a_worker_begins_without_a_word(capfd, monkeypatch):
    """A worker prints nothing at its start."""
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    with WorkerPool(f"{__name__}:sleepy", errors_shown=True) as made:
        made.ask({}, 60)
    assert capfd.readouterr().err == ""


def test_a_worker_beyond_its_time_is_replaced(pool):
    """The process ends at once, and the next request gets another one."""
    first = pool.ask({}, 60)["pid"]
    [worker] = pool.workers
    with pytest.raises(TimeoutError):
        pool.ask({"sleep": 60}, 0.1)
    assert not worker.lives
    assert pool.ask({}, 60)["pid"] != first


def test_a_long_wait_raises_an_error(pool):
    """A request to a busy worker raises PoolBusyError after the waiting time."""
    busy = threading.Thread(target=pool.ask, args=({"sleep": 1.0}, 60))
    busy.start()
    time.sleep(0.1)
    with pytest.raises(PoolBusyError, match="busy with other requests for 0.2 s"):
        pool.ask({}, 60)
    busy.join()


@pytest.mark.skipif(sys.platform != "linux", reason="address space is bounded on Linux")
def test_memory_is_limited(pool):
    """A request above the memory limit is refused, and the worker continues."""
    assert pool.ask({"bytes": 5 * 2**30}, 60)["bytes"] == 5 * 2**30
    assert pool.ask({"bytes": 6 * 2**30}, 60) == {"exceeded": "memory"}
    assert pool.ask({}, 60)["bytes"] == 0


def test_depth_is_limited():
    """An endless recursion gives a reply, and the next request is answered."""
    replies = io.StringIO()
    serve(sleepy, io.StringIO('{"deep": 1}\n{"bytes": 3}\n'), replies)
    ready, deep, shallow = replies.getvalue().splitlines()
    assert ready == "ready"
    assert json.loads(deep) == {"exceeded": "depth"}
    assert json.loads(shallow)["bytes"] == 3


@pytest.mark.skipif(sys.platform == "win32", reason="parents are not seen to end there")
def test_a_worker_ends_with_its_parent():
    """After a parent is killed, its workers end, also a busy one."""
    code = (
        "from geomtorsion.teaching.exercises.worker_pool import Worker\n"
        f"w = Worker('{__name__}:sleepy')\n"
        "print(w.ask({}, 60)['pid'], flush=True)\n"
        "w.ask({'sleep': 60}, 60)"
    )
    parent = subprocess.Popen(
        [sys.executable, "-c", code],
        stdout=subprocess.PIPE,
        text=True,
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
    )
    assert parent.stdout is not None
    worker = int(parent.stdout.readline())
    time.sleep(PARENT_LIVES)
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
