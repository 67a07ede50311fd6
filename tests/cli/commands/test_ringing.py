"""ringing: each example of its help text runs, and what it writes."""

import csv
import json
import shlex
from pathlib import Path

import pytest

from geomtorsion.cli.commands.ringing import ringing
from geomtorsion.gravity import perturbed
from tests.cli import running

# Examples of the help text, with the continuation of a line.
_LINES = (ringing.__doc__ or "").partition("Examples:")[2].replace("\\\n", " ").splitlines()
EXAMPLES = [line.strip() for line in _LINES if line.strip()]
# l = 2, M = 1, Q = 4/5: Leaver (1990), Andersson (1993).
CHARGED = 0.40121718546 - 0.08964322973j


def test_the_examples_are_found() -> None:
    assert len(EXAMPLES) == 6


@pytest.mark.parametrize("example", EXAMPLES)
def test_each_example_runs(example: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    program, *arguments = shlex.split(example)
    shown = running.run(*arguments, "--format", "json")
    modes = json.loads(shown.stdout)["modes"]
    assert program == "geomtorsion"
    assert all(float(one["imag"]) < 0 < float(one["real"]) for one in modes)
    if "--maxwell" in arguments:
        assert abs(complex(float(modes[0]["real"]), float(modes[0]["imag"])) - CHARGED) < 1e-10
    if "-o" in arguments:
        assert {path.name for path in Path("rings").iterdir()} == {"ringing.json", "ringing.png"}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--maxwell", "q/r, 0, 0"], "potential"),
        (["--maxwell", "q/r, 0, 0, 0", "--maxwell", "q/r, 0, 0, 0"], "at most one"),
        (["--scalar", "1"], "--scalar"),
    ],
)
def test_wrong_fields(arguments: list[str], words: str) -> None:
    shown = running.run(
        "ringing", "kerr_newman", "--set", "M=1", "--set", "a=0", "--set", "q=4/5",
        "-L", "R - F2", *arguments, code=2,
    )  # fmt: skip
    assert words in shown.output


def test_a_table_and_latex(tmp_path: Path) -> None:
    rings = perturbed.ringing("-X/2", "schwarzschild", l=1, parameters={"M": 1})
    rings.to_csv(tmp_path / "rings.csv")
    with (tmp_path / "rings.csv").open() as file:
        (row,) = csv.DictReader(file)
    assert (float(row["l"]), row["field"], row["parity"]) == (1, "scalar", "")
    assert complex(float(row["real"]), float(row["imag"])) == pytest.approx(
        rings.modes[0].frequency, abs=float(row["error"])
    )
    assert r"\omega = 0.292936133" in rings._repr_latex_()
    assert "scalar" in rings.modes[0]._repr_latex_()
