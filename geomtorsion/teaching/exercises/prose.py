"""prose: statements in a little Markdown with LaTeX, as HTML, as LaTeX and as plain text."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape
from itertools import zip_longest
from xml.etree import ElementTree

from geomtorsion.pictures.formula import FORMULA, FUNCTIONS, converted, mathml

_MARKS = {"˙": "\u0307", "¨": "\u0308", "¯": "\u0304", "^": "\u0302", "~": "\u0303"}
_SPACED = "=+-∧×≤≥≠→≈<>"
_BINDING = ("letter", "number", "word", "scripts", "accent", "root", "fence")
_MARKED = {"˙": "dot", "¨": "ddot", "¯": "mean", "^": "hat", "~": "tilde"}
_CODE = re.compile(r"`([^`]+)`")
_BOLD = re.compile(r"\*\*(.+?)\*\*", re.DOTALL)
# Signs that LaTeX reserves outside of formulas -> how they are written there.
_LATEX = str.maketrans(
    {sign: f"\\{sign}" for sign in "%#&_{}$"}
    | {"\\": r"\textbackslash{}", "^": r"\textasciicircum{}", "~": r"\textasciitilde{}"}
)


def html_of(markdown: str, *, tex: bool = False) -> str:
    r"""Paragraphs, lists, bold words, code and formulas as HTML.

    tex: formulas as TeX between \( and \), for pages with MathJax; otherwise as MathML.

    Examples
    --------
    >>> html_of("Let **x** be `r`, with $r$.")
    '<p>Let <strong>x</strong> be <code>r</code>, with <math><mi>r</mi></math>.</p>'
    >>> html_of("Let $r < 1$.", tex=True)
    '<p>Let \\(r &lt; 1\\).</p>'
    """
    return "\n".join(_block(block, tex) for block in re.split(r"\n\s*\n", markdown.strip()))


def _block(block: str, tex: bool) -> str:
    block = block.strip()
    display = re.fullmatch(r"\$\$(.+?)\$\$", block, re.DOTALL)
    if display:
        return f'<div class="scroll">{_formula(display[1], tex, display=True)}</div>'
    if block.startswith("- "):
        items = (f"<li>{_inline(x, tex)}</li>" for x in re.split(r"(?:^|\n)- ", block) if x)
        return f"<ul>{''.join(items)}</ul>"
    return f"<p>{_inline(block, tex)}</p>"


def _formula(latex: str, tex: bool, *, display: bool) -> str:
    """A formula as MathML, or unchanged, for MathJax."""
    if not tex:
        return mathml(latex, display=display)
    return escape(rf"\[{latex}\]" if display else rf"\({latex}\)", quote=False)


def _inline(text: str, tex: bool) -> str:
    """Bold, code and formulas inside a paragraph."""

    def formula(match: re.Match[str]) -> str:
        if match[1]:
            return f'<span class="wide">{_formula(match[1], tex, display=True)}</span>'
        return _formula(match[2], tex, display=False)

    def words(part: str) -> str:
        return _BOLD.sub(r"<strong>\1</strong>", _CODE.sub(r"<code>\1</code>", escape(part)))

    return _with_formulas(text, formula, words)


def text_of(markdown: str) -> str:
    r"""The statement as plain text: formulas in Greek letters, without marks of Markdown.

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

    plain = _with_formulas(markdown, formula, words)
    return re.sub(r"\n{3,}", "\n\n", re.sub(r" +$|^ (?=\w)", "", plain, flags=re.MULTILINE)).strip()


def latex_of(markdown: str) -> str:
    r"""The statement as text of a LaTeX document, for copying.

    Examples
    --------
    >>> latex_of(r"Let **x** be `r_1`, with $\phi_1$.")
    'Let \\textbf{x} be \\texttt{r\\_1}, with $\\phi_1$.'
    """

    def formula(match: re.Match[str]) -> str:
        return rf"\[{match[1]}\]" if match[1] else match[0]

    def words(part: str) -> str:
        latex = _CODE.sub(r"\\texttt{\1}", _BOLD.sub(r"\\textbf{\1}", part.translate(_LATEX)))
        return re.sub(r"^- ", r"\\par -- ", latex, flags=re.MULTILINE)

    return _with_formulas(markdown.strip(), formula, words)


def _with_formulas(
    text: str, formula: Callable[[re.Match[str]], str], words: Callable[[str], str]
) -> str:
    """Formulas by one rule, the text between them by another."""
    pieces, place = [], 0
    # Bold marks may enclose a formula: they are handled with placeholders for the formulas.
    formulas: list[str] = []
    for match in FORMULA.finditer(text):
        pieces.append(text[place : match.start()])
        formulas.append(formula(match))
        pieces.append(f"\0{len(formulas) - 1}\0")
        place = match.end()
    pieces.append(text[place:])
    whole = words("".join(pieces))
    return re.sub(r"\0([0-9]+)\0", lambda match: formulas[int(match[1])], whole)


def plain_of(latex: str) -> str:
    r"""A formula as text.

    Examples
    --------
    >>> plain_of(r"g_{\mu\nu} = e^i{}_\mu\,e^i{}_\nu")
    'g_μν = e^i_μ e^i_ν'
    >>> plain_of(r"\frac{\sin{\left(x \right)}}{2 r}")
    'sin(x)/(2r)'
    """
    return _written(tree_of(latex))


def lines_of(latex: str) -> list[str]:
    r"""A formula as lines: a matrix takes one line for each row.

    Examples
    --------
    >>> lines_of(r"g = \begin{pmatrix} 1 & 0 \\ 0 & r \end{pmatrix}.")
    ['    / 1  0 \\', 'g = \\ 0  r /.']
    """
    tree = tree_of(latex)
    parts = tree.parts if tree.kind == "row" else (tree,)
    places = [k for k, part in enumerate(parts) if part.kind == "matrix"]
    if len(places) != 1:
        return [_written(tree)]
    [place] = places
    before = _row(Node("row", parts=parts[:place]))
    after = _row(Node("row", parts=parts[place + 1 :]))
    before += " " * bool(before)
    cells = [[_written(cell) for cell in row.parts] for row in parts[place].parts]
    # LaTeX lets a row end early.
    columns = list(zip_longest(*cells, fillvalue=""))
    cells = [list(row) for row in zip(*columns, strict=True)]
    widths = [max(map(len, column)) for column in columns]
    rows = ["  ".join(x.ljust(w) for x, w in zip(row, widths, strict=True)) for row in cells]
    inside = len(rows) - 2
    # The pairs of signs that make up the two brackets, from above.
    brackets = ["()"] if inside < 0 else ["/\\", *["||"] * inside, "\\/"]
    sides = [(" " * len(before), "")] * len(rows)
    sides[len(rows) // 2 : len(rows) // 2 + 1] = [(before, after)] * bool(rows)
    return [
        f"{lead}{left} {row} {right}{end}"
        for (lead, end), (left, right), row in zip(sides, brackets, rows, strict=False)
    ]


@dataclass(frozen=True)
class Node:
    """A part of a formula.

    kind: row, letter, sign, number, word, space, fraction, root, scripts, accent, fence or matrix.
    text: the letter, sign, number, word or accent; for a fence its two brackets.
    parts: children; for scripts: base, subscript, superscript (empty rows where missing);
    for a root: the radicand, and its degree if that is not two.
    width: for a space, in em.
    """

    kind: str
    text: str = ""
    parts: tuple[Node, ...] = ()
    width: float = 0.0


EMPTY = Node("row")
_APPLIED = "\u2061"
_SIGNS = {"−": "-", "ˆ": "^", "˜": "~", "″": "′′", "‴": "′′′"}
_KINDS = {"mfrac": "fraction", "mroot": "root"}
# Tag -> which child after the base is the subscript, and which the superscript; 2 is none.
_SCRIPTS = {
    "msub": (0, 2), "munder": (0, 2), "msup": (2, 0), "mover": (2, 0), "msubsup": (0, 1),
    "munderover": (0, 1),
}  # fmt: skip


def tree_of(latex: str) -> Node:
    """The tree of a formula, from its MathML.

    Raises
    ------
    ExpressionError
        The formula has an unknown command, or braces that do not match.

    Examples
    --------
    >>> tree_of("x_1").kind
    'scripts'
    """
    return _row_of(_parts(ElementTree.fromstring(converted(latex))))


def _row_of(parts: tuple[Node, ...]) -> Node:
    return parts[0] if len(parts) == 1 else Node("row", parts=parts)


def _parts(element: ElementTree.Element) -> tuple[Node, ...]:
    """Nodes of the children of a row; a function and its argument become parts of the row."""
    nodes: list[Node] = []
    for child in element:
        if child.tag in ("mrow", "mpadded") and any(part.text == _APPLIED for part in child):
            nodes += _parts(child)
        elif child.text != _APPLIED and (child.tag != "mspace" or _width(child)):
            nodes.append(_node(child))
    return tuple(nodes)


def _width(space: ElementTree.Element) -> float:
    r"""Width of an explicit space; 0.1667em is the space on both sides of a function."""
    width = space.get("width", "0em").removesuffix("em")
    return 0.0 if width == "0.1667" else float(width)


def _node(element: ElementTree.Element) -> Node:
    tag, text = element.tag, (element.text or "").replace("\xa0", " ")
    children = list(element)
    if tag in ("mi", "mo", "mn", "mtext"):
        return _leaf(tag, text, upright=bool(element.get("mathvariant")))
    if tag == "mspace":
        return Node("space", width=_width(element))
    if tag == "mtable":
        rows = (Node("row", parts=tuple(_row_of(_parts(cell)) for cell in row)) for row in element)
        return Node("matrix", parts=tuple(rows))
    if tag == "msqrt":
        return Node("root", parts=(_row_of(_parts(element)),))
    if tag == "mover" and element.get("accent"):
        base, mark = map(_node, children)
        return Node("accent", mark.text, (base,))
    if tag in _KINDS:
        return Node(_KINDS[tag], parts=tuple(map(_node, children)))
    if tag in _SCRIPTS:
        base, *marks = map(_node, children)
        return _scripted(base, *(marks[k] if k < len(marks) else EMPTY for k in _SCRIPTS[tag]))
    inner = _parts(element)
    return _fenced(inner) if _is_fence(tag, children) else _row_of(inner)


def _is_fence(tag: str, children: Sequence[ElementTree.Element]) -> bool:
    """Whether a row is in brackets that grow with what they hold."""
    if tag != "mrow" or len(children) < 2:
        return False
    # No attribute stops such a bracket.
    return all(one.tag == "mo" and not one.get("stretchy") for one in (children[0], children[-1]))


def _fenced(parts: tuple[Node, ...]) -> Node:
    """A row in brackets; a matrix has its own brackets."""
    if [part.kind for part in parts[1:-1]] == ["matrix"]:
        return parts[1]
    return Node("fence", parts[0].text + parts[-1].text, (_row_of(parts[1:-1]),))


def _leaf(tag: str, text: str, *, upright: bool) -> Node:
    """A letter, sign, number or word; a blank of its own is a space."""
    if tag == "mtext":
        return Node("word", text) if text.strip() else Node("space", width=0.25)
    if tag == "mn":
        return Node("number", text)
    if text.isalpha() and (len(text) > 1 or (upright and text.isascii())):
        return Node("word", text)
    return Node("letter" if text.isalpha() else "sign", _SIGNS.get(text, text))


def _scripted(base: Node, below: Node, above: Node) -> Node:
    """A base with its scripts; primes that another superscript follows come before it."""
    if above.kind == "row" and above.parts and set(above.parts[0].text) == {"′"}:
        base, above = Node("scripts", parts=(base, EMPTY, above.parts[0])), _row_of(above.parts[1:])
    return Node("scripts", parts=(base, below, above))


def _written(node: Node) -> str:
    if node.kind == "row":
        return _row(node)
    if node.kind == "space":
        return " " if node.width < 1 else "  "
    if node.kind == "fraction":
        above, below = node.parts
        return f"{_grouped(above)}/{_grouped(below, whole=True)}"
    if node.kind == "root":
        inner, *degree = map(_written, node.parts)
        return f"({inner})^(1/{degree[0]})" if degree else f"sqrt({inner})"
    if node.kind == "scripts":
        return _scripts(node)
    if node.kind == "accent":
        inner = _written(node.parts[0])
        return inner + _MARKS[node.text] if len(inner) == 1 else f"{_MARKED[node.text]}({inner})"
    if node.kind == "fence":
        left, right = (x if x != "." else "" for x in node.text)
        return f"{left}{_written(node.parts[0])}{right}"
    if node.kind == "matrix":
        rows = ("  ".join(_written(cell) for cell in row.parts) for row in node.parts)
        return "(" + " | ".join(rows) + ")"
    return node.text


def _row(node: Node) -> str:
    text = ""
    for number, part in enumerate(node.parts):
        piece = _written(part)
        if number and part.kind in ("letter", "scripts") and _is_function(node.parts[number - 1]):
            piece = f"({piece})"
        if part.kind == "sign" and piece in _SPACED and number and text[-1:] not in "(,= ":
            piece = f" {piece} "
        elif part.kind == "sign" and piece == ",":
            piece = ", "
        elif piece and text and _collide(node.parts[number - 1], part, text, piece):
            piece = f" {piece}"
        text += piece if not (text.endswith(" ") and piece.startswith(" ")) else piece.lstrip()
    return text.strip()


def _is_function(node: Node) -> bool:
    """Whether a part is a function whose argument follows, perhaps with a power; det e is not."""
    base = node.parts[0] if node.kind == "scripts" else node
    return base.kind == "word" and base.text in FUNCTIONS and base.text != "det"


def _collide(before: Node, after: Node, text: str, piece: str) -> bool:
    """Whether two parts side by side would be read as one."""
    if after.kind in ("word", "fraction", "root") and before.kind in (*_BINDING, "fraction"):
        return True
    if before.kind == "word":
        return after.kind != "fence" and piece[0] != "(" and before.text != "d"
    if before.kind in ("scripts", "accent"):
        return (
            piece[0] != "("
            and after.kind in _BINDING
            and after.kind != "fence"
            and piece[0] not in "_^′"
        )
    return before.kind == "fraction" and after.kind in _BINDING


def _grouped(node: Node, whole: bool = False) -> str:
    """In brackets where it is a sum or, if that counts, more than one thing."""
    inner = _written(node)
    several = node.kind == "fraction" or (node.kind == "row" and len(node.parts) > 1)
    if not several or not (whole or " + " in inner or " - " in inner):
        return inner
    kinds = [part.kind for part in node.parts]
    return inner if kinds in (["word", "fence"], ["scripts", "fence"]) else f"({inner})"


def _scripts(node: Node) -> str:
    base, below, above = node.parts
    if base.kind == "word" and base.text == "e":
        return f"exp({_written(above)})"
    text = _written(base) if base is not EMPTY else ""
    for mark, part in (("_", below), ("^", above)):
        if part is EMPTY:
            continue
        inner = _written(part)
        if inner and set(inner) == {"′"}:
            text += inner
        else:
            text += f"{mark}({inner})" if _is_composed(part, inner) else mark + inner
    return text


def _is_composed(part: Node, text: str) -> bool:
    """Whether a script needs brackets: x^(2k), but g^ij, where letters are indices."""
    if part.kind != "row":
        return part.kind == "fraction"
    return any(sign in text for sign in "+-= ") or any(x.kind == "number" for x in part.parts)
