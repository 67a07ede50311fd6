"""Executors: equal bits for any number of workers, and results that survive a failure."""

import multiprocessing
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import ArgumentError, WorkerError

SWING = gt.ODE.of(
    {"x": "v", "v": "-k*sin(x)"}, [1, 0], parameters={"k": 1}, events=[gt.At(0.5, {"k": 2})]
)
# One part of the job has 3072 members of two states.
NUMBER, PART = 4000, 3072
DRAWS = np.random.default_rng(0)
STARTS = {"x": DRAWS.uniform(-2, 2, NUMBER), "v": DRAWS.uniform(-1, 1, NUMBER)}
SCREW = gt.spaces.load("screw_dislocation")
CENTRES = DRAWS.uniform(-8, 8, (10_000, 3))


class Here(Executor):
    """Calls functions at once; some calls fail as the test wants."""

    def __init__(self, fails: Callable[[int], BaseException | None] = lambda _: None) -> None:
        self.fails, self.calls = fails, 0

    def submit(self, fn: Callable[..., Any], /, *args: Any, **_: Any) -> Future[Any]:
        """The future of a call that is done."""
        future: Future[Any] = Future()
        self.calls += 1
        error = self.fails(self.calls)
        if error is None:
            future.set_result(fn(*args))
        else:
            future.set_exception(error)
        return future


@pytest.fixture(scope="module")
def processes() -> Iterator[Executor]:
    """Two worker processes."""
    context = multiprocessing.get_context("forkserver")
    with ProcessPoolExecutor(2, mp_context=context) as pool:
        yield pool


@pytest.fixture(scope="module")
def serial() -> gt.ode.Ensemble:
    """The ensemble without an executor."""
    return gt.solve_many(SWING, STARTS, [0.25, 1.0], 1e-8)


def same(one: gt.ode.Ensemble, two: gt.ode.Ensemble) -> bool:
    """Whether two ensembles have the same bits."""
    return all(
        np.array_equal(a, b, equal_nan=True)
        for a, b in [(one["x"], two["x"]), (one["v"], two["v"]), (one.errors, two.errors)]
    )


def test_processes_give_the_same_bits(serial, processes):
    """Two processes, across an event at a time."""
    assert same(serial, gt.solve_many(SWING, STARTS, [0.25, 1.0], 1e-8, executor=processes))


@pytest.mark.parametrize("workers", [1, 3])
def test_threads_give_the_same_bits(serial, workers):
    """Any number of workers."""
    with ThreadPoolExecutor(workers) as pool:
        assert same(serial, gt.solve_many(SWING, STARTS, [0.25, 1.0], 1e-8, executor=pool))


def test_stacked_members_give_the_same_bits():
    """A method that steps many members together steps the same ones together."""
    engine, pool = gt.RungeKutta(), Here()
    plain = gt.solve_many(SWING, STARTS, 0.4, 1e-6, engine)
    assert same(plain, gt.solve_many(SWING, STARTS, 0.4, 1e-6, engine, executor=pool))
    assert pool.calls >= 4


def test_members_that_leave_their_chart(processes):
    """Those over the pole are sent one by one."""
    sphere = gt.geodesic("s2", [1.0, 0.0], velocity=[1.0, 0.0], parameters={"R": 1})
    slopes = [[-1.0, x] for x in (0.0, 0.01, 0.5, 1.0)]
    starts = [[1.0, 0.1]] * 4
    plain = gt.solve_many(sphere, starts, 2.0, 1e-8, velocities=slopes)
    sent = gt.solve_many(sphere, starts, 2.0, 1e-8, velocities=slopes, executor=processes)
    assert plain.finished.all()
    assert np.array_equal(plain["theta"], sent["theta"])
    assert np.array_equal(plain.errors, sent.errors)


def test_loops_give_the_same_bits(processes):
    """Many circles, some of which enclose the dislocation or pass near it."""
    options = {"parameters": {"b": 0.5}, "accuracy": 1e-8}
    plain = gt.burgers_vectors(SCREW, CENTRES, 0.2, **options)
    sent = gt.burgers_vectors(SCREW, CENTRES, 0.2, executor=processes, **options)
    assert sent.complete
    assert plain.enclosed.any()
    for name in ("vectors", "density", "errors", "expected", "enclosed"):
        one, two = getattr(plain, name), getattr(sent, name)
        assert np.array_equal(one, two, equal_nan=True), name
    edges = (np.linspace(-1, 1, 12), np.linspace(-1, 1, 12))
    grid = gt.burgers_map(SCREW, edges, executor=Here(), **options)
    assert np.array_equal(grid.vectors, gt.burgers_map(SCREW, edges, **options).vectors)


def test_dask_gives_the_same_bits(serial):
    """A client of dask, on threads of this process."""
    distributed = pytest.importorskip("dask.distributed")
    with distributed.Client(
        processes=False, n_workers=1, threads_per_worker=2, dashboard_address=":0"
    ) as client:
        assert same(serial, gt.solve_many(SWING, STARTS, [0.25, 1.0], 1e-8, executor=client))


def test_a_failed_worker_is_reported_with_its_members():
    """Finished members are kept; the error names the others."""
    pool = Here(lambda call: BrokenProcessPool("a process was killed") if call == 1 else None)
    with pytest.raises(WorkerError, match="a process was killed") as caught:
        gt.solve_many(SWING, STARTS, 0.4, 1e-8, executor=pool)
    assert f"none for {PART} members" in str(caught.value)
    assert "member" in str(caught.value)
    assert not caught.value.partial.finished[:PART].any()
    assert caught.value.partial.interrupted


def test_a_failed_block_of_loops_is_reported():
    """The vectors of the other blocks are kept."""
    pool = Here(lambda call: MemoryError("too little memory") if call == 2 else None)
    with pytest.raises(WorkerError, match="got none for loops [1-9]") as caught:
        gt.burgers_vectors(SCREW, CENTRES, 0.2, parameters={"b": 0.5}, executor=pool)
    assert "MemoryError: too little memory" in str(caught.value)
    assert not caught.value.partial.complete


def test_ctrl_c_keeps_finished_work():
    """As without an executor."""
    pool = Here(lambda call: KeyboardInterrupt() if call == 2 else None)
    result = gt.solve_many(SWING, STARTS, 0.4, 1e-8, executor=pool)
    assert result.interrupted
    assert not result.finished.all()
    pool = Here(lambda call: KeyboardInterrupt() if call == 2 else None)
    loops = gt.burgers_vectors(SCREW, CENTRES, 0.2, parameters={"b": 0.5}, executor=pool)
    assert not loops.complete


def test_errors_of_ours_are_raised_as_they_are():
    """A start that no worker can solve."""
    edge = gt.ODE.of({"x": "-1/sqrt(x)"}, [1.0])
    with pytest.raises(gt.GeomtorsionError, match="expected at least one"):
        gt.solve_many(edge, [[0.1], [0.2]], 5.0, 1e-8, executor=Here())


def future_of(value: object) -> Future[Any]:
    """A future that is done."""
    future: Future[Any] = Future()
    future.set_result(value)
    return future


@pytest.mark.parametrize(
    ("returned", "words"),
    [
        (future_of(None), "a future with the result of the submitted call, got one with None"),
        (future_of((0, 1.0)), "a future with the result of the submitted call, got one with"),
        (None, "submit to return a future of concurrent.futures, got None"),
    ],
)
def test_an_executor_that_loses_results(returned, words):
    """A future without the result of its call is an error of a worker."""

    class Losing:
        def submit(self, *_: object) -> object:
            return returned

    for call in (
        lambda pool: gt.solve_many(SWING, STARTS, 1.0, 1e-6, executor=pool),
        lambda pool: gt.burgers_vectors(SCREW, CENTRES, 0.2, parameters={"b": 1}, executor=pool),
    ):
        with pytest.raises(WorkerError, match=words):
            call(Losing())


@pytest.mark.parametrize("executor", [3, "dask", ThreadPoolExecutor, object()])
def test_other_things_are_refused(executor):
    """Only what takes work is an executor."""
    with pytest.raises(ArgumentError, match="expected an object with submit"):
        gt.solve_many(SWING, STARTS, 1.0, executor=executor)
    with pytest.raises(ArgumentError, match="expected an object with submit"):
        gt.burgers_vectors(SCREW, CENTRES, 0.2, parameters={"b": 1}, executor=executor)
