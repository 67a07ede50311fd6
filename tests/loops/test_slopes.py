"""Derivatives of Burgers vectors by parameters of the frame."""

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import UnknownNameError
from tests.rounding import ROUNDED

SPREAD = "b/(2*pi)*(1 - exp(-((x - x0)**2 + (y - y0)**2)/w**2))/((x - x0)**2 + (y - y0)**2)"
CORE = gt.Frame(
    "x y z",
    [["1", "0", "0"], ["0", "1", "0"], [f"-(y - y0)*{SPREAD}", f"(x - x0)*{SPREAD}", "1"]],
    parameters="b x0 y0 w",
)
VALUES = {"b": 0.5, "x0": 0.1, "y0": 0.05, "w": 0.6}


def test_a_centred_core_has_a_closed_form():
    """b(R) = b (1 - exp(-R^2/w^2)), by b, w and, from symmetry, the position."""
    loop = gt.Loop.circle([0.1, 0.05, 0], 0.8)
    slopes = gt.burgers_derivatives(CORE, loop, ["b", "w", "x0"], parameters=VALUES)
    share = np.exp(-((0.8 / 0.6) ** 2))
    expected = {"b": 1 - share, "w": -0.5 * share * 2 * 0.8**2 / 0.6**3, "x0": 0.0}
    for name, value in expected.items():
        assert abs(slopes[name].vector[2] - value) <= slopes[name].error + 1e-15, name
        assert abs(slopes[name].vector[:2]).max() < ROUNDED
        assert slopes[name].error < 1e-12


@pytest.mark.parametrize("name", ["x0", "y0", "w"])
def test_differences_agree(name):
    """Off the centre, against differences of neighbours."""
    loop = gt.Loop.circle([0.3, 0.4, 0], 0.7)
    slope = gt.burgers_derivatives(CORE, loop, [name], parameters=VALUES)[name]
    up, down = (
        gt.burgers_vector(CORE, loop, parameters=VALUES | {name: VALUES[name] + h}).vector
        for h in (1e-4, -1e-4)
    )
    assert slope.vector == pytest.approx((up - down) / 2e-4, abs=1e-7)
    assert abs(slope.vector[2]) > 0.01


def test_balls_hold_the_derivative():
    """The proof of a Burgers vector also proves its derivative."""
    loop = gt.Loop.circle([0.3, 0.4, 0], 0.7)
    assert gt.prove(gt.burgers_derivatives(CORE, loop, ["w"], parameters=VALUES)["w"]).holds


def test_a_position_far_inside_does_not_matter():
    """The Burgers vector of a point-like dislocation only changes with b."""
    loop = gt.Loop.circle([0, 0, 0], 3)
    values = VALUES | {"w": 0.1}
    slopes = gt.burgers_derivatives(CORE, loop, ["b", "x0"], parameters=values)
    assert slopes["b"].vector[2] == pytest.approx(1, abs=1e-12)
    assert abs(slopes["x0"].vector).max() <= slopes["x0"].error + 1e-15


def test_a_coframe_that_shrinks():
    """A slope of -1 on the diagonal needs another multiple of the coordinates."""
    frame = gt.Frame("x y", [["-p", "0"], ["-y*p", "1"]], parameters="p")
    loop = gt.Loop.circle([0, 0], 1)
    slope = gt.burgers_derivatives(frame, loop, ["p"], parameters={"p": 2})["p"]
    assert slope.vector == pytest.approx([0, np.pi], abs=1e-12)


def test_unknown_names_are_refused():
    """Only parameters of the frame."""
    with pytest.raises(UnknownNameError, match="There are b, x0, y0, w"):
        gt.burgers_derivatives(CORE, gt.Loop.circle([0, 0, 0], 1), ["x"], parameters=VALUES)
