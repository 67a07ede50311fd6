"""The store of compiled integrators, in surroundings of every kind."""

import os
import subprocess
import sys

import pytest

pytest.importorskip("heyoka", reason="the store holds heyoka's integrators")

SOLVE = """
import geomtorsion as gt
print(gt.solve(gt.ODE.of({"x": "-x"}, {"x": 1}), 1.0, engine=gt.Taylor()).complete)
"""


def test_no_home_folder_is_needed():
    """Where there is no place for a cache on the disk, none is kept and nothing is said."""
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
    """In a fresh process the first solution says what compilation took; the second took none."""
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run(
        [sys.executable, "-c", COST],
        capture_output=True, text=True, timeout=60, check=False, env=env,
    )  # fmt: skip
    assert done.stdout.split() == ["True", "True"], done.stderr


LIMIT = """
import sys, heyoka
import geomtorsion as gt
heyoka.llvm_state.set_diskcache_limit(int(sys.argv[1]))
gt.solve(gt.ODE.of({"x": "-x"}, {"x": 1}), 1.0, engine=gt.Taylor())
print(heyoka.llvm_state.get_diskcache_limit())
"""


@pytest.mark.parametrize(("before", "after"), [(2**34, 2**30), (2**28, 2**28)])
def test_little_is_kept_on_the_disk(before, after, tmp_path):
    """No more than a gigabyte of compiled code; a smaller limit, which somebody set, stays."""
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run(
        [sys.executable, "-c", LIMIT, str(before)],
        capture_output=True, text=True, timeout=60, check=False, env=env | {"HOME": str(tmp_path)},
    )  # fmt: skip
    assert done.stdout.strip() == str(after), done.stderr
