"""The command `circuit`: measured grids, maps and images, text and JSON, exit codes of failures."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.cli import running
from tests.materials.maps.test_map_files import ctf, write
from tests.materials.test_readers import grid


def run(*arguments: str, code: int = 0, given: str = "") -> Any:
    """Result of `geomtorsion circuit`, which must end with the given code."""
    return running.run("circuit", *arguments, code=code, given=given)


def data(*arguments: str, code: int = 0, given: str = "") -> dict[str, Any]:
    """Parsed JSON that `geomtorsion circuit` prints."""
    return json.loads(run(*arguments, "--format", "json", code=code, given=given).stdout)


def wall_file(folder: Path) -> str:
    """A tilt wall of 2 degrees in the middle of 12 x 14 pixels, with steps of 0.5 um."""
    angles = np.zeros((12, 14, 3))
    angles[..., 0] = np.where(np.arange(14) < 7, 359.0, 1.0)
    return str(write(folder, ctf(angles), "wall.ctf"))


def test_a_grid(tmp_path) -> None:
    """Torsion 1 everywhere: b equals the area in JSON; the figure and the text are written."""
    path = str(grid(tmp_path, sigma=1e-3, unit="nm"))
    out = tmp_path / "o"
    found = data(path, "--loop", "plaquette 1,1:2,1", "--loop", "circle 2,3:1.5", "-o", str(out))
    assert [one["vector"][0] for one in found["results"]] == pytest.approx([2.0, 7.0685835])
    assert all(one["significant"] for one in found["results"])
    assert json.loads((out / "burgers.json").read_text()) == found
    assert (out / "circuits.png").read_bytes().startswith(b"\x89PNG")
    said = run(path, "--loop", "circle 2,3:1.5", "--sigma", "estimate").stdout
    assert "the median of sixth differences" in said
    assert "b = (7.068583470577" in said


def test_a_proved_circuit(tmp_path) -> None:
    """The proof of a grid in JSON and in words; an orientation map has no interpolant."""
    path = str(grid(tmp_path))
    (found,) = data(path, "--loop", "circle 2,3:1.5", "--proved")["results"]
    assert "7.068583470577" in found["proof"]["values"][0]
    assert "interpolant" in found["proof"]["assumes"][0]
    said = run(path, "--loop", "circle 2,3:1.5", "--proved").stdout
    assert "proved, 15 digits" in said
    refused = run(wall_file(tmp_path), "--loop", "plaquette 1,1:4,3", "--proved", code=2).stderr
    assert "without an interpolant" in " ".join(refused.split())


def test_an_orientation_map(tmp_path) -> None:
    """A circuit around a tilt wall: b/L = 2 sin(theta/2), in crystal and specimen axes."""
    path = wall_file(tmp_path)
    found = data(path, "--loop", "plaquette 1,1:4,3", "--sigma", "0.01")["results"][0]
    assert found["magnitude"] == pytest.approx(6 * math.sin(math.radians(1)), rel=1e-6)
    assert math.hypot(*found["specimen"]) == pytest.approx(found["magnitude"])
    assert found["phase"] == "Nickel"
    said = run(path, "--loop", "plaquette 1,1:4,3", "--sigma", "0.01").stdout
    assert "in specimen axes" in said
    assert "more than noise explains" in said


def test_circuits_that_fail(tmp_path) -> None:
    """One failing circuit ends with code 2 and a remedy; among others it is one failed result."""
    path = wall_file(tmp_path)
    options = ("--threshold", "1.5", "--sigma", "0.01", "--loop", "circle 3.5,3:2")
    message = run(path, *options, code=2).stderr
    assert "is in grain 0" in message
    assert "threshold above 1.5" in message
    found = data(path, *options, "--loop", "circle 1.5,2:1", code=1)["results"]
    assert found[0]["kind"] == "OrientationError"
    assert "vector" in found[1]
    assert "failed" in run(path, *options, "--loop", "circle 1.5,2:1", code=1).stdout


def test_loops_of_a_file(tmp_path) -> None:
    """Loops of a file come before typed ones; a circle and a curve agree."""
    path = str(grid(tmp_path))
    circle = {"circle": {"centre": [2, 3], "radius": 1.5}, "name": "drawn"}
    curve = "curve 2+1.5*cos(s);3+1.5*sin(s)"
    found = data(path, "--loop", curve, "--loops", "-", given=json.dumps([circle]))["results"]
    assert [one["loop"] for one in found] == ["drawn", curve]
    assert found[0]["vector"] == pytest.approx(found[1]["vector"], rel=1e-6)


@pytest.mark.parametrize(
    ("arguments", "given", "words"),
    [
        ((), "", "expected a circuit, got none. Use --loop"),
        (("--loop", "disc 1"), "", "--loop: expected one of circle, ellipse"),
        (("--loop", "circle 1,1"), "", "--loop circle 1,1: expected CENTRE:RADIUS"),
        (
            ("--loops", "-"),
            '{"loops": [{"circle": {"centre": [2, 3], "radius": 1}}], "accuracy": 1e-3}',
            "--loops -: accuracy: expected loops only",
        ),
        (
            ("--loops", "-"),
            '{"loops": [{"circle": {"centre": [2, 3], "radius": 1}}], "parameters": {"b": 2}}',
            "--loops -: parameters: expected loops only",
        ),
        (("--threshold", "1", "--loop", "circle 2,3:1"), "", "--threshold: expected a file of"),
        (("--exact", "--loop", "circle 2,3:1"), "", "No such option: --exact"),
    ],
)
def test_bad_input_ends_with_two(tmp_path, arguments, given, words) -> None:
    """A wrong argument ends the command with code 2 and a message that names it."""
    said = run(str(grid(tmp_path)), *arguments, code=2, given=given).stderr
    assert words in " ".join(said.replace("│", " ").split())


def test_a_space_has_its_own_command() -> None:
    """The name of a space is refused with the name of the other command."""
    said = run("so3", "--loop", "circle 0.3,1,0.2:1", code=2).stderr
    assert "expected a file of measured data, got a shipped space" in said
    assert "geomtorsion burgers so3 --circle" in said
