"""Plain: formulas as one line of text for a terminal."""

from __future__ import annotations

from geomtorsion.exercises.prose.formula import EMPTY, Node, tree_of

_MARKS = {"˙": "\u0307", "¨": "\u0308", "¯": "\u0304", "^": "\u0302", "~": "\u0303"}
_SPACED = "=+-∧×≤≥≠→≈<>"
_BINDING = ("letter", "number", "word", "scripts", "accent", "root", "fence")


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
    r"""A formula as lines: a matrix stands in its rows.

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
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    rows = ["  ".join(x.ljust(w) for x, w in zip(row, widths, strict=True)) for row in cells]
    last, middle = len(rows) - 1, len(rows) // 2
    found = []
    for k, row in enumerate(rows):
        left = "(" if not last else "/" if k == 0 else "\\" if k == last else "|"
        right = ")" if not last else "\\" if k == 0 else "/" if k == last else "|"
        lead = before if k == middle else " " * len(before)
        found.append(f"{lead}{left} {row} {right}{after if k == middle else ''}")
    return found


def _written(node: Node) -> str:
    if node.kind == "row":
        return _row(node)
    if node.kind == "space":
        return " " if node.width < 1 else "  "
    if node.kind == "fraction":
        above, below = node.parts
        return f"{_grouped(above)}/{_grouped(below, whole=True)}"
    if node.kind == "root":
        return f"sqrt({_written(node.parts[0])})"
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


_MARKED = {"˙": "dot", "¨": "ddot", "¯": "mean", "^": "hat", "~": "tilde"}


def _row(node: Node) -> str:
    text = ""
    for number, part in enumerate(node.parts):
        piece = _written(part)
        if part.kind == "sign" and piece in _SPACED and number and text[-1:] not in "(,= ":
            piece = f" {piece} "
        elif part.kind == "sign" and piece == ",":
            piece = ", "
        elif piece and text and _collide(node.parts[number - 1], part, text, piece):
            piece = f" {piece}"
        text += piece if not (text.endswith(" ") and piece.startswith(" ")) else piece.lstrip()
    return text.strip()


def _collide(before: Node, after: Node, text: str, piece: str) -> bool:
    """Whether two things side by side would be read as one."""
    if after.kind in ("word", "fraction", "root") and before.kind in (*_BINDING, "fraction"):
        return True
    if before.kind == "word":
        return after.kind != "fence" and piece[0] != "(" and before.text != "d"
    if before.kind in ("scripts", "accent"):
        return after.kind in _BINDING and after.kind != "fence" and piece[0] not in "_^′"
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
    text = _written(base) if base is not EMPTY else ""
    for mark, part in (("_", below), ("^", above)):
        if part is EMPTY:
            continue
        inner = _written(part)
        if inner and set(inner) == {"′"}:
            text += inner
        elif part.kind == "row" and any(sign in inner for sign in "+-= "):
            text += f"{mark}({inner})"
        else:
            text += mark + inner
    return text
