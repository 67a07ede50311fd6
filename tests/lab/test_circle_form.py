"""Circle form: the Burgers vector of a circle in closed form, as it is shown."""

import pytest
import sympy as sp

from geomtorsion.errors import ExpressionError, LoopError, UndecidedError
from geomtorsion.lab.circle_form import circle_form
from geomtorsion.lab.costs import costs
from geomtorsion.loops import Loop, burgers_vector
from geomtorsion.spaces import load


@pytest.mark.parametrize(
    ("space", "centre"),
    [("so3", ["1/10", "1", "1/5"]), ("heisenberg", ["1", "2", "3"]), ("s2", ["1", "1/2"])],
)
def test_as_in_numbers(space: str, centre: list[str]):
    """The closed form at R = 3/10 against the line integral of the library, in floats."""
    values = {"R": 1.0} if space == "s2" else {}
    radius = "3/10" if space == "s2" else "R"
    found = circle_form(space, centre, radius)["b"]
    at = [float(sp.Rational(x)) for x in centre]
    right = burgers_vector(load(space).frame, Loop.circle(at, 0.3), parameters=values)
    table = {"R": 1.0 if space == "s2" else 0.3}
    for text, value in zip(found, right.vector, strict=True):
        assert float(sp.S(text).subs(table)) == pytest.approx(value, abs=1e-12)


def test_a_radius_is_no_parameter_of_the_space():
    """On the sphere of radius R the circle has another name: 2 pi R rho J1(rho) cos(theta)."""
    [_, b] = circle_form("s2", ["1/2", "0"])["b"]
    assert b == "2*pi*R*rho*cos(1/2)*besselj(1, rho)"
    assert "rho" not in circle_form("so3", ["0", "1", "0"])["b"][0]


def test_round_the_axis_of_polar_coordinates_there_is_no_circle_in_them():
    """The picture is of the circle about the axis; another one would pass for its closed form."""
    case = {"space": "wedge_disclination", "centre": [0, 0, 0], "radius": 0.3, "plane": [0, 1]}
    with pytest.raises(LoopError, match="off the axis"):
        circle_form("wedge_disclination", ["0", "0", "0"])
    with pytest.raises(LoopError, match="off the axis"):
        costs("loop", case)


def test_what_is_said():
    """Of a line, of torsion that is the same everywhere, of none, and of any other."""
    said = {
        space: circle_form(space, centre)["sentence"]
        for space, centre in (
            ("screw_dislocation", ["0"] * 3), ("heisenberg", ["0"] * 3), ("sol", ["0"] * 3),
            ("so3", ["0", "1", "0"]),
        )
    }  # fmt: skip
    assert "runs round a line" in said["screw_dislocation"]
    assert "b is 2 S A, exactly" in said["heisenberg"]
    assert "b = 0, exactly" in said["sol"]
    assert "the closer b comes" in said["so3"]


def test_what_cannot_be_read():
    """Decimals, too few places, unknown names, circles that may meet a pole."""
    with pytest.raises(ExpressionError, match="Write 3/10"):
        circle_form("so3", ["0.3", "1", "0"])
    with pytest.raises(LoopError, match="needs 3 coordinates"):
        circle_form("so3", ["0"])
    with pytest.raises(ExpressionError, match="neither"):
        circle_form("so3", ["q", "1", "0"])
    with pytest.raises(UndecidedError, match="changes along"):
        circle_form("screw_dislocation", ["2", "0", "0"])
