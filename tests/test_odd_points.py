"""Odd points: each call with any kind of point or list gives values or an error of ours."""

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError

r, phi, a = sp.symbols("r phi a", positive=True)
FRAME = gt.Frame([r, phi], [[1, 0], [0, r]])
SCALED = gt.Frame([r, phi], [[1, 0], [0, a * r]])
CURVATURE = gt.levi_civita(FRAME).curvature
SOLUTION = gt.solve(gt.geodesic(FRAME, [1, 0.1], [0.2, 0.3]), 1.0)
FUNCTION = gt.numpy_function(FRAME.coframe, [r, phi])
ODD: dict[str, Any] = {
    "without axes": np.array(1.0),
    "an object without axes": np.array(None, dtype=object),
    "a table without axes": np.array({r: 1, phi: 1}, dtype=object),
    "two": [1.0, 2.0],
    "three": [1.0, 2.0, 3.0],
    "text": "abc",
    "bytes": b"ab",
    "nothing": None,
    "masked": np.ma.array([1.0, 2.0], mask=[True, False]),
    "the masked number": np.ma.masked,
    "complex": [1j, 2],
    "nan": [np.nan, 1],
    "rows": [[1.0, 2.0], [3.0, 4.0]],
    "ragged": [[1.0, 2.0], [3.0]],
    "texts": ["1", "2"],
    "nothings": [None, None],
    "a set": {1, 2},
    "empty": [],
    "an object": object(),
    "dates": np.array(["2020", "2021"], dtype="datetime64[D]"),
    "a structure": np.zeros(2, dtype=[("a", float)]),
    "huge": [10**400, 1],
    "symbols": [r, phi],
    "no rows": np.zeros((0, 2)),
    "nothing at r": {r: None, phi: 1},
    "text at r": {r: "1", phi: 1},
    "a number as a name": {3: 1},
    "lists at r": {r: [1, [2]], phi: 1},
    "masked at r": {r: np.ma.masked, phi: 1},
    "complex at r": {r: 1j, phi: 1},
    "an object without axes at r": {r: np.array(None, dtype=object), phi: 1},
}
CALLS: dict[str, Callable[[Any], object]] = {
    "coframe": FRAME.coframe.at,
    "scalar": CURVATURE.scalar.at,
    "coordinate": lambda odd: FRAME.coframe.at({r: odd, phi: 1}),
    "digits": lambda odd: FRAME.coframe.at({r: odd, phi: 1}, digits=30),
    "parameter": lambda odd: SCALED.subs({"a": odd}),
    "function": lambda odd: FUNCTION(odd, 1.0),
    "solution": SOLUTION.at,
    "start": lambda odd: gt.geodesic(FRAME, odd, [0.1, 0.1]),
    "velocity": lambda odd: gt.geodesic(FRAME, [1, 0.1], odd),
    "exponential map": lambda odd: gt.exponential_map(gt.levi_civita(FRAME), [1, 0.1], odd),
    "centre": lambda odd: gt.Loop.circle(odd, radius=0.1),
    "plane": lambda odd: gt.Loop.circle([2, 1], radius=0.1, plane=odd),
    "axes": lambda odd: gt.Loop.ellipse([2, 1], odd),
    "vertices": gt.Loop.polygon,
    "steps": lambda odd: gt.Loop.plaquette([2, 1], odd),
    "spline": gt.Loop.spline,
    "values of a loop": gt.Loop.circle([2, 1], radius=a).at,
}


@pytest.mark.parametrize("odd", ODD.values(), ids=ODD.keys())
@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS.keys())
def test_values_or_an_error(call: Callable[[Any], object], odd: Any):
    """No error of numpy, sympy, mpmath or Python is raised, and each value is finite."""
    try:
        found = call(odd)
    except GeomtorsionError:
        return
    if isinstance(found, np.ndarray) and found.dtype.kind in "fc":
        assert np.isfinite(found).all()


@pytest.mark.parametrize("value", [3, 3.0, Fraction(3), np.float64(3), np.array(3.0), np.array(3)])
def test_a_number_in_an_array_without_axes(value: Any):
    """An array without axes counts as its number."""
    assert FRAME.coframe.at({r: value, phi: 1}).tolist() == [[1.0, 0.0], [0.0, 3.0]]
    assert FRAME.coframe.at({r: value, phi: 1}, digits=30)[1, 1] == 3
