"""The page in German: its words, the note where it has none, and its address."""

from __future__ import annotations

import asyncio
import urllib.request
from html import escape
from typing import Any

import pytest

from geomtorsion.teaching.lab import guides, problems, views
from geomtorsion.teaching.lab.localized import localized
from tests.browser import Watched, loaded
from tests.teaching.lab.serving import served
from tests.teaching.lab.session import PATIENCE, Session, run


def test_tabs_have_their_english_names():
    """A tab has its English name in addresses, whatever its label."""
    for name in guides.TABS:
        assert guides.tab(name).name == name
        label = guides.tab(name, "de").name
        assert guides.named(label, "de") == name
    assert guides.tab(guides.COMPASS, "de").name == "Der Kompass"


def test_a_tab_without_translation_is_english_with_a_note():
    """In French the compass is French; the tab for loops is English, with a note in French."""
    compass, loops = (
        views.intro(guides.tab(name, "fr").guide, "fr") for name in (guides.COMPASS, guides.LOOPS)
    )
    note = escape("Cette partie de la page n'est pas encore traduite. Son texte est en anglais.")
    assert "Le navire bleu" in compass
    assert "Prédisez" in compass
    assert note not in compass
    assert note in loops
    assert note not in views.intro(guides.tab(guides.LOOPS).guide)
    assert "In Worten" in views.words(guides.COMPASS, "de")


def test_german_exercises_of_the_page():
    """Statement, instructions, hints and verdict are German."""
    stated = problems.statement("1.1", 0, "de")
    assert "Korahmen" in views.exercise(stated, "de")
    assert "Verfügbare Namen: r, phi" in stated["questions"][0]["how"]
    assert "Dualität" in problems.hints("1.1", 0, 1, "de")["hints"][0]
    assert next(iter(problems.listing("de")["chapters"])) == "1. Rahmen und Anholonomie"
    reply = problems.answer("1.1", 0, {"legs": "[[1, 0], [0, 1]]"}, "de")
    shown = views.verdict(reply, "de")
    for words in ("legs: ✗ falsch", "Sieh noch einmal nach", "Gelesen als:"):
        assert words in shown
    assert "pas encore traduit" in views.exercise(problems.statement("3.1", 0, "fr"), "fr")


@pytest.mark.parametrize(
    ("path", "query", "method", "expected"),
    [
        ("/", "", "GET", "/?language=de"),
        ("/", "access_token=a%20b", "GET", "/?access_token=a%20b&language=de"),
        ("/", "language=en", "GET", ""),
        ("/", "tab=Loops&language=en", "GET", ""),
        ("/", "", "POST", ""),
        ("/health", "", "GET", ""),
    ],
)
def test_the_address_gets_the_language_of_the_server(path, query, method, expected):
    """A browser without a language is sent to the address with the language of the server."""
    sent: list[Any] = []

    async def inner(scope: Any, receive: Any, send: Any) -> None:
        await send({"type": "http.response.start", "status": 200, "headers": []})

    async def send(message: Any) -> None:
        sent.append(message)

    async def receive() -> dict[str, Any]:
        return {"type": "http.request", "body": b""}

    async def ask() -> None:
        await localized(inner, "de")(scope, receive, send)

    scope = {"type": "http", "method": method, "path": path, "query_string": query.encode()}
    run(ask())
    assert dict(sent[0]["headers"]).get(b"location", b"").decode() == expected
    assert sent[0]["status"] == (307 if expected else 200)
    assert localized(inner, "en") is inner


def test_a_served_page_is_german():
    """`geomtorsion lab --language de` serves German tabs and exercises."""

    async def opened(url: str) -> str:
        async with Session(url, "language=de") as session:
            await session.shown("Das blaue Schiff")
            await session.set(session.element("marimo-tabs"), "6")
            await session.shown("Bestimme die Matrix")
            return str(session.outputs)

    with served("--language", "de") as url:
        with urllib.request.urlopen(url, timeout=PATIENCE) as reply:
            assert reply.url.endswith("/?language=de")
        shown = run(asyncio.wait_for(opened(url), 2 * PATIENCE))
    for words in ("Torsionslabor", "Prüfen", "1.1 Die Beine eines Korahmens"):
        assert words in shown


@pytest.mark.parametrize(
    ("language", "label", "title", "tab", "sent"),
    [
        ("en", "Parts of the lab", "Torsion lab", "Loops", "Uploaded 1 file."),
        ("de", "Teile des Labors", "Torsionslabor", "Schleifen", "Hochgeladen: 1 Datei."),
    ],
)
def test_parts_that_marimo_draws(
    watched: Watched, address: str, language: str, label: str, title: str, tab: str, sent: str
):
    """The document, its group of tabs and its upload field are in the language of the page."""
    page = loaded(watched, f"{address}?language={language}").page
    page.get_by_role("tablist", name=label, exact=True).wait_for()
    assert (page.evaluate("document.documentElement.lang"), page.title()) == (language, title)
    watched.tab(tab).wait_for_selector("#loop svg")
    file = {"name": "a.csv", "mimeType": "text/csv", "buffer": b"a,b\n1,2"}
    page.locator("input[type=file]").set_input_files(file)
    page.get_by_text(sent, exact=True).wait_for()
