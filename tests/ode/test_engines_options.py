"""Options of engines that make no sense are refused by the constructor."""

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import ArgumentError

NAN, INF = float("nan"), float("inf")
NO_COUNTS = [0, -1, NAN, INF, 2.5, "5", None, True]


@pytest.mark.parametrize("engine", [gt.RungeKutta, gt.Stiff])
@pytest.mark.parametrize("value", NO_COUNTS)
def test_evaluations(engine, value):
    """The number of evaluations is a whole number from one on."""
    with pytest.raises(ArgumentError, match="max_evaluations: expected a whole number from 1 on"):
        engine(max_evaluations=value)


@pytest.mark.parametrize("value", NO_COUNTS)
def test_steps(value):
    """The number of steps is a whole number from one on."""
    with pytest.raises(ArgumentError, match="max_steps: expected a whole number from 1 on"):
        gt.Taylor(max_steps=value)


@pytest.mark.parametrize(
    "value", [0, -53, 52.5, NAN, INF, "53", None, 53.0, [53, 64], np.array([53, 64]), 54, 112, 401]
)
def test_bits(value):
    """The precision is a number of bits that heyoka supports."""
    with pytest.raises(ArgumentError, match="expected 53, 64 or a whole number from 113 to"):
        gt.Taylor(precision=value)


@pytest.mark.parametrize("value", ["x", "radau", None, 5, ["Radau"]])
def test_methods(value):
    """The method is one of two names."""
    with pytest.raises(ArgumentError, match="method: expected one of Radau, LSODA"):
        gt.Stiff(method=value)


def test_what_makes_sense_is_taken():
    """Values on the valid side of each bound are accepted."""
    assert [gt.Taylor(precision=bits).precision for bits in (53, 64, 113, 114, 400)]
    assert gt.Taylor(max_steps=1).max_steps == gt.Stiff("LSODA", 1).max_evaluations == 1
