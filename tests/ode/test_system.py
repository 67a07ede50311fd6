"""Systems: rates, edges and Jacobians by all routes agree with the sums they come from."""

# pyright: reportAttributeAccessIssue=false

import mpmath
import numpy as np
import pytest
import sympy as sp

from geomtorsion.curves import geodesic
from geomtorsion.geometry import Frame
from geomtorsion.spaces import load
from tests.rounding import ROUNDED


def problems():
    """One with a kinetic metric and two charts, one with roots and parameters."""
    top = geodesic(
        load("so3").frame, [0.3, 1.0, 0.2], frame_velocity=[0.9, 0.4, 0.7], metric=(1.1, 2.2, 3.3)
    )
    orbit = geodesic(
        load("kerr").frame,
        [0, 8.0, 1.4, 0],
        frame_velocity=[1.2, 0.05, 0.2, 0.6],
        parameters={"M": 1, "a": 0.6},
        causal=None,
    )
    return {"top": top, "orbit": orbit}


def plain_values(sums, point):
    """Sums of products, each coefficient evaluated by its own element, at many digits."""
    names, shared = {name: mpmath.mpf(x) for name, x in point.items()}, {}
    with mpmath.workprec(200):
        return [
            sum(
                (c.evaluate(names, 200, shared) * mpmath.fprod(names[n] for n in factors)
                 for c, factors in row),
                mpmath.mpf(0),
            )
            for row in sums
        ]  # fmt: skip


@pytest.mark.parametrize("name", problems())
def test_all_routes(name):
    """Scalar and array rates, Jacobian and guard agree with the plain sums."""
    problem = problems()[name]
    count = 0
    for chart in problem.charts:
        equations = problem.equations(chart)
        system = equations.system
        rng = np.random.default_rng(7)
        states = 0.3 + rng.random(system.size)
        values = [0.3 + 0.1 * k for k in range(len(system.parameters))]
        if name == "orbit":
            states[1] += 8
        point = [*states.tolist(), *values]
        table = dict(zip((*system.states, *system.parameters), point, strict=True))
        expected = [float(x) for x in plain_values(equations.rates, table)]
        assert system.scalar_function(*point) == pytest.approx(expected, rel=1e-12, abs=ROUNDED)
        arrays = system.array_function(*(np.full(3, value) for value in states), *values)
        for array, value in zip(arrays, expected, strict=True):
            assert np.broadcast_to(array, 3) == pytest.approx(value, rel=1e-12, abs=ROUNDED)
        found = system.jacobian(states.tolist(), values)
        for k, state in enumerate(system.states):
            # Central differences at 60 digits have 38 right.
            step = mpmath.mpf(10) ** -20
            with mpmath.workprec(200):
                here = mpmath.mpf(table[state])
                up, down = (
                    plain_values(equations.rates, table | {state: here + h}) for h in (step, -step)
                )
                slopes = [float((x - y) / (2 * step)) for x, y in zip(up, down, strict=True)]
            assert found[:, k] == pytest.approx(slopes, rel=1e-11, abs=ROUNDED)
        if system.guard is not None:
            margin = system.guard_at(states.tolist(), values)
            again = system.guard_along(np.tile(states[:, None], 3), values)
            assert np.broadcast_to(again, 3) == pytest.approx(margin, rel=1e-13)
            count += 1
    assert count


def test_one_system_one_key():
    """Equal problems share a compiled integrator."""
    one, two = (problems()["orbit"].equations("kerr").system for _ in range(2))
    assert one is not two
    assert one.key == two.key


@pytest.mark.parametrize("k", [0.5, 800.0])
def test_constants_of_one_motion_and_of_many(k):
    """1/(1 + e^k) is computed once; e^800 overflows to infinity, and the constant is zero."""
    x, y, number = sp.symbols("x y k", real=True)
    frame = Frame([x, y], [[1 + sp.exp(number), 0], [0, 1 + y**2]])
    motion = geodesic(frame, [0, 0], frame_velocity=[3, 1], parameters={"k": 1})
    system = motion.equations(motion.charts[0]).system
    assert system.parameters == ("k", "u1", "u2")
    given = np.array([k, 3.0, 1.0])
    hoisted = system.hoisted
    one = hoisted.numbers(given)
    assert one[3] == pytest.approx(3 / (1 + np.exp(min(k, 700.0))), rel=ROUNDED, abs=1e-300)
    assert hoisted.numbers(np.array([given] * 2)).tolist() == [one.tolist()] * 2
    assert hoisted.system.array_function(0.0, 0.0, *one).tolist() == [one[3], 1.0]
