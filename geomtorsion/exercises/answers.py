"""answers: what a student gives, read by the whitelist parser; and solutions as texts like it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import sympy

from geomtorsion import checks
from geomtorsion.errors import ExpressionError, LimitError
from geomtorsion.exact import parse_expression
from geomtorsion.exercises.limits import ANSWER, MOST, check_constants
from geomtorsion.exercises.prompts import advice, plain_name, shown_name
from geomtorsion.pictures.text import expression_text

if TYPE_CHECKING:
    from geomtorsion.exercises.compare import Index, Value
    from geomtorsion.exercises.question import Question

# Digits of a number that is written.
DIGITS = 12
_DECIMAL = re.compile(r"(?<![\w.])([0-9]*)\.([0-9]*)(?:[eE]([+-]?[0-9]{1,3}))?(?![\w.])")
_POWER_OF_TEN = re.compile(r"(?<![\w.])([0-9]+)[eE]([+-]?[0-9]{1,3})(?![\w.])")


def expression(question: Question, given: object, where: str) -> sympy.Expr:
    """One expression over the symbols of a question.

    Raises
    ------
    ExpressionError
        It is no text, or cannot be read; the message shows where.
    LimitError
        It is longer, deeper or has larger numbers than an answer may.
    """
    if isinstance(given, int) and not isinstance(given, bool):
        given = str(given) if abs(given) < 10**ANSWER.digits else "1" * (ANSWER.digits + 1)
    if isinstance(given, float):
        given = repr(given)
    if not isinstance(given, str):
        raise ExpressionError(
            f"{where}: an expression in quotes was needed, but {_kind(given)} came. Write for "
            'instance "sin(x)/2".'
        )
    if len(given) > ANSWER.characters:
        raise LimitError(
            f"{where}: {len(given):,} characters; the limit is {ANSWER.characters:,}. "
            "Write it shorter."
        )
    # Decimals become fractions first: the parser of exact expressions refuses them.
    text = plain_name(rational(given))
    check_constants(text, question.domain.names, where, ANSWER)
    try:
        return parse_expression(text, question.domain.names, {}, where=where, limits=ANSWER)
    except (ExpressionError, LimitError) as error:
        raise type(error)(advice(question, str(error))) from None


def rational(text: str) -> str:
    """Text with its decimals as fractions: 0.25 is read as what it says.

    Examples
    --------
    >>> rational("0.25*x + 1e-3")
    '(25/100)*x + (1/1000)'
    """
    return _POWER_OF_TEN.sub(_scaled, _DECIMAL.sub(_fraction, text))


def _fraction(match: re.Match[str]) -> str:
    whole, part, exponent = match[1] or "", match[2] or "", int(match[3] or 0)
    if not whole + part or len(whole + part) > ANSWER.digits or abs(exponent) > ANSWER.digits:
        return match[0]
    return _over(int(whole + part), exponent - len(part))


def _scaled(match: re.Match[str]) -> str:
    exponent = int(match[2])
    if len(match[1]) > ANSWER.digits or abs(exponent) > ANSWER.digits:
        return match[0]
    return _over(int(match[1]), exponent)


def _over(digits: int, exponent: int) -> str:
    return f"({digits}{'0' * exponent})" if exponent >= 0 else f"({digits}/1{'0' * -exponent})"


def components(question: Question, given: object, where: str) -> dict[Index, sympy.Expr]:
    """Components by their indices, from a table, nested lists, or a text that writes one of them.

    A table or text names components: ``{"1,2,1" = "1/r"}`` or ``1,2,1 = 1/r; 2,1,1 = 0``; indices
    are counted from 1 or named by coordinates; what is not listed is zero. A list gives them all:
    ``[[1, 0], [0, "r"]]``.

    Raises
    ------
    ExpressionError
        An index or an expression cannot be read.
    LimitError
        There are more entries than components, or an expression is too large.
    """
    if isinstance(given, str):
        given = _from_text(given, where)
    if isinstance(given, int) and not isinstance(given, bool) and given == 0:
        return {}
    if isinstance(given, Mapping):
        pairs = [(index(question, key, where), value) for key, value in given.items()]
    elif isinstance(given, list):
        pairs = _flat(given, question.shape, where)
    elif question.shape in ((), (1,)):
        pairs = [((0,) * len(question.shape), given)]
    else:
        raise ExpressionError(
            f"{where}: components were needed, but {_kind(given)} came. Write for instance "
            f'"{_example(question)}", or a list of lists.'
        )
    if len(pairs) > MOST.entries:
        raise LimitError(f"{where}: {len(pairs)} entries; the limit is {MOST.entries}.")
    found: dict[Index, sympy.Expr] = {}
    for key, value in pairs:
        name = f"{where}[{','.join(str(k + 1) for k in key)}]"
        if key in found:
            raise ExpressionError(f"{name} is given twice. Give it once.")
        found[key] = expression(question, value, name)
    return found


def index(question: Question, key: object, where: str) -> Index:
    """Indices counted from 0, from a text that counts from 1 or names coordinates.

    ``1,2,1``, ``121``, ``Gamma_12^1``, ``Gamma[1, 2, 1]`` and ``phi1,phi2,phi1`` all will do.
    """
    text = str(key)[:200]
    inside = re.sub(r"^\s*[^\W\d_]+(?=[\[({_^])", "", text) if not _names(question, text) else text
    parts = [part for part in re.split(r"[\s,_^{}\[\]()]+", inside) if part]
    rank = len(question.shape)
    if all(part.isdigit() for part in parts) and len("".join(parts)) == rank:
        parts = list("".join(parts))
    names = list(question.domain.names)
    symbols = list(question.domain.symbols)
    found = []
    for k, part in enumerate(parts):
        if part.isdecimal() and len(part) < 4:
            found.append(int(part) - 1)
        elif part in names:
            found.append(symbols.index(question.domain.names[part]))
        else:
            raise ExpressionError(
                f"{where}: {part!r} is no index {k + 1}. Indices are numbers counted from 1, as in "
                f"{_example(question)}."
            )
    if len(found) != rank:
        raise ExpressionError(
            f"{where}: {text!r} has {len(found)} indices; needed are {rank}, as in "
            f"{_example(question)}."
        )
    for k, (number, size) in enumerate(zip(found, question.shape, strict=True)):
        if number >= size or (number < 0 and number != -1):
            raise ExpressionError(
                f"{where}: index {k + 1} of {text!r} is {number + 1}, but runs from 1 to {size}."
            )
    return tuple(found)


def _names(question: Question, text: str) -> bool:
    """Whether an index names coordinates."""
    return any(part in question.domain.names for part in re.split(r"[\s,_^{}\[\]()]+", text))


def completed(given: Value, symmetry: str) -> dict[Index, Any]:
    """With the components that follow from those given by exchanging the first two indices.

    Examples
    --------
    >>> completed({(0, 1): 5}, "antisymmetric")
    {(0, 1): 5, (1, 0): -5}
    """
    found = dict(given)
    sign = {"antisymmetric": -1, "symmetric": 1}.get(symmetry)
    for key, value in given.items() if sign else ():
        found.setdefault((key[1], key[0], *key[2:]), sign * value)
    return found


def _from_text(text: str, where: str) -> object:
    """A table or nested lists from a text; a single expression stays text."""
    if len(text) > MOST.characters:
        raise LimitError(
            f"{where}: {len(text):,} characters; the limit is {MOST.characters:,}. "
            "Write it shorter."
        )
    text = text.strip()
    if text.startswith("["):
        return _listed(text, where)
    if "=" not in text:
        return 0 if text == "0" else text
    table: dict[str, str] = {}
    for line in re.split(r"[;\n]", text):
        if not line.strip():
            continue
        key, sign, value = line.partition("=")
        if not sign or not value.strip():
            raise ExpressionError(
                f"{where}: {line.strip()[:60]!r} names no component. Write index = value, one "
                "after the other, separated by semicolons."
            )
        if key.strip() in table:
            raise ExpressionError(f"{where}: {key.strip()[:60]} is given twice. Give it once.")
        table[key.strip()] = value.strip()
    return table


def _listed(text: str, where: str) -> list[object]:
    """Nested lists of expressions from a text in square brackets."""
    stack: list[list] = [[]]
    word, depth = "", 0
    for sign in text:
        # No tensor here has more indices; deeper lists are written to exhaust the reader.
        if sign == "[":
            if len(stack) > 6:
                raise LimitError(f"{where}: more than 6 lists inside one another. Flatten it.")
            stack.append([])
            word = ""
        elif sign in ",]" and depth == 0:
            if word.strip():
                stack[-1].append(word.strip().strip("\"'"))
            word = ""
            if sign == "]":
                if len(stack) < 2:
                    raise ExpressionError(f"{where}: a bracket ] is closed that was not opened.")
                done = stack.pop()
                stack[-1].append(done)
        else:
            depth += (sign == "(") - (sign == ")")
            word += sign
    if len(stack) != 1 or len(stack[0]) != 1 or word.strip():
        raise ExpressionError(f"{where}: the brackets [ ] do not pair up. Write [[a, b], [c, d]].")
    return stack[0][0]


def _flat(given: list, shape: tuple[int, ...], where: str) -> list[tuple[Index, object]]:
    """Pairs (index, entry) of nested lists, which must have the shape of the question."""
    if not shape or len(given) != shape[0]:
        needed = " x ".join(map(str, shape)) or "one expression"
        raise ExpressionError(
            f"{where}: a list of {len(given)} entries came where the shape is {needed}."
        )
    if len(shape) == 1:
        return [((k,), entry) for k, entry in enumerate(given)]
    found: list[tuple[Index, object]] = []
    for k, row in enumerate(given):
        if not isinstance(row, list):
            raise ExpressionError(f"{where}[{k + 1}]: a list was needed, but {_kind(row)} came.")
        found += [((k, *key), x) for key, x in _flat(row, shape[1:], f"{where}[{k + 1}]")]
    return found


def _example(question: Question) -> str:
    """A component as it may be written."""
    return ",".join("1" for _ in question.shape) + " = ..."


def _kind(value: object) -> str:
    """What an answer is, in a few words."""
    names = {bool: "true or false", list: "a list", dict: "a table", type(None): "nothing"}
    return names.get(type(value), f"{type(value).__name__} {str(value)[:40]}")


def answer_text(question: Question, value: Value) -> str:
    """A value as text that `Exercise.check` reads back.

    Examples
    --------
    >>> from geomtorsion.exercises import load
    >>> question = load("1.1").questions[0]
    >>> answer_text(question, {(0, 0): sympy.Integer(1), (1, 1): 1 / sympy.Symbol("r")})
    '1,1 = 1; 2,2 = 1/r'
    """
    if question.kind == "choice":
        return str(value[()])
    if question.kind == "equations":
        return "; ".join(
            f"{name} = {component_text(value.get((k,), 0))}"
            for k, name in enumerate(question.unknowns)
        )
    if not question.shape:
        text = component_text(value.get((), 0))
        return f"{text} {question.unit}".strip()
    if question.kind == "number":
        largest = max((abs(float(x)) for x in value.values()), default=0.0)
        kept = {key: x for key, x in value.items() if abs(float(x)) > 10**-DIGITS * largest}
        parts = [component_text(kept.get((k,), 0)) for k in range(question.shape[0])]
        return f"[{', '.join(parts)}]"
    pairs = [f"{','.join(str(k + 1) for k in key)} = {component_text(x)}" for key, x in
             sorted(value.items())]  # fmt: skip
    return "; ".join(pairs) or "0"


def component_text(value: object) -> str:
    """One expression or number as text without Greek letters."""
    if isinstance(value, float):
        return f"{value:.{DIGITS}g}"
    return shown_name(expression_text(checks.expression(value), greek=False))
