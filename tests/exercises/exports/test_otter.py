"""otter: notebooks read back and graded by their hidden tests, and by otter itself."""

import json
import re
from functools import cache
from pathlib import Path

import pytest

from geomtorsion import exercises
from geomtorsion.exercises.answers import answer_text
from geomtorsion.exercises.exports.otter import assign_files
from geomtorsion.exercises.exports.tasks import tasks
from tests.exercises.exports.graders import command

NUMBERS = exercises.names()
SEED = 1
SOLUTION = re.compile(r"(\w+) = (.+)  # SOLUTION")
SET = re.compile(r"\w+ = .+")


def source(cell: dict) -> str:
    return "".join(cell["source"])


@cache
def exported(number: str) -> dict:
    [text] = assign_files(tasks([number], [SEED])).values()
    return json.loads(text)


def graded(tests: list[str], name: str, answer: object) -> tuple[int, set[str]]:
    """How many hidden tests pass, as otter calls them, and what the others say."""
    passed, said = 0, set()
    for count, test in enumerate(tests, 1):
        scope: dict = {}
        exec(test, scope)
        try:
            scope[f"test_{count}"](**{name: answer})
            passed += 1
        except AssertionError as error:
            said.add(str(error))
    return passed, said


@pytest.mark.parametrize("number", NUMBERS)
def test_round_trip(number):
    """The solution passes all tests; of a mistake as many pass as its share, and it is named."""
    cells = exported(number)["cells"]
    for question in exercises.load(number, SEED).questions:
        key = f"{number.replace('.', '-')}-{question.name}"
        [answer] = [source(cell) for cell in cells if cell["id"] == f"answer-{key}"]
        tests = [source(cell) for cell in cells if cell["id"].startswith(f"test-{key}-")]
        assert all(test.startswith("# HIDDEN\n") for test in tests)
        solved = SOLUTION.fullmatch(answer)
        assert solved is not None
        assert graded(tests, solved[1], json.loads(solved[2])) == (len(tests), set())
        for mistake in question.mistakes:
            text = answer_text(question, mistake.value)
            passed, said = graded(tests, solved[1], text)
            verdict = exercises.check(number, {question.name: text}, SEED)[question.name]
            assert passed == int(verdict.score * len(tests) + 0.01) < len(tests)
            assert said == {verdict.message}


def test_nothing_is_answered():
    """What otter leaves of a solution, an ellipsis, passes no test and says what was needed."""
    tests = [source(c) for c in exported("2.2")["cells"] if c["id"].startswith("test-")]
    passed, [said] = graded(tests, "connection_2_2", ...)
    assert passed == 0
    assert "components were needed" in said


@pytest.mark.parametrize("number", NUMBERS)
def test_blocks_are_closed(number):
    """Each question, solution and list of tests begins and ends once; ids are those of nbformat."""
    cells = exported(number)["cells"]
    keys = [cell["id"] for cell in cells]
    assert len(keys) == len(set(keys))
    assert all(re.fullmatch(r"[a-zA-Z0-9_-]{1,64}", key) for key in keys)
    marks = [source(cell).split("\n")[0] for cell in cells if cell["cell_type"] == "raw"]
    asked = len(exercises.load(number, SEED).questions)
    block = ["# BEGIN QUESTION", "# BEGIN SOLUTION", "# END SOLUTION", "# BEGIN TESTS",
             "# END TESTS", "# END QUESTION"]  # fmt: skip
    assert marks == ["# ASSIGNMENT CONFIG", *block * asked]


def test_a_chapter_and_its_variants():
    """One notebook for each chapter and variant."""
    assert list(assign_files(tasks(["3.1", "3.2", "7.1"], [0, 5]))) == [
        "chapter3.ipynb",
        "chapter3-seed5.ipynb",
        "chapter7.ipynb",
        "chapter7-seed5.ipynb",
    ]


def filled(released: dict, answers: dict[str, str]) -> str:
    """A notebook of a student with answers: name of the variable -> text."""
    handed = json.loads(json.dumps(released))
    for cell in handed["cells"]:
        name = source(cell).removesuffix(" = ...")
        if name in answers:
            cell["source"] = [f"{name} = {json.dumps(answers[name])}"]
    return json.dumps(handed)


# bob is right once, makes a mistake, gives a part of a table and leaves out an exercise.
NUMBERS_ASKED = ("3.1", "3.2", "3.3")
PARTLY = {
    "3.2": {"christoffel": "-cot(phi2)"},
    "3.3": {"ricci": "1,1 = 1/R^2", "scalar": "2/R^2"},
}


def answers_of(student: str) -> dict[str, dict[str, str]]:
    """Exercise -> question -> text; ada answers all."""
    right = {number: exercises.load(number).answers() for number in NUMBERS_ASKED}
    return {"ada": right, "bob": PARTLY}[student]


def variables(answers: dict[str, dict[str, str]]) -> dict[str, str]:
    """The same by the names that they have in the notebook."""
    return {
        f"{key}_{number.replace('.', '_')}": text
        for number, found in answers.items()
        for key, text in found.items()
    }


def points_of(answers: dict[str, dict[str, str]]) -> dict[str, tuple[float, float]]:
    """What each answer earns in the library, and could earn."""
    return {
        f"{part.name}_{number.replace('.', '_')}": (part.points * part.score, part.points)
        for number in NUMBERS_ASKED
        for part in exercises.check(number, answers.get(number, {})).questions
    }


def read_by_otter(folder: Path) -> tuple[dict, dict]:
    """The notebooks for students and for the grader, as otter assign takes them apart."""
    from otter.assign.assignment import Assignment
    from otter.assign.output import write_output_directories

    [(name, text)] = assign_files(tasks(NUMBERS_ASKED, [0])).items()
    (folder / name).write_text(text, "utf-8")
    assignment = Assignment(require_valid_keys=True)
    assignment.master, assignment.result = folder / name, folder / "made"
    assert write_output_directories(assignment)
    found = [folder / "made" / kind / name for kind in ("student", "autograder")]
    student, grader = (json.loads(path.read_text("utf-8")) for path in found)
    return student, grader


@pytest.mark.parametrize("student", ["bob", "ada"])
def test_otter_takes_it_apart(student, tmp_path, monkeypatch):
    """What otter's own reader makes of a notebook: none of the solutions and tests for students,
    and tests that grade what came back as they are run by otter."""
    pytest.importorskip("otter.assign")
    from otter.test_files.exception_test import ExceptionTestFile

    monkeypatch.chdir(tmp_path)
    released, grader = read_by_otter(tmp_path)
    text = json.dumps(released)
    assert "exercises.check" not in text
    assert exercises.load("3.2").answers()["christoffel"] not in text
    answers = answers_of(student)
    scope: dict = {}
    for cell in json.loads(filled(released, variables(answers)))["cells"]:
        if SET.fullmatch(source(cell)):
            exec(source(cell), scope)
    marks, said = {}, {}
    for name, code in grader["metadata"]["otter"]["tests"].items():
        test = ExceptionTestFile.from_metadata(code, "chapter3.ipynb")
        test.run(scope)
        assert all(case.test_case.hidden for case in test.test_case_results)
        marks[name] = (test.score, test.possible)
        said[name] = [case.message for case in test.test_case_results if not case.passed]
    assert marks == points_of(answers)
    if student == "ada":
        assert not any(said.values())
    else:
        assert {earned / most for earned, most in marks.values()} == {0, 0.5, 1}
        assert marks["ricci_3_3"] == (0.5, 1)
        assert said["christoffel_3_2"]
        assert all("The sign is wrong." in message for message in said["christoffel_3_2"])


# What is read in one process stands for it above.
@pytest.mark.slow
@pytest.mark.parametrize("student", ["bob", "ada"])
def test_otter_assigns_and_grades(student, tmp_path):
    """otter assign takes out solutions and tests, and runs them; otter run grades what came back.

    What every kind of answer earns, by one student; ada answers all.
    """
    pytest.importorskip("otter.assign")
    answers = answers_of(student)
    with command("otter.cli", "cli", tmp_path) as otter:
        [(name, text)] = assign_files(tasks(NUMBERS_ASKED, [0])).items()
        (tmp_path / name).write_text(text, "utf-8")
        otter("assign", name, "made")
        released = (tmp_path / "made/student" / name).read_text("utf-8")
        assert "exercises.check" not in released
        assert exercises.load("3.2").answers()["christoffel"] not in released
        [grader] = (tmp_path / "made/autograder").glob("*.zip")
        folder = tmp_path / student
        folder.mkdir()
        (folder / name).write_text(filled(json.loads(released), variables(answers)), "utf-8")
        otter("run", "-a", str(grader), "-o", str(folder), "--no-logo", str(folder / name))
    found = json.loads((folder / "results.json").read_text("utf-8"))
    tests = {test["name"]: test for test in found["tests"] if "score" in test}
    marks = {name: (test["score"], test["max_score"]) for name, test in tests.items()}
    points = points_of(answers)
    assert marks == points
    if student == "ada":
        assert all(earned == most for earned, most in marks.values())
    else:
        assert {earned / most for earned, most in marks.values()} == {0, 0.5, 1}
        assert points["ricci_3_3"] == (0.5, 1)
        assert "The sign is wrong." in tests["christoffel_3_2"]["output"]
