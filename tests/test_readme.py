"""The README is executed: its Python, its tetrad file and its commands."""

import doctest
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import geomtorsion
from geomtorsion.cli.app import app
from geomtorsion.spaces import read_file
from tests.materials.crystals.making import copper_screw, written
from tests.materials.images.atoms import crystal
from tests.materials.maps.synthetic import bent
from tests.materials.maps.test_map_files import ctf, write

# A flat field of 24 x 20 nodes, and a picture of 256 x 256 pixels with a dislocation.
FIELD = np.broadcast_to(np.eye(2)[:, :, None, None], (2, 2, 24, 20)).copy()
PICTURE = crystal(256, "square").values.astype("float32")
ROOT = Path(__file__).parent.parent
TEXT = (ROOT / "README.md").read_text("utf-8")
EXPECTED_PYTHON = 45
EXPECTED_COMMANDS = 19


def blocks(language: str) -> list[str]:
    """Fenced blocks of a language."""
    return re.findall(rf"^```{language}\n(.*?)^```", TEXT, re.MULTILINE | re.DOTALL)


COMMANDS = [
    line.split("#")[0].strip()
    for block in blocks("sh")
    for line in block.splitlines()
    if line.startswith("geomtorsion ")
]
# All exercises in two variants each: tests of the exports export them one by one. Pages of all
# tabs: the test of the lesson in examples/classroom.md exports them.
LONG = (
    "geomtorsion exercises export --to stack -o moodle",
    "geomtorsion lab --export course",
)
INSTALLING = [line for block in blocks("sh") for line in block.splitlines() if "venv" in line]


def test_python_is_true():
    """What the README shows in Python is what happens."""
    text = "\n".join(blocks("pycon"))
    test = doctest.DocTestParser().get_doctest(text, {}, "README.md", "README.md", 0)
    assert len(test.examples) >= EXPECTED_PYTHON
    report: list[str] = []
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS, verbose=False)
    runner.run(test, out=report.append)
    assert not runner.failures, "".join(report)


def test_the_tetrad_file_is_read(tmp_path):
    """The file in the README is a tetrad file, and its story is true."""
    text, _ = blocks("toml")
    file = tmp_path / "own.toml"
    file.write_text(text, "utf-8")
    frame = read_file(file).frame
    assert frame.quantity("riemann").is_zero
    assert not frame.quantity("torsion").is_zero


def test_the_scene_file_is_read(tmp_path):
    """The other file in the README is a scene, and it runs."""
    _, text = blocks("toml")
    file = tmp_path / "top.toml"
    file.write_text(text, "utf-8")
    result = geomtorsion.scenes.read_file(file).run()
    assert result.complete
    assert result.error < result.accuracy


def test_commands_are_found():
    """As many as the README should show."""
    assert len(COMMANDS) >= EXPECTED_COMMANDS
    assert set(LONG) <= set(COMMANDS)


@pytest.mark.parametrize(
    "command",
    [pytest.param(x, marks=pytest.mark.slow) if x in LONG else x for x in COMMANDS],
)
def test_commands_run(command, tmp_path, monkeypatch):
    """Each command ends well and says something; some read crystals, atoms, arrays, pictures."""
    monkeypatch.chdir(tmp_path)
    write(tmp_path, ctf(bent((12, 14), 0.1)), "scan.ctf")
    for name, library, make in (
        ("field.zarr", "zarr", lambda zarr: zarr.save_array("field.zarr", FIELD)),
        ("lattice.tif", "tifffile", lambda tifffile: tifffile.imwrite("lattice.tif", PICTURE)),
    ):
        if name in command:
            make(pytest.importorskip(library))
    written(tmp_path, copper_screw())
    result = CliRunner().invoke(app, shlex.split(command)[1:])
    assert result.exit_code == 0, result.output
    assert result.output.strip()


def test_the_flow_names_every_package():
    """Each package has a row, and each row is a package."""
    rows = set(re.findall(r"^\| `(\w+)/` \|", TEXT, re.MULTILINE))
    folders = {path.parent.name for path in Path(geomtorsion.__file__).parent.glob("*/__init__.py")}
    assert rows == folders


def test_what_measured_the_figures_is_there():
    """Every test and benchmark that the README names can be run."""
    named = set(re.findall(r"\btests/[\w/]+(?:\.py)?", TEXT))
    named |= {name.replace(".", "/") + ".py" for name in re.findall(r"-m (tests\.[\w.]+\w)", TEXT)}
    assert len(named) >= 8
    assert not [name for name in named if not (ROOT / name).exists()]


def test_the_two_commands_stand_there_once():
    """One line installs and runs, one installs and tests, and one builds the site, further down.

    .ci/run takes them from here.
    """
    assert len(INSTALLING) == 3
    run, test, site = INSTALLING
    assert "'.[docs]'" in site
    assert "sphinx-build -q -W" in site
    assert site.endswith("examples/site build/site")
    assert run.endswith("geomtorsion report so3 -o so3-report")
    assert "'.[test]'" in test
    assert test.endswith("pytest -q -n auto")
    script = (ROOT / ".ci" / "run").read_text("utf-8")
    assert "README.md" in script
    assert "pytest" not in script, "the test command would stand twice"


def test_version_stands_once():
    """Version and Python floor stand in pyproject.toml and nowhere else in the package."""
    project = (ROOT / "pyproject.toml").read_text("utf-8")
    version = re.search(r'^version = "(.+)"$', project, re.MULTILINE)
    assert version
    for file in (ROOT / "geomtorsion").rglob("*.py"):
        assert f'"{version[1]}"' not in file.read_text("utf-8"), file.name
