"""Selection: the states and effects that a scene needs or omits, with reasons."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.pictures.scene_plan import plan_picture
from geomtorsion.pictures.style import pictured, svg_text
from geomtorsion.scenes.assembly import WORK, Assembly, power_of
from geomtorsion.scenes.context import (
    ATTITUDE,
    OMEGA,
    POSITION,
    QUATERNION,
    TIME,
    VELOCITY,
    VERTICAL,
    Symbols,
    group_of,
)
from geomtorsion.scenes.observables import Observable, observable
from geomtorsion.support.caching import cached_property

if TYPE_CHECKING:
    import networkx as nx
    from matplotlib.figure import Figure

# Names of groups whose states are included or omitted together; other states form no group.
_TOGETHER = {
    **dict.fromkeys((*ATTITUDE[0, :], *ATTITUDE[1, :], *QUATERNION), "attitude"),
    **dict.fromkeys(VERTICAL, "vertical"),
}


# Cause of a row -> its sentence; a page in another language has its own.
_CAUSES = {
    "acts": "{title}; acts on {states}",
    "stops": "{title}; watched, or stops the motion",
    "unneeded": "acts only on {states}; no output needs these",
    "idle": "acts on nothing here",
    "watched": "{states}: watched",
    "watched_as": "{states}: watched as {users}",
    "stopping": "{states}: needed to stop by {users}",
    "needed": "{states}: needed by {users}",
    "needed_through": "{states}: needed by {users}, through {effects}",
    "constant": "{states} constant: no force acts along it",
    "no_user": "no output and no effect needs it",
    "vertical": "the vertical is enough: nothing needs the rotation about it",
    "part": "part of the attitude",
    "constraint": "given by the constraint",
}


@dataclass(frozen=True)
class SelectionRow:
    """One line of a selection: an effect, or a group of states.

    kind: "effect" or "states"; name: what it is; inside: whether it is in the equations.
    cause: why, a word; title: of an effect; states: that it acts on, or that it has; users:
    outputs, groups or effects that need it; effects: through which they do.

    Examples
    --------
    >>> row = SelectionRow("states", "vertical", True, "needed", states=("n1..n3",), users=("x",))
    >>> row.reason
    'n1..n3: needed by x'
    """

    kind: str
    name: str
    inside: bool
    cause: str
    title: str = ""
    states: tuple[str, ...] = ()
    users: tuple[str, ...] = ()
    effects: tuple[str, ...] = ()

    @property
    def reason(self) -> str:
        """The cause as a sentence."""
        states, users, effects = map(", ".join, (self.states, self.users, self.effects))
        sentence = _CAUSES[self.cause]
        return sentence.format(title=self.title, states=states, users=users, effects=effects)


@dataclass(frozen=True, eq=False)
class StateSelection:
    """States that a scene integrates: those that its outputs and effects need.

    title: of the scene.
    assembly: all equations, before the selection.
    watch: the requested outputs.
    titles: key of each effect -> its title.

    Examples
    --------
    >>> from geomtorsion.scenes import Body, Scene, State
    >>> body = Body(moments=(1, 2, 3))
    >>> scene = Scene(body, start=State(omega=(0, 1, 1e-3)), watch=["omega"], t=9)
    >>> scene.selection.states
    ('Omega1', 'Omega2', 'Omega3')
    """

    title: str
    assembly: Assembly
    watch: tuple[Observable, ...]
    titles: Mapping[str, str]

    def __reduce__(self) -> tuple[object, ...]:
        names = tuple(item.name for item in self.watch)
        return _selected_again, (self.title, self.assembly, names, self.titles)

    # -- the graph -------------------------------------------------------------------------------

    @cached_property
    def graph(self) -> nx.DiGraph[str]:
        """Quantities, states and effects, with edges from each requirement to its dependents."""
        import networkx as nx  # 0.14 s to load, and only here

        graph = nx.DiGraph()
        for item in self.watch:
            graph.add_node(f"watch {item.name}", kind="watch")
            self._needs(graph, f"watch {item.name}", item.made_of(self.assembly))
        if self.assembly.constraint is None:
            for symbol in VELOCITY:
                graph.add_node(symbol.name, kind="state")
        for symbol, rate in self.assembly.rates.items():
            graph.add_node(symbol.name, kind="state")
            self._needs(graph, symbol.name, (rate,))
        for name, symbols in (("vertical", VERTICAL), ("attitude", tuple(ATTITUDE[:2, :]))):
            graph.add_node(name, kind="state")
            omega = tuple(self.assembly.omega)
            if any(self.assembly.turning(symbol) != 0 for symbol in symbols):
                self._needs(graph, name, omega)
        # Who follows the attitude has the vertical for nothing; it needs no states of its own.
        graph.add_edge("attitude", "vertical", kind="gives")
        for key in self.titles:
            graph.add_node(f"effect {key}", kind="effect")
            for name in self._touched(key):
                graph.add_edge(f"effect {key}", name)
        for key, part in self.assembly.parts.items():
            if part.stop is not None:
                graph.add_node(f"stop {key}", kind="watch")
                self._needs(graph, f"stop {key}", (self.assembly.constrained(part.stop),))
        return graph

    def _needs(self, graph: nx.DiGraph[str], name: str, expressions: Sequence[sp.Expr]) -> None:
        """Edges from every state in the expressions to the node."""
        for expression in expressions:
            for symbol in expression.free_symbols:
                needed = str(_TOGETHER.get(symbol, symbol.name))
                if symbol.name not in self.assembly.values and symbol != TIME and needed != name:
                    graph.add_edge(needed, name)

    def _touched(self, key: str) -> set[str]:
        """States whose rates an effect takes part in."""
        if key == "spin":
            return {symbol.name for symbol in self.assembly.speeds}
        free = self.assembly.constraint is None
        if key == "drift":
            return {symbol.name for symbol in (*POSITION, *VELOCITY)} if free else set()
        part = self.assembly.parts[key]
        names = {*part.states, *part.replaces}
        speeds = {symbol.name for symbol in self.assembly.speeds}
        # A force acts on the rotation too, where a constraint couples the two.
        turning = (part.moment, part.momentum, part.inertia, part.constraint)
        if part.naive or any(v is not None for v in turning):
            names |= speeds
        if part.force is not None:
            pairs = zip(VELOCITY, part.force, strict=True)
            names |= {v.name for v, f in pairs if f != 0} if free else speeds
        if power_of(part) != 0:
            names.add(WORK.name)
        return names

    @cached_property
    def _needed(self) -> frozenset[str]:
        """Nodes from which a watched quantity can be reached, but for vertical in attitude."""
        import networkx as nx  # as above

        graph = nx.subgraph_view(
            self.graph,
            filter_node=lambda n: self.graph.nodes[n].get("kind") != "effect",
            filter_edge=lambda a, b: self.graph.edges[a, b].get("kind") != "gives",
        )
        nodes: set[str] = set()
        for name, kind in self.graph.nodes(data="kind"):
            if kind == "watch":
                nodes |= nx.ancestors(graph, name)
        return frozenset(nodes)

    # -- results ---------------------------------------------------------------------------------

    @cached_property
    def symbols(self) -> Symbols:
        """States in the order in which they are solved for."""
        needed = self._needed
        rates = self.assembly.rates
        symbols = [s for s in self.assembly.speeds if s.name in needed]
        if "attitude" in needed:
            symbols += QUATERNION
        elif "vertical" in needed:
            symbols += VERTICAL
        symbols += [s for s in (*POSITION, *VELOCITY) if s.name in needed and s in rates]
        symbols += [s for s in rates if s.name in needed and s not in symbols]
        # A velocity that nothing changes is a number, not a state.
        moving = [s for s in symbols if not (s in VELOCITY and rates[s] == 0)]
        # A flow has states; where nothing that is watched moves, the rotation is followed.
        return tuple(moving or symbols or self.assembly.speeds)

    @cached_property
    def constants(self) -> Symbols:
        """Components of the velocity that are needed, but do not change."""
        changing = {*self.assembly.rates} - {*self.symbols}
        return tuple(s for s in VELOCITY if s.name in self._needed and s in changing)

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states that are solved for."""
        return tuple(symbol.name for symbol in self.symbols)

    @property
    def uses_quaternion(self) -> bool:
        """Whether the whole attitude is followed."""
        return "attitude" in self._needed

    @cached_property
    def effects(self) -> tuple[str, ...]:
        """Keys of the included effects."""
        solved = {*self.states, *(s.name for s in self.constants)}
        provided = {item.name for item in self.watch}
        keys = []
        for key in self.titles:
            part = self.assembly.parts.get(key)
            stops = part is not None and part.stop is not None
            outputs = set(part.outputs) if part else set()
            if self._touched(key) & solved or outputs & provided or stops:
                keys.append(key)
        return tuple(keys)

    @cached_property
    def rows(self) -> tuple[SelectionRow, ...]:
        """Every effect and every group of states, with the reason."""
        return _rows(self)

    @property
    def left_out(self) -> tuple[str, ...]:
        """Names of the omitted effects and groups of states."""
        return tuple(row.name for row in self.rows if not row.inside)

    def draw(self) -> str:
        """The graph as SVG text, the same each time; omitted nodes are grey."""
        return svg_text(selection_figure(self))

    def _repr_html_(self) -> str:
        return pictured(str(self), lambda: selection_figure(self))

    def __str__(self) -> str:
        count = len(self.states)
        asked = ", ".join(item.name for item in self.watch)
        heading = f"{self.title or 'scene'}: {count} equation{'s' * (count != 1)} for {asked}"
        width = max(len(row.name) for row in self.rows)
        lines = [heading]
        for inside, mark in ((True, "in"), (False, "omitted")):
            lines += [
                f"{mark:<9} {row.kind:<7} {row.name:<{width}}  {row.reason}"
                for row in self.rows
                if row.inside == inside
            ]
        return "\n".join(lines)

    def __repr__(self) -> str:
        return str(self)


# -- reasons --------------------------------------------------------------------------------------


def _rows(selection: StateSelection) -> tuple[SelectionRow, ...]:
    """All rows: effects in the order of the scene, then groups of states."""
    rows = []
    solved = set(selection.states) | {s.name for s in selection.constants}
    for key, title in selection.titles.items():
        inside, touched = key in selection.effects, selection._touched(key)
        acts = _listed(touched & solved if inside else touched)
        cause = ("acts" if acts else "stops") if inside else ("unneeded" if acts else "idle")
        rows.append(SelectionRow("effect", key, inside, cause, title, acts))
    return (*rows, *_state_rows(selection))


def _state_rows(selection: StateSelection) -> Iterable[SelectionRow]:
    """Groups of states."""
    groups: dict[str, list[str]] = {}
    for name in selection.states:
        groups.setdefault(group_of(name), []).append(name)
    for group, members in groups.items():
        node = group if group in ("attitude", "vertical") else members[0]
        cause, users, effects = _wanted(selection, node)
        states = _listed(members)
        yield SelectionRow(
            "states", group, True, cause, states=states, users=users, effects=effects
        )
    if selection.constants:
        names = _listed(s.name for s in selection.constants)
        yield SelectionRow("states", "velocity", False, "constant", states=names)
    substitutions = selection.assembly.substitutions
    listed_groups = {*groups, *(["velocity"] if selection.constants else [])}
    for group, symbols in (
        ("rotation", OMEGA), ("attitude", QUATERNION), ("vertical", VERTICAL),
        ("position", POSITION), ("velocity", VELOCITY),
    ):  # fmt: skip
        if group in listed_groups:
            continue
        cause = "no_user"
        if group == "attitude" and "vertical" in listed_groups:
            cause = "vertical"
        elif group == "vertical" and "attitude" in listed_groups:
            cause = "part"
        elif symbols[0] in substitutions:
            cause = "constraint"
        yield SelectionRow("states", group, False, cause)


def _wanted(selection: StateSelection, node: str) -> tuple[str, tuple[str, ...], tuple[str, ...]]:
    """Cause, users and effects of a state: outputs first, then the rates that contain it."""
    graph, needed = selection.graph, selection._needed
    watchers = [
        other.removeprefix("watch ")
        for other in graph.successors(node)
        if other.startswith("watch ")
    ]
    if watchers:
        return ("watched", (), ()) if watchers == [node] else ("watched_as", _listed(watchers), ())
    stops = [other for other in graph.successors(node) if other.startswith("stop ")]
    if stops:
        return "stopping", _listed(other.removeprefix("stop ") for other in stops), ()
    users = [o for o in graph.successors(node) if o in needed and not o.startswith("effect ")]
    helpers = [
        key
        for key in selection.effects
        if key not in ("spin", "drift") and set(users) & selection._touched(key)
    ]
    groups = _listed(dict.fromkeys(map(group_of, users)))
    if helpers and node != "rotation":
        return "needed_through", groups, _listed(helpers)
    return "needed", groups, ()


def _listed(names: Iterable[str]) -> tuple[str, ...]:
    """Names, in order, runs such as Omega1, Omega2, Omega3 shortened."""
    names = list(names) if isinstance(names, list | tuple | dict) else sorted(names)
    for run in (OMEGA, QUATERNION, VERTICAL):
        whole = [s.name for s in run]
        if set(whole) <= set(names):
            place = min(names.index(name) for name in whole)
            names = [n for n in names if n not in whole]
            names.insert(place, f"{whole[0]}..{whole[-1]}")
    return tuple(names)


def _selected_again(
    title: str, assembly: Assembly, names: Iterable[str], titles: Mapping[str, str]
) -> StateSelection:
    """A selection from the plain data that `StateSelection.__reduce__` gives."""
    watch = tuple(observable(name, assembly) for name in names)
    return StateSelection(title, assembly, watch, titles)


def selection_figure(selection: StateSelection) -> Figure:
    """Outputs, the states that they need, and the effects on these, as a figure.

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
    """Pairs (dependent, requirement), each once."""
    edges: dict[tuple[str, str], None] = {}
    # An omitted state that another one contains is read from that one.
    givers = {b: a for a, b, kind in selection.graph.edges(data="kind") if kind == "gives"}
    for needed, user, kind in selection.graph.edges(data="kind"):
        if kind == "gives" or user.startswith("stop "):
            continue
        kind, _, name = needed.partition(" ")
        start = boxes.get(group_of(user))
        if user.startswith("watch "):
            start = user.removeprefix("watch ")
        if kind == "effect":
            if start and name in selection.effects:
                edges[start, _effect(selection, name)] = None
            continue
        group = group_of(needed)
        end = boxes.get(group if group in boxes else givers.get(group, group))
        if start and end and start != end:
            edges[start, end] = None
    return list(edges)


def _effect(selection: StateSelection, key: str) -> str:
    """The box of an effect; distinct from an output of the same name."""
    return f"{key} (effect)" if key in [item.name for item in selection.watch] else key


def _box(group: str, names: list[str]) -> str:
    """A group of states with its states."""
    if names == [group]:
        return f"state {group}"
    shown = ", ".join(names) if len(names) <= 3 else f"{names[0]}..{names[-1]}"
    return f"{group}: {shown}"
