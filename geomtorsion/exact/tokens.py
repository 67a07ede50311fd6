"""Tokens: the text of an expression cut into numbers, names and signs, each with its place."""

from __future__ import annotations

import keyword
import re
from collections.abc import Collection
from dataclasses import dataclass
from fractions import Fraction
from typing import NoReturn

from geomtorsion.errors import ExpressionError, LimitError
from geomtorsion.support.allowance import check_limits
from geomtorsion.support.checks import LARGEST_ARGUMENT, LargestArgument


@dataclass(frozen=True)
class Limits:
    """Limits on the cost of an expression; an error names the exceeded limit.

    characters: length of the text; depth: brackets, signs and powers inside one another;
    exponent: largest numerical exponent; digits: length of any number that is written or formed;
    argument: numbers that functions are taken of.
    """

    characters: int = 2_000_000
    depth: int = 50
    exponent: int = 256
    digits: int = 1000
    argument: LargestArgument = LARGEST_ARGUMENT


@dataclass(frozen=True)
class Token:
    """A piece of the text: kind is "number", "name" or "sign"; start and end are columns."""

    kind: str
    text: str
    start: int
    end: int


@dataclass(frozen=True)
class Source:
    """A text with the name of the place it came from; makes errors that point into it."""

    text: str
    where: str

    def error(self, start: int, end: int, reason: str, remedy: str = "") -> ExpressionError:
        """Return an error that shows the text with a caret under columns start to end."""
        return ExpressionError(self._message(start, end, reason, remedy))

    def limit(self, start: int, end: int, reason: str, remedy: str = "") -> LimitError:
        """Return an error that names the exceeded limit and the position."""
        return LimitError(self._message(start, end, reason, remedy))

    def _message(self, start: int, end: int, reason: str, remedy: str) -> str:
        first, last = max(0, start - 40), min(len(self.text), start + 40)
        before, after = "…" * (first > 0), "…" * (last < len(self.text))
        shown = before + re.sub(r"\s", " ", self.text[first:last]) + after
        indent = " " * (start - first + len(before))
        width = max(1, min(end, last) - start)
        lines = [f"{self.where}: {reason}", f"    {shown}", f"    {indent}{'^' * width}", remedy]
        return "\n".join(lines).rstrip()


_PATTERN = re.compile(
    r"""(?P<space>\s+)
      | (?P<number>[0-9][0-9_]*\.[0-9_]*(?:[eE][+-]?[0-9]+)?
                 | \.[0-9]+(?:[eE][+-]?[0-9]+)?
                 | [0-9][0-9_]*(?:[eE][+-]?[0-9]+)?)
      | (?P<name>[^\W0-9]\w*)
      | (?P<sign>\*\*|//|==|<=|>=|!=|:=|->|[-+*/^(),−·×])
    """,
    re.VERBOSE,
)
_PLAIN = {"^": "**", "−": "-", "·": "*", "×": "*"}
_REFUSED = {
    "//": "floor division is not smooth",
    "%": "a remainder is not smooth",
    ".": "a dot is allowed only between the digits of a number; expressions have no attributes",
    "'": "text in quotes is not part of an expression",
    '"': "text in quotes is not part of an expression",
    "[": "square brackets are not part of an expression; use parentheses",
    "{": "curly brackets are not part of an expression; use parentheses",
    "=": "an expression assigns and compares nothing; write one side only",
}
_CODE = {"eval", "exec", "compile", "open", "input", "getattr", "setattr", "globals", "locals"}
_ALLOWED = "Allowed are integers, names, + - * / ** ^ ( ) and functions such as sin(x)."


def tokens_of(
    source: Source, names: Collection[str], limits: Limits, *, decimals: bool = False
) -> list[Token]:
    """Cut a text into tokens; all but numbers, names and + - * / ** ( ) , is refused.

    decimals: whether 0.1 is a number; otherwise the message offers 1/10.

    Raises
    ------
    ExpressionError
        A sign that has no place in an expression, a decimal number, or a word of a programming
        language that is not among ``names``.
    LimitError
        The text or one of its numbers is longer than ``limits`` allow.
    """
    text = source.text
    if len(text) > limits.characters:
        raise source.limit(
            limits.characters,
            limits.characters + 1,
            f"the expression has {len(text):,} characters; the limit is {limits.characters:,}",
            "Split it, or name its parts with unknown functions.",
        )
    tokens: list[Token] = []
    position = 0
    while position < len(text):
        check_limits()
        match = _PATTERN.match(text, position)
        if match is None:
            _refuse(source, text[position], position, position + 1)
        token = Token(str(match.lastgroup), match.group(), position, match.end())
        if token.kind != "space":
            tokens.append(checked(source, token, names, limits, decimals=decimals))
        position = match.end()
    return tokens


def checked(
    source: Source, token: Token, names: Collection[str], limits: Limits, *, decimals: bool
) -> Token:
    """A token as the parser takes it, from this notation or another; see `tokens_of`.

    kind: "number" (also of a decimal), "name" or "sign".

    Raises
    ------
    ExpressionError
        It has no place in an expression.
    LimitError
        It is longer than ``limits`` allow.
    """
    kind, piece, start, end = token.kind, token.text, token.start, token.end
    if kind == "number" and "_" in piece and not _GROUPED.fullmatch(piece):
        reason = f"{piece[:20]} is not a number: underscores may only separate digits"
        raise source.error(start, end, reason, "Write it without underscores.")
    if kind == "number" and not piece.replace("_", "").isdecimal():
        _check_digits(source, piece, start, end, limits)
        if not decimals:
            piece = piece.replace("_", "")
            raise _decimal(source, piece, start, end)
        piece = piece.replace("_", "")
    elif kind == "number" and len(piece) > limits.digits:
        reason = f"the number has {len(piece):,} digits; the limit is {limits.digits:,}"
        raise source.limit(start, end, reason)
    elif kind == "number":
        piece = piece.replace("_", "").lstrip("0") or "0"
    if kind == "name" and piece not in names:
        _refuse_code(source, piece, start, end)
    if kind == "sign":
        piece = _PLAIN.get(piece, piece)
        if piece not in {"+", "-", "*", "/", "**", "(", ")", ","}:
            _refuse(source, piece, start, end)
    return token if piece == token.text else Token(kind, piece, start, end)


def _refuse(source: Source, sign: str, start: int, end: int) -> NoReturn:
    """Refuse a sign, with the reason where there is a special one."""
    default = "an expression assigns and compares nothing" if len(sign) > 1 else ""
    reason = _REFUSED.get(sign, default) or f"{sign!r} is not part of an expression"
    raise source.error(start, end, reason, _ALLOWED)


def _refuse_code(source: Source, name: str, start: int, end: int) -> None:
    """Refuse words that only code uses."""
    if keyword.iskeyword(name) or name in _CODE:
        reason = f"{name} is a word of the Python language; expressions are not code"
        remedy = f"{_ALLOWED} To use {name} as a symbol, declare it as coordinate or parameter."
        raise source.error(start, end, reason, remedy)
    if name.startswith("_"):
        reason = f"{name} starts with an underscore; expressions are not code"
        raise source.error(start, end, reason, _ALLOWED)


_GROUPED = re.compile(r"[0-9.eE+-]+(?:(?<=[0-9])_(?=[0-9])[0-9.eE+-]+)*")
_EXPONENT = re.compile(r"[eE]([+-]?[0-9]+)$")


def _check_digits(source: Source, piece: str, start: int, end: int, limits: Limits) -> None:
    """Refuse a decimal number that would be a fraction of very many digits."""
    exponent = _EXPONENT.search(piece)
    if len(piece) > limits.digits or (exponent and abs(int(exponent[1])) > limits.digits):
        reason = f"the number {piece[:20]} has more digits than the limit of {limits.digits:,}"
        raise source.limit(start, end, reason)


def _decimal(source: Source, piece: str, start: int, end: int) -> ExpressionError:
    """Return the error that offers the exact rational for a decimal number."""
    exponent = _EXPONENT.search(piece)
    exact = str(Fraction(piece.rstrip(".")))
    if exponent and len(exact) > 40:
        exact = f"{Fraction(piece[: exponent.start()])}*10**({int(exponent[1])})"
    reason = f"{piece} is a decimal number; exact work needs a rational"
    remedy = f"Write {exact} if that is what you mean, or a named parameter."
    return source.error(start, end, reason, remedy)
