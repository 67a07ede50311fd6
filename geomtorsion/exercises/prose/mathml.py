"""MathML: formulas for a browser, without script and without network."""

from __future__ import annotations

from html import escape

from geomtorsion.exercises.prose.formula import EMPTY, Node, tree_of

_FENCES = "()[]|"
_PREFIXED = '<mo form="prefix">−</mo>'
_LEADING = ("=", ",", "(", "[")
_THIN = '<mspace width="0.17em"/>'


def mathml_of(latex: str, *, display: bool = False) -> str:
    r"""A formula as a math element.

    Examples
    --------
    >>> mathml_of(r"\tfrac12")
    '<math><mfrac><mn>1</mn><mn>2</mn></mfrac></math>'
    """
    kind = ' display="block"' if display else ""
    return f"<math{kind}>{_written(tree_of(latex))}</math>"


def _written(node: Node) -> str:
    return _WRITERS[node.kind](node)


def _row(node: Node) -> str:
    """Parts side by side; a function stands a little apart from what comes before."""
    found = []
    for number, part in enumerate(node.parts):
        named = part.kind == "word" or (part.kind == "scripts" and part.parts[0].kind == "word")
        if number and named and node.parts[number - 1].kind not in ("sign", "space"):
            found.append(_THIN)
        leads = not number or (node.parts[number - 1].text in _LEADING)
        found.append(_PREFIXED if part.text == "-" and leads else _written(part))
    return f"<mrow>{''.join(found)}</mrow>"


def _letter(node: Node) -> str:
    upright = ' mathvariant="normal"' if "Α" <= node.text <= "Ω" else ""
    return f"<mi{upright}>{escape(node.text)}</mi>"


def _sign(node: Node) -> str:
    if node.text == "∂":
        # As an operator it would stand apart from what it differentiates.
        return "<mi>∂</mi>"
    sign = "−" if node.text == "-" else node.text
    still = ' stretchy="false"' if sign in _FENCES else ""
    tight = ' lspace="0" rspace="0"' if sign in "/′" else ""
    return f"<mo{still}{tight}>{escape(sign)}</mo>"


def _word(node: Node) -> str:
    if " " in node.text:
        return f"<mtext>{escape(node.text)}</mtext>"
    if node.text == "d":
        return '<mi mathvariant="normal">d</mi>'
    return f"<mi>{escape(node.text)}</mi>"


def _fraction(node: Node) -> str:
    return f"<mfrac>{''.join(map(_written, node.parts))}</mfrac>"


def _scripts(node: Node) -> str:
    base, below, above = node.parts
    inner = _written(base) if base is not EMPTY else "<mrow></mrow>"
    if below is EMPTY:
        return f"<msup>{inner}{_written(above)}</msup>"
    if above is EMPTY:
        return f"<msub>{inner}{_written(below)}</msub>"
    return f"<msubsup>{inner}{_written(below)}{_written(above)}</msubsup>"


def _accent(node: Node) -> str:
    mark = f'<mo stretchy="false">{node.text}</mo>'
    return f"<mover>{_written(node.parts[0])}{mark}</mover>"


def _fence(node: Node) -> str:
    left, right = (escape(x) if x != "." else "" for x in node.text)
    inner = "".join(map(_written, node.parts))
    tall = "<mfrac" in inner or "<mtable" in inner
    mark = "<mo>" if tall else '<mo stretchy="false">'
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
    "root": lambda node: f"<msqrt>{_written(node.parts[0])}</msqrt>",
    "scripts": _scripts,
    "accent": _accent,
    "fence": _fence,
    "matrix": _matrix,
}
