"""Verdict: the result of checking an answer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from html import escape
from typing import Any

from geomtorsion.errors import UnknownNameError
from geomtorsion.support.checks import known_name
from geomtorsion.teaching.exercises.prose import html_of
from geomtorsion.teaching.texts import ENGLISH, Texts, TextTable, texts

# Code -> the mistake in a few words.
TITLES = TextTable("feedback", "titles")
# Codes of answers that a person must read: it is unknown whether they are right.
UNREAD = ("unreadable", "too large")
# Code -> message to a student, unless the exercise has its own.
MESSAGES = TextTable("feedback", "messages")
# State of a verdict -> its name.
STATES = TextTable("feedback", "states")
# Sources of a wrong sign or factor 2 in questions about torsion only.
TORSION = TextTable("feedback", "torsion")
# Sources of these mistakes in questions about the connection itself.
CONNECTION = TextTable("feedback", "connection")


def message_of(code: str, remarks: Mapping[str, str], language: str = ENGLISH) -> str:
    """The message about a mistake: common to all exercises, then the exercise's own remark.

    Examples
    --------
    >>> message_of("sign", {}), message_of("factor", {"factor": "A half?"})
    ('The sign is wrong.', 'It is off by a factor 2. A half?')
    """
    return f"{MESSAGES.of(language)[code]} {remarks.get(code, '')}".strip()


Json = Mapping[str, Any]


@dataclass(frozen=True)
class QuestionVerdict:
    """The verdict on the answer to one question.

    name: of the question. right: whether the answer is right.
    score: from 0 to 1; the share of right components if there are several.
    message: the feedback to the student.
    diagnosis: code of the likely mistake (see `diagnoses`), empty if there is none.
    also: further codes that fit equally well.
    points: points of a right answer.
    read_as: the answer as parsed, in the notation of solutions; empty if it could not be read.
    """

    name: str
    right: bool
    score: float
    message: str
    diagnosis: str = ""
    also: tuple[str, ...] = ()
    points: int = 1
    read_as: str = ""

    @property
    def was_read(self) -> bool:
        """Whether the answer could be read and checked; otherwise a person must read it."""
        return self.diagnosis not in UNREAD

    @property
    def state(self) -> str:
        """ "right", "wrong", "no answer" or "could not be read".

        Examples
        --------
        >>> QuestionVerdict("legs", False, 0.0, "...", "unreadable").state
        'could not be read'
        """
        if self.right:
            return "right"
        if not self.was_read:
            return TITLES["unreadable"]
        return TITLES["empty"] if self.diagnosis == "empty" else "wrong"

    @property
    def codes(self) -> tuple[str, ...]:
        """All codes that fit."""
        return (self.diagnosis, *self.also) if self.diagnosis else ()


@dataclass(frozen=True)
class Verdict:
    """The verdict on the answers to an exercise.

    number, seed: which exercise. questions: one verdict each, in order.
    notes: remarks about the answers as a whole, such as names that do not match a question.
    language: of the words around the answers.

    Examples
    --------
    >>> legs = QuestionVerdict("legs", True, 1.0, "Right.")
    >>> verdict = Verdict("1.1", 0, (legs,))
    >>> verdict.right, verdict.score
    (True, 1.0)
    >>> unread = QuestionVerdict("metric", False, 0.0, "...", "unreadable", points=3)
    >>> Verdict("1.2", 0, (legs, unread)).points_text
    '1 to 4 of 4 points'
    """

    number: str
    seed: int
    questions: tuple[QuestionVerdict, ...]
    notes: tuple[str, ...] = ()
    language: str = ENGLISH

    @property
    def right(self) -> bool:
        """Whether every answer is right."""
        return all(question.right for question in self.questions)

    @property
    def points(self) -> int:
        """Points of all questions."""
        return sum(question.points for question in self.questions)

    @property
    def unread(self) -> tuple[str, ...]:
        """Names of the questions whose answers could not be read."""
        return tuple(question.name for question in self.questions if not question.was_read)

    @property
    def earned(self) -> float:
        """Earned points; an answer that could not be read earns none until a person reads it."""
        return sum(question.points * question.score for question in self.questions)

    @property
    def at_most(self) -> float:
        """Earned points if every answer that could not be read is right."""
        unread = (question.points for question in self.questions if not question.was_read)
        return self.earned + sum(unread)

    @property
    def score(self) -> float:
        """Earned share of the points, 0 to 1."""
        return self.earned / self.points if self.points else 0.0

    @property
    def points_text(self) -> str:
        """Earned points and all points in words; a range if an answer could not be read."""
        earned, most = f"{self.earned:.3g}", f"{self.at_most:.3g}"
        text = self._text
        share = earned if earned == most else text("range", low=earned, high=most)
        return text("points", earned=share, count=self.points)

    @property
    def _text(self) -> Texts:
        return texts("feedback", "checking", self.language)

    def to_json(self) -> Json:
        """Everything as plain values, ready for json.dumps."""
        return asdict(self)

    @classmethod
    def from_json(cls, data: Json) -> Verdict:
        """The verdict that `to_json` wrote."""
        questions = [
            QuestionVerdict(**{**entry, "also": tuple(entry["also"])})
            for entry in data["questions"]
        ]
        notes = tuple(data["notes"])
        language = data.get("language", ENGLISH)
        return cls(data["number"], data["seed"], tuple(questions), notes, language)

    def __getitem__(self, name: str) -> QuestionVerdict:
        """The verdict on the question with this name.

        Raises
        ------
        UnknownNameError
            There is no such question; the message lists the known ones.
        """
        table = {question.name: question for question in self.questions}
        return table[known_name(name, table, f"exercise {self.number}", UnknownNameError)]

    def _ipython_key_completions_(self) -> list[str]:
        return [question.name for question in self.questions]

    def _repr_html_(self) -> str:
        text, states = self._text, STATES.of(self.language)
        rows = "".join(
            f"<tr><td>{escape(one.name)}</td><td>{escape(states[one.state])}</td>"
            f"<td>{html_of(one.message)}</td><td><code>{escape(one.read_as)}</code></td></tr>"
            for one in self.questions
        )
        heads = (text("question"), text("verdict"), "", text("read_as"))
        head = f"<tr>{''.join(f'<th>{escape(one)}</th>' for one in heads)}</tr>"
        notes = "".join(f"<p>{escape(note)}</p>" for note in self.notes)
        points = f"<p>{self.points_text}</p>"
        return f"<div><table>{head}{rows}</table>{points}{notes}</div>"

    def __repr__(self) -> str:
        words = STATES.of(self.language)
        states = ", ".join(f"{one.name} {words[one.state]}" for one in self.questions)
        return f"Verdict(exercise {self.number}: {self.points_text}; {states})"

    def __str__(self) -> str:
        lines, states = [], STATES.of(self.language)
        for question in self.questions:
            codes = ", ".join(question.codes) if question.state == "wrong" else ""
            code = f" [{codes}]" if codes else ""
            read = f" {self._text('read', answer=question.read_as)}" if question.read_as else ""
            state = states[question.state]
            lines.append(f"{question.name}: {state}{code}. {question.message}{read}")
        return "\n".join([*lines, *self.notes])
