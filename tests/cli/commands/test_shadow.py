"""shadow: the edge in words and as data, files, a frame of one's own, and refusals."""

import csv
import json
import math
from pathlib import Path

import pytest

from tests.cli import running

HERE = ("schwarzschild", "--camera", "0,30,pi/2,0", "--set", "M=1", "--directions", "2")
WORMHOLE = """
name = "wormhole"
coordinates = ["t", "l", "theta", "phi"]
signature = [-1, 1, 1, 1]
coframe = [
  [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, "sqrt(l**2 + 1)", 0],
  [0, 0, 0, "sqrt(l**2 + 1)*sin(theta)"],
]
domain = ["theta > 0", "theta < pi"]
"""


def test_the_edge_of_a_hole_without_spin() -> None:
    """sin(chi) = 3 sqrt(3) M sqrt(1 - 2 M/r)/r (Synge 1966)."""
    shown = json.loads(running.run("shadow", *HERE, "--format", "json").stdout)
    edge = math.asin(math.sqrt(27) * math.sqrt(1 - 2 / 30) / 30)
    assert shown["camera"]["r"] == 30
    for radius, error in zip(shown["radii"], shown["errors"], strict=True):
        assert abs(radius - edge) <= error <= 1e-7


def test_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A table of the edge, plain data and two figures; no image without pixels."""
    monkeypatch.chdir(tmp_path)
    few = ("--accuracy", "1e-3", "--pixels")
    assert "pixels" in running.run("shadow", *HERE, *few, "8", "-o", "image").stdout
    files = {path.name for path in Path("image").iterdir()}
    assert files == {"edge.csv", "shadow.json", "edge.png", "image.png"}
    with Path("image", "edge.csv").open() as file:
        assert list(next(csv.DictReader(file))) == ["angle", "radius", "error"]
    running.run("shadow", *HERE, *few, "0", "-o", "edge")
    assert not Path("edge", "image.png").exists()


def test_a_frame_of_ones_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The throat of a wormhole, sin(chi) = b/sqrt(b^2 + l^2), from options."""
    monkeypatch.chdir(tmp_path)
    Path("wormhole.toml").write_text(WORMHOLE)
    camera = ("--camera", "0,3,pi/2,0", "--dark", "l + 10", "--sky", "10 - l")
    shown = running.run("shadow", "wormhole.toml", *camera, "--directions", "2", "--format", "json")
    assert json.loads(shown.stdout)["radii"][0] == pytest.approx(
        math.asin(1 / math.sqrt(10)), abs=1e-6
    )


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("so3x",), "so3"),
        (("wormhole.toml",), "expected coordinates, got none"),
        ((*HERE, "--light", "sound"), "geodesic"),
        ((*HERE[:1], "--camera", "0,30"), "4"),
        ((*HERE, "--dark", "r - "), "missing after -"),
    ],
)
def test_refusals(
    arguments: tuple[str, ...], words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The error names the cause and a remedy."""
    monkeypatch.chdir(tmp_path)
    Path("wormhole.toml").write_text(WORMHOLE)
    failed = running.run("shadow", *arguments, code=2)
    assert words in " ".join(failed.output.split())
    assert "Traceback" not in failed.output
