"""Ends: where charts and frames end, motions continue or stop with a message of where."""

import re
import warnings

import numpy as np
import pytest
from scipy.integrate import quad

from geomtorsion.curves import autoparallel, geodesic, geodesic_deviation
from geomtorsion.errors import ChartEdgeError
from geomtorsion.geometry import cartan
from geomtorsion.ode import Taylor, solve, solve_many
from geomtorsion.spaces import load
from tests.ode.engines import ENGINES, every_engine, needs_heyoka

# A fall with energy E = 1.25 sqrt(f), f = 1/3, and dr/dtau = -0.75 sqrt(f): it ends at r = 0.
FALL = {"frame_velocity": [1.25, -0.75, 0, 0], "parameters": {"M": 1.0}, "causal": "timelike"}


def fall(theta, phi):
    return geodesic(load("schwarzschild").frame, [0.0, 3.0, theta, phi], **FALL)


def proper_time(radius):
    """Proper time of the fall from r = 3: int dr / sqrt(E^2 - f(r)), as dr/dtau^2 = E^2 - f."""
    energy = 1.25**2 / 3
    # r = s^2 takes the root out of the origin.
    return quad(
        lambda s: 2 * s**2 / np.sqrt((energy - 1) * s**2 + 2), np.sqrt(radius), np.sqrt(3.0)
    )[0]


@every_engine
@pytest.mark.parametrize("theta", [np.pi / 2, 1.2])
@pytest.mark.parametrize("phi", [0.0, 0.4])
def test_radial_infall(theta, phi, engine):
    """A fall crosses the horizon at any angle, phi = 0 (where y_ = 0 all the way) included."""
    sol = solve(fall(theta, phi), [1.0, 2.0, 3.0], 1e-9, engine)
    assert sol.charts == ("schwarzschild", "kerr_schild")
    places = sol.in_chart("kerr_schild")[:, 1:]
    radii = np.linalg.norm(places, axis=1)
    assert [proper_time(r) for r in radii] == pytest.approx([1.0, 2.0, 3.0], abs=1e-8)
    direction = [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)]
    assert places == pytest.approx(np.outer(radii, direction), abs=1e-9)


@needs_heyoka
@pytest.mark.parametrize("precision", [64, 113])
def test_radial_infall_precisely(precision):
    """As above, with more digits."""
    sol = solve(fall(np.pi / 2, 0.0), [3.0], 1e-15, Taylor(precision))
    radius = np.linalg.norm(sol.in_chart("kerr_schild")[-1, 1:].astype(float))
    assert proper_time(radius) == pytest.approx(3.0, abs=1e-11)


ENDINGS = [
    *((engine, phi) for engine in ENGINES for phi in (0.0, 0.4)),
    pytest.param(Taylor(64), 0.4, marks=[needs_heyoka, pytest.mark.slow]),
]


@pytest.mark.parametrize(("engine", "phi"), ENDINGS)
def test_the_singularity_is_where_it_is(engine, phi):
    """The message names the last regular point: r near 0, at the proper time of the fall."""
    with pytest.raises(ChartEdgeError) as caught:
        solve(fall(1.2, phi), 10.0, 1e-9, engine)
    text, sol = str(caught.value), caught.value.solution
    numbers = {name: float(x) for name, x in re.findall(r"(\w+) = ([-+.\de]*\d)", text)}
    assert numbers["t"] == pytest.approx(proper_time(0.0), abs=1e-5)
    assert np.linalg.norm([numbers[name] for name in ("x_", "y_", "z_")]) < 1e-4
    assert sol.times[-1] <= numbers["t"] < sol.times[-1] + 10 / 64
    last = sol.in_chart("kerr_schild")[-1]
    assert proper_time(np.linalg.norm(last[1:])) == pytest.approx(sol.times[-1], abs=1e-6)
    assert 0 < numbers["T"] - last[0] < 1


@needs_heyoka
def test_the_last_chart_that_has_a_value_counts():
    """Near r = 0 other charts may still give a position for a motion, but no velocities."""
    start = [0, 17.579325770223637, 1.2217500227440852, 0.3]
    velocity = [1.0052513698156307, 0.0025600512702218525, 0.0, 9.18702393760401e-05]
    numbers = {"M": 1.0, "a": 0.0}
    problem = geodesic(
        load("kerr").frame, start, frame_velocity=velocity, parameters=numbers, causal=None
    )
    with pytest.raises(ChartEdgeError, match=r"stops at t = 82\.18.*, r_in = [34]\.\d+e-05") as got:
        solve(problem, np.linspace(0, 126.31555158213958, 36), 1e-10)
    assert got.value.solution.times[-1] == pytest.approx(79.4, abs=0.01)


ENDING = {
    "flat_polar": ([1.0, 0.4], [-1.0, 0.0]),
    "flat_cylindrical": ([1.0, 0.4, 0.0], [-1.0, 0.0, 0.5]),
    "flat_spherical": ([1.0, 0.8, 0.4], [-1.0, 0.0, 0.0]),
}


@every_engine
@pytest.mark.parametrize("name", ENDING)
def test_autoparallels_end_with_their_frame(name, engine):
    """A motion straight to the origin, where the frame has no direction, stops at r = 0."""
    start, velocity = ENDING[name]
    problem = autoparallel(cartan(load(name).frame), start, frame_velocity=velocity)
    with pytest.raises(ChartEdgeError, match=r"stops at t = 1, at r = .* frame itself") as got:
        solve(problem, [0.25, 0.5, 1.5, 3.0], 1e-10, engine)
    sol = got.value.solution
    assert not sol.complete
    assert sol.times == pytest.approx([0.25, 0.5])
    assert sol.coordinates[:, 0] == pytest.approx([0.75, 0.5], abs=1e-10)
    assert sol.at(0.9).coordinates[0] == pytest.approx(0.1, abs=1e-9)
    assert solve(problem, 0.99, 1e-10, engine).complete


def test_the_advice_fits():
    """The advice depends on why the motion cannot leave its chart."""
    through = geodesic(load("flat_polar").frame, [1.0, 0.4], [-1.0, 0.0])
    with pytest.raises(ChartEdgeError, match="Allow another chart of cartesian"):
        solve(through.with_charts("flat_polar"), 2.0)
    with pytest.raises(ChartEdgeError, match="The transported vectors are given in this frame"):
        solve(geodesic_deviation(through, [0.0, 0.1], [0.0, 0.0]), 2.0)


@every_engine
def test_loxodromes_end_at_the_pole(engine):
    """A loxodrome due north on s2 ends at the pole, where there is no north."""
    problem = autoparallel(
        cartan(load("s2").frame), [1.0, 0.2], frame_velocity=[-1, 0], parameters={"R": 1}
    )
    with pytest.raises(ChartEdgeError, match=r"stops at t = 1, at theta = .*sin\(theta\) = 0"):
        solve(problem, 2.0, 1e-10, engine)


@every_engine
def test_batches_do_not_pass_the_end(engine):
    """The one of two autoparallels that meets the origin is not finished."""
    problem = autoparallel(cartan(load("flat_polar").frame), [1.0, 0.4], frame_velocity=[-1.0, 0])
    many = solve_many(problem, None, 1.5, 1e-9, engine, frame_velocities=[[-1.0, 0.0], [-0.5, 0.0]])
    assert many.finished.tolist() == [False, True]
    assert many.coordinates[1, -1] == pytest.approx([0.25, 0.4], abs=1e-9)


@every_engine
@pytest.mark.parametrize("name", ENDING)
@pytest.mark.parametrize("home_first", [False, True])
def test_no_warnings_at_the_origin(name, home_first, engine):
    """Geodesics pass through the origin; all results there come without warnings."""
    start, velocity = ENDING[name]
    for angle in (0.0, 0.4):
        problem = geodesic(load(name).frame, [*start[:-1], angle], velocity)
        if home_first:
            problem = problem.with_charts(name, "cartesian")
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            for times in ([1.0], [0.5, 1.0, 2.0], 3.0):
                sol = solve(problem, times, 1e-10, engine)
                assert sol.complete
                assert len(sol.velocity) == len(sol.frame_velocity) == len(sol.times)
                assert max(sol.drift.values(), default=0.0) < 1e-9
                assert sol.at(1.0).coordinates.shape == (len(start),)
        if name != "flat_cylindrical":
            assert sol.coordinates[-1, 0] == pytest.approx(2.0, abs=1e-9)


@every_engine
@pytest.mark.parametrize(("accuracy", "miss"), [(1e-6, 1e-5), (1e-6, 0.1), (1e-10, 1e-4)])
def test_the_error_holds_beside_the_origin(accuracy, miss, engine):
    """A straight line that passes the origin at a distance: angle and velocities count there."""
    problem = geodesic(load("flat_polar").frame, [1.0, 0.0], [-1.0, miss])
    times = np.array([0.5, 1.0, 1.5])
    sol = solve(problem, times, accuracy, engine)
    x, y = 1 - times, miss * times
    r = np.hypot(x, y)
    places = np.array([r, np.arctan2(y, x)]).T
    speeds = np.array([(miss * y - x) / r, (miss * x + y) / r**2]).T
    assert sol.error <= accuracy
    for got, exact in ((sol.coordinates, places), (sol.velocity, speeds)):
        assert np.abs(got - exact).max() <= (sol.error + 1e-15 / miss) * np.abs(exact).max()


@every_engine
def test_members_pass_through_the_origin(engine):
    """One of two lines meets the origin at a time that is read; the other misses it."""
    problem = geodesic(load("flat_polar").frame, [1.0, 0.4], [-1.0, 0.0])
    speeds = [[-1.0, 0.0], [-1.0, 0.2]]
    many = solve_many(problem, None, [0.5, 1.0, 3.0], 1e-9, engine, velocities=speeds)
    assert many.finished.all()
    assert many.error <= 1e-9
    assert many.coordinates[:, -1, 0] == pytest.approx([2.0, np.hypot(2.0, 0.6)], abs=1e-8)


@every_engine
def test_the_end_of_all_charts_is_found(engine):
    """Kerr's inner horizon, r = M - sqrt(M^2 - a^2), is where both charts that reach it end.

    A motion does not change between these charts again and again.
    """
    problem = geodesic(
        load("kerr").frame, [0, 8.0, 1.0, 0], frame_velocity=[1.2, 0.05, 0.4, 1e-3],
        parameters={"M": 1.0, "a": 0.6}, causal=None,
    )  # fmt: skip
    with pytest.raises(ChartEdgeError) as caught:
        solve(problem, 200.0, 1e-6, engine)
    solution = caught.value.solution
    assert solution.charts[:2] == ("kerr", "ingoing")
    assert len(solution.charts) < 8
    assert "r_in = 0.2," in str(caught.value)


def test_parameter_and_coordinate_of_one_name():
    """A coordinate may be called t like the curve parameter: the message names both."""
    hole = load("schwarzschild").frame
    fall = geodesic(hole, [0, 4, 1.5, 0], frame_velocity=[1, 0, 0, 0], parameters={"M": 1})
    said = r"stops at t = \d+\.\d+ \(the curve parameter\), in coordinates at t = \d+"
    with pytest.raises(ChartEdgeError, match=said):
        solve(fall.with_charts("schwarzschild"), 100.0, 1e-6)
