"""Poles: a loop near a singular line has the right vector, and one through it is refused."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from geomtorsion.errors import LoopError, SingularPointError
from geomtorsion.geometry import Connection, Frame, cartan, from_spin_connection
from geomtorsion.loops import EdgeList, Loop, Network, burgers_vector, burgers_vectors, develop
from geomtorsion.spaces import load

B = {"b": 1.0}
SCREW = load("screw_dislocation").frame
# Distances of the line from the loop, in units of its radius, down to where they are rounding.
NEAR = [0.3, 0.1, 0.05, 0.03, 0.02, 0.015, *(10.0**-k for k in range(2, 12))]


def polygon(x: float) -> list[list[float]]:
    """A polygon about (2, 1) whose left side passes the axis at x."""
    return [[x, -1, 0], [3, -1, 0], [3, 2, 0], [x, 2, 0]]


@pytest.mark.parametrize("distance", NEAR)
@pytest.mark.parametrize("accuracy", [1e-2, 1e-6, 1e-12])
@pytest.mark.parametrize("inside", [1, 0])
def test_the_line_integral_misses_no_peak(distance: float, accuracy: float, inside: int) -> None:
    """Near the line the vector is b or nothing, and the error estimate holds at any accuracy."""
    x = -distance if inside else distance
    for loop in (Loop.circle([1 + x, 0, 0], 1), Loop.polygon(polygon(x))):
        found = burgers_vector(SCREW, loop, accuracy, parameters=B)
        assert abs(found.vector[2] - inside) <= found.error
        assert abs(found.check.line[2] - inside) <= found.check.line_error
        assert found.check.line_error < 100 * max(accuracy, 1e-15 / distance)
        assert found.check.agrees is (not inside)


@pytest.mark.parametrize("distance", NEAR)
@pytest.mark.parametrize("inside", [1, 0])
def test_edges_and_maps_miss_no_peak(distance: float, inside: int) -> None:
    """The same as a cycle of a network, and as one of many circles."""
    x = -distance if inside else distance
    square = EdgeList(np.array(polygon(x)), np.array([[0, 1], [1, 2], [2, 3], [3, 0]]))
    cycle = Network(SCREW, square, parameters=B).burgers([0, 1, 2, 3])
    assert abs(cycle.vector[2] - inside) <= cycle.error < 1e-14 / distance + 1e-11
    found = burgers_vectors(SCREW, [[1 + x, 0, 0], [9, 0, 0]], 1.0, accuracy=1e-6, parameters=B)
    assert abs(found.vectors[2, 0] - inside) <= found.errors[0]
    assert found.enclosed.tolist() == [bool(inside), False]


@pytest.mark.parametrize("distance", [0, 1e-15, 1e-13])
def test_nearer_than_rounding_is_through_it(distance: float) -> None:
    """A distance below 1e-12 of the size is none."""
    with pytest.raises(SingularPointError, match="passes through"):
        burgers_vector(SCREW, Loop.circle([1 - distance, 0, 0], 1), parameters=B)
    with pytest.raises(SingularPointError, match="passes through"):
        burgers_vector(SCREW, Loop.polygon(polygon(distance)), parameters=B)
    places = EdgeList(np.array(polygon(distance)), np.array([[0, 1], [3, 0]]))
    with pytest.raises(SingularPointError, match="edge 1 passes through the singular line"):
        _ = Network(SCREW, places, parameters=B).integrals


def test_loops_far_from_poles_are_not_cut() -> None:
    """Intervals are cut only where few points would miss a peak; else the trapezoid is best."""
    far = burgers_vector(SCREW, Loop.circle([0.5, 0, 0], 1), parameters=B)
    near = burgers_vector(SCREW, Loop.circle([0.98, 0, 0], 1), parameters=B)
    assert "trapezoid" in far.check.text
    assert "Kronrod" in near.check.text


@pytest.mark.parametrize("distance", [0.3, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10])
@pytest.mark.parametrize("accuracy", [1e-2, 1e-12])
@pytest.mark.parametrize("inside", [1, 0])
def test_a_development_misses_no_peak(distance: float, accuracy: float, inside: int) -> None:
    """Near the line the development is right within its error, or refused with the place."""
    loop = Loop.circle([1 - distance if inside else 1 + distance, 0, 0], 1)
    if distance < 1e-9:
        with pytest.raises(LoopError, match=r"does not converge near offset \(-1,"):
            develop(cartan(SCREW), loop, accuracy, parameters=B)
        return
    found = develop(cartan(SCREW), loop, accuracy, parameters=B)
    assert abs(found.burgers[2] - inside) <= found.error < 0.1


def twist(share: sp.Rational) -> Connection:
    """A flat coframe whose connection turns by share * 2 pi about the axis."""
    x, y, z = sp.symbols("x y z", real=True)
    frame = Frame([x, y, z], [[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    omega = [[[sp.S.Zero] * 3 for _ in range(3)] for _ in range(3)]
    for mu, slope in ((0, -y), (1, x)):
        omega[mu][0][1] = share * slope / (x**2 + y**2)
        omega[mu][1][0] = -omega[mu][0][1]
    return from_spin_connection(frame, omega)


@pytest.mark.parametrize("distance", [0.5, 1e-2, 1e-6])
def test_a_singular_connection_over_a_regular_coframe(distance: float) -> None:
    """Poles of the connection count: the whole angle, and the line is named."""
    found = develop(twist(sp.Rational(1, 20)), Loop.circle([1 - distance, 0, 0], 1), 1e-6)
    assert abs(found.angle - np.pi / 10) <= found.turn_error < 1e-5
    assert [str(one.defect) for one in found.enclosed] == ["singular line at x = 0, y = 0"]
    with pytest.raises(SingularPointError, match="the connection has no finite value"):
        develop(twist(sp.Rational(1, 20)), Loop.circle([1, 0, 0], 1))
