"""reductions: which smaller systems are offered, and that they are the same motion."""

import numpy as np

from geomtorsion.curves import geodesic, reductions
from geomtorsion.ode import RungeKutta, solve
from geomtorsion.spaces import load


def orbit():
    """A bound orbit around a turning hole, in one chart."""
    problem = geodesic(
        load("kerr").frame, [0, 8, 1.4, 0], frame_velocity=[1.2, 0.05, 0.2, 0.6],
        parameters={"M": 1, "a": 0.6},
    )  # fmt: skip
    return problem.with_charts("kerr", "ingoing")


def test_how_long_rates_may_be(monkeypatch):
    """Those of Kerr, of 80 values, get smaller systems, those of 101 in another chart do not."""
    problem = orbit()
    assert problem.reductions("kerr").offered
    assert not problem.reductions("ingoing").offered
    found = solve(problem, 20.0, 1e-8, RungeKutta())
    monkeypatch.setattr(reductions, "LONGEST", 0)
    full = orbit()
    assert not full.reductions("kerr").offered
    other = solve(full, 20.0, 1e-8, RungeKutta())
    assert np.abs(found.coordinates - other.coordinates).max() <= 8 * (found.error + other.error)
