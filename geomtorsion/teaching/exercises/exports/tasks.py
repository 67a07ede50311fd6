"""tasks: the exercises of an export, each in its variants."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from geomtorsion.errors import ArgumentError
from geomtorsion.support import checks
from geomtorsion.teaching.exercises.chapter_folder import load_folder
from geomtorsion.teaching.exercises.checking import ROUNDED
from geomtorsion.teaching.exercises.exercise import Exercise
from geomtorsion.teaching.exercises.question import Mistake, Question
from geomtorsion.teaching.exercises.registry import Own, load, names
from geomtorsion.teaching.exercises.verdict import message_of
from geomtorsion.teaching.texts import ENGLISH, Language


@dataclass(frozen=True, eq=False)
class Task:
    """An exercise in the variants to export.

    variants: one exercise for each seed, in the order of the seeds.

    Examples
    --------
    >>> task = tasks(["3.2"], [0, 7])[0]
    >>> task.number, task.slug, [exercise.seed for exercise in task.variants]
    ('3.2', '3-2-a-christoffel-symbol', [0, 7])
    """

    variants: tuple[Exercise, ...]

    @property
    def number(self) -> str:
        """Number, such as "3.2"."""
        return self.variants[0].number

    @property
    def title(self) -> str:
        """Title of the exercise."""
        return self.variants[0].title

    @property
    def heading(self) -> str:
        """Number and title."""
        return f"{self.number} {self.title}"

    @property
    def chapter(self) -> str:
        """Number and title of its chapter."""
        number = self.number.partition(".")[0]
        return f"{number}. {self.variants[0].chapter}"

    @property
    def slug(self) -> str:
        """Number and title in small letters, digits and dashes, as names of folders."""
        letters = (sign if sign.isalnum() else "-" for sign in self.heading.lower())
        return "-".join(part for part in "".join(letters).split("-") if part)


def tasks(
    numbers: Sequence[str] | None,
    seeds: Sequence[int],
    language: Language = ENGLISH,
    chapter: Own = None,
) -> tuple[Task, ...]:
    """Exercises in their variants; by default all, or with a chapter its exercises.

    Raises
    ------
    UnknownNameError
        There is no such exercise, seed or language.
    ArgumentError
        An exercise or a seed is given twice, or none is given.
    """
    every = names() if chapter is None else load_folder(chapter).names
    chosen = every if numbers is None else numbers
    for subject, entries in (("numbers", chosen), ("seeds", seeds)):
        values = list(checks.entries(entries, subject, ArgumentError))
        if not values or len({str(value) for value in values}) < len(values):
            raise ArgumentError(
                f"{subject}: expected at least one, and none twice, got {checks.shown(entries)}. "
                "List each once."
            )
    return tuple(
        Task(tuple(load(number, seed, language, chapter) for seed in seeds)) for number in chosen
    )


def feedback(question: Question, mistake: Mistake) -> str:
    """The feedback on a mistake: Markdown with LaTeX.

    Examples
    --------
    >>> question = load("3.2").questions[0]
    >>> feedback(question, Mistake("sign", 0))[:19]
    'The sign is wrong.'
    """
    return mistake.message or message_of(mistake.code, question.remarks, question.language)


def can_be_rounded(question: Question) -> bool:
    """Whether early rounding can move a number out of its tolerance.

    Examples
    --------
    >>> [can_be_rounded(question) for question in load("5.5").questions]
    [True, False]
    """
    return question.kind == "number" and not question.exact and question.tolerance < ROUNDED
