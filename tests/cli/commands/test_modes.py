"""The command `modes`: text, JSON and refusals."""

import json

import pytest

from geomtorsion.cli.exits import ExitCode
from geomtorsion.gravity import perturbed
from tests.cli import running

GALILEON = ("modes", "-L", "R/2 - X/2 + c*X*Box(phi)", "-g", "riemannian", "--scalars", "phi")


@pytest.mark.parametrize(
    ("kind", "function"),
    [
        ("tensor", perturbed.tensor_modes),
        ("scalar", perturbed.scalar_modes),
        ("growth", perturbed.growth),
    ],
)
def test_text_and_json_equal_the_library(kind: str, function) -> None:
    result = function("R/2 - X/2 + c*X*Box(phi)", "riemannian", scalars="phi")
    shown = running.run(*GALILEON, "--kind", kind).stdout
    assert "".join(shown.split()) == "".join(str(result).split())
    document = json.loads(running.run(*GALILEON, "--kind", kind, "--format", "json").stdout)
    assert document == result.to_json()


def test_speed_of_light() -> None:
    """Gravitational waves of a cubic galileon have the speed of light; G4(X) changes it."""
    assert json.loads(running.run(*GALILEON, "--format", "json").stdout)["speed2"] == "1"
    kinetic = ("modes", "-L", "R/2 + c*Y", "-g", "riemannian", "--scalars", "phi")
    slow = running.run(*kinetic, "--invariant", "Y = G_ab phi^a phi^b", "--format", "json")
    assert json.loads(slow.stdout)["speed2"] != "1"


def test_numbers_and_figure_over_time(tmp_path) -> None:
    """--times with a cosmos: the numbers of `over_time`, in a file with their figure."""
    cosmos = ("--set", "a=t**(1/2)", "--set", "phi=t", "--set", "c=1/10")
    arguments = (*GALILEON, "--kind", "scalar", "--times", "1,10", *cosmos)
    shown = running.run(*arguments, "-o", str(tmp_path / "new")).stdout
    assert "speed2 from" in shown
    document = json.loads((tmp_path / "new" / "modes.json").read_text(encoding="utf-8"))
    over = document["over_time"]
    waves = perturbed.scalar_modes("R/2 - X/2 + c*X*Box(phi)")
    own = waves.over_time(over["times"], a="t**(1/2)", phi="t", c="1/10")
    assert over == own.to_json()
    assert (over["times"][0], over["times"][-1]) == (1, 10)
    assert (tmp_path / "new" / "modes.png").stat().st_size > 0


def test_refusals_name_the_remedy() -> None:
    for arguments, words in (
        (["modes"], "-L 'f(R)' -g riemannian"),
        (["modes", "-L", "R/2 + sqrt(-X)", "--scalars", "phi", "--kind", "scalar"], "cuscuton"),
        (["modes", "-L", "R/2 + Box(phi)", "-g", "riemannian"], "matter field"),
        ([*GALILEON, "--set", "a=t"], "Add --times 1,10"),
        ([*GALILEON, "--times", "10,1", "--set", "a=t"], "two increasing times"),
        ([*GALILEON, "--times", "1,2"], "scale factor"),
        (
            ["modes", "-L", "R/2 - X/2 + c*Box(phi)**2", "--scalars", "phi", "--kind", "scalar"],
            "phi to order 4, not degenerate",
        ),
    ):
        result = running.run(*arguments, code=ExitCode.wrong_input)
        assert words in result.stderr
