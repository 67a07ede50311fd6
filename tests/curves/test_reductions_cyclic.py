"""cyclic: momenta stand in the place of velocities where they hold all of their digits."""

import numpy as np
import pytest
import sympy as sp

from geomtorsion import Frame
from geomtorsion.curves import geodesic
from geomtorsion.curves.reductions import CyclicReduction


@pytest.mark.parametrize(("mixed", "least", "most"), [(10, 1.0, 1.0), (1000, 0.0, 0.3)])
def test_how_much_may_cancel(mixed, least, most):
    """Of e = (y dx + k dy, dy) p_y has a part k u^1, in which the digits of u^2 get lost."""
    x, y, k = sp.symbols("x y k")
    frame = Frame([x, y], [[y, k], [0, 1]], name="mixed")
    problem = geodesic(frame, [0, 1], frame_velocity=[1, 1], parameters={"k": mixed})
    equations = problem.equations(problem.charts[0])
    states = np.random.default_rng(1).normal(size=(400, 4))
    states[:, 1] = 1 + np.abs(states[:, 1])
    assert equations.momenta is not None
    cyclic = CyclicReduction(equations, equations.momenta)
    *_, kept = cyclic.reduced(states, np.full((400, 1), float(mixed)))
    assert least <= kept.mean() <= most
