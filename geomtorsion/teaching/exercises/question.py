"""Question: one task, the form of its answer, and its likely mistakes."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import permutations
from math import degrees, radians
from typing import Any

import numpy as np
import sympy

from geomtorsion.geometry import Tensor
from geomtorsion.support.caching import cached_property
from geomtorsion.support.checks import cut
from geomtorsion.teaching.exercises.compare import Index, Value, agrees
from geomtorsion.teaching.exercises.domain import Domain
from geomtorsion.teaching.texts import ENGLISH, texts

KINDS = ("expression", "components", "equations", "number", "choice")
HALF = sympy.Rational(1, 2)
ANGLES = ("rad", "deg")


@dataclass(frozen=True)
class Mistake:
    """A wrong answer that is recognised.

    code: one of `diagnoses.TITLES`. value: the wrong answer, in any form `normal` understands.
    message: the feedback, if the exercise has a better one than the code.
    """

    code: str
    value: Any
    message: str = ""


def _none() -> Iterable[Mistake]:
    return ()


@dataclass(frozen=True, eq=False)
class Question:
    """One task with one answer.

    name: key of the answer. kind: one of KINDS. prompt: Markdown with LaTeX.
    domain: symbols that may be used, with the relations between them.
    answer: computes the right answer with the library at its first use.
    errors: computes the wrong answers that this exercise expects.
    shape: numbers of components, as (3, 3, 3); () for a single one.
    label: name of a component in messages, such as "Gamma".
    marks: position of each index, "_" below and "^" above, in order: "__^" for Gamma_ab^c.
    symmetry: "antisymmetric" or "symmetric" in the first two indices: half may be given.
    unknowns: for equations: the text before the sign of equality, such as "Omega1'".
    unit, tolerance: of numbers; the tolerance is relative to the largest component.
    options: of choices: key -> text.
    generic: mistakes that are tested without being named by the exercise.
    remarks: code of a generic mistake -> sentence to append to its general message.
    points: points of a right answer.
    language: of the messages about answers.
    """

    name: str
    kind: str
    prompt: str
    answer: Callable[[], object]
    domain: Domain = field(default_factory=Domain)
    errors: Callable[[], Iterable[Mistake]] = _none
    shape: tuple[int, ...] = ()
    label: str = ""
    marks: str = ""
    symmetry: str = ""
    unknowns: tuple[str, ...] = ()
    unit: str = ""
    tolerance: float = 1e-3
    options: Mapping[str, str] = field(default_factory=dict)
    generic: tuple[str, ...] = ("sign", "factor", "permuted")
    remarks: Mapping[str, str] = field(default_factory=dict)
    points: int = 1
    language: str = ENGLISH

    @cached_property
    def solution(self) -> Value:
        """The right answer as index -> expression or number; a missing component is zero."""
        return normal(self.answer())

    @property
    def exact(self) -> bool:
        """Whether a number must be exact: its tolerance then covers rounding only."""
        # No question requires this many digits.
        return self.tolerance < 1e-6

    @cached_property
    def mistakes(self) -> tuple[Mistake, ...]:
        """Wrong answers that are recognised, in the order of their tests."""
        return all_mistakes(self)


def normal(value: object) -> Value:
    """Index -> component, from a tensor, a mapping, nested lists, or a single expression.

    Examples
    --------
    >>> normal([0, 5]), normal([[1, 0], [0, 2]]), normal(3)
    ({(1,): 5}, {(0, 0): 1, (1, 1): 2}, {(): 3})
    """
    if isinstance(value, Tensor):
        return {**value.nonzero(), **value.undecided()}
    if isinstance(value, Mapping):
        pairs = {key if isinstance(key, tuple) else (key,): x for key, x in value.items()}
        return {key: x for key, x in pairs.items() if not _is_zero(x)}
    if isinstance(value, sympy.MatrixBase):
        value = sympy.Matrix(value).tolist()
    elif isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, Sequence) and not isinstance(value, str):
        components: dict[Index, Any] = {}
        for k, entry in enumerate(value):
            components |= {(k, *key): x for key, x in normal(entry).items()}
        return components
    return {} if _is_zero(value) else {(): value}


def _is_zero(value: object) -> bool:
    return not isinstance(value, str) and value == 0


def all_mistakes(question: Question) -> tuple[Mistake, ...]:
    """Expected mistakes of the exercise, then generic ones; none equals the solution."""
    own: list[Mistake] = []
    for mistake in question.errors():
        value = normal(mistake.value)
        repeated = any(m.code == mistake.code and m.value == value for m in own)
        if not (repeated or looks_like(question, value, question.solution)):
            own.append(Mistake(mistake.code, value, mistake.message))
    # If the exercise explains why a value is wrong, the general message is dropped.
    better = (question.solution, *(mistake.value for mistake in own))
    generic = [Mistake(m.code, normal(m.value), m.message) for m in _generic(question)]
    return (
        *own,
        *(m for m in generic if not any(looks_like(question, m.value, value) for value in better)),
    )


def looks_like(question: Question, one: Value, two: Value) -> bool:
    """Whether two answers are written alike, or are one number within the tolerance."""
    return one == two or (question.kind == "number" and agrees(question, one, two))


def _generic(question: Question) -> Iterator[Mistake]:
    """Sign, factor 2, permuted indices, and degrees for radians."""
    if question.kind == "choice":
        return
    right = question.solution
    codes = question.generic
    if question.unit in ANGLES:
        for turned in (degrees, radians):
            yield Mistake("degrees", {key: turned(float(x)) for key, x in right.items()})
    if "sign" in codes:
        yield Mistake("sign", scaled(right, -1))
    if "factor" in codes:
        yield Mistake("factor", scaled(right, 2))
        yield Mistake("factor", scaled(right, HALF))
    if {"sign", "factor"} <= set(codes):
        both = texts("feedback", "checking", question.language)("both")
        yield from (Mistake("factor", scaled(right, x), both) for x in (-2, -HALF))
    if "permuted" in codes and question.kind == "components":
        yield from (Mistake("permuted", value) for value in permuted(right, question.shape))


def scaled(value: object, factor: sympy.Expr | float) -> Value:
    """Every component times a factor.

    Examples
    --------
    >>> scaled([1, 0, 3], 2)
    {(0,): 2, (2,): 6}
    """
    return {
        key: float(factor) * x if isinstance(x, float) else factor * x
        for key, x in normal(value).items()
    }


def permuted(value: Value, shape: tuple[int, ...]) -> Iterator[Value]:
    """The components with their indices in every other order."""
    rank = len(shape)
    # Indices of different ranges cannot be exchanged.
    if rank < 2 or len(set(shape)) > 1:
        return
    for order in permutations(range(rank)):
        if order != tuple(range(rank)):
            yield reordered(value, order)


def reordered(value: object, order: tuple[int, ...]) -> Value:
    """Components with their indices in another order; order[k] becomes index k.

    Examples
    --------
    >>> reordered([[1, 2], [0, 3]], (1, 0))
    {(0, 0): 1, (1, 0): 2, (1, 1): 3}
    """
    return {tuple(key[k] for k in order): x for key, x in normal(value).items()}


_NAME = re.compile(r"(\S+) is neither a coordinate nor a declared parameter$", re.MULTILINE)
_DECLARE = re.compile(r"(?:Otherwise d|D)eclare \S+ as a parameter\.\Z")
_FUNCTION = re.compile(r"(?:Otherwise d|D)eclare it as an unknown function with .*\Z")
_SMALLER = re.compile(r"Replace it by a parameter.*\Z")
_PRIMES = re.compile(r"([^\W\d]\w*)\s*(['′’]{1,2}|″)")


def how_to_answer(question: Question, *, options: bool = True) -> str:
    """One line of Markdown: kind of answer, symbols, tolerance, and options.

    Examples
    --------
    >>> from geomtorsion.teaching.exercises import load
    >>> how_to_answer(load("3.2").questions[0])
    'an expression. Use the names `phi1`, `phi2`'
    """
    text = texts("sheets", "answers", question.language)
    if question.kind == "choice":
        choices = (f"`{k}`" + f" ({x})" * options for k, x in question.options.items())
        return text("choice", options=", ".join(choices))
    if question.kind == "number":
        number = text("numbers", count=question.shape[0]) if question.shape else ""
        return f"{number_text(question, number)}, {precision_text(question)}"
    if question.kind == "components":
        form = text(
            "matrix" if len(question.shape) == 2 else "components", example=example(question)
        )
    else:
        form = text("equations") if question.kind == "equations" else text("expression")
    names = [f"`{name}`" for name in symbol_names(question)]
    return f"{form}. {names_to_use(names, question.language)}"


def number_text(question: Question, numbers: str = "") -> str:
    """The word for a number, or the given words for several, with their unit.

    Examples
    --------
    >>> from geomtorsion.teaching.exercises import load
    >>> number_text(load("5.5").questions[0])
    'a number in rad'
    """
    text = texts("sheets", "answers", question.language)
    number = numbers or text("number")
    return text("unit", number=number, unit=question.unit) if question.unit else number


def precision_text(question: Question) -> str:
    """How precise a number must be, in words.

    Examples
    --------
    >>> from geomtorsion.teaching.exercises import load
    >>> precision_text(load("5.5").questions[0])
    'relative tolerance 0.002'
    """
    text = texts("sheets", "answers", question.language)
    if question.exact:
        return text("exactly")
    return text("tolerance", tolerance=f"{question.tolerance:.2g}")


def names_to_use(names: Sequence[str], language: str = ENGLISH) -> str:
    """A sentence about the names in an answer, without its full stop.

    Examples
    --------
    >>> names_to_use(["R"]), names_to_use(["r", "phi"]), names_to_use([])
    ('Use the name R', 'Use the names r, phi', 'Use no symbols')
    """
    text = texts("sheets", "answers", language)
    if not names:
        return text("no_names")
    return text("name" if len(names) == 1 else "names", names=", ".join(names))


def symbol_names(question: Question) -> tuple[str, ...]:
    """The names that may be used, rates written with primes."""
    return tuple(shown_name(symbol.name) for symbol in question.domain.symbols)


def example(question: Question) -> str:
    """How components may be written."""
    rank = len(question.shape)
    if rank == 1:
        return "1 = ...; 2 = ..."
    first, second = ",".join(["1"] * rank), ",".join([*["1"] * (rank - 1), "2"])
    return f"{first} = ...; {second} = ..."


def plain_name(text: str) -> str:
    """Derivatives as names of symbols: r'' becomes r_dd.

    Examples
    --------
    >>> plain_name("Omega1' + r''")
    'Omega1_d + r_dd'
    """
    return _PRIMES.sub(
        lambda match: f"{match[1]}_{'d' * (len(match[2]) + (match[2] == '″'))}", text
    )


def shown_name(text: str) -> str:
    """Names of symbols as derivatives, the inverse of `plain_name`.

    Examples
    --------
    >>> shown_name("Omega1_d + r_dd")
    "Omega1' + r''"
    """
    return re.sub(r"(\w+?)_(d{1,2})\b", lambda match: match[1] + "'" * len(match[2]), text)


def advice(question: Question, message: str, given: str = "") -> str:
    """A message of the parser, with advice for an answer, in which nothing can be declared.

    given: the typed text; it is added if the message shows other signs for it.

    Examples
    --------
    >>> from geomtorsion.teaching.exercises import load
    >>> question = load("3.2").questions[0]
    >>> advice(question, "Did you mean phi2? Otherwise declare phi as a parameter.")
    'Did you mean phi2? Names that may occur here: phi1, phi2.'
    """
    names = ", ".join(symbol_names(question))
    allowed = f"Names that may occur here: {names}." if names else "No names occur in this answer."
    message = _NAME.sub(r"\1 is not a name of this question", message)
    message = _DECLARE.sub(allowed, message)
    message = _FUNCTION.sub("Write it with sin, cos, tan, exp, log, sqrt and the like.", message)
    message = _SMALLER.sub("Write a smaller one.", shown_name(message))
    lines = message.splitlines()
    excerpt = lines[1].strip(" …") if len(lines) > 1 else ""
    if not given or excerpt in re.sub(r"\s", " ", given):
        return message
    return f"{message}\nYou typed: {cut(given, 80)}"
