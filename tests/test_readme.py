"""README: the Python, commands and scene file in it and in pages of the site are executed."""

import doctest
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import geomtorsion
from geomtorsion.cli.app import app
from geomtorsion.materials.lines import DislocationNetwork
from tests.materials.crystals.making import copper_screw, written
from tests.materials.images.atoms import crystal
from tests.materials.lines.synthetic_networks import rings
from tests.materials.maps.synthetic import bent
from tests.materials.maps.test_map_files import ctf, write

# A flat field of 24 x 20 nodes, and a picture of 256 x 256 pixels with a dislocation.
FIELD = np.broadcast_to(np.eye(2)[:, :, None, None], (2, 2, 24, 20)).copy()
PICTURE = crystal(256, "square").values.astype("float32")
ROOT = Path(__file__).parent.parent
README = ROOT / "README.md"
TEXT = README.read_text("utf-8")
LONGEST_README = 200
# Markdown pages of the site, and the pages whose Python examples show their results.
PAGES = sorted((ROOT / "examples" / "site").glob("**/*.md"))
PAGES = [page for page in PAGES if page.parent.name != "pages"]
EXAMPLES = [page for page in (README, *PAGES) if "```pycon" in page.read_text("utf-8")]
EXPECTED_PYTHON = 120
EXPECTED_COMMANDS = 34


def blocks(language: str, text: str = TEXT) -> list[str]:
    """Fenced blocks in a language."""
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


def examples(page: Path) -> doctest.DocTest:
    """The Python of a page, with its results, as `python -m doctest` finds it."""
    text = page.read_text("utf-8")
    return doctest.DocTestParser().get_doctest(text, {}, page.name, str(page), 0)


COMMANDS = [
    line.split("#")[0].strip()
    for page in (README, ROOT / "examples" / "site" / "howto" / "commands.md")
    for block in blocks("sh", page.read_text("utf-8"))
    for line in block.splitlines()
    if line.startswith("geomtorsion ")
]
# The first exports all exercises, and tests of the exports cover them one by one. The second
# exports all tabs, and the test of the lesson in examples/classroom.md covers them. The third is
# an example that test_ringing.py runs, and tests/cli/commands has the others with other values.
LONG = (
    "geomtorsion exercises export --to stack -o moodle",
    "geomtorsion lab --export pages",
    "geomtorsion ringing schwarzschild --set M=1",
    'geomtorsion count -L "T + c*T**2" --dimension 3',
    "geomtorsion price lagrange_cusp --t 1",
    "geomtorsion shadow kerr --set a=0.9 -o shadow",
)
INSTALLING = [line for block in blocks("sh") for line in block.splitlines() if "venv" in line]


def test_it_is_short():
    """The README is at most 200 lines long; details are on the site."""
    assert len(TEXT.splitlines()) <= LONGEST_README


def test_links_lead_to_files():
    """Each file that the README links or shows exists."""
    linked = re.findall(r"\]\(([^)#]+)\)", TEXT)
    assert len(linked) > 20
    assert not [name for name in linked if not (ROOT / name).is_file()]


@pytest.mark.parametrize("page", EXAMPLES, ids=lambda page: page.stem)
def test_python_is_true(page):
    """The code of the README and of each page returns the results that the page shows."""
    report: list[str] = []
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS, verbose=False)
    runner.run(examples(page), out=report.append)
    assert not runner.failures, "".join(report)


def test_python_is_found():
    """The pages contain at least the expected number of examples."""
    assert README in EXAMPLES
    assert sum(len(examples(page).examples) for page in EXAMPLES) >= EXPECTED_PYTHON


def test_the_scene_file_is_read(tmp_path):
    """The scene file of its page is a scene, and it runs."""
    page = ROOT / "examples" / "site" / "howto" / "scene_file.md"
    [text] = blocks("toml", page.read_text("utf-8"))
    file = tmp_path / "top.toml"
    file.write_text(text, "utf-8")
    result = geomtorsion.scenes.read_file(file).run()
    assert result.complete
    assert result.error < result.accuracy


def test_commands_are_found():
    """The README and the page of commands show at least the expected number of commands."""
    assert len(COMMANDS) >= EXPECTED_COMMANDS
    assert set(LONG) <= set(COMMANDS)


@pytest.mark.parametrize(
    "command",
    [pytest.param(x, marks=pytest.mark.slow) if x in LONG else x for x in COMMANDS],
)
def test_commands_run(command, tmp_path, monkeypatch):
    """Each command ends with code 0 and prints something; some read maps, images, atoms, lines."""
    monkeypatch.chdir(tmp_path)
    write(tmp_path, ctf(bent((12, 14), 0.1)), "scan.ctf")
    for name, library, make in (
        ("field.zarr", "zarr", lambda zarr: zarr.save_array("field.zarr", FIELD)),
        ("lattice.tif", "tifffile", lambda tifffile: tifffile.imwrite("lattice.tif", PICTURE)),
    ):
        if name in command:
            make(pytest.importorskip(library))
    written(tmp_path, copper_screw())
    if "cosmology.toml" in command:
        page = ROOT / "examples" / "site" / "tutorials" / "universe.md"
        [text] = blocks("toml", page.read_text("utf-8"))
        Path("cosmology.toml").write_text(text, "utf-8")
    if "my-tetrad.toml" in command:
        Path("my-tetrad.toml").write_text(geomtorsion.spaces.load("s2").frame.to_toml(), "utf-8")
    if "slice.npz" in command:
        flat = np.broadcast_to(np.eye(3)[:, :, None, None, None], (3, 3, 9, 9, 9))
        x = np.linspace(0, 1, 9)
        still = np.zeros_like(flat)
        np.savez("slice.npz", metric=flat, extrinsic_curvature=still, axis_x=x, axis_y=x, axis_z=x)
    if "chains.data" in command:
        DislocationNetwork.of_arrays(rings(20, seed=6)).save("chains.data")
    if "oscillator.toml" in command:
        text = 'rates = {x = "v", v = "(1-x**2)*v-x"}\nstart = {x = 2, v = 0}\n'
        Path("oscillator.toml").write_text(text, "utf-8")
    if "track.csv" in command:
        rows = "\n".join(f"{t},{1.5 + t / 100},{0.5 * t}" for t in range(1, 5))
        Path("track.csv").write_text(f"t,theta,phi\n{rows}\n", "utf-8")
    result = CliRunner().invoke(app, shlex.split(command)[1:])
    assert result.exit_code == 0, result.output
    assert result.output.strip()


def test_the_flow_names_every_package():
    """Each package has a row, and each row is a package."""
    text = (ROOT / "examples" / "site" / "design.md").read_text("utf-8")
    rows = set(re.findall(r"^\| `(\w+)/` \|", text, re.MULTILINE))
    folders = {path.parent.name for path in Path(geomtorsion.__file__).parent.glob("*/__init__.py")}
    assert rows == folders


def test_what_measured_the_figures_is_there():
    """Every test and benchmark that the README or a page names can be run."""
    text = "\n".join(page.read_text("utf-8") for page in (README, *PAGES))
    named = set(re.findall(r"\btests/[\w/]+(?:\.py)?", text))
    names = re.findall(r"-m\s(tests\.[\w.]+\w)", text)
    named |= {name.replace(".", "/") + ".py" for name in names}
    assert len(named) >= 8
    assert not [name for name in named if not (ROOT / name).exists()]


def test_each_command_occurs_once():
    """One line installs and runs, one installs and tests, and a later one builds the site.

    .ci/run reads these lines from the README.
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
    assert "pytest" not in script, "the test command would occur twice"


def test_version_occurs_once():
    """The package does not repeat the version of pyproject.toml."""
    project = (ROOT / "pyproject.toml").read_text("utf-8")
    version = re.search(r'^version = "(.+)"$', project, re.MULTILINE)
    assert version
    for file in (ROOT / "geomtorsion").rglob("*.py"):
        assert f'"{version[1]}"' not in file.read_text("utf-8"), file.name
