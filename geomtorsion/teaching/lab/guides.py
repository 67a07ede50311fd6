"""guides: the words of each tab, on the served page and on pages without a server."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache

from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.lab.uploads import TEXT_MAPS
from geomtorsion.teaching.texts import ENGLISH, Texts, texts


@dataclass(frozen=True)
class Guide:
    """Sentences for one tab.

    seen: the displayed objects. tried: the first action to try. question, answer: a prediction to
    make before the answer is opened. words: term -> its meaning, with formulas in LaTeX. note: that
    the sentences are English, if they are not translated.
    """

    seen: str
    tried: str
    question: str = ""
    answer: str = ""
    words: Mapping[str, str] = field(default_factory=dict)
    note: str = ""


@dataclass(frozen=True)
class Tab:
    """A tab in one language.

    name: its label. summary: its contents in a sentence. guide: its sentences.
    """

    name: str
    summary: str
    guide: Guide


# Tab, by its English name, which addresses contain -> its heading in the file of texts.
TABS: Mapping[str, str] = {
    "The compass": "compass",
    "Loops": "loops",
    "Straightest and shortest": "paths",
    "The top": "top",
    "What accuracy costs": "costs",
    "Any tetrad": "tetrad",
    "Exercises": "exercises",
}
COMPASS, LOOPS, PATHS, TOP, COSTS, TETRAD, EXERCISES = TABS
# Two more parts of the tab for loops.
ATOMS, MEASURED = "atoms", "measured"


@lru_cache(maxsize=256)
def tab(name: str, language: str = ENGLISH, *, still: bool = False) -> Tab:
    """A tab, or its page without a server, which has computed cases and no fields.

    Examples
    --------
    >>> tab(LOOPS).name, tab(LOOPS, still=True).guide.tried[:23]
    ('Loops', 'Make the radius smaller')
    """
    text = texts("lab", TABS[name], language)
    start = "still." if still else ""
    return Tab(text(f"{start}name"), text(f"{start}summary"), _guide(text, start))


@lru_cache(maxsize=256)
def part(name: str, language: str = ENGLISH) -> Guide:
    """The guide of a part of a tab, ATOMS or MEASURED.

    Examples
    --------
    >>> part(ATOMS).question
    'A circuit encloses two opposite dislocations. Which gap does it have?'
    """
    return _guide(texts("lab", name, language))


def named(label: str, language: str = ENGLISH) -> str:
    """The tab with a label.

    Examples
    --------
    >>> named("Loops") == LOOPS
    True
    """
    return next(name for name in TABS if tab(name, language).name == label)


def _guide(text: Texts, start: str = "") -> Guide:
    """The guide of a heading; start: of the keys whose texts take precedence."""
    # Elsewhere a comma is the sign of decimals.
    between = "," if text.language == ENGLISH else "\u202f"
    limits = {
        "formats": ", ".join(TEXT_MAPS), "megabytes": f"{PAGE.upload / 1e6:g}",
        "nodes": f"{PAGE.nodes:,}".replace(",", between),
        "pixels": f"{PAGE.pixels:,}".replace(",", between),
    }  # fmt: skip

    def sentence(key: str) -> str:
        key = f"{start}{key}" if f"{start}{key}" in text else key
        return text(key, **(limits if (text.heading, key) == (MEASURED, "seen") else {}))

    asked = ("question", "answer") if "question" in text else ()
    words = text.pairs("words") if "words" in text else {}
    note = "" if text.translated else text.of("notes", "sheets")("page")
    return Guide(sentence("seen"), sentence("tried"), *map(sentence, asked), words=words, note=note)
