"""Derivatives of curves by parameters and starts."""

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import ChartEdgeError, StartError, UnknownNameError
from tests.chosen import few
from tests.ode.engines import every_engine

KERR = gt.geodesic(
    "kerr", [0, 10, 1.2, 0], velocity=[1.2, 0, 0.012, 0.034], parameters={"M": 1.0, "a": 0.6}
)
SPHERE = gt.geodesic("s2", [np.pi / 2, 0.0], velocity=[0.0, 1.0], parameters={"R": 2})


@every_engine
def test_neighbours_on_a_sphere(engine):
    """Great circles from one point of the equator spread as sin(phi)."""
    times = np.linspace(0, 3, 5)
    solution = gt.solve(SPHERE, times, 1e-10, engine, derivatives=["R", "theta", "theta'", "phi'"])
    assert solution["dtheta_dtheta"] == pytest.approx(np.cos(times), abs=1e-9)
    assert solution["dtheta_dthetadot"] == pytest.approx(np.sin(times), abs=1e-9)
    assert solution["dphi_dphidot"] == pytest.approx(times, abs=1e-9)
    # At a fixed coordinate velocity the radius only changes the speed u = R phi'.
    assert solution["dphi_dR"] == pytest.approx(0 * times, abs=1e-12)
    assert solution["du2_dR"] == pytest.approx(0 * times + 1, abs=1e-9)


def test_given_quantities_are_held_fixed():
    """At a fixed speed the angle advances as 1/R."""
    given = gt.geodesic("s2", [np.pi / 2, 0.0], frame_velocity=[0.0, 1.0], parameters={"R": 2})
    solution = gt.solve(given, [0, 3.0], derivatives=["R", "u2"])
    assert solution["dphi_dR"][-1] == pytest.approx(-3 / 4, rel=1e-9)
    assert solution["dphi_du2"][-1] == pytest.approx(3 / 2, rel=1e-9)


@pytest.mark.parametrize("by", few(2, ["M", "a", "r", "phi'"]))
def test_orbits_of_kerr(by):
    """Differences of neighbouring orbits, extrapolated to step zero (Richardson)."""
    times = np.linspace(0, 100, 4)
    solution = gt.solve(KERR, times, 1e-11, derivatives=[by])
    step = 1e-4 * abs(KERR.variables[by])

    def slope(h: float) -> dict[str, np.ndarray]:
        values = [KERR.variables[by] + s * h for s in (1, -1)]
        up, down = (gt.solve(KERR.with_values({by: x}), times, 1e-14) for x in values)
        return {name: (up[name] - down[name]) / (2 * h) for name in ("t", "r", "phi", "u3")}

    coarse, fine = slope(2 * step), slope(step)
    for name, values in fine.items():
        expected = values + (values - coarse[name]) / 3
        derivative = solution[f"d{name}_d{by}".replace("'", "dot")]
        assert derivative == pytest.approx(expected, abs=1e-7 * np.abs(expected).max()), name


def test_balls_hold_the_derivative_by_the_spin():
    """The proof covers the derivative as it covers the orbit."""
    proof = gt.prove(gt.solve(KERR, 2.0, derivatives=["a"]))
    assert proof.holds
    assert "dphi_da" in proof.names[-1]


def test_longer_numbers():
    """The derivative at the start also has the digits of the engine."""
    fine = gt.solve(KERR, [0, 5.0], 1e-25, derivatives=["a"])
    plain = gt.solve(KERR, [0, 5.0], 1e-12, derivatives=["a"])
    assert fine.error_of("dr_da") < 1e-25
    assert fine["du1_da"].astype(float) == pytest.approx(plain["du1_da"], rel=1e-10)


def test_velocities_only():
    """On a group without coordinates: Euler's equations at moments 1, 2, 3."""
    top = gt.geodesic("so3", frame_velocity=[1.0, 2.0, 3.0], metric=[1, 2, 3])
    times = np.linspace(0, 1, 3)
    solution = gt.solve(top, times, derivatives=["u2"])
    up, down = (gt.solve(top.with_values({"u2": 2 + h}), times, 1e-13) for h in (1e-5, -1e-5))
    assert solution["du1_du2"] == pytest.approx((up["u1"] - down["u1"]) / 2e-5, abs=1e-8)


def test_another_start_renews_the_derivatives():
    """The coframe at the new start makes u from the given velocity."""
    problem = SPHERE.with_derivatives(["R"]).with_values({"phi'": 0.5})
    assert gt.solve(problem, 1.0)["du2_dR"][0] == 0.5


def test_times_at_which_a_radius_is_passed():
    """Against differences; t in a term is the coordinate."""
    solution = gt.solve(KERR, 300.0, derivatives=["a"])
    near = [gt.solve(KERR.with_values({"a": 0.6 + h}), 300.0, 1e-12) for h in (1e-4, -1e-4)]
    for term in ("r - 7", "t - 100 - a", "u2"):
        up, down = (x.event_times(term) for x in near)
        slopes = solution.event_derivatives(term, "a")
        assert len(slopes.values) > 0
        assert slopes.values == pytest.approx((up - down) / 2e-4, rel=1e-6)
        assert slopes.error < 1e-8


REFUSALS = [
    (lambda: KERR.with_derivatives(["u1"]), UnknownNameError, "There are M, a, t, r"),
    (lambda: KERR.with_derivatives(["Q"]), UnknownNameError, "expected names of parameters"),
    (
        lambda: gt.parallel_transport(SPHERE, [1, 0]).with_derivatives(["R"]),
        StartError, "without vectors carried along",
    ),
    (
        lambda: gt.solve(gt.geodesic("s2", [0.5, 0], velocity=[-1, 0], parameters={"R": 1}), 2.0,
                         derivatives=["R"]),
        ChartEdgeError, "ends there",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("call", "error", "words"), REFUSALS)
def test_bad_requests_are_refused(call, error, words):
    """Names of the other kind of velocity, vectors carried along, and the end of a chart."""
    with pytest.raises(error, match=words):
        call()
