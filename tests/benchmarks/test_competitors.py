"""Competitors: all installed packages on the same cases, each in a process with a time limit.

No time is asserted; a package that gives an answer has to give the right one.
`python -m tests.benchmarks.compare` prints the table of ratios.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.benchmarks.cases import NAMES
from tests.benchmarks.compare import cell, is_wanted
from tests.benchmarks.contestants import ALL, Contestant
from tests.benchmarks.race import race


@pytest.mark.parametrize("case", NAMES)
@pytest.mark.parametrize("contestant", ALL, ids=lambda contestant: contestant.name)
def test_race(
    contestant: Contestant,
    case: str,
    request: pytest.FixtureRequest,
    record_property: Callable[[str, object], None],
) -> None:
    """A contestant that ends within the limit has the right scalar; others report progress."""
    if not contestant.is_installed:
        # importorskip would import the package here, and some packages print or warn on import.
        pytest.skip(f"{contestant.title} is not installed")
    if not is_wanted(contestant, case):
        pytest.skip(f"{contestant.title} takes metrics only: the same race as another case")
    limit = float(request.config.getoption("--limit") or 60.0)
    result = race(contestant.name, case, limit=limit)
    record_property("best", result.best)
    record_property("reached", result.reached)
    if result.best is None and contestant.name != "geomtorsion":
        pytest.skip(f"{contestant.title}: {result.failure or cell(result)}")
    assert result.best is not None, result.failure
    assert result.agrees is not False
