"""Verdict: what an examiner says about an answer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

Json = Mapping[str, Any]


@dataclass(frozen=True)
class QuestionVerdict:
    """What is said about the answer to one question.

    name: of the question. right: whether the answer is right.
    score: from 0 to 1; the share of components that are right where there are several.
    message: what to tell the student.
    diagnosis: code of the likely mistake (see `diagnoses`), empty if there is none.
    also: further codes that fit as well.
    points: what a right answer is worth.
    """

    name: str
    right: bool
    score: float
    message: str
    diagnosis: str = ""
    also: tuple[str, ...] = ()
    points: int = 1

    @property
    def codes(self) -> tuple[str, ...]:
        """All codes that fit."""
        return (self.diagnosis, *self.also) if self.diagnosis else ()


@dataclass(frozen=True)
class Verdict:
    """What is said about the answers to an exercise.

    number, seed: which exercise. questions: one verdict each, in order.
    notes: remarks about the answers as a whole, such as names that no question has.

    Examples
    --------
    >>> verdict = Verdict("1.1", 0, (QuestionVerdict("legs", True, 1.0, "Right."),))
    >>> verdict.right, verdict.score
    (True, 1.0)
    """

    number: str
    seed: int
    questions: tuple[QuestionVerdict, ...]
    notes: tuple[str, ...] = ()

    @property
    def right(self) -> bool:
        """Whether every answer is right."""
        return all(question.right for question in self.questions)

    @property
    def points(self) -> int:
        """What all right answers are worth."""
        return sum(question.points for question in self.questions)

    @property
    def earned(self) -> float:
        """Points that were earned."""
        return sum(question.points * question.score for question in self.questions)

    @property
    def score(self) -> float:
        """Share of the points that was earned, 0 to 1."""
        return self.earned / self.points if self.points else 0.0

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
        return cls(data["number"], data["seed"], tuple(questions), tuple(data["notes"]))

    def __getitem__(self, name: str) -> QuestionVerdict:
        """The verdict on the question of a name."""
        return next(question for question in self.questions if question.name == name)

    def __str__(self) -> str:
        lines = []
        for question in self.questions:
            sign = "right" if question.right else "wrong"
            code = f" [{', '.join(question.codes)}]" if question.codes else ""
            lines.append(f"{question.name}: {sign}{code}. {question.message}")
        return "\n".join([*lines, *self.notes])
