"""Error estimates: between the true error and the request, on motions hard to estimate."""

# The tests pass bad input and arrays for lists, and use results that could be None.
# pyright: reportArgumentType=false, reportCallIssue=false

from __future__ import annotations

import math
import sys
from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from geomtorsion.curves import autoparallel, geodesic
from geomtorsion.errors import AccuracyError, ChartEdgeError, StuckError
from geomtorsion.geometry import Frame, blend, cartan, levi_civita
from geomtorsion.ode import ODE, At, RungeKutta, Stiff, Taylor, When, solve
from geomtorsion.ode.engines.taylor import order_of, tolerance_of
from geomtorsion.prices import truth_of
from geomtorsion.spaces import load
from tests.chosen import one_in
from tests.ode.engines import every_engine, needs_heyoka
from tests.rounding import ROUNDED

X, Y = sp.symbols("x y", real=True)
# Where the true error is smaller than this, an estimate may be any small number.
ROUNDING = 1e-15


def true_error(problem, solution):
    """The error against a closed form or 113 bits, each group of states against its size."""
    times = solution.times
    grid = times if times[0] == 0 else np.concatenate(([0.0], times))
    return truth_of(problem, grid).error(solution)


def assert_honest(problem, solution, accuracy):
    """The true error is below the accuracy, and the estimate is 0.5 to 100 times the true error."""
    true = true_error(problem, solution)
    assert true <= accuracy
    assert solution.error <= accuracy
    if true > ROUNDING:
        assert 0.5 * true <= solution.error <= 100 * true
    return true


def top(spin, metric):
    """A top on the three-sphere."""
    weights = [Fraction(x) for x in metric]
    return geodesic(load("s3").frame, (0.7, 0.2, 0.3), frame_velocity=spin, metric=weights)


# -- what an estimate is ---------------------------------------------------------------------------


@every_engine
def test_error_is_twice_the_difference(engine):
    """The error is twice the largest difference to a finer run, over the size of the group."""
    law = ODE.of({"x": "v", "v": "-2.2*v - x"}, [1.0, 0.0], norm_groups=[("x", "v")])
    sol = solve(law, [6.0, 9.0], 1e-7, engine)
    assert sol.reference is not None
    assert sol.reference.tolerance < sol.trajectory.tolerance
    answer, finer = (x.segments[0].states for x in (sol.trajectory, sol.reference))
    gap = np.abs(answer - finer).max()
    assert gap > 0
    # The size includes the start, where the state is one.
    assert np.abs(sol.states).max() < 0.1
    assert sol.error == pytest.approx(2 * gap, rel=1e-9)


@every_engine
def test_error_of_a_curve_is_twice_the_difference(engine):
    """As above for a curve, from the velocities only."""
    problem = geodesic(load("so3").frame, frame_velocity=[0.9, 0.4, 0.7], metric=[1.1, 2.2, 3.3])
    sol = solve(problem, 60.0, 1e-8, engine)
    assert sol.reference is not None
    assert sol.reference.tolerance < sol.trajectory.tolerance
    states, other = (x.segments[0].states for x in (sol.trajectory, sol.reference))
    gap = np.abs(states - other).max() / np.abs(states).max()
    assert sol.error == pytest.approx(2 * gap, rel=1e-9)


def test_orders_and_tolerances():
    """Each order has one tolerance; heyoka's rule is p = ceil(1 - log(tol) / 2)."""
    for order in range(2, 60):
        assert order_of(tolerance_of(order)) == order
    assert [order_of(x) for x in (1e-6, 1e-9, 1e-12)] == [8, 12, 15]
    for away, order in ((0.9, 12), (1.1, 11), (-0.9, 12), (-1.1, 13)):
        assert Taylor().rung(tolerance_of(12) * math.exp(away)) == tolerance_of(order)


@needs_heyoka
def test_orders_agree_with_heyoka():
    """The rule agrees with the order of heyoka's integrators."""
    import heyoka as hy

    x = hy.make_vars("x")
    for tolerance in (1e-3, 1e-6, 1e-9, 1e-12, 1e-16):
        made = hy.taylor_adaptive([(x, -x)], [1.0], tol=tolerance, opt_level=0)
        assert made.order == order_of(tolerance)


@every_engine
def test_ladders_end(engine):
    """Tolerances fall by factors below 10,000, down to the finest one of the engine."""
    for accuracy in (1e-3, 1e-8, 1e-15):
        tolerance, rungs = engine.first(accuracy), 0
        assert tolerance <= accuracy or tolerance == engine.first(1e-30)
        while (finer := engine.finer(tolerance)) is not None:
            assert 1e-4 * tolerance < finer < tolerance
            tolerance, rungs = finer, rungs + 1
        assert rungs < 20


# -- motions that amplify --------------------------------------------------------------------------


@needs_heyoka
@pytest.mark.parametrize(("away", "accuracy"), one_in(3, [1e-1, 2e-4, 1e-6], [1e-5, 1e-8, 1e-11]))
def test_rounding_on_the_way_is_seen(away, accuracy):
    """Near the axis of the middle moment each flip amplifies the rounding errors so far."""
    problem = top([0.5, away, 0.8 * away], (Fraction(3, 2), 1, 2))
    solution = solve(problem, 150.0, accuracy)
    assert_honest(problem, solution, accuracy)


@needs_heyoka
def test_what_agrees_by_chance_is_confirmed():
    """In doubles, two runs differ by 7e-11 and are both off by 7e-8; the solver notices it."""
    start = [0.7852679674879348, 1.716910964359756, 1.0248503623205936]
    spin = [2.053071316123966e-05, 0.606239833157449, 1.6424570528991727e-05]
    problem = geodesic(load("s3").frame, start, frame_velocity=spin, metric=[1.56, 1.95, 2.61])
    assert_honest(problem, solve(problem, 150.0, 1e-8), 1e-8)


@needs_heyoka
def test_beyond_double_precision():
    """Where only rounding is left in doubles, the solver takes more digits."""
    problem = top([0.5, 1e-5, 1e-5], (Fraction(3, 2), 1, 2))
    solution = solve(problem, 150.0, 1e-13)
    assert solution.engine != "Taylor"
    assert solution.error <= 1e-13
    assert true_error(problem, solution) < 1e-13


@settings(max_examples=40, deadline=None)
@given(
    st.lists(st.floats(-2, 2), min_size=9, max_size=9),
    st.lists(st.floats(-3, 3), min_size=3, max_size=3).filter(lambda x: max(map(abs, x)) > 0.1),
    st.integers(4, 12),
)
def test_linear_equations(entries, start, digits):
    """x' = M x agrees with the matrix exponential, computed at many digits."""
    names = ["x", "y", "z"]
    matrix = np.array(entries).reshape(3, 3).round(2)
    rates = {
        name: " + ".join(f"({m})*{other}" for m, other in zip(row, names, strict=True))
        for name, row in zip(names, matrix.tolist(), strict=True)
    }
    law = ODE.of(rates, dict(zip(names, start, strict=True)), norm_groups=[names])
    solution = solve(law, 3.0, 10.0**-digits)
    exact = mpmath.matrix([[mpmath.mpf(str(x)) for x in row] for row in matrix.tolist()])
    worst = size = 0.0
    for time, row in zip(solution.times[::16], solution.states[::16], strict=True):
        there = mpmath.expm(exact * time) * mpmath.matrix(start)
        worst = max([worst, *(float(abs(a - b)) for a, b in zip(row, there, strict=True))])
        size = max([size, *(float(abs(b)) for b in there)])
    assert worst <= 10.0**-digits * size
    assert solution.error >= 0.5 * worst / size or worst / size < ROUNDING


@every_engine
def test_growing_states_are_measured_by_their_size(engine):
    """For states that grow a millionfold, the tolerance is relative to their final size."""
    solution = solve(ODE.of({"x": "x"}, [1.0]), 14.0, 1e-11, engine)
    error = np.abs(solution["x"] - np.exp(solution.times)).max() / np.exp(14.0)
    assert error <= 1e-11
    assert solution.error >= 0.5 * error


@needs_heyoka
@pytest.mark.parametrize("end", [12.0, 25.0, 38.0])
def test_growing_beside_bounded(end):
    """One group grows, the other does not: each is measured by its own size."""
    law = ODE.of(
        {"x": "x*cos(y)", "y": "z", "z": "-y"}, [1.0, 0.1, 0.0], norm_groups=[("x",), ("y", "z")]
    )
    assert_honest(law, solve(law, end, 1e-8), 1e-8)


GROWING = [
    (
        [[-0.156, -0.662, 0.051], [-0.363, -2.282, -0.158], [1.252, 0.197, 0.484]],
        [-0.3971099294651292, -0.9990910626819414, 0.49343008615190687],
        1e-4,
        31.614600435833268,
    ),
    (
        [[-0.584, -0.64, -0.079], [-0.504, -1.757, 0.555], [-0.527, 1.251, 0.567]],
        [62.675550954521384, 422.5848617235808, -101.99884386824368],
        1e-5,
        20.388273768796285,
    ),
]


@needs_heyoka
@pytest.mark.parametrize(("matrix", "start", "accuracy", "end"), GROWING)
def test_what_grows_out_of_all_proportion(matrix, start, accuracy, end):
    """Errors of the first steps grow with the solution, and the estimate contains them."""
    rates = {
        name: " + ".join(f"({value})*{other}" for value, other in zip(row, "xyz", strict=True))
        for name, row in zip("xyz", matrix, strict=True)
    }
    made = ODE.of(rates, dict(zip("xyz", start, strict=True)))
    assert_honest(made, solve(made, end, accuracy, Taylor()), accuracy)


@needs_heyoka
@pytest.mark.parametrize(("start", "limit", "end"), [(2.4e-5, 77491, 19.8), (1.6e-5, 808669, 24.2)])
def test_small_states_that_grow(start, limit, end):
    """Logistic growth over ten powers of ten: digits lost while the state is small stay lost."""
    law = ODE.of({"x": "x*(1 - x/K)"}, [start], parameters={"K": limit})
    solution = solve(law, end, 1e-12, engine=Taylor())
    exact = limit / (1 + (limit / start - 1) * np.exp(-solution.times))
    error = np.abs(solution["x"] - exact).max() / exact.max()
    assert error < 1e-12
    assert solution.error >= 0.5 * (error - 1e-14)


@needs_heyoka
@pytest.mark.parametrize("start", [38.0, 42.0, 123.1977448486044])
def test_a_long_step_is_not_taken_for_rounding(start):
    """x'' = x - x^3 far out: the error of a too long step is not taken for rounding."""
    law = ODE.of({"x": "v", "v": "x - x**3"}, [start, 0.0])
    solution = solve(law, 150 / start**2, 1e-11, engine=Taylor())
    energy = solution["v"] ** 2 / 2 - solution["x"] ** 2 / 2 + solution["x"] ** 4 / 4
    assert solution.error <= 1e-11
    assert np.abs(energy / energy[0] - 1).max() < 1e-10


@needs_heyoka
@pytest.mark.parametrize("near", [1e-3, 3e-4, 1e-4])
def test_more_digits_near_a_separatrix(near):
    """A pendulum that lingers upside down: the estimate is honest with 64 bits as well."""
    for end, accuracy in ((30.0, 1e-11), (45.0, 1e-11), (38.0, 1e-13)):
        made = ODE.of({"x": "y", "y": "sin(x)"}, {"x": near, "y": 0.0})
        sol = solve(made, end, accuracy)
        true = true_error(made, sol)
        assert true <= accuracy
        assert sol.error >= 0.5 * true


@every_engine
def test_an_unstable_motion_is_refused(engine):
    """Near a saddle rounding grows beyond any accuracy: an error instead of a wrong answer."""
    saddle = ODE.of({"x": "v", "v": "x"}, {"x": 1.0, "v": -1.0})
    with pytest.raises(AccuracyError):
        solve(saddle, 40.0, 1e-8, engine)


@needs_heyoka
@pytest.mark.parametrize(
    ("start", "accuracy"),
    [
        ([1.9407494008594477, -0.09104621441818508, -0.9165974717600273], 1e-8),
        ([1.9407494008594477, -0.09104621441818508, -0.9165974717600273], 1e-10),
        ([0.270613704172437, -0.4439808545171319, 1.2105047438502337], 1e-9),
        ([0.6373623593766596, -1.3068504934903284, 1.057242123986707], 1e-10),
    ],
)
def test_states_of_uneven_size(start, accuracy):
    """Coordinates grow like exp(t), velocities stay near one: the estimate is honest."""
    frame = load("bianchi_v").frame
    law = blend(levi_civita(frame), cartan(frame))
    problem = autoparallel(law, [0.1, 0.2, 0.3], frame_velocity=start)
    assert_honest(problem, solve(problem, 20.0, accuracy, Taylor()), accuracy)


@needs_heyoka
@pytest.mark.parametrize("end", [60.0, 75.0, 91.0])
def test_roundings_of_grown_states(end):
    """Autoparallels of Sol: z grows a hundredfold, and e^z amplifies all its rounding errors."""
    problem = autoparallel(
        cartan(load("sol").frame), [0.3, -0.4, 0.6], frame_velocity=[0.7, 0.2, -1.3]
    )
    sol = solve(problem, end, 1e-12)
    true = true_error(problem, sol)
    assert true <= 1e-12
    assert sol.error >= 0.5 * true


@needs_heyoka
@pytest.mark.parametrize(
    "end", [0.0021, *(pytest.param(x, marks=pytest.mark.slow) for x in (0.00215, 0.0022)), 0.0023]
)
def test_roundings_beside_a_pole(end):
    """A millionth from the pole of s2, the rounding of theta enters phi fully."""
    sphere = load("s2").frame
    between = blend(levi_civita(sphere), cartan(sphere))
    numbers = {symbol.name: 1.2 for symbol in sphere.field.symbols[2:]} | {"R": 1.3}
    problem = autoparallel(
        between,
        [1.0, 0.5],
        frame_velocity=[-4542.008374395556, 0.004829829911202137],
        parameters=numbers,
    )
    sol = solve(problem, end, 1e-9)
    true = true_error(problem, sol)
    assert true <= 1e-9
    assert sol.error >= 0.5 * true or true < ROUNDING


# -- rounded numbers, events, clocks ---------------------------------------------------------------


@needs_heyoka
def test_rounded_parameters_are_seen():
    """1/3 is rounded in binary: after a million radians all steps share one error."""
    law = ODE.of({"x": "w*v", "v": "-w*x"}, [1, 0], parameters={"w": Fraction(1, 3)})
    solution = solve(law, [1e6, 1e6 + 4.0], 1e-9)
    error = np.abs(solution["x"] - np.cos(solution.times.astype(np.longdouble) / 3)).max()
    assert error < 1e-9
    assert solution.error >= 0.5 * error


@needs_heyoka
def test_errors_before_an_event_grow_after_it():
    """Errors from before an event grow after it, and the estimate contains them."""
    law = ODE.of({"x": "a*x"}, [1.0], parameters={"a": 1.0}, events=[At(5.0, {"a": -1.0})])
    unstable = ODE.of(
        {"x": "a*(y - x)", "y": "x*(r - z) - y", "z": "x*y - 8*z/3"}, [1.0, 2.0, 20.0],
        parameters={"a": 10.0, "r": 28.0}, events=[At(t, {"r": 28.0}) for t in (1, 4, 7, 9.9)],
    )  # fmt: skip
    for one in (law, unstable):
        assert_honest(one, solve(one, 10.0, 1e-8), 1e-8)


@every_engine
@pytest.mark.parametrize("accuracy", [1e-7, 1e-12])
def test_events_jumps_clock_and_unit(accuracy, engine):
    """Rates with a clock, unit states, changes and jumps agree with closed forms."""
    rates = {"x": "a*cos(t)", "p": "w*q", "q": "-w*p"}
    law = ODE.of(
        rates, {"x": 0, "p": 0.6, "q": 0.8}, parameters={"a": 1, "w": 2}, normalized=[("p", "q")],
        events=[At(10.0, {"a": 0.5}), At(25.0, {"x": 3, "w": 1})],
    )  # fmt: skip
    solution = solve(law, [5.0, 10.0, 20.0, 25.0, 40.0], accuracy, engine)
    half = np.sin(10) + 0.5 * (np.sin(20) - np.sin(10))
    exact = [np.sin(5), np.sin(10), half, 3.0, 3.0 + 0.5 * (np.sin(40) - np.sin(25))]
    assert np.abs(solution["x"] - exact).max() < 3 * accuracy
    angle = np.arctan2(0.6, 0.8) + np.where(solution.times < 25, 2 * solution.times, 0)
    angle += np.where(solution.times >= 25, 25 + solution.times, 0)
    assert np.abs(solution["p"] - np.sin(angle)).max() < accuracy
    assert np.abs(solution["q"] - np.cos(angle)).max() < accuracy


@every_engine
def test_jumps_of_states_of_length_one(engine):
    """After a jump, unit states are scaled back to length one."""
    law = ODE.of(
        {"p": "q", "q": "-p"}, {"p": 0, "q": 1}, normalized=[("p", "q")],
        events=[At(8.0, {"p": 3})], norm_groups=[("p", "q")],
    )  # fmt: skip
    times = np.linspace(8.5, 20.0, 24)
    solution = solve(law, times, 1e-9, engine)
    angle = np.arctan2(3.0, np.cos(8.0)) + times - 8.0
    assert np.abs(solution["p"] - np.sin(angle)).max() < 1e-9
    assert np.abs(solution["q"] - np.cos(angle)).max() < 1e-9
    (_, second) = solution.trajectory.segments
    assert np.hypot(*second.stage.start[:2]) == pytest.approx(1, abs=ROUNDED)


@every_engine
def test_backwards(engine):
    """Negative times give the same accuracy."""
    solution = solve(ODE.of({"x": "v", "v": "-x"}, [1.0, 0.0]), -7.0, 1e-10, engine)
    assert np.abs(solution["x"] - np.cos(solution.times)).max() < 1e-10


# -- ends ------------------------------------------------------------------------------------------


@every_engine
def test_edges_end_with_place_and_reason(engine):
    """A motion that leaves its only chart reports time, position and reason."""
    problem = geodesic(load("flat_polar").frame, [1.0, 0.0], frame_velocity=[-1.0, 0.0])
    with pytest.raises(ChartEdgeError, match=r"stops at t = 1, at r = .*\(r = 0\)"):
        solve(problem.with_charts("flat_polar"), 3.0, 1e-8, engine)


@every_engine
def test_series_without_value(engine):
    """x' = x^2 is stuck at t = 1."""
    with pytest.raises(StuckError, match=r"cannot continue at t = (1|0\.99)"):
        solve(ODE.of({"x": "x**2"}, [1.0]), 2.0, 1e-8, engine)


@needs_heyoka
def test_edges_do_not_measure_steps():
    """Far from the hole the guard is larger than any state; step sizes follow the states."""
    problem = autoparallel(
        cartan(load("kerr").frame), [0, 9, 1.1, 0.4], frame_velocity=[0.44, 2.5, 1.33, 0.4],
        parameters={"M": 1, "a": 0.6},
    )  # fmt: skip
    solution = solve(problem, np.linspace(0.0, 11.4, 33), 1e-9)
    assert_honest(problem, solution, 1e-9)


# -- inputs of the caller
# ---------------------------------------------------------------------------


@every_engine
def test_later_changes_of_times_change_nothing(engine):
    """The array of times may be changed after the call without changing the solution."""
    times = np.linspace(0.0, 9.0, 10)
    motion = geodesic(load("s3").frame, (0.7, 0.2, 0.3), frame_velocity=[1.0, 0.0, 0.0])
    for problem in (ODE.of({"x": "v", "v": "-x"}, [1.0, 0.0]), motion):
        solution = solve(problem, times, 1e-8, engine)
        there = solution.at(4.5)
        assert not np.shares_memory(solution.times, times)
        times *= 2
        assert solution.times[-1] == times[-1] / 2
        again = solve(problem, solution.times, 1e-8, engine)
        times /= 2
        for name in ("states",) if problem is not motion else ("coordinates", "velocity"):
            assert np.array_equal(getattr(again, name), getattr(solution, name))
            assert np.array_equal(getattr(again.at(4.5), name), getattr(there, name))


def test_other_motions_do_not_matter():
    """Far or hard motions solved in between change no bit of a later solve."""
    near = ODE.of({"x": "v", "v": "-sin(x)"}, [1.0, 0.0])
    first = solve(near, 10.0, 1e-10)
    for start in (1e9, 3.1, 3.14, 3.1415):
        solve(near.with_start(start=[start, 0.0]), 10.0, 1e-7)
    again = solve(near, 10.0, 1e-10)
    assert (again.states == first.states).all()
    assert again.error == first.error
    assert again.cost.steps == first.cost.steps


@needs_heyoka
@pytest.mark.parametrize("stop", [None, "9 - x"], ids=["no guard", "a guard"])
def test_threads_share_an_integrator(stop):
    """Two threads that solve equal equations get the same bits as one thread."""
    events = [] if stop is None else [When(stop)]
    law = ODE.of({"x": "v", "v": "-sin(x)"}, [1.0, 0.0], events=events)
    starts = np.linspace(0.1, 3.0, 240)

    def last(start):
        return solve(law.with_start(start=[start, 0.0]), 30.0, 1e-9).states[-1]

    alone, before = [last(start) for start in starts], sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    try:
        with ThreadPoolExecutor(2) as pool:
            found = list(pool.map(last, starts))
    finally:
        sys.setswitchinterval(before)
    assert (np.array(found) == alone).all()


# -- orbits ----------------------------------------------------------------------------------------


@needs_heyoka
@pytest.mark.parametrize("accuracy", [1e-6, 1e-9, 1e-12])
def test_errors_of_an_orbit(accuracy):
    """A bound orbit near a rotating hole: the error is below the accuracy, the estimate near it."""
    orbit = geodesic(
        levi_civita(load("kerr").frame), [0, 8.0, 1.4, 0],
        frame_velocity=[1.2, 0.05, 0.2, 0.6], parameters={"M": 1, "a": 0.6},
    )  # fmt: skip
    assert_honest(orbit, solve(orbit, 300.0, accuracy, RungeKutta()), accuracy)


@every_engine
@pytest.mark.parametrize("accuracy", [1e-6, 1e-9, 1e-10])
def test_an_ellipse_closes(accuracy, engine):
    """An orbit of eccentricity 0.6 closes after ten turns, within the accuracy."""
    x = 0.4
    kepler = ODE.of(
        {"x": "u", "y": "v", "u": "-x/(x**2+y**2)**(3/2)", "v": "-y/(x**2+y**2)**(3/2)"},
        {"x": x, "y": 0.0, "u": 0.0, "v": 2.0},
    )
    sol = solve(kepler, np.linspace(0.0, 20 * np.pi, 66), accuracy, engine)
    row = np.asarray(sol.states)[-1]
    true = max(np.abs(row[:2] - [x, 0.0]).max() / 0.4, np.abs(row[2:] - [0.0, 2.0]).max() / 2.0)
    assert true <= accuracy
    assert 0.5 * true <= sol.error <= 100 * true


def test_series_have_an_order_of_at_least_six():
    """Accuracies down to 4e-4 start with the same tolerance; finer ones do not."""
    assert Taylor().first(1e-1) == Taylor().first(1e-3) == Taylor().first(4e-4)
    assert Taylor().first(1e-6) < Taylor().first(5e-5) < Taylor().first(4e-4)


@pytest.mark.parametrize("engine", [RungeKutta(), Stiff()])
def test_finer_runs_are_two_orders_finer(engine):
    """Each finer run has a hundredth of the tolerance, down to the finest of the engine."""
    assert engine.finer(1e-6) == pytest.approx(1e-8)
    assert engine.finer(2 * engine.finest) == engine.finest
    assert engine.finer(engine.finest) is None


def test_the_error_is_twice_the_difference():
    """Where rounding does not count, the reported error of exp(t) is twice the true error."""
    grow = ODE.of({"x": "x"}, [1.0])
    found = solve(grow, np.linspace(0, 3, 40), 1e-6, RungeKutta())
    exact = np.exp(found.times)
    away = np.abs(found["x"] - exact).max() / exact.max()
    assert found.error / away == pytest.approx(2, rel=0.1)


@needs_heyoka
@pytest.mark.parametrize("accuracy", [1e-6, 1e-9])
@pytest.mark.parametrize(
    ("entry", "start", "speeds"),
    [
        (2 - 2 * sp.cos(Y), 1e-6, (1e-12, 1e-7)),
        (sp.log(1 + Y**2), 1e-6, (1e-12, 1e-7)),
        (sp.exp(Y) - 1, 1e-10, (1e-10, 1e-11)),
    ],
    ids=["cosine", "logarithm", "exponential"],
)
def test_roundings_of_the_rates_are_seen(entry, start, speeds, accuracy):
    """Rates lose digits in a difference: the finer run rounds them differently and shows it."""
    frame = Frame([X, Y], [[entry, 0], [0, 1]])
    motion = autoparallel(cartan(frame), [0, start], frame_velocity=speeds)
    slope = sp.lambdify(Y, 1 / entry, "mpmath")
    with mpmath.workdps(40):
        u, v = (mpmath.mpf(x) for x in speeds)
        exact = mpmath.quad(lambda t: u * slope(mpmath.mpf(start) + v * t), [0, 0.5, 1])
    for engine in (None, Taylor()):
        try:
            solution = solve(motion, 1.0, accuracy, engine)
        except AccuracyError:
            assert engine is not None
            continue
        last = float(solution.coordinates[-1, 0])
        gap = float(abs(mpmath.mpf(last) - exact) / abs(exact))
        assert gap < accuracy
        assert solution.error > 0.5 * gap


@needs_heyoka
@pytest.mark.parametrize("end", [0.1, 0.2, 0.3])
def test_a_motion_of_few_steps(end):
    """x = tan t in one or two steps: the finer run shows the omitted terms."""
    solution = solve(ODE.of({"x": "1 + x**2"}, [0]), end, 1e-3, Taylor())
    gap = np.abs(solution["x"] - np.tan(solution.times)).max() / np.tan(end)
    assert gap > 1e-13
    assert 0.5 * gap < solution.error < 100 * gap


@every_engine
@pytest.mark.parametrize(
    ("problem", "end", "true"),
    [
        (ODE.of({"x": "v", "v": "-4*x"}, [1, 0]), 10.0, lambda t: np.cos(2 * t)),
        (ODE.of({"x": "x"}, [1]), 30.0, np.exp),
        (ODE.of({"x": "w", "y": "x"}, [0, 1], parameters={"w": 3}), 100.0, lambda t: 3 * t),
        (
            ODE.of({"x": "v", "v": "-4*x"}, [1, 0], events=[When("x + 1/2")]),
            2.0,
            lambda t: np.cos(2 * t),
        ),
    ],
    ids=["swings", "grows", "evenly", "stopped"],
)
def test_solutions_are_true(problem, end, true, engine):
    """The true error is below the accuracy and below twice the reported error."""
    for accuracy in (1e-6, 1e-10):
        solution = solve(problem, end, accuracy, engine)
        size = np.abs(true(solution.times)).max()
        gap = np.abs(solution["x"] - true(solution.times)).max() / size
        assert gap <= accuracy
        assert gap <= 2 * solution.error
