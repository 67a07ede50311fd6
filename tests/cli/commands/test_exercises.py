"""exercises: the list, statements, hints, checks, sheets and marks on the command line."""

import csv

import pytest

from geomtorsion import exercises
from tests.cli.running import run

pytestmark = pytest.mark.usefixtures("one_pool")


def test_the_list():
    """The list shows each number with its title, and each chapter; the help shows an example."""
    text = run("exercises").stdout
    for number, title in exercises.titles().items():
        assert f"{number}  {title}" in text
    for _, title in exercises.CHAPTERS:
        assert title in text
    assert "(project)" in text
    assert "geomtorsion exercises show 3.2 --seed 7" in run("exercises", "--help").stdout


@pytest.mark.parametrize("number", ["1.2", "6.6", "7.2"])
def test_show(number):
    """Statement, questions, answer format and hints are printed; another seed changes the text."""
    text = run("exercises", "show", number).stdout
    exercise = exercises.load(number)
    assert exercise.title in text
    for question in exercise.questions:
        assert question.name in text
    assert "Answer: " in text
    assert "hints: " in text
    assert "$" not in text
    assert run("exercises", "show", number, "--seed", "5").stdout != text


def test_choices_are_listed():
    """Each option is on its own line."""
    assert "    geodesic: a geodesic of the metric" in run("exercises", "show", "6.6").stdout


def test_hints_come_in_steps():
    """--step 2 adds a hint to the first; the last step does not offer another."""
    one, two = (
        run("exercises", "hint", "3.2").stdout,
        run("exercises", "hint", "3.2", "--step", "2").stdout,
    )
    assert two.startswith(one.splitlines()[0])
    assert "--step 2" in one
    assert "Next:" not in two


def test_a_right_answer():
    """Two forms of the right answer are accepted."""
    for answer in ("cos(phi2)/sin(phi2)", "cot(φ2)"):
        assert "Right." in run("exercises", "check", "3.2", answer).stdout


def test_a_wrong_answer():
    """A wrong sign and a factor 2 are named; a wrong answer ends with code 1."""
    text = run("exercises", "check", "3.2", "-cot(phi2)", code=1).stdout
    assert "[the sign]" in text
    assert "[a factor 2]" in run("exercises", "check", "3.2", "-(-2)*cot(phi2)", code=1).stdout
    assert "__import__" in run("exercises", "check", "3.2", "__import__('os')", code=1).stdout


def test_several_answers():
    """Answers are given by name or in order; the points of a missing answer are not counted."""
    solution = exercises.load("3.3", 1).answers()
    named = [f"{name}={text}" for name, text in solution.items()]
    assert "2 of 2 points" in run("exercises", "check", "3.3", *named, "--seed", "1").stdout
    assert (
        "2 of 2 points"
        in run("exercises", "check", "3.3", *solution.values(), "--seed", "1").stdout
    )
    text = run("exercises", "check", "3.3", named[1], "--seed", "1", code=1).stdout
    assert "1 of 2 points" in text
    assert "[no answer]" in text


def test_answers_in_a_file(tmp_path):
    """A file holds a submission or one exercise; its seed applies unless --seed is given."""
    file = tmp_path / "answers.toml"
    solution = exercises.load("3.3", 3).answers()
    lines = "".join(f'{name} = "{text}"\n' for name, text in solution.items())
    file.write_text(f'seed = 3\n[answers."3.3"]\n{lines}', "utf-8")
    assert "2 of 2" in run("exercises", "check", "3.3", "--file", str(file)).stdout
    assert "1.1" in run("exercises", "check", "1.1", "--file", str(file), code=2).stderr
    file.write_text(f"seed = 3\n{lines}", "utf-8")
    assert "2 of 2" in run("exercises", "check", "3.3", "--file", str(file)).stdout
    assert (
        "2 of 2"
        not in run("exercises", "check", "3.3", "--file", str(file), "--seed", "0", code=1).stdout
    )
    file.write_text('"3.2" = "cot(phi2)"\n[answers]\n3.2 = "cot(phi2)"\n', "utf-8")
    assert "Right" in run("exercises", "check", "3.2", "--file", str(file)).stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("show", "9.9"), "the number of an exercise, from 1.1 to 7.4, got '9.9'"),
        (("show", "3.2", "--seed", "-1"), "seed (which variant): expected a whole number"),
        (("check", "3.2"), "expected an answer or --file, got neither"),
        (("check", "3.2", "x", "--file", "y.toml"), "expected an answer or --file, got both"),
        (("check", "3.2", "x", "y"), "expected one answer, got 'x' and 'y'"),
        (("check", "3.3", "scalar=1", "2"), "scalar: expected one answer, got"),
        (("check", "3.2", "--file", "nobody.toml"), "nobody.toml: the file cannot be read"),
        (("sheet", "9", "-o", "x"), "expected the number of a chapter, got '9'"),
        (("grade", "nowhere"), "nowhere: expected a folder of TOML files, got no such folder"),
        (("grade", "."), "expected TOML files of answers, got none"),
    ],
)
def test_impossible_requests_are_refused(arguments, words, tmp_path, monkeypatch):
    """An impossible request ends with code 2 and a message; no file is written."""
    monkeypatch.chdir(tmp_path)
    result = run("exercises", *arguments, code=2)
    assert words in result.stderr.replace("\n", " ")
    assert not list(tmp_path.iterdir())


def test_sheets_are_written(tmp_path):
    """Four files are written; the solutions are in the folder of the teacher."""
    text = run("exercises", "sheet", "3", "-o", str(tmp_path / "out"), "--seed", "2").stdout
    assert text.count("wrote") == 4
    assert (tmp_path / "out" / "teacher" / "chapter3-seed2-solutions.html").stat().st_size > 5000


def test_solution():
    """The solution shows steps, matrices row by row, and the answers that the checker accepts."""
    text = run("exercises", "solution", "3.2", "--seed", "9").stdout
    assert "1. The metric is diagonal: g_11 = φ_2^2 exp(4φ_2), g_22 = 1." in text
    assert "christoffel: (2*phi2 + 1)/phi2" in text
    assert "    E = | sin(z)" in run("exercises", "solution", "2.2", "--seed", "5").stdout


def test_grade(tmp_path):
    """Marks are a table; a bad file is reported and ends with 1; a second run keeps the marks."""
    folder = tmp_path / "answers"
    folder.mkdir()
    (folder / "ada.toml").write_text('[answers]\n"3.2" = "cot(phi2)"\n', "utf-8")
    (folder / "bob.toml").write_text('[answers]\n"3.2" = "-cot(phi2)"\n', "utf-8")
    (folder / "eve.toml").write_text("[[[", "utf-8")
    marks = tmp_path / "marks.csv"
    result = run("exercises", "grade", str(folder), "-o", str(marks), code=1)
    assert "eve.toml: not graded" in result.stderr
    assert "graded 2 of 3 students; 1 to be checked by you" in result.stdout
    with marks.open(encoding="utf-8", newline="") as file:
        rows = {row["file"]: row for row in csv.DictReader(file)}
    assert rows["ada.toml"]["percent"] == "100.0"
    assert rows["bob.toml"]["diagnoses"] == "3.2:christoffel sign"
    assert rows["eve.toml"]["status"] == "not graded"
    (folder / "eve.toml").write_text('seed = 0\n[answers]\n"3.2" = "cot(phi2"\n', "utf-8")
    ranged = run("exercises", "grade", str(folder), "-o", str(marks), code=1)
    assert "eve.toml: partly: 0 % to 100 %, 1 answer to be read by you: 3.2" in ranged.stderr
    assert "graded 3 of 3 students, 2 of them in an earlier run; 1 to be" in ranged.stdout
    (folder / "eve.toml").unlink()
    again = run("exercises", "grade", str(folder), "-o", str(marks))
    assert "2 of them in an earlier run" in again.stdout
    assert "counted: 3.2, all that any student answered" in again.stdout
    assert "ada.toml: graded: the file names no seed: graded as seed 0." in again.stderr
    named = run("exercises", "grade", str(folder), "-o", str(marks), "--only", "3.2")
    assert "counted" not in named.stdout


@pytest.mark.parametrize(
    ("to", "file", "words"),
    [
        ("stack", "geomtorsion-stack.xml", "Moodle XML"),
        ("nbgrader", "source/chapter3/chapter3.ipynb", "generate_assignment"),
    ],
)
def test_export(to, file, words, tmp_path):
    """The text gives the number of written files and the next step for the target system."""
    text = run("exercises", "export", "--to", to, "-o", str(tmp_path), "--only", "3.1").stdout
    assert (tmp_path / file).is_file()
    files = sum(path.is_file() for path in tmp_path.rglob("*"))
    assert f"wrote {files} file{'s' * (files > 1)} to {tmp_path}" in text.replace("\n", " ")
    assert words in " ".join(text.split())


def test_export_of_chosen_variants(tmp_path):
    """--seeds chooses the variants; a wrong seed and an unknown exercise are refused by name."""
    words = ("exercises", "export", "--to", "nbgrader", "-o", str(tmp_path), "--only", "3.1")
    run(*words, "--seeds", "4,5")
    assert (tmp_path / "source/chapter3-seed4/chapter3-seed4.ipynb").is_file()
    assert "got 'x'" in run(*words, "--seeds", "x", code=2).stderr
    said = run(*words[:-1], "9.9", code=2).stderr
    assert "the number of an exercise, from 1.1 to 7.4, got '9.9'" in " ".join(said.split())


def test_moodle_is_another_name_of_stack(tmp_path):
    """`moodle` and `stack` write equal bytes."""
    for name in ("moodle", "stack"):
        run("exercises", "export", "--to", name, "-o", str(tmp_path / name), "--only", "3.2")
    one, two = (next((tmp_path / name).iterdir()).read_bytes() for name in ("moodle", "stack"))
    assert one == two


def test_unreadable_answers_are_neither_right_nor_wrong():
    """The question of an unreadable answer is named as neither right nor wrong."""
    text = run("exercises", "check", "3.2", "1/2 cot phi2/2", code=1).stdout
    assert "could not be read" in text
    assert "Not understood, so neither right nor wrong: christoffel" in text
    assert "read as: sec(phi2)" in run("exercises", "check", "3.2", "sec phi2", code=1).stdout
