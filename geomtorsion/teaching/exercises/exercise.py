"""Exercise: a statement with questions, hints and a solution that the library computes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from html import escape

from geomtorsion.errors import UnknownNameError
from geomtorsion.support.caching import cached_property
from geomtorsion.support.checks import close_names, shown
from geomtorsion.teaching.exercises.answers import answer_text
from geomtorsion.teaching.exercises.checking import check_question
from geomtorsion.teaching.exercises.compare import Value
from geomtorsion.teaching.exercises.entries import is_part
from geomtorsion.teaching.exercises.prose import html_of
from geomtorsion.teaching.exercises.question import Question, how_to_answer
from geomtorsion.teaching.exercises.verdict import Verdict
from geomtorsion.teaching.exercises.working import Step
from geomtorsion.teaching.texts import ENGLISH, TextTable, texts

# Level -> its name.
LEVELS = TextTable("sheets", "levels")


@dataclass(frozen=True, eq=False)
class Variant:
    """One variant of an exercise, as its file creates it.

    statement: Markdown with LaTeX between dollar signs.
    questions: in order. hints: one step each, from a nudge to nearly the whole solution.
    worked: computes the worked solution at its first use.
    """

    statement: str
    questions: tuple[Question, ...]
    hints: tuple[str, ...]
    worked: Callable[[], tuple[Step, ...]]


@dataclass(frozen=True, eq=False, repr=False)
class Exercise:
    """One variant of an exercise.

    number: "3.2". title, chapter: the exercise and its chapter. level: warm-up, exercise or
    project. seed: the variant; 0 is the variant of the paper. variant: its content. loader:
    creates the exercise from number, seed and language, which determine it completely; copies use
    it. language: of the texts, as requested. note: that the text is English, if it is not
    translated into this language. folder: of the chapter of a teacher; "" for a shipped exercise.

    Examples
    --------
    >>> from geomtorsion.teaching.exercises import load
    >>> exercise = load("1.1")
    >>> exercise.check(exercise.answers()).right
    True
    """

    number: str
    title: str
    chapter: str
    level: str
    seed: int
    variant: Variant
    loader: Callable[[str, int, str], Exercise]
    language: str = ENGLISH
    note: str = ""
    folder: str = ""

    def __repr__(self) -> str:
        names = ", ".join(question.name for question in self.questions)
        return (
            f"exercise {self.number} ({self.level}, seed {self.seed}): {self.title}; "
            f"asked: {names}; {len(self.hints)} hints"
        )

    def _repr_markdown_(self) -> str:
        note = f"*{self.note}*\n\n" if self.note else ""
        return f"**{self.number}. {self.title}** ({self.level_name})\n\n{note}{self.statement}"

    def _repr_html_(self) -> str:
        asked = "".join(
            f"<li>{html_of(question.prompt)}"
            f"{html_of(f'`{question.name}`: {how_to_answer(question)}')}</li>"
            for question in self.questions
        )
        title = f"<b>{escape(self.number)}. {escape(self.title)}</b> ({escape(self.level_name)})"
        note = f"<p><em>{escape(self.note)}</em></p>" * bool(self.note)
        return f"<div><p>{title}</p>{note}{html_of(self.statement)}<ul>{asked}</ul></div>"

    def __reduce__(self) -> tuple[object, ...]:
        return self.loader, (self.number, self.seed, self.language)

    @property
    def level_name(self) -> str:
        """The level in the language of the texts.

        Examples
        --------
        >>> from geomtorsion.teaching.exercises import load
        >>> load("1.1").level_name, load("1.1", language="de").level_name
        ('warm-up', 'zum Einstieg')
        """
        return LEVELS.of(self.language)[self.level]

    @property
    def statement(self) -> str:
        """The known quantities and the task: Markdown, LaTeX between dollar signs."""
        return self.variant.statement

    @property
    def questions(self) -> tuple[Question, ...]:
        """The questions, in order."""
        return self.variant.questions

    @property
    def hints(self) -> tuple[str, ...]:
        """Steps, from a nudge to nearly the whole solution; Markdown with LaTeX."""
        return self.variant.hints

    @cached_property
    def worked(self) -> tuple[Step, ...]:
        """The solution step by step, for the teacher; each question is answered by one step.

        The answers are derived by hand, independently of the library's own solution.
        """
        return self.variant.worked()

    def question(self, name: str) -> Question:
        """The question with this name.

        Raises
        ------
        UnknownNameError
            There is no such question; the message lists the known ones.
        """
        by_name = {question.name: question for question in self.questions}
        if isinstance(name, str) and name in by_name:
            return by_name[name]
        near = close_names(name, by_name) if isinstance(name, str) else []
        hint = f" Did you mean {near[0]}?" if near else ""
        raise UnknownNameError(
            f"exercise {self.number}: expected the name of a question ({', '.join(by_name)}), got "
            f"{shown(name)}.{hint}"
        )

    def solution(self) -> dict[str, Value]:
        """The right answers, computed now: question -> {index counted from 0: expression}."""
        return {question.name: question.solution for question in self.questions}

    def answers(self) -> dict[str, str]:
        """The right answers as texts that `check` takes."""
        return {q.name: answer_text(q, q.solution) for q in self.questions}

    def check(self, answers: Mapping[str, object] | str) -> Verdict:
        """The verdict on answers; no input of a student raises an error.

        Parameters
        ----------
        answers
            question -> answer (text, number, list or table); a single text if there is one
            question.

        Examples
        --------
        >>> from geomtorsion.teaching.exercises import load
        >>> verdict = load("1.1").check({"legs": "[[1, 0], [0, oops]]"})
        >>> verdict.right, verdict["legs"].diagnosis
        (False, 'unreadable')
        """
        by_name, notes = self.arranged(answers)
        verdicts = tuple(check_question(q, by_name.get(q.name)) for q in self.questions)
        return Verdict(self.number, self.seed, verdicts, notes, self.language)

    def arranged(self, answers: object) -> tuple[dict[str, object], tuple[str, ...]]:
        """Answers by question, and remarks about the form of the answers.

        One answer counts for the first question; a table whose keys are components of the only
        question is its answer; any other key that does not name a question is reported.

        Examples
        --------
        >>> from geomtorsion.teaching.exercises import load
        >>> load("2.1").arranged({"1,2,2": "1/r"})
        ({'connection': {'1,2,2': '1/r'}}, ())
        >>> load("2.1").arranged({"conection": "0"})
        ({}, ("There is no question 'conection': this answer is not counted. Did you mean...",))
        """
        first, *rest = self.questions
        text = texts("feedback", "checking", self.language)
        by_name = {question.name: question for question in self.questions}
        if not isinstance(answers, Mapping):
            note = text("several", names=", ".join(by_name), first=first.name)
            return {first.name: answers}, (note,) * bool(rest)
        strange = [name for name in answers if name not in by_name]
        if not rest and strange == list(answers) and any(is_part(first, key) for key in strange):
            return {first.name: dict(answers)}, ()
        notes = []
        for name in strange:
            near = close_names(str(name), list(by_name))
            hint = f" {text('near', name=near[0])}" if near else ""
            notes.append(text("strange", name=repr(str(name)[:60])) + hint)
        return {name: answers[name] for name in by_name if name in answers}, tuple(notes)
