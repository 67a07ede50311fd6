"""Slots: the kinds and positions of indices, and the matrices that change them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from geomtorsion.geometry.components import Row

if TYPE_CHECKING:
    from geomtorsion.geometry.frame import Frame

KINDS = {"d": "coordinate", "u": "coordinate", "D": "frame", "U": "frame"}
POSITIONS = {"d": "down", "D": "down", "u": "up", "U": "up"}
_RAISED, _LOWERED = str.maketrans("dD", "uU"), str.maketrans("uU", "dD")


def moved(slots: str, k: int | None, up: bool) -> str:
    """Slots with index k, or all indices, up or down.

    Examples
    --------
    >>> moved("ddU", 0, up=True), moved("ddU", None, up=False)
    ('udU', 'ddD')
    """
    changed = slots.translate(_RAISED if up else _LOWERED)
    return changed if k is None else slots[:k] + changed[k] + slots[k + 1 :]


def exchange(frame: Frame, old: str, new: str) -> tuple[Sequence[Row], Sequence[Row]]:
    """Sparse matrix that turns a slot of one kind into another: rows and columns of it."""
    if old + new in ("uU", "Uu"):
        matrix = frame.coframe.components if new == "U" else frame.legs.components
        return matrix.rows, matrix.columns
    if old + new in ("dD", "Dd"):
        matrix = frame.legs.components if new == "D" else frame.coframe.components
        return matrix.columns, matrix.rows
    matrices = {"du": "inverse_metric", "ud": "metric", "DU": "inverse_eta", "UD": "eta"}
    matrix = getattr(frame, matrices[old + new]).components
    return matrix.rows, matrix.rows
