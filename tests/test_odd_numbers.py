"""Odd numbers: any value as a number, a time or a word is used, or refused by our own error."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import (
    ArgumentError,
    ExpressionError,
    GeomtorsionError,
    SceneError,
    StartError,
    TimeError,
    UnknownNameError,
)
from geomtorsion.ode import ODE, At, RungeKutta, solve, solve_many
from geomtorsion.scenes import effects
from tests.rounding import ROUNDED

LONG = int("9" * 999)
ODD: list[Any] = [
    1e308, -1e308, 5e-324, 1e-310, float("inf"), float("nan"), LONG, -LONG, Fraction(1, LONG),
    sp.Integer(LONG), sp.Rational(1, LONG), sp.pi * 10**400, sp.zoo, sp.nan, sp.Symbol("q"), 1j,
    "1", "9" * 999, b"1", None, True, (1, 2), ("a", 1), [[1]], {}, object(), np.float64(1e308),
    np.array(1.0), np.array("a"),
]  # fmt: skip
SPHERE = gt.spaces.load("s2").frame
SWING = ODE.of({"x": "v", "v": "-x"}, [1, 0])
SOLVED = solve(gt.geodesic(SPHERE, [1, 0.3], frame_velocity=[0.2, 0.3], parameters={"R": 1}), 1.0)


def circle(**changed: Any) -> gt.ode.Solution:
    """A short geodesic of the sphere."""
    given: dict[str, Any] = {"frame_velocity": [0.2, 0.3], "parameters": {"R": 1}} | changed
    return solve(gt.geodesic(SPHERE, given.pop("start", [1, 0.3]), **given), 1.0)


def equations(rates: Any, start: Any = (1,), **given: Any) -> gt.ode.Solution:
    """A solution of one equation for x."""
    return solve(ODE.of({"x": rates}, list(start), **given), 1.0)


def turning(**changed: Any) -> Any:
    """A damped rotating body, run for a second."""
    given: dict[str, Any] = {
        "body": gt.Body(moments=(1, 2, 3)),
        "effects": [effects.AngularDamping(0.1)],
        "start": gt.State(omega=(0.3, 1, 0.2), euler=(0.3, 0.5, 2)),
        "watch": ["omega", "energy"],
        "t": 1,
    }
    return gt.Scene(**given | changed).run()


CALLS: dict[str, Callable[[Any], Any]] = {
    "time": lambda value: solve(SWING, value),
    "times": lambda value: solve(SWING, [value]),
    "accuracy": lambda value: solve(SWING, 1.0, value),
    "engine": lambda value: solve(SWING, 1.0, engine=value),
    "start of members": lambda value: solve_many(SWING, [[1, value]], 1.0),
    "start": lambda value: circle(start=[value, 0.3]),
    "velocity": lambda value: circle(frame_velocity=[0.2, value]),
    "parameter": lambda value: circle(parameters={"R": value}),
    "rate": equations,
    "initial value": lambda value: equations("-x", [value]),
    "parameter of equations": lambda value: equations("-k*x", parameters={"k": value}),
    "output": lambda value: equations("-x", outputs={"a": value}),
    "event": lambda value: equations("-x", events=[At(value, {"x": 1})]),
    "value after an event": lambda value: equations("-x", events=[At(0.5, {"x": value})]),
    "time between": SOLVED.at,
    "term": SOLVED.event_times,
    "direction": lambda value: SOLVED.event_times("theta", value),
    "chart": SOLVED.in_chart,
    "name": SOLVED.error_of,
    "name in brackets": lambda value: SOLVED[value],
    "accuracy of a scene": lambda value: turning(accuracy=value),
    "watch": lambda value: turning(watch=value),
    "watched": lambda value: turning(watch=[value]),
    "moment": lambda value: turning(body=gt.Body(moments=(3, 3, value))),
    "rate of a body": lambda value: turning(start=gt.State(omega=(0.3, 1, value))),
    "damping": lambda value: turning(effects=[effects.AngularDamping(value)]),
}


# A number may overflow on the way to its refusal.
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("name", CALLS)
def test_an_odd_value_is_used_or_refused(name: str) -> None:
    """The result is finite and its error at most the accuracy, or the error is one of ours."""
    for value in ODD:
        try:
            found = CALLS[name](value)
            if isinstance(found, gt.ode.Solution):
                values = list(found.moment.values.values())
            elif isinstance(found, gt.scenes.SceneResult):
                values = list(found.values.values())
            else:
                continue
        except GeomtorsionError:
            continue
        assert all(np.isfinite(array.astype(float)).all() for array in values)
        if isinstance(found, gt.ode.Solution):
            assert found.error <= found.accuracy


REFUSED: list[tuple[Callable[[], Any], type[GeomtorsionError], str]] = [
    (lambda: solve(SWING, 5e-324), TimeError, r"expected 0 or at least 2.2e-308.*unit of time"),
    (lambda: equations(f"{LONG}*x"), StartError, r"expected real numbers below 1.8e308.*units"),
    (
        lambda: equations("-x", outputs={"a": LONG}).moment,
        ExpressionError,
        r"below 1.8e308.*other units",
    ),
    (lambda: SOLVED.event_times("theta", 2), ArgumentError, r"direction: expected 1 .upwards"),
    (lambda: SOLVED.event_times("theta", (1, 2)), ArgumentError, r"got \(1, 2\)"),  # type: ignore[arg-type]  # on purpose
    (
        lambda: SOLVED[["theta"]],  # type: ignore[index]  # on purpose
        UnknownNameError,
        r"expected a quantity of this motion, got \['theta'\]",
    ),
    (lambda: SOLVED.in_chart({}), UnknownNameError, r"expected a chart of this space, got \{\}"),  # type: ignore[arg-type]  # on purpose
    (
        lambda: turning(
            body=gt.Body(moments=(1e308,) * 3), start=gt.State(omega=(1, 3, 2), euler=(0, 1, 0))
        ),
        SceneError,
        r"energy: expected finite values, got one .* at t = 0\. Use other units",
    ),
]


@pytest.mark.parametrize(("call", "error", "words"), REFUSED)
def test_the_remedy_is_in_the_message(
    call: Callable[[], Any], error: type[GeomtorsionError], words: str
) -> None:
    """Each refusal names the value and the remedy."""
    with pytest.raises(error, match=words):
        call()


def test_a_time_beyond_all_steps_ends() -> None:
    """A great circle, which changes charts without end, raises an error for t = 1e308."""
    problem = gt.geodesic(SPHERE, [1, 0.3], frame_velocity=[0.2, 0.3], parameters={"R": 1})
    for engine in (None, RungeKutta()):
        with pytest.raises(GeomtorsionError):
            solve(problem, 1e308, engine=engine)


def test_tiny_numbers_that_are_quotients_of_long_ones() -> None:
    """(10^399 + 1)/10^400 acts as a tenth, although both its parts exceed all floats."""
    tenth = Fraction(10**399 + 1, 10**400)
    solution = equations("-x", outputs={"a": f"x*{tenth}"})
    assert solution["a"] == pytest.approx(solution["x"] / 10, rel=ROUNDED)
