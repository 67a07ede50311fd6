"""In turn: what RungeKutta's answers are held against, and where the search ends."""

from dataclasses import dataclass

import numpy as np
import pytest

from geomtorsion.errors import AccuracyError
from geomtorsion.geometry import levi_civita
from geomtorsion.motion import RungeKutta, Taylor, flow, geodesic, solve
from geomtorsion.motion.checking import CAUTION
from geomtorsion.motion.compare import difference
from geomtorsion.motion.in_turn import MANY_STEPS, ROUGH_BELOW, TAKEN, told_in_turn
from geomtorsion.motion.journey import travel
from geomtorsion.spaces import load
from tests.motion.engines import needs_heyoka

EPSILON = 2.0**-52


@dataclass(frozen=True, eq=False)
class Try:
    """A run that is wrong by a multiple of its tolerance, and by its rounding."""

    tolerance: float
    wrong: float
    steps: int
    outcome: str = "done"


def steps_for(tolerance):
    """Steps of an eighth-order method."""
    return round(30 * tolerance**-0.125)


class Motion:
    """Runs whose errors are growth times the tolerance, and roundings times a grown last place."""

    def __init__(self, growth=1.0, rounding=0.0, outcome="done"):
        self.growth, self.rounding, self.outcome = growth, rounding, outcome
        self.runs = []

    def attempt(self, tolerance):
        """As `checking` makes it: each run but once."""
        for run, part in self.runs:
            if run.tolerance == tolerance and not part:
                return run
        return self._made(tolerance, 0.0)

    def moved(self, tolerance, part):
        """A run started elsewhere: the answer is off by as much, grown."""
        return self._made(tolerance, part)

    def _made(self, tolerance, part):
        wrong = self.growth * tolerance + self.rounding * part
        run = Try(tolerance, wrong, steps_for(tolerance), self.outcome)
        self.runs.append((run, part))
        return run

    def told(self, accuracy, known=None):
        """The answer, and what is remembered."""
        known = {} if known is None else known
        return told_in_turn(
            RungeKutta(), accuracy, known, self.attempt, self.moved,
            lambda one, two: (abs(one.wrong - two.wrong), 65),
        )  # fmt: skip


@pytest.mark.parametrize("growth", [0.01, 1.0, 300.0])
@pytest.mark.parametrize("accuracy", [1e-5, 1e-8, 1e-11])
def test_what_steps_leave_out_is_told_by_a_coarser_run(growth, accuracy):
    """The estimate is near the error and never below it; two pairs of runs at most."""
    motion = Motion(growth)
    found = motion.told(accuracy)
    assert found is not None
    assert found.check.tolerance == pytest.approx(100 * found.answer.tolerance)
    least = EPSILON * np.sqrt(found.answer.steps)
    assert found.answer.wrong <= found.error <= max(4 * found.answer.wrong, least)
    assert found.error <= TAKEN * accuracy
    assert len(motion.runs) == len(found.spent) <= 6


def test_what_was_good_enough_is_remembered():
    """The next motion begins there, looser if there is much to spare, and tries that once."""
    known = {}
    assert Motion(1e-3).told(1e-8, known) is not None
    looser = Motion(1e-3)
    found = looser.told(1e-8, known)
    assert found is not None
    assert len(looser.runs) == 3
    assert 0.1 * 1e-8 * TAKEN < found.error <= TAKEN * 1e-8
    # Another motion of equal equations for which that is too loose, and then that one again.
    other = Motion(10.0)
    assert other.told(1e-8, known) is not None
    assert len(other.runs) == 4
    last = Motion(10.0)
    assert last.told(1e-8, known) is not None
    assert len(last.runs) == 2


def test_what_was_too_loose_once_is_not_tried_again():
    """However much there is to spare."""
    key = "RungeKutta", 1e-8, "in turn"
    missed = (*key, "missed")
    known = {key: 1e-10, missed: 1e-8}
    assert Motion(1e-4).told(1e-8, known) is not None
    assert known[key] == 1e-10
    assert known[missed] == 1e-8
    del known[missed]
    assert Motion(1e-4).told(1e-8, known) is not None
    assert known[key] > 1e-8


def test_few_steps_are_held_against_a_run_between():
    """Errors of the coarse run may cancel by chance; then the run between says more."""
    motion = Motion()

    def difference(one, two):
        return (abs(one.wrong - two.wrong) * (0.01 if two.tolerance > 50 * one.tolerance else 1), 9)

    found = told_in_turn(RungeKutta(), 1e-6, {}, motion.attempt, motion.moved, difference)
    assert found is not None
    assert found.answer.steps < MANY_STEPS
    assert len(found.spent) == 3
    assert found.answer.wrong <= found.error <= 1e-6


def test_rounding_is_told_by_runs_that_round_differently():
    """Near rounding two more runs begin above and below; the coarse run is not moved then."""
    motion = Motion(growth=0.01, rounding=600.0)
    found = motion.told(1e-12)
    assert found is not None
    assert found.answer.tolerance <= ROUGH_BELOW
    moved = [part for run, part in motion.runs if run.tolerance < 3 * found.answer.tolerance]
    assert sorted(moved) == [-EPSILON, 0.0, EPSILON]
    assert found.error >= CAUTION * 600 * EPSILON * 0.5
    assert found.error <= 1e-12


def test_the_search_ends_where_rounding_is_left():
    """The best is returned, soon, with an error above the accuracy."""
    motion = Motion(growth=1.0, rounding=1e5)
    found = motion.told(1e-12)
    assert found is not None
    assert found.error > 1e-12
    assert found.error == pytest.approx(2 * CAUTION * 1e5 * EPSILON, rel=0.1)
    assert len(motion.runs) <= 8


@pytest.mark.parametrize(("accuracy", "outcome"), [(1e-3, "done"), (1e-8, "stuck")])
def test_what_cannot_be_told_is_left(accuracy, outcome):
    """A check would be too loose, or the motion ends on its way."""
    assert Motion(outcome=outcome).told(accuracy) is None


@needs_heyoka
@pytest.mark.parametrize("accuracy", [1e-6, 1e-9, 1e-12])
def test_errors_of_an_orbit(accuracy):
    """A bound orbit near a rotating hole: below the accuracy, the estimate near it."""
    orbit = geodesic(
        levi_civita(load("kerr").frame), [0, 8.0, 1.4, 0],
        frame_velocity=[1.2, 0.05, 0.2, 0.6], parameters={"M": 1, "a": 0.6},
    )  # fmt: skip
    for _ in range(3):
        sol = solve(orbit, 300.0, accuracy, RungeKutta())
        fine = travel(orbit, Taylor(64), 1e-19, sol.times * orbit.speed)
        true, _ = difference(sol.journey, fine)
        assert true <= accuracy
        assert 0.3 * true <= sol.error <= 100 * true


@pytest.mark.parametrize("accuracy", [1e-6, 1e-9, 1e-10])
def test_errors_of_a_flow(accuracy):
    """An ellipse of eccentricity 0.6 over ten turns closes."""
    x = 0.4
    kepler = flow(
        {"x": "u", "y": "v", "u": "-x/(x**2+y**2)**(3/2)", "v": "-y/(x**2+y**2)**(3/2)"},
        {"x": x, "y": 0.0, "u": 0.0, "v": 2.0},
    )
    sol = solve(kepler, np.linspace(0.0, 20 * np.pi, 66), accuracy, RungeKutta())
    row = np.asarray(sol.states)[-1]
    true = max(np.abs(row[:2] - [x, 0.0]).max() / 0.4, np.abs(row[2:] - [0.0, 2.0]).max() / 2.0)
    assert true <= accuracy
    assert 0.1 * true <= sol.error <= 100 * true


def test_an_unstable_motion_says_so():
    """Near a saddle rounding grows beyond any accuracy: no answer rather than a wrong one."""
    saddle = flow({"x": "v", "v": "x"}, {"x": 1.0, "v": -1.0})
    with pytest.raises(AccuracyError):
        solve(saddle, 40.0, 1e-8, RungeKutta())
