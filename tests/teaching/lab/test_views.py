"""Guide of each tab: a few sentences, and explanations of its terms."""

from __future__ import annotations

import re
from html import unescape

import pytest

from geomtorsion.teaching.lab.guides import COMPASS, EXERCISES, LOOPS, PATHS, TABS, TOP
from geomtorsion.teaching.lab.guides import tab as tab_of
from geomtorsion.teaching.lab.space_info import typable
from geomtorsion.teaching.lab.views import intro, words

TERMS = {
    COMPASS: ("torsion",),
    LOOPS: ("b", "2 S A", "flux of torsion"),
    PATHS: ("torsion force", "straightest (autoparallel)", "shortest (geodesic)"),
    TOP: ("body cone", "space cone", "torsion force", "nutation"),
}


@pytest.mark.parametrize("tab", TABS)
def test_a_guide_describes_the_view_and_a_trial(tab: str):
    """A guide has one sentence about the view and one about a trial, 100 to 400 letters in all."""
    guide = tab_of(tab).guide
    text = f"{guide.seen} {guide.tried}"
    for sentence in (guide.seen, guide.tried):
        assert sentence[0].isupper()
        assert re.findall(r"[.!?](?=\s+[A-Z]|$)", sentence) == ["."]
    assert 100 < len(text) < 400
    assert guide.tried[:40] in intro(guide)


@pytest.mark.parametrize("tab", [tab for tab in TABS if tab != EXERCISES])
def test_a_tab_asks_before_it_answers(tab: str):
    """A tab with figures asks one question; its answer is folded, and the guide omits it."""
    guide = tab_of(tab).guide
    assert guide.question.count("?") == 1
    before, folded = intro(guide).split("</summary>")
    assert guide.question[:40] in unescape(before)
    assert guide.answer not in unescape(before)
    assert guide.answer in unescape(folded.partition("</details>")[0])


@pytest.mark.parametrize(("tab", "terms"), TERMS.items())
def test_words_are_explained_where_they_appear(tab: str, terms: tuple[str, ...]):
    """Terms that a beginner does not know are explained on their tab."""
    shown = words(tab)
    for term in terms:
        assert f"<dt>{term}</dt>" in shown
        assert len(tab_of(tab).guide.words[term]) > 30


def test_spaces_that_are_named_are_there():
    """Each space that a guide names is on the list."""
    named = {"flat_polar", "screw_dislocation", "so3"}
    text = " ".join(tab_of(tab).guide.tried for tab in TABS)
    assert all(name in text for name in named)
    assert named <= set(typable().values())


def test_the_page_begins_with_a_picture():
    """The compass is the first tab, the tab for typed tetrads the last but one."""
    tabs = list(TABS)
    assert tabs[0] == "The compass"
    assert tabs[-2] == "Any tetrad"
