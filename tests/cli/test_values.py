"""Numbers, names and pairs as people type them."""

import pytest

from geomtorsion.cli.values import named_numbers, numbers, parts
from geomtorsion.errors import StartError
from tests.cli.running import run


def test_numbers():
    """Blanks, fractions and constants; nothing else."""
    assert numbers(" 1/2 , -1e-3,2*pi", "start") == pytest.approx([0.5, -1e-3, 6.283185307])
    assert numbers(None, "start") is None
    with pytest.raises(StartError, match="came"):
        numbers("1,,2", "start")


def test_pairs():
    """In one text or in several; a name is given once."""
    assert named_numbers(["M = 1,a=1/2"]) == {"M": 1.0, "a": 0.5}
    assert named_numbers([]) == {}
    assert named_numbers(["M=1", "a=2, b=3"]) == {"M": 1.0, "a": 2.0, "b": 3.0}
    with pytest.raises(StartError, match="given twice"):
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
    """What came is recognised by its beginning."""
    assert len(run(*arguments, code=2).stderr) < 1000


def test_words():
    """Blanks and empty words are dropped."""
    assert parts(" torsion,,ricci , ") == ("torsion", "ricci")
