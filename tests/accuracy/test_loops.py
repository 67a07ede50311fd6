"""Accuracy on loops: measured errors agree with theory."""

import mpmath
import numpy as np
import pytest

from geomtorsion.accuracy.loops import RULES, loop_costs, reference
from geomtorsion.errors import LoopError
from geomtorsion.loops import Loop
from geomtorsion.spaces import load

FRAME = load("so3").frame
CENTRE = [0.3, 1, 0.2]


def errors(costs, rule: str) -> dict[int, float]:
    """Points -> error of one rule."""
    return {row.points: row.error for row in costs.rows if row.rule == rule}


def test_rules_on_a_circle() -> None:
    """The trapezoid rule needs 16 points where Gauss needs 24 and Clenshaw-Curtis 32."""
    costs = loop_costs(FRAME, Loop.circle(CENTRE, 0.3), points=(8, 16, 24, 32))
    assert errors(costs, "trapezoid")[16] < 1e-14 < errors(costs, "Gauss")[16]
    assert errors(costs, "Gauss")[24] < 1e-13 < errors(costs, "Clenshaw-Curtis")[24]
    assert errors(costs, "Clenshaw-Curtis")[32] < 1e-13
    assert errors(costs, "flux")[96] < 1e-14
    assert {row.rule for row in costs.rows} == set(RULES)
    ours = [row for row in costs.rows if row.rule == "burgers_vector"]
    for row in ours:
        assert row.asked is not None
        assert row.claimed is not None
        assert row.error <= row.asked
        assert row.error <= 10 * row.claimed
    table = str(costs).splitlines()
    assert len(table) == len(costs.rows) + 2


def test_the_direct_sum_loses_a_digit_for_every_decade() -> None:
    """Slope of log error over decades of the radius: 1 for the line integral, 0 for the flux."""
    decades = (3, 5, 7, 9)
    lines, fluxes = [], []
    for decade in decades:
        circle = Loop.circle(CENTRE, 10.0**-decade)
        costs = loop_costs(FRAME, circle, rules=["trapezoid", "flux"], points=(16, 24, 32))
        lines.append(np.log10(np.mean(list(errors(costs, "trapezoid").values()))))
        fluxes.append(max(errors(costs, "flux").values()))
    assert np.polyfit(decades, lines, 1)[0] == pytest.approx(1, abs=0.25)
    assert max(fluxes) < 1e-14


def test_polygons() -> None:
    """Six Gauss points per side are enough; equidistant points are not."""
    triangle = Loop.polygon([CENTRE, [0.4, 1, 0.2], [0.4, 1.1, 0.2]])
    costs = loop_costs(FRAME, triangle, rules=["trapezoid", "Gauss", "flux"], points=(6, 12))
    assert errors(costs, "Gauss")[18] < 1e-13
    assert errors(costs, "trapezoid")[36] > 1e-3
    assert costs.cheapest(1e-10) is not None
    assert costs.cheapest(1e-30) is None


def test_the_reference_has_its_digits() -> None:
    """The reference has 45 right digits, compared with a Bessel function."""
    found = reference(FRAME, Loop.circle(CENTRE, 0.5))
    with mpmath.workdps(50):
        half, place = mpmath.mpf(1) / 2, mpmath.mpf(3) / 10
        exact = 2 * mpmath.pi * half * mpmath.besselj(1, half) * mpmath.cos(place)
        assert abs(found[0] - exact) < mpmath.mpf(10) ** -45


def test_bad_requests() -> None:
    """Unknown rules, loops without a relative error and loops from numbers only are refused."""
    with pytest.raises(LoopError, match="got 'Simpson'"):
        loop_costs(FRAME, Loop.circle(CENTRE, 1), rules=["Simpson"])
    with pytest.raises(LoopError, match="vanishes"):
        loop_costs(load("flat_polar").frame, Loop.polygon([[1, 0], [1, 2], [1, 1]]))
    # At fifty digits a vanishing vector is about 1e-55.
    with pytest.raises(LoopError, match="vanishes"):
        loop_costs(load("heisenberg").frame, Loop.circle([0, 0, 0], 0.3, (1, 2)))
    with pytest.raises(LoopError, match="known by numbers only"):
        loop_costs(FRAME, Loop.spline([[0, 1, 0], [1, 1, 0], [0, 2, 0]]))
