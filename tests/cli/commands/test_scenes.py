"""scenes: the list, and a scene as a file."""

from geomtorsion.scenes import load, names, read_file
from tests.cli.running import run


def test_scenes_are_listed_and_printed(tmp_path):
    """Each name has a line; a printed scene, read as a file, equals the shipped scene."""
    lines = run("scenes").stdout.splitlines()
    assert [line.split()[0] for line in lines] == list(names())
    file = tmp_path / "dzhanibekov.toml"
    file.write_text(run("scenes", "dzhanibekov").stdout)
    assert read_file(file) == load("dzhanibekov")
    assert "Did you mean dzhanibekov" in run("scenes", "dzanibekov", code=2).stderr
