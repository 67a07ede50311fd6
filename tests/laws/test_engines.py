"""Laws: statements that hold for every engine, also for a user's own."""

# pyright: reportArgumentType=false

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy
import sympy as sp

from geomtorsion import scenes, spaces
from geomtorsion.curves import geodesic
from geomtorsion.errors import CheckpointError, GeomtorsionError, StartError
from geomtorsion.ode import (
    ODE,
    Engine,
    RungeKutta,
    SavedSolution,
    Stiff,
    Taylor,
    When,
    solve,
    solve_many,
)
from geomtorsion.ode.engines import Run
from geomtorsion.ode.engines.taylor import is_available
from geomtorsion.prices import price
from geomtorsion.scenes.checkpoint import partial_result
from tests.chosen import few


class Mine:
    """A small engine as a user may write it: scipy's DOP853 at a tolerance."""

    name = "Mine"
    precision = 53
    finds_every_root = False

    def __repr__(self) -> str:
        return "Mine()"

    def first(self, accuracy: float) -> float:
        """A tenth of the accuracy."""
        return self.rung(accuracy / 10)

    def rung(self, tolerance: float) -> float:
        """Powers of ten, down to scipy's limit."""
        return max(10.0 ** math.floor(math.log10(tolerance) + 1e-9), 1e-13)

    def finer(self, tolerance: float) -> float | None:
        """A hundredth."""
        return tolerance / 100 if tolerance > 1e-11 else None

    def run(
        self,
        system: Any,
        start: Any,
        parameters: Any,
        times: np.ndarray,
        tolerance: float,
        *,
        dense: bool = False,
        watch: Any = None,
        longest: float = math.inf,
    ) -> Run:
        """One call of solve_ivp, up to where the guard falls through zero."""
        values, y0 = [float(x) for x in parameters], np.array([float(x) for x in start])
        span = float(times[0]), float(times[-1])
        if span[0] == span[1]:
            return Run(times[:1], y0[None], span[0], y0, "done", 0, 0, 0.0, 0.0)

        def guard(_: float, y: np.ndarray) -> float:
            return min(system.guard_at(y.tolist(), values), 1.0)

        guard.terminal, guard.direction = True, -1  # type: ignore[attr-defined]  # as scipy asks
        found = scipy.integrate.solve_ivp(
            system.scalar_rates(values), span, y0, "DOP853", rtol=tolerance, atol=tolerance / 10,
            dense_output=True, events=guard, max_step=longest,
        )  # fmt: skip
        reached = float(found.t[-1])
        here = times[np.abs(times - span[0]) <= abs(reached - span[0])]
        outcome = {-1: "stuck", 0: "done", 1: "edge"}[found.status]
        return Run(
            here, found.sol(here).T, reached, found.y[:, -1], outcome, len(found.t) - 1,
            found.nfev, 0.0, 0.0, (lambda t: found.sol(t).T) if dense else None, found.message,
            float(np.abs(np.diff(found.t)).max()),
        )  # fmt: skip


OWN: list[Engine] = [RungeKutta(), Stiff("Radau"), Stiff("LSODA")]
if is_available():
    OWN += [Taylor(), Taylor(64), Taylor(113)]
every_engine = pytest.mark.parametrize("engine", [*OWN, Mine()], ids=lambda engine: engine.name)
# Two engines solve long motions in the normal run, one without heyoka and one of a user.
two_engines = pytest.mark.parametrize(
    "engine", few(2, [*OWN, Mine()]), ids=lambda engine: engine.name
)
ACCURACY = 1e-8


def swing() -> ODE:
    """x'' = -4 x from x = 1: a cosine."""
    return ODE.of({"x": "v", "v": "-4*x"}, [1, 0])


@every_engine
def test_no_step_is_longer_than_the_longest(engine: Engine) -> None:
    """Forwards and backwards, steps stay below the limit and values are right."""
    system, begin = swing().system, np.array([1.0, 0.0])
    for end in (0.5, -0.5):
        times = np.linspace(0.0, end, 4)
        run = engine.run(system, begin, [], times, 1e-6, longest=0.01)
        assert run.steps >= 50
        assert run.longest_step <= 0.01 * (1 + 1e-9)
        assert np.abs(run.states[:, 0].astype(float) - np.cos(2 * times)).max() < 1e-5


@every_engine
def test_samples_and_values_between(engine: Engine) -> None:
    """Samples and values between are right, and the error estimate is not below the true error."""
    solution = solve(swing(), [1.0, 2.0, 3.0], ACCURACY, engine)
    assert solution.engine == engine.name
    truth = np.cos(2 * solution.times)
    error = np.abs(solution["x"].astype(float) - truth).max()
    assert error <= max(solution.error, 1e-15) <= ACCURACY
    times = np.linspace(0.1, 2.9, 7)
    assert solution.at(times)["x"].astype(float) == pytest.approx(np.cos(2 * times), abs=1e-6)
    assert solution.event_times("x", -1)[0] == pytest.approx(np.pi / 4, abs=1e-6)


@every_engine
def test_a_great_circle_over_both_poles(engine: Engine) -> None:
    """A great circle of the sphere, in two charts that end, takes as many stages as it needs."""

    frame = spaces.load("s2").frame
    problem = geodesic(frame, [sp.pi / 2, 0.3], frame_velocity=[1, 1e-3], parameters={"R": 1})
    solution = solve(problem, 6.0, 1e-6, engine)
    z = np.cos(solution.coordinates[:, 0].astype(float))
    speed = np.sqrt(1 + 1e-6)
    assert z == pytest.approx(-np.sin(speed * solution.times.astype(float)) / speed, abs=1e-5)


@two_engines
def test_eighteen_changes_of_charts(engine: Engine) -> None:
    """Great circles beside the poles: the error estimate covers the error to t = 30."""
    problem = geodesic(
        spaces.load("s2").frame, [sp.pi / 2, 0.3], frame_velocity=[1, 1e-3], parameters={"R": 1}
    ).with_charts("s2", "s2_x")
    times = np.linspace(1, 30, 30)
    accuracy = 1e-5 if engine.name == "Stiff(LSODA)" else 1e-6
    solution = solve(problem, times, accuracy, engine)
    speed = np.sqrt(1 + 1e-6)
    truth = np.arccos(np.clip(-np.sin(speed * times) / speed, -1, 1))
    gap = np.abs(solution.coordinates[:, 0].astype(float) - truth).max()
    assert gap <= 40 * solution.error <= 40 * accuracy


class Late(Mine):
    """An engine that passes the guard and reports it afterwards."""

    finds_every_root = True

    def run(self, system: Any, *given: Any, **more: Any) -> Run:
        """The run without the guard, "beyond" where it ended below zero."""
        run = super().run(system.unguarded, *given, **more)
        numbers = [float(x) for x in given[1]]
        if system.guard is not None and system.guard_at([float(x) for x in run.last], numbers) < 0:
            run.outcome = "beyond"
        return run


@pytest.mark.parametrize("finds_every_root", [True, False])
def test_an_engine_that_notices_the_guard_late(finds_every_root: bool) -> None:
    """The solver finds the root itself: an even fall ends where the guard is zero."""
    engine = Late()
    engine.finds_every_root = finds_every_root
    fall = ODE.of({"x": "-1"}, [1], events=[When("x")])
    solution = solve(fall, 3.0, ACCURACY, engine)
    assert (solution.outcome, solution.times[-1]) == ("stopped", pytest.approx(1.0, abs=1e-9))


@every_engine
def test_a_saved_solution_is_the_same_or_is_refused(engine: Engine, tmp_path: Path) -> None:
    """Samples are always kept; values between come from the same engine, or are refused."""
    solution = solve(swing(), [1.0, 2.0, 3.0], ACCURACY, engine)
    solution.save(tmp_path / "swing.npz")
    saved = SavedSolution.load(tmp_path / "swing.npz")
    assert saved.metadata["engine"] == engine.name
    assert saved["x"].tolist() == solution["x"].astype(float).tolist()
    if engine in OWN:
        assert saved.at(0.5)["x"] == solution.at(0.5)["x"]
        assert saved.solution.trajectory.engine == engine
    else:
        with pytest.raises(StartError, match="got one by 'Mine'.*solve `problem` again"):
            saved.at(0.5)
        again = solve(saved.problem, [1.0, 2.0, 3.0], ACCURACY, engine)
        assert again["x"].tolist() == saved["x"].tolist()


@every_engine
def test_a_checkpoint_resumes(engine: Engine, tmp_path: Path) -> None:
    """The second run takes all parts from the file; another engine is refused."""
    runs = [
        solve(swing(), [1.0, 2.0, 3.0], ACCURACY, engine, checkpoint=tmp_path / "run.npz")
        for _ in range(2)
    ]
    assert runs[0]["x"].tolist() == runs[1]["x"].tolist()
    other = RungeKutta(max_evaluations=10**6)
    with pytest.raises(CheckpointError, match="accuracy or engine"):
        solve(swing(), [1.0, 2.0, 3.0], ACCURACY, other, checkpoint=tmp_path / "run.npz")


@two_engines
def test_a_scene_and_what_its_checkpoint_holds(engine: Engine, tmp_path: Path) -> None:
    """A stopped scene is read with the engine that ran it."""
    scene = replace(scenes.load("lagrange_cusp"), accuracy=1e-6)
    whole = scene.run(engine=engine, checkpoint=tmp_path / "run.npz")
    part = partial_result(scene, tmp_path / "run.npz", engine)
    assert part.engine == whole.engine == engine.name
    assert np.abs(part["energy"] - whole["energy"]).max() < 1e-5


class Sampling(Mine):
    """An engine that knows only its samples."""

    def run(self, *given: Any, **more: Any) -> Run:
        """The same run without dense output."""
        return super().run(*given, **{**more, "dense": False})


def test_an_engine_without_dense_output() -> None:
    """Samples are right; between them there is an error that names the engine."""
    solution = solve(swing(), [1.0, 2.0, 3.0], ACCURACY, Sampling())
    assert solution["x"] == pytest.approx(np.cos(2 * solution.times), abs=ACCURACY)
    with pytest.raises(StartError, match="engine Mine: expected Run.dense"):
        solution.at(0.5)


@pytest.mark.parametrize(
    "engine", [x for x in (*OWN, Mine()) if x.precision == 53], ids=lambda engine: engine.name
)
def test_an_ensemble_is_its_members(engine: Engine) -> None:
    """In a batch or one by one, errors of members cover the truth; also in several charts."""
    many = solve_many(swing(), {"x": [1.0, 2.0, 3.0]}, [1.0, 2.0], ACCURACY, engine)
    assert many.finished.all()
    assert many.engine == engine.name
    truth = np.outer([1, 2, 3], np.cos(2 * many.times))
    for x, row, error in zip(many["x"], truth, many.errors, strict=True):
        assert np.abs(x - row).max() <= error * np.abs(row).max() + 1e-15
    frame = spaces.load("s2").frame
    problem = geodesic(frame, [1.5, 0.3], frame_velocity=[1, 1e-3], parameters={"R": 1})
    speeds = [[1.0, 1e-3], [0.2, 0.5]]
    pair = solve_many(problem, None, 3.0, 1e-6, engine, frame_velocities=speeds)
    for k, speed in enumerate(speeds):
        alone = solve(problem.with_start(frame_velocity=speed), 3.0, 1e-6, engine)
        assert pair.coordinates[k, -1] == pytest.approx(alone.coordinates[-1], abs=1e-5)


def test_ensembles_refuse_long_numbers() -> None:
    """solve_many names the engine that has too many bits."""
    long = Mine()
    long.precision = 113
    with pytest.raises(GeomtorsionError, match="expected an engine in double precision, got Mine"):
        solve_many(swing(), [[1, 0], [2, 0]], 1.0, engine=long)


def test_costs_of_an_engine() -> None:
    """The table of costs has a row for the user's engine, with an error that holds."""
    row = price(swing(), 3.0, [1e-6], engines=[Mine()], proofs=[]).rows[0]
    assert row.way == "Mine"
    assert row.claimed is not None
    assert row.holds
    assert row.claimed <= 1e-6


def test_a_sweep_by_an_engine() -> None:
    """A sweep of a scene over two masses agrees between the user's engine and Runge-Kutta."""
    scene = replace(scenes.load("lagrange_cusp"), accuracy=1e-6)
    one, two = (
        scene.sweep({"body.mass": [1.0, 1.1]}, "max nutation", engine=engine)
        for engine in (Mine(), RungeKutta())
    )
    assert one.engine == "Mine"
    assert one["max nutation"] == pytest.approx(two["max nutation"], abs=1e-4)


class Broken(Mine):
    """An engine that breaks one promise."""

    def __init__(self, **changes: Any) -> None:
        self.changes = changes

    def run(self, *given: Any, **more: Any) -> Run:
        """A run with some fields changed."""
        run = super().run(*given, **more)
        return replace(run, **{name: change(run) for name, change in self.changes.items()})


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"states": lambda run: run.states[1:]}, "expected a state at each of 4 times, got 3"),
        (
            {"times": lambda run: run.times[1:], "states": lambda run: run.states[1:]},
            "expected samples at 4 times, got 3",
        ),
        ({"reached": lambda run: 2.5}, "expected a run to 3.0, got one to 2.5"),
        (
            {"outcome": lambda run: "failed"},
            "expected one of the outcomes beyond, done, edge",
        ),
    ],
    ids=["states", "times", "end", "outcome"],
)
def test_what_an_engine_owes(changes: Any, words: str) -> None:
    """A run that breaks a promise is refused with the name of the engine."""
    with pytest.raises(StartError, match="engine Mine: " + words.replace(".", r"\.")):
        solve(swing(), [1.0, 2.0, 3.0], ACCURACY, Broken(**changes))


@pytest.mark.parametrize(
    ("member", "value", "words"),
    [
        ("finer", None, "expected name, precision, .*, got no finer"),
        ("precision", 60, "expected a precision of 53, 64 or 113 to 400 bits, got 60"),
        ("run", None, "expected Taylor.., RungeKutta.., Stiff.."),
    ],
)
def test_what_an_engine_lacks(member: str, value: Any, words: str) -> None:
    """An engine without a member is refused before anything is run."""
    engine = Mine()
    setattr(engine, member, value)
    with pytest.raises(StartError, match=words):
        solve(swing(), 1.0, engine=engine)
