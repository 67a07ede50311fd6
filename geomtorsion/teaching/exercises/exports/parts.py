"""parts: questions in all their variants as fields, variables and response trees of STACK."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from string import ascii_lowercase

import sympy

from geomtorsion.support.caching import cached_property
from geomtorsion.teaching.exercises.answers import without_rounding
from geomtorsion.teaching.exercises.checking import ROUNDED
from geomtorsion.teaching.exercises.compare import Value, largest
from geomtorsion.teaching.exercises.exercise import Exercise
from geomtorsion.teaching.exercises.exports.maxima import (
    maxima_list,
    maxima_matrix,
    maxima_name,
    maxima_text,
)
from geomtorsion.teaching.exercises.exports.tasks import can_be_rounded, feedback
from geomtorsion.teaching.exercises.question import (
    Mistake,
    Question,
    looks_like,
    names_to_use,
    number_text,
    precision_text,
)
from geomtorsion.teaching.texts import texts

# Replaces a mistake that only other variants have; no answer is equal to it.
MISSING = "nomistake"


@dataclass(frozen=True, eq=False)
class Slot:
    """A mistake in all variants.

    note: its code, numbered if a question has several mistakes of one code. variable: its value.
    mistakes: one for each variant, None if the variant does not have it. messages: the feedback.
    tested: whether every variant has it and nothing before it in the tree is equal to it.
    """

    note: str
    variable: str
    mistakes: tuple[Mistake | None, ...]
    messages: tuple[str, ...]
    tested: bool


@dataclass(frozen=True, eq=False)
class Part:
    """A question of an exercise in all variants.

    place: among the questions, from 1. first: number of its first field.
    questions: one for each variant, of one kind and shape.
    """

    place: int
    first: int
    questions: tuple[Question, ...]

    @property
    def kind(self) -> str:
        """Kind of the questions."""
        return self.questions[0].kind

    @property
    def shape(self) -> tuple[int, ...]:
        """Numbers of components."""
        return self.questions[0].shape

    @property
    def points(self) -> int:
        """Points of a right answer."""
        return self.questions[0].points

    @property
    def tree(self) -> str:
        """Name of the response tree."""
        return f"prt{self.place}"

    @property
    def solution(self) -> str:
        """Name of the variable that holds the solution."""
        return f"ta{self.place}"

    @property
    def field(self) -> str:
        """Type of the fields."""
        if self.kind == "choice":
            return "dropdown"
        return "matrix" if self.shape else "algebraic"

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the fields: one for each unknown, or for each first index of three."""
        count = len(self.questions[0].unknowns) or (self.shape[0] if self._stacked else 1)
        return tuple(f"ans{self.first + k}" for k in range(count))

    @property
    def _stacked(self) -> bool:
        return len(self.shape) > 2

    @property
    def labels(self) -> tuple[str, ...]:
        """The label before each field, HTML."""
        question = self.questions[0]
        if question.unknowns:
            return tuple(f"<code>{escape(maxima_name(x))}</code> =" for x in question.unknowns)
        if self._stacked:
            text = texts("sheets", "stack", question.language)
            return tuple(escape(text("index", number=k + 1)) for k in range(self.shape[0]))
        return ("",)

    @property
    def words(self) -> tuple[str, ...]:
        """Names of symbols that may be typed."""
        symbols = (symbol.name for q in self.questions for symbol in q.domain.symbols)
        return tuple(dict.fromkeys(map(maxima_name, symbols)))

    @property
    def relations(self) -> tuple[str, ...]:
        """Relations between symbols in every variant."""
        lists = [[_relation(x) for x in question.domain.relations] for question in self.questions]
        return tuple(x for x in lists[0] if all(x in other for other in lists))

    @property
    def zeros(self) -> str:
        """The initial content of the boxes of a field."""
        return maxima_matrix({}, self.shape[-2:])

    def how(self) -> list[str]:
        """How to answer, for each variant."""
        return [self._how(question) for question in self.questions]

    def _how(self, question: Question) -> str:
        text = texts("sheets", "stack", question.language)
        if self.kind == "choice":
            return text("choice")
        if self.kind == "number":
            number = text("numbers", count=question.shape[0]) if question.shape else ""
            return text(
                "number", number=number_text(question, number), precision=precision_text(question)
            )
        if self.kind == "equations":
            sentences = [text("equations")]
        else:
            sentences = [text("components") if self.shape else text("expression")]
        names = [maxima_name(symbol.name) for symbol in question.domain.symbols]
        if names:
            sentences.append(f"{names_to_use(names, question.language)}.")
        if any(symbol.name.endswith("_d") for symbol in question.domain.symbols):
            sentences.append(text("derivative"))
        return " ".join(sentences)

    # -- values ---------------------------------------------------------------------------------

    def _written(self, question: Question, value: Value) -> str:
        """A value as Maxima has it, in the form in which answers are compared."""
        if self.kind == "choice":
            return str(list(question.options).index(str(value[()])) + 1)
        if question.unknowns:
            return maxima_list(value, len(question.unknowns))
        if not self.shape:
            return maxima_text(value.get((), 0))
        if self.kind == "number":
            return maxima_list(without_rounding(value), self.shape[0])
        return maxima_matrix(value, self.shape)

    def variables(self) -> Iterator[tuple[str, list[str]]]:
        """Name -> one text for each variant: solution, tolerance, options, mistakes."""
        pairs = [(q, self._written(q, q.solution)) for q in self.questions]
        yield self.solution, [text for _, text in pairs]
        if self.kind == "choice":
            yield f"options{self.place}", [_options(q, int(text)) for q, text in pairs]
        if self.tolerance:
            sizes = [largest(question.solution) for question in self.questions]
            yield (
                self.tolerance,
                [f"{q.tolerance * x:.12g}" for q, x in zip(self.questions, sizes, strict=True)],
            )
            if self.rounding:
                yield self.rounding, [f"{ROUNDED * x:.12g}" for x in sizes]
        for slot in self.slots:
            yield (
                slot.variable,
                [
                    MISSING if mistake is None else self._written(question, mistake.value)
                    for question, mistake in zip(self.questions, slot.mistakes, strict=True)
                ],
            )

    @property
    def tolerance(self) -> str:
        """Name of the variable that holds the tolerance; empty where answers are exact."""
        return f"tol{self.place}" if self.kind == "number" else ""

    @property
    def rounding(self) -> str:
        """Name of the variable with the effect of rounding; empty if rounding is not a mistake."""
        return f"near{self.place}" if all(map(can_be_rounded, self.questions)) else ""

    def shown(self, variable: str, place: int) -> str:
        """The teacher's answer in the syntax of a field."""
        return f"options{self.place}" if self.kind == "choice" else self.typed(variable, place)

    def typed(self, variable: str, place: int) -> str:
        """The text to type into a field for the value of a variable."""
        if self.questions[0].unknowns:
            return f"{variable}[{place + 1}]"
        if self._stacked:
            rows = self.shape[1]
            first, last = rows * place + 1, rows * (place + 1)
            return f"apply(matrix,makelist({variable}[ma],ma,{first},{last}))"
        if self.shape and self.kind == "number":
            return f"matrix({variable})"
        return variable

    # -- answers --------------------------------------------------------------------------------

    def feedback_variables(self) -> Iterator[str]:
        """Variables that are computed from the fields before the comparison."""
        if self.questions[0].unknowns:
            yield f"given{self.place}: [{','.join(self.inputs)}];"
        elif self.shape and self.kind == "number":
            yield f"given{self.place}: first(args({self.inputs[0]}));"
        elif self._stacked:
            rows = ",".join(f"args({name})" for name in self.inputs)
            yield f"given{self.place}: apply(matrix,append({rows}));"
        elif self.shape:
            yield f"given{self.place}: {self.inputs[0]};"
        if self._sign:
            yield f"full{self.place}: {self._completed()};"

    @property
    def _sign(self) -> str:
        signs = {"symmetric": "", "antisymmetric": "-"}
        kinds = {signs.get(question.symmetry, "none") for question in self.questions}
        return kinds.pop() + " " if len(kinds) == 1 and "none" not in kinds else ""

    def _completed(self) -> str:
        """The matrix whose zero components are filled by exchanging the first two indices."""
        # All boxes contain zeros at the start, so a typed zero cannot be distinguished from them.
        # Index names have two letters, since i is the imaginary unit in STACK.
        n, matrix, sign = self.shape[0], f"given{self.place}", self._sign.strip()
        if not self._stacked:
            entry, other = f"{matrix}[ma,mb]", f"{sign}{matrix}[mb,ma]"
            rows = f"makelist(makelist(@,mb,1,{n}),ma,1,{n})"
        else:
            entry, other = f"{matrix}[{n}*(ma-1)+mb,mc]", f"{sign}{matrix}[{n}*(mb-1)+ma,mc]"
            row = f"makelist(@,mc,1,{self.shape[-1]})"
            rows = f"apply(append,makelist(makelist({row},mb,1,{n}),ma,1,{n}))"
        filled = f"if is({entry}=0) then {other} else {entry}"
        return f"apply(matrix,{rows.replace('@', filled)})"

    @property
    def given(self) -> str:
        """The value that is compared with the solution."""
        if self._sign:
            return f"full{self.place}"
        return f"given{self.place}" if self.shape or self.questions[0].unknowns else self.inputs[0]

    def compared(self, slot: Slot) -> str:
        """The value that is compared with a mistake: as typed if the mistake lacks the symmetry."""
        if self._sign and not all(
            mistake is None or _has_symmetry(mistake.value, -1 if self._sign == "- " else 1)
            for mistake in slot.mistakes
        ):
            return f"given{self.place}"
        return self.given

    @cached_property
    def slots(self) -> tuple[Slot, ...]:
        """Mistakes in the order of their tests, variants side by side."""
        tables = [_numbered(question) for question in self.questions]
        keys = dict.fromkeys(key for table in tables for key in table)
        slots: list[Slot] = []
        for letters, key in zip(_letters(), keys, strict=False):
            mistakes = tuple(table.get(key) for table in tables)
            messages = tuple(
                "" if mistake is None else feedback(question, mistake)
                for question, mistake in zip(self.questions, mistakes, strict=True)
            )
            code, number = key
            note = code.replace(" ", "-") + (f"-{number}" if number > 1 else "")
            tested = None not in mistakes and not any(
                self._meet(mistakes, before.mistakes) for before in slots
            )
            slots.append(Slot(note, f"w{letters}{self.place}", mistakes, messages, tested))
        return tuple(slots)

    def _meet(self, one: Sequence[Mistake | None], two: Sequence[Mistake | None]) -> bool:
        """Whether two mistakes are the same answer in some variant."""
        return any(
            a is not None and b is not None and looks_like(question, a.value, b.value)
            for question, a, b in zip(self.questions, one, two, strict=True)
        )


def _letters() -> Iterator[str]:
    """a, b, ..., z, aa, ab, ...: names of STACK may have digits only at their end."""
    yield from ascii_lowercase
    yield from (one + two for one in ascii_lowercase for two in ascii_lowercase)


def _numbered(question: Question) -> dict[tuple[str, int], Mistake]:
    """(code, number among the mistakes with this code) -> mistake."""
    seen: Counter[str] = Counter()
    numbered: dict[tuple[str, int], Mistake] = {}
    for mistake in question.mistakes:
        seen[mistake.code] += 1
        numbered[mistake.code, seen[mistake.code]] = mistake
    return numbered


def _has_symmetry(value: Value, sign: int) -> bool:
    """Whether exchanging the first two indices reproduces a value, times the sign."""
    exchanged = {(key[1], key[0], *key[2:]): x for key, x in value.items()}
    return all(value.get(key, 0) - sign * x == 0 for key, x in exchanged.items())


def _options(question: Question, right: int) -> str:
    """The options, in STACK's form: value, whether it is right, displayed text."""
    rows = []
    for place, text in enumerate(question.options.values(), 1):
        shown = text.replace("\\", "\\\\").replace('"', '\\"')
        rows.append(f'[{place},{str(place == right).lower()},"{shown}"]')
    return f"[{','.join(rows)}]"


def _relation(relation: sympy.core.relational.Relational) -> str:
    """An inequality between symbols."""
    sign = {"StrictGreaterThan": ">", "StrictLessThan": "<", "GreaterThan": ">=",
            "LessThan": "<="}[type(relation).__name__]  # fmt: skip
    return f"{maxima_text(relation.lhs)}{sign}{maxima_text(relation.rhs)}"


def parts_of(group: Sequence[Exercise]) -> tuple[Part, ...]:
    """The questions of an exercise, each in all its variants; fields are numbered throughout."""
    parts: list[Part] = []
    first = 1
    for place, questions in enumerate(zip(*(x.questions for x in group), strict=True), 1):
        part = Part(place, first, questions)
        first += len(part.inputs)
        parts.append(part)
    return tuple(parts)
