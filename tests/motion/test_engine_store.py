"""The store of compiled integrators, in surroundings of every kind."""

import os
import subprocess
import sys

import pytest

pytest.importorskip("heyoka", reason="the store holds heyoka's integrators")

SOLVE = """
import geomtorsion as gt
print(gt.solve(gt.flow({"x": "-x"}, {"x": 1}), 1.0, engine=gt.Taylor()).complete)
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
