"""Derivatives of developments by parameters of frame and loop, against closed forms."""

import math
from collections.abc import Callable

import numpy as np
import pytest
import sympy as sp
from scipy.special import j0

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError

THETA, PHI, X, Y, Z = sp.symbols("theta phi x y z")
RADIUS = sp.Symbol("R", positive=True)
SPHERE = gt.levi_civita(
    gt.Frame([THETA, PHI], sp.diag(RADIUS, RADIUS * sp.sin(THETA)), parameters=[RADIUS])
)
DISC = gt.Loop.circle([1.0, 1.0], sp.Symbol("r"))
VALUES = {"R": 2, "r": 0.5}
SCREW = gt.cartan(gt.spaces.load("screw_dislocation").frame)


def test_the_turn_of_a_growing_disc_on_a_sphere() -> None:
    """The angle is the integral of sin(theta) over the disc; its derivative is 2 pi r sin(1) J0(r).

    The angle does not depend on the radius of the sphere, and the translation is linear in it.
    """
    slopes = gt.loops.development_derivatives(SPHERE, DISC, ["r", "R"], parameters=VALUES)
    whole = gt.develop(SPHERE, DISC, parameters=VALUES)
    exact = 2 * math.pi * 0.5 * math.sin(1) * j0(0.5)
    # dR = (generator of turns) R d(angle).
    turned = slopes["r"].rotation @ np.linalg.inv(whole.rotation)
    assert abs(abs(turned[0, 1]) - exact) <= 2 * slopes["r"].turn_error
    assert slopes["r"].turn_error < 1e-10
    assert abs(turned[0, 0]) <= 2 * slopes["r"].turn_error
    assert np.abs(slopes["R"].rotation).max() <= slopes["R"].turn_error
    assert np.abs(slopes["R"].burgers - whole.burgers / 2).max() <= (
        slopes["R"].error + whole.error
    )


def test_a_dislocation() -> None:
    """b of a screw dislocation is its parameter, for any radius of the loop."""
    loop = gt.Loop.circle([0, 0, 0], sp.Symbol("r"))
    slopes = gt.loops.development_derivatives(SCREW, loop, ["b", "r"], parameters={"b": 3, "r": 2})
    assert np.abs(slopes["b"].burgers - [0, 0, 1]).max() <= slopes["b"].error < 1e-9
    assert np.abs(slopes["r"].burgers).max() <= slopes["r"].error < 1e-9
    one = gt.burgers_derivatives(SCREW.frame, gt.Loop.circle([0, 0, 0], 2), ["b"],
                                 parameters={"b": 3})  # fmt: skip
    assert slopes["b"].burgers == pytest.approx(one["b"].vector, abs=1e-9)


def test_flat_space_at_zero() -> None:
    """A parameter that is zero; a development that does not depend on a parameter."""
    c = sp.Symbol("c")
    flat = gt.Frame([X, Y], [[1, c * X], [0, 1]], parameters=[c])
    loop = gt.Loop.circle([0, 0], 1)
    slope = gt.loops.development_derivatives(gt.cartan(flat), loop, ["c"], parameters={"c": 0})["c"]
    # The loop integral of x dy is the area.
    assert abs(slope.burgers[0] - math.pi) <= slope.error < 1e-10
    assert slope.burgers[1] == 0
    assert not slope.rotation.any()


def test_equal_calls_give_equal_bits() -> None:
    one, two = (
        gt.loops.development_derivatives(SPHERE, DISC, ["r"], parameters=VALUES)["r"]
        for _ in range(2)
    )
    assert np.array_equal(one.burgers, two.burgers)
    assert one.error == two.error


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: gt.loops.development_derivatives(SPHERE, DISC, ["q"], parameters=VALUES), "q"),
        (lambda: gt.loops.development_derivatives(SPHERE, DISC, ["r"]), "r"),
        (lambda: gt.loops.development_derivatives(SPHERE, DISC, "r", parameters=VALUES), "list"),
    ],
)
def test_refusals(call: Callable[[], object], words: str) -> None:
    """Unknown names and missing numbers are errors of the package."""
    with pytest.raises(GeomtorsionError, match=words):
        call()
