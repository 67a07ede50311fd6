"""The command `map`: text and data, files, circles that fail, bad input."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.cli import running
from tests.orientations.test_map_files import ctf, write


@pytest.fixture
def scan(tmp_path: Path) -> str:
    """A bent crystal beside a grain that is turned by 30 degrees."""
    angles = np.zeros((20, 30, 3))
    angles[..., 0] = 0.2 * np.arange(30)
    angles[:, 20:, 0] += 30
    return str(write(tmp_path, ctf(angles), "scan.ctf"))


def run(*arguments: str, code: int = 0) -> Any:
    """The result of `geomtorsion map` that has to end with a code."""
    return running.run("map", *arguments, code=code)


def test_text_and_data(scan: str) -> None:
    """The density of the bend, in words and as data."""
    shown = run(scan, "--size", "4", "--sigma", "0.01").stdout
    assert "2 grains at 5 degrees" in shown
    assert "squares of 4 x 4 cells stay in one grain" in shown
    found = json.loads(run(scan, "--size", "4", "--sigma", "0.01", "--json").stdout)
    assert found["median_per_area"] == pytest.approx(np.radians(0.2) / 0.5, rel=1e-5)
    assert found["clean"] == 16 * (16 + 6)


def test_circles(scan: str) -> None:
    """One within a grain; one across the boundary fails in its place, with pixels."""
    arguments = (scan, "--sigma", "0.01", "--circle", "4,4:2", "--circle", "10,4:2")
    found = json.loads(run(*arguments, "--json", code=1).stdout)
    good, bad = found["circles"]
    assert good["size"] / good["area"] == pytest.approx(np.radians(0.4), rel=1e-4)
    assert "lies in grain 0" in bad["failed"]
    shown = run(*arguments, code=1).stdout
    assert "in specimen axes" in shown
    assert "failed: the circuit crosses a boundary" in shown


def test_what_is_written(scan: str, tmp_path: Path) -> None:
    """Arrays, data and two pictures."""
    out = tmp_path / "out"
    run(scan, "--size", "4", "--sigma", "0.01", "--circle", "4,4:2", "-o", str(out))
    with np.load(out / "map.npz", allow_pickle=False) as content:
        assert content["vectors"].shape == (16, 26, 3)
        assert content["clean"].sum() == json.loads((out / "map.json").read_text("utf-8"))["clean"]
    assert (out / "squares.png").stat().st_size > 5000
    assert (out / "grains.png").stat().st_size > 5000


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--circle", "4,4"), "X,Y:RADIUS was needed"),
        (("--circle", "a,b:c"), "X,Y:RADIUS was needed"),
        (("--size", "40"), "size: a whole number from 1 to 19"),
        (("--sigma", "-1"), "standard deviations of 0 or more"),
        (("--threshold", "0"), "threshold: a positive number"),
        (("--laue", "cubic"), "PHASE=GROUP was needed"),
        (("--laue", "1=cubic"), "'cubic' is not known"),
    ],
)
def test_bad_options(scan: str, arguments: tuple[str, ...], message: str) -> None:
    """Each is refused with what was needed."""
    assert message in " ".join(run(scan, *arguments, code=2).stderr.split())


def test_a_damaged_file(tmp_path: Path) -> None:
    """The message names file and line."""
    path = write(tmp_path, ctf()[:-3], "scan.ctf")
    assert "scan.ctf: line 32" in " ".join(run(str(path), code=2).stderr.split())
