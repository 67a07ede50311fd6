"""Bad input: an error of ours that names the value and the remedy."""

import pytest

from geomtorsion.curves import autoparallel, geodesic, geodesic_deviation, parallel_transport
from geomtorsion.errors import MetricError, ShapeError, StartError
from geomtorsion.geometry import cartan
from geomtorsion.ode import solve_many
from geomtorsion.spaces import load

SO3 = load("so3").frame
S2 = load("s2").frame
HOLE = load("schwarzschild").frame
START, TURN = [0.3, 1.0, 0.2], [0.1, 0.5, -0.2]


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: geodesic(SO3, [0.3, 1.0], TURN), ShapeError, "3 numbers were needed, 2 came"),
        (lambda: geodesic(SO3, START, [1, 2]), ShapeError, "3 numbers were needed, 2 came"),
        (lambda: geodesic(SO3, START, "abc"), ShapeError, "list of 3 numbers"),
        (lambda: geodesic(SO3, [0.3, float("nan"), 0], TURN), StartError, r"start.*\[1\] = nan"),
        (lambda: geodesic(SO3, START, [0, 0, 1j]), StartError, "no real number"),
        (lambda: geodesic(SO3, [0.3, 0.0, 0.2], TURN), StartError, "singular at the start"),
        (lambda: geodesic(SO3, START), StartError, "none came"),
        (lambda: geodesic(SO3, START, TURN, frame_velocity=TURN), StartError, "both came"),
        (lambda: geodesic(SO3, None, TURN), StartError, "needs a start"),
        (lambda: geodesic(S2, [1, 0], [0, 1]), StartError, r"R.*parameters=\{"),
        (
            lambda: geodesic(S2, [1, 0], [0, 1], parameters={"r": 1}),
            StartError,
            "'r' is no parameter",
        ),
        (
            lambda: geodesic(S2, None, frame_velocity=[0, 1], parameters={"R": 1}),
            StartError,
            "stand alone",
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
            "the velocity is null",
        ),
        (
            lambda: geodesic(
                HOLE, [0, 2, 1.5, 0], frame_velocity=[1, 0, 0, 0], parameters={"M": 1}
            ),
            StartError,
            "singular at the start",
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
            "needs coordinates",
        ),
        (
            lambda: solve_many(geodesic(SO3, START, TURN), [[1, 2]], 1.0),
            ShapeError,
            r"shape \(number, 3\)",
        ),
        (
            lambda: solve_many(
                geodesic(SO3, START, TURN), [START] * 2, 1.0, frame_velocities=[TURN] * 3
            ),
            ShapeError,
            "different length",
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
    """Each names what came and what helps."""
    with pytest.raises(error, match=message):
        make()
