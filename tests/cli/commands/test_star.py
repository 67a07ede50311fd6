"""star: one star, a family, a star of a mass, and refusals."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from geomtorsion import gravity
from tests.cli import running

# A polytrope as a table: p = 100 r^2.
ROWS = "\n".join(f"{p!r},{(p / 100) ** 0.5 + p!r}" for p in np.geomspace(1e-9, 1e-2, 45).tolist())


@pytest.fixture
def table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """The name of a table in the current folder."""
    monkeypatch.chdir(tmp_path)
    Path("soft.csv").write_text(f"p,rho\n{ROWS}\n")
    return "soft.csv"


def test_one_star() -> None:
    """The numbers of the library, as JSON."""
    shown = json.loads(running.run("star", "SLy", "--density", "1e15", "--format", "json").stdout)
    star = gravity.star("SLy", density=1e15)
    assert shown["mass"] == star.mass
    assert shown["errors"]["radius"] == star.errors["radius"]


def test_a_family_and_its_files(table: str) -> None:
    """A table of the stars, the heaviest one and a figure."""
    centres = ("--density", "1e-3,4e-3,9e-3")
    shown = running.run("star", table, *centres, "-o", "stars")
    assert "heaviest: mass 1.637" in shown.stdout
    files = {path.name for path in Path("stars").iterdir()}
    assert files == {"star.json", "star.png", "stars.csv"}
    with Path("stars", "stars.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 3
    assert float(rows[0]["love_number"]) > float(rows[-1]["love_number"]) > 0
    exact = gravity.star(gravity.polytropes(100, [2]), density=1e-3)
    assert float(rows[0]["mass"]) == pytest.approx(exact.mass, rel=1e-4)


def test_a_star_of_a_mass(table: str) -> None:
    """The star of Font et al. (2002) by its mass."""
    centres = ("--density", "1e-3,4e-3,9e-3")
    shown = running.run("star", table, *centres, "--mass", "1.4", "--format", "json")
    assert json.loads(shown.stdout)["radius"] == pytest.approx(9.586, abs=2e-3)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["SLI"], "Did you mean SLy"),
        (["nothing.csv"], "cannot be read"),
        (["SLy", "--density", "-1"], "expected a positive number"),
        (["SLy", "--density", "1", "--pressure", "1"], "got both"),
        (["soft.csv", "--units", "feet"], "geometric"),
        (["soft.csv", "--interpolation", "none"], "monotone"),
        (["soft.csv", "--density", "1e-3,2e-3", "--mass", "9"], "expected a mass from"),
    ],
)
def test_refusals(arguments: list[str], words: str, table: str) -> None:
    """The error names the cause and a remedy."""
    failed = running.run("star", *arguments, code=2)
    assert words in " ".join(failed.output.split())
