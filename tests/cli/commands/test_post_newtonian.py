"""The command `post-newtonian`: text, numbers, files and refusals."""

import json
from pathlib import Path

from geomtorsion.cli.exits import ExitCode
from geomtorsion.gravity import perturbed
from tests.cli import running

TORSION = ("post-newtonian", "-L", "T + c*vector2", "-g", "teleparallel")


def test_text_equals_the_library() -> None:
    text = running.run(*TORSION).stdout
    assert text.split() == str(perturbed.post_newtonian("T + c*vector2", "teleparallel")).split()


def test_json_files_and_values(tmp_path: Path) -> None:
    """JSON on the screen and in the file agree; --set gives numbers."""
    folder = tmp_path / "out"
    shown = running.run(*TORSION, "--set", "c=1/10", "--format", "json", "-o", str(folder))
    document = json.loads(shown.stdout)
    assert document == json.loads((folder / "post_newtonian.json").read_text())
    assert (folder / "post_newtonian.png").stat().st_size > 1000
    assert (document["gamma"], document["tests"][0]["passes"]) == ("14/13", "False")


def test_scalar_fields_have_values_far_away() -> None:
    text = running.run(
        "post-newtonian", "-L", "phi*R/2 - X/phi", "-g", "riemannian", "--scalars", "phi",
        "--far", "phi=1",
    ).stdout  # fmt: skip
    assert "gamma = 3/4, beta = 1, G = 8/7" in text


def test_refusals_name_the_remedy() -> None:
    for arguments, words in (
        (["post-newtonian"], "-L 'T + c*vector2' -g teleparallel"),
        ([*TORSION, "--set", "d=1"], "expected"),
        ([*TORSION, "--set", "c"], "--set"),
        ([*TORSION, "--far", "phi=1"], "scalar field"),
    ):
        result = running.run(*arguments, code=ExitCode.wrong_input)
        assert words in result.stderr
