"""Processes: one pool for all examiners of a file, because each would start its own."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from geomtorsion.teaching.exercises import examiner
from geomtorsion.teaching.exercises.worker_pool import Json, WorkerPool


class Lent:
    """A pool that its users may close; it stays open for the next user."""

    def __init__(self, function: str) -> None:
        self.pool = WorkerPool(function)

    def ask(self, request: Json, seconds: float) -> Json:
        """The reply of the pool."""
        return self.pool.ask(request, seconds)

    def close(self) -> None:
        """Do nothing: the fixture closes the pool at the end of the file."""


@pytest.fixture(scope="module")
def one_pool() -> Iterator[None]:
    """All examiners of this file share their processes, which start once for each function."""
    lent: dict[str, Lent] = {}

    def lend(function: str) -> Lent:
        if function not in lent:
            lent[function] = Lent(function)
        return lent[function]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(examiner, "WorkerPool", lend)
        yield
    for one in lent.values():
        one.pool.close()
