"""Rewriting: tokens to a text that Python's ast takes at any length, with the way back to columns.

Python's own parser gives up on sums of some thousand terms. Long sums and products are therefore
bracketed in portions, and every name is replaced by a harmless one, so that ``lambda`` may be a
coordinate and no name can mean anything to Python.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field

from geomtorsion.exact.tokens import Limits, Source, Token

_PORTION = 40


@dataclass(frozen=True)
class Rewritten:
    """The rewritten text, its names (new -> written) and, per piece, its column in both texts."""

    text: str
    names: dict[str, str]
    columns: tuple[int, ...]
    pieces: tuple[Token, ...]

    def column(self, offset: int) -> int:
        """Return the column in the written text of an offset in the rewritten one."""
        return self._piece(offset).start

    def end(self, offset: int) -> int:
        """Return the column behind the written piece that holds an offset."""
        return self._piece(offset).end

    def _piece(self, offset: int) -> Token:
        return self.pieces[max(0, bisect_right(self.columns, offset) - 1)]


@dataclass
class _Level:
    """One bracket: arguments done, terms of the sum, factors of the term, part of the factor."""

    opening: Token | None
    call: bool
    done: list[Token] = field(default_factory=list)
    terms: list[list[Token]] = field(default_factory=list)
    factors: list[list[Token]] = field(default_factory=list)
    part: list[Token] = field(default_factory=list)
    nested: int = 0

    def end_factor(self) -> None:
        self.factors.append(self.part)
        self.part, self.nested = [], 0

    def end_term(self) -> None:
        self.end_factor()
        self.terms.append(_in_portions(self.factors))
        self.factors = []

    def end_sum(self) -> None:
        self.end_term()
        self.done += _in_portions(self.terms)
        self.terms = []


def rewrite(source: Source, tokens: Sequence[Token], limits: Limits) -> Rewritten:
    """Check that values and signs alternate and brackets match; bracket long chains in portions.

    Raises
    ------
    ExpressionError
        Empty text, two values without a sign between them, a sign without a value, a bracket
        without its partner.
    LimitError
        More levels inside one another than ``limits.depth``.
    """
    names: dict[str, str] = {}
    levels = [_Level(None, call=False)]
    before: Token | None = None
    for token in tokens:
        level = levels[-1]
        after_value = before is not None and (before.kind != "sign" or before.text == ")")
        _check_place(source, token, before, after_value, level)
        if len(levels) + level.nested > limits.depth:
            reason = f"the expression is nested too deeply; the limit is {limits.depth} levels"
            raise source.limit(token.start, token.end, reason, "Write it flatter.")
        if token.text == "(":
            level.part.append(token)
            levels.append(_Level(token, call=before is not None and before.kind == "name"))
        elif token.text == ")":
            level.end_sum()
            levels.pop()
            levels[-1].part += [*level.done, token]
        elif token.text == ",":
            level.end_sum()
            level.done.append(token)
        elif token.text in "+-" and after_value:
            level.end_term()
            level.part = [token]
        elif token.text in "*/":
            level.end_factor()
            level.part = [token]
        elif token.kind == "name":
            new = names.setdefault(token.text, f"n{len(names)}")
            level.part.append(Token("name", new, token.start, token.end))
        else:
            level.nested += token.kind == "sign"
            level.part.append(token)
        before = token
    _check_end(source, before, levels[-1])
    levels[-1].end_sum()
    return _joined(levels[-1].done, {new: name for name, new in names.items()})


def _joined(pieces: list[Token], names: dict[str, str]) -> Rewritten:
    """Join the pieces with blanks and note at which column each begins."""
    columns, offset = [], 0
    for piece in pieces:
        columns.append(offset)
        offset += len(piece.text) + 1
    text = " ".join(piece.text for piece in pieces)
    return Rewritten(text, names, tuple(columns), tuple(pieces))


def _in_portions(chain: list[list[Token]]) -> list[Token]:
    """Join a chain of signed links; a long one as brackets of brackets, so that no level is long.

    The first link of each portion keeps its sign: + ( - c - d ) and * ( 1 / c / d ).
    """
    while len(chain) > _PORTION:
        chain = [_bracketed(chain[i : i + _PORTION]) for i in range(0, len(chain), _PORTION)]
    return [piece for link in chain for piece in link]


def _bracketed(links: list[list[Token]]) -> list[Token]:
    """One portion of a chain, in brackets, with the sign that joins it to the portion before."""
    first = links[0][0]
    pieces = [piece for link in links for piece in link]
    at = (first.start, first.end)
    close = Token("sign", ")", *at)
    if first.text in ("+", "-"):
        return [Token("sign", "+", *at), Token("sign", "(", *at), *pieces, close]
    if first.text in ("*", "/") and first.kind == "sign":
        one = Token("number", "1", *at)
        return [Token("sign", "*", *at), Token("sign", "(", *at), one, *pieces, close]
    return [Token("sign", "(", *at), *pieces, close]


def _check_place(
    source: Source, token: Token, before: Token | None, after_value: bool, level: _Level
) -> None:
    """Refuse a token that cannot stand where it does."""
    starts_value = token.kind != "sign" or token.text == "("
    if starts_value and after_value and before is not None:
        if token.text == "(" and before.kind == "name":
            return
        reason = f"a sign is missing between {before.text} and {token.text}"
        raise source.error(token.start, token.end, reason, "For a product write *.")
    if starts_value or (token.text in "+-" and token.text):
        return
    empty_call = token.text == ")" and level.call and before is level.opening
    if not after_value and not empty_call:
        reason = f"a number or a name is missing before {token.text}"
        raise source.error(token.start, token.end, reason)
    if token.text == ")" and level.opening is None:
        reason = "this closing bracket has no opening one"
        raise source.error(token.start, token.end, reason)
    if token.text == "," and not level.call:
        reason = "a comma stands only between the arguments of a function"
        raise source.error(token.start, token.end, reason, "A decimal point is no comma either.")


def _check_end(source: Source, last: Token | None, level: _Level) -> None:
    """Refuse a text that ends too early."""
    end = len(source.text)
    if last is None:
        raise source.error(0, 1, "the expression is empty", "Write 0 if it vanishes.")
    if level.opening is not None:
        opening = level.opening
        raise source.error(opening.start, opening.end, "this bracket is never closed")
    if last.kind == "sign" and last.text != ")":
        raise source.error(end, end + 1, f"a number or a name is missing after {last.text}")
