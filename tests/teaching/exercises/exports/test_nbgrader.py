"""nbgrader: notebooks graded by their hidden tests, and by nbgrader itself."""

import ast
import csv
import json
import re
from copy import deepcopy
from functools import cache
from pathlib import Path

import pytest

from geomtorsion import exercises
from geomtorsion.teaching.exercises.answers import answer_text
from geomtorsion.teaching.exercises.exports.nbgrader import course_files
from geomtorsion.teaching.exercises.exports.tasks import tasks
from tests.teaching.exercises.exports.graders import command

NUMBERS = exercises.names()
SEED = 1
SOLUTION = re.compile(r"### BEGIN SOLUTION\n(\w+) = (.+)\n### END SOLUTION")
HIDDEN = re.compile(r"### BEGIN HIDDEN TESTS\n(.+)\n### END HIDDEN TESTS", re.DOTALL)


def source(cell: dict) -> str:
    return "".join(cell["source"])


@cache
def exported(number: str) -> dict:
    files = course_files(tasks([number], [SEED]))
    [name] = [name for name in files if name.endswith(".ipynb")]
    return json.loads(files[name])


def graded(test: str, name: str, answer: str) -> tuple[float, str]:
    """Points and message that a hidden test gives, run as in a notebook."""
    said: list[str] = []
    scope: dict = {"print": said.append, name: answer}
    exec("import geomtorsion as gt", scope)
    *lines, last = test.splitlines()
    try:
        exec("\n".join(lines), scope)
    except AssertionError as error:
        return 0.0, str(error)
    exec(f"points = {last}", scope)
    return scope["points"], said[0]


@pytest.mark.parametrize("number", NUMBERS)
def test_round_trip(number):
    """The notebook's solution earns all points; each mistake gets its own message and score."""
    cells = {cell["id"]: cell for cell in exported(number)["cells"]}
    asked = exercises.load(number, SEED).questions
    for question in asked:
        key = f"{number.replace('.', '-')}-{question.name}"
        solved = SOLUTION.fullmatch(source(cells[f"answer-{key}"]))
        hidden = HIDDEN.search(source(cells[f"test-{key}"]))
        assert solved is not None
        assert hidden is not None
        points, said = graded(hidden[1], solved[1], json.loads(solved[2]))
        assert (points, said) == (question.points, "Right.")
        points, said = graded(hidden[1], solved[1], "sin(" if question.options else "((")
        assert points == 0
        assert said.startswith("Not graded yet: this answer could not be read")
        for mistake in question.mistakes:
            text = answer_text(question, mistake.value)
            points, said = graded(hidden[1], solved[1], text)
            verdict = exercises.check(number, {question.name: text}, SEED)[question.name]
            assert mistake.code in verdict.codes
            assert points == question.points * verdict.score < question.points
            assert said == verdict.message


@pytest.mark.parametrize("number", NUMBERS)
def test_cells_are_marked(number):
    """Each cell has its own id; tests are locked and graded, answers are solutions."""
    cells = exported(number)["cells"]
    keys = [cell["id"] for cell in cells]
    assert len(keys) == len(set(keys))
    assert all(re.fullmatch(r"[a-zA-Z0-9_-]{1,64}", key) for key in keys)
    for cell in cells:
        marks = cell["metadata"]["nbgrader"]
        assert marks["schema_version"] == 3
        assert marks["grade_id"] == cell["id"]
        assert marks["grade"] == ("HIDDEN TESTS" in source(cell)) == ("points" in marks)
        assert marks["solution"] == ("BEGIN SOLUTION" in source(cell))
        assert marks["locked"] != marks["solution"]


def test_a_chapter_and_its_variants():
    """Each chapter has one assignment per variant."""
    files = course_files(tasks(["3.1", "3.2", "7.1"], [0, 5]))
    assert list(files) == [
        "nbgrader_config.py",
        "source/chapter3/chapter3.ipynb",
        "source/chapter3-seed5/chapter3-seed5.ipynb",
        "source/chapter7/chapter7.ipynb",
        "source/chapter7-seed5/chapter7-seed5.ipynb",
    ]


def test_nbgrader_validates_the_cells():
    """The reader of nbgrader accepts a notebook and finds a graded cell for each question."""
    formats = pytest.importorskip("nbgrader.nbgraderformat")
    [text] = list(course_files(tasks(["3.3"], [0])).values())[1:]
    read = formats.reads(text, as_version=4)
    assert sum(cell.metadata.nbgrader.grade for cell in read.cells) == 2


def filled(release: dict, answers: dict[str, dict[str, str]]) -> dict:
    """A released notebook with answers, as a student submits it."""
    handed = json.loads(json.dumps(release))
    for cell in handed["cells"]:
        found = re.fullmatch(r"answer-([0-9])-([0-9])-(\w+)", cell["id"])
        if found and f"{found[1]}.{found[2]}" in answers:
            text = answers[f"{found[1]}.{found[2]}"][found[3]]
            cell["source"] = [f"{found[3]}_{found[1]}_{found[2]} = {json.dumps(text)}"]
    return handed


# bob omits 3.1, has a mistake in 3.2, half a table and a right answer in 3.3; ada answers all.
NUMBERS_ASKED = ("3.1", "3.2", "3.3")
PARTLY = {
    "3.2": {"christoffel": "-cot(phi2)"},
    "3.3": {"ricci": "1,1 = 1/R^2", "scalar": "2/R^2"},
}


def answers_of(student: str) -> dict[str, dict[str, str]]:
    """Exercise -> question -> text."""
    right = {number: exercises.load(number).answers() for number in NUMBERS_ASKED}
    return {"ada": right, "bob": PARTLY}[student]


def run(cells: list) -> None:
    """Run cells in order, and store their results where a kernel stores them."""
    formats = pytest.importorskip("nbformat.v4")
    scope: dict = {}
    for cell in cells:
        said: list[str] = []
        scope["print"] = said.append
        *lines, last = ast.parse(cell.source).body
        try:
            exec(compile(ast.Module(lines, []), "cell", "exec"), scope)
            if isinstance(last, ast.Expr):
                given = eval(compile(ast.Expression(last.value), "cell", "eval"), scope)  # noqa: S307
                shown = {"text/plain": repr(given)}
                cell.outputs = [formats.new_output("execute_result", shown)]
            else:
                exec(compile(ast.Module([last], []), "cell", "exec"), scope)
        except (AssertionError, NameError, NotImplementedError) as error:
            told = {"ename": type(error).__name__, "evalue": str(error)}
            cell.outputs = [formats.new_output("error", **told)]
        if said:
            cell.outputs.append(formats.new_output("stream", text="\n".join(said)))


@pytest.mark.parametrize("student", ["bob", "ada"])
def test_nbgrader_takes_it_apart(student):
    """nbgrader's steps remove solutions and tests from the release and give the library's marks."""
    steps = pytest.importorskip("nbgrader.preprocessors")
    formats = pytest.importorskip("nbgrader.nbgraderformat")
    utils = pytest.importorskip("nbgrader.utils")
    [text] = list(course_files(tasks(NUMBERS_ASKED, [0])).values())[1:]
    teacher = formats.reads(text, as_version=4)
    released = deepcopy(teacher)
    for name in ("LockCells", "ClearSolutions", "CheckCellMetadata", "ClearHiddenTests"):
        released, _ = getattr(steps, name)().preprocess(released, {})
    text = json.dumps(released)
    assert "exercises.check" not in text
    assert "BEGIN SOLUTION" not in text
    answers = answers_of(student)
    handed = formats.reads(json.dumps(filled(released, answers)), as_version=4)
    # nbgrader restores the tests from the teacher's notebook before it runs the cells.
    tests = {cell.id: cell for cell in teacher.cells if utils.is_grade(cell)}
    cells = [tests.get(cell.id, cell) for cell in handed.cells if cell.cell_type == "code"]
    run(cells)
    marks = {key: utils.determine_grade(cell) for key, cell in tests.items()}
    points = {
        f"test-{number.replace('.', '-')}-{part.name}": (part.points * part.score, part.points)
        for number in NUMBERS_ASKED
        for part in exercises.check(number, answers.get(number, {})).questions
    }
    assert marks == points
    shares = {earned / most for earned, most in marks.values()}
    assert shares == ({1} if student == "ada" else {0, 0.5, 1})
    assert ("The sign is wrong." in json.dumps(tests)) == (student == "bob")


# The normal run covers grading by the test above, in one process.
@pytest.mark.slow
@pytest.mark.parametrize("student", ["bob", "ada"])
def test_nbgrader_grades(student, tmp_path):
    """generate_assignment removes solutions and tests; autograde restores the tests."""
    pytest.importorskip("nbgrader")

    def write(path: Path, text: str) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")

    for name, text in course_files(tasks(NUMBERS_ASKED, [0])).items():
        write(tmp_path / name, text)
    with command("nbgrader.apps.nbgraderapp", "main", tmp_path) as nbgrader:
        nbgrader("generate_assignment", "chapter3")
        released = (tmp_path / "release/chapter3/chapter3.ipynb").read_text("utf-8")
        assert "exercises.check" not in released
        assert "BEGIN SOLUTION" not in released
        answers = answers_of(student)
        handed = json.dumps(filled(json.loads(released), answers))
        write(tmp_path / f"submitted/{student}/chapter3/chapter3.ipynb", handed)
        nbgrader("autograde", "chapter3")
        nbgrader("export", "--to", "marks.csv")
    with (tmp_path / "marks.csv").open(encoding="utf-8") as file:
        [marks] = csv.DictReader(file)
    verdicts = [exercises.check(number, answers.get(number, {})) for number in NUMBERS_ASKED]
    earned, most = (sum(getattr(x, key) for x in verdicts) for key in ("earned", "points"))
    assert marks["student_id"] == student
    assert float(marks["max_score"]) == most
    assert float(marks["score"]) == pytest.approx(earned)
    assert earned == most if student == "ada" else 0 < earned < most
    graded = (tmp_path / f"autograded/{student}/chapter3/chapter3.ipynb").read_text("utf-8")
    assert ("The sign is wrong." in graded) == (student == "bob")
