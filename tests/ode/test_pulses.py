"""Pulses of the time that are narrower than a step, and starts that a motion may leave any time."""

import math

import numpy as np
import pytest

from geomtorsion.errors import StartError
from geomtorsion.ode import ODE, solve
from tests.ode.engines import needs_heyoka

# Functions of u = (t - c)/w whose integral over a pulse far from both ends is known.
AREAS = {
    "exp(-((t - c)/w)**2)/w": math.sqrt(math.pi),
    "1/(1 + ((t - c)/w)**2)/w": None,
    "(1 - tanh((t - c)/w)**2)/w": 2.0,
}


@pytest.mark.parametrize("width", [1e-3, 1e-5, 1e-8])
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("pulse", AREAS)
@needs_heyoka
def test_a_narrow_pulse_is_not_missed(pulse, sign, width):
    """Its integral is known; without a look at the time, all steps pass over it."""
    centre = 3.3 * sign
    problem = ODE.of({"x": pulse}, [0], parameters={"w": width, "c": centre})
    motion = solve(problem, 10.0 * sign)
    area = AREAS[pulse] or math.atan(6.7 / width) + math.atan(3.3 / width)
    error = abs(motion["x"][-1] - sign * area)
    assert error <= motion.error * area
    assert motion.error < 1e-10


@needs_heyoka
def test_a_blow_to_an_oscillator():
    """x = cos(t) and the blow of the Gaussian: sqrt(pi) sin(t - c), up to w^2/4 of it."""
    rates = {"x": "v", "v": "-x + exp(-((t - 5)/w)**2)/w"}
    motion = solve(ODE.of(rates, [1, 0], parameters={"w": 1e-8}), 10.0)
    truth = math.cos(10) + math.sqrt(math.pi) * math.sin(5)
    assert abs(motion["x"][-1] - truth) <= motion.error * np.abs(motion["x"]).max()


@pytest.mark.parametrize(
    ("rates", "start"),
    [
        ({"x": "sqrt(x)"}, [0]),
        ({"x": "x**(2/3)"}, [0]),
        ({"x": "sqrt(abs(x))"}, [0]),
        # Norton's dome.
        ({"x": "v", "v": "sqrt(x)"}, [0, 0]),
        # The turning point of an oscillator, from its energy.
        ({"x": "sqrt(1 - x**2)"}, [-1]),
    ],
)
def test_a_start_with_more_than_one_motion_is_refused(rates, start):
    """x = 0 and x = t^2/4 both solve x' = sqrt(x)."""
    with pytest.raises(StartError, match="rest or leave at any time"):
        solve(ODE.of(rates, start), 1.0)


@pytest.mark.parametrize(
    ("rate", "end"),
    [("-sqrt(x)", 0.0), ("x*sqrt(x)", 0.0), ("sqrt(x**2)", 0.0)],
)
def test_a_root_with_one_motion_is_solved(rate, end):
    assert solve(ODE.of({"x": rate}, [0]), 1.0)["x"][-1] == end


def test_a_tank_that_is_filled_leaves_its_root():
    """h' = 1 - sqrt(h): t = -2 (sqrt(h) + log(1 - sqrt(h)))."""
    filled = solve(ODE.of({"h": "1 - sqrt(h)"}, [0]), 1.0)
    root = math.sqrt(filled["h"][-1])
    assert -2 * (root + math.log(1 - root)) == pytest.approx(1.0, abs=10 * filled.error)
