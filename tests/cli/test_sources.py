"""Names and files on the command line: how an argument is interpreted."""

import pytest

from geomtorsion.cli.sources import open_space
from geomtorsion.errors import FileFormatError, UnknownNameError

FILE = 'coordinates = ["x"]\ncoframe = [["1"]]\nname = "mine"\n'


def test_a_name_wins_over_a_file(tmp_path, monkeypatch):
    """A file with the name of a shipped space is read only if its path has a folder."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "so3").write_text(FILE)
    (tmp_path / "other").write_text(FILE)
    assert open_space("so3").name == "so3"
    assert open_space("./so3").name == "mine"
    assert open_space("other").name == "mine"


def test_what_looks_like_a_file_is_one(tmp_path, monkeypatch):
    """A missing path or .toml is reported as a missing file, any other text as an unknown name."""
    monkeypatch.chdir(tmp_path)
    for missing in ("none.toml", "folder/none"):
        with pytest.raises((FileFormatError, FileNotFoundError)):
            open_space(missing)
    with pytest.raises(UnknownNameError, match="There is no file of this name either"):
        open_space("nowhere")
