"""The command `spectrum`: text, numbers, files and refusals."""

import json
from pathlib import Path

from geomtorsion.cli.exits import ExitCode
from geomtorsion.gravity import perturbed
from tests.cli import running

STAROBINSKY = ("spectrum", "-L", "R/2 + c*R**2", "-g", "riemannian")


def test_text_equals_the_library() -> None:
    """The command prints the spectrum as Python does."""
    text = running.run(*STAROBINSKY).stdout
    assert text.split() == str(perturbed.spectrum("R/2 + c*R**2", "riemannian")).split()


def test_json_files_and_values(tmp_path: Path) -> None:
    """JSON on the screen and in the file agree; --set counts again."""
    folder = tmp_path / "out"
    shown = running.run(*STAROBINSKY, "--set", "c=1/12", "--format", "json", "-o", str(folder))
    document = json.loads(shown.stdout)
    assert document == json.loads((folder / "spectrum.json").read_text())
    assert (folder / "spectrum.png").stat().st_size > 1000
    (scalar,) = [x for x in document["particles"] if not x["massless"]]
    assert (scalar["mass2"], scalar["energy"], document["healthy"]) == ("1", "1", "True")
    zero = running.run(*STAROBINSKY, "--set", "c=0", "--format", "json")
    assert json.loads(zero.stdout)["degrees_of_freedom"] == 2


def test_a_named_theory_knows_its_geometry() -> None:
    assert "2 degrees of freedom" in running.run("spectrum", "-L", "tegr").stdout


def test_refusals_name_the_remedy() -> None:
    for arguments, words in (
        (["spectrum"], "-L 'R/2 + c*R**2' -g riemannian"),
        (["spectrum", "R/2"], "-L 'R/2'"),
        (["spectrum", "-L", "R/2", "-g", "flat"], "expected one of riemannian"),
        ([*STAROBINSKY, "--set", "d=1"], "expected"),
        ([*STAROBINSKY, "--set", "c"], "--set"),
        ([*STAROBINSKY, "--set", "c=__import__('os')"], "c"),
    ):
        result = running.run(*arguments, code=ExitCode.wrong_input)
        assert words in result.stderr
