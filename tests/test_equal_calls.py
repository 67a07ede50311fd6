"""Equal calls: they give equal bits after any other calls, in any thread and any process."""

from __future__ import annotations

import hashlib
import json
import os
import random
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import geomtorsion as gt
from tests.golden.calls import MOMENTS, ORBIT, SPIN, START, heavy_top, kerr, ode, pushed, so3

ACCURACIES = (1e-6, 1e-9, 1e-12)
# Numbers of calls in the normal run and in the long run.
CALLS = [400, pytest.param(2000, marks=pytest.mark.slow)]
# Slow engines are called less often: this many of a hundred calls.
SELDOM = 2


def pendulum() -> Any:
    """A pendulum, whose digits once changed after some hundred calls."""
    return ode({"x": "v", "v": "-sin(x)"}, [2.0, 0.0])


def top() -> Any:
    """A free top with its attitude."""
    return gt.geodesic(so3, START, frame_velocity=SPIN, metric=MOMENTS)


def orbit() -> Any:
    """A bound orbit of a Kerr black hole."""
    return gt.geodesic(kerr, causal=None, **ORBIT)


PROBLEMS: dict[str, tuple[Callable[[], Any], float]] = {
    "pendulum": (pendulum, 50.0),
    "pushed": (pushed, 4.0),
    "top": (top, 20.0),
    "orbit": (orbit, 100.0),
    "line": (lambda: gt.autoparallel(gt.cartan(so3), START, frame_velocity=SPIN), 20.0),
}
CURVES = ("top", "orbit", "line")
MADE = {name: make() for name, (make, _) in PROBLEMS.items()}
FAST = [(name, accuracy, "default") for name in PROBLEMS for accuracy in ACCURACIES]
SLOW = [(name, 1e-8, "RungeKutta") for name in PROBLEMS]
SLOW += [("scene", 1e-9, "default"), ("many", 1e-9, "default")]
SPEEDS = np.random.default_rng(5).normal(size=(20, 3))
Key = tuple[str, float, str]


def solved(key: Key, *, anew: bool) -> str:
    """Digest of a solution, of a new problem or of the problem that is kept."""
    name, accuracy, engine = key
    if name == "scene":
        result = heavy_top(t=0.5, accuracy=accuracy).run()
        return digits(result.error, result.times, *result.values.values())
    if name == "many":
        many = gt.solve_many(top(), None, 5.0, accuracy, frame_velocities=SPEEDS)
        return digits(many.errors, many.coordinates, many.frame_velocity)
    make, end = PROBLEMS[name]
    problem = make() if anew else MADE[name]
    chosen = gt.RungeKutta() if engine == "RungeKutta" else None
    solution = gt.solve(problem, end, accuracy, chosen)
    if name in CURVES:
        return digits(solution.error, solution.times, solution.coordinates, solution.velocity)
    return digits(solution.error, solution.times, solution.states)


def digits(*arrays: Any) -> str:
    """Digest of each bit."""
    found = hashlib.sha256()
    for array in arrays:
        found.update(np.ascontiguousarray(array, dtype=float).tobytes())
    return found.hexdigest()


def shuffled(seed: int, count: int) -> list[Key]:
    """Keys of `count` calls, shuffled, with each kind among them."""
    rng = random.Random(seed)
    keys = [*FAST, *SLOW]
    keys += [
        rng.choice(SLOW if rng.random() < SELDOM / 100 else FAST) for _ in range(count - len(keys))
    ]
    rng.shuffle(keys)
    return keys


def of_a_process(seed: int, count: int) -> dict[str, list[str]]:
    """Digests of each kind of call from a fresh process with its own order of calls."""
    program = "import sys, tests.test_equal_calls as o; o.print_digests(*map(int, sys.argv[1:]))"
    done = subprocess.run(
        [sys.executable, "-c", program, str(seed), str(count)],
        capture_output=True,
        text=True,
        check=True,
        cwd=Path(__file__).parent.parent,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
    )
    return json.loads(done.stdout)


def print_digests(seed: int, count: int) -> None:
    """Print the digests that such a process found."""
    print(json.dumps(gathered([(key, solved(key, anew=False)) for key in shuffled(seed, count)])))


def gathered(found: list[tuple[Key, str]]) -> dict[str, list[str]]:
    """All different digests of each kind of call."""
    kinds: dict[str, set[str]] = {}
    for key, bits in found:
        kinds.setdefault(" ".join(map(str, key)), set()).add(bits)
    return {kind: sorted(bits) for kind, bits in kinds.items()}


def unlike(found: dict[str, list[str]], first: dict[str, list[str]]) -> list[str]:
    """Kinds of calls that gave several digests, or another one than at first."""
    return [kind for kind, bits in first.items() if found[kind] != bits]


@pytest.fixture(scope="module")
def first() -> dict[str, list[str]]:
    """Digests of each kind of call, each made once."""
    return gathered([(key, solved(key, anew=True)) for key in [*FAST, *SLOW]])


def test_unlike_solutions_have_unlike_digits(first):
    """Solutions of unlike accuracy or problem have unlike digests, so the comparison can fail."""
    assert len(first) == len(FAST) + len(SLOW)
    assert len({bits for (bits,) in first.values()}) == len(first)


@pytest.mark.parametrize("calls", CALLS)
def test_calls_in_any_order(first, calls):
    """Half of the calls, shuffled, of kept and of new problems, give the same bits."""
    keys = shuffled(1, calls // 2)
    found = [(key, solved(key, anew=n % 4 == 0)) for n, key in enumerate(keys)]
    assert unlike(gathered(found), first) == []


@pytest.mark.parametrize("calls", CALLS)
def test_calls_in_threads(first, calls):
    """Three tenths of the calls, in four threads at once, of kept problems, give the same bits."""
    keys = shuffled(2, 3 * calls // 10)
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda key: (key, solved(key, anew=False)), keys))
    assert unlike(gathered(found), first) == []


@pytest.mark.parametrize("calls", CALLS)
@pytest.mark.parametrize("seed", [3, pytest.param(4, marks=pytest.mark.slow)])
def test_calls_in_fresh_processes(first, seed, calls):
    """A tenth of the calls, in a fresh process and another order, give the same bits."""
    assert unlike(of_a_process(seed, calls // 10), first) == []
