"""Index types: the kind (coordinate, frame) and the position (up, down) of each index."""

from __future__ import annotations

KINDS = {"d": "coordinate", "u": "coordinate", "D": "frame", "U": "frame"}
POSITIONS = {"d": "down", "D": "down", "u": "up", "U": "up"}
# The matrix of a frame that turns a slot into another one, and whether it is transposed for that.
EXCHANGES = {
    "uU": ("coframe", False), "Uu": ("legs", False), "dD": ("legs", True), "Dd": ("coframe", True),
    "du": ("inverse_metric", False), "ud": ("metric", False),
    "DU": ("inverse_eta", False), "UD": ("eta", False),
}  # fmt: skip
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
