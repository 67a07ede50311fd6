"""Bad input: an error of ours that names the value and the remedy."""

import pytest
import sympy as sp

from geomtorsion.curves import (
    autoparallel,
    geodesic,
    geodesic_deviation,
    parallel_transport,
)
from geomtorsion.errors import MetricError, ShapeError, StartError
from geomtorsion.geometry import Frame, cartan
from geomtorsion.ode import solve_many
from geomtorsion.spaces import load

SO3 = load("so3").frame
MOSTLY_MINUS = Frame(sp.symbols("t x y z"), sp.eye(4), signature=(1, -1, -1, -1))
S2 = load("s2").frame
HOLE = load("schwarzschild").frame
START, TURN = [0.3, 1.0, 0.2], [0.1, 0.5, -0.2]


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: geodesic(SO3, [0.3, 1.0], TURN), ShapeError, "expected 3 numbers, got 2"),
        (lambda: geodesic(SO3, START, [1, 2]), ShapeError, "expected 3 numbers, got 2"),
        (lambda: geodesic(SO3, START, "abc"), ShapeError, "list of 3 numbers"),
        (lambda: geodesic(SO3, [0.3, float("nan"), 0], TURN), StartError, "start.*, got nan"),
        (lambda: geodesic(SO3, START, [0, 0, 1j]), StartError, "expected a number, got"),
        (lambda: geodesic(SO3, [0.3, 0.0, 0.2], TURN), StartError, "is singular at the start"),
        (lambda: geodesic(SO3, START), StartError, "got none. Give one"),
        (lambda: geodesic(SO3, START, TURN, frame_velocity=TURN), StartError, "got both. Give one"),
        (lambda: geodesic(SO3, None, TURN), StartError, "expected a start with it, got none"),
        (lambda: geodesic(S2, [1, 0], [0, 1]), StartError, r"R.*parameters=\{"),
        (
            lambda: geodesic(S2, [1, 0], [0, 1], parameters={"r": 1}),
            StartError,
            "expected a parameter of this frame, got 'r'",
        ),
        (
            lambda: geodesic(S2, None, frame_velocity=[0, 1], parameters={"R": 1}),
            StartError,
            "expected velocity equations without coordinates",
        ),
        (lambda: geodesic(SO3, START, TURN, metric=[1, 2]), ShapeError, "3 numbers"),
        (lambda: geodesic(SO3, START, TURN, metric=[1, 0, 2]), MetricError, "singular"),
        (
            lambda: geodesic(SO3, START, TURN, metric=[[1, 1, 0], [0, 1, 0], [0, 0, 1]]),
            MetricError,
            "not symmetric",
        ),
        (lambda: geodesic(SO3, START, TURN, causal="timelike"), StartError, "Euclidean"),
        (
            lambda: geodesic(
                HOLE, [0, 6, 1.5, 0], frame_velocity=[1, 1, 0, 0], parameters={"M": 1},
                causal="timelike",
            ),
            StartError,
            "got a null one",
        ),
        (
            lambda: geodesic(MOSTLY_MINUS, [0] * 4, [0, 1, 0, 0], causal="timelike"),
            StartError,
            "got a spacelike one",
        ),
        (
            lambda: geodesic(MOSTLY_MINUS, [0] * 4, [2, 1, 0, 0], causal="spacelike"),
            StartError,
            "got a timelike one",
        ),
        (
            lambda: geodesic(
                HOLE, [0, 2, 1.5, 0], frame_velocity=[1, 0, 0, 0], parameters={"M": 1}
            ),
            StartError,
            "is singular at the start",
        ),
        (
            lambda: autoparallel(
                cartan(load("kerr_kinnersley").frame), None, frame_velocity=[1, 0, 0, 0]
            ),
            StartError,
            "complex",
        ),
        (
            lambda: parallel_transport(geodesic(SO3, START, TURN), [1, 2]),
            ShapeError,
            "3 numbers",
        ),
        (
            lambda: parallel_transport(geodesic(SO3, START, TURN), [1, 2, 3], cartan(S2)),
            ShapeError,
            "another frame",
        ),
        (
            lambda: geodesic_deviation(geodesic(SO3, frame_velocity=TURN), [1, 0, 0]),
            StartError,
            "expected a problem with coordinates, got one without",
        ),
        (
            lambda: solve_many(geodesic(SO3, START, TURN), [[1, 2]], 1.0),
            ShapeError,
            r"shape \(any, 3\)",
        ),
        (
            lambda: solve_many(
                geodesic(SO3, START, TURN), [START] * 2, 1.0, frame_velocities=[TURN] * 3
            ),
            ShapeError,
            "expected lists of equal length",
        ),
        (
            lambda: solve_many(geodesic(SO3, START, TURN), [[0.3, float("inf"), 0]], 1.0),
            StartError,
            "not finite",
        ),
        (lambda: solve_many(geodesic(SO3, START, TURN), t=1.0), StartError, "one row per"),
    ],
)  # fmt: skip
def test_refused(make, error, message):
    """Each refusal names the input and a remedy."""
    with pytest.raises(error, match=message):
        make()


@pytest.mark.parametrize("place", [2.0, 2.0 * (1 + 2**-52), 5.0])
def test_legs_that_end_where_the_determinant_does_not(place):
    """On the horizon of Schwarzschild's coordinates the volume is finite, but the legs are not."""
    space = load("schwarzschild").frame
    start, speed = [0, place, 1.2, 0], [1, 0, 0, 0]
    if place == 2.0:
        with pytest.raises(StartError, match="is singular at the start"):
            geodesic(space, start, frame_velocity=speed, parameters={"M": 1})
    else:
        problem = geodesic(space, start, frame_velocity=speed, parameters={"M": 1})
        assert problem.start == tuple(start)


def test_legs_that_doubles_do_not_give():
    """A removable gap of a form does not refuse a start; a gap to a zero divisor does."""
    r = sp.Symbol("r")
    frame = Frame([r], [[(r**2 - 1) / (r - 1) + sp.sin(r) / r]])
    assert geodesic(frame, [1.0], [1.0]).start == (1.0,)
    with pytest.raises(StartError, match="is singular at the start"):
        geodesic(frame, [0.0], [1.0])
