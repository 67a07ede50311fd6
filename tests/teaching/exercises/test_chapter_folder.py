"""A teacher's own chapter: a folder with TOML texts, and a Python file where one is wanted."""

from __future__ import annotations

import pickle
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

from geomtorsion import exercises
from geomtorsion.cli.app import app
from geomtorsion.errors import FileFormatError, UnknownNameError
from geomtorsion.teaching.exercises.grading import grade
from geomtorsion.teaching.exercises.sheets import write_sheet

EXAMPLE = Path(__file__).parents[3] / "examples" / "chapter"
PLAIN = r"""title = 'Circles'

[area]
title = 'The area of a circle'
statement = 'A circle has the radius $r$.'
hints = ['It grows with $r^2$.']
coordinates = ["r"]

[area.area]
prompt = 'What is its area?'
answer = "pi*r^2"

[[area.area.mistakes]]
answer = "2*pi*r"
message = 'That is the circumference.'
"""
MADE = """title = 'Made'

[cell]
title = 'A cell'
function = "cell"
"""
VARIANT = """from geomtorsion.teaching.exercises.authoring import Question, Variant

def cell(draw, text):
    return Variant("s", (Question("q", "expression", "p", lambda: {answer}),), (), lambda: ())
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """An empty folder for a chapter."""
    own = tmp_path / "own"
    own.mkdir()
    return own


def written(folder: Path, text: str, program: str = "") -> Path:
    """The folder with these files."""
    (folder / "chapter.toml").write_text(text, "utf-8")
    if program:
        (folder / "chapter.py").write_text(program, "utf-8")
    return folder


def line_of(text: str, part: str) -> int:
    """The line of a text with this part."""
    return text[: text.index(part)].count("\n") + 1


def test_a_chapter_needs_only_texts(folder):
    """Title, statement and answer are enough; any equivalent answer is right."""
    chapter = exercises.load_folder(written(folder, PLAIN))
    assert (chapter.number, chapter.title) == ("8", "Circles")
    assert chapter.titles == {"8.1": "The area of a circle"}
    exercise = chapter.load("8.1")
    assert exercise.check("r \\pi r").right
    wrong = exercise.check("2 pi r")["area"]
    assert wrong.message == "That is the circumference."
    assert not exercise.check("pi*r^2/2").right


def test_the_example_has_values_a_quantity_and_a_function():
    """The answers of the example follow from the geometry of a cone, a surface and a cell."""
    chapter = exercises.load_folder(EXAMPLE)
    # A sheet without the share s has the angle 2 pi (1 - s) less.
    for seed, angle in enumerate(("2*pi/3", "pi/2", "pi/3", "pi")):
        assert chapter.load("8.1", seed).check(angle).right
    # Circles of circumference 2 pi f have R = -2 f''/f; the plane has none.
    surface = {0: ("r^4", "-4/r^2"), 1: ("r^6", "-12/r^2"), 3: ("r^2", "0")}
    for seed, (square, scalar) in surface.items():
        given = {"metric": f"1,1 = 1; 2,2 = {square}", "scalar": scalar}
        assert chapter.load("8.2", seed).check(given).right
    half = chapter.load("8.2").check({"scalar": "-2/r^2"})["scalar"]
    assert "Gaussian curvature" in half.message
    assert chapter.load("8.3", 2).check("r^6").right
    assert "coframe" in chapter.load("8.3", 2).check("r^3")["determinant"].message


def test_values_are_typeset_in_texts():
    """A value is LaTeX in a text and an expression in an answer."""
    exercise = exercises.load("8.1", 1, chapter=EXAMPLE)
    assert r"\frac{3}{4}" in exercise.statement
    assert exercise.answers() == {"angle": "1.57079632679 rad"}


def test_shipped_exercises_stay_beside_the_chapter():
    """The folder adds exercises; without it they are unknown."""
    assert exercises.names(EXAMPLE)[-3:] == ("8.1", "8.2", "8.3")
    assert exercises.names() == exercises.names(EXAMPLE)[:-3]
    assert exercises.chapters(chapter=EXAMPLE)["8"] == "Cones and cells"
    assert exercises.titles(chapter=EXAMPLE)["8.3"] == "How large is a cell?"
    assert exercises.load("1.1", chapter=EXAMPLE) is exercises.load("1.1")
    assert exercises.check("8.3", "r^2", chapter=EXAMPLE).right
    with pytest.raises(UnknownNameError, match=r"from 1\.1 to 7\.4, got '8\.1'"):
        exercises.load("8.1")
    with pytest.raises(UnknownNameError, match=r"from 1\.1 to 8\.3, got '8\.4'"):
        exercises.load("8.4", chapter=EXAMPLE)


def test_copies_are_equal(folder):
    """A chapter and its exercises can be copied; equal content is equal, a changed one is not."""
    chapter = exercises.load_folder(written(folder, PLAIN))
    assert pickle.loads(pickle.dumps(chapter)) == chapter
    assert hash(pickle.loads(pickle.dumps(chapter))) == hash(chapter)
    copied = pickle.loads(pickle.dumps(chapter.load("8.1", 3)))
    assert (copied.number, copied.seed, copied.statement) == (
        "8.1",
        3,
        "A circle has the radius $r$.",
    )
    assert repr(chapter) == "chapter 8. Circles: exercises 8.1"
    changed = exercises.load_folder(written(folder, PLAIN.replace("its area", "the area")))
    assert changed != chapter
    assert changed.load("8.1").questions[0].prompt == "What is the area?"


# A part of PLAIN, its replacement, and words of the refusal.
REFUSED = {
    "no title": ("title = 'The area of a circle'\n", "", "expected the key title, got none"),
    "no statement": ("statement = 'A circle has the radius $r$.'\n", "", "the key statement"),
    "no prompt": ("prompt = 'What is its area?'\n", "", "area.area: expected the key prompt"),
    "no answer": ('answer = "pi*r^2"\n', "", "expected an answer or a quantity, got neither"),
    "empty answer": ('answer = "pi*r^2"', 'answer = " "', "expected an answer, got an empty text"),
    "unknown key": ("prompt =", "promt = 'x'\nprompt =", "unknown key promt. Did you mean prompt?"),
    "unknown key above": ("hints =", "hint = 'x'\nhints =", "got hint. Did you mean hints?"),
    "wrong type": ("hints = ['It grows with $r^2$.']", "hints = 3", "area.hints: expected a list"),
    "wrong type of text": ("title = 'The area of a circle'", "title = 3", "expected a text"),
    "wrong coordinates": ('["r"]', '["r", 3]', "expected a list of texts"),
    "unknown function": ('"pi*r^2"', '"foo(r)"', "foo"),
    "unknown symbol": ('"pi*r^2"', '"pi*R^2"', "R is not a name of this question"),
    "bad mistake": ('"2*pi*r"', '"2*pi*("', "2*pi*("),
    "mistake that is right": ('"2*pi*r"', '"r*pi*r"', "expected a wrong answer, got the right one"),
    "no message": ("message = 'That is the circumference.'\n", "", "the key message"),
    "unknown value": ('"pi*r^2"', '"pi*r^@{n}"', "got @{n}. Write n = [1, 2, 3]"),
    "unknown kind": ("prompt =", "kind = 'expresion'\nprompt =", "Did you mean expression?"),
    "choice without options": ("prompt =", "kind = 'choice'\nprompt =", "the key options"),
    "quantity without coframe": ('answer = "pi*r^2"', 'quantity = "metric"', "expected a coframe"),
    "bad tolerance": ("prompt =", "tolerance = 2\nprompt =", "expected a number between 0 and 1"),
    "unknown level": ("hints =", "level = 'hard'\nhints =", "expected a level, got 'hard'"),
    "question twice": ("[[area", "[area.area]\nprompt = 'x'\n[[area", "expected TOML, got an"),
    "exercise twice": ("[area.area]", "[area]\n[area.area]", "expected TOML, got an"),
    "unclosed brace": ("radius $r$", r"radius $\frac{r}{2$", "expected LaTeX"),
    "hidden rest of a line": ("with $r^2$", "with $5% r^2$", "% hides the rest of its line; write"),
    "unknown command": ("with $r^2$", r"with $\sqare r$", r"unknown command \"\sqare\""),
    "open dollar": ("its area?", "its area $A?", "expected a second $ after '$A?', got none"),
    "number of a shipped chapter": ("title = 'Circles'", "number = 3\ntitle = 'Circles'",
                                    "expected a whole number from 8 to 999, got 3"),
    "unknown key of the chapter": ("title = 'Circles'", "titel = 'x'\ntitle = 'Circles'", "titel"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_a_mistake_is_refused_with_file_and_line(folder, case):
    """Each mistake names the file, the line where it is, and a remedy."""
    old, new, words = REFUSED[case]
    assert old in PLAIN
    text = PLAIN.replace(old, new, 1)
    with pytest.raises(FileFormatError) as caught:
        exercises.load_folder(written(folder, text))
    message = str(caught.value)
    assert message.startswith("chapter.toml: line "), message
    assert words.replace('\\"', '"') in message
    # A missing key is reported at its table, everything else at most one line from the change.
    if new:
        line = int(message.split("line ")[1].split(":")[0].split(",")[0])
        first = line_of(text, new)
        assert first - 1 <= line <= first + new.count("\n") + 1, message


@pytest.mark.parametrize(
    ("program", "words"),
    [
        ("", "expected the file chapter.py in the folder, got none"),
        ("def cel(draw, text): ...", "has no function cell. Did you mean cel?"),
        ("x = 1", "has no function cell"),
        ("def cell(draw, text):\n    return 3\n", "expected a Variant, got 3"),
        ("def cell(draw, text):\n    return 1/0\n", "chapter.py: line 2: .*ZeroDivisionError"),
        ("import no_such_module\ndef cell(draw, text): ...\n", "chapter.py: line 1: .*no_such"),
        ("def cell(draw, text):\n    return (\n", "chapter.py: line 2: .*SyntaxError"),
        ("def cell():\n    ...\n", "chapter.py: expected a program that runs, got TypeError"),
        ("def cell(draw, text):\n    return text('statement')\n", "expected a text 'statement'"),
        (VARIANT.replace("{answer}", "0").replace(",), ()", ", 3), ()"), "a tuple of questions"),
        (VARIANT.replace("{answer}", "0").replace('"expression"', '"x"'), "chapter.py: .*kind"),
    ],
)
def test_a_mistake_of_the_program_is_refused(folder, program, words):
    """An error of chapter.py, or a result that is not an exercise, is refused with its line."""
    with pytest.raises(FileFormatError, match=words):
        exercises.load_folder(written(folder, MADE, program))


def test_an_error_in_an_answer_names_its_line(folder):
    """An answer that is computed later and fails names the line of the program as well."""
    chapter = exercises.load_folder(written(folder, MADE, VARIANT.replace("{answer}", "1/0")))
    with pytest.raises(FileFormatError, match=r"chapter\.py: line 4: .*ZeroDivisionError"):
        chapter.load("8.1").solution()


def test_a_folder_without_a_chapter_is_refused(folder):
    """No folder, no chapter.toml, a second file of texts."""
    with pytest.raises(FileFormatError, match="got no such folder"):
        exercises.load_folder(folder / "missing")
    with pytest.raises(FileFormatError, match=r"expected one TOML file, chapter\.toml, got none"):
        exercises.load_folder(folder)
    (written(folder, PLAIN) / "more.toml").write_text("", "utf-8")
    with pytest.raises(FileFormatError, match=r"got more\.toml"):
        exercises.load_folder(folder)
    with pytest.raises(FileFormatError, match="expected at least one exercise"):
        exercises.load_folder(written(shutil.copytree(EXAMPLE, folder / "a"), "title = 'x'"))


def test_all_commands_take_a_chapter(folder, monkeypatch):
    """List, show, hint, solution, check, sheet and export know the exercises of the folder."""
    shutil.copytree(EXAMPLE, folder / "my")
    monkeypatch.chdir(folder)

    def output(*words: str, code: int = 0) -> str:
        done = CliRunner().invoke(app, ["exercises", *words, "--chapter", "my"])
        assert done.exit_code == code, done.output
        return done.output

    assert "8.2  A surface of circles" in output()
    assert "Find the metric" in output("show", "8.2")
    assert "--chapter" in output("hint", "8.2")
    assert "determinant: r^2" in output("solution", "8.3")
    assert "right" in output("check", "8.1", "2 pi/3").lower()
    assert "the paper that remains" in output("check", "8.1", "4*pi/3", code=1)
    output("sheet", "8", "-o", "sheets")
    assert "chapter='my'" in Path("sheets/chapter8.ipynb").read_text("utf-8")
    output("export", "--to", "moodle", "-o", "moodle")
    assert "Cones and cells" in Path("moodle/geomtorsion-stack.xml").read_text("utf-8")


def test_answers_are_graded_with_the_chapter(folder, tmp_path):
    """Marks of the chapter; a changed chapter is graded again."""
    own = written(folder, PLAIN)
    answers = tmp_path / "answers"
    answers.mkdir()
    (answers / "ada.toml").write_text('seed = 0\n[answers]\n"8.1" = "pi*r^2"\n', "utf-8")
    table = tmp_path / "marks.csv"
    assert grade(answers, table, chapter=own).rows[0]["earned"] == "1"
    assert grade(answers, table, chapter=own).kept == 1
    written(own, PLAIN.replace('"pi*r^2"', '"pi*r^2/4"'))
    again = grade(answers, table, chapter=own)
    assert (again.kept, again.rows[0]["earned"]) == (0, "0")
    assert "no exercise '8.1'" in grade(answers, table).rows[0]["remarks"]


def test_a_sheet_of_the_chapter_has_its_solutions(folder, tmp_path):
    """The teacher's page has the answer and the mistake."""
    files = write_sheet("8", tmp_path / "sheets", own=written(folder, PLAIN))
    solutions = files[-1].read_text("utf-8")
    assert "pi*r^2" in solutions
    assert "That is the circumference." in solutions
