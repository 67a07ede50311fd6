"""Pages without a server: complete, without requests, and narrow enough for a phone."""

from __future__ import annotations

import re
from html import unescape
from pathlib import Path
from typing import Any

import pytest

from geomtorsion import exercises
from geomtorsion.teaching.lab.export import RADII, write_pages
from tests.browser import Watched, hosted


@pytest.fixture(scope="module")
def pages(tmp_path_factory: Any) -> tuple[Path, ...]:
    """All pages, written once."""
    return write_pages(tmp_path_factory.mktemp("course") / "torsion")


def test_a_page_for_each_tab(pages: tuple[Path, ...]):
    """An index links to each of the other pages."""
    assert len(pages) == 8
    index = pages[0].read_text("utf-8")
    assert all(f'href="{page.name}"' in index for page in pages)


def test_the_pages_need_nothing(pages: tuple[Path, ...]):
    """A page refers only to the pages beside it."""
    names = {page.name for page in pages}
    for page in pages:
        text = page.read_text("utf-8")
        assert set(re.findall(r'href="([^"#]+)"', text)) <= names
        assert not re.findall(r'src="[^"]*"|@import|url\((?!"data:font/|#)', text)
        links = [found for found in re.findall(r"https?://[\w.]+", text) if "w3.org" not in found]
        assert links == []
        assert "default-src 'none'" in text


def test_every_exercise_is_there(pages: tuple[Path, ...]):
    """Statements, prompts and hints of all exercises are in the page, but no solution."""
    [page] = [page for page in pages if page.name == "exercises.html"]
    text = page.read_text("utf-8")
    for number in exercises.names():
        assert f'id="e{number}"' in text
    assert "Solution" not in text


# Page -> a text about a page without a server. Texts that are true only of the served page are on
# no page.
SAYS = {
    "index": "Nothing is computed here.",
    "loops": "Make the radius smaller",
    "five-tetrads": "Each tetrad is a list of one-forms, one in each row",
    "exercises": "this page has no fields for answers",
    "what-accuracy-costs": "measured on the computer that made this page",
}
SERVED_ONLY = (
    "checks your answer", "Type ", "type cos", "press Check", "Each row of fields", "slider",
    "measured now", "choose the space", "screw_dislocation and move", "serves this page.",
    "moments to 2", "on its own tab", "Any tetrad",
)  # fmt: skip


def visible_text(page: Path) -> str:
    """The text of a page that a reader sees, without scripts, styles and figures."""
    text = page.read_text("utf-8").partition("<body>")[2]
    text = re.sub(r"<(script|svg)\b.*?</\1>|<iframe[^>]*>", "", text, flags=re.DOTALL)
    return " ".join(unescape(re.sub(r"<[^>]+>", " ", text)).split())


def test_the_pages_describe_their_cases(pages: tuple[Path, ...]):
    """Each page describes its own cases, and offers nothing that only the served page has."""
    texts = {page.stem: visible_text(page) for page in pages}
    for name, says in SAYS.items():
        assert says in texts[name]
    for name, text in texts.items():
        for word in SERVED_ONLY:
            assert word not in text, (name, word)


def test_a_term_is_explained_once_on_a_page(pages: tuple[Path, ...]):
    """A page with several views of one kind has their terms once, at its end."""
    for page in pages[1:]:
        terms = re.findall(r"<dt>(.*?)</dt>", page.read_text("utf-8"))
        assert len(terms) == len(set(terms)), page.name


def test_an_exercise_names_the_command_that_checks_it(pages: tuple[Path, ...]):
    """The command below a task names its questions, and below the prompts is how to answer."""
    [page] = [page for page in pages if page.name == "exercises.html"]
    text = visible_text(page)
    assert 'geomtorsion exercises check 1.2 "metric=..." "volume=..."' in text
    assert 'geomtorsion exercises check 3.2 "..."' in text
    assert "Available names: phi1, phi2" in text


@pytest.mark.parametrize("place", range(7))
def test_a_page_in_the_browser(watched: Watched, pages: tuple[Path, ...], place: int):
    """Without a server a page loads only its file, and it fits a window of 400 pixels."""
    page = watched.page
    with hosted(pages[place]) as address:
        page.goto(address)
        page.wait_for_load_state()
        assert {url for url in watched.asked if not url.startswith("about:")} == {address}
        page.set_viewport_size({"width": 400, "height": 800})
        assert page.evaluate("document.documentElement.scrollWidth") <= 400


def test_the_slider_of_a_page_works(watched: Watched, pages: tuple[Path, ...]):
    """The slider changes the radius without a server."""
    page = watched.page
    [loops] = [page for page in pages if page.name == "loops.html"]
    with hosted(loops) as address:
        page.goto(address)
        slider = page.locator('input[data-slides="loops-so3"]')
        slider.fill("2")
        shown = page.locator("#loops-so3 > section:visible")
        assert shown.count() == 1
        assert f"radius {RADII[2]:g}" in shown.inner_text()
