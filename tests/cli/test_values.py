"""Numbers, names and pairs as people type them."""

import pytest

from geomtorsion.cli.values import engine_of, named_numbers, numbers, parts, start_options
from geomtorsion.errors import StartError, UnknownNameError
from tests.cli.running import run


def test_numbers():
    """Blanks, fractions and constants are read; an empty entry is refused."""
    assert numbers(" 1/2 , -1e-3,2*pi", "start") == pytest.approx([0.5, -1e-3, 6.283185307])
    assert numbers(None, "start") is None
    with pytest.raises(StartError, match="start: expected a number"):
        numbers("1,,2", "start")


def test_pairs():
    """Pairs are in one text or in several; a repeated name is refused."""
    assert named_numbers(["M = 1,a=1/2"]) == {"M": 1.0, "a": 0.5}
    assert named_numbers([]) == {}
    assert named_numbers(["M=1", "a=2, b=3"]) == {"M": 1.0, "a": 2.0, "b": 3.0}
    with pytest.raises(StartError, match="expected M once, got it twice"):
        named_numbers(["M=1", "M=2"])


@pytest.mark.parametrize(
    "arguments",
    [
        ("curve", "s2", "--start", "x" * 5000),
        ("curve", "s2", "--set", "x" * 5000),
        ("curve", "s2", "--engine", "x" * 5000),
        ("burgers", "s2", "--circle", "x" * 5000),
        ("run", "helix", "--set", "x" * 5000),
        ("paper", "--format", "x" * 5000),
    ],
)
def test_long_texts_are_cut(arguments):
    """A message quotes only the beginning of a long text."""
    assert len(run(*arguments, code=2).stderr) < 1000


def test_words():
    """Blanks and empty words are dropped."""
    assert parts(" torsion,,ricci , ") == ("torsion", "ricci")


def test_engines():
    """Names of engines ignore case; auto leaves the choice to the solver."""
    assert engine_of("auto") is None
    for name in ("rungekutta", "RungeKutta"):
        engine = engine_of(name)
        assert engine is not None
        assert engine.name == "RungeKutta"
    with pytest.raises(UnknownNameError, match="auto, taylor, rungekutta, stiff"):
        engine_of("magic")


def test_starts():
    """A missing option is None; errors name the option."""
    options = start_options("pi,0", None, "1,2", "2*pi", ["R=1/2", "M=2"], None)
    assert options == {
        "start": [pytest.approx(3.141592653589793), 0.0],
        "velocity": None,
        "frame_velocity": [1.0, 2.0],
        "t": pytest.approx(6.283185307179586),
        "parameters": {"R": 0.5, "M": 2.0},
        "moments": None,
        "force": None,
        "potential": None,
    }
    with pytest.raises(StartError, match="frame velocity: expected a number"):
        start_options(None, None, "fast", None, None, None)
