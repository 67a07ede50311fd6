"""Workers: processes that do work for this one, watched and ended at limits of time and memory."""

from __future__ import annotations

import contextlib
import os
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO, TYPE_CHECKING

from geomtorsion.errors import AllowanceError, LimitError

if TYPE_CHECKING:
    from multiprocessing.process import BaseProcess

# Seconds between two looks at a process, each of which takes a fraction of a millisecond.
LOOK = 0.02
# Seconds in which a process may report its finished work after a limit, before it is ended.
GRACE = 1.0
# Factor by which its memory may grow meanwhile.
GROWTH = 1.1
# A worker gets one of these at a limit of time or of memory; Windows has neither.
TIME, MEMORY = (getattr(signal, name, None) for name in ("SIGXCPU", "SIGUSR1"))


@dataclass(frozen=True)
class Bounds:
    """Limits of a worker.

    seconds: wall-clock time of its work. megabytes: millions of bytes of resident memory, of it
    and the processes it starts, beyond those at the beginning of its work.
    """

    seconds: float | None = None
    megabytes: float | None = None

    def exceeded(self, seconds: float, taken: float, growth: float = 1.0) -> str:
        """The exceeded limit as text, such as "5 s"; empty within all limits."""
        if self.megabytes is not None and taken > growth * self.megabytes * 10**6:
            return f"{self.megabytes:g} MB"
        if self.seconds is not None and seconds >= self.seconds:
            return f"{self.seconds:g} s"
        return ""


def family(pid: int) -> dict[int, int]:
    """Resident bytes of a process and of all processes below it, by their numbers.

    Empty if the process has ended, or if the system does not report memory (Windows).
    """
    if sys.platform == "linux":
        return _family_on_linux(pid)
    if os.name != "posix":
        return {}
    listed = subprocess.run(
        ["ps", "-A", "-o", "pid=,ppid=,rss="], capture_output=True, text=True, check=False
    )
    rows = [tuple(map(int, line.split())) for line in listed.stdout.splitlines()]
    members = {own: 1024 * size for own, _, size in rows if own == pid}
    while more := {
        own: 1024 * size for own, above, size in rows if above in members and own not in members
    }:
        members |= more
    return members


def _family_on_linux(pid: int) -> dict[int, int]:
    folder, members = Path(f"/proc/{pid}"), {}
    with contextlib.suppress(OSError, IndexError):
        pages = int((folder / "statm").read_text().split()[1])
        members[pid] = pages * os.sysconf("SC_PAGE_SIZE")
        for file in folder.glob("task/*/children"):
            # A thread may end meanwhile.
            with contextlib.suppress(OSError):
                for below in file.read_text().split():
                    members |= _family_on_linux(int(below))
    return members


def resident(pid: int | None = None) -> int | None:
    """Resident bytes of a process (default: this one) and those below it; None if unknown."""
    members = family(os.getpid() if pid is None else pid)
    return sum(members.values()) if members else None


def end_family(pid: int) -> None:
    """End a process and all processes below it, at once."""
    for member in {pid, *family(pid)}:
        with contextlib.suppress(OSError):
            os.kill(member, getattr(signal, "SIGKILL", signal.SIGTERM))


def end_with_parent() -> None:
    """Let this process end, in the midst of whatever it does, when its parent is gone."""
    threading.Thread(target=_outlive_nobody, args=(os.getppid(),), daemon=True).start()


def _outlive_nobody(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(1.0)
    os._exit(1)


def limit_data(most: int) -> None:
    """Bound the data of this process in bytes, where the system can do that.

    More raises MemoryError. Memory-mapped files and reserved addresses do not count.
    """
    try:
        # Not on Windows.
        import resource
    except ImportError:
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
    if soft == resource.RLIM_INFINITY or soft > most:
        with contextlib.suppress(ValueError, OSError):
            resource.setrlimit(resource.RLIMIT_DATA, (most, hard))


def machine_memory() -> int | None:
    """Bytes of memory of this machine; None if unknown."""
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    # Not on Windows.
    except (AttributeError, ValueError, OSError):
        return None


# -- work of this process, done by a worker -------------------------------------------------------


def work_within(bounds: Bounds, work: Callable[[Callable[[], None]], object], reported: int) -> int:
    """Exit code of a worker that calls `work`; the worker is ended when it exceeds a limit.

    On Linux the worker is a fork, which starts at once; elsewhere it is a new process, and `work`
    must be a function that can be pickled.

    work: gets a function, calls it when the work begins, and ends by SystemExit. At a limit it gets
    the signal TIME or MEMORY, and has GRACE seconds to end, with `reported` if it has printed
    that a limit was exceeded.

    Raises
    ------
    AllowanceError
        A limit was exceeded, and the worker has not reported it.
    LimitError
        The system does not report memory.
    """
    if bounds.megabytes is not None and resident() is None:
        raise LimitError(
            "megabytes: expected a system that reports the memory of a process, got none. Give "
            "only seconds."
        )
    # The package imports this file; multiprocessing loads sockets, selectors and more.
    from multiprocessing import get_context

    # Forks are unsafe on other systems: their libraries have threads.
    context = get_context("fork" if sys.platform == "linux" else "spawn")
    begun = context.Event()
    process = context.Process(target=_begin, args=(work, begun.set))
    # Nothing may be printed twice.
    sys.stdout.flush()
    sys.stderr.flush()
    process.start()
    try:
        while not begun.is_set() and process.is_alive():
            _wait(process)
        limit = _watch(process, bounds)
    finally:
        if process.is_alive():
            end_family(process.pid or 0)
        process.join()
    code = process.exitcode or 0
    if limit and code != reported:
        raise AllowanceError(f"the work takes more than {limit}", "the work")
    return code if code >= 0 else 128 - code


def _begin(work: Callable[[Callable[[], None]], object], begun: Callable[[], None]) -> None:
    """Do the work in this process, the worker, which has the standard input of its parent."""
    if hasattr(os, "setsid"):
        # Ctrl-C in the terminal is for the parent, which passes it on.
        os.setsid()
        end_with_parent()
    # multiprocessing closes it.
    sys.stdin = open(0, encoding=sys.__stdin__.encoding if sys.__stdin__ else None, closefd=False)  # noqa: SIM115
    work(begun)


def _wait(process: BaseProcess) -> None:
    """Wait for the next look; Ctrl-C is passed on to the worker, which reports and ends."""
    try:
        process.join(LOOK)
    except KeyboardInterrupt:
        # On Windows all processes of a console get it.
        if os.name == "posix" and process.pid is not None:
            os.kill(process.pid, signal.SIGINT)


def _watch(process: BaseProcess, bounds: Bounds) -> str:
    """Wait until the worker has ended; the limit that it exceeded, or nothing."""
    pid = process.pid or 0
    began, before = time.monotonic(), resident(pid) or 0
    limit, latest = "", 0.0
    while process.is_alive():
        _wait(process)
        now = time.monotonic()
        taken = 0 if bounds.megabytes is None else (resident(pid) or 0) - before
        if not limit:
            limit, latest = bounds.exceeded(now - began, taken), now + GRACE
            sign = MEMORY if limit.endswith("MB") else TIME
            if limit and sign is not None:
                os.kill(pid, sign)
        elif now >= latest or TIME is None or bounds.exceeded(0, taken, GROWTH):
            end_family(pid)
    return limit


# -- processes that answer lines ------------------------------------------------------------------


class LineProcess:
    """A Python process that answers each line of text with a line, until it is ended.

    arguments: of Python, such as the path of a script.
    errors_shown: whether its standard error is shown.
    """

    def __init__(self, arguments: Sequence[str], *, errors_shown: bool = False) -> None:
        # -P: Python imports nothing from the working folder (a sympy.py among answers that are
        # graded), but it does import this package, wherever this process imported it from.
        paths = [str(Path(__file__).parents[1]), os.environ.get("PYTHONPATH", "")]
        self.process: subprocess.Popen[str] = subprocess.Popen(
            [sys.executable, "-P", *arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=None if errors_shown else subprocess.DEVNULL,
            encoding="utf-8",
            env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, paths))},
            # Ctrl-C is for the parent process; this process ends with its parent.
            start_new_session=True,
        )
        self.owner = os.getpid()
        self._replies: queue.Queue[str] = queue.Queue()
        threading.Thread(target=self._listen, args=(self.process.stdout,), daemon=True).start()

    def _listen(self, stream: IO[str]) -> None:
        # A thread reads, since pipes have no time-out on every system.
        with contextlib.suppress(ValueError, OSError):
            for line in stream:
                self._replies.put(line)
        self._replies.put("")

    def send(self, line: str) -> None:
        """Send a line; OSError or ValueError if the process has ended."""
        assert self.process.stdin is not None
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()

    def receive(self, seconds: float) -> str:
        """The next line, empty if the process has ended; TimeoutError if none comes in time."""
        try:
            return self._replies.get(timeout=seconds)
        except queue.Empty:
            raise TimeoutError(f"expected a reply within {seconds:g} s, got none") from None

    @property
    def lives(self) -> bool:
        """Whether it still accepts lines from this process; a fork has no part in it."""
        return self.owner == os.getpid() and self.process.poll() is None

    def end(self) -> None:
        """End the process and its children at once."""
        if self.owner != os.getpid():
            return
        if self.lives:
            end_family(self.process.pid)
        self.process.wait()
        for stream in (self.process.stdin, self.process.stdout):
            if stream is not None:
                # Unwritten data has no reader any more.
                with contextlib.suppress(OSError, ValueError):
                    stream.close()
