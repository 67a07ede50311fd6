"""Line elements and one-forms typed where a command expects a space."""

import pytest

import geomtorsion as gt
from geomtorsion.cli.exits import ExitCode
from tests.cli import running


@pytest.mark.parametrize(
    ("text", "coordinates", "parameters"),
    [
        ("dr^2 + r^2 dtheta^2", "r theta", ""),
        ("ds^2 = -dt^2 + dx^2", "t x", ""),
        ("-(1 - 2M/r) dt^2 + dr^2/(1 - 2M/r) + r^2 dOmega^2", "t r theta phi", "M"),
        ("-(1 - 2*M/r)*dt**2 + dr**2/(1 - 2*M/r) + r**2 dΩ^2", "t r θ φ", "M"),
        ("R^2 dOmega_2^2", "theta phi", "R"),
        ("-dt^2 + a(t)^2 dx^2", "t x", ""),
        ("-2 du dv + exp(k*u) dx^2", "u v x", "k"),
        ("delta^2 dx^2 + pi dy^2", "x y", "delta"),
        ("dr, r dtheta", "r theta", ""),
        ("dx - z dy, dy, dz", "x y z", ""),
        ("exp(-b*y) dx, dy", "x y", "b"),
    ],
)
def test_names_are_read_from_the_text(text: str, coordinates: str, parameters: str) -> None:
    frame = gt.spaces.load(text).frame
    assert " ".join(map(str, frame.coordinates)) == coordinates
    assert " ".join(map(str, frame.parameters)) == parameters
    if "," in text:
        assert (
            frame.coframe
            == gt.Frame(coordinates, text.split(","), parameters=parameters.split()).coframe
        )
    else:
        assert (
            frame.metric
            == gt.Frame.from_metric(coordinates, text, parameters=parameters.split()).metric
        )


def test_line_elements_may_begin_with_a_minus() -> None:
    """The metric that everybody types first: a vacuum, and flat space."""
    hole = "-(1 - 2M/r) dt^2 + dr^2/(1 - 2M/r) + r^2 dOmega^2"
    assert "= 0" in running.run("geometry", hole, "--only", "ricci").stdout
    assert running.run("identify", hole).stdout.startswith("schwarzschild: ")
    assert running.run("identify", "-dt^2 + dx^2").stdout.startswith("flat ")


def test_commands_on_a_typed_space() -> None:
    shown = running.run("geometry", "dr, r dtheta", "--only", "torsion").stdout
    assert "1/(2*r)" in shown
    same = running.run("same", "dx^2 + dy^2", "dr^2 + r^2 dphi^2").stdout
    assert same.startswith("same: ")
    assert "so(3)" in running.run("symmetries", "dtheta^2 + sin(theta)^2 dphi^2").stdout


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("dr^2 + dr", "quadratic in dr"),
        ("dr^2 +", "missing after +"),
        ("dr, dr^2", "linear"),
        ("dr, r", "linear in dr"),
        ("dx^2 + __import__('os') dy^2", "expressions are not code"),
    ],
)
def test_refusals(text: str, words: str) -> None:
    result = running.run("geometry", text, code=ExitCode.wrong_input)
    assert words in result.stderr


def test_a_line_element_may_be_longer_than_a_file_name() -> None:
    """Systems refuse names of files above 255 letters."""
    long = "dx^2 + " + " + ".join(["0*x^2*dx^2"] * 40) + " + dy^2"
    assert "= 0" in running.run("geometry", long, "--only", "ricci").stdout
