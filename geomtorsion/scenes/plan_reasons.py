"""Plan reasons: why each effect and each group of states is in or left out."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from geomtorsion.scenes.context import OMEGA, POSITION, QUATERNION, VELOCITY, VERTICAL
from geomtorsion.scenes.plan import PlanRow

if TYPE_CHECKING:
    from geomtorsion.scenes.plan import ScenePlan

_GROUP_NAMES: dict[str, str] = {
    **dict.fromkeys((s.name for s in OMEGA), "rotation"),
    **dict.fromkeys((s.name for s in QUATERNION), "attitude"),
    **dict.fromkeys((s.name for s in VERTICAL), "vertical"),
    **dict.fromkeys((s.name for s in POSITION), "position"),
    **dict.fromkeys((s.name for s in VELOCITY), "velocity"),
}


def group_of(name: str) -> str:
    """The group that a state belongs to; other nodes of the graph stand for themselves.

    Examples
    --------
    >>> group_of("q2"), group_of("vz"), group_of("work")
    ('attitude', 'velocity', 'work')
    """
    return _GROUP_NAMES.get(name, name)


def rows(plan: ScenePlan) -> tuple[PlanRow, ...]:
    """All rows: effects in the order of the scene, then groups of states."""
    found = []
    solved = set(plan.states) | {s.name for s in plan.constants}
    for key, title in plan.titles.items():
        inside = key in plan.effects
        if inside:
            acts = _listed(plan._touched(key) & solved)
            why = f"{title}; acts on {acts}" if acts else f"{title}; watched, or stops the motion"
        else:
            acts = _listed(plan._touched(key))
            why = f"acts on {acts} only, which nothing that is watched needs"
            if not acts:
                why = "acts on nothing here"
        found.append(PlanRow("effect", key, inside, why))
    return (*found, *_state_rows(plan))


def _state_rows(plan: ScenePlan) -> Iterable[PlanRow]:
    """Groups of states."""
    groups: dict[str, list[str]] = {}
    for name in plan.states:
        groups.setdefault(group_of(name), []).append(name)
    for group, members in groups.items():
        node = group if group in ("attitude", "vertical") else members[0]
        yield PlanRow("states", group, True, f"{_listed(members)}: {_wanted(plan, node)}")
    if plan.constants:
        names = _listed(s.name for s in plan.constants)
        yield PlanRow("states", "velocity", False, f"{names} constant: no force acts along it")
    ties = plan.assembly.ties
    known = {*groups, *(["velocity"] if plan.constants else [])}
    for group, symbols in (
        ("rotation", OMEGA), ("attitude", QUATERNION), ("vertical", VERTICAL),
        ("position", POSITION), ("velocity", VELOCITY),
    ):  # fmt: skip
        if group in known:
            continue
        why = "nothing that is watched or acts needs it"
        if group == "attitude" and "vertical" in known:
            why = "the vertical is enough: nothing needs the turn about it"
        elif group == "vertical" and "attitude" in known:
            why = "part of the attitude"
        elif symbols[0] in ties:
            why = "given by the constraint"
        yield PlanRow("states", group, False, why)


def _wanted(plan: ScenePlan, node: str) -> str:
    """Who asks for a state: what is watched first, then the rates that contain it."""
    graph, needed = plan.graph, plan._needed
    watchers = [
        other.removeprefix("watch ")
        for other in graph.successors(node)
        if other.startswith("watch ")
    ]
    if watchers:
        return f"watched as {_listed(watchers)}" if watchers != [node] else "watched"
    stops = [other for other in graph.successors(node) if other.startswith("stop ")]
    if stops:
        return f"needed to stop by {_listed(other.removeprefix('stop ') for other in stops)}"
    users = [o for o in graph.successors(node) if o in needed and not o.startswith("effect ")]
    helpers = [
        key
        for key in plan.effects
        if key not in ("spin", "drift") and set(users) & plan._touched(key)
    ]
    groups = dict.fromkeys(map(group_of, users))
    through = f", through {_listed(helpers)}" if helpers and node != "rotation" else ""
    return f"needed by {_listed(groups)}{through}"


def _listed(names: Iterable[str]) -> str:
    """Names, in order, runs such as Omega1, Omega2, Omega3 shortened."""
    names = list(names) if isinstance(names, list | tuple | dict) else sorted(names)
    for run in (OMEGA, QUATERNION, VERTICAL):
        whole = [s.name for s in run]
        if set(whole) <= set(names):
            place = min(names.index(name) for name in whole)
            names = [n for n in names if n not in whole]
            names.insert(place, f"{whole[0]}..{whole[-1]}")
    return ", ".join(names)
