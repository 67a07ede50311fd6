"""Writing: files of each format, with equal bytes each time."""

import pytest

from geomtorsion import exercises
from geomtorsion.errors import ArgumentError
from geomtorsion.teaching.exercises.exports import FORMATS

FILES = {
    "stack": {"geomtorsion-stack.xml"},
    "nbgrader": {"nbgrader_config.py", "source/chapter3/chapter3.ipynb"},
}


def test_all_formats_are_here():
    """The table of files covers all formats."""
    assert set(FILES) == set(FORMATS)


@pytest.mark.parametrize("to", FORMATS)
def test_files(to, tmp_path):
    """Files have the expected paths and equal bytes each time; a note explains their use."""
    done = exercises.export(to, tmp_path / "one", ["3.1"])
    assert {path.relative_to(tmp_path / "one").as_posix() for path in done.files} == FILES[to]
    again = exercises.export(to, tmp_path / "two", ["3.1"])
    for one, two in zip(done.files, again.files, strict=True):
        assert one.read_bytes() == two.read_bytes()
    [note] = done.notes
    assert len(note) > 80


def test_progress_and_seeds(tmp_path):
    """Each exercise is reported in order; the requested seeds are exported."""
    seen: list[str] = []
    done = exercises.export("nbgrader", tmp_path, ["3.1", "7.4"], [3, 4], seen.append)
    assert seen == ["3.1", "7.4"]
    assert [path.name for path in done.files][1:] == [
        "chapter3-seed3.ipynb", "chapter3-seed4.ipynb", "chapter7-seed3.ipynb",
        "chapter7-seed4.ipynb",
    ]  # fmt: skip


def test_no_such_format(tmp_path):
    """The message lists the formats."""
    with pytest.raises(ArgumentError, match="to: expected one of stack, nbgrader"):
        exercises.export("moodle", tmp_path)
