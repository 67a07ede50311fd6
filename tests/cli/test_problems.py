"""Engines and starts as they are typed."""

import pytest

from geomtorsion.cli.problems import engine_of, start_options
from geomtorsion.errors import StartError, UnknownNameError


def test_engines():
    """By name in any case; auto leaves the choice to the solver."""
    assert engine_of("auto") is None
    for name in ("rungekutta", "RungeKutta"):
        engine = engine_of(name)
        assert engine is not None
        assert engine.name == "RungeKutta"
    with pytest.raises(UnknownNameError, match="auto, taylor, rungekutta, stiff"):
        engine_of("magic")


def test_starts():
    """What is not given stays open; errors name the option."""
    options = start_options("pi,0", None, "1,2", "2*pi", ["R=1/2", "M=2"], None)
    assert options == {
        "start": [pytest.approx(3.141592653589793), 0.0],
        "velocity": None,
        "frame_velocity": [1.0, 2.0],
        "t": pytest.approx(6.283185307179586),
        "parameters": {"R": 0.5, "M": 2.0},
        "moments": None,
    }
    with pytest.raises(StartError, match="frame velocity: a number was needed"):
        start_options(None, None, "fast", None, None, None)
