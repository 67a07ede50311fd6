"""Optimised code: requested, and after many steps of one run."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from geomtorsion.errors import ArgumentError
from geomtorsion.ode import ODE, SavedSolution, Taylor, When, solve
from geomtorsion.ode.engines import taylor
from geomtorsion.ode.engines.named import engine_named
from geomtorsion.ode.system import STEPS_AT_ONCE

pytest.importorskip("heyoka", reason="optimised code is heyoka's")

SWING = ODE.of({"x": "v", "v": "-x"}, [1, 0])
ORBIT = ODE.of(
    {"x": "u", "y": "w", "u": "-x/(x**2 + y**2)**(3/2)", "w": "-y/(x**2 + y**2)**(3/2)"},
    [0.5, 0, 0, "sqrt(3)"],
)


@pytest.mark.parametrize(
    "name", ["Taylor", "Taylor(optimised)", "Taylor(64)", "Taylor(113, optimised)"]
)
def test_names_lead_back_to_the_engine(name):
    """Files and tables keep whether code was optimised."""
    assert engine_named(name).name == name


@pytest.mark.parametrize(
    "name", ["Taylor()", "Taylor(113, )", "Taylor(, optimised)", "Taylor(fast)", "taylor"]
)
def test_other_names_are_refused(name):
    """Only names that an engine has."""
    with pytest.raises(Exception, match="expected Taylor, "):
        engine_named(name)


@pytest.mark.parametrize("value", [1, None, "yes"])
def test_only_true_or_false(value):
    """A number of a level, for example, is refused."""
    with pytest.raises(ArgumentError, match="optimised: expected True or False"):
        Taylor(optimised=value)


@pytest.mark.parametrize("precision", [53, 64, 113])
def test_optimised_code_solves(precision, tmp_path):
    """Against the closed form, and between samples of a saved solution."""
    solution = solve(SWING, 20.0, 1e-13, Taylor(precision, optimised=True))
    assert solution.engine == Taylor(precision, optimised=True).name
    assert abs(float(solution["x"][-1]) - np.cos(20)) < solution.error + 1e-15
    solution.save(tmp_path / "swing.npz")
    again = SavedSolution.load(tmp_path / "swing.npz").at(7.25)
    assert float(again["x"]) == float(solution.at(7.25)["x"])


def test_repeated_runs_have_equal_bits():
    """Two runs of one kind of code are equal; both kinds agree within the error."""
    plain, fast = (
        [solve(ORBIT, 30.0, 1e-11, Taylor(optimised=kind)) for _ in range(2)]
        for kind in (False, True)
    )
    for pair in (plain, fast):
        assert np.array_equal(pair[0].states, pair[1].states)
    gap = np.abs(plain[0].states - fast[0].states).max()
    assert gap <= (plain[0].error + fast[0].error) * np.abs(plain[0].states).max()


def test_a_long_run_is_optimised_on_the_way():
    """An oscillator that takes more steps than plain code: closed form, equal bits in threads."""
    end = 250_000.0
    times = np.linspace(0, end, 7)

    def run(_: int) -> np.ndarray:
        return solve(SWING, times, 1e-4, Taylor()).states

    solution = solve(SWING, times, 1e-4, Taylor())
    assert solution.cost.steps > taylor.LONG * STEPS_AT_ONCE
    exact = np.stack([np.cos(times), -np.sin(times)], axis=1)
    assert np.abs(solution.states - exact).max() <= solution.error
    with ThreadPoolExecutor(2) as pool:
        assert all(np.array_equal(x, solution.states) for x in pool.map(run, range(2)))


@pytest.mark.parametrize("portions", [1, 2])
def test_values_between_samples_of_a_long_run(portions, monkeypatch):
    """Between samples the run is followed again, on both sides of the change of code."""
    monkeypatch.setattr(taylor, "LONG", portions)
    end = 2.5 * STEPS_AT_ONCE
    solution = solve(SWING, np.linspace(0, end, 5), 1e-9, Taylor())
    assert solution.cost.steps > portions * STEPS_AT_ONCE
    times = np.array([0.1, 0.4, 0.6, 0.9]) * end
    assert np.abs(solution.at(times)["x"] - np.cos(times)).max() <= solution.error


@pytest.mark.parametrize("portions", [1, 2])
def test_a_long_run_that_ends_at_a_pole(portions, monkeypatch):
    """The end is where it is without optimised code."""
    monkeypatch.setattr(taylor, "LONG", portions)
    hasty = ODE.of({"x": "50*v", "v": "-50*x", "y": "(1 + y**2)/100"}, [1, 0, 0])
    with pytest.raises(Exception, match=r"at t = 157\.08"):
        solve(hasty, 200.0, 1e-9, Taylor())


def test_a_long_run_that_a_condition_ends(monkeypatch):
    """Optimised code also stops where a condition fails."""
    monkeypatch.setattr(taylor, "LONG", 1)
    law = ODE.of({"x": "v", "v": "-x", "s": "1/1000"}, [1, 0, 0], events=[When("3 - s")])
    solution = solve(law, 5000.0, 1e-8, Taylor())
    assert abs(solution.times[-1] - 3000) <= 3000 * solution.error
