"""same and identify: verdicts on two spaces, and the name of a tetrad in a file."""

from pathlib import Path

from geomtorsion.cli.exits import ExitCode
from tests.cli.running import run

SPHERE = """\
coordinates = ["u", "v"]
coframe = [["2*l/(1 + u^2 + v^2)", 0], [0, "2*l/(1 + u^2 + v^2)"]]
parameters = {l = "positive"}
"""


def test_same_prints_the_verdict() -> None:
    """Rotations in two descriptions are the same, leg by leg."""
    text = run("same", "so3", "so3_quaternion", "--keep", "legs").stdout
    assert text.startswith("same: all invariants agree\n")
    assert "compared: frames, leg by leg" in text


def test_different_spaces_end_with_1() -> None:
    """The reason names the difference, and the exit code is 1."""
    done = run("same", "so3", "so3_right", "--keep", "legs", code=ExitCode.failed)
    assert done.stdout.startswith("different: T_12^3 is -1 for the first and 1 for the second")


def test_a_file_is_a_member_of_a_family(tmp_path: Path) -> None:
    """A sphere in a file is the shipped sphere for the radius that is printed."""
    file = tmp_path / "disguise.toml"
    file.write_text(SPHERE)
    text = run("same", str(file), "s2").stdout
    assert text.startswith("same for R = l: all invariants agree\n")


def test_a_file_is_identified(tmp_path: Path) -> None:
    """The sphere in stereographic coordinates, with its radius."""
    file = tmp_path / "disguise.toml"
    file.write_text(SPHERE)
    text = run("identify", str(file)).stdout
    assert "s2: the sphere of radius R, compass frame with R = l" in text
    assert "source: " in text


def test_a_strange_file_matches_no_shipped_space(tmp_path: Path) -> None:
    """A bent surface is not among the shipped spaces."""
    file = tmp_path / "bump.toml"
    file.write_text(SPHERE.replace('v^2)"]]', '2*v^2)"]]'))
    text = run("identify", str(file), code=ExitCode.failed).stdout
    assert text.startswith("none of the shipped spaces\n")
