"""Grading: 200 students, malformed and hostile files, interruptions, and the remarks of a row."""

import csv
import json
import os
from random import Random

import pytest

from geomtorsion import exercises
from geomtorsion.errors import ArgumentError, FileFormatError, LimitError, UnknownNameError
from geomtorsion.teaching.exercises import grading
from geomtorsion.teaching.exercises.answers import answer_text
from geomtorsion.teaching.exercises.examiner import Examiner
from geomtorsion.teaching.exercises.grading import (
    GRADED,
    PARTLY,
    REFUSED,
    TWICE,
    grade,
    read_submission,
)
from geomtorsion.teaching.exercises.limits import MOST
from tests.teaching.exercises.forms import another_form

pytestmark = pytest.mark.usefixtures("one_pool")
STUDENTS = 200
NUMBERS = ("1.1", "2.1", "3.2", "3.3")


def handed_in(name: str, seed: int, answers) -> str:
    """A file of answers."""
    lines = [f'student = "{name}"', f"seed = {seed}"]
    for number, table in answers.items():
        lines.append(f'[answers."{number}"]')
        lines += [f"{key} = '''{text}'''" for key, text in table.items()]
    return "\n".join(lines) + "\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """200 students with different knowledge, a malformed and a hostile file."""
    place = tmp_path_factory.mktemp("answers")
    draw = Random("students")
    expected = {}
    for k in range(STUDENTS):
        seed = draw.randrange(4)
        answers, earned, unread = {}, 0.0, 0
        for number in NUMBERS:
            answers[number] = {}
            for question in exercises.load(number, seed).questions:
                if draw.random() < 0.7:
                    text = another_form(question, question.solution, draw)
                    earned += question.points
                elif draw.random() < 0.5:
                    text = answer_text(question, draw.choice(question.mistakes).value)
                else:
                    text = "sin("
                    unread += question.points
                answers[number][question.name] = text
        name = f"student{k:03}"
        expected[f"{name}.toml"] = earned, unread
        (place / f"{name}.toml").write_text(handed_in(f"Student {k}", seed, answers), "utf-8")
    (place / "broken.toml").write_text('[answers\n"1.1" = import os', "utf-8")
    hostile = {
        "1.1": {"legs": f"__import__('os').system('touch {place}/pwned')"},
        "2.1": {"connection": "1,2,2 = " + "(" * 2000},
        "3.2": {"christoffel": "9**9**9**9"},
        "3.3": {
            "scalar": "cos(phi2)*" + "*".join(f"(sin({k}*r)+cos({k}*r))^24" for k in range(99))
        },
    }
    (place / "hostile.toml").write_text(handed_in("=HYPERLINK(1)", 0, hostile), "utf-8")
    (place / "notes.txt").write_text("not an answer", "utf-8")
    return place, expected


def table_of(file) -> dict[str, dict[str, str]]:
    """The rows of the table, by file."""
    with file.open(encoding="utf-8", newline="") as source:
        return {row["file"]: row for row in csv.DictReader(source)}


def test_two_hundred_students(folder, tmp_path):
    """All students get the points they earned; the two bad files are reported and affect no one."""
    place, expected = folder
    seen = []
    marks = grade(place, tmp_path / "marks.csv", progress=lambda *step: seen.append(step))
    assert marks.numbers == NUMBERS
    rows = table_of(tmp_path / "marks.csv")
    assert len(rows) == STUDENTS + 2
    whole = sum(q.points for number in NUMBERS for q in exercises.load(number).questions)
    for name, (earned, unread) in expected.items():
        assert float(rows[name]["earned"]) >= earned
        assert float(rows[name]["earned"]) <= earned + 2
        # A person must read an unreadable answer; until then the marks are a range.
        assert int(rows[name]["points"]) == whole
        most = float(rows[name]["at_most"]) - float(rows[name]["earned"])
        assert most == pytest.approx(unread)
        assert rows[name]["status"] == (PARTLY if unread else GRADED)
        assert ("could not be read" in rows[name]["remarks"]) == bool(unread)
    exact = sum(float(rows[name]["earned"]) == earned for name, (earned, _) in expected.items())
    assert exact > STUDENTS / 2
    assert rows["broken.toml"]["status"] == REFUSED
    assert "expected TOML" in rows["broken.toml"]["remarks"]
    assert rows["hostile.toml"]["status"] == PARTLY
    assert float(rows["hostile.toml"]["earned"]) == 0
    assert not (place / "pwned").exists(), "an answer was run as code"
    assert rows["hostile.toml"]["student"] == "'=HYPERLINK(1)"
    looked_at = {name for name, (_, unread) in expected.items() if unread}
    assert {row["file"] for row in marks.troubled} == looked_at | {"broken.toml", "hostile.toml"}
    assert seen[0][:2] == (0, STUDENTS + 2)
    assert seen[-1][:2] == (STUDENTS + 2, STUDENTS + 2)
    assert [done for done, _, _ in seen] == sorted(done for done, _, _ in seen)


def rows_in(file) -> int:
    """Number of students in the table so far."""
    return len(table_of(file)) if file.exists() else 0


def some(folder, tmp_path, count: int = 6):
    """The first files in a folder of their own."""
    place, _ = folder
    few = tmp_path / "few"
    few.mkdir()
    for path in sorted(place.glob("*.toml"))[:count]:
        (few / path.name).write_bytes(path.read_bytes())
    return few


def test_interrupted_grading_loses_nothing(folder, tmp_path, monkeypatch):
    """Ctrl-C keeps the finished rows in the table; a second run continues from them."""
    few, output = some(folder, tmp_path), tmp_path / "out" / "marks.csv"
    checked = []
    real = Examiner.check

    def counted(self, number, answers, seed=0, **options):
        if len(checked) == 9:
            raise KeyboardInterrupt
        checked.append(number)
        return real(self, number, answers, seed, **options)

    monkeypatch.setattr(Examiner, "check", counted)
    with pytest.raises(KeyboardInterrupt):
        grade(few, output, NUMBERS)
    done = table_of(output)
    assert 2 <= len(done) < 6
    monkeypatch.setattr(Examiner, "check", real)
    marks = grade(few, output, NUMBERS)
    assert marks.kept == len(done)
    assert len(marks.rows) == 6
    whole = table_of(output)
    assert {name: whole[name] for name in done} == done
    assert not list(output.parent.glob(".*"))
    fresh = tmp_path / "fresh.csv"
    written = []
    grade(few, fresh, NUMBERS, progress=lambda done, *_: written.append((done, rows_in(fresh))))
    assert all(done == rows for done, rows in written), "a student done is a row on the disk"
    assert fresh.read_bytes() == output.read_bytes()


def test_a_second_run_that_is_interrupted_loses_nothing(folder, tmp_path, monkeypatch):
    """If the second run stops before a student, the row of the first run remains."""
    few, output = some(folder, tmp_path), tmp_path / "marks.csv"
    grade(few, output, ["3.2"])
    one = min(few.glob("student*.toml"))
    one.write_text(handed_in("Changed", 0, {"3.2": {"christoffel": "0"}}), "utf-8")

    def stopped(*_, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(Examiner, "check", stopped)
    with pytest.raises(KeyboardInterrupt):
        grade(few, output, ["3.2"])
    assert set(table_of(output)) == {path.name for path in few.glob("*.toml")} - {one.name}


def test_a_changed_file_is_graded_again(folder, tmp_path):
    """Only a changed file is graded again; another task, time limit or table regrades all."""
    few, output = some(folder, tmp_path, 3), tmp_path / "marks.csv"
    output.write_text("not,a,table\n", "utf-8")
    assert grade(few, output, NUMBERS).kept == 0
    one = min(few.glob("student*.toml"))
    one.write_text(handed_in("Changed", 0, {"3.2": {"christoffel": "cot(phi2)"}}), "utf-8")
    marks = grade(few, output, NUMBERS)
    assert marks.kept == 2
    assert table_of(output)[one.name]["3.2"] == "1"
    assert grade(few, output, ["3.2"]).kept == 0
    # With more time, an answer that took too long may succeed.
    assert grade(few, output, ["3.2"], seconds=20).kept == 0
    assert grade(few, output, ["3.2"], seconds=20).kept == 3


def test_one_seed_for_all(folder, tmp_path):
    """A student with another variant is reported, not graded."""
    few, output = some(folder, tmp_path), tmp_path / "marks.csv"
    grade(few, output, ["3.2"], seed=2)
    for row in table_of(output).values():
        fits = row["seed"] == "2"
        assert (row["status"] == GRADED) == fits or row["file"] in ("broken.toml", "hostile.toml")
        assert fits or "instead of 2" in row["remarks"] or row["status"] == REFUSED


def test_unknown_exercises_and_empty_folders(tmp_path):
    """An empty folder, an unknown exercise and an empty list are refused before grading."""
    with pytest.raises(FileFormatError, match="expected TOML files of answers, got none"):
        grade(tmp_path, tmp_path / "marks.csv")
    (tmp_path / "a.toml").write_text("", "utf-8")
    with pytest.raises(UnknownNameError, match="9.9"):
        grade(tmp_path, tmp_path / "marks.csv", ["9.9"])
    with pytest.raises(ArgumentError, match="at least one exercise that counts, got none"):
        grade(tmp_path, tmp_path / "marks.csv", [])


def test_rows_are_harmless_in_a_spreadsheet():
    """No cell begins like a formula or contains a line break."""
    for text in ("=1+1", "+1", "-1", "@x", "a\nb", "x" * 1000):
        shown = grading._harmless(text)
        assert shown[0] not in "=+-@"
        assert "\n" not in shown
        assert len(shown) <= MOST.remark + 1


def test_a_name_in_another_encoding_costs_nobody_marks(tmp_path):
    """A file name that is not UTF-8, as from old archives, keeps its row, and so do all others."""
    place = tmp_path / "answers"
    place.mkdir()
    right = '[answers]\n"3.2" = "1/tan(phi2)"\n'
    (place / "ada.toml").write_text(right, "utf-8")
    try:
        (place / os.fsdecode(b"jos\xe9.toml")).write_text(right, "utf-8")
    except OSError:
        pytest.skip("this file system has only names in UTF-8")
    for kept in (0, 2):
        marks = grade(place, tmp_path / "marks.csv")
        assert (len(marks.rows), marks.kept) == (2, kept)
    rows = table_of(tmp_path / "marks.csv")
    assert {name: row["earned"] for name, row in rows.items()} == {
        "ada.toml": "1",
        "jos?.toml": "1",
    }


def graded(tmp_path, files, numbers=None, **more):
    """The rows for some files, by name; the table may be CSV or JSON."""
    place = tmp_path / "answers"
    place.mkdir(exist_ok=True)
    for name, text in files.items():
        (place / name).write_text(text, "utf-8")
    marks = grade(place, tmp_path / more.pop("table", "marks.csv"), numbers, **more)
    return {row["file"]: row for row in marks.rows}


RIGHT = '[answers]\n"3.2" = "1/tan(phi2)"\n'


def test_rows_state_the_seed_of_each_file(tmp_path):
    """A file without a seed is graded with the requested seed or 0, and its row states the seed."""
    files = {"ada.toml": RIGHT, "bob.toml": "seed = 0\n" + RIGHT}
    rows = graded(tmp_path, files)
    assert rows["ada.toml"]["remarks"] == "the file names no seed: graded as seed 0."
    assert rows["bob.toml"]["remarks"] == ""
    assert {row["earned"] for row in rows.values()} == {"1"}
    rows = graded(tmp_path, files, ["3.2"], seed=2)
    assert rows["ada.toml"]["remarks"] == "the file names no seed: graded as seed 2."
    assert (rows["ada.toml"]["seed"], rows["bob.toml"]["status"]) == ("2", REFUSED)


def test_unknown_parts_are_reported(tmp_path):
    """A misspelt question and an unknown exercise are reported, also with several questions."""
    files = {
        "ada.toml": 'seed = 0\n[answers."2.1"]\nconection = "1,2,2 = 1/r"\n',
        "bob.toml": 'seed = 0\n[answers."3.3"]\nscalr = "2/R^2"\n[answers."9.9"]\nx = "1"\n',
        "eve.toml": 'seed = 0\n[answers."2.1"]\n"1,2,2" = "1/r"\n[answers]\n"3.3" = "0"\n',
    }
    rows = graded(tmp_path, files)
    ada, bob, eve = (rows[name] for name in files)
    assert "There is no question 'conection'" in ada["remarks"]
    assert "Did you mean connection?" in ada["remarks"]
    assert "There is no question 'scalr'" in bob["remarks"]
    assert "no exercise '9.9'" in bob["remarks"]
    assert (ada["status"], bob["status"]) == (PARTLY, PARTLY)
    assert eve["2.1"] == "1"
    assert "several questions (ricci, scalar); the answer counts for the first" in eve["remarks"]


def test_a_forgotten_table_of_answers_is_reported(tmp_path):
    """A forgotten table makes the grading partial; a date does not."""
    files = {
        "ada.toml": 'seed = 0\n["3.2"]\nchristoffel = "cot(phi2)"\n',
        "bob.toml": "seed = 0\ndate = 2026-11-23\n" + RIGHT,
        "eve.toml": '[3.2]\nchristoffel = "cot(phi2)"\n' + RIGHT,
    }
    ada, bob, eve = graded(tmp_path, files).values()
    assert (ada["status"], bob["status"], eve["status"]) == (PARTLY, GRADED, PARTLY)
    assert ada["remarks"] == "'3.2' is outside of [answers]: it is not read."
    assert bob["remarks"] == "'date' is outside of [answers]: it is not read."
    assert (ada["earned"], bob["earned"], eve["earned"]) == ("0", "1", "1")


def test_two_files_of_one_student_are_reported(tmp_path):
    """Both rows name the other file; a later third file changes them."""
    files = {
        "a.toml": 'student = "Ada  Lovelace"\nseed = 0\n' + RIGHT,
        "b.toml": 'student = "ada lovelace"\nseed = 0\n' + RIGHT,
        "c.toml": 'student = "Charles"\nseed = 0\n' + RIGHT,
    }
    rows = graded(tmp_path, files)
    assert [rows[name]["status"] for name in files] == [TWICE, TWICE, GRADED]
    assert "the same student as in b.toml" in rows["a.toml"]["remarks"]
    rows = graded(tmp_path, files | {"d.toml": files["a.toml"]})
    assert "the same student as in b.toml, d.toml" in rows["a.toml"]["remarks"]


def test_rows_state_the_number_of_graded_answers(tmp_path):
    """The row states which exercises count and how many questions are answered."""
    files = {"ada.toml": "seed = 0\n" + RIGHT}
    [row] = graded(tmp_path, files).values()
    assert (row["percent"], row["answered"]) == ("100.0", "1 of 1")
    assert row["counted"] == "3.2 (all that any student answered)"
    [row] = graded(tmp_path, files, ["3.1", "3.2", "3.3"]).values()
    assert (row["percent"], row["answered"]) == ("16.7", "1 of 6")
    assert row["counted"] == "3.1 3.2 3.3 (as requested)"


@pytest.mark.parametrize(
    ("christoffel", "least", "most"),
    [("cot(phi2)", "100.0", "100.0"), ("-cot(phi2)", "0.0", "0.0"), ("", "0.0", "0.0"),
     ("sin(", "0.0", "100.0")],
)  # fmt: skip
def test_points_possible_count_every_question(tmp_path, christoffel, least, most):
    """An unreadable answer makes a range; it never removes points from the possible points."""
    files = {"ada.toml": f'seed = 0\n[answers]\n"3.2" = "{christoffel}"\n'}
    [row] = graded(tmp_path, files, ["3.2"]).values()
    assert (row["percent"], row["percent_at_most"], row["points"]) == (least, most, "1")


def test_unreadable_answers_count_as_empty(tmp_path):
    """One right answer and "pass" in all other cells gives the same lower end as empty cells."""
    one, *others = questions = exercises.load("3.3").questions
    right = answer_text(one, one.solution)
    rest = {question.name: "pass" for question in others}
    files = {
        "pass.toml": handed_in("Ada", 0, {"3.3": {one.name: right, **rest}, "3.2": {"x": "pass"}}),
        "empty.toml": handed_in("Eve", 0, {"3.3": {one.name: right}}),
        "whole.toml": handed_in("Bob", 0, {"3.3": {one.name: right, **rest}}),
    }
    rows = graded(tmp_path, files, ["3.3"])
    points = sum(question.points for question in questions)
    share = f"{100 * one.points / points:.1f}"
    assert [rows[name]["percent"] for name in files] == [share] * 3
    assert rows["empty.toml"]["percent_at_most"] == share
    assert rows["pass.toml"]["percent_at_most"] == "100.0"
    assert rows["pass.toml"]["unread"] == str(len(others))
    assert grading.range_text(rows["pass.toml"]) == (
        f"{float(share):.0f} % to 100 %, 1 answer to be read by you"
    )


def test_the_table_as_json(tmp_path):
    """The JSON has the same rows and the counted exercises; a second run continues from it."""
    files = {"ada.toml": RIGHT, "bob.toml": "seed = 0\n" + RIGHT}
    rows = graded(tmp_path, files, table="marks.json")
    data = json.loads((tmp_path / "marks.json").read_text("utf-8"))
    assert (data["counted"], data["chosen"]) == (["3.2"], "all that any student answered")
    first = data["rows"][0]
    assert (first["earned"], first["points"], first["seed"], first["3.2"]) == (1, 1, 0, 1)
    assert first["percent"] == 100
    assert rows == graded(tmp_path, files)
    assert {row["file"]: row["remarks"] for row in data["rows"]} == {
        name: row["remarks"] for name, row in rows.items()
    }
    assert grade(tmp_path / "answers", tmp_path / "marks.json").kept == 2
    for broken in ("{", "[]", '{"rows": 3}', '{"rows": [3]}', '{"rows": [{}]}'):
        (tmp_path / "marks.json").write_text(broken, "utf-8")
        assert grade(tmp_path / "answers", tmp_path / "marks.json").kept == 0


def read(tmp_path, text: str | bytes, name: str = "ada.toml"):
    """The submission in a file with this content."""
    file = tmp_path / name
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_submission(file)


def test_all_ways_to_write_answers(tmp_path):
    """Numbers with or without quotes, tables, single answers and a byte order mark are read."""
    found = read(
        tmp_path,
        '\ufeffstudent = "Ada  Lovelace"\nseed = 7\n[answers]\n"1.1" = "0"\n3.2 = "x"\n'
        '[answers."3.3"]\nricci = "1"\n[answers.7.1]\nline = 8\n[answers."8.8"]\nx = 1\n',
    )
    assert found.student == "Ada Lovelace"
    assert found.seed == 7
    assert found.answers == {"1.1": "0", "3.2": "x", "3.3": {"ricci": "1"}, "7.1": {"line": 8}}
    assert found.unknown == ("8.8",)


def test_optional_entries_have_defaults(tmp_path):
    """The file name replaces a missing student; seed and answers are optional."""
    found = read(tmp_path, "")
    assert (found.student, found.seed, dict(found.answers)) == ("ada", None, {})
    assert read(tmp_path, 'student = " "\n').student == "ada"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("answers = 3", "expected a table, got 3"),
        ("student = 3", "expected a name of at most 200 letters, got 3"),
        ("student = '" + "x" * 300 + "'", "a name of at most"),
        ("seed = -1", "whole number from 0"),
        ("seed = true", "whole number from 0"),
        ("seed = 1e3", "whole number from 0"),
        ('answers = "1.1"', "expected a table, got '1.1'"),
        ("[answers\n", "expected TOML, got an error"),
        ('"1.1" = import os', "expected TOML, got an error"),
        (b"\xff\xfe\x00", "expected UTF-8 text"),
        ("x = " + "[" * 5000 + "]" * 5000, "nested too deeply|expected TOML"),
        ("seed = 0x" + "f" * 9000, "more digits than can be read"),
        ("seed = " + "9" * 9000, "more digits than can be read"),
        ("answers = 0x" + "f" * 9000, "more digits than can be read"),
        ('[answers]\n"1.1" = [0x' + "f" * 9000 + "]", "more digits than can be read"),
    ],
)
def test_bad_files(tmp_path, text, words):
    """The message names the file, the expected value and the remedy."""
    with pytest.raises((FileFormatError, LimitError), match=f"ada.toml: .*({words})"):
        read(tmp_path, text)


def test_large_files_and_no_files(tmp_path):
    """A file that is too long, a missing file, a directory and a pipe are refused."""
    with pytest.raises(LimitError, match="longer than the limit"):
        read(tmp_path, "#" * (MOST.file + 1))
    with pytest.raises(FileFormatError, match="cannot be read"):
        read_submission(tmp_path / "nobody.toml")
    with pytest.raises(FileFormatError, match="not a regular file"):
        read_submission(tmp_path)
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe.toml")
        with pytest.raises(FileFormatError, match="not a regular file"):
            read_submission(tmp_path / "pipe.toml")


def test_an_exercise_that_is_named_twice_counts_once(tmp_path):
    """A repeated number does not count its points twice."""
    (tmp_path / "ada.toml").write_text('seed = 0\n[answers]\n"3.2" = "cot(phi2)"\n', "utf-8")
    [row] = grade(tmp_path, tmp_path / "marks.csv", ["3.2", "3.2"]).rows
    assert (row["earned"], row["points"], row["percent"]) == ("1", "1", "100.0")
