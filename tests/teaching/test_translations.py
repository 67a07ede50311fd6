"""Translations: complete where they promise it, with the formulas and code of the English text."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

from geomtorsion import exercises
from geomtorsion.spaces import titles
from geomtorsion.teaching.lab.space_info import drawable
from geomtorsion.teaching.texts import (
    FOLDER,
    is_complete,
    languages,
    placeholders,
    texts,
    untranslated,
)
from tests.cli.running import run

FILES = sorted(path.stem for path in (FOLDER / "en").glob("*.toml"))
OTHERS = languages()[1:]
# A formula or a name to type, and a word in prose inside a formula.
FORMULA = re.compile(r"\$\$.*?\$\$|\$.*?\$|`.*?`", re.DOTALL)
PROSE = re.compile(r"\\text\{[^}]*\}")
# Language -> words that it shares with English.
SAME = {
    "de": {"in", "In", "Python", "yes", "phi", "Animation", "Torsion"},
    "fr": {
        "Animation",
        "Figure",
        "Pause",
        "circuit",
        "phi",
        "point",
        "points",
        "question",
        "verdict",
    },
}


def tables(file: str) -> Iterator[str]:
    """The headings of an English file; "" for the texts above all tables."""
    lines = (FOLDER / "en" / f"{file}.toml").read_text("utf-8").splitlines()
    tops = {line.strip("[]").split(".")[0] for line in lines if line.startswith("[")}
    first = next(line for line in lines if line and not line.startswith("#"))
    yield from sorted(tops | ({""} if not first.startswith("[") else set()))


def pairs(language: str) -> Iterator[tuple[str, str, str]]:
    """(where, text, English text) of each text that a language has."""
    for file in FILES:
        for heading in tables(file):
            own, english = texts(file, heading, language), texts(file, heading)
            if not own.translated:
                continue
            for key, entry in own.entries.items():
                model = english.entries[key]
                several = (
                    [(entry, model)] if isinstance(entry, str) else zip(entry, model, strict=True)
                )
                for number, (one, two) in enumerate(several):
                    yield f"{language}/{file}.toml [{heading}] {key} {number}", str(one), str(two)


def bare(text: str) -> str:
    """The words of a text, without formulas, code, placeholders and numbers."""
    plain = re.sub(r"@\{[a-z0-9_]*\}", " ", FORMULA.sub(" ", text))
    return " ".join(re.findall(r"[^\W\d_]{2,}", plain))


@pytest.mark.parametrize("language", [one for one in OTHERS if is_complete(one)])
def test_a_complete_language_has_every_table(language: str):
    """A language that promises to be complete lacks no table of any file."""
    assert untranslated(language) == ()


@pytest.mark.parametrize("language", OTHERS)
def test_translations_have_the_same_formulas(language: str):
    """Each text has the formulas, code, placeholders and bold words of the English text."""
    count = 0
    for where, own, english in pairs(language):
        count += 1
        found, model = (
            Counter(PROSE.sub(r"\\text{}", part) for part in FORMULA.findall(text))
            for text in (own, english)
        )
        assert found == model, where
        assert placeholders(own) == placeholders(english), where
        for mark in ("**", "\n\n", "\n- "):
            assert own.count(mark) == english.count(mark), (where, mark)
    assert count > 100


@pytest.mark.parametrize("language", OTHERS)
def test_no_text_is_left_in_english(language: str):
    """A translated text differs from the English one, unless it has no words of its own."""
    for where, own, english in pairs(language):
        if own == english:
            assert set(bare(own).split()) <= SAME[language], where


@pytest.mark.parametrize("language", OTHERS)
def test_titles_of_exercises_are_distinct(language: str):
    """A list of exercises shows each title once."""
    named = exercises.titles(language)
    assert len(set(named.values())) == len(named)


def test_every_space_has_its_title():
    """The file of titles has each shipped space, with its title in the library."""
    assert texts("spaces", "titles").table() == dict(titles())
    german = drawable("de")
    assert "heisenberg: die Heisenberg-Gruppe (Nil)" in german
    assert list(german.values()) == list(drawable().values())


def test_a_language_reports_what_it_lacks(tmp_path: Path):
    """A folder with one exercise lacks all other tables, and is not complete."""
    (tmp_path / "frames.toml").write_text((FOLDER / "de" / "frames.toml").read_text("utf-8"))
    lacking = untranslated(tmp_path)
    assert not is_complete(tmp_path)
    assert "torsion.toml [in_the_frame]" in lacking
    assert "torsion.toml title" in lacking
    assert not any(line.startswith("frames.toml") for line in lacking)
    assert (untranslated("en"), is_complete("en")) == ((), True)


def test_the_laws_see_wrong_translations():
    """The words of a text are seen between formulas, and a formula in prose is compared."""
    assert bare("In `gt.x`: the $x$ of @{legs}, 3") == "In the of"
    first, second = (
        PROSE.sub(r"\\text{}", text) for text in (r"$a_\text{mid}$", r"$a_\text{Mitte}$")
    )
    assert first == second
    assert FORMULA.findall("$a$ and `b` and $$c$$") == ["$a$", "`b`", "$$c$$"]


def test_german_verdicts_in_words():
    """Points, states, notes and the advice about a decimal comma are German."""
    spiral = exercises.load("4.1", language="de")
    verdict = spiral.check({"radius": "1,5", "winkel": "2"})
    assert "Schreibe 1.5." in verdict["radius"].message
    assert verdict.points_text == "0 bis 1 von 2 Punkten"
    assert verdict.notes == ("Es gibt keine Frage 'winkel': Diese Antwort wird nicht gezählt.",)
    assert "nicht lesbar" in str(verdict)
    assert "<th>Urteil</th>" in verdict._repr_html_()
    copied = type(verdict).from_json(verdict.to_json())
    assert copied == verdict
    assert repr(spiral.check(spiral.answers())).endswith("radius richtig, angle richtig)")


def test_a_choice_may_be_given_by_the_first_word_of_its_text():
    """The words ja and nein choose an option of a German exercise, not of an English one."""
    constraint = exercises.load("4.5", language="de")
    verdicts = [
        constraint.check({"integrable": word})["integrable"].right
        for word in (constraint.answers()["integrable"], "nein", "ja")
    ]
    assert sorted(verdicts[1:]) == [False, True]
    assert verdicts[0]
    assert not exercises.load("4.5").check({"integrable": "nein"})["integrable"].was_read


def test_german_words_of_the_command_line():
    """Each command of exercises has German words around the texts."""
    for arguments, words in {
        ("show", "6.4"): ("Variante (seed) 0", "3 Hinweise: `geomtorsion exercises hint 6.4"),
        ("hint", "6.4"): ("Weiter: `geomtorsion exercises hint 6.4 --language de --step 2`",),
        ("solution", "6.4"): ("Antworten, wie sie geprüft werden:",),
    }.items():
        shown = run("exercises", *arguments, "--language", "de").stdout
        for word in words:
            assert word in " ".join(shown.split())
    listed = run("exercises", "--language", "de").stdout
    assert "`geomtorsion exercises show 1.1` zeigt eine davon." in listed
    answers = ("radius=1,5", "angle=2", "--language", "de")
    checked = run("exercises", "check", "4.1", *answers, code=1).stdout
    assert "Nicht verstanden, also weder richtig noch falsch: radius." in checked
