"""problems: what a curve is solved from, read from options, and said in lines."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, SupportsFloat

from geomtorsion.checks import shown
from geomtorsion.cli.values import named_numbers, number, numbers
from geomtorsion.curves import CurveProblem
from geomtorsion.errors import UnknownNameError
from geomtorsion.ode import Engine, RungeKutta, Stiff, Taylor

ENGINES = {"taylor": Taylor, "rungekutta": RungeKutta, "stiff": Stiff}


def engine_of(name: str) -> Engine | None:
    """The engine of a name; None, which lets the solver choose, for auto."""
    if name == "auto":
        return None
    if name.lower() not in ENGINES:
        raise UnknownNameError(
            f"there is no engine {shown(name)}. There are auto, {', '.join(ENGINES)}."
        )
    return ENGINES[name.lower()]()


def start_options(
    start: str | None,
    velocity: str | None,
    frame_velocity: str | None,
    t: str | None,
    parameters: list[str] | None,
    moments: str | None,
) -> dict[str, Any]:
    """The arguments of a pair of curves, from options as they were typed."""
    return {
        "start": numbers(start, "start"),
        "velocity": numbers(velocity, "velocity"),
        "frame_velocity": numbers(frame_velocity, "frame velocity"),
        "t": None if t is None else number(t, "t"),
        "parameters": named_numbers(parameters or ()),
        "moments": numbers(moments, "moments"),
    }


def start_lines(
    problem: CurveProblem, chosen: Sequence[str], last: float | None = None
) -> list[str]:
    """Start, velocity, parameters and duration, with a word where they were chosen."""
    names = problem.coordinates
    facts = {
        "start": _pairs(names, problem.start or ()),
        "velocity": _pairs([f"{name}'" for name in names], problem.velocity),
        "parameters": _pairs(problem.parameters.keys(), problem.parameters.values()),
        "t": "" if last is None else f"0 to {last:g}",
    }
    return [
        f"{key:<11}{text}{'  (chosen)' if key in chosen else ''}"
        for key, text in facts.items()
        if text
    ]


def _pairs(names: Iterable[str], values: Iterable[SupportsFloat]) -> str:
    return ", ".join(
        f"{name} = {float(value):.6g}" for name, value in zip(names, values, strict=True)
    )
