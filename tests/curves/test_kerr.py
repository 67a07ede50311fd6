"""Geodesics of Kerr's and Schwarzschild's spaces: constants, circles, falls, one and many."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from geomtorsion.curves import geodesic
from geomtorsion.errors import ChartEdgeError
from geomtorsion.ode import RungeKutta, SavedSolution, Taylor, solve, solve_many
from geomtorsion.ode.engines.taylor import tolerance_of
from geomtorsion.ode.trajectory import integrate
from geomtorsion.prices import truth_of
from geomtorsion.spaces import load
from tests.chosen import one_in
from tests.ode.engines import every_engine, needs_heyoka

# Starts t, r, theta, phi and frame velocities in Kerr's space with M = 1, a = 0.6.
BOUND = {
    "bound": ([0, 8.0, 1.4, 0], [1.2, 0.05, 0.2, 0.36]),
    "wide": ([0, 30.0, 1.2, 0], [1.02, 0.02, 0.05, 0.14]),
    "backwards": ([0, 12.0, 1.9, 0], [1.1, 0.01, -0.1, -0.4]),
    "on the equator": ([0, 10.0, np.pi / 2, 0], [1.1, 0.05, 0.0, 0.36]),
}
OTHERS = {
    "light": ([0, 8.0, 1.4, 0], [0.55, -0.4, 0.12, 0.36]),
    "leaving": ([0, 8.0, 1.4, 0], [1.9, 1.2, 0.1, 0.4]),
    "near the pole": ([0, 8.0, 1.0, 0], [1.2, 0.05, 0.47, 1e-3]),
    "falling": ([0, 8.0, 1.4, 0], [1.05, -0.2, 0.1, 0.2]),
    "no angular momentum": ([0, 8.0, 1.2, 0], [1.2, 0.05, 0.1, 0.0]),
}
ORBITS = BOUND | OTHERS
STARTS = np.array([start for start, _ in ORBITS.values()])
VELOCITIES = np.array([velocity for _, velocity in ORBITS.values()])
# Orbits, ends, and allowed rounding errors at the end, relative to the size of each state.
ROUNDED = {
    # (With Carter's constant instead of a momentum, 300 roundings are left here.)
    "bound": (BOUND["bound"], 600.0, 2500),
    "light": (OTHERS["light"], 40.0, 300),
    # Near the pole angles change fast, and their error enters all other states: 500 to 7000
    # roundings at orders from 18 to 22.
    "near the pole": (OTHERS["near the pole"], 200.0, 8000),
    "falling": (OTHERS["falling"], 20.0, 300),
    "no angular momentum": (OTHERS["no angular momentum"], 8.0, 300),
}


@cache
def kerr():
    return load("kerr").frame


def orbit(start, velocity, charts=("kerr",)):
    """A geodesic of Kerr's space, by default only in Boyer-Lindquist coordinates."""
    numbers = {"M": 1, "a": 0.6}
    made = geodesic(kerr(), start, frame_velocity=velocity, parameters=numbers, causal=None)
    return made.with_charts(*charts) if charts else made


def constants(states, a):
    """Energy, angular momentum, square of the mass and Carter's constant, by rows of states."""
    _, r, theta, _, u1, u2, u3, u4 = states.T
    rho = np.sqrt(r**2 + (a * np.cos(theta)) ** 2)
    root = np.sqrt(r**2 - 2 * r + a**2)
    energy = (root * u1 + a * np.sin(theta) * u4) / rho
    turn = np.sin(theta) / rho * (a * root * np.sin(theta) * u1 + (r**2 + a**2) * u4)
    mass = u1**2 - u2**2 - u3**2 - u4**2
    carter = (rho * u3) ** 2 + np.cos(theta) ** 2 * (
        a**2 * (mass - energy**2) + turn**2 / np.sin(theta) ** 2
    )
    return energy, turn, mass, carter


def infall():
    """Inwards from r = 6 in Schwarzschild's space, all charts."""
    return geodesic(
        load("schwarzschild").frame, [0, 6.0, 1.2, 0], frame_velocity=[1.5, -1.1, 0.1, 0.2],
        parameters={"M": 1}, causal=None,
    )  # fmt: skip


# -- constants -------------------------------------------------------------------------------------


@needs_heyoka
def test_carters_constant():
    """p_theta^2 + cos^2 theta (a^2 (m^2 - E^2) + L^2 / sin^2 theta) is constant, in 64 bits."""
    problem = orbit([0, 8.0, 1.4, 0], [1.2, 0.05, 0.2, 0.45])
    times = np.linspace(0, 300.0, 40) * problem.time_unit
    made = integrate(problem.first_stage(64, 0.0), times, 1e-20, Taylor(64))
    # The parameter is the double nearest to 0.6.
    for kept in constants(made.segments[0].states, np.longdouble(0.6)):
        assert np.abs(kept / kept[0] - 1).max() < 1e-16


@every_engine
@pytest.mark.parametrize("name", BOUND)
def test_constants_of_solutions(name, engine):
    """Energy, momentum, mass and Carter's constant change by less than 1e-8."""
    sol = solve(orbit(*ORBITS[name]), 100.0, 1e-10, engine)
    rows = np.concatenate((sol.coordinates, sol.frame_velocity), axis=1)
    for kept in constants(rows, 0.6):
        assert np.abs(kept - kept[0]).max() < 1e-8 * max(abs(kept[0]), 1.0)


@needs_heyoka
def test_a_circle_stays_a_circle():
    """On the equator at r = 8, for 4000 units of time, r changes only by rounding."""
    a, r = 0.6, 8.0
    below = np.sqrt(1 - 3 / r + 2 * a * r**-1.5)
    energy = (1 - 2 / r + a * r**-1.5) / below
    turn = np.sqrt(r) * (1 - 2 * a * r**-1.5 + a * a / r**2) / below
    root = np.sqrt(r * r - 2 * r + a * a)
    rows = np.array([[root, a], [a * root, r * r + a * a]]) / r
    u1, u4 = np.linalg.solve(rows, [energy, turn])
    problem = orbit([0, r, np.pi / 2, 0], [u1, 0, 0, u4])
    times = np.linspace(0, 4000.0, 9) * problem.time_unit
    made = integrate(problem.first_stage(53, 0.0), times, 1e-16, Taylor())
    states = made.segments[0].states
    assert np.abs(states[:, 1] - r).max() < 1e-12
    assert np.abs(states[:, 2] - np.pi / 2).max() < 1e-12


def test_a_circle_of_schwarzschild():
    """A circle of Schwarzschild's space, with states of zero and constant velocities, is kept."""
    problem = geodesic(
        load("schwarzschild").frame, [0, 6.0, np.pi / 2, 0],
        frame_velocity=[np.sqrt(4 / 3), 0.0, 0.0, np.sqrt(1 / 3)], parameters={"M": 1},
    )  # fmt: skip
    sol = solve(problem.with_charts("schwarzschild"), 50.0, 1e-9, RungeKutta())
    assert np.abs(sol["r"] - 6).max() < 1e-7


# -- against more digits ---------------------------------------------------------------------------


@needs_heyoka
@pytest.mark.parametrize(("name", "accuracy"), one_in(2, list(BOUND), [1e-6, 1e-9, 1e-12]))
def test_against_113_bits(name, accuracy):
    """Estimates are honest over four hundred units of time, with both engines."""
    problem = orbit(*BOUND[name])
    truth = truth_of(problem, np.linspace(0, 400.0, 33))
    for engine in (Taylor(), RungeKutta()):
        sol = solve(problem, np.linspace(0, 400.0, 33), accuracy, engine)
        true = truth.error(sol)
        assert true <= accuracy
        assert 0.5 * true <= sol.error <= accuracy
        assert sol.error <= 100 * max(true, 1e-15)


@needs_heyoka
@pytest.mark.parametrize("name", ROUNDED)
def test_only_rounding_remains(name):
    """At a high order only rounding errors are left, relative to the size of each state."""
    (start, velocity), end, most = ROUNDED[name]
    problem = orbit(start, velocity)
    grid = np.linspace(0, end, 17)
    precise = truth_of(problem, grid).trajectory.segments[0].states.astype(float)
    made = integrate(
        problem.first_stage(53, 0.0), grid * problem.time_unit, tolerance_of(20), Taylor()
    )
    assert made.outcome == "done"
    sizes = np.abs(precise).max(axis=0)
    gaps = np.abs(made.segments[0].states - precise).max(axis=0)
    assert (gaps < most * 2.0**-53 * sizes).all()


@needs_heyoka
@pytest.mark.parametrize(("bits", "tolerance", "most"), [(64, 1e-18, 1e-16), (113, 1e-32, 1e-29)])
def test_more_digits(bits, tolerance, most):
    """Each number type keeps its digits, compared with 300 bits."""
    problem, grid = orbit(*BOUND["bound"]), np.linspace(0, 40.0, 5)
    found, truth = (
        integrate(problem.first_stage(b, 0.0), grid * problem.time_unit, x, Taylor(b))
        .segments[0].states.ravel()
        for b, x in ((bits, tolerance), (300, 1e-60))
    )  # fmt: skip
    gaps = [
        abs(float(x - y)) / max(abs(float(y)), 1e-3)
        for x, y in zip(Taylor(300).array(found), truth, strict=True)
    ]
    assert max(gaps) < most


@every_engine
def test_all_engines_agree(engine):
    """Solutions agree within the requested accuracy."""
    problem = orbit([0, 8.0, 1.4, 0], [1.2, 0.05, 0.2, 0.45])
    sol = solve(problem, 60.0, 1e-8, engine)
    tight = solve(problem, 60.0, 1e-11, RungeKutta())
    size = np.abs(tight.coordinates).max()
    assert np.abs(sol.coordinates - tight.coordinates).max() < 2e-8 * size
    assert set(sol.drift) >= {"momentum of t", "momentum of phi"}
    assert max(sol.drift.values()) < 1e-7


# -- falls -----------------------------------------------------------------------------------------


@needs_heyoka
def test_a_fall_from_afar():
    """A fall through the horizon into another chart agrees with 113 bits."""
    problem = geodesic(
        load("schwarzschild").frame, [0, 255.0, np.pi / 2, 0],
        frame_velocity=[1.0000041266590871, 0, 0, 0.003], parameters={"M": 1}, causal=None,
    )  # fmt: skip
    sol = solve(problem, 4529.5, 1e-9)
    assert sol.charts == ("schwarzschild", "kerr_schild")
    grid = np.array([0.0, 4529.5]) * problem.time_unit
    truth = integrate(problem.first_stage(113, 0.0), grid, 1e-28, Taylor(113))
    last = truth.segments[-1].states[-1].astype(float)
    assert sol.in_chart("kerr_schild")[-1] == pytest.approx(last[:4], rel=1e-9, abs=1e-9)


@every_engine
@pytest.mark.parametrize(("a", "end", "below"), [(0.6, 17.5, 1.8), (0.99999, 20.0, 0.9955)])
def test_a_fall_through_the_horizons(a, end, below, engine):
    """A fall ends between the horizons, or inside the inner one where they are close together."""
    problem = geodesic(
        kerr(), [0, 8.0, 1.4, 0], frame_velocity=[1.05, -0.2, 0.02, 0.05],
        parameters={"M": 1, "a": a}, causal=None,
    )  # fmt: skip
    sol = solve(problem, end, 1e-9, engine)
    assert sol.charts == ("kerr", "ingoing")
    r = sol.in_chart("ingoing")[:, 1]
    assert r[0] == pytest.approx(8.0, abs=1e-9)
    assert r[-1] < below
    assert max(sol.drift.values()) < 1e-6


@every_engine
def test_through_the_horizon_keeps_momenta(engine):
    """The momenta are kept in the chart behind the horizon."""
    sol = solve(infall(), 4.0, 1e-8, engine)
    assert sol.charts != ("schwarzschild",)
    assert max(sol.drift.values()) < 1e-6


@every_engine
def test_out_of_the_horizon_into_the_past(engine):
    """The time reversal (t, phi) -> (-t, -phi) of an orbit out of the horizon is a fall into it."""
    kerr, start = load("kerr").frame, [0, 4, 1.3, 0]
    numbers = {"M": 1, "a": 0.9}
    times = np.linspace(0, 6.9, 20)
    falling = geodesic(kerr, start, [1.2, -0.3, -0.02, 0.05], parameters=numbers)
    rising = geodesic(kerr, start, [1.2, 0.3, 0.02, 0.05], parameters=numbers)
    fall = solve(falling, times, 1e-9, engine)
    past = solve(rising, -times, 1e-9, engine)
    assert fall.trajectory.labels == ("kerr", "ingoing")
    assert past.trajectory.labels == ("kerr", "outgoing")
    one, two = fall.in_chart("ingoing"), past.in_chart("outgoing")
    assert two[-1, 1] < 1
    signs = [-1, 1, 1, -1]
    turned = (two - one * signs)[:, 3]
    assert np.abs(two - one * signs)[:, :3].max() < 1e-8
    assert np.abs(np.exp(1j * turned) - 1).max() < 1e-8


@every_engine
def test_it_stops_at_the_edge(engine):
    """A fall in one chart ends at the horizon, and the error carries the partial solution."""
    problem = infall().with_charts("schwarzschild")
    with pytest.raises(ChartEdgeError, match="chart 'schwarzschild' ends") as caught:
        solve(problem, 30.0, 1e-7, engine)
    r = caught.value.solution["r"]
    assert len(r) > 5
    assert (np.diff(r) < 0).all()


def test_reading_and_saving(tmp_path):
    """Values between samples, a table and a file agree with the solution."""
    problem = orbit([0, 8.0, 1.4, 0], [1.2, 0.05, 0.2, 0.45])
    sol = solve(problem, 30.0, 1e-9)
    finer = solve(problem, np.array([0.0, 7.3, 11.9]), 1e-11)
    moment = sol.at([7.3, 11.9])
    assert np.abs(moment.coordinates - finer.coordinates[1:]).max() < 1e-7
    assert np.abs(moment.frame_velocity - finer.frame_velocity[1:]).max() < 1e-8
    table = sol.to_pandas()
    assert list(table.columns[-4:]) == ["u1", "u2", "u3", "u4"]
    sol.save(tmp_path / "orbit.npz")
    again = SavedSolution.load(tmp_path / "orbit.npz")
    assert np.array_equal(again["frame_velocity"], sol.frame_velocity)
    assert again.metadata["drift"]["momentum of t"] == sol.drift["momentum of t"]
    assert sol.drift["momentum of t"] < 1e-9


# -- many ------------------------------------------------------------------------------------------


@needs_heyoka
@pytest.mark.parametrize("times", [7.0, [2.0, 5.0, 7.0]], ids=["only the end", "samples"])
def test_members_agree_with_single_motions(times):
    """Each member agrees with its true solution and has an error, at the end and at samples."""
    accuracy = 1e-10
    many = solve_many(
        orbit(STARTS[0].tolist(), VELOCITIES[0].tolist(), charts=()), STARTS, times, accuracy,
        frame_velocities=VELOCITIES,
    )  # fmt: skip
    assert many.finished.all()
    assert many.errors.shape == (len(STARTS),)
    assert (many.errors <= accuracy).all()
    grid = np.concatenate(([0.0], np.atleast_1d(times)))
    for k, (start, velocity) in enumerate(zip(STARTS, VELOCITIES, strict=True)):
        alone = orbit(start.tolist(), velocity.tolist())
        states = truth_of(alone, grid).trajectory.segments[-1].states[1:].astype(float)
        coordinates, own = states[:, :4], states[:, 4:] * alone.time_unit
        if k in many.trajectories:
            # Followed on its own, through other charts.
            continue
        gap = np.abs(many.coordinates[k] - coordinates).max() / np.abs(coordinates).max()
        assert gap < accuracy
        assert np.abs(many.frame_velocity[k] - own).max() < accuracy * np.abs(own).max()


@needs_heyoka
def test_many_by_both_engines():
    """Engines agree in isotropic coordinates, where x, y and z form one group."""
    one = geodesic(
        load("schwarzschild_isotropic").frame, [0, 6.0, 0.5, 0.3],
        frame_velocity=[1.3, 0.1, 0.4, 0.1], parameters={"M": 1.0}, causal=None,
    )  # fmt: skip
    rng = np.random.default_rng(3)
    velocities = np.array([1.3, 0.1, 0.4, 0.1]) * (1 + 0.05 * rng.normal(size=(9, 4)))
    fast = solve_many(one, None, 20.0, 1e-10, frame_velocities=velocities)
    slow = solve_many(one, None, 20.0, 1e-9, RungeKutta(), frame_velocities=velocities)
    assert fast.coordinates == pytest.approx(slow.coordinates, rel=3e-9, abs=3e-9)
    assert fast.frame_velocity == pytest.approx(slow.frame_velocity, rel=3e-9, abs=3e-9)


@needs_heyoka
@pytest.mark.parametrize("times", [40.0, [5.0, 20.0, 40.0]], ids=["only the end", "samples"])
def test_a_member_that_falls_holds_up_nobody(times):
    """Behind the horizon steps become arbitrarily small; the other member arrives nevertheless."""
    one = geodesic(
        load("schwarzschild").frame, [0, 8, 1.2, 0.3], frame_velocity=[1.1, 0.05, 0.1, 0.4],
        parameters={"M": 1}, causal=None,
    )  # fmt: skip
    starts = [[0, 6, 1.2, 0.3], [0, 9, 1.2, 0.3]]
    velocities = [[1.0198039027185568, -0.2, 0, 0.0], [1.1, 0.05, 0.1, 0.4]]
    many = solve_many(one, starts, times, 1e-8, frame_velocities=velocities)
    assert many.finished.tolist() == [False, True]
    assert np.isnan(many.errors[0])
    assert many.errors[1] <= 1e-8


@every_engine
def test_time_is_measured_on_its_own(engine):
    """t grows fifty times larger than r: r is still accurate relative to its own size."""
    problem, times = orbit([0, 10.0, 1.4, 0], [1.1, 0.05, 0.1, 0.36]), np.linspace(0, 1500, 7)[1:]
    assert problem.equations("kerr").groups[:2] == ((0,), (1, 2, 3))
    rough, fine = solve(problem, times, 1e-6, engine), solve(problem, times, 1e-11)
    gaps = np.abs(rough.coordinates - fine.coordinates).max(axis=0)
    sizes = np.abs(fine.coordinates).max(axis=0)
    assert sizes[0] > 50 * sizes[1]
    assert gaps[0] < 1e-6 * sizes[0]
    assert gaps[1:].max() < 1e-6 * sizes[1:].max()
