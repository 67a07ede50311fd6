"""Measures: values between samples are as accurate as the samples, also at the ends."""

import numpy as np
import pytest

from geomtorsion.scenes.metrics import SweepRun


@pytest.mark.parametrize("shift", [0.02, 2.01, 3.98])
def test_zeros_and_extremes_between_samples(shift):
    """Zeros and maxima in the first, middle and last steps of an oscillation are right to 1e-13.

    Polynomials through fewer samples are less accurate; those through more lose digits at the ends.
    """
    times = np.linspace(0.0, 4.0, 41)
    run = SweepRun(times, {"x": np.sin(times - shift), "y": np.cos(times - shift)}, {})
    zeros = run.zeros("x")
    assert zeros[np.argmin(np.abs(zeros - shift))] == pytest.approx(shift, abs=1e-13)
    assert run.largest("y") == pytest.approx(1.0, abs=1e-13)


def test_what_touches_zero_or_stays_there_does_not_cross_it():
    """A quantity that touches zero or stays there has no zero; a sign change on a sample is one.

    A quantity that is 0 throughout has no zeros, rather than one at each sample.
    """
    times = np.linspace(0.0, 4.0, 41)
    none = {"still": np.zeros(41), "touched": (times - times[10]) ** 2}
    through = {"one": times - times[10], "flat": np.clip(times - times[10], -9, 0) + 0.0}
    later = np.where(times > times[20], times - times[20], through["flat"])
    run = SweepRun(times, none | through | {"later": later}, {})
    assert [run.zeros(name).tolist() for name in (*none, "flat")] == [[], [], []]
    assert run.zeros("one").tolist() == [times[10]]
    assert run.zeros("later").tolist() == [times[10]]
