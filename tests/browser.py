"""Browser and served page, started once and shared by the tests that need them."""

from __future__ import annotations

import os
import re
import shutil
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any, NoReturn
from urllib.parse import parse_qs, urlsplit

import pytest

from tests.teaching.lab.serving import served

# The variable that names a browser, and those that turn a missing browser into a failure.
NAMED, NEEDED = "GEOMTORSION_BROWSER", ("CI", "GEOMTORSION_NEED_BROWSER")
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
# One process renders all pages, which are the same page: several would each load the scripts again.
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--renderer-process-limit=1",
    "--disable-site-isolation-trials",
)  # fmt: skip
WINDOW = {"width": 1200, "height": 900}
# Longest time in milliseconds to wait for a change of the page, on a loaded machine.
PATIENCE = 30_000
FIRST_TAB = "The compass"
MISSING = (
    "no browser was found. Install one (`apt-get install chromium` or `playwright install "
    f"chromium`), or name one in {NAMED}."
)


def _absent(reason: str) -> NoReturn:
    """Fail where a browser is required, skip elsewhere."""
    if any(os.environ.get(name) for name in NEEDED):
        pytest.fail(reason)
    pytest.skip(reason)


@pytest.fixture(scope="session")
def playwright() -> Iterator[Any]:
    """The Playwright driver of all browsers; a process may have only one."""
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        _absent("playwright is not installed: `pip install 'geomtorsion[test]'`")
    with sync_playwright() as driver:
        yield driver


@contextmanager
def _chromium(launch: Callable[..., Any], *where: str, **options: Any) -> Iterator[Any]:
    """Chromium, started by the given method of launching and closed at the end."""
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
    """Browser without an open window."""
    with _chromium(playwright.chromium.launch) as launched:
        yield launched


class _Quiet(SimpleHTTPRequestHandler):
    """A server of files that writes no log and has an empty icon."""

    def do_GET(self) -> None:
        if self.path == "/favicon.ico":
            self.send_response(204)
            self.end_headers()
        else:
            super().do_GET()

    def log_message(self, format: str, *args: object) -> None:
        pass


@contextmanager
def hosted(file: Path) -> Iterator[str]:
    """Address at which a file and its folder are served; a `file:` page has no origin."""
    handler = partial(_Quiet, directory=str(file.parent))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        try:
            yield f"http://127.0.0.1:{server.server_port}/{file.name}"
        finally:
            server.shutdown()


@pytest.fixture(scope="session")
def address() -> Iterator[str]:
    """Address at which the page is served."""
    with served() as url:
        yield url


@dataclass
class Watched:
    """A page, the errors on it and the addresses that it requested."""

    page: Any
    errors: list[str] = field(default_factory=list)
    asked: list[str] = field(default_factory=list)

    def tab(self, name: str) -> Any:
        """Open a tab."""
        self.page.get_by_role("tab", name=name, exact=True).click()
        return self.page

    def shows(self, selector: str, text: str | re.Pattern[str]) -> str:
        """Wait until a part of the page contains a text; return the full text of that part.

        A part is drawn again after a change, and for a moment it does not exist.
        """
        from playwright.sync_api import expect

        part = self.page.locator(selector)
        expect(part).to_contain_text(text, use_inner_text=True, timeout=PATIENCE)
        return part.inner_text()

    def typed(self, texts: dict[str, str], shown: Any, filler: str = " ", key: str = "") -> None:
        """Type into fields, found by their labels, until the expected result is shown.

        A field that was just drawn shows typed text but does not report it for some tenths of a
        second, and the end of this time is not visible. Text that is typed again has to differ, so
        each attempt appends a filler, which has no meaning in this field. key: sends the text.
        """
        from playwright.sync_api import expect

        for again, patience in enumerate((PATIENCE // 20, PATIENCE // 6, PATIENCE)):
            for label, text in texts.items():
                field = self.page.get_by_label(label, exact=True)
                field.fill(text + filler * again)
                if key:
                    field.press(key)
            try:
                return expect(shown).to_be_visible(timeout=patience)
            except AssertionError:
                if patience == PATIENCE:
                    raise


@pytest.fixture(scope="session")
def context(playwright: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """Windows of one browser, which loads the parts of the page only once.

    A folder of its own also lets the browser keep compiled scripts, a third of the loading time.
    """
    folder = str(tmp_path_factory.mktemp("browser"))
    launch = playwright.chromium.launch_persistent_context
    with _chromium(launch, folder, viewport=WINDOW) as made:
        yield made


def opened(context: Any) -> Watched:
    """Open an empty page and record its errors and requests."""
    page = context.new_page()
    page.set_default_timeout(PATIENCE)
    seen = Watched(page)
    page.on("console", lambda m: seen.errors.append(m.text) if m.type == "error" else None)
    page.on("pageerror", lambda error: seen.errors.append(str(error)))
    page.on("request", lambda request: seen.asked.append(request.url))
    return seen


def loaded(seen: Watched, address: str) -> Watched:
    """Open the page and wait for its first tab."""
    seen.page.goto(address)
    seen.page.wait_for_selector("#compass iframe")
    return seen


@pytest.fixture
def watched(context: Any) -> Iterator[Watched]:
    """An empty page; any error that it logs fails the test."""
    seen = opened(context)
    yield seen
    seen.page.close()
    assert seen.errors == [], seen.errors


@pytest.fixture
def lab(watched: Watched, address: str) -> Watched:
    """The page, loaded."""
    return loaded(watched, address)


@pytest.fixture(scope="session")
def shared_pages() -> list[Watched]:
    """The page that stays open between the tests that leave it unchanged."""
    return []


@pytest.fixture
def shared_lab(context: Any, address: str, shared_pages: list[Watched]) -> Iterator[Watched]:
    """The page as first loaded, for a test that leaves it unchanged; loading it takes seconds.

    The address shows the changes. After a change of anything but the tab, the page is loaded again.
    """
    if not (shared_pages and _is_untouched(shared_pages[0])):
        for seen in shared_pages:
            seen.page.close()
        shared_pages[:] = [loaded(opened(context), address)]
    [seen] = shared_pages
    seen.page.set_viewport_size(WINDOW)
    seen.tab(FIRST_TAB).wait_for_selector("#compass iframe")
    yield seen
    assert seen.errors == [], seen.errors


def _is_untouched(seen: Watched) -> bool:
    """Whether all input of a page has its first value and the page has logged no error."""
    return not seen.errors and parse_qs(urlsplit(seen.page.url).query).keys() <= {"tab"}
