"""Solutions of first-order equations: accuracy, outputs, drift, event times, files, tables."""

# The tests pass bad input and arrays for lists, and use results that could be None.
# pyright: reportArgumentType=false, reportAttributeAccessIssue=false, reportOperatorIssue=false, reportOptionalMemberAccess=false

import json
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy as sp

from geomtorsion.errors import (
    CoordinateError,
    ExpressionError,
    FileFormatError,
    StuckError,
    TimeError,
    UnknownNameError,
)
from geomtorsion.ode import (
    ODE,
    At,
    RungeKutta,
    SavedSolution,
    Stiff,
    Taylor,
    When,
    solve,
    solve_many,
)
from geomtorsion.ode.engines.taylor import is_available
from geomtorsion.ode.numbers import perturbed
from geomtorsion.support.precision import GOLDEN
from tests.ode.engines import every_engine, needs_heyoka
from tests.rounding import ROUNDED

QUATERNION = {
    "q0": "-(q1*w1 + q2*w2 + q3*w3)/2",
    "q1": "(q0*w1 + q2*w3 - q3*w2)/2",
    "q2": "(q0*w2 + q3*w1 - q1*w3)/2",
    "q3": "(q0*w3 + q1*w2 - q2*w1)/2",
}


def swing(**more):
    """x'' = -k x with k = 4: x = cos 2t."""
    options: dict[str, Any] = {
        "parameters": {"k": 4},
        "invariants": {"energy": "v**2/2 + k*x**2/2"},
        "outputs": {"place": ["x", "v/2"], "angle": "atan2(v/2, x)", "far": "Abs(x) + t"},
    }
    return ODE.of({"x": "v", "v": "-k*x"}, {"x": 1, "v": 0}, **(options | more))


@every_engine
@pytest.mark.parametrize("accuracy", [1e-5, 1e-8, 1e-11])
def test_error_and_its_estimate(engine, accuracy):
    """The true error is below the accuracy; the estimate is between a tenth and 100 times it."""
    sol = solve(swing(), 10.0, accuracy, engine)
    exact = np.array([np.cos(2 * sol.times), -2 * np.sin(2 * sol.times)]).T
    # Each state is a group of its own.
    true = float((np.abs(sol.states - exact).max(axis=0) / np.abs(exact).max(axis=0)).max())
    assert len(sol.times) == 65
    assert true <= accuracy
    assert sol.error <= accuracy
    assert sol.error >= 0.1 * true or true < ROUNDED
    assert sol.error <= 100 * true or true < ROUNDED


@every_engine
def test_time_in_the_rates(engine):
    """x' = cos(t) x, with a hidden clock, forwards and backwards."""
    driven = ODE.of({"x": "cos(t)*x"}, [1])
    assert driven.states == ("x",)
    for end in (5.0, -5.0):
        sol = solve(driven, end, 1e-11, engine)
        assert sol.states.shape == (65, 1)
        assert sol["x"] == pytest.approx(np.exp(np.sin(sol.times)), rel=1e-10)
        assert sol.at(end / 3)["x"] == pytest.approx(np.exp(np.sin(end / 3)), rel=1e-9)
    renamed = ODE.of({"t": "s"}, [0], time="s")
    assert solve(renamed, 2.0, engine=engine)["t"][-1] == pytest.approx(2.0, abs=1e-12)


@every_engine
def test_outputs_and_moments(engine):
    """Outputs at the times and in between: a number, a vector, with the time, with kinks."""
    sol = solve(swing(), [0.5, 1.0, 4.0], 1e-11, engine)
    assert sol.times.tolist() == [0.5, 1.0, 4.0]
    assert sol["place"].shape == (3, 2)
    assert sol["angle"] == pytest.approx(np.arctan2(-np.sin(2 * sol.times), np.cos(2 * sol.times)))
    assert sol["far"] == pytest.approx(np.abs(np.cos(2 * sol.times)) + sol.times)
    moment = sol.at(np.array([[0.1, 3.9], [1.0, 2.0]]))
    assert set(moment) == {"x", "v", "place", "angle", "far"}
    assert len(moment) == 5
    assert moment["place"].shape == (2, 2, 2)
    assert moment["place"][0, 1] == pytest.approx([np.cos(7.8), -np.sin(7.8)], abs=1e-9)
    assert float(sol.at(1.0)["x"]) == pytest.approx(np.cos(2), abs=1e-9)
    with pytest.raises(UnknownNameError, match="Did you mean place"):
        sol["plce"]
    with pytest.raises(UnknownNameError, match="expected a quantity of this motion, got 'y'"):
        moment["y"]
    with pytest.raises(TimeError, match="from 0 to 4, the range of the solution"):
        sol.at(4.5)


@every_engine
@pytest.mark.parametrize("accuracy", [1e-5, 1e-9])
def test_error_of_outputs(engine, accuracy):
    """x = exp(2 t), and an output that varies a thousand times as fast, with an error to match."""
    problem = ODE.of({"x": "2*x"}, [1], outputs={"fine": "sin(1000*x)"})
    solution = solve(problem, 1.0, accuracy, engine)
    truth = np.exp(2 * solution.times)
    for name, exact, size in (("x", truth, truth.max()), ("fine", np.sin(1000 * truth), 1.0)):
        gap = np.abs(solution[name] - exact).max() / size
        assert 0.5 * gap < solution.error_of(name) < 100 * max(gap, 1e-15)
    assert solution.error_of("x") == pytest.approx(solution.error, rel=1e-6)
    assert solution.error_of("fine") > 500 * solution.error


def test_error_of_outputs_without_a_value():
    """The error of an output without a real value is infinite."""
    falling = ODE.of({"x": -1}, [1], outputs={"root": "sqrt(x)", "none": "0*x"})
    solution = solve(falling, 2.0, 1e-8, RungeKutta())
    assert np.isnan(solution["root"][-1])
    assert solution.error_of("root") == np.inf
    assert solution.error_of("none") < 1e-14


def test_plain_data_is_strict():
    """Columns, error and drift as JSON: x = e^-t; None where an output has no value."""
    rates = ODE.of({"x": "-x", "y": "x"}, [1, 0], outputs={"q": "x/y"}, invariants={"sum": "x + y"})
    solution = solve(rates, [0.0, 1.0, 2.0])
    data = json.loads(json.dumps(solution.to_json(), allow_nan=False))
    columns = data["solution"]
    assert list(columns) == ["t", "x", "y", "q"]
    assert columns["t"] == [0, 1, 2]
    assert columns["x"] == pytest.approx(np.exp([0, -1, -2]), rel=10 * solution.error)
    assert columns["q"][0] is None
    assert data["drift"] == {"sum": solution.drift["sum"]}
    assert data["error"] == solution.error


def test_error_of_unknown_outputs():
    solution = solve(swing(), 1.0, 1e-8, RungeKutta())
    with pytest.raises(UnknownNameError, match="Did you mean place"):
        solution.error_of("plaec")


def test_moments_are_mappings(tmp_path):
    """A missing name is not in the mapping; the error message has no quotes around it."""
    solution = solve(swing(), 1.0, 1e-8, RungeKutta())
    solution.save(tmp_path / "swing.npz")
    for values in (solution.at(0.5), SavedSolution.load(tmp_path / "swing.npz")):
        assert "x" in values
        assert "y" not in values
        assert values.get("y") is None
        with pytest.raises(UnknownNameError, match="^expected a quantity of this motion, got 'y'"):
            values["y"]


@every_engine
def test_drift(engine):
    """Invariants are kept to the accuracy; a quantity that is not invariant shows its change."""
    sol = solve(swing(invariants={"energy": "v**2 + k*x**2", "no": ["x", "v"]}), 9.0, 1e-10, engine)
    assert sol.drift["energy"] < 1e-9
    assert 0.5 < sol.drift["no"] <= 2
    # The change is relative to the terms: a difference that vanishes causes no false alarm.
    tiny = solve(swing(invariants={"zero": "v**2 + 4*x**2 - 4"}), 9.0, 1e-10, engine)
    assert tiny.drift["zero"] < 1e-9


@pytest.mark.parametrize(
    ("times", "ends"), [([1.0, 2.0], 2.0), ([0.0, 1.0], 1.0), ([1.0, 5.0], 3.0)]
)
def test_changes_of_invariants_go_with_the_times(times, ends):
    """There is one change for each time, with or without the start, and one for the stop."""
    falling = ODE.of({"x": -1}, [3], invariants={"x": "x"}, events=[When("x")])
    solution = solve(falling, times, 1e-8, RungeKutta())
    assert solution.times[-1] == pytest.approx(ends)
    changes = solution.invariant_changes["x"]
    assert changes / changes[-1] * ends == pytest.approx(solution.times)


@every_engine
def test_unit_states(engine):
    """A quaternion has length one to rounding, at the samples and between them."""
    turn = ODE.of(
        QUATERNION,
        [1, 1e-9, 0, 0],
        parameters={"w1": 0.3, "w2": -1.1, "w3": 2.2},
        normalized=[("q0", "q1", "q2", "q3")],
    )
    sol = solve(turn, 200.0, 1e-8, engine)
    assert np.abs((sol.states**2).sum(axis=1) - 1).max() < ROUNDED
    between = sol.at(np.linspace(0, 200, 333)).states
    assert np.abs((between**2).sum(axis=1) - 1).max() < ROUNDED
    rate = np.sqrt(0.3**2 + 1.1**2 + 2.2**2)
    assert sol["q3"] == pytest.approx(2.2 / rate * np.sin(rate * sol.times / 2), abs=2e-8)


@every_engine
def test_event_times(engine):
    """Crossings of a state, an output, an expression; upwards only; pairs close together."""
    sol = solve(swing(outputs={"gap": "x - 1 + 1e-9"}), 9.0, 1e-11, engine)
    expected = (np.arange(6) + 0.5) * np.pi / 2
    assert sol.event_times("x") == pytest.approx(expected[expected < 9], abs=2e-9)
    assert sol.event_times("v", 1) == pytest.approx(
        [np.pi / 2, 3 * np.pi / 2, 5 * np.pi / 2], abs=2e-9
    )
    assert sol.event_times("x - cos(2*t) + t - 1/3") == pytest.approx([1 / 3], abs=2e-9)
    assert len(sol.event_times("x - 2")) == 0
    # cos 2t > 1 - 1e-9 for |t| < 2.2e-5 around each half turn.
    width = np.sqrt(2e-9) / 2
    pairs = [width, *(k * np.pi + s * width for k in (1, 2) for s in (-1, 1))]
    if isinstance(engine, Taylor):
        assert sol.event_times("gap") == pytest.approx(pairs, abs=1e-6)
    with pytest.raises(ExpressionError, match="nope"):
        sol.event_times("nope")
    with pytest.raises(ExpressionError, match="no finite value at t = 0"):
        sol.event_times("1/t")
    with pytest.raises(UnknownNameError, match="2 components"):
        solve(swing(), 1.0, engine=engine).event_times("place")


def test_event_times_backwards_and_across_events():
    """Times come in the order of the motion; a jump through zero is not a crossing."""
    back = solve(swing(), -4.0, 1e-11, RungeKutta())
    assert back.event_times("x") == pytest.approx(
        [-np.pi / 4, -3 * np.pi / 4, -5 * np.pi / 4], abs=1e-8
    )
    jump = ODE.of({"x": 1}, [-1], events=[At(0.5, {"x": 3}), At(2, {"x": -1})])
    assert solve(jump, 4.0, 1e-10, RungeKutta()).event_times("x") == pytest.approx([3.0], abs=1e-9)


@every_engine
def test_save_and_load(engine, tmp_path):
    """A loaded solution has the same numbers, also between the samples."""
    made = swing(events=[At(1.5, {"k": 0.1}), At(2, {"v": -1})], name="swing")
    made = made.with_start(start={"x": 0.1 + 0.2, "v": Fraction(1, 3)})
    sol = solve(made, 3.0, 1e-9, engine)
    sol.save(tmp_path / "swing.npz")
    again = SavedSolution.load(tmp_path / "swing.npz")
    assert (again.solution.states == sol.states).all()
    assert (again["place"] == sol["place"]).all()
    assert again.solution.drift == sol.drift
    assert again.problem.start == made.start
    assert again.problem.events == made.events
    assert again.solution.error == sol.error
    assert again.solution.reason == sol.reason
    assert again.solution.cost.steps == sol.cost.steps
    assert (again.at([0.2, 1.7, 2.9]).states == sol.at([0.2, 1.7, 2.9]).states).all()
    assert (again.solution.event_times("x") == sol.event_times("x")).all()
    assert solve(again.problem, 3.0, 1e-9, engine).states == pytest.approx(sol.states, abs=1e-9)


@needs_heyoka
def test_the_error_of_a_file_covers_its_doubles(tmp_path):
    """Thirty digits are saved as doubles, and the file reports the error of the doubles."""
    solution = solve(ODE.of({"x": "-x"}, [1]), 1.0, 1e-25)
    assert solution.error < 1e-25
    solution.save(tmp_path / "decay.npz")
    saved = SavedSolution.load(tmp_path / "decay.npz")
    assert saved.error == 2.0**-53
    assert saved.solution.error == solution.error


def test_table():
    """A pandas table numbers the components of vectors."""
    pandas = pytest.importorskip("pandas")
    table = solve(swing(), 1.0, engine=RungeKutta()).to_pandas()
    assert isinstance(table, pandas.DataFrame)
    assert list(table) == ["t", "x", "v", "place[0]", "place[1]", "angle", "far"]
    assert len(table) == 65


@every_engine
def test_a_motion_that_ends_names_its_time(engine):
    """x' = x^2 ends at t = 1: the error names the time and carries the partial solution."""
    with pytest.raises(StuckError, match=r"cannot continue at t = (1|0\.99)") as caught:
        solve(ODE.of({"x": "x**2"}, [1]), 2.0, 1e-8, engine)
    partial = caught.value.solution
    assert not partial.complete
    assert partial.outcome == "stuck"
    inside = partial.times < 0.95
    assert partial["x"][inside] == pytest.approx(1 / (1 - partial.times[inside]), rel=1e-6)


@every_engine
@pytest.mark.parametrize(("rate", "start", "words"), [("log(x)", -1, "nan"), ("1/x", 0, "inf")])
def test_where_it_cannot_begin(engine, rate, start, words):
    """A rate without a value at the start is named in the error, and the drift is zero."""
    begun = ODE.of({"x": rate, "y": "x"}, [start, 1], invariants={"far": "x**2"})
    with pytest.raises(StuckError, match=f"cannot continue at t = 0.*; x' = {words}") as caught:
        solve(begun, 2.0, 1e-8, engine)
    assert len(caught.value.solution.times) <= 1
    assert caught.value.solution.drift.get("far", 0) == 0


def test_stiff_equations_by_an_implicit_engine():
    """Damping a million times faster than the motion takes few steps."""
    k = 1e6
    slow = ODE.of({"x": "-k*(x - cos(t))"}, [0], parameters={"k": k})
    sol = solve(slow, 1.0, 1e-9, Stiff("LSODA"))
    g = sol.times
    exact = (k * k * np.cos(g) + k * np.sin(g)) / (k * k + 1) - np.exp(-k * g) * k * k / (k * k + 1)
    assert np.abs(sol["x"] - exact).max() < 1e-9
    assert sol.cost.evaluations < 5000


def test_a_zero_at_the_start_adds_no_event():
    """A rounding error below zero at the start is not a crossing, as for sin(pi)."""
    sol = solve(ODE.of({"x": "v", "v": "-x"}, [np.pi, 0]), 2.0, 1e-10)
    (crossed,) = sol.event_times("sin(x) - 2e-16")
    assert crossed == pytest.approx(np.pi / 2, abs=1e-9)


@needs_heyoka
def test_more_digits_than_doubles_have():
    """An accuracy beyond doubles is reached, checked with mpmath."""
    sol = solve(swing(), [1.0, 3.0], 1e-25)
    assert sol.error <= 1e-25
    with mpmath.workdps(34):
        found = mpmath.mpf(str(sol.states[-1, 0]))
        assert abs(found - mpmath.cos(6)) < mpmath.mpf(10) ** -25


def test_choice_of_engine():
    """The default is Taylor where it is installed, else Runge-Kutta; a given engine is used."""
    assert solve(swing(), 1.0).engine == ("Taylor" if is_available() else "RungeKutta")
    assert solve(swing(), 1.0, 1e-7, Stiff()).reason == "as requested"


def test_zero_time():
    """At t = 0 nothing is integrated."""
    sol = solve(swing(), 0.0)
    assert sol.states.tolist() == [[1.0, 0.0]]
    assert sol.at(0.0)["x"] == 1.0


@needs_heyoka
def test_states_that_are_rounding_only():
    """A state of only rounding noise does not stop a solve; a small state keeps its digits."""
    cancels = "sqrt(1 + x**2)*(sin(x)*cos(y) + cos(x)*sin(y) - sin(x + y))"
    idle = ODE.of({"zero": cancels, "x": "-x", "y": "1/7"}, [0, 1, 1])
    sol = solve(idle, 5.0, 1e-9)
    assert np.abs(sol["zero"]).max() < ROUNDED
    assert sol["x"][-1] == pytest.approx(np.exp(-5.0), rel=1e-6)
    small = solve(ODE.of({"a": "1e-12*cos(t)", "b": "1"}, [0, 1]), 5.0, 1e-9)
    assert small["a"] == pytest.approx(1e-12 * np.sin(small.times), abs=2e-21)


@needs_heyoka
def test_time_far_beyond_the_states():
    """At times of ten thousand, states of size one keep an error below 1e-9 in doubles."""
    driven = ODE.of({"x": "v", "v": "-x + cos(t/3)"}, [1, 0])
    sol = solve(driven, 1e4, 1e-9, Taylor())
    exact = 9 / 8 * np.cos(sol.times / 3) - np.cos(sol.times) / 8
    assert np.abs(sol["x"] - exact).max() < 1e-9


def test_references_start_a_rounding_away():
    """Answers start exactly at the start, references two units in the last place away."""
    made = ODE.of({"x": "v/3", "v": "-2*x", "z": "1"}, [1.0, 0.7, 0], parameters={})
    sol = solve(made, 3.0, 1e-6, RungeKutta())
    assert sol.reference is not None
    first, second = (x.segments[0].stage for x in (sol.trajectory, sol.reference))
    assert first.start.tolist() == [1.0, 0.7, 0.0]
    ratios = second.start[:2] / first.start[:2] - 1
    assert np.abs(ratios) == pytest.approx(2 * 2.0**-52, rel=0.6)
    assert second.start[2] == 0
    # 1/3 is rounded and perturbed; -2 is exact and compiled in.
    assert first.parameters.tolist() == [1 / 3]
    assert second.parameters != first.parameters


def test_perturbed_numbers():
    """Only numbers that an engine rounds are perturbed, at any precision."""
    held, rounded = [0.5, 3, Fraction(1, 4)], [Fraction(1, 3), sp.sqrt(2)]
    for precision in (53, 113):
        part = 2.0 ** (1 - precision)
        assert perturbed(held, part, precision, all_of_them=False) == held
        found = perturbed(rounded, part, precision, all_of_them=False)
        with mpmath.workprec(300):
            known = (mpmath.mpf(1) / 3, mpmath.sqrt(2))
            for value, exact, sign in zip(found, known, (1, -GOLDEN), strict=True):
                change = mpmath.mpf(value) / exact - 1
                # In doubles the change itself is rounded.
                assert change / (sign * part) == pytest.approx(
                    1, abs=1 if precision == 53 else 1e-6
                )
            one, zero = perturbed([1, 0], part, precision, all_of_them=True)
            assert mpmath.mpf(one) - 1 == part
            assert zero == 0


def test_length_is_kept_at_every_cut(tmp_path):
    """Every part begins at length one, however coarse the steps."""
    turn = ODE.of(QUATERNION, [1, 0, 0, 0], parameters={"w1": 1, "w2": 2, "w3": 3},
                normalized=[("q0", "q1", "q2", "q3")])  # fmt: skip
    sol = solve(turn, 60.0, 1e-4, RungeKutta(), checkpoint=tmp_path / "turn.npz")
    segments = sol.trajectory.segments
    lengths = [np.linalg.norm([float(x) for x in one.stage.start]) for one in segments]
    assert len(lengths) == 64
    assert np.abs(np.array(lengths) - 1).max() < ROUNDED
    plain = np.linalg.norm(segments[-1].run.last)
    assert abs(plain - 1) > 1e-14


@pytest.mark.parametrize("time", ["1", True, 1j, None, [], [[]], [1, [2, 3]], np.ma.masked])
def test_times_between_are_numbers(time):
    """Text, truth values, empty lists and masked times are refused."""
    solution = solve(ODE.of({"x": "-x"}, [1]), [0, 2], 1e-6)
    with pytest.raises(TimeError, match=r"expected"):
        solution.at(time)
    hidden = np.ma.array([0.5, 1], mask=[False, True])
    with pytest.raises(TimeError, match="expected t from 0 to 2, .* got nan"):
        solution.at(hidden)
    assert solution.at([[1, 0], [0, 1]])["x"].shape == (2, 2)


@pytest.mark.parametrize("name", [0, None, 3.5, ("x",)])
def test_keys_that_are_not_names_are_refused(name):
    """A key that is not a name is refused like an unknown name."""
    solution = solve(ODE.of({"x": "-x"}, [1]), [0, 2], 1e-6)
    with pytest.raises(
        UnknownNameError, match="expected a quantity of this motion, got .*There are x"
    ):
        solution[name]


def test_declarations_are_saved(tmp_path):
    """Assumptions of symbols are saved: the loaded problem refuses k = -2 as the original does."""
    k, n, x = sp.Symbol("k", positive=True), sp.Symbol("n", even=True), sp.Symbol("x")
    made = ODE.of({"x": -sp.sqrt(k**2) * x + n}, [1], parameters={"k": 1, "n": 2})
    solve(made, 1.0).save(tmp_path / "decay.npz")
    read = SavedSolution.load(tmp_path / "decay.npz").problem
    assert read is not None
    assert set(read.rates.declared) >= {n}
    for problem in (made, read):
        for name, value in (("k", -2), ("n", 3), ("n", 1.5)):
            with pytest.raises(
                CoordinateError,
                match=f"{name}: expected a value that is .*, as declared, got {value}",
            ):
                problem.with_start(parameters={name: value})
            with pytest.raises(
                CoordinateError,
                match=f"{name}: expected a value that is .*, as declared, got {value}",
            ):
                solve_many(problem, {name: [2, value, 4]}, 1.0)


@pytest.mark.parametrize(
    ("declared", "message"),
    [
        ({"k": ["evil"]}, r"declared\.k\[0\]: expected one of even, "),
        ({"k": ["positive", "negative"]}, "metadata: problem"),
        ({"k": ["negative"]}, "k: expected a value that is .*negative"),
    ],
)
def test_bad_declarations_are_refused(tmp_path, declared, message):
    """Unknown or contradictory assumptions in a file, or wrong values for them, are refused."""
    path = tmp_path / "decay.npz"
    solve(ODE.of({"x": "-k*x"}, [1], parameters={"k": 1}), 1.0).save(path)
    with np.load(path) as file:
        arrays = dict(file)
    known = json.loads(str(arrays["metadata"]))
    known["problem"]["declared"] = declared
    np.savez(path, **arrays | {"metadata": np.array(json.dumps(known))})
    with pytest.raises(FileFormatError, match=message):
        SavedSolution.load(path)
