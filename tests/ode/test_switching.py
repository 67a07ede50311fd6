"""Switching: pieces, tables, conditions with changes, and changes at times by parameters."""

import math

import mpmath
import numpy as np
import pytest
import sympy as sp
from scipy.interpolate import CubicSpline, PchipInterpolator

import geomtorsion as gt
from geomtorsion.errors import (
    ArgumentError,
    ExpressionError,
    FileFormatError,
    StartError,
    StuckError,
    TimeError,
    UnknownNameError,
)

ENGINES = [gt.Taylor(), gt.RungeKutta(), gt.Stiff()]
# Twice the requested error, because size and difference are both known to the accuracy only.
MARGIN = 2.0


def ball(**start):
    """A ball that loses half of its speed whenever it meets the floor."""
    return gt.ODE.of(
        {"z": "v", "v": "-g"},
        {"z": 1, "v": 0, **start},
        parameters={"g": 10, "e": "1/2"},
        events=[gt.When("z", {"v": "-e*v"})],
    )


def bounced(time, height, g, e, number):
    """Height and velocity after so many bounces, in closed form."""
    first = sp.sqrt(2 * height / g)
    last = first * (1 + 2 * sum(e**k for k in range(1, number)))
    speed = g * first * e**number
    since = time - last
    return speed * since - g * since**2 / 2, speed - g * since


@pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.name)
def test_a_bouncing_ball_follows_its_closed_form(engine):
    """Height and velocity after two bounces agree with the closed form within the error."""
    solution = gt.solve(ball(), 1.0, 1e-9, engine=engine)
    exact = bounced(sp.Integer(1), 1, 10, sp.Rational(1, 2), 2)
    for name, value in zip(("z", "v"), exact, strict=True):
        size = np.abs(solution[name]).max()
        assert abs(solution[name][-1] - float(value)) <= MARGIN * solution.error * size
    first = math.sqrt(0.2)
    assert solution.change_times == pytest.approx([first, 2 * first], rel=1e-9)


def test_a_bounce_is_found_to_thirty_digits():
    """With more digits the bounces are as exact as the motion between them."""
    solution = gt.solve(ball(), 1.0, 1e-25, engine=gt.Taylor(113))
    with mpmath.workdps(40):
        exact = bounced(sp.Integer(1), sp.Integer(1), 10, sp.S.Half, 2)
        exact = [mpmath.mpf(str(sp.N(x, 40))) for x in exact]
        values = [mpmath.mpf(str(solution[name][-1])) for name in ("z", "v")]
        assert max(abs(x - y) for x, y in zip(exact, values, strict=True)) <= 5 * 1e-25


def test_derivatives_pass_bounces_by_the_saltation_matrix():
    """Derivatives of height and velocity after two bounces agree with the closed form."""
    names = ["e", "g", "z"]
    solution = gt.solve(ball(), 1.0, derivatives=names)
    e, g, z = symbols = sp.symbols("e g z", positive=True)
    values = {e: sp.S.Half, g: 10, z: 1}
    for name, exact in zip(("z", "v"), bounced(1, z, g, e, 2), strict=True):
        for by, symbol in zip(names, symbols, strict=True):
            slope = float(sp.diff(exact, symbol).subs(values))
            key = f"d{name}_d{by}"
            assert solution[key][-1] == pytest.approx(slope, abs=solution.error_of(key) * 100)
            assert solution[key][-1] == pytest.approx(slope, rel=1e-9)


def test_a_sample_at_the_bounce_shows_one_side():
    """A requested time at which the velocity jumps shows one of its sides."""
    solution = gt.solve(ball(z=5), [0.5, 1.0, 1.5])
    assert solution["z"] == pytest.approx([3.75, 0, 1.25], abs=1e-9)
    assert min(abs(solution["v"][1] - x) for x in (-10, 5)) < 1e-9
    assert solution.event_times("z").tolist() == []
    assert solution.event_times("v") == pytest.approx([1.5])


def test_a_thermostat_has_its_period():
    """Heating and cooling between 18 and 20 degrees take logarithms of known ratios."""
    room = gt.ODE.of(
        {"T": "k*on - T"},
        {"T": 18},
        parameters={"k": 30, "on": 1},
        events=[gt.When("20 - T", {"on": 0}), gt.When("T - 18", {"on": 1})],
    )
    solution = gt.solve(room, 1.0)
    heating, cooling = math.log(12 / 10), math.log(20 / 18)
    exact = np.cumsum([heating, cooling] * 5)
    exact = exact[exact < 1]
    assert solution.change_times == pytest.approx(exact, rel=1e-9)
    assert {*solution["on"].tolist()} == {0.0, 1.0}
    assert solution.problem.with_start(parameters={"on": 0}).start == (18, 0)


def test_derivatives_contain_the_shift_of_a_change():
    """A decay that is switched off at T: dy/dT = -k exp(-k T) y(0)."""
    decay = gt.ODE.of(
        {"y": "-k*y"}, {"y": 2}, parameters={"k": 3, "T": 0.5}, events=[gt.At("T", {"k": 0})]
    )
    solution = gt.solve(decay, 1.0, derivatives=["T", "k", "y"])
    rest = math.exp(-1.5)
    assert solution["dy_dT"][-1] == pytest.approx(-3 * rest * 2, rel=1e-9)
    assert solution["dy_dk"][-1] == pytest.approx(-0.5 * rest * 2, rel=1e-9)
    assert solution["dy_dy"][-1] == pytest.approx(rest, rel=1e-9)
    later = gt.solve(decay.with_start(parameters={"T": 0.75}), 1.0)
    assert later["y"][-1] == pytest.approx(2 * math.exp(-2.25), rel=1e-9)


def test_a_stage_that_separates_changes_mass_and_speed():
    """A parameter that changes with the state is a state; its derivative passes the change."""
    rocket = gt.ODE.of(
        {"m": "-1", "v": "1/m"},
        {"m": 10, "v": 0},
        parameters={"dry": 2, "kick": 1},
        events=[gt.When("m - 5", {"m": "m - dry", "v": "v + kick/dry"})],
    )
    solution = gt.solve(rocket, 6.0, derivatives=["dry"])
    assert solution["m"][-1] == pytest.approx(2.0, rel=1e-9)
    assert solution["v"][-1] == pytest.approx(math.log(2) + 0.5 + math.log(3 / 2), rel=1e-9)
    exact = -1 / 4 + 1 / 2 - 1 / 3
    assert solution["dv_ddry"][-1] == pytest.approx(exact, rel=1e-9)


def test_a_contact_that_opens_lets_go():
    """A mass leaves a spring at x = 0 and flies on; the derivative by the stiffness includes it."""
    contact = gt.ODE.of(
        {"x": "v", "v": "-k*x"},
        {"x": -1, "v": 0},
        parameters={"k": 4},
        events=[gt.When("-x", {"k": 0})],
    )
    solution = gt.solve(contact, 2.0, derivatives=["k"])
    # x = sqrt(k) (t - pi/(2 sqrt(k))) after the contact; the stiffness is a state from the start.
    assert solution["x"][-1] == pytest.approx(2 * (2 - math.pi / 4), rel=1e-9)
    assert solution["dx_dk"][-1] == pytest.approx(2 / (2 * 2), rel=1e-9)


def test_pieces_in_the_state_restart_at_their_level():
    """A spring of two stiffnesses has half a period of each; text and Piecewise agree."""
    x = sp.Symbol("x", real=True)
    text = gt.ODE.of({"x": "v", "v": "pieces(x, -x, 0, -4*x)"}, [1, 0])
    symbols = gt.ODE.of({"x": "v", "v": sp.Piecewise((-x, x < 0), (-4 * x, True))}, [1, 0])
    assert text == symbols
    solution = gt.solve(text, 1.5 * math.pi)
    assert solution["x"][-1] == pytest.approx(1, rel=1e-9)
    assert solution["x"].min() == pytest.approx(-2, rel=1e-3)
    again = gt.solve(symbols, 1.5 * math.pi)
    assert (again["x"] == solution["x"]).all()


def test_a_force_that_jumps_in_time_has_derivatives_by_the_time_of_the_jump():
    """v' = a before T and b after it: dv/dT = a - b."""
    push = gt.ODE.of({"v": "pieces(t, a, T, b)"}, [0], parameters={"a": 3, "b": 1, "T": 0.5})
    solution = gt.solve(push, 2.0, derivatives=["T", "a", "b"])
    assert solution["v"][-1] == pytest.approx(3.0, rel=1e-12)
    slopes = [solution[f"dv_d{name}"][-1] for name in ("T", "a", "b")]
    assert slopes == pytest.approx([2, 0.5, 1.5], rel=1e-9)


@pytest.mark.parametrize(
    ("interpolation", "made"),
    [("cubic", CubicSpline), ("monotone", PchipInterpolator)],
)
def test_a_table_is_integrated_as_scipy_does(interpolation, made):
    """The integral of a table over time, at rows and between them, equals scipy's."""
    places = np.array([0, 0.3, 1, 1.5, 4])
    values = np.array([1, -2, 0.5, 3, 3])
    table = gt.Table.of(np.column_stack([places, values]), interpolation)
    problem = gt.ODE.of({"v": "2*F(t)"}, [0], tables={"F": table}, outputs={"F": "F(t)"})
    times = [0.3, 0.7, 3.9, 4.0]
    solution = gt.solve(problem, times)
    one = made(places, values)
    size = max(abs(2 * one.integrate(0, t)) for t in times)
    for k, time in enumerate(times):
        error = MARGIN * solution.error * size
        assert abs(solution["v"][k] - 2 * one.integrate(0, time)) <= error
        assert solution["F"][k] == pytest.approx(one(time), rel=1e-9)


def test_a_table_over_a_state_is_a_potential():
    """A particle crosses rows of a force; its energy with the integral of the table is kept."""
    places = np.linspace(-2, 2, 17)
    table = gt.Table.of(np.column_stack([places, -np.sin(places)]))
    spline = CubicSpline(places, -np.sin(places))
    solution = gt.solve(gt.ODE.of({"x": "v", "v": "F(x)"}, [1.5, 0], tables={"F": table}), 6.0)
    energy = solution["v"] ** 2 / 2 - [spline.integrate(0, x) for x in solution["x"]]
    assert np.ptp(energy) <= 1e-9


def test_rows_of_a_file_and_of_a_list_agree(tmp_path):
    """Commas, blanks, comments and a line of names are read."""
    file = tmp_path / "torque.csv"
    file.write_text("# measured\ntime, torque\n0, 1\n1 ; 2\n\n3 4\n")
    assert gt.Table.of(file) == gt.Table.of([(0, 1), (1, 2), (3, 4)])
    assert hash(gt.Table.of(file)) == hash(gt.Table.of(str(file)))


def test_the_trivial_tables():
    """A constant table, two rows, steps, and a table that holds its ends."""
    constant = gt.Table.of([(0, 2), (1, 2), (5, 2)])
    assert gt.solve(gt.ODE.of({"v": "F(t)"}, [0], tables={"F": constant}), 5.0)["v"][
        -1
    ] == pytest.approx(10, rel=1e-12)
    steps = gt.Table.of([(0, 1), (1, 3), (2, 7)], "steps", outside="hold")
    solution = gt.solve(gt.ODE.of({"v": "F(t)"}, [0], tables={"F": steps}), [1, 2, 3])
    assert solution["v"] == pytest.approx([1, 4, 11], rel=1e-12)
    assert gt.Table.of([(0, 0), (2, 4)])(1) == 2


def test_two_conditions_end_a_motion():
    """Each of two stops ends the motion, one by one and in a batch."""
    problem = gt.ODE.of(
        {"x": "v", "v": "0"}, {"x": 0, "v": 1}, events=[gt.When("2 - x"), gt.When("x + 1")]
    )
    solution = gt.solve(problem, 10.0)
    assert (solution.outcome, solution.trajectory.reason) == ("stopped", "2 - x")
    many = gt.solve_many(problem, {"v": [1.0, -1.0, 0.01]}, 10.0)
    assert many.stopped_by.tolist() == ["2 - x", "x + 1", ""]
    assert many.times_at_stop[:2] == pytest.approx([2, 1])


def test_members_that_bounce_are_followed_one_by_one():
    """Each member bounces at its own time, and equals its own solution."""
    values = np.array([0.4, 0.5, 0.9])
    many = gt.solve_many(ball(), {"e": values}, [0.5, 1.0])
    for k, e in enumerate(values):
        if not many.finished[k]:
            continue
        alone = gt.solve(ball().with_start(parameters={"e": e}), [0.5, 1.0])
        assert many["z"][k] == pytest.approx(alone["z"], abs=1e-9)
    assert many.finished.sum() >= 2


def test_equal_calls_files_and_checkpoints_give_equal_bits(tmp_path):
    """A second call, a saved solution and a resumed run agree to the bit."""
    problem = ball()
    one, two = (gt.solve(ball(), [0.5, 1.0], derivatives=["e"]) for _ in range(2))
    assert (one.states == two.states).all()
    one.save(tmp_path / "ball.npz")
    saved = gt.SavedSolution.load(tmp_path / "ball.npz")
    assert saved.problem == one.problem
    assert (saved.at(0.7)["dz_de"] == one.at(0.7)["dz_de"]).all()
    file = tmp_path / "run.npz"
    first = gt.solve(problem, [0.5, 1.0], checkpoint=file)
    again = gt.solve(problem, [0.5, 1.0], checkpoint=file)
    assert (first.states == again.states).all()


def test_balls_that_meet_the_floor_at_one_time():
    """Two conditions that fall at one time both act."""
    two = gt.ODE.of(
        {"x": "v", "v": "-10", "y": "w", "w": "-10"},
        [1, 0, 1, 0],
        events=[gt.When("x", {"v": "-v/2"}), gt.When("y", {"w": "-w/2"})],
    )
    solution = gt.solve(two, 1.0)
    assert solution["x"][-1] == pytest.approx(solution["y"][-1], abs=1e-9)
    assert solution["x"][-1] == pytest.approx(gt.solve(ball(), 1.0)["z"][-1], abs=1e-9)


def test_a_wall_with_two_sides_reflects():
    """A particle that comes back from a wall does not fall through its other side."""
    wall = [gt.When("x", {"v": "-v"}), gt.When("-x", {"v": "-v"})]
    for start, exact in ((1, 2), (-1, -2)):
        problem = gt.ODE.of({"x": "v", "v": "0"}, {"x": start, "v": -start}, events=wall)
        assert gt.solve(problem, 3.0)["x"][-1] == pytest.approx(exact)


def test_a_mass_that_sticks_to_the_floor_stays_there():
    """A condition that also takes away the weight leaves the mass at rest."""
    stuck = gt.ODE.of(
        {"z": "v", "v": "-g"},
        {"z": 1, "v": 0},
        parameters={"g": 10},
        events=[gt.When("z", {"v": 0, "g": 0})],
    )
    solution = gt.solve(stuck, 3.0)
    assert [solution["z"][-1], solution["v"][-1]] == [0, 0]


def test_a_start_on_the_floor_that_moves_down_bounces_at_once():
    """The condition falls at t = 0; a start that moves up leaves the floor."""
    for speed, exact in ((-2, 0.0375), (2, 0.0875)):
        solution = gt.solve(ball(z=0, v=speed), 0.05)
        assert solution["z"][-1] == pytest.approx(exact, rel=1e-9)


def test_a_neuron_that_fires_starts_again():
    """A state that is set back makes a periodic motion: V' = 2 - V up to 1, period log 2."""
    neuron = gt.ODE.of({"V": "2 - V"}, [0], events=[gt.When("1 - V", {"V": 0})])
    solution = gt.solve(neuron, 3.0)
    since = 3 % math.log(2)
    assert solution["V"][-1] == pytest.approx(2 - 2 * math.exp(-since), rel=1e-9)


ENDLESS = {
    "bounces that add up to a finite time": (lambda: gt.solve(ball(), 2.0), "infinitely many"),
    "dry friction": (
        lambda: gt.solve(
            gt.ODE.of({"x": "v", "v": "-pieces(v, -1, 0, 1) - x/10"}, [1, 1]), 8.0
        ),
        "slides along v = 0",
    ),
    "two laws that point to their border": (
        lambda: gt.solve(gt.ODE.of({"x": "pieces(x, 1, 0, -1)"}, [1]), 3.0),
        "slides along x = 0",
    ),
    "a relay without a gap": (
        lambda: gt.solve(
            gt.ODE.of(
                {"x": "k"}, [1], parameters={"k": -1},
                events=[gt.When("x", {"k": 1}), gt.When("-x", {"k": -1})],
            ),
            3.0,
        ),
        "slides along x = 0",
    ),
    "behind the last row": (
        lambda: gt.solve(
            gt.ODE.of({"v": "F(t)"}, [0], tables={"F": gt.Table.of([(0, 1), (1, 2)])}), 2.0
        ),
        "no rows beyond",
    ),
    "a ball that does not bounce": (
        lambda: gt.solve(ball().with_start(parameters={"e": 0}), 1.0), "rests on z = 0",
    ),
    "backwards through a bounce": (lambda: gt.solve(ball(), -1.0), "forwards"),
    "backwards through a step in time": (
        lambda: gt.solve(gt.ODE.of({"x": "Heaviside(t + 1)"}, [0]), -2.0), "forwards",
    ),
    "backwards through a row of a table": (
        lambda: gt.solve(
            gt.ODE.of({"x": "F(t)"}, [0], tables={"F": gt.Table.of([(-3, 0), (0, 2), (1, 3)])}),
            -2.0,
        ),
        "forwards",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", ENDLESS)
def test_what_the_equations_do_not_describe_is_refused_with_the_reason(name):
    """The error names the reason and holds the computed part."""
    call, words = ENDLESS[name]
    with pytest.raises(StuckError, match=words) as error:
        call()
    assert len(error.value.solution.times) >= 0


@pytest.mark.parametrize("law", ["pieces(t, 1, a, 2, b, 3)", "pieces(-t, 3, -b, 2, -a, 1)"])
def test_levels_that_are_parameters_have_to_increase(law):
    """The pieces 1, 2 and 3 for a time of one each; a value in a wrong order is refused."""
    steps = gt.ODE.of({"x": law}, [0], parameters={"a": 1, "b": 2})
    assert gt.solve(steps, 3.0)["x"][-1] == pytest.approx(6, rel=1e-9)
    equal = steps.with_start(parameters={"b": 1})
    assert gt.solve(equal, 3.0, derivatives=["a"])["x"][-1] == pytest.approx(7, rel=1e-9)
    with pytest.raises(StartError, match="the levels .* of pieces in .*t do not increase"):
        gt.solve(steps.with_start(parameters={"a": 3}), 3.0)
    later = steps.with_start(events=[gt.At(0.5, {"a": 5})])
    with pytest.raises(StuckError, match="do not increase"):
        gt.solve(later, 3.0)


@pytest.mark.parametrize("engine", [None, gt.RungeKutta()])
def test_a_change_at_a_later_time_does_not_touch_a_motion_backwards(engine):
    """x' = k, with k = 2 from t = 1 on: x(-2) = -2, also as a member of many."""
    step = gt.ODE.of({"x": "k"}, [0], parameters={"k": 1}, events=[gt.At(1, {"k": 2})])
    back = gt.solve(step, [-0.5, -2.0], engine=engine)
    assert back["x"].tolist() == pytest.approx([-0.5, -2.0], rel=1e-12)
    many = gt.solve_many(step, [[0], [1]], [-0.5, -2.0], engine=engine)
    assert many["x"] == pytest.approx(np.array([[-0.5, -2.0], [0.5, -1.0]]), rel=1e-12)


def test_the_accumulation_of_bounces_is_reported_at_its_time():
    """The refused motion ends at the time at which all bounces have happened: 3 sqrt(2 h/g)."""
    with pytest.raises(StuckError) as error:
        gt.solve(ball(), 2.0)
    end = error.value.solution.trajectory.reached
    assert end == pytest.approx(3 * math.sqrt(0.2), rel=1e-6)


F = {"F": gt.Table.of([(0, 1), (1, 2)])}
REFUSED = {
    "one row": (lambda: gt.Table.of([(0, 1)]), ExpressionError, "two rows"),
    "a number outside": (
        lambda: gt.Table.of([(0, 1), (1, 2)])(1.5), ExpressionError, "from 0 to 1, got 1.5",
    ),
    "equal places": (lambda: gt.Table.of([(0, 1), (0, 2)]), ExpressionError, "increasing"),
    "not a number": (lambda: gt.Table.of([(0, 1), (1, math.nan)]), ExpressionError, "finite"),
    "three columns": (lambda: gt.Table.of([(0, 1, 2), (1, 2, 3)]), ExpressionError, "rows"),
    "an unknown interpolation": (
        lambda: gt.Table.of([(0, 1), (1, 2)], "spline"), ExpressionError, "cubic",
    ),
    "a file that is missing": (lambda: gt.Table.of("none.csv"), FileFormatError, "none.csv"),
    "a table with the name of a state": (
        lambda: gt.ODE.of({"F": "F"}, [0], tables=F), ExpressionError, "Rename",
    ),
    "rows instead of a table": (
        lambda: gt.ODE.of({"x": "F(t)"}, [0], tables={"F": [(0, 1)]}), ExpressionError, "Table",
    ),
    "a table without its argument": (
        lambda: gt.ODE.of({"x": "F"}, [0], tables=F), ExpressionError, "function",
    ),
    "a start outside a table": (
        lambda: gt.ODE.of({"x": "F(x)"}, [3], tables=F), StartError, "no rows",
    ),
    "levels that decrease": (
        lambda: gt.ODE.of({"x": "pieces(x, 1, 2, 3, 1, 4)"}, [0]), ExpressionError, "increasing",
    ),
    "a start at rest on the floor": (
        lambda: gt.solve(ball(z=0), 1.0), StartError, "rests on z = 0",
    ),
    "a table of two arguments": (
        lambda: gt.ODE.of({"x": "F(x, 1)"}, [0], tables=F), ExpressionError, "one argument",
    ),
    "sign of two numbers": (
        lambda: gt.ODE.of({"x": "sign(1, 2)"}, [0]), ExpressionError, "does not take 2 arguments",
    ),
    "the largest of 14": (
        lambda: gt.ODE.of({"x": f"max({', '.join(f'{k}*t' for k in range(14))})"}, [0]),
        ExpressionError, "Max: expected at most 6 expressions, got 14",
    ),
    "a missing piece": (
        lambda: gt.ODE.of({"x": "pieces(x, 1, 2)"}, [0]), ExpressionError, "each further piece",
    ),
    "Piecewise with a gap": (
        lambda: gt.ODE.of({"x": sp.Piecewise((1, sp.Symbol("x") < 0))}, [0]),
        ExpressionError, "True",
    ),
    "Piecewise as text": (
        lambda: gt.ODE.of({"x": "Piecewise(x)"}, [0]), ExpressionError, "pieces",
    ),
    "a condition that never changes": (
        lambda: gt.ODE.of({"x": "k"}, [0], parameters={"k": 1}, events=[gt.When("2", {"x": 0})]),
        ExpressionError, "changes during the motion",
    ),
    "a change of an unknown name": (
        lambda: gt.ODE.of({"x": "1"}, [0], events=[gt.When("1 - x", {"y": 0})]),
        UnknownNameError, "y",
    ),
    "a change with an unknown name": (
        lambda: gt.ODE.of({"x": "1"}, [0], events=[gt.When("1 - x", {"x": "y"})]),
        ExpressionError, "y",
    ),
    "a time that moves": (
        lambda: gt.ODE.of({"x": "1"}, [0], events=[gt.At("x", {"x": 0})]), TimeError, "When",
    ),
    "a time before the start": (
        lambda: gt.ODE.of(
            {"x": "1"}, [0], parameters={"T": -1}, events=[gt.At("T", {"x": 0})]
        ),
        TimeError, "0 or later",
    ),
    "a proof": (
        lambda: gt.prove(gt.solve(ball(), 0.5)), ArgumentError, "conditions with changes",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_bad_pieces_tables_and_conditions_are_refused(name):
    """The message names the reason."""
    call, error, words = REFUSED[name]
    with pytest.raises(error, match=words):
        call()
