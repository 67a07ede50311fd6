"""Syntax: tokens to a tree of sums, products, powers and calls, by precedence climbing.

First one pass over the tokens checks that values and signs alternate, that brackets match and how
deep they go; the parser then meets no mistake. Sums and products are flat, however long they are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from geomtorsion.exact.names import DERIVATIVE_NAMES, SUBSTITUTION_NAME
from geomtorsion.exact.tokens import Limits, Source, Token

# Calls with brackets of several parts inside, as in Derivative(f(r), (r, 2)).
_WITH_GROUPS = DERIVATIVE_NAMES | {SUBSTITUTION_NAME}


@dataclass(frozen=True)
class Node:
    """A part of an expression.

    kind: "number", "name", "call", "sum", "product", "power" or "group".
    text: the number or the name as written; for a call, the name of the function.
    parts: terms, factors, (base, exponent), arguments, or the entries of a bracket with commas.
    signs: 1 or -1 for each term (plus, minus) or factor (times, by).
    start, end: columns in the text, without brackets around it.
    """

    kind: str
    text: str
    parts: tuple[Node, ...]
    signs: tuple[int, ...]
    start: int
    end: int


def parse(source: Source, tokens: Sequence[Token], limits: Limits) -> Node:
    """The tree of the tokens of a text.

    Raises
    ------
    ExpressionError
        A value or a sign that is missing, a bracket without its partner.
    LimitError
        The tree is deeper than ``limits`` allow.

    Examples
    --------
    >>> from geomtorsion.exact.tokens import tokens_of
    >>> source, limits = Source("1 - 2*r^2", "entry"), Limits()
    >>> node = parse(source, tokens_of(source, {"r"}, limits), limits)
    >>> node.kind, node.signs, [part.kind for part in node.parts]
    ('sum', (1, -1), ['number', 'product'])
    """
    _check(source, tokens, limits)
    return _Parser(tokens).sum()


def with_products(source: Source, tokens: Sequence[Token]) -> list[Token]:
    """The tokens with the signs of products that a text omits, as in 2 r sin(theta).

    A product after a division is refused, with both readings, except after a fraction of numbers
    and a space: 1/2 r. A name before a bracket stays a call.

    Raises
    ------
    ExpressionError
        The text can be read in two ways: 1/2r, 1/r sin(theta), E^2 x.

    Examples
    --------
    >>> from geomtorsion.exact.tokens import tokens_of
    >>> source = Source("1/2 (1 + r)(1 - r)sin(r)", "entry")
    >>> names = [token.text for token in with_products(source, tokens_of(source, {"r"}, Limits()))]
    >>> "".join(names)
    '1/2*(1+r)*(1-r)*sin(r)'
    """
    result: list[Token] = []
    # For each open bracket, whether a value is in a denominator: "", "fraction" or "value".
    under = [""]
    for k, token in enumerate(tokens):
        before = result[-1] if result else None
        if before is not None and _omits_product(before, token):
            _refuse_two_readings(source, result, token, under[-1])
            result.append(Token("sign", "*", token.start, token.start))
            under[-1] = ""
        if token.text == "/":
            under[-1] = "fraction" if _is_fraction(result, tokens[k + 1 : k + 2]) else "value"
        elif token.text in ("+", "-", "*", ",") and (before is None or before.text != "**"):
            under[-1] = ""
        elif token.text == "(":
            under.append("")
        elif token.text == ")" and len(under) > 1:
            under.pop()
        result.append(token)
    return result


def _omits_product(before: Token, token: Token) -> bool:
    """Whether two tokens are factors without a sign between them, and not the start of a call."""
    ends_value = before.kind != "sign" or before.text == ")"
    called = token.text == "(" and before.kind == "name"
    return ends_value and not called and (token.kind == "name" or token.text == "(")


def _refuse_two_readings(source: Source, result: Sequence[Token], token: Token, under: str) -> None:
    """Refuse a factor that may belong to the denominator or the exponent before it."""
    before = result[-1]
    spaced = token.start > before.end
    power = [x.text for x in result[-3:-1]] == ["E", "**"] and before.kind == "number"
    if power or under == "value" or (under and not spaced):
        reason = "this can be read in two ways, because a product has no sign"
        remedy = "Put brackets around the denominator or the exponent, and write *."
        raise source.error(before.start, token.end, reason, remedy)


def _is_fraction(result: Sequence[Token], after: Sequence[Token]) -> bool:
    """Whether a division is between two numbers, the first of them at the start of a term."""
    if not result or not after or not result[-1].kind == after[0].kind == "number":
        return False
    return len(result) == 1 or result[-2].text in "(+-,"


def too_deep(limits: Limits) -> str:
    """Message for brackets that are nested too deeply."""
    return f"the expression is nested too deeply; the limit is {limits.depth} levels"


class _Parser:
    """Reads tokens that were checked, from the loosest sign to the tightest."""

    def __init__(self, tokens: Sequence[Token]) -> None:
        self.tokens = tokens
        self.place = 0

    def at(self, *signs: str) -> bool:
        """Whether one of these signs comes next."""
        here = self.tokens[self.place] if self.place < len(self.tokens) else None
        return here is not None and here.kind == "sign" and here.text in signs

    def taken(self) -> Token:
        """The next token."""
        self.place += 1
        return self.tokens[self.place - 1]

    def made(
        self,
        kind: str,
        first: int,
        parts: Sequence[Node] = (),
        signs: Sequence[int] = (),
        text: str = "",
    ) -> Node:
        """A node that spans all tokens since the first."""
        start, end = self.tokens[first].start, self.tokens[self.place - 1].end
        return Node(kind, text, tuple(parts), tuple(signs), start, end)

    def sum(self) -> Node:
        first, parts, signs = self.place, [self.product()], [1]
        while self.at("+", "-"):
            signs.append(1 if self.taken().text == "+" else -1)
            parts.append(self.product())
        return parts[0] if len(parts) == 1 else self.made("sum", first, parts, signs)

    def product(self) -> Node:
        first, parts, signs = self.place, [self.signed()], [1]
        while self.at("*", "/"):
            signs.append(1 if self.taken().text == "*" else -1)
            parts.append(self.signed())
        return parts[0] if len(parts) == 1 else self.made("product", first, parts, signs)

    def signed(self) -> Node:
        """A factor with its sign: -r**2 is -(r**2)."""
        if not self.at("+", "-"):
            return self.power()
        first, sign = self.place, 1 if self.taken().text == "+" else -1
        return self.made("sum", first, [self.signed()], [sign])

    def power(self) -> Node:
        """A power; r**s**t is r**(s**t), and an exponent may have a sign."""
        first, base = self.place, self.value()
        if not self.at("**"):
            return base
        self.taken()
        return self.made("power", first, [base, self.signed()])

    def value(self) -> Node:
        """A number, a name, a call, or a bracket."""
        first, token = self.place, self.taken()
        if token.text == "(":
            inner = [self.sum()]
            while self.at(","):
                self.taken()
                inner.append(self.sum())
            self.taken()
            return inner[0] if len(inner) == 1 else self.made("group", first, inner)
        if token.kind == "number" or not self.at("("):
            return self.made(token.kind, first, text=token.text)
        self.taken()
        arguments = []
        while not self.at(")"):
            arguments.append(self.sum())
            if self.at(","):
                self.taken()
        self.taken()
        return self.made("call", first, arguments, text=token.text)


@dataclass
class _Level:
    """An open bracket (None: the text itself), and the signs inside its present factor.

    called: the name of the function of which it holds the arguments, or nothing.
    has_commas: whether it may contain commas.
    """

    opening: Token | None
    called: str = ""
    has_commas: bool = False
    nested: int = 0


def _check(source: Source, tokens: Sequence[Token], limits: Limits) -> None:
    """Refuse misplaced tokens, and too many levels."""
    levels = [_Level(None)]
    before: Token | None = None
    for token in tokens:
        level = levels[-1]
        after_value = before is not None and (before.kind != "sign" or before.text == ")")
        _check_place(source, token, before, after_value, level)
        if len(levels) + level.nested > limits.depth:
            raise source.limit(token.start, token.end, too_deep(limits), "Write it flatter.")
        if token.text == "(":
            called = before.text if before is not None and before.kind == "name" else ""
            has_commas = bool(called) or level.called in _WITH_GROUPS
            levels.append(_Level(token, called, has_commas))
        elif token.text == ")":
            levels.pop()
        elif token.text in (",", "*", "/") or (token.text in ("+", "-") and after_value):
            level.nested = 0
        elif token.kind == "sign":
            level.nested += 1
        before = token
    _check_end(source, before, levels[-1])


def _check_place(
    source: Source, token: Token, before: Token | None, after_value: bool, level: _Level
) -> None:
    """Refuse a misplaced token."""
    starts_value = token.kind != "sign" or token.text == "("
    if starts_value and after_value and before is not None:
        if token.text == "(" and before.kind == "name":
            return
        reason = f"a sign is missing between {before.text} and {token.text}"
        raise source.error(token.start, token.end, reason, "For a product write *.")
    if starts_value or token.text in ("+", "-"):
        return
    empty_call = token.text == ")" and level.called and before is level.opening
    if not after_value and not empty_call:
        reason = f"a number or a name is missing before {token.text}"
        raise source.error(token.start, token.end, reason)
    if token.text == ")" and level.opening is None:
        reason = "this closing bracket has no opening one"
        raise source.error(token.start, token.end, reason)
    if token.text == "," and not level.has_commas:
        reason = "a comma is allowed only between the arguments of a function"
        raise source.error(token.start, token.end, reason, "Write decimals with a point.")


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
