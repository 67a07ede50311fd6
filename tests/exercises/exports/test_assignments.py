"""Assignments: the same notebooks for every system, apart from what it marks."""

import json

import pytest

from geomtorsion.exercises.exports.nbgrader import course_files
from geomtorsion.exercises.exports.otter import assign_files
from geomtorsion.exercises.exports.tasks import tasks


@pytest.mark.parametrize("number", ["1.2", "3.1", "5.7"])
def test_students_read_the_same(number):
    """Text is the same for nbgrader and otter, and so is the solution."""
    found = tasks([number], [1])
    read = []
    for files in (course_files(found), assign_files(found)):
        [text] = [text for name, text in files.items() if name.endswith(".ipynb")]
        cells = json.loads(text)["cells"]
        shown = [cell["source"] for cell in cells if cell["cell_type"] == "markdown"]
        solved = [
            line.rstrip("\n").removesuffix("  # SOLUTION")
            for cell in cells
            if cell["id"].startswith("answer-")
            for line in cell["source"]
            if not line.startswith("###")
        ]
        read.append((shown, solved))
    assert read[0] == read[1]
    assert len(read[0][1]) == len(found[0].variants[0].questions)
