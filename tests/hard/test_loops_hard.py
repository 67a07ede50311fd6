"""Hard loops: near gimbal lock, wild, with corners, self-crossing, huge, close to singularities."""

import mpmath
import numpy as np
import pytest
import sympy as sp

from geomtorsion.errors import SingularPointError
from geomtorsion.geometry import Frame
from geomtorsion.loops import Loop, burgers_vector
from geomtorsion.spaces import load
from tests.rounding import ROUNDED

SAME = 1e-12  # the requested accuracy

x, y, z = sp.symbols("x y z", real=True)
f = (x - sp.Rational(1, 2)) ** 2 + y**2


def everywhere(name: str) -> Frame:
    """A shipped frame without its declared domain: the formulas are smooth beyond it."""
    frame = load(name).frame
    return Frame(frame.coordinates, frame.coframe.to_sympy(), parameters=frame.parameters)


@pytest.mark.parametrize("radius", [1e-6, 0.9999999e-6, 1e-9, 1e-14])
def test_next_to_gimbal_lock(radius: float) -> None:
    """A millionth from the edge of the chart, or touching it: the coframe is smooth there."""
    frame = everywhere("so3")
    b = burgers_vector(frame, Loop.circle([0.3, 1e-6, 0.2], radius, (1, 2)))
    with mpmath.workdps(60):
        r, q = mpmath.mpf(radius), mpmath.mpf(1e-6)
        c = 2 * mpmath.pi * r * mpmath.besselj(1, r)
        expected = [-c * mpmath.cos(0.3) * mpmath.cos(q), c * mpmath.sin(0.3) * mpmath.cos(q)]
        expected.append(-c * mpmath.sin(q))
        for one, two in zip(b.vector.tolist(), expected, strict=True):
            assert abs(one - two) <= SAME * abs(expected[0])


def test_a_thousand_wiggles() -> None:
    """The area of r = 1 + cos(1000 s)/10 is pi (1 + 1/200), and Heisenberg's space measures it."""
    loop = Loop.parametric(
        ["(1 + cos(1000*s)/10)*cos(s)", "(1 + cos(1000*s)/10)*sin(s)", "sin(1000*s)"],
        interval=(0, "2*pi"),
    )
    b = burgers_vector(load("heisenberg").frame, loop)
    assert b.vector == pytest.approx([0, 0, -np.pi * (1 + 1 / 200)], abs=1e-11)
    assert b.reached
    so3 = burgers_vector(everywhere("so3"), loop)
    assert so3.check.agrees
    assert so3.reached


def test_a_wild_frame() -> None:
    """A bar twisted by a thousand turns along the loop: -2 pi R J1(kappa R)."""
    frame = load("twisted_bar").frame
    for kappa in (10, 1000, 12345):
        b = burgers_vector(frame, Loop.circle([0, 0, 0], 1, (1, 2)), parameters={"kappa": kappa})
        expected = float(-2 * mpmath.pi * mpmath.besselj(1, kappa))
        assert abs(b.vector[0] - expected) <= 10 * b.error
        assert abs(b.vector[0] - expected) < 1e-11


def test_self_intersections() -> None:
    """Parts of opposite sense cancel, windings add up: figure of eight and limacon."""
    frame = load("heisenberg").frame
    eight = Loop.parametric(["sin(s)", "sin(2*s)", "cos(s)"], interval=(0, "2*pi"))
    assert burgers_vector(frame, eight).vector[2] == pytest.approx(0, abs=ROUNDED)
    limacon = Loop.parametric(
        ["(1 + 2*cos(s))*cos(s)", "(1 + 2*cos(s))*sin(s)", "0"], interval=(0, "2*pi")
    )
    assert burgers_vector(frame, limacon).vector[2] == pytest.approx(-3 * np.pi, rel=SAME)
    screw = Frame([x, y, z], [[1, 0, 0], [0, 1, 0], [-y / f, (x - sp.Rational(1, 2)) / f, 1]])
    b = burgers_vector(screw, limacon)
    assert limacon.winding([0.5, 0, 0]) == 2
    assert b.vector[2] == pytest.approx(4 * np.pi, rel=SAME)
    with pytest.raises(SingularPointError, match="passes through"):
        burgers_vector(load("screw_dislocation").frame, limacon, parameters={"b": 1})


def test_a_loop_of_radius_a_million() -> None:
    """Rounding of the coordinates is part of the error, and the estimate contains it."""
    b = burgers_vector(load("heisenberg").frame, Loop.circle([0.3, 1, 0], 1e6))
    assert b.vector[2] == pytest.approx(-np.pi * 1e12, rel=SAME)
    frame = everywhere("so3")
    for radius in (1e2, 1e4):
        b = burgers_vector(frame, Loop.circle([0.3, 1, 0.2], radius), 1e-9)
        with mpmath.workdps(40):
            expected = 2 * mpmath.pi * radius * mpmath.besselj(1, radius) * mpmath.cos(0.3)
            assert abs(b.vector[0] - expected) <= 10 * b.error
        assert b.relative_error < 1e-8


@pytest.mark.parametrize("distance", [1e-3, 1e-6, 1e-9])
def test_close_to_a_singular_line(distance: float) -> None:
    """A circle that passes a screw at a small distance, on either side."""
    frame = load("screw_dislocation").frame
    for side, expected in ((1 - distance, 1.0), (1 + distance, 0.0)):
        b = burgers_vector(frame, Loop.circle([side, 0, 0], 1), parameters={"b": 1})
        assert b.vector[2] == pytest.approx(expected, abs=max(1e-10, ROUNDED / distance))
        assert abs(b.vector[2] - expected) <= 10 * b.error + 1e-15 / distance


def test_corners_next_to_a_singular_line() -> None:
    """A corner a millionth from the axis: only the sides near it are halved."""
    frame = load("screw_dislocation").frame
    d = 1e-6
    inside = Loop.polygon([[-d, 0, 0], [1, -1, 0], [1, 1, 0]])
    outside = Loop.polygon([[d, 0, 0], [1, -1, 0], [1, 1, 0]])
    for loop, expected in ((inside, 1), (outside, 0)):
        b = burgers_vector(frame, loop, parameters={"b": 1})
        assert b.vector[2] == pytest.approx(expected, abs=1e-9)
        assert b.evaluations < 20000


def test_a_small_core_inside_a_large_loop() -> None:
    """The torsion is in a core a thousandth of the loop wide: the line integral resolves it."""
    b = burgers_vector(
        load("screw_core").frame, Loop.circle([0.3, 0.1, 0], 1), parameters={"b": 2, "c": 1e-3}
    )
    d2 = 0.3**2 + 0.1**2
    assert b.route == "line"
    assert b.reached
    # Integral of (b/2pi) (x dy - y dx) / (r^2 + c^2) over the unit circle around (0.3, 0.1).
    p = 1 + d2 + 1e-6
    root = np.sqrt(p * p - 4 * d2)
    expected = 2 * (1 + (2 - p) / root) / 2
    assert b.vector[2] == pytest.approx(expected, rel=1e-11)


def test_singular_along_a_whole_side() -> None:
    """A side along a singular line and a root that ends are refused; a singular chart is not."""
    screw = load("screw_dislocation").frame
    along = Loop.polygon([[0, 0, -1], [0, 0, 1], [1, 0, 0]])
    with pytest.raises(SingularPointError, match="passes through"):
        burgers_vector(screw, along, parameters={"b": 1})
    ends = Frame([x, y], [[1, sp.sqrt(x)], [0, 1]])
    with pytest.raises(SingularPointError, match="no finite value"):
        burgers_vector(ends, Loop.circle([0, 0], 1))
    polar = everywhere("s2")
    assert burgers_vector(polar, Loop.circle([0, 0], 1), parameters={"R": 1}).reached


def test_larger_than_all_doubles() -> None:
    """Radius 1e200: b is infinite as a double, and right as mpmath number, without warnings."""
    b = burgers_vector(load("heisenberg").frame, Loop.circle([0, 0, 0], 1e200))
    assert np.isinf(b.vector[2])
    assert float(b.numbers[2] / (mpmath.pi * mpmath.mpf(1e200) ** 2)) == pytest.approx(-1)


def test_very_many_corners() -> None:
    """A polygon of two thousand sides gives its area."""
    angles = 2 * np.pi * np.arange(2000) / 2000
    vertices = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    loop = Loop.polygon(vertices.tolist())
    b = burgers_vector(load("heisenberg").frame, loop)
    assert b.vector[2] == pytest.approx(-loop.area[0, 1], rel=SAME)
    assert b.seconds < 5
