"""Writing: files of each format, the same ones each time."""

import zipfile

import pytest

from geomtorsion import exercises
from geomtorsion.errors import ArgumentError
from geomtorsion.exercises.exports import FORMATS

FILES = {
    "stack": {"geomtorsion-stack.xml"},
    "prairielearn": {f"geomtorsion/3-1-which-connection-is-flat/{name}"
                     for name in ("info.json", "question.html", "server.py")},
    "nbgrader": {"nbgrader_config.py", "source/chapter3/chapter3.ipynb"},
    "otter": {"chapter3.ipynb"},
    "qti": {"imsmanifest.xml", "items/3-1-which-connection-is-flat-seed0.xml",
            "geomtorsion-qti21.zip"},
}  # fmt: skip


def test_all_formats_are_here():
    """Each has its files below."""
    assert set(FILES) == set(FORMATS)


@pytest.mark.parametrize("to", FORMATS)
def test_files(to, tmp_path):
    """They stand where they should, say what to do, and have the same bits the next time."""
    done = exercises.export(to, tmp_path / "one", ["3.1"])
    assert {path.relative_to(tmp_path / "one").as_posix() for path in done.files} == FILES[to]
    again = exercises.export(to, tmp_path / "two", ["3.1"])
    for one, two in zip(done.files, again.files, strict=True):
        assert one.read_bytes() == two.read_bytes()
    [note] = done.notes
    assert len(note) > 80


def test_the_package_of_qti_is_packed(tmp_path):
    """The ZIP file holds what stands beside it, and the note says what is graded."""
    done = exercises.export("qti", tmp_path, ["1.4", "3.1", "4.4"])
    with zipfile.ZipFile(tmp_path / "geomtorsion-qti21.zip") as package:
        assert package.testzip() is None
        held = {name: package.read(name) for name in package.namelist()}
    assert held == {
        path.relative_to(tmp_path).as_posix(): path.read_bytes()
        for path in done.files
        if path.suffix == ".xml"
    }
    assert "QTI 2.1 grades 6 of 8 questions in full" in done.notes[0]


def test_progress_and_seeds(tmp_path):
    """Each exercise is named before it is solved; seeds are those asked for."""
    seen: list[str] = []
    done = exercises.export("nbgrader", tmp_path, ["3.1", "7.4"], [3, 4], seen.append)
    assert seen == ["3.1", "7.4"]
    assert [path.name for path in done.files][1:] == [
        "chapter3-seed3.ipynb", "chapter3-seed4.ipynb", "chapter7-seed3.ipynb",
        "chapter7-seed4.ipynb",
    ]  # fmt: skip


def test_no_such_format(tmp_path):
    """The formats are listed."""
    with pytest.raises(
        ArgumentError, match="to: one of stack, prairielearn, nbgrader, otter, qti was"
    ):
        exercises.export("moodle", tmp_path)


def test_the_note_names_a_file_that_is_there(tmp_path):
    """What is to be called for Otter is one of the notebooks that were written."""
    done = exercises.export("otter", tmp_path, ["3.2"])
    assert "otter assign chapter3.ipynb chapter3 makes" in done.notes[0]
    assert (tmp_path / "chapter3.ipynb").exists()
