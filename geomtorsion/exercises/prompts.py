"""prompts: how a question is to be answered, and what to do where an answer cannot be read."""

from __future__ import annotations

import re

from geomtorsion.checks import cut
from geomtorsion.exercises.question import Question

_NAME = re.compile(r"(\S+) is neither a coordinate nor a declared parameter$", re.MULTILINE)
_DECLARE = re.compile(r"(?:Otherwise d|D)eclare \S+ as a parameter\.\Z")
_FUNCTION = re.compile(r"(?:Otherwise d|D)eclare it as an unknown function with .*\Z")
_SMALLER = re.compile(r"Name it as a parameter.*\Z")
_PRIMES = re.compile(r"([^\W\d]\w*)\s*(['′’]{1,2}|″)")
ASKED = {
    "expression": "an expression",
    "components": "components, indices counted from 1",
    "equations": "equations, separated by semicolons",
    "number": "a number",
    "choice": "one of",
}


def how_to_answer(question: Question, *, options: bool = True) -> str:
    """One line of Markdown: kind of answer, symbols, tolerance, and what can be chosen.

    Examples
    --------
    >>> from geomtorsion.exercises import load
    >>> how_to_answer(load("3.2").questions[0])
    'an expression in `phi1`, `phi2`'
    """
    text = ASKED[question.kind]
    if question.kind == "choice":
        said = (f"`{k}`" + f" ({x})" * options for k, x in question.options.items())
        return f"{text} {', '.join(said)}"
    if question.kind == "number":
        if question.shape:
            text = f"{question.shape[0]} numbers `[x, y, ...]`"
        unit = f" in {question.unit}" if question.unit else ""
        if question.tolerance < 1e-6:
            return f"{text}{unit}, exactly"
        return f"{text}{unit}, relative tolerance {question.tolerance:.2g}"
    if question.kind == "components":
        matrix = " or a matrix `[[...], [...]]`" if len(question.shape) == 2 else ""
        text = f"{text}, as `{example(question)}`{matrix},"
    names = ", ".join(f"`{name}`" for name in symbol_names(question))
    return f"{text} in {names}" if names else f"{text} without symbols"


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
    """The same backwards.

    Examples
    --------
    >>> shown_name("Omega1_d + r_dd")
    "Omega1' + r''"
    """
    return re.sub(r"(\w+?)_(d{1,2})\b", lambda match: match[1] + "'" * len(match[2]), text)


def advice(question: Question, message: str, given: str = "") -> str:
    """A message of the parser, with advice that fits an answer, in which nothing can be declared.

    given: what was written; it is shown where the message shows something else, as it was read.

    Examples
    --------
    >>> from geomtorsion.exercises import load
    >>> question = load("3.2").questions[0]
    >>> advice(question, "Did you mean phi2? Otherwise declare phi as a parameter.")
    'Did you mean phi2? Names that may occur here: phi1, phi2.'
    """
    names = ", ".join(symbol_names(question))
    allowed = f"Names that may occur here: {names}." if names else "No names occur in this answer."
    message = _NAME.sub(r"\1 is no name that occurs in this answer", message)
    message = _DECLARE.sub(allowed, message)
    message = _FUNCTION.sub("Write it with sin, cos, tan, exp, log, sqrt and the like.", message)
    message = _SMALLER.sub("Write a smaller one.", shown_name(message))
    lines = message.splitlines()
    if len(lines) < 2 or not given or cut(given, 80) in lines[1]:
        return message
    return f"{message}\nThat is how your answer was read: {cut(given, 80)}"
