"""Arguments: numbers and balls that replace others in a proof, checked at the entrance."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from flint import arb

from geomtorsion.errors import ArgumentError, StartError, UnknownNameError
from geomtorsion.ode import Solution
from geomtorsion.ode.derivatives import checked_by
from geomtorsion.support import checks


def checked_balls(values: object, subject: str) -> dict[str, Any]:
    """Numbers or finite balls by name.

    Raises
    ------
    ArgumentError
        One is neither.
    """
    if values is None:
        return {}
    table = checks.by_name(values, subject, ArgumentError)
    return {name: _checked_ball(value, f"{subject}: {name}") for name, value in table.items()}


def _checked_ball(value: object, subject: str) -> Any:
    if isinstance(value, arb):
        if not value.is_finite():
            raise ArgumentError(f"{subject}: expected a finite ball, got {value}. Give another.")
        return value
    return checks.exact_number(value, subject, ArgumentError)


def checked_derivatives(result: object, derivatives: object) -> tuple[str, ...]:
    """Names by which derivatives of a solution are taken."""
    if not checks.entries(derivatives, "derivatives", StartError):
        return ()
    if not isinstance(result, Solution):
        raise ArgumentError(
            "derivatives: expected nothing except for a solution, got "
            f"{checks.shown(derivatives)} for a {type(result).__name__}. Drop them."
        )
    problem = result.problem
    if getattr(problem, "carried", None) is not None:
        raise StartError(
            "derivatives: expected a curve without vectors carried along, got one with them. Solve "
            "it without them."
        )
    return checked_by(derivatives, tuple(getattr(problem, "variables", {})), "derivatives")


def checked_start(start: object) -> Any:
    """Numbers or balls by name or in order; None without any."""
    if start is None:
        return None
    if isinstance(start, Mapping):
        return checked_balls(start, "start")
    return tuple(
        _checked_ball(x, f"start[{k}]") for k, x in enumerate(checks.entries(start, "start"))
    )


def refuse_unknown(names: Mapping[str, Any], known: Mapping[str, Any]) -> None:
    """Refuse names of parameters that a result does not have."""
    for name in names:
        checks.known_name(name, known, "parameters", UnknownNameError, expected="a parameter")
