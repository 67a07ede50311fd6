"""Declared: every function with parameters refuses a value that contradicts a declaration."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import pytest
import sympy as sp

from geomtorsion.curves import autoparallel, exponential_map, geodesic, holonomy, log_map
from geomtorsion.errors import CoordinateError
from geomtorsion.geometry import Frame, cartan, levi_civita
from geomtorsion.loops import (
    Loop,
    burgers_map,
    burgers_vector,
    burgers_vectors,
    develop,
    develop_path,
    enclosed_defects,
    exact_burgers_vector,
)

S = sp.Symbol("s", real=True)
ABOUT = Loop.circle([1, 0], 0.5)
# Functions of a frame and of values of its parameters.
ROUTES: dict[str, Callable[[Frame, Mapping[Any, int]], object]] = {
    "point": lambda f, p: f.metric.at({"x": 1, "y": 0, **p}),
    "substitution": lambda f, p: f.subs(p),
    "geodesic": lambda f, p: geodesic(f, [1, 0], [0, 1], parameters=p),
    "autoparallel": lambda f, p: autoparallel(cartan(f), [1, 0], [0, 1], parameters=p),
    "exponential": lambda f, p: exponential_map(cartan(f), [1, 0], [0, 1], parameters=p),
    "logarithm": lambda f, p: log_map(cartan(f), [1, 0], [1.1, 0], parameters=p),
    "holonomy": lambda f, p: holonomy(cartan(f), [S, S], parameters=p),
    "burgers_vector": lambda f, p: burgers_vector(f, ABOUT, parameters=p),
    "exact": lambda f, p: exact_burgers_vector(f, ABOUT, parameters=p),
    "many": lambda f, p: burgers_vectors(f, [[1, 0], [2, 0]], 0.1, parameters=p),
    "map": lambda f, p: burgers_map(f, ([1, 2, 3], [0, 1, 2]), parameters=p),
    "development": lambda f, p: develop(levi_civita(f), ABOUT, parameters=p),
    "flat development": lambda f, p: develop(cartan(f), ABOUT, parameters=p),
    "path": lambda f, p: develop_path(levi_civita(f), [[1, 0], [2, 0]], parameters=p),
    "defects": lambda f, p: enclosed_defects(f, ABOUT, p),
}


@pytest.mark.parametrize("route", ROUTES.values(), ids=ROUTES)
def test_values_against_declarations(route: Callable[..., object]) -> None:
    """Each route refuses a negative value of a positive M: sympy has replaced sqrt(M**2) by M."""
    M = sp.Symbol("M", positive=True)
    x, y = sp.symbols("x y", real=True)
    frame = Frame([x, y], [[1, 0], [0, sp.sqrt(M**2) + x**2]])
    said = "M: expected a value that is positive, nonnegative, as declared, got -1"
    for key in (M, "M"):
        with pytest.raises(CoordinateError, match=said):
            route(frame, {key: -1})
    route(frame, {"M": 1})
