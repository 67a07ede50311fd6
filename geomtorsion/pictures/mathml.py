"""mathml: formulas for a browser, in MathML Core, which needs no script and no network."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from geomtorsion.pictures.formula import EMPTY, Node, tree_of
from geomtorsion.pictures.latex import latex_text

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
    return f"<mi{upright}>{escape(node.text)}</mi>"


def _sign(node: Node) -> str:
    if node.text == "∂":
        # As an operator it would stand apart from what it differentiates.
        return "<mi>∂</mi>"
    sign = "−" if node.text == "-" else node.text
    still = ' stretchy="false"' if sign in _FENCES else ""
    tight = ' lspace="0" rspace="0"' if sign[:1] in "/′" else ""
    return f"<mo{still}{tight}>{escape(sign)}</mo>"


def _word(node: Node) -> str:
    if " " in node.text:
        # Markup would swallow blanks at the ends.
        return f"<mtext>{escape(node.text).replace(' ', chr(0xA0))}</mtext>"
    upright = ' mathvariant="normal"' if len(node.text) == 1 else ""
    return f"<mi{upright}>{escape(node.text)}</mi>"


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
    left, right = (escape(x) if x != "." else "" for x in node.text)
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
