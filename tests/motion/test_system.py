"""Systems: rates, edges and Jacobians by all routes are the sums that they were made of."""

import numpy as np
import pytest

from geomtorsion.exact.compile import python_function
from geomtorsion.exact.engine_code import python_source, scalar_names
from geomtorsion.motion import geodesic, solve
from geomtorsion.spaces import load
from tests.motion.engines import every_engine


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


def plain_values(system, outputs, point):
    """Sums of products as they stand."""
    source, functions = python_source((*system.states, *system.parameters), outputs)
    return python_function(source, scalar_names(functions))(*point)


@pytest.mark.parametrize("name", problems())
def test_all_routes(name):
    """Scalar and array rates, Jacobian and edge against the plain sums."""
    problem = problems()[name]
    count = 0
    for chart in problem.charts:
        system = problem.equations(chart).system
        rng = np.random.default_rng(7)
        states = 0.3 + rng.random(system.size)
        values = [0.3 + 0.1 * k for k in range(len(system.parameters))]
        if name == "orbit":
            states[1] += 8
        point = [*states, *values]
        expected = plain_values(system, system.rates, point)
        # Kerr and Schild's rates fill thirty thousand characters: they are left as they are.
        assert (system.line is None) == (chart == "kerr_schild")
        assert system.scalar_function(*point) == pytest.approx(expected, rel=1e-12, abs=1e-15)
        arrays = system.array_rates(*(np.full(3, value) for value in states), *values)
        for array, value in zip(arrays, expected, strict=True):
            assert np.broadcast_to(array, 3) == pytest.approx(value, rel=1e-12, abs=1e-15)
        slopes = plain_values(system, system.jacobian_system, point)
        found = system.scalar_jacobian(values)(0.0, states)
        assert found.ravel() == pytest.approx(slopes, rel=1e-11, abs=1e-15)
        if system.edge is not None:
            margin = plain_values(system, (system.edge,), point)[0]
            assert system.scalar_edge(*point)[0] == pytest.approx(margin, rel=1e-13)
            assert system.edge_values(states, values) == pytest.approx(margin, rel=1e-13)
            count += 1
    assert count


@every_engine
def test_equations_too_long_to_shorten(engine, monkeypatch):
    """What is not shortened is written as it stands, and solved to the same answer."""
    short = solve(problems()["top"].with_charts("so3"), 2.0, 1e-9, engine)
    monkeypatch.setattr("geomtorsion.motion.system.factored", lambda *_: None)
    plain = solve(problems()["top"].with_charts("so3"), 2.0, 1e-9, engine)
    assert plain.at(2.0).coordinates == pytest.approx(short.at(2.0).coordinates, abs=1e-8)


def test_one_system_one_key():
    """Equal problems share a compiled integrator: their sources are the same text."""
    one, two = (problems()["orbit"].equations("kerr").system for _ in range(2))
    assert one is not two
    assert one.key == two.key
