"""executors: parts of a job that run in this process, in other ones, or on other machines."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, as_completed
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar

from geomtorsion.errors import ArgumentError, GeomtorsionError, WorkerError
from geomtorsion.support.checks import shown

T = TypeVar("T")


class Executor(Protocol):
    """A pool of processes or threads with the interface of `concurrent.futures.Executor`.

    mpi4py.futures has one, and a `dask.distributed.Client` gives one.
    """

    def submit(self, fn: Callable[..., Any], /, *args: Any) -> Future[Any]:
        """Have a function called somewhere, and return its future result."""
        ...


def checked_executor(executor: object) -> Executor | None:
    """The executor, or the executor of a dask client; None stays None.

    Raises
    ------
    ArgumentError
        It takes no work.

    Examples
    --------
    >>> checked_executor(None) is None
    True
    """
    if executor is None:
        return None
    # A dask client has its own futures; its executor gives futures of concurrent.futures.
    own = getattr(executor, "get_executor", None)
    pool: Any = own() if callable(own) else executor
    if isinstance(pool, type) or not callable(getattr(pool, "submit", None)):
        raise ArgumentError(
            "executor: expected an object with submit (a pool of concurrent.futures, a "
            f"dask.distributed.Client), got {shown(executor)}."
        )
    return pool


def each_done(
    executor: Executor | None, function: Callable[..., T], parts: Iterable[tuple[Any, ...]]
) -> Iterator[tuple[int, T]]:
    """Number and result of each part as it is done; without an executor one by one, in order.

    On an error, on Ctrl-C and when the caller stops, parts that have not begun are cancelled.

    Raises
    ------
    WorkerError
        A worker ended, raised an error that is not ours, or returned something else than its
        result; `part` is the number of its part.

    Examples
    --------
    >>> list(each_done(None, divmod, [(7, 2), (9, 4)]))
    [(0, (3, 1)), (1, (2, 1))]
    """
    if executor is None:
        yield from ((k, function(*part)) for k, part in enumerate(parts))
        return
    futures: dict[Future[Returned[T]], int] = {}
    try:
        for k, part in enumerate(parts):
            futures[_submitted(executor, function, part, k)] = k
        for future in as_completed(futures):
            yield futures[future], _result(future, futures[future])
    finally:
        for future in futures:
            future.cancel()


@dataclass(frozen=True)
class Returned(Generic[T]):
    """The result of one part, distinct from whatever else a future may hold.

    part: its number.
    """

    part: int
    value: T


def _called(function: Callable[..., T], part: tuple[Any, ...], k: int) -> Returned[T]:
    """The result of one part, in the process of a worker."""
    return Returned(k, function(*part))


def _submitted(
    executor: Executor, function: Callable[..., T], part: tuple[Any, ...], k: int
) -> Future[Returned[T]]:
    """The future result of one part."""
    try:
        future = executor.submit(_called, function, part, k)
    except Exception as error:  # pools of any library, each with its own errors
        raise WorkerError.of(error, k) from error
    if not isinstance(future, Future):
        raise WorkerError(
            "executor: expected submit to return a future of concurrent.futures, got "
            f"{shown(future)}.",
            k,
        )
    return future


def _result(future: Future[Returned[T]], k: int) -> T:
    """The result of one part."""
    try:
        result = future.result()
    except GeomtorsionError:
        raise
    except Exception as error:  # whatever a worker or its library raises
        raise WorkerError.of(error, k) from error
    if not (isinstance(result, Returned) and result.part == k):
        raise WorkerError(
            "executor: expected a future with the result of the submitted call, got one with "
            f"{shown(result)}.",
            k,
        )
    return result.value
