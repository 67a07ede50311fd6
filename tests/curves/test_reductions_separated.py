"""separated: geodesics that fall apart, against the equations of frame velocities."""

import numpy as np
import pytest
import sympy as sp

from geomtorsion import Frame
from geomtorsion.curves import geodesic
from geomtorsion.curves.reductions import CyclicReduction, SeparatedReduction
from geomtorsion.ode import RungeKutta, Taylor, solve, solve_many
from geomtorsion.ode.engines import taylor
from geomtorsion.spaces import load

KERR = {"M": 1, "a": 0.9}


# Bound between turning points that are no factor of four apart.
BOUND = {"kerr": (1.07, 0.02, 0.1, 0.28), "schwarzschild": (1.07, 0.02, 0.1, 0.38)}


def orbit(space="kerr", start=(0, 10, 1.2, 0), velocity=None, **numbers):
    """A geodesic in one chart."""
    velocity = BOUND[space] if velocity is None else velocity
    problem = geodesic(load(space).frame, start, frame_velocity=velocity, parameters=numbers)
    return problem.with_charts(problem.charts[0])


def lifted_rates(problem, seed):
    """Rates of coordinates at random places: those of the reduction, and the full ones."""
    equations = problem.equations(problem.charts[0])
    smaller = problem.reductions(problem.charts[0]).offered[0]
    random = np.random.default_rng(seed)
    state = np.array([[*map(float, problem.start), *map(float, problem.frame_velocity)]])
    state = state * (1 + 0.01 * random.normal(size=(50, state.shape[1])))
    numbers = np.tile([float(problem.parameters[n]) for n in equations.parameters], (50, 1))
    start, own, kept = smaller.reduced(state, numbers)
    return equations, smaller, state, numbers, start, own, kept


@pytest.mark.parametrize(
    ("space", "numbers"), [("kerr", KERR), ("schwarzschild", {"M": 1})], ids=["kerr", "round"]
)
def test_rates_are_those_of_frame_velocities(space, numbers):
    """A small step by the smaller system is one by the full system, at random states."""
    problem = orbit(space, **numbers)
    equations, smaller, state, full_numbers, start, own, kept = lifted_rates(problem, 1)
    assert isinstance(smaller, SeparatedReduction)
    assert kept.all()
    assert smaller.lifted(own, start[:, None, :])[:, 0] == pytest.approx(state, rel=1e-12)
    rates = smaller.system.rates.numpy()(*start.T, *own.T).T
    step = 1e-6
    ahead = smaller.lifted(own, (start + step * rates)[:, None, :])[:, 0]
    behind = smaller.lifted(own, (start - step * rates)[:, None, :])[:, 0]
    slopes = equations.system.rates.numpy()(*state.T, *full_numbers.T).T
    assert (ahead - behind) / (2 * step) == pytest.approx(slopes, rel=1e-6, abs=1e-7)


def test_constants_are_carters():
    """kappa of the cosine is Q = p_theta^2 + cos^2 (L^2 / sin^2 - a^2 (E^2 + N)) (Carter 1968)."""
    problem = orbit(**KERR)
    _, smaller, state, _, start, own, _ = lifted_rates(problem, 2)
    known = dict(zip(smaller.system.parameters, own.T, strict=True))
    cosine, sine = np.cos(state[:, 2]), np.sin(state[:, 2])
    rho = np.sqrt(state[:, 1] ** 2 + (0.9 * cosine) ** 2)
    energy, turn, norm = known["p_t"], known["p_phi"], known["norm"]
    carter = (rho * state[:, 6]) ** 2
    carter += cosine**2 * (turn**2 / sine**2 - 0.81 * (energy**2 + norm))
    assert known["kappa_theta"] == pytest.approx(carter, rel=1e-11)
    # Both parts of D (g^mu nu p_mu p_nu - N) = 0.
    assert known["kappa_r"] == pytest.approx(-carter, rel=1e-9)
    assert start[:, 2] == pytest.approx(cosine)


@pytest.mark.parametrize("space", ["kerr", "schwarzschild"])
def test_errors_are_told(space):
    """Against Runge-Kutta and, where it is there, Taylor in long numbers by the full equations."""
    problem = orbit(space, **(KERR if space == "kerr" else {"M": 1}))
    found = solve(problem, 200.0, 1e-9)
    other = solve(problem, 200.0, 1e-10, engine=RungeKutta())
    size = np.abs(other.coordinates).max()
    gap = np.abs(found.coordinates - other.coordinates).max() / size
    assert gap <= found.error + other.error
    assert found.coordinates[0] == pytest.approx([0, 10, 1.2, 0], abs=1e-15)
    if taylor.is_available():
        truth = solve(problem, 200.0, 1e-14, engine=Taylor(64)).coordinates.astype(float)
        assert np.abs(found.coordinates - truth).max() / size <= found.error


def test_an_angle_that_goes_round_keeps_its_place():
    """On a torus cos(theta) is all that occurs, but theta goes on beyond pi."""
    theta, phi = sp.symbols("theta phi")
    torus = Frame([theta, phi], [[1, 0], [0, 3 + sp.cos(theta)]], name="torus")
    problem = geodesic(torus, [0.5, 0], frame_velocity=[1.0, 0.3])
    reductions = problem.reductions(problem.charts[0]).offered
    assert not any(isinstance(one, SeparatedReduction) for one in reductions)
    found = solve(problem, 20.0, 1e-9)
    assert found.coordinates[-1, 0] > 2 * np.pi


def test_angles_outside_keep_the_full_equations():
    """The cosine stands for theta between 0 and pi only."""
    problem = orbit(**KERR)
    (smaller, *_) = problem.reductions(problem.charts[0]).offered
    state = np.array(
        [[0, 8, theta, 0, 1.07, 0, 0.1, 0.28] for theta in (1.0, -1.0, 1.0 + 2 * np.pi)]
    )
    numbers = np.tile([1, 0.9], (3, 1))
    *_, kept = smaller.reduced(state, numbers)
    assert kept.tolist() == [True, False, False]


@pytest.mark.parametrize(
    ("start", "velocity", "kept"),
    [
        ((0, 10, 1.2, 0), (1.07, 0.02, 0.1, 0.28), True),
        ((0, 10, 1.2, 0), (1.1, 0.02, 0.38, 0.01), False),
        ((0, 10, 1.2, 0), (1.1, -0.2, 0.1, 0.1), False),
        ((0, 10, 1.2, 0), (1.9, 1.2, 0.1, 0.38), False),
        ((0, 10, 0.1, 0), (1.1, 0.02, 0.0, 0.38), False),
    ],
    ids=["bound", "near the pole", "falling", "leaving", "begins near the pole"],
)
def test_only_where_no_digits_are_lost(start, velocity, kept):
    """x_r grows as r^2, and the cosine says little about the angle near the pole."""
    problem = orbit(start=start, velocity=velocity, **KERR)
    states = set(problem.first_stage(53, 0.0).system.states)
    assert ("x_r" in states) is kept
    assert kept or "p_r" in states


def test_what_does_not_fall_apart():
    """Mixed momenta, sums that are none, and functions that are not rational."""
    t, r, x = sp.symbols("t r x")
    for frame in (
        Frame([t, r, x], [[1 + r * x, 0, 0], [0, 1, 0], [0, 0, 1]]),
        Frame([t, r, x], [[1 + r, 0, 0], [0, 1, r], [0, 0, x]]),
        Frame([t, r, x], [[sp.exp(r) + sp.exp(x), 0, 0], [0, 1, 0], [0, 0, 1]]),
    ):
        problem = geodesic(frame, [0, 0.5, 0.5], frame_velocity=[1, 0.1, 0.1])
        reductions = problem.reductions(problem.charts[0]).offered
        assert all(type(one) is CyclicReduction for one in reductions)


def test_ensembles_are_single_motions():
    """Members by the smaller equations, one that keeps the full ones among them."""
    problem = orbit(**KERR)
    starts = np.array([[0, 10, 1.2, 0], [0, 11, 1.2 - 2 * np.pi, 0], [0, 12, 1.4, 0]], dtype=float)
    many = solve_many(problem, starts, 50.0, 1e-9)
    for k in (0, 2):
        alone = solve(problem.with_start(list(starts[k])), 50.0, 1e-9)
        assert many["coordinates"][k, -1] == pytest.approx(alone.coordinates[-1], rel=1e-8)


@pytest.mark.parametrize(
    ("ratio", "turn", "kept"),
    [(3.8, 0.5, True), (4.2, 0.5, False), (1.5, 0.96, True), (1.5, 0.975, False)],
    ids=["a longer orbit", "too long", "a steep orbit", "too steep"],
)
def test_how_far_coordinates_may_move(ratio, turn, kept):
    """Between turning points r is to grow fourfold at most, and the sine to stay above 1/4."""
    near, far = 20.0, 20.0 * ratio
    one, two = 1 - 2 / near, 1 - 2 / far
    # E^2 = f (1 + L^2 / r^2) at both ends.
    speed = np.sqrt((two - one) / (one / near**2 - two / far**2)) / near
    velocity = [np.sqrt(1 + speed**2), 0.0, speed * turn, speed * np.sqrt(1 - turn**2)]
    problem = orbit("schwarzschild", (0, near, np.pi / 2, 0), velocity, M=1)
    assert ("x_r" in problem.first_stage(53, 0.0).system.states) is kept
