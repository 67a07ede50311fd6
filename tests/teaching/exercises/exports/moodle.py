"""Moodle: STACK questions read from XML, and answers of Maxima as students write them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from xml.etree import ElementTree as ET

from geomtorsion.teaching.exercises.entries import split_outside
from geomtorsion.teaching.exercises.exports.maxima import maxima_name
from geomtorsion.teaching.exercises.question import Question, shown_name


def text_of(parent: ET.Element, tag: str) -> str:
    """The text of an element, or of the text element inside it."""
    found = parent.find(tag)
    assert found is not None, tag
    inner = found.find("text")
    return (found.text if inner is None else inner.text) or ""


@dataclass(frozen=True, eq=False)
class StackQuestion:
    """A question of type stack."""

    element: ET.Element

    @property
    def seeds(self) -> list[int]:
        """Seeds of the library, by variant, from the question note."""
        return [int(x) for x in re.findall(r"seed ([0-9]+)", text_of(self.element, "questionnote"))]

    @cached_property
    def variables(self) -> Mapping[str, str]:
        """Name -> the text after the colon."""
        lines = text_of(self.element, "questionvariables").splitlines()
        return dict(line.rstrip(";").split(": ", 1) for line in lines if ": " in line)

    def value(self, name: str, variant: int) -> str:
        """The value of a variable in a variant, counted from 0."""
        text = self.variables[name]
        if not text.endswith("][variant]"):
            return text
        return split_outside(text.removesuffix("[variant]")[1:-1], ",")[variant]

    @property
    def trees(self) -> list[ET.Element]:
        """The potential response trees."""
        return self.element.findall("prt")


def stack_questions(text: str) -> list[StackQuestion]:
    """The questions of a quiz."""
    quiz = ET.fromstring(text)
    assert quiz.tag == "quiz"
    kinds = [question.get("type") for question in quiz]
    assert kinds[0] == "category"
    assert set(kinds) == {"category", "stack"}
    return [StackQuestion(question) for question in quiz if question.get("type") == "stack"]


def as_answered(question: Question, text: str, options: str = "") -> str:
    """A Maxima value in a student's notation: names with primes, three indices as nested lists."""
    names = {maxima_name(x.name): shown_name(x.name) for x in question.domain.symbols}
    text = re.sub(r"[A-Za-z]\w*", lambda match: names.get(match[0], match[0]), text)
    if question.kind == "choice":
        rows = re.findall(r'\[([0-9]+),(?:true|false),"((?:[^"\\]|\\.)*)"\]', options)
        return dict(rows)[text]
    if question.unknowns:
        values = split_outside(text[1:-1], ",")
        pairs = zip(question.unknowns, values, strict=True)
        return "; ".join(f"{name} = {value}" for name, value in pairs)
    if len(question.shape) == 3:
        rows = split_outside(text.removeprefix("matrix(").removesuffix(")"), ",")
        n = question.shape[1]
        blocks = (",".join(rows[k : k + n]) for k in range(0, len(rows), n))
        return f"[{','.join(f'[{block}]' for block in blocks)}]"
    return text
