"""Wording: what a question tells about how it is to be answered."""

from __future__ import annotations

from geomtorsion.exercises.question import Question

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
    from geomtorsion.exercises.reading import shown_name

    return tuple(shown_name(symbol.name) for symbol in question.ground.symbols)


def example(question: Question) -> str:
    """How components may be written."""
    rank = len(question.shape)
    if rank == 1:
        return "1 = ...; 2 = ..."
    first, second = ",".join(["1"] * rank), ",".join([*["1"] * (rank - 1), "2"])
    return f"{first} = ...; {second} = ..."
