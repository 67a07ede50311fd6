"""registry: chapters and exercises by number, loaded on first use."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from importlib import import_module
from typing import TYPE_CHECKING

from geomtorsion.errors import UnknownNameError
from geomtorsion.support.checks import close_names, count, shown
from geomtorsion.teaching.exercises.chapter_folder import Chapter, Folder, load_folder
from geomtorsion.teaching.exercises.draw import Draw
from geomtorsion.teaching.exercises.exercise import Exercise
from geomtorsion.teaching.exercises.limits import MOST
from geomtorsion.teaching.exercises.shipped import CHAPTERS, EXERCISES
from geomtorsion.teaching.texts import ENGLISH, Language, Texts, language_name, texts

if TYPE_CHECKING:
    from geomtorsion.teaching.exercises.verdict import Verdict

# The chapter of a teacher, besides the shipped ones.
Own = Chapter | Folder | None


def names(chapter: Own = None) -> tuple[str, ...]:
    """Numbers of all exercises, in order; loads none of the shipped ones.

    chapter: the folder of a teacher's chapter, whose exercises come last; see `load_folder`.

    Examples
    --------
    >>> names()[0]
    '1.1'
    """
    own = () if chapter is None else load_folder(chapter).names
    return (*(number for number, _, _ in EXERCISES), *own)


def titles(language: Language = ENGLISH, chapter: Own = None) -> dict[str, str]:
    """Number -> title; loads none of the shipped exercises. chapter: as in `names`.

    Examples
    --------
    >>> titles()["1.1"], titles("de")["1.1"]
    ('The legs of a coframe', 'Die Beine eines Korahmens')
    """
    language = language_name(language)
    own = {} if chapter is None else load_folder(chapter).titles
    return {number: _texts(module, language)("title") for number, module, _ in EXERCISES} | own


def levels_of(chapter: Own = None) -> dict[str, str]:
    """Number -> level of all exercises. chapter: as in `names`."""
    own = {} if chapter is None else load_folder(chapter).levels
    return {number: level for number, _, level in EXERCISES} | own


def chapters(language: Language = ENGLISH, chapter: Own = None) -> dict[str, str]:
    """Number -> subject of each chapter. chapter: as in `names`.

    Examples
    --------
    >>> chapters()["1"]
    'Frames and anholonomy'
    """
    language = language_name(language)
    own = {} if chapter is None else {(last := load_folder(chapter)).number: last.title}
    return {number: texts(name, "", language)("title") for number, name in CHAPTERS} | own


def chapter_of(number: str, language: Language = ENGLISH) -> str:
    """Title of the chapter of an exercise."""
    return texts(dict(CHAPTERS)[number.partition(".")[0]], "", language_name(language))("title")


def _texts(module: str, language: str) -> Texts:
    """The texts of an exercise."""
    name, _, heading = module.partition(".")
    return texts(name, heading, language)


def load(number: str, seed: int = 0, language: Language = ENGLISH, chapter: Own = None) -> Exercise:
    """An exercise in the variant of a seed; nothing is solved before an answer is checked.

    Parameters
    ----------
    number
        such as "1.1".
    seed
        the variant.
    language
        "en", "de", or a folder with translated texts; an exercise that it lacks is in English, and
        its `note` reports this.
    chapter
        the folder of a teacher's chapter, whose exercises are then known as well; see
        `load_folder`.

    Raises
    ------
    UnknownNameError
        There is no such exercise, seed or language; the message lists the known ones.
    FileFormatError
        The folder has a mistake; the message names the file and the line.

    Examples
    --------
    >>> load("1.1").title, load("1.1", seed=7).seed
    ('The legs of a coframe', 7)
    >>> load("1.1", language="de").title
    'Die Beine eines Korahmens'
    """
    seed = count(seed, "seed (which variant)", UnknownNameError, 0, MOST.seed)
    for key, module, level in EXERCISES:
        if key == number:
            return _loaded(key, module, level, seed, language_name(language))
    known = names(chapter)
    if chapter is not None and number in known:
        return load_folder(chapter).load(number, seed, language)
    if not isinstance(number, str):
        example = str(number) if str(number) in known else known[0]
        raise UnknownNameError(
            f"expected the number of an exercise as text, got {shown(number)}. Write it in quotes: "
            f'"{example}".'
        )
    near = close_names(number[:20], known, 3, 0.6)
    hint = f" Did you mean {' or '.join(near)}?" if near else ""
    raise UnknownNameError(
        f"expected the number of an exercise, from {known[0]} to {known[-1]}, got "
        f"{number[:20]!r}.{hint} `geomtorsion exercises` lists all exercises."
    )


# A class has a few variants of each exercise; solving one again costs time.
@lru_cache(maxsize=512)
def _loaded(number: str, module: str, level: str, seed: int, language: str = ENGLISH) -> Exercise:
    """An exercise from the cache: results computed for one student serve the next."""
    text = _texts(module, language)
    made = import_module(f"geomtorsion.teaching.exercises.{module}").make(Draw(seed), text)
    questions = tuple(replace(question, language=language) for question in made.questions)
    note = "" if text.translated else text.of("notes", "sheets")("untranslated")
    return Exercise(
        number,
        text("title"),
        chapter_of(number, language),
        level,
        seed,
        replace(made, questions=questions),
        load,
        language,
        note,
    )


def check(
    number: str,
    answers: Mapping[str, object] | str,
    seed: int = 0,
    language: Language = ENGLISH,
    chapter: Own = None,
) -> Verdict:
    """The verdict on the answers to an exercise; see `Exercise.check`.

    Examples
    --------
    >>> check("1.1", "[[1, 0], [0, 1]]").right
    False
    """
    return load(number, seed, language, chapter).check(answers)
