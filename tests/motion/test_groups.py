"""Batches by smaller systems: every member as if it were alone."""

import numpy as np
import pytest

from geomtorsion.motion import RungeKutta, Taylor, geodesic, solve_many
from geomtorsion.motion import groups as groups_module
from geomtorsion.motion.groups import groups
from geomtorsion.motion.journey import travel
from geomtorsion.motion.many import Lanes, run_lanes
from geomtorsion.motion.reduced import constants
from geomtorsion.spaces import load
from tests.motion.engines import needs_heyoka
from tests.motion.test_confined import ORBITS, orbit, unreduced

STARTS = np.array([start for start, *_ in ORBITS.values()])
VELOCITIES = np.array([velocity for _, velocity, _ in ORBITS.values()])
CONFINED = np.array([confined for *_, confined in ORBITS.values()])


def problem(*charts):
    """Kerr's space, from the first of the orbits."""
    return orbit(STARTS[0].tolist(), VELOCITIES[0].tolist(), charts=charts)


def found(lanes):
    """Groups of all lanes."""
    system = lanes.equations.system
    return list(groups(lanes.equations, system, lanes.states, lanes.parameters, lanes.speeds))


def test_who_goes_with_whom():
    """Confined ones, others with constants, and those that constants would cost digits."""
    steep = np.array([[0, 8.0, 1e-9, 0]])
    starts, velocities = np.vstack((STARTS, steep)), np.vstack((VELOCITIES, VELOCITIES[:1]))
    made = found(Lanes.laid_out(problem("kerr"), starts, velocities))
    assert sorted(np.concatenate([group.index for group in made])) == list(range(len(starts)))
    together = {group.system.states: set(group.index.tolist()) for group in made}
    cosine = ("t", "r", "cos_theta", "phi", "v_r", "v_theta")
    assert together[cosine] == set(np.flatnonzero(CONFINED))
    assert set(np.flatnonzero(~CONFINED)) <= set.union(
        *(index for states, index in together.items() if states != cosine)
    )


def test_without_longer_numbers(monkeypatch):
    """Where constants of many starts would lose digits, the full equations answer."""
    monkeypatch.setattr(constants, "ENOUGH", 1000)
    (group,) = found(Lanes.laid_out(problem("kerr"), STARTS, VELOCITIES))
    assert group.system.size == 8
    assert group.index.tolist() == list(range(len(STARTS)))


@needs_heyoka
@pytest.mark.parametrize("times", [7.0, [2.0, 5.0, 7.0]])
def test_members_are_as_if_alone(times):
    """Through all charts, at the end or at samples: the truth of each, by the full equations."""
    many = solve_many(problem(), STARTS, times, 1e-10, frame_velocities=VELOCITIES, check=None)
    assert many.finished.all()
    grid = np.concatenate(([0.0], np.atleast_1d(times)))
    for k, (start, velocity) in enumerate(zip(STARTS, VELOCITIES, strict=True)):
        alone = unreduced(orbit(start.tolist(), velocity.tolist()))
        journey = travel(alone, Taylor(113), 1e-28, grid * alone.speed)
        states = journey.segments[-1].states[1:].astype(float)
        coordinates, own = states[:, :4], states[:, 4:] * alone.speed
        gap = np.abs(many.coordinates[k] - coordinates).max() / np.abs(coordinates).max()
        assert gap < 1e-10
        assert np.abs(many.frame_velocity[k] - own).max() < 1e-10 * np.abs(own).max()


@needs_heyoka
def test_momenta_alone():
    """Where nothing falls apart but momenta are constants, engines agree."""
    frame = load("schwarzschild_isotropic").frame
    numbers = {"M": 1.0}
    one = geodesic(
        frame, [0, 6.0, 0.5, 0.3], frame_velocity=[1.3, 0.1, 0.4, 0.1], parameters=numbers,
        causal=None,
    )  # fmt: skip
    rng = np.random.default_rng(3)
    velocities = np.array([1.3, 0.1, 0.4, 0.1]) * (1 + 0.05 * rng.normal(size=(9, 4)))
    fast = solve_many(one, None, 20.0, 1e-10, frame_velocities=velocities)
    slow = solve_many(one, None, 20.0, 1e-9, RungeKutta(), frame_velocities=velocities)
    assert fast.coordinates == pytest.approx(slow.coordinates, rel=3e-9, abs=3e-9)
    assert fast.frame_velocity == pytest.approx(slow.frame_velocity, rel=3e-9, abs=3e-9)


@needs_heyoka
@pytest.mark.parametrize("times", [40.0, [5.0, 20.0, 40.0]])
def test_a_member_that_falls_holds_up_nobody(times):
    """Behind the horizon steps become as small as they like; the others arrive all the same."""
    one = geodesic(
        load("schwarzschild").frame, [0, 8, 1.2, 0.3], frame_velocity=[1.1, 0.05, 0.1, 0.4],
        parameters={"M": 1}, causal=None,
    )  # fmt: skip
    starts = [[0, 6, 1.2, 0.3], [0, 9, 1.2, 0.3]]
    velocities = [[1.0198039027185568, -0.2, 0, 0.0], [1.1, 0.05, 0.1, 0.4]]
    many = solve_many(one, starts, times, 1e-8, frame_velocities=velocities)
    assert many.finished.tolist() == [False, True]


@needs_heyoka
@pytest.mark.parametrize("times", [60.0, [20.0, 60.0]])
def test_looks_on_the_way_change_nothing(times, monkeypatch):
    """A batch that is looked at every few steps gives what it gives at one go."""
    one, velocities = problem("kerr"), VELOCITIES[:3]
    whole = solve_many(one, STARTS[:3], times, 1e-10, frame_velocities=velocities)
    edged = Lanes.laid_out(one, STARTS[4:5], VELOCITIES[4:5])
    grid = np.array([0.0, 4.0]) if np.ndim(times) == 0 else np.array([0.0, 2.0, 4.0])
    truth = run_lanes(Taylor(), edged, grid, 1e-12, None, np.array([False]))
    monkeypatch.setattr(groups_module, "MOST_STEPS", 1)
    again = solve_many(one, STARTS[:3], times, 1e-10, frame_velocities=velocities)
    assert again.finished.all()
    assert (again.coordinates == whole.coordinates).all()
    looked = run_lanes(Taylor(), edged, grid, 1e-12, None, np.array([False]))
    assert truth[1].all()
    if np.ndim(times) == 0:
        assert looked[1].all()
        assert looked[0] == pytest.approx(truth[0], rel=1e-12)
    else:
        # Between samples nobody goes on: such members are followed one by one.
        assert not looked[1].any()
