"""Numbers with their errors, in one form: rounded by the error, with the unit."""

import math

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.support.outgoing import count_text, measured_text


@pytest.mark.parametrize(
    ("values", "errors", "unit", "text"),
    [
        # The digits of the error end the number (rule of the Particle Data Group, two digits).
        (3.14159, 0.012, "", "3.142 +- 0.012"),
        (3.14159, 0.0996, "", "3.14 +- 0.10"),
        (3.14159, 12.3, "nm", "3 +- 12 nm"),
        (1234.5, 321.0, "nm", "1234 +- 321 nm"),
        (-0.001, 0.5, "", "0.00 +- 0.50"),
        (1234567.0, 23000.0, "um^-2", "(1.235 +- 0.023)e+06 um^-2"),
        (1.6e-19, 2e-21, "C", "(1.600 +- 0.020)e-19 C"),
        (0.0, 3e-12, "", "(0.0 +- 3.0)e-12"),
        # A circuit in noise: components of the same size as their errors.
        ([-2.19047, 14.6524, 5.21051], [22.0, 22.0, 22.0], "um", "(-2, 15, 5) +- 22 um"),
        ([-2.19047, 14.6524], [22.0, 3.1], "um", "(-2 +- 22, 14.7 +- 3.1) um"),
        ([1e-9, 2e-9], [1e-10, 2e-10], "m", "(1.00 +- 0.10, 2.00 +- 0.20)e-09 m"),
        # Calculated numbers with many digits.
        (math.pi, 1e-13, "", "3.1415926535898 +- 1.0e-13"),
        ([3.0012e-24, 0.0], 1e-37, "", "(3.0012e-24, 0) +- 1.0e-37"),
        # No error, no noise, nothing.
        (2.5, 0.0, "nm", "2.5 nm"),
        (0.0, 0.0, "", "0"),
        (1.5, math.nan, "", "1.5, error unknown"),
        (math.inf, 1.0, "", "inf, error unknown"),
        ([], [], "", "()"),
    ],
)
def test_value_and_error(values, errors, unit, text):
    """Value and error have the same last digit; the unit follows both."""
    assert measured_text(values, errors, unit) == text


@pytest.mark.parametrize("seed", range(5))
def test_the_text_is_the_number(seed):
    """The written number is within half of the last digit of the error, for all sizes."""
    rng = np.random.default_rng(seed)
    for value, error in zip(rng.normal(size=200), 10 ** rng.uniform(-5, 1, 200), strict=True):
        scale = 10.0 ** rng.integers(-12, 12)
        text = measured_text(value * scale, error * scale)
        power = float("1e" + text.split("e")[1]) if ")e" in text else 1.0
        number, spread = text.split(")")[0].strip("(").split(" +- ")
        assert abs(float(number) * power - value * scale) <= 0.051 * error * scale
        assert abs(float(spread) * power / (error * scale) - 1) < 0.051


def test_counts():
    """One thing is singular."""
    assert [count_text(n, "node") for n in (0, 1, 2, 1500)] == [
        "0 nodes", "1 node", "2 nodes", "1,500 nodes",
    ]  # fmt: skip
    line = gt.LineArrays([[0, 0, 0]], [[0, 0]], [[0, 0, 1]],
                         gt.Box.of_bounds([0] * 3, [1] * 3), images=[[0, 0, 1]])  # fmt: skip
    assert repr(line) == "LineArrays(1 node, 1 line)"
    net = gt.DislocationNetwork.of_arrays(line)
    assert repr(net) == "DislocationNetwork(1 node, 1 line)"
    frame = gt.SampledFrame([np.arange(8.0)] * 2, np.zeros((1, 2, 8, 8)))
    assert "1 row," in repr(frame)


def test_results_in_noise_show_no_more_digits_than_they_have():
    """A circuit in noise prints value and error together, rounded by the error."""
    axes = [np.linspace(0, 10, 21)] * 2
    noise = 22 / 10 * np.random.default_rng(0).normal(size=(3, 2, 21, 21))
    frame = gt.SampledFrame(axes, noise, sigma=2.2, unit="um")
    b = frame.burgers(gt.Loop.circle([5, 5], 3))
    assert b.text in repr(b)
    assert b.text.endswith(" um")
    numbers, spread = b.text.removesuffix(" um").split(" +- ")
    assert len(spread.replace(".", "").strip("0")) <= 2
    for number, value, error in zip(numbers[1:-1].split(", "), b.vector, b.errors, strict=True):
        assert abs(float(number) - value) < 0.051 * error
