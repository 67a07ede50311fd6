"""Notation: answers as people write them, rewritten in the syntax of the parser.

Only signs are exchanged and added here; the result still passes the whitelist. A text that
can be read in two ways is refused, with both readings.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from types import MappingProxyType
from typing import NoReturn

from geomtorsion.checks import GREEK
from geomtorsion.errors import ExpressionError
from geomtorsion.exact.names import CONSTANTS, FUNCTIONS
from geomtorsion.teaching.exercises.limits import ANSWER

_SPACES = re.compile(
    r"\\(?:left|right|bigg?[lr]?|Bigg?[lr]?|displaystyle|textstyle|quad|qquad|[,;:! ])(?![A-Za-z])"
    r"|\\[,;:! ]|\$"
)
_PRODUCT = re.compile(r"\\(?:cdot|times|ast)(?![A-Za-z])")
_UPRIGHT = re.compile(r"\\(?:mathrm|mathit|mathbf|text|operatorname)\s*\{([^{}]*)\}")
_LETTERS = {"varphi": "phi", "vartheta": "theta", "varepsilon": "epsilon", "arctan": "atan",
            "arcsin": "asin", "arccos": "acos"}  # fmt: skip
_DOT = re.compile(r"\\(d?)dot\s*(?:\{\s*\\?([A-Za-z]+)\s*((?:_\{?[0-9]+\}?)?)\s*\}|\\?([A-Za-z]+))"
                  r"\s*((?:_\{?[0-9]+\}?)?)")  # fmt: skip
_INDEX = re.compile(r"_\s*\{\s*(\w+)\s*\}")
_MATRIX = re.compile(r"\\begin\{(\w*(?:matrix|array))\}(?:\{[lcr|]*\})?(.*?)\\end\{\1\}", re.DOTALL)


def without_latex(text: str) -> str:
    r"""A formula of LaTeX as plain text; unknown commands are unchanged.

    Examples
    --------
    >>> without_latex(r"\frac{\sin\phi_{1}}{2}"), without_latex(r"\dot{\Omega}_1 = \sqrt{x}")
    ('(( sin phi_1)/(2))', "Omega_1' = sqrt(x)")
    >>> without_latex(r"\begin{pmatrix} 1 & 0 \\ 0 & r \end{pmatrix}")
    '[[1, 0], [0, r]]'
    """
    text = re.sub(r"\\delta\s*\\([A-Z])", r"\\d\1", text)
    text = _PRODUCT.sub("*", _SPACES.sub(" ", re.sub(r"\\\\(?=[^A-Za-z]|$)", "\0", text)))
    text = _UPRIGHT.sub(r"\1", _DOT.sub(_rate, text))
    text = _MATRIX.sub(_rows, text.replace("\0", "\\\\"))
    text = _without_braces(text)
    text = _INDEX.sub(r"_\1", text)
    return re.sub(r"\\([A-Za-z]+)", lambda m: f" {_LETTERS.get(m[1], m[1])}", text).strip()


def _rate(match: re.Match[str]) -> str:
    """A letter with dots as a name with primes."""
    name, index = match[2] or match[4], re.sub(r"[{}]", "", (match[3] or "") + match[5])
    return f" {name}{index}{chr(39) * (1 + bool(match[1]))} "


def _rows(match: re.Match[str]) -> str:
    """A matrix as nested lists."""
    rows = [row for row in match[2].split("\\\\") if row.strip()]
    cells = ("[" + ", ".join(cell.strip() for cell in row.split("&")) + "]" for row in rows)
    return f"[{', '.join(cells)}]"


_BRACES = r"\s*\{([^{}]*)\}"
# A part of a fraction that is one sign, such as 2, r or \phi, needs no braces.
_PART = rf"\s*(?:\{{([^{{}}]*)\}}|([0-9A-Za-z]|\\(?:{'|'.join(GREEK)})(?![A-Za-z])))"
_QUOTIENT = re.compile(r"\\[dtc]?frac(?![A-Za-z])" + _PART + _PART)
_ROOT = re.compile(r"\\sqrt\s*(?:\[\s*([0-9]+)\s*\])?" + _BRACES)
_SCRIPT = re.compile(r"([_^])" + _BRACES)
_ARGUMENT = re.compile(r"(\\(?![dtc]?frac|sqrt)[A-Za-z]+)" + _BRACES)


def _without_braces(text: str) -> str:
    """Quotients, roots, scripts and arguments with round brackets, from the inside out."""
    while True:
        before = text
        text = _QUOTIENT.sub(r"((\1\2)/(\3\4))", text)
        text = _ROOT.sub(_root, text)
        text = _SCRIPT.sub(_script, text)
        text = _ARGUMENT.sub(r"\1(\2)", text)
        if text == before:
            return text


def _script(match: re.Match[str]) -> str:
    simple = match[1] == "_" and match[2].strip().isalnum()
    return match[1] + (match[2].strip() if simple else f"({match[2]})")


def _root(match: re.Match[str]) -> str:
    return f"({match[2]})^(1/{match[1]})" if match[1] else f"sqrt({match[2]})"


# How Unicode marks a sign as a superscript or subscript -> how it is typed.
_SMALL = MappingProxyType({"<super>": "^({})", "<sub>": "_{}"})
_SIGNS = str.maketrans(
    {
        **dict.fromkeys("−–—‐‑﹣", "-"), **dict.fromkeys("×⋅·∙•∗", "*"),
        **dict.fromkeys("÷∕⁄", "/"), **dict.fromkeys("′’‘`´", "'"), "″": "''", "√": " sqrt ",
        "∛": " cbrt ", "½": "(1/2)", "¼": "(1/4)", "¾": "(3/4)", "⅓": "(1/3)", "⅔": "(2/3)",
        "“": '"', "”": '"', **dict.fromkeys("\u200b\u200c\u200d\u2060\ufeff", None),
    }
)  # fmt: skip
# Names of functions in other systems.
_OTHER_NAMES = MappingProxyType(
    {
        "tg": "tan", "ctg": "cot", "cotg": "cot", "cotan": "cot", "cosec": "csc", "sen": "sin",
        "arccot": "acot", "arctg": "atan", "arcsinh": "asinh", "arsinh": "asinh",
        "arccosh": "acosh", "arcosh": "acosh", "arctanh": "atanh", "artanh": "atanh",
    }
)  # fmt: skip
_TOKEN = re.compile(
    r"(?P<space>\s+)|(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+(?!\w))?)"
    r"|(?P<name>[^\W\d]\w*)|(?P<prime>['\"]+)|(?P<sign>\*\*|.)",
    re.DOTALL,
)
_DOTTED = re.compile("([^\\W\\d_])([\u0307\u0308])(_?[0-9]*)")
_RATE = re.compile(r"\bd\s*([^\W\d]\w*?)\s*/\s*d\s*t\b")
_RATE_OF = re.compile(r"\bd\s*/\s*d\s*t\s*\(?\s*([^\W\d]\w*)\s*\)?")
_SECOND_RATE = re.compile(r"\bd\s*(?:\^|\*\*)\s*\(?2\)?\s*([^\W\d]\w*?)\s*/\s*d\s*t\s*"
                          r"(?:\^|\*\*)\s*\(?2\)?")  # fmt: skip
# Constants as Maxima writes them.
_MAXIMA = MappingProxyType({"pi": "pi", "e": "E", "i": "I"})
_PERCENT = re.compile(r"%(pi|e|i)\b")
_BARS = re.compile(r"\|([^|]+)\|")
_LIBRARY = re.compile(r"\b(?:np|numpy|math|cmath|mpmath|sp|sympy)\.(?=[A-Za-z])")
_BRACKETS = "([{"


def plain_signs(text: str) -> str:
    """Text in keyboard signs: superscripts, subscripts, LaTeX and other minus signs are replaced.

    Examples
    --------
    >>> plain_signs("−φ₁² · √2"), plain_signs(r"\\frac{1}{2}\\cos^2\\phi_{1}")
    ('-φ_1^(2) *  sqrt 2', '((1)/(2)) cos^2 phi_1')
    """
    if re.search("[0-9][½¼¾⅓⅔]", text):
        raise ExpressionError("a number stands before a fraction sign. Write 5/2 for two and a "
                              "half.")  # fmt: skip
    text = "".join(_full_size(kind, "".join(run)) for kind, run in groupby(text, _small_kind))
    text = text.translate(_SIGNS)
    # Compatible forms of letters are one letter; composed dots are taken apart first.
    text = unicodedata.normalize("NFKC", text)
    text = _DOTTED.sub(_primed, unicodedata.normalize("NFD", text))
    text = unicodedata.normalize("NFC", text)
    text = re.sub(r"_\s*\{\s*(\w+)\s*\}", r"_\1", _LIBRARY.sub("", text))
    text = _PERCENT.sub(lambda match: f" {_MAXIMA[match[1]]}", text)
    text = without_latex(text) if "\\" in text or "$" in text else text
    return _BARS.sub(r" abs(\1)", text)


def _small_kind(sign: str) -> str:
    kind = unicodedata.decomposition(sign).partition(" ")[0]
    return kind if kind in _SMALL else ""


def _full_size(kind: str, run: str) -> str:
    return _SMALL[kind].format(unicodedata.normalize("NFKC", run)) if kind else run


def _primed(match: re.Match[str]) -> str:
    return match[1] + match[3] + "'" * (1 + (match[2] == "\u0308"))


def written_out(text: str, names: Mapping[str, object], where: str) -> str:
    """An expression with all its products and brackets, over names that the parser knows.

    names: allowed names, as name -> symbol; x'' means x_dd.

    Raises
    ------
    ExpressionError
        It can be read in two ways; the message gives both.

    Examples
    --------
    >>> names = dict.fromkeys(["phi1", "phi2", "r", "r_d"])
    >>> written_out("1/2 sin^2 phi_1 + 2r(1 - e^x)", names, "q")
    '1/2*sin(phi1)**2+2*r*(1-E**x)'
    >>> written_out("sin phi1/2", names, "q")
    Traceback (most recent call last):
    geomtorsion.errors.ExpressionError: q: 'sin phi1/2' can be read in two ways. Write...
    """
    try:
        text = _with_rates(plain_signs(text), names)
    except ExpressionError as error:
        raise ExpressionError(f"{where}: {error}") from None
    return _Writer(list(_tokens(text, names)), where).written()


def _with_rates(text: str, names: Mapping[str, object]) -> str:
    """dx/dt and d^2x/dt^2 as x' and x'', where these are names."""

    def rate(match: re.Match[str], order: int) -> str:
        known = _rate_name(match[1], order, names)
        return f"({match[1]}{chr(39) * order})" if known else match[0]

    text = _SECOND_RATE.sub(lambda match: rate(match, 2), text)
    for pattern in (_RATE, _RATE_OF):
        text = pattern.sub(lambda match: rate(match, 1), text)
    return text


@dataclass(frozen=True)
class _Token:
    """A piece of an answer; kind: number, symbol, function, sign or unknown.

    text: as the parser takes it. shown: as typed. spaced: whether a space precedes it.
    """

    kind: str
    text: str
    shown: str
    spaced: bool = False

    @property
    def starts_value(self) -> bool:
        return self.kind != "sign" or self.text == "("

    @property
    def ends_value(self) -> bool:
        return self.kind in ("number", "symbol", "unknown") or self.text == ")"


def _tokens(text: str, names: Mapping[str, object]) -> Iterator[_Token]:
    """The pieces of a text, with names as the reader knows them."""
    pieces = list(_TOKEN.finditer(text))
    spaced, k = False, 0
    while k < len(pieces):
        match = pieces[k]
        kind, piece = str(match.lastgroup), match.group()
        k += 1
        if kind == "space":
            spaced = True
            continue
        if kind == "name":
            following = [later.group() for later in pieces[k : k + 3]]
            taken, found = _word(piece, following, names)
            k += taken
            for place, token in enumerate(found):
                yield _Token(token.kind, token.text, token.shown, spaced and not place)
        elif kind == "sign":
            plain = {"^": "**", "[": "(", "]": ")", "{": "(", "}": ")"}.get(piece, piece)
            yield _Token("sign", plain, piece, spaced)
        else:
            yield _Token(kind, piece, piece, spaced)
        spaced = False


def _word(
    word: str, following: Sequence[str], names: Mapping[str, object]
) -> tuple[int, list[_Token]]:
    """A name, with the number of following pieces that belong to it."""
    after = following[0] if following else ""
    if after[:1] in ("'", '"'):
        order = len(after.replace('"', "''"))
        rate = _rate_name(word, order, names)
        if rate:
            return 1, [_Token("symbol", rate, word + after)]
        # In rr' the prime belongs to the last name only.
        for cut in range(1, min(len(word), ANSWER.depth)):
            before, rate = _parts(word[:cut], names), _rate_name(word[cut:], order, names)
            if before and rate and before[-1].kind == "symbol":
                return 1, [*before, _Token("symbol", rate, word[cut:] + after)]
        return 1, [_Token("symbol", f"{word}_{'d' * order}", word + after)]
    known = _known(word, names)
    if known:
        return 0, [known]
    # phi 2, phi^2 and phi_2 are phi2 where there is no phi.
    number = 1 if after in ("^", " ") else 0
    if number and len(following) > 1 and following[1].isdigit():
        symbol = _symbol(word + following[1], names)
        if symbol:
            return 2, [_Token("symbol", symbol, f"{word}{after}{following[1]}")]
    # sqrt2 and ln2; log2 might be a logarithm to the base 2.
    joined = re.fullmatch(r"(sqrt|cbrt|ln|exp)([0-9]+)", word)
    if joined:
        return 0, [_Token("function", joined[1], joined[1]), _Token("number", joined[2], joined[2])]
    parts = _parts(word, names)
    return 0, parts or [_Token("unknown", word, word)]


def _known(word: str, names: Mapping[str, object]) -> _Token | None:
    """A word that is a symbol, a constant or a function."""
    symbol = _symbol(word, names)
    if symbol:
        return _Token("symbol", symbol, word)
    for form in (word, word.lower()):
        plain = _OTHER_NAMES.get(form, form)
        if plain in (*FUNCTIONS, "abs"):
            return _Token("function", plain, word)
    if word in CONSTANTS or word in ("e", "Pi", "PI"):
        return _Token("symbol", {"e": "E", "Pi": "pi", "PI": "pi"}.get(word, word), word)
    return None


def _symbol(word: str, names: Mapping[str, object]) -> str:
    """The symbol that a word writes: phi_1, φ1 or phi1; empty if there is none."""
    for form in (word, word.replace("_", ""), _spelled(word), _spelled(word).replace("_", "")):
        if form in names:
            return form
    dotted = re.fullmatch(r"(\w+?)_?(d?)dot(_?[0-9]*)", word)
    return _rate_name(dotted[1] + dotted[3], 1 + bool(dotted[2]), names) if dotted else ""


def _spelled(word: str) -> str:
    """Greek letters by their names; a small delta before a name is the d of dPhi."""
    word = re.sub(r"^(?:δ|delta_?)(?=[^\W\d])", "d", word)
    return "".join(_NAMES_OF_LETTERS.get(sign, sign) for sign in word)


_NAMES_OF_LETTERS = {letter: name for name, letter in GREEK.items()}


def _rate_name(word: str, order: int, names: Mapping[str, object]) -> str:
    """The symbol of a rate, such as Omega1_d for Ω_1'; empty if there is none."""
    for form in (word, word.replace("_", ""), _spelled(word), _spelled(word).replace("_", "")):
        if f"{form}_{'d' * order}" in names:
            return f"{form}_{'d' * order}"
    return ""


def _parts(word: str, names: Mapping[str, object]) -> list[_Token]:
    """A word as names side by side, such as Omega2Omega3 or piR; empty if it is anything else.

    If several splits exist, the split with the longest names from the left is taken.
    """
    found: list[_Token] = []
    longest = max(map(len, (*names, *FUNCTIONS))) + 1
    rest = word if len(word) <= ANSWER.depth else ""
    while rest:
        heads = (rest[:size] for size in range(min(longest, len(rest)), 0, -1))
        known = next((token for head in heads if (token := _known(head, names))), None)
        if known is None or (known.shown in ("e", "E", "I") and len(word) > 1):
            return []
        found.append(known)
        rest = rest[len(known.shown) :]
    # A function only as the last: xsin(...) is x sin(...), but sinx may be a name misspelt.
    single = len(found) == 2 and found[0].kind == "function" and found[1].kind == "symbol"
    inner = any(token.kind == "function" for token in found[:-1])
    repeated = len({token.text for token in found}) < len(found)
    return found if single or not (inner or repeated) else []


class _Writer:
    """Inserts the omitted products and brackets."""

    def __init__(self, tokens: Sequence[_Token], where: str) -> None:
        self.tokens = tokens
        self.where = where
        self.found: list[str] = []
        # For each open bracket: whether a value is in a denominator, and whether this is a
        # fraction of two numbers; and the text that follows the closed bracket.
        self.under: list[str] = [""]
        self.closing: list[str] = [""]

    def written(self) -> str:
        k = 0
        while k < len(self.tokens):
            k = self._next(k)
        return "".join(self.found)

    def _at(self, k: int) -> _Token:
        return self.tokens[k] if 0 <= k < len(self.tokens) else _Token("end", "", "")

    def _next(self, k: int) -> int:
        token = self.tokens[k]
        before = self._at(k - 1)
        # An unknown name may be meant as a function: the parser reports that there is none.
        called = before.kind == "unknown" and token.text == "("
        if k and token.starts_value and before.ends_value and not called:
            self._multiply(k)
        if token.kind == "function":
            return self._function(k)
        self.found.append(token.text)
        if token.text == "(":
            self.under.append("")
            self.closing.append("")
        elif token.text == ")" and len(self.under) > 1:
            self.under.pop()
            self.found.append(self.closing.pop())
        elif token.text == "/":
            before, first = self._at(k - 1), self._at(k - 2)
            plain = before.kind == "number" and first.text in ("", "(", "+", "-", ",", "=")
            self.under[-1] = "number" if plain and self._at(k + 1).kind == "number" else "value"
        elif token.kind == "sign" and token.text != "**":
            self.under[-1] = ""
        return k + 1

    def _multiply(self, k: int) -> None:
        """A product sign before token k, unless it is ambiguous."""
        token, before = self.tokens[k], self._at(k - 1)
        if self.under[-1] == "value" or (self.under[-1] == "number" and not token.spaced):
            above = self._at(k - 3).shown if self._at(k - 2).text == "/" else "..."
            above = "..." if above == ")" else above
            below = (
                f"{before.shown}*{token.shown}" if before.text != ")" else f"(...)*{token.shown}"
            )
            self._ambiguous(k, f"({above}/{below.replace('*', ')*', 1)} or {above}/({below})")
        power = self._at(k - 2).text == "**" and self._at(k - 3).text == "E"
        if power and before.kind == "number":
            self._ambiguous(k, f"exp({before.shown}*{token.shown}) or exp({before.shown})*"
                               f"{token.shown}")  # fmt: skip
        self.under[-1] = ""
        self.found.append("*")

    def _function(self, k: int) -> int:
        """A function with its power before its argument, and with brackets if it has none."""
        name = self.tokens[k].text
        power, k = self._power(name, k + 1)
        # The parser has no |x|; the root of a square drops the sign of a real value.
        opening, closing = ("sqrt((", f"**2){power}") if name == "abs" else (f"{name}(", power)
        if self._at(k).text == "(":
            self.found.append(opening)
            self.under.append("")
            self.closing.append(closing)
            return k + 1
        start = k
        if self._at(k).text == "-":
            k += 1
        number, symbol = self._at(k).kind == "number", self._at(k + 1).kind == "symbol"
        if number and symbol and name in ("sqrt", "cbrt"):
            self._ambiguous(k, f"{name}({self._at(k).shown})*{self._at(k + 1).shown} or "
                               f"{name}({self._at(k).shown}*{self._at(k + 1).shown})")  # fmt: skip
        size = 2 if number and symbol else 1 if number or self._at(k).kind == "symbol" else 0
        if not size:
            self.found.append(name)
            return start
        argument = "*".join(self._at(j).text for j in range(k, k + size))
        sign = "-" if k > start else ""
        k += size
        self.found.append(f"{opening}{sign}{argument}){closing}")
        self._check_end(k, name, sign + argument)
        return k

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
        return f"**{exponent.text}", k + 2 + 2 * bracket

    def _check_end(self, k: int, name: str, argument: str) -> None:
        """Refuse a piece that may or may not belong to an argument without brackets."""
        token, after = self._at(k), self._at(k + 1)
        if token.text == "/" and after.kind == "function":
            return
        if token.text in ("**", "/") or (
            token.starts_value and token.kind not in ("function", "end")
        ):
            sign = "^" if token.text == "**" else token.text if token.text == "/" else "*"
            rest = after.shown if token.text in ("**", "/") else token.shown
            rest = "(...)" if rest in _BRACKETS else rest
            self._ambiguous(k, f"{name}({argument}){sign}{rest} or {name}({argument}{sign}{rest})")

    def _ambiguous(self, k: int, ways: str) -> NoReturn:
        near = self.tokens[max(0, k - 3) : k + 3]
        text = "".join(" " * token.spaced + token.shown for token in near).strip()
        raise ExpressionError(f"{self.where}: {text[:60]!r} can be read in two ways. Write {ways}.")
