"""Derivatives of a curve: what may vary, and how its start changes with it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from geomtorsion import checks
from geomtorsion.curves.atlas import ElementMatrix
from geomtorsion.curves.equations import velocity_names
from geomtorsion.curves.transported import Derivatives
from geomtorsion.errors import ExpressionError, StartError
from geomtorsion.ode.derivatives import checked_by
from geomtorsion.ode.numbers import Real
from geomtorsion.precision import EXACT_BITS

if TYPE_CHECKING:
    from geomtorsion.curves.problem import CurveProblem


def variables(problem: CurveProblem) -> dict[str, Real]:
    """Parameters and numbers at the start by name, as they were given.

    Velocities are r', ... where a coordinate velocity was given, else u1, u2, ...
    """
    table: dict[str, Real] = dict(problem.parameters)
    if problem.start is not None:
        table |= dict(zip(problem.coordinates, problem.start, strict=True))
    if problem.coordinate_velocity is None:
        speeds = zip(velocity_names(problem.frame), problem.frame_velocity, strict=True)
    else:
        names = [f"{name}'" for name in problem.coordinates]
        speeds = zip(names, problem.coordinate_velocity, strict=True)
    return table | dict(speeds)


def with_derivatives(problem: CurveProblem, by: object) -> CurveProblem:
    """The same curve with its derivatives; see `CurveProblem.with_derivatives`."""
    if problem.carried is not None:
        raise StartError(
            "derivatives: expected a curve without vectors carried along, got one with them. Solve "
            "the two problems one after the other."
        )
    words = checked_by(by, tuple(variables(problem)), "derivatives")
    coordinates = problem.coordinates if problem.start is not None else ()
    varied = (*coordinates, *velocity_names(problem.frame))
    columns = tuple(_at_start(problem, word, coordinates) for word in words)
    derivatives = Derivatives(words, varied, columns, len(coordinates))
    taken = {*problem.coordinates, *problem.parameters, *varied, "t"}
    clash = taken & set(derivatives.names())
    if clash:
        raise ExpressionError(
            f"derivatives: expected {min(clash)} to be free for a derivative, got a coordinate or "
            "parameter of this name. Rename it."
        )
    return replace(problem, carried=derivatives)


def renewed(problem: CurveProblem) -> CurveProblem:
    """The curve with derivatives that belong to its start, if it has some."""
    carried = problem.carried
    if not isinstance(carried, Derivatives):
        return problem
    return with_derivatives(replace(problem, carried=None), carried.by)


def _at_start(problem: CurveProblem, by: str, coordinates: Sequence[str]) -> tuple[Real, ...]:
    """Derivatives of coordinates and frame velocities at the start."""
    place = [int(name == by) for name in coordinates]
    rates, n = problem.coordinate_velocity, problem.frame.dimension
    if rates is None or problem.start is None:
        return (*place, *(int(name == by) for name in velocity_names(problem.frame)))
    # The coordinate velocity was given: u^i = e^i_mu q'^mu changes with the coframe.
    entries = problem.frame.coframe.components.nonzero
    vector: Sequence[Real] = [int(f"{name}'" == by) for name in coordinates]
    if not any(vector):
        vector, slopes = rates, {}
        for index, element in entries.items():
            symbol = next((s for s in element.field.symbols if s.name == by), None)
            if symbol is not None:
                slopes[index] = element.diff(symbol)
        entries = slopes
    point = dict(zip(coordinates, problem.start, strict=True)) | dict(problem.parameters)
    return (*place, *ElementMatrix(entries, (n, n)).precisely(point, vector, EXACT_BITS))


def with_values(problem: CurveProblem, values: Mapping[str, Real]) -> CurveProblem:
    """The same curve with other parameters and numbers at the start, by name."""
    table = checks.known_keys(values, variables(problem), "values", StartError)
    every = variables(problem) | table
    given = problem.coordinate_velocity is not None
    names = [f"{x}'" for x in problem.coordinates] if given else velocity_names(problem.frame)
    speeds = [every[name] for name in names]
    start = None if problem.start is None else [every[name] for name in problem.coordinates]
    changed = replace(problem, parameters={name: every[name] for name in problem.parameters})
    if given:
        return changed.with_start(start, velocity=speeds)
    return changed.with_start(start, frame_velocity=speeds)
