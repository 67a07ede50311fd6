"""solve_many on curves: batches, stacks, interruptions."""

from functools import cache
from typing import Any

import numpy as np
import pytest

from geomtorsion.curves import autoparallel, geodesic
from geomtorsion.errors import AccuracyError, TimeError
from geomtorsion.geometry import cartan
from geomtorsion.ode import RungeKutta, Solution, Taylor, solve, solve_many
from geomtorsion.ode.engines import stacked
from geomtorsion.spaces import load
from tests.chosen import one_in
from tests.ode.engines import ENGINES, every_engine, needs_heyoka
from tests.rounding import ROUNDED

RANDOM = np.random.default_rng(7)


def top(**start):
    return geodesic(load("so3").frame, metric=[1.1, 2.2, 3.3], **start)


@every_engine
def test_members_agree_with_single_motions(engine):
    """Members agree with single motions, for speeds that differ by 1e6 and an odd number."""
    speeds = RANDOM.normal(size=(21, 3))
    speeds[3] *= 1e-3
    speeds[4] = 0
    many = solve_many(
        top(start=[0.3, 1.0, 0.2], frame_velocity=[1, 0, 0]),
        None,
        [1.0, 2.0],
        1e-9,
        engine,
        frame_velocities=speeds,
    )
    assert many.finished.all()
    assert many.error <= 1e-9
    assert many.coordinates.shape == many.frame_velocity.shape == (21, 2, 3)
    for k in (0, 3, 4, 20):
        one = solve(
            top(start=[0.3, 1.0, 0.2], frame_velocity=speeds[k]), [1.0, 2.0], 1e-11, RungeKutta()
        )
        assert many.frame_velocity[k] == pytest.approx(one.frame_velocity, rel=2e-9, abs=ROUNDED)
        gap = many.coordinates[k] - one.coordinates
        assert np.abs(np.remainder(gap + np.pi, 2 * np.pi) - np.pi).max() < 1e-8


@every_engine
def test_starts_and_velocities(engine):
    """Straight lines from coordinates and coordinate velocities pass through another chart."""
    starts = np.array([[1.0, 0.1], [2.0, 0.2], [3.0, 0.3]])
    rates = np.array([[-1.0, 0.0], [0.5, 0.5], [0.0, 1.0]])
    problem = geodesic(load("flat_polar").frame, [1.0, 0.0], [0.0, 0.0])
    many = solve_many(problem, starts, 2.5, 1e-10, engine, velocities=rates, check=None)
    r, phi = starts.T
    place = np.array([r * np.cos(phi), r * np.sin(phi)])
    speed = np.array(
        [
            rates[:, 0] * np.cos(phi) - r * np.sin(phi) * rates[:, 1],
            rates[:, 0] * np.sin(phi) + r * np.cos(phi) * rates[:, 1],
        ]
    )
    end = place + 2.5 * speed
    assert many.coordinates[:, -1, 0] == pytest.approx(np.hypot(*end), rel=1e-9)
    assert many.checked == 3


@every_engine
def test_unfinished_members_are_marked(engine):
    """One loxodrome of three ends at the pole; the others are finished."""
    problem = autoparallel(
        cartan(load("s2").frame), [1.0, 0.0], frame_velocity=[0, 1], parameters={"R": 1}
    )
    speeds = [[0.1, 1.0], [-1.0, 0.5], [0.2, 0.5]]
    many = solve_many(problem, None, 1.5, 1e-8, engine, frame_velocities=speeds)
    assert many.finished.tolist() == [True, False, True]
    assert many.coordinates[2, -1, 0] == pytest.approx(1.3, abs=1e-7)
    assert np.isfinite(many.coordinates[[0, 2]]).all()
    assert np.isnan(many.coordinates[1]).all()


def test_interruption_returns_finished_members(monkeypatch):
    """Ctrl-C in the second stack returns the members of the first one."""
    monkeypatch.setattr(stacked, "STACKED", 12)
    inner, calls = stacked._run_part, []

    def stopped(*given):
        calls.append(given)
        # Two calls are for the error estimate of four motions each.
        if len(calls) > 3:
            raise KeyboardInterrupt
        inner(*given)

    monkeypatch.setattr(stacked, "_run_part", stopped)
    problem = top(frame_velocity=[1, 0, 0])
    many = solve_many(
        problem,
        None,
        1.0,
        1e-6,
        RungeKutta(),
        frame_velocities=RANDOM.normal(size=(12, 3)),
        check=4,
    )
    assert many.interrupted
    assert 0 < many.finished.sum() < 12


def test_progress(capsys):
    """Without progress nothing is printed."""
    problem, speeds = top(frame_velocity=[1, 0, 0]), RANDOM.normal(size=(8, 3))
    solve_many(problem, None, 1.0, frame_velocities=speeds, engine=RungeKutta())
    assert capsys.readouterr().err == ""


def test_refused():
    """A missing time, an accuracy beyond doubles and an engine of another precision are refused."""
    problem, speeds = top(frame_velocity=[1, 0, 0]), RANDOM.normal(size=(3, 3))
    with pytest.raises(TimeError, match="t: expected the last time or a list of times, got none"):
        solve_many(problem, frame_velocities=speeds)
    with pytest.raises(AccuracyError, match="gets to"):
        solve_many(problem, None, 50.0, 1e-17, RungeKutta(), frame_velocities=speeds)
    with pytest.raises(AccuracyError, match="double precision"):
        solve_many(problem, None, 1.0, 1e-9, Taylor(113), frame_velocities=speeds)


@needs_heyoka
def test_summary_of_many_names_its_cost():
    """The summary has the numbers of motions and the engine."""
    many = solve_many(
        top(frame_velocity=[1, 0, 0]), None, 5.0, frame_velocities=RANDOM.normal(size=(40, 3))
    )
    assert "40 of 40 motions by Taylor" in str(many)
    assert len(many) == 40


def ensembles() -> dict[str, tuple[Any, dict[str, Any]]]:
    """Ensembles that meet an edge of their chart: over the pole of s2, through the gimbal lock."""
    s2 = geodesic(load("s2").frame, [0.9, 0.3], [0.0, 1.0], parameters={"R": 1})
    rates = np.stack([np.linspace(-1.5, -0.4, 9), np.linspace(-0.2, 0.3, 9)], axis=1)
    angles = top(start=[1e-3, 1.2, 0.2], frame_velocity=[0.0, -1.0, 0.0])
    turns = np.array([0.0, -1.0, 0.0]) + 0.05 * np.random.default_rng(3).normal(size=(9, 3))
    return {
        "s2": (s2, {"velocities": rates}),
        "so3": (angles.with_charts("so3", "so3_xyz"), {"frame_velocities": turns}),
    }


@cache
def single(name: str, k: int, times: tuple[float, ...]) -> Solution:
    """A member solved by itself, with one engine for all comparisons."""
    problem, given = ensembles()[name]
    member = problem.with_start(**{key[:-3] + "y": rows[k] for key, rows in given.items()})
    return solve(member, list(times), 1e-11, RungeKutta())


@pytest.mark.parametrize(
    ("engine", "name", "t"), one_in(2, ENGINES, ["s2", "so3"], [2.0, [0.5, 1.0, 2.0]])
)
def test_charts_are_changed_on_the_way(engine, name, t):
    """Each member agrees with its own solution, also where no sample is near the edge."""
    problem, given = ensembles()[name]
    many = solve_many(problem, None, t, 1e-8, engine, **given)
    assert many.finished.all()
    assert many.error <= 1e-8
    assert len(many.trajectories) >= 4
    assert any(len(trajectory.segments) > 1 for trajectory in many.trajectories.values())
    for k in range(9):
        one = single(name, k, tuple(t) if isinstance(t, list) else (t,))
        gap = many.coordinates[k] - one.coordinates
        gap[:, -1] = np.remainder(gap[:, -1] + np.pi, 2 * np.pi) - np.pi
        gap[:, 0] = np.remainder(gap[:, 0] + np.pi, 2 * np.pi) - np.pi
        assert np.abs(gap).max() < 2e-7
        assert many.frame_velocity[k] == pytest.approx(one.frame_velocity, abs=2e-7)


@every_engine
def test_an_edge_between_samples_is_seen(engine):
    """A loxodrome into the pole of its only chart is unfinished, though its end has coordinates."""
    problem = autoparallel(
        cartan(load("s2").frame), [1.0, 0.0], frame_velocity=[0, 1], parameters={"R": 1}
    )
    # Straight down the meridian: theta = 1 - 7.5 would be inside again.
    many = solve_many(problem, None, 7.5, 1e-8, engine, frame_velocities=[[-1.0, 0.0], [0.1, 1.0]])
    assert many.finished.tolist() == [False, True]
