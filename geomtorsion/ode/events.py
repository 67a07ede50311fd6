"""Events: what users say happens at a time, or where something falls through zero."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from geomtorsion.ode.numbers import Real


@dataclass(frozen=True)
class At:
    """From exactly this time on a parameter has a new value, or a state starts from a new one.

    time: from t = 0 on.
    changes: name of a parameter or state -> number.

    Examples
    --------
    >>> from geomtorsion.ode import ODE, solve
    >>> burn = ODE.of({"v": "a"}, [0], parameters={"a": 2}, events=[At(1.0, {"a": 0})])
    >>> solve(burn, 3.0)["v"][-1].item()
    2.0
    """

    time: float
    changes: Mapping[str, Real] = field(default_factory=dict)


@dataclass(frozen=True)
class When:
    """The motion ends where an expression falls through zero.

    falls: text or sympy, over states, parameters and the time.

    Examples
    --------
    >>> from geomtorsion.ode import ODE, solve
    >>> fall = ODE.of({"z": "v", "v": "-g"}, {"z": 20, "v": 0}, parameters={"g": 10},
    ...               events=[When("z")])
    >>> solution = solve(fall, 5.0)
    >>> solution.outcome, round(float(solution.times[-1]), 9)
    ('stopped', 2.0)
    """

    falls: Any
