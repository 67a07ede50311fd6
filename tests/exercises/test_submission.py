"""Submission: files of students, whatever they hold."""

import os

import pytest

from geomtorsion.errors import FileFormatError, LimitError
from geomtorsion.exercises.limits import MOST
from geomtorsion.exercises.submission import read_submission


def read(tmp_path, text: str | bytes, name: str = "ada.toml"):
    """The submission in a file with this content."""
    file = tmp_path / name
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_submission(file)


def test_all_ways_to_write_answers(tmp_path):
    """Numbers with and without quotes, tables and single answers, a byte order mark."""
    found = read(
        tmp_path,
        '\ufeffstudent = "Ada  Lovelace"\nseed = 7\n[answers]\n"1.1" = "0"\n3.2 = "x"\n'
        '[answers."3.3"]\nricci = "1"\n[answers.7.1]\nline = 8\n[answers."8.8"]\nx = 1\n',
    )
    assert found.student == "Ada Lovelace"
    assert found.seed == 7
    assert found.answers == {"1.1": "0", "3.2": "x", "3.3": {"ricci": "1"}, "7.1": {"line": 8}}
    assert found.unknown == ("8.8",)


def test_what_is_left_out(tmp_path):
    """The file names the student, there may be no seed and no answers."""
    found = read(tmp_path, "")
    assert (found.student, found.seed, dict(found.answers)) == ("ada", None, {})
    assert read(tmp_path, 'student = " "\n').student == "ada"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("answers = 3", "a table was needed"),
        ("student = 3", "a name of at most"),
        ("student = '" + "x" * 300 + "'", "a name of at most"),
        ("seed = -1", "whole number from 0"),
        ("seed = true", "whole number from 0"),
        ("seed = 1e3", "whole number from 0"),
        ('answers = "1.1"', "a table was needed"),
        ("[answers\n", "this is no TOML"),
        ('"1.1" = import os', "this is no TOML"),
        (b"\xff\xfe\x00", "no UTF-8 text"),
        ("x = " + "[" * 5000 + "]" * 5000, "nested too deeply|no TOML"),
        ("seed = 0x" + "f" * 9000, "more digits than can be read"),
        ("seed = " + "9" * 9000, "more digits than can be read"),
        ("answers = 0x" + "f" * 9000, "more digits than can be read"),
        ('[answers]\n"1.1" = [0x' + "f" * 9000 + "]", "more digits than can be read"),
    ],
)
def test_bad_files(tmp_path, text, says):
    """The message names the file, what was needed and what to write."""
    with pytest.raises((FileFormatError, LimitError), match=f"ada.toml: .*({says})"):
        read(tmp_path, text)


def test_large_files_and_no_files(tmp_path):
    """Too long, missing, a directory, a pipe that would never end."""
    with pytest.raises(LimitError, match="longer than the limit"):
        read(tmp_path, "#" * (MOST.file + 1))
    with pytest.raises(FileFormatError, match="cannot be read"):
        read_submission(tmp_path / "nobody.toml")
    with pytest.raises(FileFormatError, match="no regular file"):
        read_submission(tmp_path)
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe.toml")
        with pytest.raises(FileFormatError, match="no regular file"):
            read_submission(tmp_path / "pipe.toml")
