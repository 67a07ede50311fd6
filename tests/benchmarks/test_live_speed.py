"""How long the page without a server takes to start and to answer, in a real browser.

Run with `python -m pytest tests/benchmarks/test_live_speed.py -s`. What is asserted is that every
request is answered, not how soon. What it downloads is kept where `geomtorsion lab` keeps it.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.browser import browser  # noqa: F401 (a fixture)
from tests.lab.live.test_folder import START, served_folder, site  # noqa: F401 (a fixture)


def processor_seconds() -> float:
    """Processor time of the browser, which runs in processes below this one."""
    psutil = pytest.importorskip("psutil")
    times = [one.cpu_times() for one in psutil.Process().children(recursive=True)]
    return sum(one.user + one.system for one in times)


def took(page: Any, tab: str, act: Callable[[], object]) -> float:
    """Milliseconds from the request of an action to the worker until its answer is shown."""
    panel = page.locator(f'[data-tab="{tab}"]')
    panel.evaluate("e => e.removeAttribute('data-milliseconds')")
    act()
    page.wait_for_selector(f'[data-tab="{tab}"][data-milliseconds]')
    return float(panel.get_attribute("data-milliseconds"))


def test_start_and_answers(
    site: Path,  # noqa: F811 (the fixture)
    browser: Any,  # noqa: F811 (the fixture)
    capsys: pytest.CaptureFixture[str],
):
    """The start, ten tetrads in polar coordinates, ten wrong answers."""
    with served_folder(site) as address:
        page = browser.new_context().new_page()
        page.set_default_timeout(START)
        begun, used = time.perf_counter(), processor_seconds()
        page.goto(f"{address}?start=flat_polar&exercise=2.1")
        page.wait_for_selector("body[data-state=ready] #torsion math")
        start, used = time.perf_counter() - begun, processor_seconds() - used
        entry = page.locator('[data-name="1,1"]')
        tetrads = [
            took(page, "Any tetrad", lambda text=f"r^{k}": entry.fill(text)) for k in range(2, 12)
        ]
        page.get_by_role("tab", name="Exercises").click()
        answer = page.locator('[data-tab="Exercises"] textarea')
        check = page.get_by_role("button", name="Check")
        answers = []
        for k in range(2, 12):
            # What is typed is kept in the address, which is a request of its own.
            took(page, "Exercises", lambda text=f"1,2,2 = {k}/r": answer.fill(text))
            answers.append(took(page, "Exercises", check.click))
        page.wait_for_selector("#verdict .wrong")
    assert min(tetrads + answers) >= 0
    with capsys.disabled():
        print(f"\nstart: {start:.1f} s, with {used:.1f} s of processor time")
        for what, each in (("a tetrad", tetrads), ("an answer", answers)):
            print(f"{what}: {statistics.median(each):.0f} ms, at most {max(each):.0f}")
