"""State: one attitude given in three ways, and invalid starts."""

# The tests pass bad input and arrays for lists, and use results that could be None.
# pyright: reportArgumentType=false, reportOptionalSubscript=false

from typing import Any

import numpy as np
import pytest

from geomtorsion.errors import BodyError, SceneError, StartError, UnknownNameError
from geomtorsion.scenes import Body, State
from geomtorsion.scenes.effects import Spring
from tests.rounding import ROUNDED
from tests.scenes.brute import zyz


def test_three_ways_to_give_an_attitude():
    angles = (0.4, 1.1, -0.7)
    by_euler: Any = State(omega=(0, 0, 1), euler=angles).attitude
    by_matrix: Any = State(omega=(0, 0, 1), matrix=zyz(*angles).tolist()).attitude
    by_quaternion: Any = State(omega=(0, 0, 1), quaternion=by_euler.tolist()).attitude
    assert np.abs(by_euler - by_matrix).max() < ROUNDED
    assert np.abs(by_euler - by_quaternion).max() < ROUNDED
    assert State(omega=(0, 0, 1)).attitude is None


def test_other_conventions():
    """Yaw, pitch, roll about body axes are roll, pitch, yaw about space axes."""
    one: Any = State(euler=(0.3, 0.2, 0.1), euler_convention="ZYX").attitude
    two: Any = State(euler=(0.1, 0.2, 0.3), euler_convention="xyz").attitude
    assert np.abs(one - two).max() < ROUNDED
    assert State(euler_convention="paper").euler_convention == "zyz"


def test_arrays_are_kept_as_tuples():
    state = State(omega=np.array([1.0, 2.0, 3.0]), quaternion=np.array([1.0, 0, 0, 0]))
    assert state.omega == (1.0, 2.0, 3.0)
    assert state == State(omega=(1.0, 2.0, 3.0), quaternion=(1.0, 0, 0, 0))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"omega": (1, 2)}, "omega: expected three numbers \\(rad/s\\), got \\(1, 2\\)"),
        ({"omega": 3}, "omega: expected three numbers .rad/s., got 3"),
        ({"omega": "abc"}, "omega: expected three numbers .rad/s., got 'abc'"),
        ({"omega": (1, float("inf"), 0)}, "omega\\[1\\]: expected a finite number, got inf"),
        ({"omega": (1, "fast", 0)}, "omega\\[1\\]: expected a number, got 'fast'"),
        ({"omega": (1, True, 0)}, "omega\\[1\\]: expected a number, got True"),
        ({"position": (1, 2, None)}, "position\\[2\\]: expected a number, got None"),
        (
            {"euler": (0, 0, 0), "quaternion": (1, 0, 0, 0)},
            "expected it once, got euler and quaternion",
        ),
        ({"quaternion": (0, 0, 0, 0)}, "quaternion: expected length 1, got 0"),
        ({"quaternion": (1, 1, 0, 0)}, "expected length 1, got 1.41421356"),
        ({"quaternion": (1, 0, 0)}, "four numbers, scalar first"),
        ({"matrix": [[1, 0], [0, 1]]}, "3 x 3 numbers"),
        ({"matrix": [[1, 0, 0], [0, 1, 0], [0, 0, -1]]}, "got a reflection"),
    ],
)
def test_invalid_starts_are_refused(given, words):
    with pytest.raises(StartError, match=words):
        State(**given)


def test_unknown_convention():
    with pytest.raises(
        UnknownNameError, match="Euler angles: expected the name of a convention, got 'zzx'"
    ):
        State(euler=(0, 0, 0), euler_convention="zzx")


@pytest.mark.parametrize(
    ("call", "value"),
    [
        (lambda: State(omega=(0, 0, "60 rpm")).omega[2], 2 * np.pi),
        (lambda: State(euler=("90 deg", 0, 0)).euler[0], np.pi / 2),
        (lambda: State(position=("3 km", 0, 0)).position[0], 3000),
        (lambda: Body("200 g", ("3 g m^2", 0.003, 0.003)).mass, 0.2),
        (lambda: Body.box("3 kg", ("200 cm", 2, 2)).moments[0], 2),
        (lambda: Body.cylinder(4, "1 m", "0 m").moments[2], 2),
        (lambda: Spring("2 N/cm").stiffness, 200),
    ],
)
def test_texts_with_units(call, value):
    """Numbers of bodies, starts and effects may be texts with a unit."""
    assert call() == pytest.approx(value, rel=ROUNDED)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: State(omega=(0, 0, "60 kg")), StartError, "omega: expected a value in rad/s, got"),
        (lambda: Body("2 m", (1, 1, 1)), BodyError, "mass: expected a value in kg, got the unit m"),
        (lambda: Spring("2 kg"), SceneError, "spring.stiffness: expected a value in N/m, got"),
    ],
)
def test_units_that_measure_something_else(call, error, words):
    """A wrong unit is named with its field."""
    with pytest.raises(error, match=words):
        call()
