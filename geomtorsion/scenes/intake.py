"""Intake: what users give to a scene, checked once at the door."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from geomtorsion.errors import SceneError, StartError
from geomtorsion.scenes.effects import EFFECTS, Effect

if TYPE_CHECKING:
    from geomtorsion.scenes.plan import ScenePlan


def watch_list(watch: Any) -> tuple[str, ...]:
    """Names of what to report, each once."""
    names = tuple(watch) if isinstance(watch, list | tuple | set | dict) else (watch,)
    if not names:
        raise SceneError('watch is empty: name what to report, for instance "omega".')
    for name in names:
        if not isinstance(name, str):
            raise SceneError(f'watch: {name!r} is no name. Give texts, for instance ["omega"].')
    return tuple(dict.fromkeys(names))


def effect_list(effects: Any) -> tuple[Effect, ...]:
    """Effects, each at most once unless it may be there several times, none against another."""
    if isinstance(effects, Effect):
        effects = (effects,)
    try:
        listed = tuple(effects)
    except TypeError:
        listed = (effects,)
    for effect in listed:
        if not isinstance(effect, Effect):
            name = getattr(effect, "__name__", repr(effect))
            hint = f" Write {name}(...)." if isinstance(effect, type) else ""
            known = ", ".join(kind.__name__ for kind in EFFECTS)
            raise SceneError(f"effects: {name} is no effect.{hint} There are {known}.")
    keys = [effect.key for effect in listed]
    for effect in listed:
        if keys.count(effect.key) > 1 and not effect.several:
            raise SceneError(f"the effect {effect.key} is there twice. Keep one of them.")
        for other in listed:
            if other.key in effect.excludes:
                raise SceneError(
                    f"{effect.key} and {other.key} contradict each other: {effect.title}; "
                    f"{other.title}. Keep one of them."
                )
    return listed


def missing_attitude(plan: ScenePlan) -> StartError:
    """The error that the start says nothing of the attitude."""
    who = [row.why for row in plan.rows if row.inside and row.name in ("attitude", "vertical")]
    return StartError(
        f"the start has no attitude, which is needed ({'; '.join(who)}). "
        "Give State(..., euler=(0, 0, 0)), a quaternion or a matrix."
    )
