"""Curves: loops that close because coordinates are angles, by line, by flux and exactly."""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy as sp

from geomtorsion.errors import LoopError, MissingValueError
from geomtorsion.geometry import Frame, cartan, levi_civita
from geomtorsion.loops import Loop, burgers_vector, develop, develop_period, exact_burgers_vector
from geomtorsion.spaces import load

B = sp.Symbol("b", positive=True)
R, PHI, Z = sp.symbols("r phi z", positive=True)
SCREW = Frame([R, PHI, Z], [[1, 0, 0], [0, R, 0], [0, B / (2 * sp.pi), 1]])
ROUND = {"interval": (0, "2*pi"), "periods": {1: "2*pi"}}


@pytest.mark.parametrize("times", [1, -3])
def test_a_wavy_loop_around_a_screw_in_polar_coordinates(times: int) -> None:
    """b of the screw and the integral of r dphi by hand, by three routes."""
    loop = Loop.parametric(["2 + cos(3*s)/4", "s", "sin(s)"], **ROUND).times(times)
    found = burgers_vector(SCREW, loop, parameters={"b": 0.5})
    expected = np.array([0, 4 * math.pi, 0.5]) * times
    assert np.abs(found.vector - expected).max() <= found.error < 1e-12
    assert found.check.agrees
    assert "across a strip, and a straight line" in found.check.text
    assert found.check.flux == pytest.approx(expected, abs=1e-12)
    exact = exact_burgers_vector(SCREW, loop)
    assert exact.vector == (0, 4 * sp.pi * times, B * times)
    assert float(exact.magnitude.subs(B, 0.5)) == pytest.approx(found.magnitude, rel=1e-12)
    assert exact.error == 0
    assert loop.gap.tolist() == [0, 2 * math.pi * times, 0]


def test_torsion_inside_the_strip_counts() -> None:
    """In a frame with torsion the flux between straight line and loop is not zero."""
    x, y = sp.symbols("x y")
    frame = Frame([x, y], [[1, 0], [0, 1 + sp.cos(x) * sp.sin(y) / 2 + x]], name="wavy")
    # One period of y is 2 pi; x is not periodic.
    loop = Loop.parametric(["sin(s)", "s"], interval=(0, "2*pi"), periods={1: "2*pi"})
    found = burgers_vector(frame, loop)
    # Integral of cos(sin s) sin(s) / 2 + 1 + sin s over a period: only the 1 contributes.
    assert found.vector == pytest.approx([0, 2 * math.pi], abs=1e-13)
    assert found.check.agrees
    wide = Loop.parametric(["cos(s)", "s"], interval=(0, "2*pi"), periods={1: "2*pi"})
    other = burgers_vector(frame, wide)
    assert other.check.agrees
    assert np.abs(other.check.line - other.check.flux).max() < 1e-13


def test_development_around_a_cone() -> None:
    """A cone has the angle of 60 degrees for loops of any shape, as on a straight path."""
    cone = levi_civita(load("wedge_disclination").frame)
    values = {"alpha": 5 / 6}
    straight = develop_period(
        cone, [[2, 0, 0], [2, 2 * math.pi, 0]], {"phi": 2 * math.pi}, parameters=values
    )
    for expressions in (["2", "s", "0"], ["7/4 + cos(3*s)/4", "s", "sin(s)"]):
        turn = develop(cone, Loop.parametric(expressions, **ROUND), parameters=values)
        assert abs(math.degrees(turn.angle) - 60) < 1e-10
        assert turn.burgers == pytest.approx(straight.burgers, abs=1e-12)
        assert "closes modulo periods" in turn.check.text
    flat = Loop.parametric(["7/4 + cos(3*s)/4", "s", "sin(s)"], **ROUND)
    plain = develop(cartan(SCREW), flat, parameters={"b": 1})
    assert plain.burgers == pytest.approx([0, 3.5 * math.pi, 1], abs=1e-12)


def test_invalid_loops_are_refused() -> None:
    """Refused: a gap, a period that the frame does not have, a winding number, bad periods."""
    with pytest.raises(LoopError, match=r"does not close: .* \(0, 0, 6.28319\) beside whole"):
        Loop.parametric(["2", "s", "s"], **ROUND)
    with pytest.raises(LoopError, match="does not close"):
        burgers_vector(SCREW, Loop.parametric(["2", "s", "0"], interval=(0, "2*pi")))
    half = Loop.parametric(["s", "1 + sin(2*s)/4", "0"], interval=(0, "pi"), periods={0: "pi"})
    for route in (burgers_vector, exact_burgers_vector):
        with pytest.raises(LoopError, match="does not have this period"):
            route(load("so3").frame, half)
    loop = Loop.parametric(["2", "s", "0"], **ROUND)
    with pytest.raises(LoopError, match="modulo periods has no winding number"):
        loop.winding([0, 0, 0])
    for periods, message in (
        ({3: 1}, r"periods\[3\]: expected a whole number from 0 to 2"),
        ({"phi": 1}, r"periods\['phi'\]: expected a whole number"),
        ({1: 0}, r"periods\[1\]: expected a positive number"),
        ({1: "a"}, "unknown|a"),
    ):
        with pytest.raises(ValueError, match=message):
            Loop.parametric(["2", "s", "0"], interval=(0, "2*pi"), periods=periods)  # type: ignore[arg-type]


def test_symbols_in_loops_with_periods() -> None:
    """A radius may get its value later; the closed form contains its symbol."""
    a = sp.Symbol("a", positive=True)
    loop = Loop.parametric([a, "s", "0"], **ROUND)
    assert exact_burgers_vector(SCREW, loop).vector == (0, 2 * sp.pi * a, B)
    found = burgers_vector(SCREW, loop, parameters={"a": 3, "b": 1})
    assert found.vector == pytest.approx([0, 6 * math.pi, 1], abs=1e-12)


def test_a_loop_with_symbols_has_no_points_yet() -> None:
    """The error names the symbol without a value, and the call that gives it one."""
    loop = Loop.circle([0, 0], R)
    for asked in (lambda: loop.then(loop), lambda: loop.base, loop.points):
        with pytest.raises(MissingValueError, match=r"contains r: give it values first, loop\.at"):
            asked()
