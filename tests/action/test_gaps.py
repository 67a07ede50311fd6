"""Gaps of varied paths: closed forms, and the varied path itself as an independent run."""

# Bad input is given on purpose.
# pyright: reportArgumentType=false

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import ExpressionError, GeomtorsionError, ShapeError

SO3 = gt.spaces.load("so3").frame
BAR = gt.variation(SO3, "closed_in_image")
# u = (0, 0, w): the first angle turns about the third axis.
TURNING = gt.ODE.of({"phi1": "w", "phi2": 0, "phi3": 0}, [0, 1, 0], parameters={"w": 1.5})


def test_constant_variation_in_closed_form():
    """b' = -u x (dPhi + b) with constant u and dPhi: dPhi + b turns, |b| = 2 |dPhi| sin(w t/2)."""
    times = np.linspace(0, 3, 7)
    found = gt.solve(BAR.gap_ode(TURNING, ["1/10", 0, 0]), times, 1e-12)
    angle = 1.5 * times
    assert np.abs(found["b1"] - 0.1 * (np.cos(angle) - 1)).max() < 1e-13
    assert np.abs(found["b2"] + 0.1 * np.sin(angle)).max() < 1e-13
    size = np.hypot(found["b1"], found["b2"])
    assert np.abs(size - 0.2 * np.abs(np.sin(angle / 2))).max() < 1e-13
    assert found.error < 1e-12


@pytest.mark.parametrize("name", ["so3", "flat_polar", "heisenberg"])
def test_gap_equals_the_gap_of_the_varied_path(name):
    """Paths with the velocities u + eps dPhi' end b eps apart, in first order of eps."""
    frame = gt.spaces.load(name).frame
    bar = gt.variation(frame, "closed_in_image")
    n, t = frame.dimension, sp.Symbol("t")
    speeds = [sp.Rational(k + 2, 5) + sp.Rational(1, 4) * sp.cos(t + k) for k in range(n)]
    bumps = [sp.sin(sp.pi * t / 2) * (1 + k * t) / 3 for k in range(n)]
    start = [sp.Rational(4 + k, 5) for k in range(n)]
    legs, q = frame.legs, frame.coordinates

    def motion(share: sp.Rational) -> gt.ODE:
        u = [x + share * y.diff(t) for x, y in zip(speeds, bumps, strict=True)]
        rates = {q[m].name: sp.Add(*(legs[m, i] * u[i] for i in range(n))) for m in range(n)}
        return gt.ODE.of(rates, start)

    found = gt.solve(bar.gap_ode(motion(sp.S.Zero), bumps), 2.0, 1e-12)
    eps = sp.Rational(1, 4096)
    ends = [gt.solve(motion(s * eps), 2.0, 1e-13).states[-1] for s in (-1, 1)]
    change = (ends[1] - ends[0]) / (2 * float(eps))
    place = {x: float(v) for x, v in zip(q, found.states[-1][:n], strict=True)}
    coframe = np.array(
        [[float(frame.coframe[i, m].subs(place)) for m in range(n)] for i in range(n)]
    )
    b = np.array([found[symbol.name][-1] for symbol in bar.gaps])
    assert np.abs(found["moved"][-1] - change).max() < 1e-6
    assert np.abs(coframe @ change - b).max() < 1e-6
    assert np.abs(b).max() > 0.05


def test_gap_beside_a_body():
    """Beside Euler's top the velocities are states, and the energy stays an invariant."""
    equations = gt.equations_of_motion(SO3, "(2*u1**2 + 3*u2**2 + u3**2)/2")
    top = gt.ODE.of(equations, [0.1, 1.0, 0.2, 0.5, 0.4, 1.0])
    beside = BAR.gap_ode(top, ["sin(pi*t)", "t*(1 - t)", 0])
    u = sp.symbols("u1:4", real=True)
    assert [str(x) for x in beside.outputs["frame_velocity"]] == [str(x) for x in u]
    found = gt.solve(beside, 1.0, 1e-11)
    assert max(found.drift.values()) < 1e-11
    assert np.abs([found[f"b{k}"][-1] for k in (1, 2, 3)]).max() > 0.1


def test_no_gap_without_torsion_or_in_coordinates():
    """Images without torsion and variations that close in coordinates have no gap."""
    for bar in (
        gt.variation(SO3),
        gt.variation(SO3, "closed_in_image", gt.levi_civita(SO3)),
        gt.variation(gt.Frame(sp.symbols("phi1:4"), sp.eye(3)), "closed_in_image"),
    ):
        found = gt.solve(bar.gap_ode(TURNING, ["sin(t)", "t", 1]), 1.0, 1e-10)
        assert np.abs([found[f"b{k}"] for k in (1, 2, 3)]).max() == 0


def test_parameters_of_images_and_stops():
    """An image may have a parameter of its own; a stop of the motion stays."""
    path = gt.ODE.of({"phi1": 1, "phi2": 0, "phi3": 0}, [0, 1, 0], events=[gt.When("1 - phi1")])
    found = gt.solve(BAR.gap_ode(path, ["size", 0, 0], parameters={"size": 0.5}), 3.0)
    assert found.outcome == "stopped"
    assert abs(found["b1"][-1] - 0.5 * (np.cos(1) - 1)) < 1e-9


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: BAR.gap_ode(3, [0, 0, 0]), GeomtorsionError, "expected an ODE"),
        (
            lambda: BAR.gap_ode(gt.ODE.of({"x": 1}, [0]), [0, 0, 0]),
            ShapeError,
            "phi1, phi2, phi3 among its states, got x",
        ),
        (
            lambda: BAR.gap_ode(TURNING, [0, 0]),
            ShapeError,
            "images: expected one for each of 3 legs",
        ),
        (lambda: BAR.gap_ode(TURNING, 5), ShapeError, "images: expected a list"),
        (lambda: BAR.gap_ode(TURNING, ["q", 0, 0]), ExpressionError, r"images\[0\]"),
        (lambda: BAR.gap_ode(TURNING, [sp.Symbol("q"), 0, 0]), ExpressionError, "got 'q'"),
        (
            lambda: BAR.gap_ode(
                gt.ODE.of({"phi1": "b1", "phi2": 0, "phi3": 0, "b1": 0}, [0, 1, 0, 1]), [0, 0, 0]
            ),
            ExpressionError,
            "names other than b1",
        ),
    ],
)
def test_refusals(call, error, words):
    """Each message names the expected value."""
    with pytest.raises(error, match=words):
        call()
