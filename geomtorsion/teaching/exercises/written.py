"""written: exercises that a teacher writes in TOML, without a program."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NoReturn, TypeVar

import sympy

from geomtorsion.errors import GeomtorsionError
from geomtorsion.geometry import Frame, Tensor
from geomtorsion.pictures.latex import latex_text
from geomtorsion.support.checks import shown
from geomtorsion.support.files import TomlFile
from geomtorsion.teaching.exercises.checking import check_question
from geomtorsion.teaching.exercises.compare import Value, agrees
from geomtorsion.teaching.exercises.domain import Domain
from geomtorsion.teaching.exercises.draw import Draw
from geomtorsion.teaching.exercises.exercise import LEVELS, Variant
from geomtorsion.teaching.exercises.expressions import expression
from geomtorsion.teaching.exercises.question import KINDS, Mistake, Question
from geomtorsion.teaching.exercises.reading import read
from geomtorsion.teaching.exercises.working import Step
from geomtorsion.teaching.texts import Keys, Texts, own_texts, placeholders, with_values

# Keys of an exercise; each other key is the name of a question.
PROSE = ("title", "statement", "hints", "worked")
KEYS = (*PROSE, "level", "function", "values", "coordinates", "coframe", "domain")
QUESTION_KEYS = (
    "prompt", "kind", "answer", "quantity", "mistakes", "points", "label", "shape", "symmetry",
    "unknowns", "unit", "tolerance", "options",
)  # fmt: skip
MISTAKE_KEYS = ("answer", "message")
SYMMETRIES = ("antisymmetric", "symmetric")
# A table of a file.
Table = Mapping[str, Any]
Result = TypeVar("Result")
# Slots of a tensor as marks of a question.
_MARKS = str.maketrans("dDuU", "__^^")


@dataclass(frozen=True, eq=False)
class Written:
    """An exercise as its table in a file.

    file, name: the file and the heading of the table. table: its content. text: its prose.
    """

    file: TomlFile
    name: str
    table: Table
    text: Texts

    @classmethod
    def of(cls, file: TomlFile, name: str) -> Written:
        """The exercise below a heading, its keys and the types of its values checked.

        Raises
        ------
        FileFormatError
            A key is missing or unknown, a value has the wrong type, or a formula is not LaTeX; the
            message names the line.
        """
        table = file.data[name]
        reader = _Reader(file, (name,), table)
        for key in ("title", "statement"):
            reader.take(key, str)
        for key in ("hints", "worked"):
            reader.texts(key)
        level(file, name, table)
        names = [key for key in table if key not in KEYS]
        prose = {key: table[key] for key in PROSE if key in table}
        for key in names:
            if not isinstance(table[key], dict):
                file.unknown((name, key), KEYS, f"{name}: expected a known key, got {key}")
            prose[key] = _question_prose(_Reader(file, (name, key), table[key]))
        if not names:
            file.fail(
                (name,), f"{name}: expected at least one question, got none. Write a table "
                f"[{name}.QUESTION] with the keys prompt and answer."
            )  # fmt: skip
        return cls(file, name, table, own_texts(file, name, prose))

    @property
    def questions(self) -> tuple[str, ...]:
        """Names of the questions, in order."""
        return tuple(key for key in self.table if key not in KEYS)

    def variant(self, draw: Draw) -> Variant:
        """The variant of a draw, its answers read.

        Raises
        ------
        FileFormatError
            A value, the frame, an answer or a mistake cannot be read, or an answer is not accepted
            as right; the message names the line.
        """
        chosen = self._values(draw)
        frame = self._frame(chosen)
        domain = Domain() if frame is None else Domain.of(frame)
        shown_values = {
            key: latex_text(self._read((self.name, "values", key), key, text, domain))
            for key, text in chosen.items()
        }
        prose = _Prose(self.text, shown_values)
        return Variant(
            statement=prose("statement"),
            questions=tuple(
                _Asked(self, name, chosen, prose, frame, domain).question()
                for name in self.questions
            ),
            hints=prose.all("hints"),
            worked=lambda: tuple(Step(text) for text in prose.all("worked")),
        )

    def check(self) -> None:
        """Make the first variants, and refuse a mistake that is right in each of them.

        Raises
        ------
        FileFormatError
            As for `variant`, or a mistake equals the answer.
        """
        # So many seeds select each value of each list.
        count = max(map(len, self.table.get("values", {}).values()), default=1)
        variants = [self.variant(Draw(seed)) for seed in range(count)]
        for name in self.questions:
            asked = [next(q for q in made.questions if q.name == name) for made in variants]
            if "quantity" in self.table[name]:
                continue
            for place, listed in enumerate(zip(*(q.errors() for q in asked), strict=True)):
                pairs = zip(asked, listed, strict=True)
                if all(agrees(q, mistake.value, q.solution) for q, mistake in pairs):
                    self.file.fail(
                        (self.name, name, "mistakes", place, "answer"),
                        "expected a wrong answer, got the right one. Change it, or remove this "
                        "mistake.",
                    )

    def _values(self, draw: Draw) -> dict[str, str]:
        """Name -> the value that the draw chooses, as text."""
        reader = _Reader(self.file, (self.name,), self.table)
        table = reader.take("values", dict, {})
        inner = _Reader(self.file, (self.name, "values"), table)
        return {key: str(draw.choice(inner.options(key))) for key in table}

    def _read(self, path: Keys, where: str, text: str, domain: Domain) -> sympy.Expr:
        """A value as an expression over the coordinates."""
        question = Question(where, "expression", "", lambda: 0, domain)
        return self.guarded(path, lambda: expression(question, text, where))

    def _frame(self, values: Mapping[str, str]) -> Frame | None:
        """The frame of the exercise; without a coframe, the coordinates as a flat space."""
        reader = _Reader(self.file, (self.name,), self.table)
        names = reader.texts("coordinates")
        if not names:
            for key in ("coframe", "domain"):
                if key in self.table:
                    reader.missing("coordinates", "because there is a " + key)
            return None
        n = len(names)
        rows = reader.take("coframe", list, [[int(i == k) for k in range(n)] for i in range(n)])
        domain = [self.filled((self.name, "domain"), x, values) for x in reader.texts("domain")]
        path = (self.name, "coframe")
        entries = [
            [self.filled(path, entry, values) for entry in row] if isinstance(row, list) else row
            for row in rows
        ]
        return self.guarded(
            path if "coframe" in self.table else (self.name, "coordinates"),
            lambda: Frame(list(names), entries, domain=domain or None),
        )

    def filled(self, path: Keys, value: object, values: Mapping[str, str]) -> Any:
        """An expression with the values of its placeholders, each in brackets."""
        if isinstance(value, dict):
            return {key: self.filled(path, inner, values) for key, inner in value.items()}
        if isinstance(value, list):
            return [self.filled(path, inner, values) for inner in value]
        if not isinstance(value, str):
            return value
        known = _known(self.file, path, value, values)
        return with_values(value, {name: f"({text})" for name, text in known.items()})

    def guarded(self, path: Keys, call: Callable[[], Result]) -> Result:
        """The result of a call; an error of the library names the line of a key."""
        try:
            return call()
        except GeomtorsionError as error:
            self.file.fail(path, str(error))


def level(file: TomlFile, name: str, table: Table) -> str:
    """Level of an exercise."""
    word = _Reader(file, (name,), table).take("level", str, "exercise")
    if word not in LEVELS:
        file.unknown((name, "level", word), list(LEVELS), f"expected a level, got {shown(word)}")
    return word


def _question_prose(reader: _Reader) -> dict[str, Any]:
    """The texts of a question; its other keys and their types are checked."""
    table, path = reader.table, reader.path
    for key in table:
        if key not in QUESTION_KEYS:
            reader.file.unknown((*path, key), QUESTION_KEYS, f"unknown key {key}")
    prose = {"prompt": reader.take("prompt", str)}
    if ("answer" in table) == ("quantity" in table):
        got = "both" if "answer" in table else "neither"
        reader.file.fail(
            path, f"{reader.name}: expected an answer or a quantity, got {got}. Write "
            'answer = "r^2", or quantity = "torsion" for a quantity of the coframe.'
        )  # fmt: skip
    options = reader.take("options", dict, {})
    mistakes = reader.take("mistakes", list, [])
    for place, entry in enumerate(mistakes):
        here = (*path, "mistakes", place)
        if not isinstance(entry, dict):
            reader.file.fail(
                here, f"{reader.name}.mistakes: expected tables, got {shown(entry)}. Write "
                f"[[{reader.name}.mistakes]] above the keys answer and message."
            )  # fmt: skip
        inner = _Reader(reader.file, here, entry)
        for key in entry:
            if key not in MISTAKE_KEYS:
                reader.file.unknown((*here, key), MISTAKE_KEYS, f"unknown key {key}")
        for key in MISTAKE_KEYS:
            if key not in entry:
                inner.missing(key)
    notes = [{"message": entry["message"]} for entry in mistakes]
    return (
        prose | ({"options": options} if options else {}) | ({"mistakes": notes} if notes else {})
    )


@dataclass(frozen=True, eq=False)
class _Prose:
    """Texts with the values of a variant."""

    text: Texts
    values: Mapping[str, str]

    def __call__(self, key: str) -> str:
        return self.text(key, **self._used(key))

    def all(self, key: str) -> tuple[str, ...]:
        """The texts of a list; none if there is no such list."""
        return self.text.all(key, **self._used(key)) if key in self.text else ()

    def _used(self, key: str) -> dict[str, str]:
        entry = self.text.entries.get(key, "")
        texts = (entry,) if isinstance(entry, str) else entry
        path = (self.text.heading, *(int(x) if x.isdecimal() else x for x in key.split(".")))
        found: dict[str, str] = {}
        for text in texts:
            found |= _known(self.text.file, path, text, self.values)
        return found


def _known(file: TomlFile, path: Keys, text: str, values: Mapping[str, str]) -> dict[str, str]:
    """The values of the placeholders of a text."""
    for name in sorted(placeholders(text)):
        if name not in values:
            there = ", ".join(f"@{{{key}}}" for key in values) or "none"
            remedy = f"Write {name} = [1, 2, 3] below [{path[0]}.values]."
            file.fail(
                path, f"expected a value of the exercise ({there}), got @{{{name}}}. {remedy}"
            )
    return {name: values[name] for name in placeholders(text)}


@dataclass(frozen=True, eq=False)
class _Asked:
    """A question of a variant: its table, with the chosen values."""

    exercise: Written
    name: str
    values: Mapping[str, str]
    prose: _Prose
    frame: Frame | None
    domain: Domain

    @property
    def path(self) -> Keys:
        return (self.exercise.name, self.name)

    @property
    def table(self) -> Table:
        return self.exercise.table[self.name]

    def question(self) -> Question:
        """The question with its answer and mistakes."""
        bare = self._bare()
        if "quantity" in self.table:
            tensor = self._tensor()
            return replace(bare, answer=lambda: tensor, errors=lambda: self._mistakes(bare))
        answer = self._value(bare, (*self.path, "answer"), self.table["answer"])
        asked = replace(bare, answer=lambda: answer)
        self._accepted(asked)
        mistakes = self._mistakes(bare)
        return replace(asked, errors=lambda: mistakes)

    def _bare(self) -> Question:
        """The question without its answer."""
        reader = _Reader(self.exercise.file, self.path, self.table)
        tensor = self._tensor() if "quantity" in self.table else None
        options = {key: self.prose(f"{self.name}.options.{key}") for key in
                   reader.take("options", dict, {})}  # fmt: skip
        kind = "choice" if options else "expression"
        if tensor is not None and tensor.slots:
            kind = "components"
        shape = tuple(reader.counts("shape"))
        unknowns = reader.texts("unknowns")
        unit = reader.take("unit", str, "")
        kind = "components" if shape and kind == "expression" else kind
        kind = reader.word("kind", KINDS, "equations" if unknowns else "number" if unit else kind)
        needs = {"choice": options, "equations": unknowns}.get(kind, True)
        if not needs or (kind == "components" and not shape and tensor is None):
            key = {"choice": "options", "equations": "unknowns"}.get(kind, "shape")
            reader.missing(key, f"which a question of the kind {kind} needs")
        more: dict[str, Any] = {}
        if "tolerance" in self.table:
            more["tolerance"] = reader.positive("tolerance")
        return Question(
            name=self.name,
            kind=kind,
            prompt=self.prose(f"{self.name}.prompt"),
            answer=lambda: 0,
            domain=self.domain,
            shape=shape if tensor is None else tensor.shape,
            label=reader.take("label", str, ""),
            marks="" if tensor is None else tensor.slots.translate(_MARKS),
            symmetry=reader.word("symmetry", SYMMETRIES, ""),
            unknowns=unknowns,
            unit=unit,
            options=options,
            points=next(iter(reader.counts("points")), 1),
            **more,
        )

    def _tensor(self) -> Tensor:
        """The quantity of the frame that is the answer."""
        path = (*self.path, "quantity")
        name, frame = self.table["quantity"], self.frame
        if frame is None or "coframe" not in self.exercise.table:
            self._fail(("quantity",), "expected a coframe of the exercise, got none. Write "
                       'coordinates = ["r", "phi"] and coframe = [[1, 0], [0, "r"]] below '
                       f"[{self.exercise.name}], or an answer instead of a quantity.")  # fmt: skip
        return self.exercise.guarded(path, lambda: frame.quantity(name))

    def _filled(self, keys: Keys) -> Any:
        """The value of a key inside the table, with the values of the variant."""
        value: Any = self.table
        for key in keys:
            value = value[key]
        return self.exercise.filled((*self.path, *keys), value, self.values)

    def _value(self, bare: Question, path: Keys, given: object) -> Value:
        """An answer, read as the answer of a student is."""
        if isinstance(given, str) and not given.strip():
            self.exercise.file.fail(path, "expected an answer, got an empty text. Write it.")
        typed = self.exercise.filled(path, given, self.values)
        return self.exercise.guarded(path, lambda: read(bare, typed))

    def _accepted(self, asked: Question) -> None:
        """Refuse an answer that the examiner would not accept."""
        verdict = check_question(asked, self._filled(("answer",)))
        if not verdict.right:
            self._fail(("answer",), f"the examiner does not accept this answer: {verdict.message}")

    def _mistakes(self, bare: Question) -> tuple[Mistake, ...]:
        """The mistakes that the table names."""
        return tuple(
            Mistake(
                "another",
                self._value(bare, (*self.path, "mistakes", place, "answer"), entry["answer"]),
                self.prose(f"{self.name}.mistakes.{place}.message"),
            )
            for place, entry in enumerate(self.table.get("mistakes", []))
        )

    def _fail(self, keys: Keys, message: str) -> NoReturn:
        self.exercise.file.fail((*self.path, *keys), message)


@dataclass(frozen=True, eq=False)
class _Reader:
    """Values of a table of a file by type; a value of another type is refused with its line."""

    file: TomlFile
    path: Keys
    table: Table

    @property
    def name(self) -> str:
        """Name of the table."""
        return ".".join(map(str, self.path))

    def missing(self, key: str, reason: str = "") -> NoReturn:
        """Refuse a table without a key."""
        why = f", {reason}" if reason else ""
        self.file.fail(self.path, f"{self.name}: expected the key {key}{why}, got none. Write it.")

    def take(self, key: str, kind: type, default: Any = None) -> Any:
        """A value of one type; a key without default is required."""
        if key not in self.table:
            if default is None:
                self.missing(key)
            return default
        value = self.table[key]
        if type(value) is not kind or (default is None and not value):
            words = {str: "a text in quotes", list: "a list", dict: "a table"}
            self._wrong(key, words[kind])
        return value

    def texts(self, key: str) -> tuple[str, ...]:
        """A list of texts; empty if it is missing."""
        value = self.take(key, list, [])
        if not all(isinstance(x, str) and x.strip() for x in value):
            self._wrong(key, "a list of texts in quotes")
        return tuple(value)

    def options(self, key: str) -> Sequence[str | int]:
        """The values from which a draw chooses."""
        value = self.table[key]
        if not key.isidentifier() or key.lower() != key:
            self.file.fail((*self.path, key), f"{self.name}: expected a name of small letters, "
                           f"digits and _, got {shown(key)}. Rename it.")  # fmt: skip
        if not isinstance(value, list) or not value or {type(x) for x in value} - {str, int}:
            self._wrong(key, "a list of whole numbers and expressions in quotes")
        return value

    def counts(self, key: str) -> list[int]:
        """A whole number from 1, or a list of them; empty if it is missing."""
        value = self.table.get(key, [])
        several = value if isinstance(value, list) else [value]
        if any(type(x) is not int or not 1 <= x <= 100 for x in several):
            self._wrong(key, "whole numbers from 1 to 100")
        return several

    def positive(self, key: str) -> float:
        """A positive number."""
        value = self.table[key]
        if type(value) not in (int, float) or not 0 < value < 1:
            self._wrong(key, "a number between 0 and 1")
        return float(value)

    def word(self, key: str, options: Sequence[str], default: str) -> str:
        """One of several words."""
        value = self.table.get(key, default)
        if value != default and value not in options:
            self.file.unknown((*self.path, key, str(value)), options,
                              f"{self.name}.{key}: unknown word {shown(value)}")  # fmt: skip
        return value

    def _wrong(self, key: str, expected: str) -> NoReturn:
        value = self.table[key]
        self.file.fail(
            (*self.path, key),
            f"{self.name}.{key}: expected {expected}, got {shown(value)}. Write it in this form.",
        )
