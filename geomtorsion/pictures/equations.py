"""Equations: formulas written as plain text, such as S_{ab}^c = T_{ab}^c/2, as markup."""

from __future__ import annotations

import re
from html import escape

from geomtorsion.pictures.labels import mathml_label
from geomtorsion.pictures.mathml import row

_NAMES = {
    "Gamma_bar": "Γ\u0304", "R_bar": "R\u0304", "D_bar": "D\u0304", "Gamma": "Γ",
    "T_scalar": "T", "omega": "ω", "eta": "η",
}  # fmt: skip
_PLAIN = re.compile("|".join(sorted(_NAMES, key=len, reverse=True)))
_PIECE = re.compile(
    r"(?P<letter>(?:[^\W\d_]|∂)\u0304?'?)(?P<marks>(?:[_^](?:\{[^{}]*\}|\[?[a-z0-9]+\]?))*)"
    r"|(?P<number>[0-9]+)|(?P<space>\s+)|(?P<sign>.)"
)
_STIFF = ' stretchy="false"'
_WORD = re.compile(r"[a-z]{2,}(?![_^\w])")
_MARK = re.compile(r"([_^])(?:\{([^{}]*)\}|(\[?[a-z0-9]+\]?))")


def equation_mathml(text: str) -> str:
    """Markup of a formula with letters, indices, numbers and words.

    Examples
    --------
    >>> equation_mathml("v_a = 0")
    '<mrow><mmultiscripts><mi>v</mi><mi>a</mi><mrow></mrow></mmultiscripts><mo>=</mo><mn>0</mn></mrow>'
    """
    text = _PLAIN.sub(lambda match: _NAMES[match.group()], text)
    parts: list[str] = []
    position = 0
    while position < len(text):
        word = _WORD.match(text, position)
        if word:
            end = _end_of_words(text, word.end())
            parts.append(f"<mtext>{escape(_spaced(text, position, end))}</mtext>")
            position = end
            continue
        match = _PIECE.match(text, position)
        if match is None:
            break
        position = match.end()
        if match["letter"]:
            parts.append(_indexed(match["letter"], match["marks"] or ""))
        elif match["number"]:
            parts.append(f"<mn>{match['number']}</mn>")
        elif match["sign"]:
            sign = "−" if match["sign"] == "-" else match["sign"]
            look = {"/": ' lspace="0" rspace="0"', "(": _STIFF, ")": _STIFF}.get(sign, "")
            parts.append(f"<mo{look}>{escape(sign)}</mo>")
        elif parts and re.match(r"\w|∂|\(", text[position:]) and "</mo>" not in parts[-1][-5:]:
            # A blank between two factors is a thin space.
            parts.append('<mspace width="0.17em"/>')
    return row(*parts)


def _end_of_words(text: str, end: int) -> int:
    """Where a run of words ends."""
    while True:
        more = re.match(r"[ ,]+(?=[a-z]{2,}(?![_^\w]))", text[end:])
        if more is None:
            return end
        word = _WORD.match(text, end + more.end())
        if word is None:
            return end
        end = word.end()


def _spaced(text: str, start: int, end: int) -> str:
    """Words with the blanks around them, which markup would swallow."""
    before = "\u00a0" if start and text[start - 1] == " " else ""
    after = "\u00a0" if text[end : end + 1] == " " else ""
    return before + text[start:end] + after


def _indexed(letter: str, marks: str) -> str:
    """A letter with its indices, each in its own column."""
    prime = letter.endswith("'")
    letter = letter.removesuffix("'")
    if letter.endswith("\u0304"):
        base = f'<mover>{_letter(letter[0])}<mo stretchy="false">¯</mo></mover>'
    else:
        base = _letter(letter)
    if prime:
        base = f'<mrow>{base}<mo lspace="0" rspace="0">′</mo></mrow>'
    slots, written = "", []
    for sign, braced, bare in _MARK.findall(marks):
        for mark in (braced or bare).replace(" ", ""):
            slots += "d" if sign == "_" else "u"
            written.append(f"<mn>{mark}</mn>" if mark.isdigit() else _letter(mark))
    return mathml_label(base, written, slots)


def _letter(letter: str) -> str:
    """A letter: capital Greek ones and brackets upright, all others slanted."""
    upright = not letter.isalpha() or "Α" <= letter <= "Ω"
    return f'<mi mathvariant="normal">{letter}</mi>' if upright else f"<mi>{letter}</mi>"
