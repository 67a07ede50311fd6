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
