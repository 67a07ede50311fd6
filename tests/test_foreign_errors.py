"""Foreign errors: what a library or Python would raise about input is refused in our words."""

from pathlib import Path

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import BodyError, ExpressionError, FileFormatError, GeomtorsionError
from geomtorsion.materials.fields.large_arrays import opened
from geomtorsion.materials.readers import is_array
from tests.cli.running import run
from tests.rounding import ROUNDED

r, phi = sp.symbols("r phi", positive=True)
HUGE = 1.7e308


@pytest.mark.parametrize("number", ["0.__1", "1__0", "1_", "1_.5", "1._5", "0.1_"])
def test_an_underscore_is_only_between_digits(number):
    """Other underscores in a number are refused in expressions, with the number."""
    with pytest.raises(ExpressionError, match=f"{number} is not a number: underscores may"):
        gt.parse_expression(f"{number}*r", {"r": r})


def test_grouped_digits_are_a_number():
    """Single underscores between digits group them."""
    assert gt.parse_expression("1_000*r", {"r": r}) == 1000 * r


@pytest.mark.parametrize(
    "arguments",
    [
        ("burgers", "so3", "--circle", "0.__1,1,0:0.1"),
        ("curve", "s2", "--start", "1__0,0", "--velocity", "1,0", "--t", "1"),
        ("curve", "s2", "--start", "1,0", "--velocity", "1,0", "--t", "1", "--moments", "1_,2"),
        ("map", "{}", "--sigma", "0_.1", "-o", "out"),
        ("map", "{}", "--steps", "1__0,1", "-o", "out"),
        ("run", "lagrange_cusp", "--t", "1__0"),
        ("run", "lagrange_cusp", "--set", "gravity.g=1__0"),
    ],
    ids=lambda x: x[2],
)
def test_options_with_stray_underscores(arguments, tmp_path, monkeypatch):
    """Numbers that only Python would accept, or nobody, are refused as options."""
    monkeypatch.chdir(tmp_path)
    np.save("a.npy", np.zeros((2, 2, 20, 20)))
    error = run(*(x.format("a.npy") for x in arguments), code=2).stderr
    assert error.startswith("geomtorsion: ")
    assert "_" in error


@pytest.mark.parametrize(
    "make",
    [
        lambda: gt.Body.cylinder(1, 1, HUGE),
        lambda: gt.Body.cylinder(1, HUGE, 0),
        lambda: gt.Body.box(HUGE, (HUGE, 1, 1)),
        lambda: gt.Body.ellipsoid(1, (1, HUGE, 1)),
        lambda: gt.Body.points([(HUGE, (1, 0, 0)), (HUGE, (-1, 0, 0)), (1, (0, 1, 0))]),
        lambda: gt.Body.points([(1, (HUGE, 0, 0)), (1, (-1, 0, 0)), (1, (0, 1, 0))]),
    ],
)
def test_bodies_whose_moments_overflow(make):
    """Finite masses and lengths whose moments exceed all floats are refused."""
    with pytest.raises(BodyError, match="fit into a float, below 1.8e308, got larger ones"):
        make()


@pytest.mark.parametrize("seconds", [1e200, 1e300])
def test_times_whose_states_overflow(seconds):
    """A motion that exceeds the range of floats on its way ends in our own error."""
    with pytest.raises(GeomtorsionError):
        gt.scenes.load("rolling_disc").with_values(t=seconds).run()


@pytest.mark.parametrize(
    ("place", "byte"), [(8, 1), (10, 10), (20, 40), (21, 44), (15, 10), (60, 95), (8, 255)]
)
def test_damaged_headers_of_arrays(place, byte, tmp_path: Path):
    """A header that NumPy reads as Python is refused when it is damaged."""
    path = tmp_path / "a.npy"
    np.save(path, np.zeros((2, 2, 10, 10)))
    content = bytearray(path.read_bytes())
    content[place] = byte
    path.write_bytes(content)
    with pytest.raises(FileFormatError, match="it is truncated or has another format"):
        opened(str(path))
    assert not is_array(path)


@pytest.mark.parametrize(
    "text",
    [
        "airyai(airyai(airybi(r)))",
        "airybiprime(airyai(r))",
        "airyaiprime(airybiprime(airyai(r)))",
        "besselj(0, airyai(r)) + erf(airybi(r))",
        "besselj(0, airybi(besselj(1, r)))",
        "erf(besselj(0, airyai(r)))",
    ],
)
def test_nested_special_functions(text):
    """The curvature of the metric dr^2 + f^2 dphi^2 is -2 f''/f, also for nested functions f."""
    f = gt.parse_expression(text, {"r": r})
    scalar = gt.levi_civita(gt.Frame([r, phi], [[1, 0], [0, f]])).curvature.scalar
    place = {r: sp.Rational(13, 10), phi: 0}
    expected = (-2 * f.diff(r, 2) / f).subs(r, place[r]).evalf(30)
    assert abs(scalar.at(place, digits=20) - expected) < ROUNDED * max(1, abs(expected))
