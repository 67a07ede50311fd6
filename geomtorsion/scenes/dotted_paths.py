"""Dotted paths: scenes with other values, each named by where it stands."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from typing import TYPE_CHECKING, Any

from geomtorsion.checks import near_names
from geomtorsion.errors import UnknownNameError

if TYPE_CHECKING:
    from geomtorsion.scenes.scene import Scene

# Of these only one is given: a new one takes the place of what was given before.
ONE_OF = (("euler", "quaternion", "matrix"), ("moments", "inertia"))
_STEP = re.compile(r"([^\W\d]\w*)((?:\[\d+\])*)")


def with_values(scene: Scene, changes: Mapping[str, Any]) -> Scene:
    """The scene with each path set to its value; all at once, so that checks see the whole."""
    # Changes are gathered first: half of them alone could be a body that cannot be.
    table: dict[str, Any] = {}
    keyed = dict(scene.keyed)
    for path, value in changes.items():
        head, *rest = _steps(path)
        name, places = head
        # Effects are called by their keys, as gravity.g; all else by fields of the scene.
        if name in keyed:
            if not rest:
                raise UnknownNameError(f"{path!r} names a whole effect. {_inside(keyed[name])}")
            keyed[name] = _set(keyed[name], rest, value, path)
        elif name in (item.name for item in fields(scene)) and name != "effects":
            now = table.get(name, getattr(scene, name))
            table[name] = _set_here(now, places, rest, value, path)
        else:
            known = (*(item.name for item in fields(scene) if item.name != "effects"), *keyed)
            raise UnknownNameError(f"{path!r} leads nowhere. {_near(name, known)}")
    return replace(scene, effects=tuple(keyed.values()), **table)


def _steps(path: str) -> list[tuple[str, tuple[int, ...]]]:
    """Names and indices of a path."""
    found = []
    for part in str(path).split("."):
        match = _STEP.fullmatch(part)
        if match is None:
            raise UnknownNameError(
                f"{path!r} is no path. Write names with dots and indices, as body.moments[2]."
            )
        found.append((match[1], tuple(int(k) for k in re.findall(r"\d+", match[2]))))
    return found


def _set(thing: Any, steps: list[tuple[str, tuple[int, ...]]], value: Any, path: str) -> Any:
    """A dataclass, or a table of names, with what is at the first step changed."""
    (name, places), *rest = steps
    if isinstance(thing, Mapping) and name in thing:
        return {**thing, name: _set_here(thing[name], places, rest, value, path)}
    known = {item.name for item in fields(thing)} if is_dataclass(thing) else set()
    if name not in known:
        raise UnknownNameError(f"{path!r} leads nowhere: {_inside(thing, name)}")
    new = _set_here(getattr(thing, name), places, rest, value, path)
    instead = next((set(names) - {name} for names in ONE_OF if name in names), ())
    others = {other: None for other in instead if new is not None and other in known}
    # That it is a dataclass is known from its fields, which types do not see.
    return replace(thing, **{name: new}, **others)  # type: ignore[type-var]


def _set_here(now: Any, places: tuple[int, ...], rest: Any, value: Any, path: str) -> Any:
    """A value with the element at these places changed."""
    if places:
        if not isinstance(now, tuple | list) or places[0] >= len(now):
            count = len(now) if isinstance(now, tuple | list) else 0
            raise UnknownNameError(
                f"{path!r}: there is no [{places[0]}] among {count} values here."
                if count
                else f"{path!r}: {now!r} has no components; set it as a whole first."
            )
        items = list(now)
        items[places[0]] = _set_here(items[places[0]], places[1:], rest, value, path)
        return tuple(items)
    return _set(now, rest, value, path) if rest else value


def _inside(thing: Any, name: str = "") -> str:
    """What there is to be set inside a thing."""
    if isinstance(thing, Mapping):
        known = tuple(thing)
    elif is_dataclass(thing):
        known = tuple(item.name for item in fields(thing))
    else:
        return f"{thing!r} has no parts."
    return _near(name, known) if known else "It has nothing to be set."


def _near(name: str, known: tuple[str, ...]) -> str:
    near = near_names(name, known) if name else ""
    listed = f"There are {', '.join(known)}."
    return f"Did you mean {near}? {listed}" if near else listed
