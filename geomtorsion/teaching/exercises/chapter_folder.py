"""chapter folder: a chapter of a teacher, in a folder with TOML texts and perhaps a Python file."""

from __future__ import annotations

import hashlib
import runpy
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from os import PathLike
from pathlib import Path
from traceback import walk_tb
from types import FunctionType
from typing import TypeVar

from geomtorsion.errors import FileFormatError, GeomtorsionError, UnknownNameError
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.files import TomlFile, read_text, read_toml_text
from geomtorsion.teaching.exercises.draw import Draw
from geomtorsion.teaching.exercises.exercise import Exercise, Variant
from geomtorsion.teaching.exercises.limits import MOST
from geomtorsion.teaching.exercises.question import KINDS, Question
from geomtorsion.teaching.exercises.shipped import CHAPTERS
from geomtorsion.teaching.exercises.written import Table, Written, level
from geomtorsion.teaching.texts import ENGLISH, QUOTES, Language, Texts, language_name, own_texts

TEXTS, PROGRAM = "chapter.toml", "chapter.py"
KEYS = ("number", "title")
# The first number that no shipped chapter has.
FIRST = len(CHAPTERS) + 1
Folder = str | PathLike[str]
Result = TypeVar("Result")


@dataclass(frozen=True, eq=False, repr=False)
class Chapter:
    """Chapter of exercises that a teacher wrote.

    folder: with chapter.toml, and with chapter.py if an exercise has a function. number: of the
    chapter, such as "8"; the exercises are "8.1", "8.2" and so on, in the order of the file.
    title: of the chapter. content: text of both files.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "chapter.toml")
    ...     _ = file.write_text('''
    ... title = 'Circles'
    ... [area]
    ... title = 'The area of a circle'
    ... statement = 'A circle has the radius $r$.'
    ... coordinates = ["r"]
    ... [area.area]
    ... prompt = 'What is its area?'
    ... answer = "pi*r^2"
    ... ''')
    ...     chapter = load_folder(folder)
    >>> chapter.names, chapter.load("8.1").check("r pi r").right
    (('8.1',), True)
    """

    folder: str
    content: tuple[str, str]
    file: TomlFile

    def __repr__(self) -> str:
        return f"chapter {self.number}. {self.title}: exercises {', '.join(self.names)}"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Chapter):
            return NotImplemented
        return (self.folder, self.content) == (other.folder, other.content)

    def __hash__(self) -> int:
        return hash((self.folder, self.content))

    def __reduce__(self) -> tuple[object, ...]:
        return load_folder, (self.folder,)

    @cached_property
    def number(self) -> str:
        """Number of the chapter."""
        value = self.file.data.get("number", FIRST)
        if type(value) is not int or not FIRST <= value < 1000:
            self.file.fail(
                ("number",),
                f"number: expected a whole number from {FIRST} to 999, got {checks.shown(value)}. "
                f"The shipped chapters are 1 to {FIRST - 1}.",
            )
        return str(value)

    @cached_property
    def title(self) -> str:
        """Title of the chapter."""
        title = self.file.data.get("title")
        if not isinstance(title, str) or not title.strip():
            got = "none" if title is None else checks.shown(title)
            self.file.fail(
                ("title",), f"title: expected the title of the chapter, got {got}. Write "
                "title = 'Cells and circles' above all tables."
            )  # fmt: skip
        return " ".join(title.split())

    @cached_property
    def tables(self) -> dict[str, Written | Programmed]:
        """Number -> exercise as it is written, in the order of the file."""
        headings = []
        for key, value in self.file.data.items():
            if isinstance(value, dict):
                headings.append(key)
            elif key not in KEYS:
                self.file.unknown((key,), KEYS, f"unknown key {key}")
        if not headings:
            self.file.fail(
                (), "expected at least one exercise, got none. Write a table such as [cell] with "
                "the keys title and statement."
            )  # fmt: skip
        return {
            f"{self.number}.{place}": self._entry(name) for place, name in enumerate(headings, 1)
        }

    def _entry(self, name: str) -> Written | Programmed:
        """The exercise below a heading."""
        if "function" not in self.file.data[name]:
            return Written.of(self.file, name)
        return Programmed.of(self, name)

    @property
    def names(self) -> tuple[str, ...]:
        """Numbers of the exercises, in order."""
        return tuple(self.tables)

    @property
    def titles(self) -> dict[str, str]:
        """Number -> title of each exercise."""
        return {number: entry.text("title") for number, entry in self.tables.items()}

    @property
    def levels(self) -> dict[str, str]:
        """Number -> level of each exercise."""
        return {
            number: level(self.file, entry.name, entry.table)
            for number, entry in self.tables.items()
        }

    @property
    def digest(self) -> str:
        """A hash of the content: equal chapters give equal exercises."""
        return hashlib.sha256("\0".join(self.content).encode()).hexdigest()

    @cached_property
    def functions(self) -> dict[str, FunctionType]:
        """The functions of chapter.py, which this runs once.

        Raises
        ------
        FileFormatError
            Its code raises an error; the message names the line.
        """
        path = Path(self.folder, PROGRAM)
        if not path.is_file():
            return {}
        # The teacher's own program: it runs only because the teacher gives this folder.
        globals_of = self.guarded(lambda: runpy.run_path(str(path), run_name="chapter"))
        return {
            name: value
            for name, value in globals_of.items()
            if isinstance(value, FunctionType) and value.__code__.co_filename == str(path)
        }

    def guarded(self, call: Callable[[], Result]) -> Result:
        """The result of a call of the teacher's program; its error names the line."""
        try:
            return call()
        except GeomtorsionError:
            raise
        except Exception as error:  # a program of somebody else
            path = str(Path(self.folder, PROGRAM))
            lines = [line for frame, line in walk_tb(error.__traceback__)
                     if frame.f_code.co_filename == path]  # fmt: skip
            if isinstance(error, SyntaxError) and error.lineno:
                lines = [error.lineno]
            where = f"{PROGRAM}: line {lines[-1]}: " if lines else f"{PROGRAM}: "
            reason = checks.cut(str(error).split("\n", maxsplit=1)[0], 200)
            raise FileFormatError(
                f"{where}expected a program that runs, got {type(error).__name__}: "
                f"{reason.rstrip('.')}. Mend this line."
            ) from error

    def load(self, number: str, seed: int = 0, language: Language = ENGLISH) -> Exercise:
        """An exercise of the chapter in the variant of a seed.

        language: of the messages about answers; the texts are in the language of the file.

        Raises
        ------
        UnknownNameError
            There is no such exercise, seed or language.
        FileFormatError
            The exercise cannot be made in this variant; the message names the line.
        """
        seed = checks.count(seed, "seed (which variant)", UnknownNameError, 0, MOST.seed)
        number = checks.known_name(number, list(self.names), "chapter", UnknownNameError)
        return _loaded(self, number, seed, language_name(language))


def load_folder(folder: Folder | Chapter) -> Chapter:
    """Load the chapter of a teacher from a folder; each exercise is made once, as a check.

    Parameters
    ----------
    folder
        with chapter.toml, and with chapter.py for exercises with a function. chapter.py is a
        program: load folders of people whom you trust.

    Raises
    ------
    FileFormatError
        There is no such folder or file, a key is missing or unknown, a value has the wrong type,
        an answer cannot be read, a formula is not LaTeX, or chapter.py raises an error; the message
        names the file and the line.

    Examples
    --------
    >>> load_folder("no_such_folder")
    Traceback (most recent call last):
    geomtorsion.errors.FileFormatError: no_such_folder: expected a folder with chapter.toml, got ...
    """
    if isinstance(folder, Chapter):
        return folder
    path = checks.file_name(folder, "folder")
    if not path.is_dir():
        got = "a file" if path.exists() else "no such folder"
        raise FileFormatError(
            f"{path}: expected a folder with {TEXTS}, got {got}. The page 'How to add an exercise' "
            "of the site shows such a folder."
        )
    others = sorted(file.name for file in path.glob("*.toml") if file.name != TEXTS)
    if others or not (path / TEXTS).is_file():
        got = ", ".join(others) or "none"
        raise FileFormatError(
            f"{path}: expected one TOML file, {TEXTS}, got {got}. Write all exercises of a chapter "
            f"into {TEXTS}, and each further chapter into a folder of its own."
        )
    program = path / PROGRAM
    content = read_text(path / TEXTS), read_text(program) if program.is_file() else ""
    return _opened(str(path.resolve()), content)


# A server and a worker open the same folder for each request.
@lru_cache(maxsize=32)
def _opened(folder: str, content: tuple[str, str]) -> Chapter:
    """A chapter from the cache, checked when it is first opened."""
    chapter = Chapter(folder, content, read_toml_text(content[0], TEXTS, advice=QUOTES))
    _ = chapter.number, chapter.title
    for entry in chapter.tables.values():
        entry.check()
    return chapter


@lru_cache(maxsize=512)
def _loaded(chapter: Chapter, number: str, seed: int, language: str) -> Exercise:
    """An exercise from the cache."""
    entry = chapter.tables[number]
    made = entry.variant(Draw(seed))
    return Exercise(
        number,
        entry.text("title"),
        chapter.title,
        chapter.levels[number],
        seed,
        replace(made, questions=tuple(replace(q, language=language) for q in made.questions)),
        partial(_load_from, chapter.folder),
        language,
        folder=chapter.folder,
    )


def _load_from(folder: str, number: str, seed: int, language: str) -> Exercise:
    """An exercise of a folder: it is what copies and other processes call."""
    return load_folder(folder).load(number, seed, language)


@dataclass(frozen=True, eq=False)
class Programmed:
    """An exercise that a function of chapter.py makes from its texts."""

    chapter: Chapter
    name: str
    table: Table
    text: Texts

    @classmethod
    def of(cls, chapter: Chapter, name: str) -> Programmed:
        """The exercise below a heading."""
        file, table = chapter.file, chapter.file.data[name]
        level(file, name, table)
        own = table["function"]
        if not isinstance(own, str) or own not in chapter.functions:
            if not chapter.content[1]:
                file.fail((name, "function"), f"{name}.function: expected the file {PROGRAM} in "
                          f"the folder, got none. Write it, with a function {own}.")  # fmt: skip
            known = list(chapter.functions) or ["no function"]
            file.unknown((name, "function", str(own)), known,
                         f"{name}.function: {PROGRAM} has no function {own}")  # fmt: skip
        prose = {key: value for key, value in table.items() if key not in ("function", "level")}
        if "title" not in prose:
            file.fail((name,), f"{name}: expected the key title, got none. Write it.")
        return cls(chapter, name, table, own_texts(file, name, prose))

    def check(self) -> None:
        """Make the first variant, and refuse it if it is not one."""
        self.variant(Draw(0))

    def variant(self, draw: Draw) -> Variant:
        """The variant that the function returns, checked."""
        own, chapter = self.table["function"], self.chapter
        made = chapter.guarded(lambda: chapter.functions[own](draw, self.text))
        self._check(made)
        return Variant(
            made.statement,
            tuple(self._question(question) for question in made.questions),
            tuple(made.hints),
            lambda: chapter.guarded(made.worked),
        )

    def _check(self, made: object) -> None:
        """Refuse a result that is not a variant with questions of different names."""
        own = self.table["function"]
        where = f"{PROGRAM}: function {own}: "
        if not isinstance(made, Variant):
            raise FileFormatError(
                f"{where}expected a Variant, got {checks.shown(made)}. Return "
                "Variant(statement=..., questions=..., hints=..., worked=...)."
            )
        questions = made.questions
        is_tuple = isinstance(questions, tuple) and questions
        if not is_tuple or not all(isinstance(q, Question) for q in questions):
            raise FileFormatError(
                f"{where}expected a tuple of questions, got {checks.shown(questions)}. Write "
                "questions=(Question(...),), with a comma after a single one."
            )
        names = [question.name for question in questions]
        if len(set(names)) < len(names):
            raise FileFormatError(
                f"{where}expected questions of different names, got {', '.join(names)}. Rename one."
            )
        for question in questions:
            checks.choice(question.kind, KINDS, f"{where}kind", FileFormatError)

    def _question(self, question: Question) -> Question:
        """A question whose answer and mistakes name the line of an error."""
        guarded = self.chapter.guarded
        return replace(
            question,
            answer=lambda: guarded(question.answer),
            errors=lambda: guarded(lambda: tuple(question.errors())),
        )
