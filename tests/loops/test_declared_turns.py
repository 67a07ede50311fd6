"""Loops that close after a full turn of an angle which the frame declares."""

import numpy as np
import pytest
import sympy as sp

from geomtorsion import spaces
from geomtorsion.errors import LoopError
from geomtorsion.geometry import Frame, cartan, levi_civita
from geomtorsion.loops import Loop, burgers_vector, develop, exact_burgers_vector

R, PHI = sp.symbols("r phi")
HALF = sp.And(PHI > 0, sp.pi > PHI).args
FULL = sp.And(PHI > 0, 2 * sp.pi > PHI).args  # both bounds of an angle
TURN = Loop.parametric(["2", "s"], interval=(0, "2*pi"))


def polar(*domain):
    """Polar coordinates of the plane, with a domain."""
    return Frame([R, PHI], [[1, 0], [0, R]], domain=domain)


@pytest.mark.parametrize("turns", [1, -1, 2])
def test_a_full_turn_in_polar_coordinates(turns):
    """The plane is flat: a circle around the origin develops into a closed circle."""
    plane = levi_civita(spaces.load("flat_polar").frame)
    loop = Loop.parametric(["2", f"{turns}*s"], interval=(0, "2*pi"))
    developed = develop(plane, loop)
    assert np.abs(developed.burgers).max() <= developed.error
    assert np.abs(developed.rotation - np.eye(2)).max() <= developed.turn_error


def test_the_polar_frame_has_the_length_of_the_circle_as_burgers_vector():
    """Legs that turn with the circle add up to its length, as a number and exactly."""
    frame = spaces.load("flat_polar").frame
    number = burgers_vector(frame, TURN)
    assert abs(number.vector[1] - 4 * np.pi) <= number.error
    assert exact_burgers_vector(frame, TURN).vector == (0, 4 * sp.pi)


def test_a_circle_of_latitude():
    """On the sphere it turns a vector by the solid angle, here half of a full turn."""
    sphere = levi_civita(spaces.load("s2").frame)
    circle = Loop.parametric(["pi/3", "s"], interval=(0, "2*pi"))
    developed = develop(sphere, circle, parameters={"R": 1})
    assert np.abs(developed.rotation + np.eye(2)).max() <= developed.turn_error
    # The developed circle is half of one of radius tan(pi/3).
    assert abs(developed.burgers[0] + 2 * np.tan(np.pi / 3)) <= developed.error


def test_a_symbol_may_be_the_radius():
    """A curve that receives its numbers later is judged then."""
    radius = sp.Symbol("a", positive=True)
    curve = Loop.parametric(["a", "s"], interval=(0, "2*pi"), symbols={"a": radius})
    frame = spaces.load("flat_polar").frame
    assert exact_burgers_vector(frame, curve).vector == (0, 2 * sp.pi * radius)
    assert develop(levi_civita(frame), curve, parameters={"a": 2}).burgers[1] == pytest.approx(0)


@pytest.mark.parametrize(
    ("frame", "curve", "words"),
    [
        (Frame(sp.symbols("x y"), [[1, 0], [0, 1]]), ["2", "s"], "does not close.* If y is an"),
        (polar(), ["2", "s"], r"declare it: periods=\{1: '2\*pi'\} of the curve, or domain="),
        (polar(*FULL), ["1 + s", "1"], "does not close.* If r is an angle"),
        (polar(*HALF), ["2", "s"], "does not close"),
    ],
    ids=["straight", "undeclared", "radius", "half"],
)
def test_other_ends_do_not_meet(frame, curve, words):
    """Ends 2 pi apart meet only in a coordinate with a declared turn."""
    loop = Loop.parametric(curve, interval=(0, "2*pi"))
    for refused in (lambda: develop(cartan(frame), loop), lambda: burgers_vector(frame, loop)):
        with pytest.raises(LoopError, match=words):
            refused()


@pytest.mark.parametrize("interval", [(0, "pi"), (0, 6.28), (0, "2*pi + 1/10**6")])
def test_parts_of_a_turn_are_refused_at_once(interval):
    """Whatever the frame, this curve is open."""
    with pytest.raises(LoopError, match="does not close: it starts at"):
        Loop.parametric(["2", "s"], interval=interval)


def test_the_remedies_of_the_message_work():
    """Both declarations give the closed circle."""
    named = Loop.parametric(["2", "s"], interval=(0, "2*pi"), periods={1: "2*pi"})
    for frame, loop in ((polar(), named), (polar(*FULL), TURN)):
        developed = develop(levi_civita(frame), loop)
        assert np.abs(developed.burgers).max() <= developed.error
