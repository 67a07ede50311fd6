"""Seconds instead of an accuracy: the digits that a time buys, and refusals."""

import math
import time
from typing import Any

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import AccuracyError, ArgumentError
from geomtorsion.support.budget import TimeModel, affordable, timed

SO3 = gt.spaces.load("so3").frame
TOP = gt.geodesic(SO3, frame_velocity=[1, 2, 3], metric=[1, 2, 3])
CIRCLE = gt.Loop.circle([0.3, 1, 0.2], 0.01)


def clocked(monkeypatch):
    """A clock of the processor that only `spend` moves."""
    now = [0.0]
    monkeypatch.setattr(time, "thread_time", lambda: now[0])

    def spend(seconds: float) -> None:
        now[0] += seconds

    return spend


def test_three_runs_predict_the_rest():
    """A quadratic law of time is predicted exactly at digits that were not run."""

    def law(d):
        return 0.1 + 0.02 * d + 0.003 * d * d

    model = TimeModel.of([3, 5, 6, 9, 12], [law(d) for d in (3, 5, 6, 9, 12)])
    assert len(model.digits) == 3
    assert model.at(7.5) == pytest.approx(law(7.5), rel=1e-12)
    digits = model.digits_for(law(8.04))
    assert digits == 8.0
    assert model.digits_for(0.9 * law(3)) is None
    assert model.digits_for(10 * law(12)) == 12


def test_no_prediction_is_below_the_fastest_run():
    """A parabola through times that fall and rise dips below zero; a prediction does not."""
    model = TimeModel.of([2, 7, 12], [1.0, 0.01, 3.0])
    assert model.at(5.5) == 0.01
    assert model.at(12) == pytest.approx(3.0)


@pytest.mark.parametrize(("least", "most"), [(0.05, 3), (0.4, 9), (3.0, 12)])
def test_the_chosen_accuracy_takes_the_time(least, most, monkeypatch):
    """The chosen accuracy takes at least four fifths of the time, and no more than all of it."""
    spend = clocked(monkeypatch)

    def cost(accuracy):
        digits = -math.log10(accuracy)
        return 0.02 + 0.005 * digits**2

    accuracy = affordable(lambda a: spend(cost(a)), least, "less")
    assert cost(accuracy) <= least
    assert accuracy == 1e-12 or cost(accuracy) > 0.8 * least
    assert round(-math.log10(accuracy)) <= most


def test_a_jump_of_the_time_is_located(monkeypatch):
    """Where one more run makes the time jump, the finest accuracy before the jump is chosen."""
    spend = clocked(monkeypatch)
    jump = 10**-5.35
    accuracy = affordable(lambda a: spend(0.1 if a > jump else 10.0), 1.0, "less")
    assert jump < accuracy < jump * 10**0.2


def test_no_trial_is_finer_than_the_time_allows(monkeypatch):
    """After the first trial that takes too long no finer one is run."""
    spend, tried = clocked(monkeypatch), []

    def run(accuracy):
        tried.append(accuracy)
        spend(1e-6 / accuracy)

    affordable(run, 1.0, "less")
    assert 1e-7 in tried
    assert 1e-12 not in tried


def test_what_cannot_be_had_is_not_bought():
    """Where an engine does not reach an accuracy, the finest that it reaches is chosen."""

    def run(accuracy):
        if accuracy < 1e-9:
            raise AccuracyError("expected less")

    assert 1e-9 <= affordable(run, 1.0, "less") <= 2e-9


def test_quick_runs_are_repeated(monkeypatch):
    """Runs are repeated for twenty milliseconds; one that may compile does not count."""
    spend, count = clocked(monkeypatch), [0]

    def run():
        count[0] += 1
        spend(1.0 if count[0] == 1 else 0.009)

    assert timed(run, first=True).seconds == pytest.approx(0.009)
    assert count[0] == 4
    assert timed(lambda: spend(0.5)).spread == 0


def test_a_motion_for_seconds_can_be_repeated():
    """The result names its accuracy, which gives equal bits; a long time buys 1e-12."""
    bought = gt.solve(TOP, 5.0, seconds=5.0)
    assert bought.accuracy == 1e-12
    assert bought.error <= 1e-12
    cheap = gt.solve(TOP, 200.0, seconds=0.2)
    again = gt.solve(TOP, 200.0, cheap.accuracy)
    assert np.array_equal(cheap["u1"], again["u1"])
    assert cheap.error <= cheap.accuracy


def test_a_loop_for_seconds():
    """The Burgers vector names the accuracy that its time buys."""
    b = gt.burgers_vector(SO3, CIRCLE, seconds=1.0)
    assert b.accuracy == 1e-12
    assert np.array_equal(b.vector, gt.burgers_vector(SO3, CIRCLE, b.accuracy).vector)


def test_a_looser_accuracy_saves_points_where_the_form_oscillates():
    """Points fall with the accuracy on a wavy loop; on a small one they are the fewest already."""
    x, y, z = sp.symbols("x y z")
    waves = gt.Frame([x, y, z], [[1, 0, 0], [0, 1, 0], [sp.sin(12 * y) * x, sp.cos(9 * x), 1]])
    wide = gt.Loop.circle([0.3, 1, 0.2], 2)
    loose, fine = (gt.burgers_vector(waves, wide, a).evaluations for a in (1e-3, 1e-12))
    assert loose < fine / 2
    small = {gt.burgers_vector(SO3, CIRCLE, a).evaluations for a in (1e-3, 1e-12)}
    assert len(small) == 1


# Types that a checker would refuse.
TEXT: Any = "long"


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: gt.solve(TOP, 1.0, seconds=0), AccuracyError, "expected a positive number"),
        (lambda: gt.solve(TOP, 1.0, seconds=TEXT), AccuracyError, "a positive number, got 'long'"),
        (lambda: gt.solve(TOP, 1.0, seconds=1e-9), AccuracyError, "expected at least"),
        (lambda: gt.solve(TOP, 1.0, 1e-8, seconds=1), ArgumentError, "no accuracy"),
        (lambda: gt.solve(TOP, 1.0, checkpoint="x", seconds=1), ArgumentError, "no checkpoint"),
        (lambda: gt.burgers_vector(SO3, CIRCLE, seconds=1e-9), AccuracyError, "a shorter loop"),
        (lambda: gt.burgers_vector(SO3, CIRCLE, 1e-3, seconds=1), ArgumentError, "no accuracy"),
    ],
)
def test_refused(call, error, words):
    """A time that buys nothing, or that comes with an accuracy, is refused."""
    with pytest.raises(error, match=words):
        call()
