"""Allowance: time and memory that exact work may take, watched by a thread of its own.

A limit either raises or does nothing: no result depends on it.  What was finished before stays
where it is, in frames, tensors and fields, and the next call goes on from there.
"""

from __future__ import annotations

import ctypes
import os
import sys
import threading
import time
from pathlib import Path
from traceback import clear_frames, walk_tb
from typing import TYPE_CHECKING

import flint
import mpmath

from geomtorsion import checks
from geomtorsion.errors import AllowanceError, ArgumentError, LimitError

if TYPE_CHECKING:
    from types import CodeType, TracebackType


class _Met(BaseException):
    """A limit was met; no BaseException of this kind leaves the block that set the limit."""


class _Entry:
    """One time that a block is entered: nothing of it is left when it is entered again.

    running: held as long as the block is; over: it has ended; inside: it has begun; what: the limit
    that was met. Locks alone: what arrives inside an Event would leave it taken for ever.
    """

    def __init__(self) -> None:
        self.lock, self.running = threading.Lock(), threading.Lock()
        self.running.acquire()
        self.over = self.inside = False
        self.what = ""


class Limits:
    """What `limits` returns: a block of `with` in which time and memory are bounded."""

    def __init__(self, seconds: float | None, megabytes: float | None) -> None:
        self.seconds = seconds
        self.megabytes = megabytes
        # A kind of its own tells the limits of one block from those of a block around it.
        self._kind = type("_Met", (_Met,), {})
        self._entry = _Entry()
        self._precision = mpmath.mp.prec, flint.ctx.prec

    def __enter__(self) -> Limits:
        """Start to watch."""
        began, before = time.monotonic(), resident()
        self._precision = mpmath.mp.prec, flint.ctx.prec
        if self.megabytes is not None and before is None:
            raise LimitError(
                "megabytes: this system does not tell how much memory a process has. "
                "Give seconds alone"
            )
        self._entry = entry = _Entry()
        given = (threading.get_ident(), entry, began, before or 0)
        watch = threading.Thread(target=self._watch, args=given, daemon=True)
        try:
            watch.start()
        except RuntimeError as error:
            raise LimitError(
                "limits of time and memory need a thread that watches, and this system starts "
                "none. Work without gt.limits here"
            ) from error
        # Nothing is sent before: what arrived in here, nobody would catch.
        entry.inside = True
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End watching; say which quantity met which limit."""
        try:
            self._end()
        # Met in the last moment, when the work was done; or this is that of a block around.
        except _Met as met:
            self._end()
            if not isinstance(met, self._kind):
                raise
        if kind is not None and issubclass(kind, self._kind):
            quantity, place = _where(trace)
            # Who sets a precision may have been stopped from setting it back, or would do so late,
            # when what it was entering is collected.
            clear_frames(trace)
            mpmath.mp.prec, flint.ctx.prec = self._precision
            at = f"; it was at {place}" if place else ""
            raise AllowanceError(
                f"{quantity} takes more than {self._entry.what}{at}. What was finished is kept: "
                "ask again with larger limits, for less, or for numbers with .at(point)",
                quantity,
            ) from None

    def _end(self) -> None:
        entry = self._entry
        with entry.lock:
            entry.over = True
            if entry.running.locked():
                entry.running.release()
            # What was sent and has not arrived is called back.
            _send(threading.get_ident(), None)

    def _watch(self, thread: int, entry: _Entry, began: float, before: int) -> None:
        """Send the error to the thread that works when a limit is met."""
        end = float("inf") if self.seconds is None else began + self.seconds
        # Memory is looked at twenty times a second.
        while not entry.running.acquire(timeout=max(0.0, min(0.05, end - time.monotonic()))):
            if time.monotonic() >= end:
                entry.what = f"{self.seconds:g} s"
            elif self.megabytes is not None:
                taken = (resident() or 0) - before
                if taken > self.megabytes * 10**6:
                    entry.what = f"{self.megabytes:g} MB"
            if entry.what and entry.inside:
                with entry.lock:
                    # At its very first step the end of a block cannot catch it yet.
                    ends = _works_at(thread) is Limits.__exit__.__code__
                    if not (ends or entry.over):
                        _send(thread, self._kind)
                # Once more where it was swallowed.
                if entry.running.acquire(timeout=0.05 if ends else 1.0):
                    return


def limits(*, seconds: float | None = None, megabytes: float | None = None) -> Limits:
    """A block in which work ends with an error when it has taken so much time or memory.

    For geometry, printing, actions, reading: all exact work of the thread that enters the block.
    A limit raises or does nothing; answers never depend on it. What was finished is kept, so that
    the same call with larger limits goes on from there.

    Parameters
    ----------
    seconds
        Of a clock on the wall, from entering the block.
    megabytes
        Millions of bytes on top of what the process has on entering the block.

    Raises
    ------
    AllowanceError
        On leaving the block, if a limit was met; it names the quantity that was worked out.
    ArgumentError
        Neither is given, or one is no positive number.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> r, phi = sp.symbols("r phi", positive=True)
    >>> with limits(seconds=60, megabytes=1000):
    ...     Frame([r, phi], [[1, 0], [0, r]]).metric.to_sympy()
    [[1, 0], [0, r**2]]
    """
    if seconds is None and megabytes is None:
        raise ArgumentError(
            "limits: seconds, megabytes or both were needed, but none came. Write "
            "limits(seconds=10)."
        )
    return Limits(
        None if seconds is None else checks.positive(seconds, "seconds", ArgumentError),
        None if megabytes is None else checks.positive(megabytes, "megabytes", ArgumentError),
    )


def _send(thread: int, kind: type[BaseException] | None) -> None:
    """Have a thread raise an error at its next step of Python; None calls it back."""
    target = None if kind is None else ctypes.py_object(kind)
    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), target)


def _works_at(thread: int) -> CodeType | None:
    """What a thread is executing, which is where it meets what is sent; None if it is gone."""
    frame = sys._current_frames().get(thread)
    return None if frame is None else frame.f_code


def resident() -> int | None:
    """Bytes of memory that this process and those that work for it have now, if that is known."""
    try:
        page = os.sysconf("SC_PAGE_SIZE")
        listed = Path("/proc/self/task").glob("*/children")
        numbers = ["self", *(number for file in listed for number in file.read_text().split())]
        return sum(page * _pages(number) for number in numbers)
    # Not on Linux.
    except (OSError, AttributeError, ValueError, IndexError):
        pass
    try:
        import resource  # not on Windows
    except ImportError:
        return None
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return most if sys.platform == "darwin" else 1024 * most


def _pages(number: str) -> int:
    """Pages of memory of a process; none if it is gone."""
    try:
        return int(Path(f"/proc/{number}/statm").read_text().split()[1])
    except (OSError, IndexError):
        if number == "self":
            raise
        return 0


def _where(trace: TracebackType | None) -> tuple[str, str]:
    """(what was asked for, which part of it was being worked out) from the calls that ended."""
    asked, tensors, index = "the work", [], None
    for frame, _ in walk_tb(trace):
        module = frame.f_globals.get("__name__", "")
        if not module.startswith("geomtorsion.") or module.startswith("geomtorsion.cli."):
            continue
        names = frame.f_locals
        label = getattr(names.get("self"), "label", None)
        if isinstance(label, str):
            tensors.append(f"{getattr(names['self'], 'name', '')} {label}".strip())
        elif asked == "the work":
            called = frame.f_code.co_qualname.removesuffix(".__init__")
            # What has a name of its own that users know.
            if not any(part.startswith(("_", "<")) for part in called.split(".")):
                asked = called
        place = names.get("representative", names.get("index"))
        if isinstance(place, tuple) and place and all(isinstance(k, int) for k in place):
            index = place
    return (tensors[0] if tensors else asked), (f"component {list(index)}" if index else "")
