"""Sheets: page, notebook, form and solutions of a chapter."""

import json
import re
import tomllib
from html.parser import HTMLParser

import pytest

from geomtorsion import exercises
from geomtorsion.errors import UnknownNameError
from geomtorsion.teaching.exercises.grading import read_submission
from geomtorsion.teaching.exercises.sheets import write_sheet


class Outline(HTMLParser):
    """Parser that checks that elements pair up and that the page loads nothing."""

    VOID = ("meta", "br", "mspace")

    def __init__(self):
        super().__init__()
        self.open: list[str] = []
        self.seen: set[str] = set()

    def handle_starttag(self, tag, attrs):
        self.seen.add(tag)
        assert tag not in ("script", "img", "link", "iframe")
        assert not any(name in ("src", "href", "onload", "onclick") for name, _ in attrs)
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.seen.add(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


@pytest.mark.parametrize("chapter", ["2", "3"])
def test_a_chapter(chapter, tmp_path):
    """A chapter has four files; only the teacher's file has solutions."""
    written = write_sheet(chapter, tmp_path / "sheets", seed=1)
    assert [path.name for path in written] == [
        f"chapter{chapter}-seed1.html",
        f"chapter{chapter}-seed1.ipynb",
        f"chapter{chapter}-seed1-answers.toml",
        f"chapter{chapter}-seed1-solutions.html",
    ]
    page, notebook, form, solutions = (path.read_text("utf-8") for path in written)
    assert written[3].parent.name == "teacher"
    for text in (page, solutions):
        outline = Outline()
        outline.feed(text)
        assert not outline.open
        assert {"math", "msub", "details"} <= outline.seen
    for number in exercises.names():
        if number.startswith(f"{chapter}."):
            assert f'id="e{number}"' in page
            for text in exercises.load(number, 1).answers().values():
                shown = text.replace("'", "&#x27;")
                assert shown in solutions
                if len(text) > 12:
                    assert shown not in page
                    assert text not in notebook
                    assert text not in form
    assert "Mistakes that are recognised" in solutions
    assert "Mistakes that are recognised" not in page


def test_the_notebook_runs(tmp_path):
    """Valid nbformat 4.5; code cells run, the check reports missing answers, hints are printed."""
    [file] = [path for path in write_sheet("3", tmp_path) if path.suffix == ".ipynb"]
    notebook = json.loads(file.read_text("utf-8"))
    assert (notebook["nbformat"], notebook["nbformat_minor"]) == (4, 5)
    keys = [cell["id"] for cell in notebook["cells"]]
    assert len(keys) == len(set(keys))
    assert all(re.fullmatch(r"[a-zA-Z0-9_-]{1,64}", key) for key in keys)
    said: list[str] = []
    scope: dict = {"print": lambda text: said.append(str(text))}
    for cell in notebook["cells"]:
        assert set(cell) >= {"cell_type", "id", "metadata", "source"}
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), scope)
    numbers = [number for number in exercises.names() if number.startswith("3.")]
    checks, hints = said[::2], said[1::2]
    assert len(checks) == len(numbers)
    assert "no answer" in checks[0]
    # If the hint were the value of the cell, each backslash would be shown twice.
    assert hints == [exercises.load(number).hints[0] for number in numbers]
    assert any("\\" in hint for hint in hints)


def test_the_form_is_a_file_of_answers(tmp_path):
    """The form is readable without changes, and it has all questions."""
    [file] = [path for path in write_sheet("6", tmp_path, seed=2) if path.suffix == ".toml"]
    data = tomllib.loads(file.read_text("utf-8"))
    for number in (number for number in exercises.names() if number.startswith("6.")):
        asked = {question.name for question in exercises.load(number, 2).questions}
        assert set(data["answers"][number]) == asked
    assert read_submission(file).seed == 2


@pytest.mark.parametrize("chapter", ["8", 1])
def test_no_such_chapter(chapter, tmp_path):
    """The message lists the chapters."""
    with pytest.raises(UnknownNameError, match=r"1 \(Frames and anholonomy\)"):
        write_sheet(chapter, tmp_path)
