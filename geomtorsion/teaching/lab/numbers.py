"""numbers: values, names and tables as a page shows them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

from geomtorsion.pictures.style import number
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.texts import ENGLISH, texts


def shown(value: float, error: float = 0.0) -> str:
    """A number for people; zero if it is within its error.

    Examples
    --------
    >>> shown(-0.25), shown(1e-17, 1e-16), shown(float("nan"))
    ('−0.25', '0', '–')
    """
    if not math.isfinite(value):
        return "–"
    return "0" if abs(value) <= PAGE.zero * error else number(value)


def names_text(names: Sequence[str], language: str = ENGLISH) -> str:
    """Names in a list for people.

    Examples
    --------
    >>> names_text(["a", "b", "c"])
    'a, b and c'
    """
    if len(names) < 2:
        return "".join(names)
    text = texts("figures", "figure", language)
    return text("list", first=", ".join(names[:-1]), last=names[-1])


def raised(k: int) -> str:
    """The number of a component, counted from 1, in superscript digits.

    Examples
    --------
    >>> raised(0)
    '¹'
    """
    return str(k + 1).translate(str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹"))


def table(heads: Sequence[str], rows: Sequence[Sequence[str]], caption: str) -> str:
    """A table whose first column names the rows.

    Examples
    --------
    >>> table(("", "b"), [("x", "1")], "it").count("<td")
    1
    """
    head = "".join(f'<th scope="col">{escape(text)}</th>' for text in heads)
    body = "".join(
        f'<tr><th scope="row">{escape(first)}</th>' + "".join(map(_cell, rest)) + "</tr>"
        for first, *rest in rows
    )
    return (
        f'<div class="scroll"><table class="numbers"><caption>{escape(caption)}</caption>'
        f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def _cell(text: str) -> str:
    """A cell; one of several words may wrap, a number such as 5e-11 never does.

    Examples
    --------
    >>> _cell("5e-11"), _cell("two words")
    ('<td>5e-11</td>', '<td class="words">two words</td>')
    """
    kind = ' class="words"' if " " in text else ""
    return f"<td{kind}>{escape(text)}</td>"
