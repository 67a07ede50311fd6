"""Markdown: the little of it that statements use, with formulas between dollar signs."""

from __future__ import annotations

import re
from collections.abc import Callable
from html import escape

from geomtorsion.exercises.prose.mathml import mathml_of
from geomtorsion.exercises.prose.plain import lines_of, plain_of

_FORMULA = re.compile(r"\$\$(.+?)\$\$|\$(.+?)\$", re.DOTALL)
_CODE = re.compile(r"`([^`]+)`")
_BOLD = re.compile(r"\*\*(.+?)\*\*", re.DOTALL)


def html_of(markdown: str) -> str:
    """Paragraphs, lists, bold words, code and formulas as HTML; formulas as MathML.

    Examples
    --------
    >>> html_of("Let **x** be `r`, with $r$.")
    '<p>Let <strong>x</strong> be <code>r</code>, with <math><mi>r</mi></math>.</p>'
    """
    return "\n".join(_block(block) for block in re.split(r"\n\s*\n", markdown.strip()))


def _block(block: str) -> str:
    block = block.strip()
    display = re.fullmatch(r"\$\$(.+?)\$\$", block, re.DOTALL)
    if display:
        return f'<div class="scroll">{mathml_of(display[1], display=True)}</div>'
    if block.startswith("- "):
        items = (f"<li>{_inline(item)}</li>" for item in re.split(r"(?:^|\n)- ", block) if item)
        return f"<ul>{''.join(items)}</ul>"
    return f"<p>{_inline(block)}</p>"


def _inline(text: str) -> str:
    """Bold, code and formulas inside a paragraph."""

    def formula(match: re.Match[str]) -> str:
        if match[1]:
            return f'<span class="wide">{mathml_of(match[1], display=True)}</span>'
        return mathml_of(match[2])

    def words(part: str) -> str:
        return _BOLD.sub(r"<strong>\1</strong>", _CODE.sub(r"<code>\1</code>", escape(part)))

    return _with_formulas(text, formula, words)


def text_of(markdown: str) -> str:
    r"""The same as plain text: formulas in Greek letters, marks of Markdown left out.

    Examples
    --------
    >>> text_of(r"Let **x** be `r`, with $\phi_1$.")
    'Let x be r, with φ_1.'
    """

    def formula(match: re.Match[str]) -> str:
        if not match[1]:
            return plain_of(match[2])
        return "\n\n" + "\n".join(f"    {line}" for line in lines_of(match[1])) + "\n\n"

    def words(part: str) -> str:
        return _BOLD.sub(r"\1", _CODE.sub(r"\1", part))

    found = _with_formulas(markdown, formula, words)
    return re.sub(r"\n{3,}", "\n\n", re.sub(r" +$|^ (?=\w)", "", found, flags=re.MULTILINE)).strip()


def _with_formulas(
    text: str, formula: Callable[[re.Match[str]], str], words: Callable[[str], str]
) -> str:
    """Formulas by one rule, what stands between them by another."""
    found, place = [], 0
    # Bold marks may enclose a formula: they are handled with placeholders for the formulas.
    formulas: list[str] = []
    for match in _FORMULA.finditer(text):
        found.append(text[place : match.start()])
        formulas.append(formula(match))
        found.append(f"\0{len(formulas) - 1}\0")
        place = match.end()
    found.append(text[place:])
    whole = words("".join(found))
    return re.sub(r"\0([0-9]+)\0", lambda match: formulas[int(match[1])], whole)
