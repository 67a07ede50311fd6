"""formula: LaTeX as a tree, for MathML and for the terminal."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from geomtorsion.errors import ExpressionError
from geomtorsion.pictures.text import GREEK

_TOKEN = re.compile(r"\\[A-Za-z]+|\\.|[{}^_&']|[0-9]+(?:\.[0-9]+)?|\s+|.", re.DOTALL)

# LaTeX has no letters of its own for the capitals that look Latin; nobody writes those.
LETTERS = GREEK | {"epsilon": "ϵ", "varepsilon": "ε"}
SIGNS = {
    "partial": "∂", "wedge": "∧", "times": "×", "cdot": "⋅", "vee": "∨", "oint": "∮", "int": "∫",
    "sum": "∑", "ldots": "…", "le": "≤", "ge": "≥", "ne": "≠", "to": "→", "infty": "∞",
    "approx": "≈", "pm": "±", "langle": "⟨", "rangle": "⟩",
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
