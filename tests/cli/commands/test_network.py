"""The command `network`: summary, node rule, circuits, files, and exit codes."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geomtorsion.materials.lines import DislocationNetwork, LineArrays
from tests.cli import running
from tests.materials.lines.synthetic_networks import rings

TRIANGLE = Path(__file__).parents[2] / "data" / "triangle.data"


def run(*arguments: str, code: int = 0) -> Any:
    """Result of `geomtorsion network`, which must end with the given code."""
    return running.run("network", *arguments, code=code)


def test_help_has_examples() -> None:
    """The help shows an example."""
    assert "geomtorsion network chains.data -o out" in run("--help").stdout


def test_summary_of_rings(tmp_path: Path) -> None:
    """The summary equals the network's numbers; --unit adds the density per square metre."""
    lines = rings(20, seed=6)
    file = tmp_path / "rings.data"
    DislocationNetwork.of_arrays(lines).save(file)
    found = json.loads(run(str(file), "--unit", "1e-9", "--format", "json").stdout)
    assert (found["nodes"], found["lines"], found["violations"]) == (240, 240, [])
    assert found["density"] == pytest.approx(lines.lengths.sum() / 1000, rel=1e-12)
    assert found["density_per_m2"] == pytest.approx(1e18 * found["density"], rel=1e-12)
    (family,) = found["families"]
    assert family["burgers"] == "0.7071 <1 1 0>"
    assert family["screw"] + family["edge"] == pytest.approx(1)
    assert abs(np.array(found["nye"])).max() < 1e-12
    text = run(str(file)).stdout
    assert "240 nodes, 240 lines, 0 junctions" in text
    assert "b is conserved at every node" in text


def test_circuits_in_lattice_vectors(tmp_path: Path) -> None:
    """A circle around a side of the triangle, an empty polygon, and a figure of both."""
    given = ("--circle", "0,-0.5,0:1/4:x,z", "--polygon", "0,0,0.5;0.1,0,0.5;0,0.1,0.5")
    done = run(str(TRIANGLE), *given, "--lattice", "sc", "-o", str(tmp_path / "out"))
    assert "b = (0, 0, 0) = [0, 0, 0] in lattice vectors, from 0 crossings" in done.stdout
    saved = json.loads((tmp_path / "out" / "network.json").read_text("utf-8"))
    assert [one["crossings"] for one in saved["circuits"]] == [0, 0]
    assert (tmp_path / "out" / "network.png").stat().st_size > 10_000
    side = run(str(TRIANGLE), "--circle", "0,0,0:1/2:y,z", "--lattice", "sc", "--format", "json")
    (one,) = json.loads(side.stdout)["circuits"]
    assert one["lattice"] == [0, 0, 1]


def test_violations_are_reported(tmp_path: Path) -> None:
    """A node that breaks the rule or a circuit through a line is reported; the code is 1."""
    lines = rings(2, seed=1)
    cut = LineArrays(lines.positions, lines.pairs[1:], lines.burgers[1:], lines.box)
    file = tmp_path / "cut.data"
    DislocationNetwork.of_arrays(cut).save(file)
    text = run(str(file), code=1).stdout
    assert "b is not conserved at 2 nodes" in text
    assert "missing: (" in text
    through = run(str(TRIANGLE), "--circle", "0,0.5,0:1/2:y,z", code=1).stdout
    assert "failed: the loop meets the line (0, 0) -> (0, 1)" in through


def test_wrong_input_ends_with_two(tmp_path: Path) -> None:
    """A missing file, a damaged file, a negative unit and an unknown symmetry end with code 2."""
    assert "cannot be read" in run("nothing.data", code=2).stderr
    damaged = tmp_path / "damaged.data"
    damaged.write_text(TRIANGLE.read_text("utf-8").replace("1.5e0", "x"), "utf-8")
    said = run(str(damaged), code=2).stderr
    assert "damaged.data: line 27: a position: expected a finite number, got 'x'" in said
    assert "--unit: expected a positive length" in run(str(TRIANGLE), "--unit", "-1", code=2).stderr
    assert "cubic, hexagonal, none" in run(str(TRIANGLE), "--symmetry", "hcp", code=2).stderr


def test_a_lattice_is_for_circuits() -> None:
    """--lattice without a circuit is refused."""
    assert "--lattice: expected a circuit, got none" in run(
        str(TRIANGLE), "--lattice", "quasi", code=2
    ).stderr  # fmt: skip
