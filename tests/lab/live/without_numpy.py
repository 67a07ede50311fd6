"""Tests in a Python without numpy, threads and processes: which need them is told from failures."""

from __future__ import annotations

import sys
from collections.abc import Iterator

import pytest

from geomtorsion.lab.live import absent

# What is said where one of these was needed.
NEEDED = (
    "which has no build for browsers", "<absent numpy", "can't start new thread",
    "does not support processes",
)  # fmt: skip
# Of Hypothesis, about generators of its own, in a Python whose thread-locals cannot be looked into.
NOT_OURS = "ignore:It looks like `register_random` was passed"


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Iterator[None]:
    """Count a test that needs what is not there as skipped."""
    report = yield
    if report.failed and any(words in report.longreprtext for words in NEEDED):
        report.outcome, report.longrepr = "skipped", (str(item.path), 0, "needs what is not there")
    return report


def run(files: list[str]) -> int:
    """Run files of tests, slow ones, too; how pytest ended."""
    # The settings that every test leaves as they were; of what is absent there are none.
    for name in ("geterr", "get_printoptions"):
        absent.KNOWN["numpy", name] = dict
    absent.stand_in(("numpy", "scipy", "playwright"))
    plugin = sys.modules[__name__]
    return int(
        pytest.main(["-q", "-m", "", "-p", "no:cacheprovider", "-W", NOT_OURS, *files], [plugin])
    )
