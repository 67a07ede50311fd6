"""MathML: formulas for a browser, without script and without network."""

from __future__ import annotations

from html import escape

from geomtorsion.exercises.prose.formula import EMPTY, Node, tree_of

_LARGE = "∮∫∑"
_FENCES = "()[]|"
_APPLY = "<mo>&#x2061;</mo>"


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
    return f"<mrow>{''.join(map(_written, node.parts))}</mrow>"


def _letter(node: Node) -> str:
    upright = ' mathvariant="normal"' if "Α" <= node.text <= "Ω" else ""
    return f"<mi{upright}>{escape(node.text)}</mi>"


def _sign(node: Node) -> str:
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
    return (
        f'<mover accent="true">{_written(node.parts[0])}'
        f'<mo stretchy="false">{node.text}</mo></mover>'
    )


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
