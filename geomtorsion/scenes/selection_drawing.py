"""Selection drawing: what is watched, the states it needs, what acts, and what is left out."""

from __future__ import annotations

from io import StringIO
from typing import TYPE_CHECKING, Any

from geomtorsion.pictures.scene_plan import plan_picture
from geomtorsion.scenes.context import group_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from geomtorsion.scenes.selection import StateSelection


def selection_figure(selection: StateSelection) -> Figure:
    """What is watched, the states it needs, and the effects that act on them, as a figure.

    Raises
    ------
    MissingExtraError
        matplotlib is not installed.
    """
    watched = [item.name for item in selection.watch]
    groups: dict[str, list[str]] = {}
    for name in selection.states:
        groups.setdefault(group_of(name), []).append(name)
    boxes = {group: _box(group, names) for group, names in groups.items()}
    reasons: dict[str, str] = {}
    outside: dict[str, list[str]] = {"states": [], "effect": []}
    for row in selection.rows:
        if not row.inside and row.name not in boxes:
            name = _effect(selection, row.name) if row.kind == "effect" else row.name
            name += " (state)" * (row.kind == "states" and name in watched)
            reasons[name] = row.reason
            outside[row.kind].append(name)
    columns = {
        "watched": watched,
        "states": [*boxes.values(), *outside["states"]],
        "effects": [*(_effect(selection, key) for key in selection.effects), *outside["effect"]],
    }
    return plan_picture(columns, _edges(selection, boxes), reasons, selection.title)


def _edges(selection: StateSelection, boxes: dict[str, str]) -> list[tuple[str, str]]:
    """From what needs to what is needed, each pair once."""
    found: dict[tuple[str, str], None] = {}
    for needed, user, kind in selection.graph.edges(data="kind"):
        if kind == "gives" or user.startswith("stop "):
            continue
        kind, _, name = needed.partition(" ")
        start = boxes.get(group_of(user))
        if user.startswith("watch "):
            start = user.removeprefix("watch ")
        if kind == "effect":
            if start and name in selection.effects:
                found[start, _effect(selection, name)] = None
            continue
        end = boxes.get(group_of(needed))
        if start and end and start != end:
            found[start, end] = None
    return list(found)


def _effect(selection: StateSelection, key: str) -> str:
    """The box of an effect; another one than that of a quantity called alike."""
    return f"{key} (effect)" if key in [item.name for item in selection.watch] else key


def _box(group: str, names: list[str]) -> str:
    """A group of states with its states."""
    if names == [group]:
        return f"state {group}"
    shown = ", ".join(names) if len(names) <= 3 else f"{names[0]}..{names[-1]}"
    return f"{group}: {shown}"


def drawn(selection: StateSelection) -> str:
    """The figure as SVG text, the same each time."""
    figure: Any = selection_figure(selection)
    import matplotlib as mpl  # an extra; `selection_figure` says so where it is missing

    data = StringIO()
    with mpl.rc_context({"svg.hashsalt": "geomtorsion"}):
        figure.savefig(data, format="svg", metadata={"Date": None, "Creator": None})
    return data.getvalue()
