"""Batches: the grouping of members affects speed, not results."""

import numpy as np
import pytest

from geomtorsion.ode import ODE, RungeKutta, Taylor, solve_many
from tests.ode.engines import needs_heyoka

# The root ends where x = 0: two of the members fall that far, the others rise.
FALL = ODE.of({"x": "v", "v": "-sqrt(x)"}, [1, 0])
STARTS = {"x": np.linspace(0.1, 1, 12), "v": np.linspace(0, 10, 12)}


@pytest.mark.parametrize(
    ("constant", "values", "engine"),
    [
        ("stacked.STACKED", (2, 100), RungeKutta()),
        pytest.param("taylor.FEW", (0, 100), Taylor(), marks=needs_heyoka),
        pytest.param("registers.MOST_STEPS", (1, 10**6), Taylor(), marks=needs_heyoka),
    ],
    ids=["states in a stack", "registers", "steps between two looks"],
)
@pytest.mark.parametrize("times", [3.0, [1.0, 3.0]], ids=["one time", "several"])
def test_groups_of_members(constant, values, engine, times, monkeypatch):
    """Small and large groups give the same finished members and the same results."""
    found = []
    for value in values:
        monkeypatch.setattr(f"geomtorsion.ode.engines.{constant}", value)
        found.append(solve_many(FALL, STARTS, times, 1e-8, engine))
    one, two = found
    assert one.finished.tolist() == two.finished.tolist() == [False] * 2 + [True] * 10
    assert one["x"] == pytest.approx(two["x"], rel=2e-8, nan_ok=True)
