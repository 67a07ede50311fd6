"""formula: LaTeX as a tree, and from it MathML Core for a browser and lines for a terminal."""

from __future__ import annotations

import base64
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from geomtorsion.errors import ExpressionError
from geomtorsion.outgoing import html_text
from geomtorsion.pictures.latex import latex_text
from geomtorsion.pictures.text import GREEK

_TOKEN = re.compile(r"\\[A-Za-z]+|\\.|[{}^_&']|[0-9]+(?:\.[0-9]+)?|\s+|.", re.DOTALL)

# LaTeX has no letters of its own for the capitals that look Latin; nobody writes those.
LETTERS = GREEK | {"epsilon": "ϵ", "varepsilon": "ε"}
SIGNS = {
    "partial": "∂", "wedge": "∧", "times": "×", "cdot": "⋅", "vee": "∨", "oint": "∮", "int": "∫",
    "sum": "∑", "ldots": "…", "le": "≤", "ge": "≥", "ne": "≠", "to": "→", "infty": "∞",
    "prime": "′", "approx": "≈", "pm": "±", "langle": "⟨", "rangle": "⟩",
}  # fmt: skip
SPACES = {",": 0.17, ";": 0.28, ":": 0.22, " ": 0.25, "quad": 1.0, "qquad": 2.0, "!": 0.0}
FUNCTIONS = (
    "sin cos tan cot sec csc sinh cosh tanh coth ln log exp det arcsin arccos arctan".split()
)
ACCENTS = {"dot": "˙", "ddot": "¨", "bar": "¯", "overline": "¯", "hat": "^", "tilde": "~"}
FRACTIONS = ("frac", "tfrac", "dfrac")
UPRIGHT = ("mathrm", "text", "operatorname")


@dataclass(frozen=True)
class Node:
    """A part of a formula.

    kind: row, letter, sign, number, word, space, fraction, root, scripts, accent, fence or matrix.
    text: the letter, sign, number, word or accent; of a fence its two brackets.
    parts: what is inside; of scripts: base, subscript, superscript (empty rows where missing);
    of a root: what is under it, and its degree if that is not two.
    width: of a space, in em.
    """

    kind: str
    text: str = ""
    parts: tuple[Node, ...] = ()
    width: float = 0.0


EMPTY = Node("row")


def tree_of(latex: str) -> Node:
    """The tree of a formula.

    Raises
    ------
    ExpressionError
        A command that is not known here, or braces that do not pair up.

    Examples
    --------
    >>> tree_of("x_1").kind
    'scripts'
    """
    reader = _Reader(latex, _TOKEN.findall(latex))
    found = reader.row(())
    if reader.place < len(reader.tokens):
        raise reader.error(f"{reader.tokens[reader.place]} stands alone")
    return found


@dataclass
class _Reader:
    """Walks over the tokens once."""

    latex: str
    tokens: list[str]
    place: int = field(default=0)

    def error(self, reason: str) -> ExpressionError:
        return ExpressionError(f"formula {self.latex!r}: {reason}")

    def peek(self) -> str:
        while self.place < len(self.tokens) and self.tokens[self.place].isspace():
            self.place += 1
        return self.tokens[self.place] if self.place < len(self.tokens) else ""

    def next(self) -> str:
        token = self.peek()
        self.place += 1
        return token

    def row(self, ends: Sequence[str]) -> Node:
        """Nodes up to one of the ends, which is left to be read."""
        found: list[Node] = []
        while (token := self.peek()) and token not in ends and token != "}":
            if token in "^_'":
                found.append(self.scripts(found.pop() if found else EMPTY))
            else:
                found.append(self.one())
        return found[0] if len(found) == 1 else Node("row", parts=tuple(found))

    def scripts(self, base: Node) -> Node:
        """A base with the sub- and superscript that follow it."""
        below, above = EMPTY, EMPTY
        while (token := self.peek()) and token in "^_'":
            if token == "'":
                self.next()
                above = Node("sign", above.text + "′")
            elif token == "_" and below is EMPTY:
                self.next()
                below = self.argument()
            elif token == "^" and above is EMPTY:
                self.next()
                above = self.argument()
            else:
                break
        return Node("scripts", parts=(base, below, above))

    def argument(self) -> Node:
        """A group in braces, or the one thing that follows: of a number its first digit."""
        token = self.peek()
        # \tfrac12 means one half, as in LaTeX.
        if token[:1].isdigit() and len(token) > 1:
            self.tokens[self.place : self.place + 1] = [token[0], token[1:]]
        return self.one()

    def one(self) -> Node:
        token = self.next()
        if token == "{":
            found = self.row(("}",))
            if self.next() != "}":
                raise self.error("a brace is not closed")
            return found
        if not token:
            raise self.error("it ends too early")
        if token.startswith("\\"):
            return self.command(token[1:])
        if token[0].isdigit():
            return Node("number", token)
        return Node("letter" if token.isalpha() else "sign", token)

    def command(self, name: str) -> Node:
        if name in LETTERS:
            return Node("letter", LETTERS[name])
        if name in SIGNS:
            return Node("sign", SIGNS[name])
        if name in SPACES:
            return Node("space", width=SPACES[name])
        if name in FUNCTIONS:
            return Node("word", name)
        if name in FRACTIONS:
            return Node("fraction", parts=(self.argument(), self.argument()))
        if name == "sqrt":
            if self.peek() != "[":
                return Node("root", parts=(self.argument(),))
            self.next()
            degree = self.row(("]",))
            self.next()
            return Node("root", parts=(self.argument(), degree))
        if name in ACCENTS:
            return Node("accent", ACCENTS[name], (self.argument(),))
        if name in UPRIGHT:
            return Node("word", self.verbatim())
        if name in "{}%|":
            return Node("sign", name)
        if name == "left":
            return self.fence()
        if name == "begin":
            return self.matrix()
        raise self.error(f"\\{name} is not known here")

    def verbatim(self) -> str:
        """The text in braces as it stands."""
        # Words keep their blanks, which the reader skips elsewhere.
        if self.next() != "{":
            raise self.error("a brace was needed")
        found = ""
        while self.place < len(self.tokens) and self.tokens[self.place] != "}":
            found += self.tokens[self.place]
            self.place += 1
        self.place += 1
        return found

    def fence(self) -> Node:
        left = self.next().removeprefix("\\")
        inner = self.row(("\\right",))
        if self.next() != "\\right":
            raise self.error("\\left has no \\right")
        right = self.next().removeprefix("\\")
        brackets = left + right
        return Node("fence", brackets, (inner,))

    def matrix(self) -> Node:
        name = self.verbatim()
        rows: list[Node] = []
        cells: list[Node] = []
        while True:
            cells.append(self.row(("&", "\\\\", "\\end")))
            token = self.next()
            if token == "&":
                continue
            rows.append(Node("row", parts=tuple(cells)))
            cells = []
            if token == "\\end":
                break
            if token != "\\\\":
                raise self.error(f"{name} has no end")
        self.verbatim()
        return Node("matrix", name, tuple(rows))


_FENCES = "()[]|⟨⟩"
_PREFIXED = '<mo form="prefix">−</mo>'
_LEADING = ("=", ",", "(", "[")
_THIN = '<mspace width="0.17em"/>'
_TALL = ("<mfrac", "<mroot", "<mtable")


def mathml(latex: str, *, display: bool = False, tall: bool = False) -> str:
    r"""A formula as a math element.

    Parameters
    ----------
    display
        It stands alone on its line.
    tall
        Fractions are as large as in a line of its own.

    Examples
    --------
    >>> mathml(r"\tfrac12")
    '<math><mfrac><mn>1</mn><mn>2</mn></mfrac></math>'
    """
    kind = ' display="block"' if display else ""
    kind += ' displaystyle="true"' if tall else ""
    return f"<math{kind}>{_written(tree_of(latex))}</math>"


def expression_mathml(expression: object) -> str:
    """An expression as a math element.

    Examples
    --------
    >>> import sympy
    >>> expression_mathml(1 - sympy.Symbol("r"))
    '<math><mrow><mn>1</mn><mo>−</mo><mi>r</mi></mrow></math>'
    """
    return mathml(latex_text(expression))


def _written(node: Node) -> str:
    return _WRITERS[node.kind](node)


def _row(node: Node) -> str:
    """Parts side by side; a function stands a little apart from what is next to it."""
    found: list[str] = []
    parts = _gathered(node.parts)
    for number, part in enumerate(parts):
        before = parts[number - 1] if number else EMPTY
        if number and (_is_named(part) or _is_named(before)):
            # A sign keeps its own distance, and brackets stand close to the function before them.
            kinds = {before.kind, part.kind}
            if not {"sign", "space"} & kinds and (_is_named(part) or part.kind != "fence"):
                found.append(_THIN)
        leads = not number or before.text in _LEADING
        found.append(_PREFIXED if part.text == "-" and leads else _written(part))
    return found[0] if len(found) == 1 else f"<mrow>{''.join(found)}</mrow>"


def _is_named(node: Node) -> bool:
    """Whether a part is a function such as sin, perhaps with a power."""
    base = node.parts[0] if node.kind == "scripts" else node
    return base.kind == "word" and len(base.text) > 1 and " " not in base.text


def _gathered(parts: Sequence[Node]) -> list[Node]:
    """Scripts without a base joined to those before them: S_{ab}{}^c has columns."""
    found: list[Node] = []
    for part in parts:
        bare = part.kind == "scripts" and part.parts[0] == EMPTY
        if bare and found and found[-1].kind in ("scripts", "columns"):
            found[-1] = Node("columns", parts=(*found[-1].parts, *part.parts[1:]))
        else:
            found.append(part)
    return found


def _columns(node: Node) -> str:
    """A base with indices one after the other, below or above."""
    base, *marks = node.parts
    empty = "<mrow></mrow>"
    pairs = ""
    for below, above in zip(marks[::2], marks[1::2], strict=True):
        # Each index has its own column, so that none stands above another.
        pairs += "".join(f"{_written(one)}{empty}" for one in _listed(below))
        pairs += "".join(f"{empty}{_written(one)}" for one in _listed(above))
    return f"<mmultiscripts>{_written(base)}{pairs}</mmultiscripts>"


def _listed(node: Node) -> tuple[Node, ...]:
    return node.parts if node.kind == "row" else (node,)


def _letter(node: Node) -> str:
    upright = ' mathvariant="normal"' if "Α" <= node.text <= "Ω" else ""
    return f"<mi{upright}>{html_text(node.text)}</mi>"


def _sign(node: Node) -> str:
    if node.text == "∂":
        # As an operator it would stand apart from what it differentiates.
        return "<mi>∂</mi>"
    sign = "−" if node.text == "-" else node.text
    still = ' stretchy="false"' if sign in _FENCES else ""
    tight = ' lspace="0" rspace="0"' if sign[:1] in "/′" else ""
    return f"<mo{still}{tight}>{html_text(sign)}</mo>"


def _word(node: Node) -> str:
    if " " in node.text:
        # Markup would swallow blanks at the ends.
        return f"<mtext>{html_text(node.text).replace(' ', chr(0xA0))}</mtext>"
    upright = ' mathvariant="normal"' if len(node.text) == 1 else ""
    return f"<mi{upright}>{html_text(node.text)}</mi>"


def _fraction(node: Node) -> str:
    return f"<mfrac>{''.join(map(_written, node.parts))}</mfrac>"


def _root(node: Node) -> str:
    inner = "".join(map(_written, node.parts))
    return f"<msqrt>{inner}</msqrt>" if len(node.parts) == 1 else f"<mroot>{inner}</mroot>"


def _scripts(node: Node) -> str:
    base, below, above = node.parts
    inner = _written(base)
    if above.text[:1] == "′":
        # Primes are raised already; as a superscript they would all but vanish.
        lower = inner if below is EMPTY else f"<msub>{inner}{_written(below)}</msub>"
        return f"<mrow>{lower}{_written(above)}</mrow>"
    if below is EMPTY:
        return f"<msup>{inner}{_written(above)}</msup>"
    if above is EMPTY:
        return f"<msub>{inner}{_written(below)}</msub>"
    return f"<msubsup>{inner}{_written(below)}{_written(above)}</msubsup>"


def _accent(node: Node) -> str:
    mark = f'<mo stretchy="false">{node.text}</mo>'
    # Browsers set dots and bars too low where they are called accents.
    close = ' accent="true"' if node.text in "^~" else ""
    return f"<mover{close}>{_written(node.parts[0])}{mark}</mover>"


def _fence(node: Node) -> str:
    left, right = (html_text(x) if x != "." else "" for x in node.text)
    inner = "".join(map(_written, node.parts))
    # Browsers set more space beside a bracket that may grow, even where it does not.
    mark = "<mo>" if any(tall in inner for tall in _TALL) else '<mo stretchy="false">'
    return f"<mrow>{mark}{left}</mo>{inner}{mark}{right}</mo></mrow>"


def _matrix(node: Node) -> str:
    rows = "".join(
        f"<mtr>{''.join(f'<mtd>{_written(cell)}</mtd>' for cell in row.parts)}</mtr>"
        for row in node.parts
    )
    return f"<mrow><mo>(</mo><mtable>{rows}</mtable><mo>)</mo></mrow>"


_WRITERS = {
    "row": _row,
    "letter": _letter,
    "sign": _sign,
    "number": lambda node: f"<mn>{node.text}</mn>",
    "word": _word,
    "space": lambda node: f'<mspace width="{node.width}em"/>',
    "fraction": _fraction,
    "root": _root,
    "scripts": _scripts,
    "columns": _columns,
    "accent": _accent,
    "fence": _fence,
    "matrix": _matrix,
}


# What a page that promises to load nothing has to allow its own font.
FONT_SOURCE = "font-src data:"
FAMILY = "geomtorsion math"


@cache
def font_face() -> str:
    """Style that brings the font inside the page and sets all formulas in it.

    Examples
    --------
    >>> font_face().count("@font-face"), "http" in font_face()
    (1, False)
    """
    data = Path(__file__).with_name("fonts").joinpath("stix-two-math.woff2").read_bytes()
    text = base64.b64encode(data).decode()
    return (
        f'@font-face {{ font-family: "{FAMILY}"; font-display: block; '
        f'src: url("data:font/woff2;base64,{text}") format("woff2"); }}\n'
        f'math {{ font-family: "{FAMILY}", math; }}\n'
    )
