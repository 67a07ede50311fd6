"""labels: a symbol with its indices in their places, as text and LaTeX."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import TYPE_CHECKING

from geomtorsion.pictures.latex import latex_name
from geomtorsion.pictures.text import greek_name

if TYPE_CHECKING:
    from geomtorsion.geometry import Tensor

Index = tuple[int, ...]


def letters(slots: str) -> list[str]:
    """A letter for each slot: a, b, c, ... for coordinates, i, j, k, ... for frame vectors.

    Examples
    --------
    >>> letters("dDU")
    ['a', 'i', 'j']
    """
    coordinate, frame = iter("abcdefgh"), iter("ijklmnpq")
    return [next(frame) if slot in "DU" else next(coordinate) for slot in slots]


def text_label(symbol: str, marks: Sequence[str], slots: str) -> str:
    """Symbol with marks below and above, in order.

    Examples
    --------
    >>> text_label("Γ", ["t", "r", "t"], "ddu"), text_label("Γ", ["φ1", "φ2", "φ1"], "ddu")
    ('Γ_{tr}^t', 'Γ_{φ1 φ2}^{φ1}')
    """
    parts = [symbol]
    for up, run in _runs(marks, slots):
        joined = ("" if all(len(mark) == 1 for mark in run) else " ").join(run)
        parts.append(f"{'^' if up else '_'}{joined if len(joined) == 1 else f'{{{joined}}}'}")
    return "".join(parts)


def latex_label(symbol: str, marks: Sequence[str], slots: str) -> str:
    """Symbol with marks below and above, each kept in its own column.

    Examples
    --------
    >>> latex_label("S", ["t", "r", "t"], "ddu")
    'S_{t r}{}^{t}'
    """
    parts = [symbol]
    for number, (up, run) in enumerate(_runs(marks, slots)):
        gap = "{}" if number else ""
        parts.append(f"{gap}{'^' if up else '_'}{{{' '.join(run)}}}")
    return "".join(parts)


def text_marks(tensor: Tensor, index: Index, *, greek: bool = True) -> list[str]:
    """Index values as text: names of coordinates, numbers of frame vectors counted from 1."""
    names = [symbol.name for symbol in tensor.frame.coordinates]
    shown = [greek_name(name) for name in names] if greek else names
    return [str(k + 1) if slot in "DU" else shown[k] for slot, k in _places(tensor, index)]


def latex_marks(tensor: Tensor, index: Index) -> list[str]:
    """Index values in LaTeX: names of coordinates, numbers of frame vectors from 1, with a hat."""
    names = [latex_name(symbol.name) for symbol in tensor.frame.coordinates]
    return [rf"\hat{{{k + 1}}}" if slot in "DU" else names[k] for slot, k in _places(tensor, index)]


def _places(tensor: Tensor, index: Index) -> list[tuple[str, int]]:
    return list(zip(tensor.slots, index, strict=True))


def _runs(marks: Sequence[str], slots: str) -> list[tuple[bool, list[str]]]:
    """Marks that stand side by side, with whether they stand above."""
    pairs = list(zip(slots, marks, strict=True))
    runs = groupby(pairs, key=lambda pair: pair[0] in "uU")
    return [(up, [mark for _, mark in run]) for up, run in runs]
