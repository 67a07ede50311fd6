"""otter: notebooks read back and graded by their hidden tests, and by otter itself."""

import json
import re
from functools import cache

import pytest

from geomtorsion import exercises
from geomtorsion.exercises.answers import answer_text
from geomtorsion.exercises.exports.otter import assign_files
from geomtorsion.exercises.exports.tasks import tasks
from tests.exercises.exports.graders import command

NUMBERS = exercises.names()
SEED = 1
SOLUTION = re.compile(r"(\w+) = (.+)  # SOLUTION")


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


@pytest.mark.parametrize("student", ["bob", pytest.param("ada", marks=pytest.mark.slow)])
def test_otter_assigns_and_grades(student, tmp_path):
    """otter assign takes out solutions and tests, and runs them; otter run grades what came back.

    What every kind of answer earns, by one student; ada answers all.
    """
    pytest.importorskip("otter.assign")
    with command("otter.cli", "cli", tmp_path) as otter:
        [(name, text)] = assign_files(tasks(NUMBERS_ASKED, [0])).items()
        (tmp_path / name).write_text(text, "utf-8")
        otter("assign", name, "made")
        released = (tmp_path / "made/student" / name).read_text("utf-8")
        assert "exercises.check" not in released
        assert exercises.load("3.2").answers()["christoffel"] not in released
        [grader] = (tmp_path / "made/autograder").glob("*.zip")
        right = {number: exercises.load(number).answers() for number in NUMBERS_ASKED}
        answers = {"ada": right, "bob": PARTLY}[student]
        given = {f"{key}_{number.replace('.', '_')}": text
                 for number, found in answers.items() for key, text in found.items()}  # fmt: skip
        folder = tmp_path / student
        folder.mkdir()
        (folder / name).write_text(filled(json.loads(released), given), "utf-8")
        otter("run", "-a", str(grader), "-o", str(folder), "--no-logo", str(folder / name))
    found = json.loads((folder / "results.json").read_text("utf-8"))
    tests = {test["name"]: test for test in found["tests"] if "score" in test}
    marks = {name: (test["score"], test["max_score"]) for name, test in tests.items()}
    verdicts = {
        number: exercises.check(number, answers.get(number, {})) for number in NUMBERS_ASKED
    }
    points = {f"{part.name}_{number.replace('.', '_')}": (part.points * part.score, part.points)
              for number, verdict in verdicts.items() for part in verdict.questions}  # fmt: skip
    assert marks == points
    if student == "ada":
        assert all(earned == most for earned, most in marks.values())
    else:
        assert {earned / most for earned, most in marks.values()} == {0, 0.5, 1}
        assert points["ricci_3_3"] == (0.5, 1)
        assert "The sign is wrong." in tests["christoffel_3_2"]["output"]
