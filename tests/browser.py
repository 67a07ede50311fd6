"""A browser and a served page, started once and shared by the tests that need them."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, NoReturn
from urllib.parse import parse_qs, urlsplit

import pytest

from tests.teaching.lab.serving import served

# Where a browser may be named, and whether its absence is a failure.
NAMED, NEEDED = "GEOMTORSION_BROWSER", ("CI", "GEOMTORSION_NEED_BROWSER")
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
# One process draws all pages, which show the same: each of several would read the scripts again.
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--renderer-process-limit=1",
    "--disable-site-isolation-trials",
)  # fmt: skip
WINDOW = {"width": 1200, "height": 900}
# Milliseconds that a page may take to show what is waited for, on a loaded machine.
PATIENCE = 30_000
FIRST_TAB = "The compass"
MISSING = (
    "no browser was found. Install one (`apt-get install chromium` or `playwright install "
    f"chromium`), or name one in {NAMED}."
)


def _absent(reason: str) -> NoReturn:
    """Fail where a browser is needed, skip elsewhere."""
    if any(os.environ.get(name) for name in NEEDED):
        pytest.fail(reason)
    pytest.skip(reason)


@pytest.fixture(scope="session")
def playwright() -> Iterator[Any]:
    """What drives all browsers of a process, of which Playwright allows one."""
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        _absent("playwright is not installed: `pip install 'geomtorsion[test]'`")
    with sync_playwright() as driver:
        yield driver


@contextmanager
def _chromium(launch: Callable[..., Any], *where: str, **options: Any) -> Iterator[Any]:
    """Chromium: what a way to launch it gives, closed at the end."""
    from playwright.sync_api import Error

    named = os.environ.get(NAMED, "")
    found = named or next((path for name in BROWSERS if (path := shutil.which(name))), None)
    try:
        launched = launch(*where, executable_path=found, args=list(FLAGS), **options)
    except Error as error:
        _absent(f"{MISSING} ({str(error).splitlines()[0]})")
    yield launched
    launched.close()


@pytest.fixture(scope="session")
def browser(playwright: Any) -> Iterator[Any]:
    """A browser without any window."""
    with _chromium(playwright.chromium.launch) as launched:
        yield launched


@pytest.fixture(scope="session")
def address() -> Iterator[str]:
    """Where the page is served."""
    with served() as url:
        yield url


@dataclass
class Watched:
    """A page with everything that went wrong on it, and everything it asked for."""

    page: Any
    errors: list[str] = field(default_factory=list)
    asked: list[str] = field(default_factory=list)

    def tab(self, name: str) -> Any:
        """Open a tab."""
        self.page.get_by_role("tab", name=name, exact=True).click()
        return self.page

    def says(self, selector: str, text: str | re.Pattern[str]) -> str:
        """Wait until a part of the page says this; the whole of what it says then.

        Parts are drawn anew when something changes: for a moment they are not there at all.
        """
        from playwright.sync_api import expect

        part = self.page.locator(selector)
        expect(part).to_contain_text(text, use_inner_text=True, timeout=PATIENCE)
        return part.inner_text()

    def typed(self, texts: dict[str, str], shown: Any) -> None:
        """Type into fields, by their labels, until what follows from it is shown.

        A field that has just been drawn shows what is typed and forgets to tell of it, for some
        tenths of a second, and nobody can see when that ends. What is typed again has to differ:
        spaces mean nothing here.
        """
        from playwright.sync_api import expect

        for again, patience in enumerate((PATIENCE // 20, PATIENCE // 6, PATIENCE)):
            for label, text in texts.items():
                self.page.get_by_label(label, exact=True).fill(text + " " * again)
            try:
                return expect(shown).to_be_visible(timeout=patience)
            except AssertionError:
                if patience == PATIENCE:
                    raise


@pytest.fixture(scope="session")
def context(playwright: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """Windows of one browser, which loads what the page is made of once.

    With a folder of its own it keeps scripts compiled, too: a third of what a load takes.
    """
    folder = str(tmp_path_factory.mktemp("browser"))
    launch = playwright.chromium.launch_persistent_context
    with _chromium(launch, folder, viewport=WINDOW) as made:
        yield made


def opened(context: Any) -> Watched:
    """An empty page that is watched."""
    page = context.new_page()
    page.set_default_timeout(PATIENCE)
    seen = Watched(page)
    page.on("console", lambda m: seen.errors.append(m.text) if m.type == "error" else None)
    page.on("pageerror", lambda error: seen.errors.append(str(error)))
    page.on("request", lambda request: seen.asked.append(request.url))
    return seen


def loaded(seen: Watched, address: str) -> Watched:
    """The page, with its first tab ready."""
    seen.page.goto(address)
    seen.page.wait_for_selector("#compass iframe")
    return seen


@pytest.fixture
def watched(context: Any) -> Iterator[Watched]:
    """An empty page; what it logs as an error fails the test."""
    seen = opened(context)
    yield seen
    seen.page.close()
    assert seen.errors == []


@pytest.fixture
def lab(watched: Watched, address: str) -> Watched:
    """The page, loaded."""
    return loaded(watched, address)


@pytest.fixture(scope="session")
def standing_pages() -> list[Watched]:
    """The page that stands open between the tests that leave it as they found it."""
    return []


@pytest.fixture
def standing(context: Any, address: str, standing_pages: list[Watched]) -> Iterator[Watched]:
    """The page as it was when it was loaded, for a test that leaves it so: a load takes seconds.

    The address tells what was changed. Where that is anything but the tab, another is loaded.
    """
    if not (standing_pages and _is_untouched(standing_pages[0])):
        for seen in standing_pages:
            seen.page.close()
        standing_pages[:] = [loaded(opened(context), address)]
    [seen] = standing_pages
    seen.page.set_viewport_size(WINDOW)
    seen.tab(FIRST_TAB).wait_for_selector("#compass iframe")
    yield seen
    assert seen.errors == []


def _is_untouched(seen: Watched) -> bool:
    """Whether all input of a page is what it was at first, and nothing has gone wrong on it."""
    return not seen.errors and parse_qs(urlsplit(seen.page.url).query).keys() <= {"tab"}
