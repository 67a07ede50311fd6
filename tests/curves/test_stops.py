"""Stops: curves that end at a condition, in any chart, agree with event times."""

# Charts that have a frame.
# pyright: reportArgumentType=false

import math

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import ChartEdgeError, ExpressionError, ProofError, StartError
from tests.ode.engines import every_engine

KERR = gt.spaces.load("kerr").frame
HOLE = {"M": 1, "a": 0.5}
# Plunge from r = 10; it passes r = 3 at 19.56305262 and is inside the horizon at 22.
PLUNGE = ([0, 10, math.pi / 2, 0], [1.3, -0.3, 0, 0.03])
PASSES = 19.56305262


def plunge(**options):
    return gt.geodesic(KERR, *PLUNGE, parameters=HOLE, **options)


def test_event_times_through_a_chart_change():
    """r has a value inside the horizon as well, where t and phi of the same chart have none."""
    solution = gt.solve(plunge(), 22.0)
    assert solution.charts == ("kerr", "ingoing")
    assert solution.event_times("r - 3") == pytest.approx([PASSES], abs=1e-8)
    # The horizon itself, and a point inside it.
    outer = 1 + math.sqrt(0.75)
    inside = solution.event_times(f"r - {outer - 0.1}")
    (crossed,) = solution.event_times(f"r - {outer}")
    assert PASSES < crossed < inside[0] < 22
    assert solution.in_chart("ingoing")[-1, 1] < outer - 0.1
    with pytest.raises(ExpressionError, match="no finite value"):
        solution.event_times("t - 20")


@every_engine
@pytest.mark.parametrize(
    "stop", ["r - 3", gt.When("r - 3"), sp.Symbol("r") - 3, ["r - 2", "r - 3*M", "t + 1"]]
)
def test_a_plunge_stops(engine, stop):
    """Text, sympy, When and lists; the first condition to fall ends the curve and is named."""
    solution = gt.solve(plunge(stop=stop), 22.0, engine=engine)
    assert solution.outcome == "stopped"
    assert float(solution.times[-1]) == pytest.approx(PASSES, abs=1e-8)
    assert solution.coordinates[-1, 1] == pytest.approx(3, abs=1e-9)
    assert sp.sympify(solution.stopped_by).has(sp.Symbol("r"))


def test_a_stop_behind_a_change_of_charts():
    """The condition is translated into the chart of the motion by the maps of the atlas."""
    free = gt.solve(plunge(), 22.0)
    stopped = gt.solve(plunge(stop="r - 1.7"), 22.0)
    assert stopped.charts == ("kerr", "ingoing")
    assert stopped.stopped_by == "r - 1.7"
    assert stopped.times[-1] == pytest.approx(free.event_times("r - 1.7")[0], abs=1e-8)
    # r = sqrt(x^2 + y^2 + z^2) in the second chart.
    hole = gt.spaces.load("schwarzschild").frame
    fall = {"frame_velocity": [1.25, -0.75, 0, 0], "parameters": {"M": 1.0}}
    ended = gt.solve(gt.geodesic(hole, [0.0, 3.0, 1.2, 0.0], stop="r - 1", **fall), 5.0)
    assert ended.charts == ("schwarzschild", "kerr_schild")
    assert np.linalg.norm(ended.in_chart("kerr_schild")[-1, 1:]) == pytest.approx(1, abs=1e-9)


def test_from_one_apsis_to_the_next():
    """A frame velocity may stop a curve; it starts at zero and rises first."""
    hole = gt.spaces.load("schwarzschild").frame
    start = [0, 10, math.pi / 2, 0]
    options = {"frame_velocity": [1.1, 0, 0, 0.48], "parameters": {"M": 1.0}}
    solution = gt.solve(gt.geodesic(hole, start, stop="u2", **options), 5000.0)
    assert solution.outcome == "stopped"
    assert solution.coordinates[-1, 1] > 20
    assert abs(solution.frame_velocity[-1, 1]) < 1e-9
    free = gt.solve(gt.geodesic(hole, start, **options), 5000.0)
    assert free.event_times("u2", -1)[0] == pytest.approx(solution.times[-1], rel=1e-8)


def test_one_turn_of_an_autoparallel():
    """An angle counts further in its own chart: others, where it would jump, are not used."""
    sphere = gt.spaces.load("s2").frame
    problem = gt.autoparallel(
        gt.levi_civita(sphere), [1.0, 0.0], [0.0, 1.0], parameters={"R": 1}, stop="2*pi - phi"
    )
    assert problem.charts == ("s2",)
    solution = gt.solve(problem, 20.0)
    assert solution.outcome == "stopped"
    assert solution.times[-1] == pytest.approx(2 * math.pi / math.sin(1.0), rel=1e-9)


def test_velocities_only():
    """Velocities of a group without coordinates stop as well."""
    top = gt.geodesic(
        gt.spaces.load("so3").frame, frame_velocity=[0.1, 2, 0.1], metric=[1, 2, 3], stop="u2"
    )
    solution = gt.solve(top, 100.0)
    assert solution.outcome == "stopped"
    assert abs(solution.frame_velocity[-1, 1]) < 1e-8


@every_engine
@pytest.mark.parametrize("stop", ["r - 3", ["r - 1.7", "11 - r"], ["r - 2.5", "u4 + 0.1"]])
def test_bundles_keep_their_own_ends(engine, stop):
    """Curves from many starts end as each does by itself, also in another chart."""
    velocities = [[1.3, -0.3, 0, 0.03], [1.3, 0.3, 0, 0.03], [1.4, -0.5, 0.01, 0.0]]
    fall = plunge(stop=stop)
    many = gt.solve_many(
        fall, [PLUNGE[0]] * 3, [5.0, 15.0, 30.0], 1e-9, engine, velocities=velocities
    )
    for row, velocity in enumerate(velocities):
        alone = gt.solve(fall.with_start(velocity=velocity), [5.0, 15.0, 30.0], 1e-9)
        assert many.stopped_by[row] == alone.stopped_by
        assert many.end.time[row] == pytest.approx(alone.times[-1], rel=1e-8)
        if alone.charts == ("kerr",):
            assert many.end.coordinates[row] == pytest.approx(alone.coordinates[-1], rel=1e-7)
        else:
            assert np.isfinite(many.end["r"][row]) or alone.charts[-1] == "ingoing"


def test_a_bundle_refuses_a_start_beyond_its_stop():
    """The error names the member and the condition."""
    starts = [PLUNGE[0], [0, 2, math.pi / 2, 0]]
    with pytest.raises(StartError, match=r"expected r - 3 above zero .* got -1 for member 1"):
        gt.solve_many(plunge(stop="r - 3"), starts, 5.0, velocities=[PLUNGE[1]] * 2)


def test_bundles_without_coordinates_and_with_constant_velocities():
    """A bundle in a group stops as well; and so do straight lines, in closed form."""
    top = gt.geodesic(
        gt.spaces.load("so3").frame, frame_velocity=[0.1, 2, 0.1], metric=[1, 2, 3], stop="u2"
    )
    many = gt.solve_many(top, t=30.0, frame_velocities=[[0.1, 2, 0.1], [0.3, 1, 0.2]])
    for row in range(2):
        alone = gt.solve(
            top.with_start(frame_velocity=many.members.varied["frame_velocity"][row].tolist()), 30.0
        )
        assert many.end.time[row] == pytest.approx(alone.times[-1], rel=1e-8)
    x, y = sp.symbols("x y")
    line = gt.geodesic(gt.Frame([x, y], [[1, 0], [0, 1]]), [0, 0], [1, 0], stop="1 - x")
    speeds = np.array([[0.5, 1.0], [2.0, 3.0], [-1.0, 0.0]])
    lines = gt.solve_many(line, t=[1.0, 3.0], velocities=speeds)
    assert lines.times_at_stop[:2] == pytest.approx([2.0, 0.5], rel=1e-10)
    assert lines.end["y"] == pytest.approx([2.0, 1.5, 0.0], rel=1e-10)
    assert lines.end["x"] == pytest.approx([1.0, 1.0, -3.0], rel=1e-10)
    assert lines["x"][0].tolist() == pytest.approx([0.5, np.nan], nan_ok=True)


PLANE = gt.Frame("x y", [[1, 0], [0, 1]], name="plane")
KINKS = [
    ("3 - abs(x)", [-1, 0], [1, 1], 4.0),
    ("3 - abs(x)", [-1, 0], [-1, 1], 2.0),
    ("3 - 2*max(abs(x), abs(y))", [0, 0], [1, -3], 0.5),
    ("min(3 - x, 2 - y)", [-1, 0], [1, 3], 2 / 3),
    (2 - sp.Abs(sp.Symbol("x")), [0, 0], [-1, 0], 2.0),
]


@pytest.mark.parametrize(("stop", "start", "velocity", "end"), KINKS)
def test_a_condition_with_a_kink_ends_where_its_smaller_side_does(stop, start, velocity, end):
    """On a line the side that is reached first, under the name that the user gave."""
    line = gt.geodesic(PLANE, start, velocity, stop=stop)
    solution = gt.solve(line, 30.0)
    assert solution.times[-1] == pytest.approx(end, rel=1e-9)
    assert solution.stopped_by == str(stop)


def test_a_map_of_ends_counts_both_sides_of_a_kink_as_one():
    """Lines to the left and to the right leave a strip by one condition, one goes along it."""
    line = gt.geodesic(PLANE, [0, 0], [1, 1], stop=["3 - abs(x)", "5 - y"])
    ends = gt.end_map(line, {"x'": [-1.0, 0.0, 1.0], "y'": [1.0]}, 10.0)
    assert ends.conditions == ("3 - abs(x)", "5 - y")
    assert ends.fate.tolist() == [[0, 1, 0]]


@pytest.mark.parametrize(
    ("stop", "error", "words"),
    [
        ("3 - r", StartError, r"expected 3 - r above zero at the start, got -7. .* -\(3 - r\)"),
        ("q - 1", ExpressionError, "stop: q is neither"),
        ("abs(r) - 3", ExpressionError, "not smooth"),
        (sp.Abs(sp.Symbol("r")) - 3, ExpressionError, "stop: .* not smooth"),
        ("M", ExpressionError, "expected an expression that changes along the curve, got M"),
        (["r - 3", 5], ExpressionError, r"stop\[1\]: expected an expression that changes"),
    ],
)
def test_refusals(stop, error, words):
    """A condition that cannot stop a curve is refused, with a remedy."""
    with pytest.raises(error, match=words):
        gt.solve(plunge(stop=stop), 1.0)


def test_where_no_other_chart_states_the_condition():
    """The error at the end of the chart gives the reason that no other chart was used."""
    with pytest.raises(ChartEdgeError, match=r"cannot state the condition to stop \(1 - u2\)"):
        gt.solve(plunge(stop="1 - u2"), 22.0)


def test_a_start_on_the_axis_names_the_chart():
    """The error names the chart that covers the pole and its coordinates; a curve starts there."""
    with pytest.raises(
        StartError, match=r"Chart 'axis' covers this point, at .* y_ax = 0, z_ax = 1"
    ):
        gt.geodesic(KERR, [0, 10, 0, 0], [1.3, -0.3, 0, 0.03], parameters=HOLE)
    axis = plunge().atlas.chart("axis").frame
    started = gt.geodesic(axis, [0, 10, 0, 1], [1.3, -0.1, 0.01, 0], parameters=HOLE)
    assert gt.solve(started, 1.0).outcome == "done"


def test_a_null_tetrad_names_from_metric():
    """A complex frame has no motions; a real one of the same metric has."""
    null = gt.spaces.load("kerr_kinnersley").frame
    with pytest.raises(StartError, match=r"gt.Frame.from_metric\(frame.coordinates"):
        gt.geodesic(null, *PLUNGE, parameters=HOLE)
    real = gt.Frame.from_metric(null.coordinates, null.metric.to_sympy())
    there = gt.solve(gt.geodesic(real, *PLUNGE, parameters=HOLE), 5.0)
    here = gt.solve(plunge(), 5.0)
    assert there.coordinates[-1] == pytest.approx(here.coordinates[-1], rel=1e-8)


def test_the_end_is_proved():
    """The point where one condition stops a curve is proved in balls; several are refused."""
    start = {"frame_velocity": [1.25, -0.75, 0, 0], "parameters": {"M": 1.0}}
    hole = gt.spaces.load("schwarzschild").frame
    fall = gt.solve(gt.geodesic(hole, [0.0, 6.0, 1.5, 0.0], stop="r - 3", **start), 5.0)
    proof = gt.prove(fall)
    assert proof.holds
    two = gt.geodesic(hole, [0.0, 6.0, 1.5, 0.0], stop=["r - 3", "r - 5"], **start)
    with pytest.raises(ProofError, match="at most one condition to stop, .* stop = r - 3, r - 5"):
        gt.prove(gt.solve(two, 5.0))
