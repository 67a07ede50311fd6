"""values: numbers, names, starts and engines as typed, and as the output repeats them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any, SupportsFloat

from geomtorsion.curves import CurveProblem
from geomtorsion.errors import ExpressionError, StartError, UnknownNameError
from geomtorsion.exact import parse_expression
from geomtorsion.ode import Engine
from geomtorsion.ode.engines.named import SHIPPED
from geomtorsion.support.checks import cut, shown
from geomtorsion.support.files import plain_float
from geomtorsion.support.typed_text import separated


def parts(text: str) -> tuple[str, ...]:
    """Words separated by commas, without blanks and without empty ones.

    Examples
    --------
    >>> parts("torsion, ricci,")
    ('torsion', 'ricci')
    """
    return tuple(part.strip() for part in text.split(",") if part.strip())


def assigned(text: str, option: str, example: str) -> tuple[str, str]:
    """A name and the text after the first sign of equality.

    Examples
    --------
    >>> assigned("Y = R_ab R^ab", "--invariant", "Y = R_ab R^ab")
    ('Y', 'R_ab R^ab')
    """
    name, sign, value = text.partition("=")
    if not sign:
        raise UnknownNameError(
            f"{option}: expected a name, = and a formula, got {shown(text)}. Write "
            f'{option} "{example}".'
        )
    return name.strip(), value.strip()


def some_names(text: str, option: str) -> list[str]:
    """Names separated by commas; at least one, since an empty list would mean all.

    Examples
    --------
    >>> some_names("torsion, ricci,", "--only")
    ['torsion', 'ricci']
    """
    names = list(parts(text))
    if not names:
        raise UnknownNameError(
            f"{option}: expected at least one name, got {shown(text)}. Name one, or omit {option}."
        )
    return names


def number(text: str, what: str) -> float:
    """A number, written as such or as an expression such as pi/2.

    Examples
    --------
    >>> number("pi/2", "start"), number("-1e-3", "start")
    (1.5707963267948966, -0.001)
    """
    text = text.strip()
    try:
        # Tried first: 1e-300 is a number to float, and a fraction of 300 digits to the parser.
        value = plain_float(text)
    except ValueError:
        value = _expression(text, what)
    if not math.isfinite(value):
        raise StartError(f"{what}: expected a finite number, got {cut(text)}.")
    return value


def _expression(text: str, what: str) -> float:
    try:
        return float(parse_expression(text, symbols={}, functions={}, where=what))
    except (ExpressionError, TypeError):
        raise StartError(
            f"{what}: expected a number, got {shown(text)}. "
            "Write numbers separated by commas, such as 0.3,pi/2,-1e-3."
        ) from None


def numbers(text: str | None, what: str) -> list[float] | None:
    """Numbers separated by commas; None without a text.

    Examples
    --------
    >>> numbers("1, pi, sqrt(2)", "start")
    [1.0, 3.141592653589793, 1.4142135623730951]
    """
    if text is None:
        return None
    return [number(part, what) for part in text.split(",")]


def named_numbers(texts: Iterable[str]) -> dict[str, float]:
    """name=number pairs separated by commas, in one text or in several.

    Examples
    --------
    >>> named_numbers(["M=1, a=1/2"])
    {'M': 1.0, 'a': 0.5}
    """
    values: dict[str, float] = {}
    for part in parts(",".join(texts)):
        name, sign, value = part.partition("=")
        name = name.strip()
        if not sign or not name:
            raise StartError(
                f"parameters: expected NAME=NUMBER, got {shown(part)}. Write M=1,a=0.5."
            )
        if name in values:
            raise StartError(
                f"parameters: expected {cut(name)} once, got it twice. Give one value."
            )
        values[name] = number(value, f"parameter {name}")
    return values


def engine_of(name: str) -> Engine | None:
    """The engine of a name; None, which lets the solver choose, for auto."""
    if name == "auto":
        return None
    engines = {type(one).__name__.lower(): one for one in reversed(SHIPPED)}
    if name.lower() not in engines:
        raise UnknownNameError(
            f"engine: expected one of auto, {', '.join(reversed(engines))}, got {shown(name)}."
        )
    return engines[name.lower()]


def start_options(
    start: str | None,
    velocity: str | None,
    frame_velocity: str | None,
    t: str | None,
    parameters: list[str] | None,
    moments: str | None,
    force: str | None = None,
    potential: str | None = None,
) -> dict[str, Any]:
    """The arguments of a pair of curves, from options as they were typed."""
    return {
        "start": numbers(start, "start"),
        "velocity": numbers(velocity, "velocity"),
        "frame_velocity": numbers(frame_velocity, "frame velocity"),
        "t": None if t is None else number(t, "t"),
        "parameters": named_numbers(parameters or ()),
        "moments": numbers(moments, "moments"),
        "force": None if force is None else separated(force),
        "potential": potential,
    }


def start_lines(
    problem: CurveProblem, chosen: Sequence[str], last: float | None = None
) -> list[str]:
    """Start, velocity, parameters and duration, with a mark on the values chosen by default."""
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
