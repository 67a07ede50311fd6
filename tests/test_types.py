"""Types: type checkers find each planted mistake in code that uses the package, and no others."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import geomtorsion

ROOT = Path(__file__).parents[1]
CLIENT = '''"""A client with twelve mistakes."""

import sympy as sp  # type: ignore[import-untyped]

import geomtorsion as gt

r, phi = sp.symbols("r phi", positive=True)
frame = gt.Frame([r, phi], [[1, 0], [0, r]])
straight = gt.autoparallel(gt.cartan(frame), [1.0, 0.0], [0.0, 1.0])
solution = gt.solve(straight, t=1.0, accuracy=1e-9, engine=gt.RungeKutta())
loop = gt.Loop.circle([1.0, 0.0], 0.1)
vector = gt.burgers_vector(frame, loop)
curvature = gt.levi_civita(frame).curvature.scalar + 1
numbers = gt.numpy_function(frame.metric, [r])([1.0, 2.0]).sum()
more = frame.metric.at({r: [1, 2]}).sum()
scene = gt.scenes.load("dzhanibekov")
print(solution.error < 1e-9, vector.error, frame.metric[0, 0], gt.read("own.toml").frame)
print(gt.__version__.split("."), gt.spaces.load("kerr").story, gt.exercises.load("1.1").hints)

gt.solve("nonsense", t=1.0)  # mistake
gt.solve(straight, tt=3)  # mistake
gt.solve(straight, t=1.0, accuracy="fine")  # mistake
gt.cartan(loop)  # mistake
gt.levi_civita()  # mistake
gt.Loop.circle([1.0, 0.0])  # mistake
gt.burgers_vector(loop, frame)  # mistake
print(solution.eror)  # mistake
print(frame.metrics)  # mistake
gt.Taylor(precision="double")  # mistake
gt.geodessic(frame, [1.0, 0.0], [0.0, 1.0])  # mistake
frame.metric.raised("a")  # mistake
'''
PLANTED = {k for k, line in enumerate(CLIENT.splitlines(), 1) if line.endswith("# mistake")}


def lines_found(checker, tmp_path, client=CLIENT):
    """Numbers of the lines in which a checker reports errors."""
    (tmp_path / "client.py").write_text(client, "utf-8")
    options = {
        "mypy": ["--strict", "--cache-dir", str(tmp_path / "cache"), "client.py"],
        "pyright": ["--pythonpath", sys.executable, "client.py"],
    }
    run = subprocess.run(
        [sys.executable, "-m", checker, *options[checker]],
        cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT), "MYPYPATH": str(ROOT)},
        capture_output=True, text=True, check=False, timeout=500,
    )  # fmt: skip
    assert run.returncode == 1, run.stdout + run.stderr
    found = re.findall(r"client\.py:(\d+):(?:\d+ -)? error", run.stdout)
    assert "Found 0" not in run.stdout
    return {int(line) for line in found}


# mypy reads the whole package, which takes as long as a hundred other tests.
@pytest.mark.parametrize("checker", [pytest.param("mypy", marks=pytest.mark.slow), "pyright"])
def test_planted_mistakes(checker, tmp_path):
    """A checker reports the twelve mistakes and nothing else."""
    pytest.importorskip(checker)
    assert len(PLANTED) == 12
    assert lines_found(checker, tmp_path) == PLANTED


def test_wrong_calls_are_refused_and_right_ones_pass(tmp_path):
    """A checker refuses each line that is marked as wrong, and no other line."""
    pytest.importorskip("pyright")
    client = (ROOT / "tests" / "data" / "typed_client.txt").read_text("utf-8")
    wrong = {k for k, line in enumerate(client.splitlines(), 1) if line.endswith("# wrong")}
    assert len(wrong) >= 30
    assert lines_found("pyright", tmp_path, client) == wrong


def test_the_package_is_marked_as_typed():
    """The package has the file py.typed, without which checkers ignore its types."""
    assert (Path(geomtorsion.__file__).parent / "py.typed").exists()


def test_every_public_name_is_declared():
    """Each name that is loaded on demand is declared for type checkers."""
    text = Path(geomtorsion.__file__).read_text("utf-8")
    seen = text[text.index("if TYPE_CHECKING") : text.index("_LATER")]
    missing = [name for name in geomtorsion._HOME if not re.search(rf"\b{name}\b", seen)]
    assert not missing
    assert len(geomtorsion._HOME) > 60


def test_version():
    """The package reports the version in pyproject.toml."""
    text = (ROOT / "pyproject.toml").read_text("utf-8")
    stated = re.search(r'^version = "(.*)"$', text, re.MULTILINE)
    assert stated is not None
    assert geomtorsion.__version__ == stated[1]
    assert "__version__" in dir(geomtorsion)


def test_the_version_is_the_same_everywhere():
    """Changelog and citation in the README have the version, and the same date."""
    changes = (ROOT / "CHANGELOG.md").read_text("utf-8")
    sections = re.findall(r"^## \[(\d[\d.]*)\] - (\d{4}-\d{2}-\d{2})$", changes, re.MULTILINE)
    version, date = sections[0]
    assert version == geomtorsion.__version__
    readme = (ROOT / "README.md").read_text("utf-8")
    assert f"version = {{{version}}}" in readme
    assert f"date    = {{{date}}}" in readme
