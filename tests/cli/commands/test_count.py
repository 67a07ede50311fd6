"""The command `count`: text, numbers, starts near a frame, files and refusals."""

import json
from pathlib import Path

import geomtorsion as gt
from geomtorsion.cli.exits import ExitCode
from geomtorsion.gravity import perturbed
from tests.cli import running

UNIVERSE = """
coordinates = ["t", "x", "y"]
signature = [-1, 1, 1]
coframe = { "0,0" = 1, "1,1" = "sqrt(1 + t)", "2,2" = "sqrt(1 + t)" }
"""

METRIC = ["count", "-L", "R", "-c", "levi-civita"]


def test_text_equals_the_library() -> None:
    """The command prints the answer as Python does."""
    text = running.run("count", "-L", "-F2/4", "-g", "flat", "--dimension", "3", "--vectors", "1")
    answer = perturbed.degrees_of_freedom("-F2/4", "flat", dimension=3, vectors=1)
    assert text.stdout.split() == str(answer).split()


def test_near_a_frame_with_formulas_of_fields(tmp_path: Path) -> None:
    """f(T) with a scalar field near a universe in which T varies: three."""
    (tmp_path / "universe.toml").write_text(UNIVERSE)
    folder = tmp_path / "out"
    shown = running.run(
        "count", "-L", "T + c*T**2 + X/2", "-c", "cartan", "--dimension", "3",
        "--near", str(tmp_path / "universe.toml"), "--scalars", "phi = log(1 + t)",
        "--set", "c=1/10", "--format", "json", "-o", str(folder),
    )  # fmt: skip
    document = json.loads(shown.stdout)
    assert document == json.loads((folder / "count.json").read_text())
    assert (document["number"], document["branch"]) == ("3", [])
    assert (folder / "count.png").exists() is gt.pictures.can_draw()


def test_refusals_name_the_remedy() -> None:
    for arguments, words in (
        (["count"], "-L 'T + c*T**2' -g teleparallel"),
        ([*METRIC, "--near", "schwarzschild"], "without parameters"),
        ([*METRIC, "--dimension", "3", "--near", "kerr", "--set", "M=1", "--set", "a=0.5"],
         "expected a frame of 3 dimensions"),
        ([*METRIC, "--near", "nowhere"], "nowhere"),
        (["count", "-L", "-X/2", "-c", "flat", "--scalars", "phi = log("], "log"),
        (["count", "-L", "R + c*R**2", "-c", "levi-civita", "--set", "c=d"], "c"),
    ):  # fmt: skip
        result = running.run(*arguments, code=ExitCode.wrong_input)
        assert words in result.stderr
