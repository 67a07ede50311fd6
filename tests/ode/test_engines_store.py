"""The store of compiled integrators, in different environments."""

import os
import subprocess
import sys

import numpy as np
import pytest

from geomtorsion.ode import ODE, Taylor

pytest.importorskip("heyoka", reason="the store holds heyoka's integrators")

SOLVE = """
import geomtorsion as gt
print(gt.solve(gt.ODE.of({"x": "-x"}, {"x": 1}), 1.0, engine=gt.Taylor()).complete)
"""


def test_no_home_folder_is_needed():
    """Without a home folder there is no cache on the disk, and no output about it."""
    bare = {
        "PATH": os.environ.get("PATH", ""),
        "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
    }
    done = subprocess.run(
        [sys.executable, "-c", SOLVE],
        capture_output=True, text=True, timeout=60, check=False, env=bare,
    )  # fmt: skip
    assert done.stdout.strip() == "True", done.stderr
    assert not done.stderr


COST = """
import geomtorsion as gt
law = gt.ODE.of({"x": "v", "v": "-sin(x) + x**3/7"}, {"x": 1, "v": 0})
costs = [gt.solve(law, 5.0, engine=gt.Taylor()).cost.compile_seconds for _ in range(2)]
print(costs[0] > 1e-3, costs[1] == 0)
"""


def test_compilation_is_part_of_the_cost():
    """In a fresh process the first solution reports the compile time; the second reports zero."""
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run(
        [sys.executable, "-c", COST],
        capture_output=True, text=True, timeout=60, check=False, env=env,
    )  # fmt: skip
    assert done.stdout.split() == ["True", "True"], done.stderr


LIMIT = """
import pathlib, sys, heyoka
import geomtorsion as gt
law = gt.ODE.of({"x": "-x"}, {"x": 1})
gt.solve(law, 1.0, engine=gt.Taylor())
print(heyoka.llvm_state.get_diskcache_enabled(), list(pathlib.Path.home().rglob("cache.db")))
heyoka.llvm_state.set_diskcache_limit(int(sys.argv[1]))
gt.solve_many(law, [[0.5], [1.0]], 1.0, engine=gt.Taylor())
print(heyoka.llvm_state.get_diskcache_limit())
"""


@pytest.mark.parametrize(("before", "after"), [(2**34, 2**28), (2**20, 2**20)])
def test_little_is_kept_on_the_disk(before, after, tmp_path):
    """One motion uses no disk cache and leaves it switched on; batches keep it small."""
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run(
        [sys.executable, "-c", LIMIT, str(before)],
        capture_output=True, text=True, timeout=60, check=False, env=env | {"HOME": str(tmp_path)},
    )  # fmt: skip
    assert done.stdout.splitlines() == ["True []", str(after)], done.stderr


def test_a_long_run_compiles_nothing_more():
    """After a short run, a much longer run of equal equations uses the same code."""
    stage = ODE.of({"x": "v", "v": "-x - x**3/7"}, [1, 0]).first_stage(53, 0.0)
    given = stage.system, stage.start, stage.parameters
    short, long = (Taylor().run(*given, np.array([0.0, 1.0, t]), 1e-12) for t in (2.0, 4e3))
    assert short.steps < 100 < 3000 < long.steps
    assert short.compile_seconds > 0 == long.compile_seconds
    assert short.states[1].tolist() == long.states[1].tolist()
