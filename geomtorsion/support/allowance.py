"""Allowance: time and memory that exact work may take, looked at in its loops.

A limit either raises or does nothing: no result depends on it. Frames, tensors and fields keep
their finished quantities, and the next call continues from there.
"""

from __future__ import annotations

import sys
import time
from traceback import clear_frames, walk_tb
from typing import TYPE_CHECKING

from geomtorsion.errors import AllowanceError, ArgumentError, LimitError
from geomtorsion.support import checks
from geomtorsion.support.exclusive import BLOCKS
from geomtorsion.support.workers import resident

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType


class _Met(BaseException):
    """A limit was met; no BaseException of this kind leaves the block that set the limit.

    Code that catches errors of this package to try another method does not catch it.
    """

    def __init__(self, block: Limits, what: str) -> None:
        super().__init__(what)
        self.block, self.what = block, what


def check_limits() -> None:
    """Raise if a limit of a block around this call is met: for the loops of exact work."""
    blocks = BLOCKS.get()
    if blocks:
        for block in blocks:
            block.check()


class Limits:
    """Result of `limits`: a block of `with` in which time and memory are bounded.

    clock: in seconds; None for wall time.
    """

    def __init__(
        self,
        seconds: float | None,
        megabytes: float | None,
        clock: Callable[[], float] | None = None,
    ) -> None:
        self.seconds = seconds
        self.megabytes = megabytes
        self.clock = clock or time.monotonic
        self._end = self._next = float("inf")
        self._before = 0

    def __repr__(self) -> str:
        return f"Limits(seconds={self.seconds}, megabytes={self.megabytes})"

    def __enter__(self) -> Limits:
        """Start to count."""
        now, before = self.clock(), resident()
        if self.megabytes is not None and before is None:
            raise LimitError(
                "megabytes: this system does not report the memory of a process. Give only seconds"
            )
        self._before = before or 0
        self._end = float("inf") if self.seconds is None else now + self.seconds
        self._next = float("inf") if self.megabytes is None else now
        BLOCKS.set((*BLOCKS.get(), self))
        return self

    def check(self) -> None:
        """Raise if a limit is met."""
        now = self.clock()
        if now >= self._end:
            raise _Met(self, f"{self.seconds:g} s")
        if self.megabytes is not None and now >= self._next:
            taken = (resident() or 0) - self._before
            # Looks at the memory take a hundredth of the time.
            self._next = now + 100 * (self.clock() - now)
            if taken > self.megabytes * 10**6:
                raise _Met(self, f"{self.megabytes:g} MB")

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Stop counting; name the quantity that exceeded a limit."""
        BLOCKS.set(BLOCKS.get()[:-1])
        if isinstance(error, _Met) and error.block is self:
            quantity, place = interrupted_work(trace)
            # Generators that were not finished end now, and set precisions back.
            clear_frames(trace)
            raise AllowanceError(
                f"{quantity} takes more than {error.what}{place}. Finished quantities are kept: "
                "repeat with larger limits, request less, or numbers with .at(point)",
                quantity,
            ) from None


def limits(*, seconds: float | None = None, megabytes: float | None = None) -> Limits:
    """Context manager: work that exceeds a limit of time or memory raises an error.

    For geometry, printing, actions, reading and proofs: all exact work of the thread that enters
    the block. A limit raises or does nothing; answers never depend on it. Finished quantities
    are kept, so that the same call with larger limits continues from there.

    The limits are checked between exact operations. A single call of python-flint or sympy is not
    interrupted: the size of products is bounded beforehand (`geomtorsion.exact.limits`), and long
    factorings run in a process of their own, which is ended in time. Work outside this package is
    not limited. The options --seconds and --megabytes of a command bound all of its work, because
    they end its process.

    Parameters
    ----------
    seconds
        Wall-clock time from entering the block.
    megabytes
        Millions of bytes beyond the memory of the process on entering the block.

    Raises
    ------
    AllowanceError
        On leaving the block, if a limit was met; it names the quantity that was being computed.
    ArgumentError
        Neither is given, or one is not a positive number.

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
            "limits: expected seconds, megabytes or both, got none. Write limits(seconds=10)."
        )
    return Limits(
        None if seconds is None else checks.positive(seconds, "seconds", ArgumentError),
        None if megabytes is None else checks.positive(megabytes, "megabytes", ArgumentError),
    )


def interrupted_work(trace: TracebackType | None, *, functions: bool = True) -> tuple[str, str]:
    """(requested quantity, "; it was at ..." or nothing), from the calls that ended.

    functions: whether exported functions have their names; who types a command knows none.
    """
    asked, tensors, index = "the work", [], None
    for frame, _ in walk_tb(trace):
        module = frame.f_globals.get("__name__", "")
        if not module.startswith("geomtorsion.") or module.startswith("geomtorsion.cli."):
            continue
        names = frame.f_locals
        label = getattr(names.get("self"), "label", None)
        if isinstance(label, str):
            tensors.append(f"{getattr(names['self'], 'name', '')} {label}".strip())
        elif functions and asked == "the work":
            called = frame.f_code.co_qualname.removesuffix(".__init__")
            first, *rest = called.split(".")
            package = sys.modules[".".join(module.split(".")[:2])]
            # Only exported names, which users know.
            if first in getattr(package, "__all__", ()) and not any(x[0] in "_<" for x in rest):
                asked = called
        place = names.get("representative", names.get("index"))
        if isinstance(place, tuple) and place and all(isinstance(k, int) for k in place):
            index = place
    return (tensors[0] if tensors else asked), (
        f"; it was at component {list(index)}" if index else ""
    )
