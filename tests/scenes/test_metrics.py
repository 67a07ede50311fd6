"""Measures: values between samples are as good as the samples, at their ends too."""

import numpy as np
import pytest

from geomtorsion.scenes.metrics import SweepRun


@pytest.mark.parametrize("shift", [0.02, 2.01, 3.98])
def test_zeros_and_extremes_between_samples(shift):
    """Of an oscillation in the first steps, in the middle, in the last: to all digits but two.

    Polynomials through fewer places miss it, those through more lose digits at the ends.
    """
    times = np.linspace(0.0, 4.0, 41)
    run = SweepRun(times, {"x": np.sin(times - shift), "y": np.cos(times - shift)}, {})
    zeros = run.zeros("x")
    assert zeros[np.argmin(np.abs(zeros - shift))] == pytest.approx(shift, abs=1e-13)
    assert run.largest("y") == pytest.approx(1.0, abs=1e-13)


def test_what_touches_zero_or_stays_there_does_not_cross_it():
    """Between the zeros of nothing there is no time; a zero on a sample is one where signs change.

    A quantity that is 0 throughout had a zero at each sample, and the step of these as a period.
    """
    times = np.linspace(0.0, 4.0, 41)
    none = {"still": np.zeros(41), "touched": (times - times[10]) ** 2}
    through = {"one": times - times[10], "flat": np.clip(times - times[10], -9, 0) + 0.0}
    later = np.where(times > times[20], times - times[20], through["flat"])
    run = SweepRun(times, none | through | {"later": later}, {})
    assert [run.zeros(name).tolist() for name in (*none, "flat")] == [[], [], []]
    assert run.zeros("one").tolist() == [times[10]]
    assert run.zeros("later").tolist() == [times[10]]
