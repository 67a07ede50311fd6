"""Notation: expressions as people write them, as tokens of the library's own parser.

Signs are exchanged and omitted products and brackets are added; the parser then checks and reads
the tokens. A text that can be read in two ways is refused, with both readings.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, NoReturn

import sympy

from geomtorsion.errors import ExpressionError, LimitError
from geomtorsion.exact import read_tokens
from geomtorsion.exact.names import CONSTANTS, FUNCTIONS
from geomtorsion.exact.tokens import Limits, Source, Token, checked
from geomtorsion.support.checks import GREEK
from geomtorsion.teaching.exercises.limits import ANSWER
from geomtorsion.teaching.exercises.signs import plain_signs

# Names of functions in other systems.
_OTHER_NAMES = MappingProxyType(
    {
        "tg": "tan", "ctg": "cot", "cotg": "cot", "cotan": "cot", "cosec": "csc", "sen": "sin",
        "arccot": "acot", "arctg": "atan", "arcsinh": "asinh", "arsinh": "asinh",
        "arccosh": "acosh", "arcosh": "acosh", "arctanh": "atanh", "artanh": "atanh",
    }
)  # fmt: skip
_TOKEN = re.compile(
    r"(?P<space>\s+)|(?P<number>[0-9]{1,3}(?:_[0-9]{3})+(?!\w)"
    r"|(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+(?!\w))?)"
    r"|(?P<name>[^\W\d]\w*)|(?P<sign>['\"]+|\*\*|//|[=<>!:]=|->|.)",
    re.DOTALL,
)
_RATE = re.compile(r"\bd\s*([^\W\d]\w*?)\s*/\s*d\s*t\b")
_RATE_OF = re.compile(r"\bd\s*/\s*d\s*t\s*\(?\s*([^\W\d]\w*)\s*\)?")
_SECOND_RATE = re.compile(r"\bd\s*(?:\^|\*\*)\s*\(?2\)?\s*([^\W\d]\w*?)\s*/\s*d\s*t\s*"
                          r"(?:\^|\*\*)\s*\(?2\)?")  # fmt: skip


def read_typed(
    text: str,
    symbols: Mapping[str, sympy.Symbol],
    where: str,
    limits: Limits,
    functions: Mapping[str, Any] = MappingProxyType({}),
    *,
    decimals: bool = True,
) -> sympy.Expr:
    """An expression as people type it; see `parse_expression` for the parameters.

    Products without a sign, functions without brackets, LaTeX, Greek letters and superscripts are
    read; x'' is the symbol x_dd.

    Raises
    ------
    ExpressionError
        It cannot be read, or can be read in two ways; the message gives both.
    LimitError
        It is larger than ``limits`` allow.

    Examples
    --------
    >>> names = dict(zip(("phi1", "r"), sympy.symbols("phi1 r")))
    >>> read_typed("1/2 sin^2 φ_1 + 2r(1 - r)", names, "q", Limits())
    2*r*(1 - r) + sin(phi1)**2/2
    >>> read_typed("sin phi1/2", names, "q", Limits())
    Traceback (most recent call last):
    geomtorsion.errors.ExpressionError: q: 'sin phi1/2' can be read in two ways. Write...
    """
    if len(text) > limits.characters:
        raise LimitError(
            f"{where}: expected at most {limits.characters:,} characters, got {len(text):,}. "
            "Write it shorter."
        )
    source = Source(_with_rates(plain_signs(text, where), symbols), where)
    words = list(_words(source.text, symbols, functions))
    tokens = [
        checked(source, token, {*symbols, *functions}, limits, decimals=decimals)
        for token in _Completer(words, where).tokens()
    ]
    return read_tokens(source, tokens, symbols, functions, limits)


def _with_rates(text: str, names: Mapping[str, object]) -> str:
    """dx/dt and d^2x/dt^2 as x' and x'', where these are names."""

    def rate(match: re.Match[str], order: int) -> str:
        is_name = _rate_name(match[1], order, names)
        return f"({match[1]}{chr(39) * order})" if is_name else match[0]

    text = _SECOND_RATE.sub(lambda match: rate(match, 2), text)
    for pattern in (_RATE, _RATE_OF):
        text = pattern.sub(lambda match: rate(match, 1), text)
    return text


@dataclass(frozen=True)
class _Word:
    """A part of a typed expression.

    kind: number, symbol, function, call (of a function with brackets), sign or unknown.
    text: as the parser takes it. shown: as typed. start: column. spaced: whether a space precedes.
    """

    kind: str
    text: str
    shown: str
    start: int
    spaced: bool = False

    @property
    def starts_value(self) -> bool:
        return self.kind != "sign" or self.text == "("

    @property
    def ends_value(self) -> bool:
        return self.kind in ("number", "symbol", "unknown") or self.text == ")"

    @property
    def end(self) -> int:
        return self.start + len(self.shown)


def _words(text: str, names: Mapping[str, object], functions: Mapping[str, Any]) -> Iterator[_Word]:
    """The parts of a text, with names as the parser knows them."""
    pieces = list(_TOKEN.finditer(text))
    spaced, k = False, 0
    while k < len(pieces):
        match = pieces[k]
        kind, piece, start = str(match.lastgroup), match.group(), match.start()
        k += 1
        if kind == "space":
            spaced = True
            continue
        if kind == "name":
            following = [later.group() for later in pieces[k : k + 3]]
            if piece in functions:
                is_value = isinstance(functions[piece], sympy.Expr) and following[:1] != ["("]
                count, parts = 0, [_Word("symbol" if is_value else "call", piece, piece, 0)]
            else:
                count, parts = _name(piece, following, names)
            k += count
            for part in parts:
                yield replace(part, start=start, spaced=spaced)
                start, spaced = start + len(part.shown), False
        else:
            plain = {"^": "**", "[": "(", "]": ")", "{": "(", "}": ")"}.get(piece, piece)
            yield _Word(kind, plain, piece, start, spaced)
        spaced = False


def _name(
    word: str, following: Sequence[str], names: Mapping[str, object]
) -> tuple[int, list[_Word]]:
    """The number of following pieces that belong to a name, and the words of all."""
    after = following[0] if following else ""
    if after[:1] in ("'", '"'):
        order = len(after.replace('"', "''"))
        rate = _rate_name(word, order, names)
        if rate:
            return 1, [_Word("symbol", rate, word + after, 0)]
        # In rr' the prime belongs to the last name only.
        for cut in range(1, min(len(word), ANSWER.depth)):
            before, rate = _factors(word[:cut], names), _rate_name(word[cut:], order, names)
            if before and rate and before[-1].kind == "symbol":
                return 1, [*before, _Word("symbol", rate, word[cut:] + after, 0)]
        # The parser names a rate that is near, if there are rates at all.
        has_rates = any(name.endswith("_d") for name in names)
        rate = f"{word}_{'d' * order}" if has_rates else word + after
        return 1, [_Word("symbol", rate, word + after, 0)]
    whole = _single(word, names)
    if whole:
        return 0, [whole]
    # phi 2, phi^2 and phi_2 are phi2 where there is no phi.
    if after in ("^", " ") and len(following) > 1 and following[1].isdigit():
        symbol = _symbol(word + following[1], names)
        if symbol:
            return 2, [_Word("symbol", symbol, f"{word}{after}{following[1]}", 0)]
    # sqrt2 and ln2; log2 might be a logarithm to the base 2.
    match = re.fullmatch(r"(sqrt|cbrt|ln|exp)([0-9]+)", word)
    if match:
        return 0, [_Word("function", match[1], match[1], 0), _Word("number", match[2], match[2], 0)]
    return 0, _factors(word, names) or [_Word("unknown", word, word, 0)]


def _single(word: str, names: Mapping[str, object]) -> _Word | None:
    """A word that is a symbol, a constant or a function."""
    symbol = _symbol(word, names)
    if symbol:
        return _Word("symbol", symbol, word, 0)
    for form in (word, word.lower()):
        plain = _OTHER_NAMES.get(form, form)
        if plain in (*FUNCTIONS, "abs"):
            return _Word("function", plain, word, 0)
    if word in CONSTANTS or word in ("e", "Pi", "PI"):
        return _Word("symbol", {"e": "E", "Pi": "pi", "PI": "pi"}.get(word, word), word, 0)
    return None


def _symbol(word: str, names: Mapping[str, object]) -> str:
    """The symbol that a word writes: phi_1, φ1 or phi1; empty if there is none."""
    symbol = next((form for form in _forms(word) if form in names), "")
    dotted = None if symbol else re.fullmatch(r"(\w+?)_?(d?)dot(_?[0-9]*)", word)
    return _rate_name(dotted[1] + dotted[3], 1 + bool(dotted[2]), names) if dotted else symbol


def _rate_name(word: str, order: int, names: Mapping[str, object]) -> str:
    """The symbol of a rate, such as Omega1_d for Ω_1'; empty if there is none."""
    rates = (f"{form}_{'d' * order}" for form in _forms(word))
    return next((rate for rate in rates if rate in names), "")


def _forms(word: str) -> tuple[str, ...]:
    """A word as written, without _, and both with Greek letters by their names."""
    # A small delta before a name is the d of dPhi.
    plain = re.sub(r"^(?:δ|delta_?)(?=[^\W\d])", "d", word)
    plain = "".join(_NAMES_OF_LETTERS.get(sign, sign) for sign in plain)
    return word, word.replace("_", ""), plain, plain.replace("_", "")


_NAMES_OF_LETTERS = {letter: name for name, letter in GREEK.items()}


def _factors(word: str, names: Mapping[str, object]) -> list[_Word]:
    """A word as names side by side, such as Omega2Omega3 or piR; empty if it is anything else.

    If several splits exist, the split with the longest names from the left is taken.
    """
    factors: list[_Word] = []
    longest = max(map(len, (*names, *FUNCTIONS))) + 1
    rest = word if len(word) <= ANSWER.depth else ""
    while rest:
        heads = (rest[:size] for size in range(min(longest, len(rest)), 0, -1))
        factor = next((single for head in heads if (single := _single(head, names))), None)
        if factor is None or (factor.shown in ("e", "E", "I") and len(word) > 1):
            return []
        factors.append(factor)
        rest = rest[len(factor.shown) :]
    # A function only as the last: xsin(...) is x sin(...), but sinx may be a name misspelt.
    called = len(factors) == 2 and factors[0].kind == "function" and factors[1].kind == "symbol"
    inner = any(factor.kind == "function" for factor in factors[:-1])
    repeated = len({factor.text for factor in factors}) < len(factors)
    return factors if called or not (inner or repeated) else []


class _Completer:
    """Adds the omitted products and brackets to the words of an expression."""

    def __init__(self, words: Sequence[_Word], where: str) -> None:
        self.words = words
        self.where = where
        self.result: list[Token] = []
        # For each open bracket: whether a value is in a denominator, and whether this is a
        # fraction of two numbers; and the tokens after the closed bracket.
        self.under: list[str] = [""]
        self.closing: list[str] = [""]

    def tokens(self) -> list[Token]:
        k = 0
        while k < len(self.words):
            k = self._next(k)
        return self.result

    def _at(self, k: int) -> _Word:
        return self.words[k] if 0 <= k < len(self.words) else _Word("end", "", "", 0)

    def _add(self, k: int, code: str) -> None:
        """Append tokens, separated by spaces in `code`, at the columns of word k."""
        start, end = self.words[k].start, self.words[k].end
        for text in code.split():
            kind = (
                "number" if text[0] in "0123456789." else "name" if text.isidentifier() else "sign"
            )
            self.result.append(Token(kind, text, start, end))

    def _next(self, k: int) -> int:
        word, before = self.words[k], self._at(k - 1)
        # An unknown name may be meant as a function: the parser reports that there is none.
        called = before.kind == "unknown" and word.text == "("
        if k and word.starts_value and before.ends_value and not called:
            self._multiply(k)
        if word.kind == "function":
            return self._function(k)
        kind = word.kind if word.kind in ("number", "sign") else "name"
        self.result.append(Token(kind, word.text, word.start, word.end))
        if word.text == "(":
            self.under.append("")
            self.closing.append("")
        elif word.text == ")" and len(self.under) > 1:
            self.under.pop()
            self._add(k, self.closing.pop())
        elif word.text == "/":
            first = self._at(k - 2)
            plain = before.kind == "number" and first.text in ("", "(", "+", "-", ",", "=")
            self.under[-1] = "number" if plain and self._at(k + 1).kind == "number" else "value"
        elif word.kind == "sign" and word.text != "**":
            self.under[-1] = ""
        return k + 1

    def _multiply(self, k: int) -> None:
        """A product sign before word k, unless it is ambiguous."""
        word, before = self.words[k], self._at(k - 1)
        if self.under[-1] == "value" or (self.under[-1] == "number" and not word.spaced):
            below, start = self._group_before(k - 1)
            # A product may be above, of which the last factor is shown.
            above = self._group_before(start - 2)[0] if self._at(start - 1).text == "/" else "..."
            factor = self._factor(k)
            self._ambiguous(k, f"({above}/{below})*{factor} or {above}/({below}*{factor})")
        power = self._at(k - 2).text == "**" and self._at(k - 3).text == "E"
        if power and before.kind == "number":
            factor = self._factor(k)
            self._ambiguous(k, f"exp({before.shown}*{factor}) or exp({before.shown})*{factor}")
        self.under[-1] = ""
        self._add(k, "*")

    def _factor(self, k: int) -> str:
        """The value that begins at word k, for a message: a function with power and argument."""
        word = self.words[k]
        if word.kind not in ("function", "call"):
            return self._group(k)[0]
        text, k = word.shown, k + 1
        if self._at(k).text == "**":
            sign = "-" if self._at(k + 1).text == "-" else ""
            power, k = self._group(k + 1 + len(sign))
            text = f"{text}^{sign}{power}"
        if self._at(k).text == "(":
            return text + self._group(k)[0]
        sign = "-" if self._at(k).text == "-" else ""
        k += len(sign)
        size = 2 if self._at(k).kind == "number" and self._is_name(k + 1) else 1
        argument = "*".join(self._at(j).shown for j in range(k, k + size))
        return f"{text}({sign}{argument or '...'})"

    def _group(self, k: int) -> tuple[str, int]:
        """The text of word k, or of the brackets that it opens if it is short; and its end."""
        depth, end = 0, k
        while end < len(self.words):
            depth += {"(": 1, ")": -1}.get(self.words[end].text, 0)
            end += 1
            if depth <= 0:
                break
        return self._shown(k, end), end

    def _group_before(self, k: int) -> tuple[str, int]:
        """The text that ends with word k, with the function of its brackets; and its start."""
        depth, start = 0, k + 1
        while start > 0:
            start -= 1
            depth += {")": 1, "(": -1}.get(self.words[start].text, 0)
            if depth <= 0:
                break
        start -= self._at(start - 1).kind in ("function", "call") and start <= k
        return self._shown(start, k + 1), start

    def _shown(self, start: int, end: int) -> str:
        """Words as they were typed; brackets without their contents if these are long."""
        text = "".join(word.shown for word in self.words[start:end])
        return text if len(text) <= ANSWER.depth or end == start + 1 else "(...)"

    def _function(self, k: int) -> int:
        """A function with its power after its argument, and with brackets if it has none."""
        place, name = k, self.words[k].text
        power, k = self._power(name, k + 1)
        # The parser has no |x|; the root of a square drops the sign of a real value.
        plain, opening, closing = ("sqrt", "( (", "** 2 )") if name == "abs" else (name, "(", "")
        if self._at(k).text == "(":
            self._add(place, plain)
            self._add(k, opening)
            self.under.append("")
            self.closing.append(f"{closing} {power}")
            return k + 1
        start, sign = k, "-" if self._at(k).text == "-" else ""
        k += len(sign)
        is_number, is_name = self._at(k).kind == "number", self._is_name(k + 1)
        if is_number and is_name and name in ("sqrt", "cbrt"):
            number, symbol = self._at(k).shown, self._at(k + 1).shown
            self._ambiguous(k, f"{name}({number})*{symbol} or {name}({number}*{symbol})")
        size = 2 if is_number and is_name else 1 if is_number or self._is_name(k) else 0
        if not size:
            self._add(place, name)
            return start
        argument = [self._at(j).text for j in range(k, k + size)]
        self._add(place, f"{plain} {opening} {sign}")
        for j, text in enumerate(argument):
            self._add(k + j, f"* {text}" if j else text)
        k += size
        self._add(k - 1, f") {closing} {power}")
        self._check_end(k, name, sign + "*".join(argument))
        return k

    def _is_name(self, k: int) -> bool:
        """Whether word k is a name that may be the argument of a function without brackets."""
        word = self._at(k)
        return word.kind == "symbol" or (word.kind == "unknown" and self._at(k + 1).text != "(")

    def _power(self, name: str, k: int) -> tuple[str, int]:
        """The power between a function and its argument, as in sin^2 x, and where it ends."""
        if self._at(k).text != "**":
            return "", k
        bracket = self._at(k + 1).text == "("
        exponent = self._at(k + 1 + bracket)
        if exponent.text == "-":
            self._ambiguous(k, f"1/{name}(x), or a{name}(x) for the inverse function")
        closed = not bracket or self._at(k + 3).text == ")"
        if exponent.kind != "number" or not closed:
            self._ambiguous(k, f"{name}(x)^2 for a power")
        return f"** {exponent.text}", k + 2 + 2 * bracket

    def _check_end(self, k: int, name: str, argument: str) -> None:
        """Refuse a word that may or may not belong to an argument without brackets."""
        word, after = self._at(k), self._at(k + 1)
        if word.text == "/" and after.kind == "function":
            return
        if word.text in ("**", "/") or (
            word.starts_value and word.kind not in ("function", "call", "end")
        ):
            sign = "^" if word.text == "**" else word.text if word.text == "/" else "*"
            rest = self._factor(k + 1 if word.text in ("**", "/") and after.text else k)
            self._ambiguous(k, f"{name}({argument}){sign}{rest} or {name}({argument}{sign}{rest})")

    def _ambiguous(self, k: int, ways: str) -> NoReturn:
        near = self.words[max(0, k - 3) : k + 5]
        text = "".join(" " * word.spaced + word.shown for word in near).strip()
        raise ExpressionError(f"{self.where}: {text[:60]!r} can be read in two ways. Write {ways}.")
