"""Texts in files: complete in English, refused with their line if wrong, and served in German."""

from __future__ import annotations

import ast
import copy
import pickle
import subprocess
import sys
from collections.abc import Callable, Iterator
from html import escape
from pathlib import Path
from typing import Any

import pytest

from geomtorsion import exercises
from geomtorsion.errors import FileFormatError, UnknownNameError
from geomtorsion.teaching.exercises import registry
from geomtorsion.teaching.exercises.prose import html_of
from geomtorsion.teaching.exercises.sheets import write_sheet
from geomtorsion.teaching.exercises.verdict import MESSAGES, TITLES
from geomtorsion.teaching.texts import (
    FOLDER,
    Texts,
    language_name,
    languages,
    placeholders,
    texts,
    texts_of,
)
from tests.cli.running import run

EXERCISES = Path(registry.__file__).parent
FRAMES = (FOLDER / "de" / "frames.toml").read_text("utf-8")
GERMAN = [number for number in exercises.names() if number.startswith("1.")]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A teacher's own folder of texts."""
    path = tmp_path / "eigene"
    path.mkdir()
    return path


def loaded(folder: Path, content: str, number: str = "1.1") -> exercises.Exercise:
    """An exercise whose chapter has the given texts."""
    (folder / "frames.toml").write_text(content, "utf-8")
    return exercises.load(number, language=str(folder))


# -- refusals -------------------------------------------------------------------------------------

TITLE = "title = 'Die Beine eines Korahmens'"
MATRIX = "die Matrix\n\n$$@{coframe}"
HINT = "'Hier ist die Determinante $@{determinant}$.'"
STATEMENT, HINTS = "statement = '''\nIn den Koordinaten", "hints = [\n  'Dualität"
# Text to replace in the German chapter, its replacement, words of the message, and the text in
# whose line the mistake is.
BAD = [
    ("permuted = 'Das ist", "swapped = 'Das ist", "unknown text legs.legs.swapped", "swapped"),
    ("permuted = 'Das ist", "# = 'Das ist", "the text legs.legs.permuted, got none", "[legs.legs]"),
    ("[metric.volume]", "[metric.size]", "text metric.size.prompt", "prompt = 'Bestimme das Vol"),
    ("[legs]", "[beine]", "unknown table beine", "[beine]"),
    (MATRIX, "$$@{korahmen}", "expected @{coframe}, @{coordinates}, got @{korahmen}", STATEMENT),
    (MATRIX, "$$ABC", "got no @{coframe}", STATEMENT),
    (HINT, "'Hier ist sie.'", "got no @{determinant}", HINTS),
    (f"{HINT},", "", "expected a list of 3 texts as in English, got a list of 2 texts", HINTS),
    (TITLE, "title = 'Die @Beine'", "expected a placeholder, got '@Beine'", "title = 'Die @Bei"),
    (TITLE, "title = 'Die @{beine'", "expected a placeholder, got '@{beine'", "title = 'Die @{b"),
    (TITLE, "title = 'Die @{Beine}'", "the sign @ as @@", "title = 'Die @{B"),
    (TITLE, "title = ['Beine']", "expected a text as in English, got a list", "title = ['B"),
    (TITLE, "title = 3", "legs.title: expected a text or a list of texts, got 3", "title = 3"),
    (TITLE, "title = ' '", "got an empty text", "title = ' '"),
    (TITLE, 'title = "Die \\mu"', "Put a text with backslashes between", 'title = "Die'),
    (TITLE, "title = Die Beine", "expected TOML", "title = Die"),
]


@pytest.mark.parametrize(("old", "new", "words", "place"), BAD)
def test_bad_texts_are_refused(folder: Path, old: str, new: str, words: str, place: str):
    """A wrong translation is refused with its file and line."""
    assert FRAMES.count(old) == 1
    content = FRAMES.replace(old, new)
    assert content.count(place) == 1
    with pytest.raises(FileFormatError) as caught:
        loaded(folder, content)
    message = str(caught.value)
    assert words in message
    line = content[: content.index(place)].count("\n") + 1
    assert message.startswith(f"eigene/frames.toml: line {line}")
    assert message.removeprefix(f"eigene/frames.toml: line {line}")[0] in ":,"


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("it", "expected en, de, fr or a folder with texts, got 'it'"),
        ("dee", "Did you mean de?"),
        (3, "language: expected the name of a file, got 3"),
        (None, "language: expected the name of a file, got None"),
    ],
)
def test_unknown_languages_are_refused(language: Any, words: str):
    """The message lists the languages."""
    calls: list[Callable[[], object]] = [
        lambda: exercises.load("1.1", language=language),
        lambda: exercises.check("1.1", "0", language=language),
        lambda: exercises.titles(language),
        lambda: exercises.chapters(language),
    ]
    for call in calls:
        with pytest.raises(UnknownNameError) as caught:
            call()
        assert words in str(caught.value)


def test_folders_without_texts_are_refused(folder: Path):
    """A folder needs a file of texts, and each file a name that the package has."""
    with pytest.raises(UnknownNameError, match="which has none"):
        exercises.load("1.1", language=str(folder))
    (folder / "frame.toml").write_text(FRAMES, "utf-8")
    with pytest.raises(UnknownNameError, match=r"Did you mean frames\.toml"):
        exercises.load("1.1", language=str(folder))


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda text: text("title", size=3), "title: expected @{size}, got no @{size}"),
        (lambda text: text("body"), "body: expected no placeholder, got @{size}"),
        (lambda text: text("body", sise=3), "expected @{sise}, got @{size}. Did you mean sise?"),
        (lambda text: text("hints"), "line 3: expected a text 'hints', got a list of 2 texts"),
        (lambda text: text.all("title"), "expected a list of texts 'title', got a text"),
        (lambda text: text.all("hints", size=1, much=2), "got no @{much}"),
        (lambda text: text("nothing"), "line 1: expected a text 'nothing', got nothing"),
        (lambda text: text.table("parts"), "expected a table parts, got none"),
        (lambda text: text.pairs("hints"), "expected no placeholder, got @{size}"),
        (lambda text: text.of("other", "frames"), "expected a table [other], got none"),
    ],
)
def test_wrong_requests_are_refused(call, words: str):
    """An exercise that asks for other texts or values than its file has is refused."""
    content = "[cell]\ntitle = 'A cell'\nhints = ['of @{size}', 'or not']\nbody = 'Size @{size}'"
    with pytest.raises(FileFormatError) as caught:
        call(texts_of(content, "cell.toml", "cell"))
    assert words in str(caught.value)


# -- reading ---------------------------------------------------------------------------------------


def test_texts_are_joined_as_markdown_reads_them():
    """Lines continue, blank lines begin a paragraph, dashes an item; values are not read again."""
    lines = "  One\n  @{x}.\n\n\n  Two:\n\n  - first\n    line\n  - second @@ home"
    content = f"[a]\nb = '''\n{lines}'''"
    text = texts_of(content, "a.toml", "a")
    assert text("b", x="@{y} @@\n\nz") == (
        "One @{y} @@\n\nz.\n\nTwo:\n\n- first line\n- second @ home"
    )
    assert placeholders("@@{no} @{yes}") == {"yes"}


def test_texts_are_never_code(folder: Path):
    """A text is escaped on the page, and no field of a format is followed."""
    bad = "{0.__class__} <script>alert(1)</script> %s $x$"
    content = FRAMES.replace("Die Beine eines Korahmens", bad)
    exercise = loaded(folder, content.replace("In den Koordinaten", f"{bad} In den Koordinaten"))
    assert exercise.title == bad
    html = exercise._repr_html_()
    assert "<script>" not in html
    assert "{0.__class__} &lt;script&gt;" in html
    assert "&lt;script&gt;" in html_of(exercise.statement)
    page, *_ = write_sheet("1", folder / "sheet", language=str(folder))
    assert "<script>" not in page.read_text("utf-8")


def test_nothing_is_read_before_it_is_needed():
    """Importing reads no file of texts, and an exercise reads the file of its chapter only."""
    code = (
        "import sys\n"
        "files = []\n"
        "sys.addaudithook(lambda event, values: files.append(str(values[0]))\n"
        "    if event == 'open' and str(values[0]).endswith('.toml') else None)\n"
        "from geomtorsion import exercises\n"
        "exercises.names()\n"
        "print(len(files))\n"
        "exercises.load('3.2')\n"
        "exercises.load('3.3')\n"
        "print(*[name.replace('\\\\', '/').rpartition('/')[2] for name in files])\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == ["0", "curvature.toml"]


# -- complete -------------------------------------------------------------------------------------


def calls(tree: ast.AST) -> Iterator[tuple[str, str, str, set[str]]]:
    """(name of the object, method, key, names of values) of each request for a text."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call) or not node.args:
            continue
        function, method = node.func, "text"
        if isinstance(function, ast.Attribute) and function.attr in ("all", "table"):
            function, method = function.value, function.attr
        if isinstance(function, ast.Name) and function.id in ("text", "mistakes"):
            first = node.args[0]
            for key in (first.body, first.orelse) if isinstance(first, ast.IfExp) else (first,):
                assert isinstance(key, ast.Constant), ast.unparse(node)
                names = {str(keyword.arg) for keyword in node.keywords}
                yield function.id, method, str(key.value), names


def used(text: Texts, module: str, name: str) -> set[str]:
    """Keys of the texts that a module requests from an object; their placeholders are compared."""
    keys: set[str] = set()
    tree = ast.parse((EXERCISES / f"{module.replace('.', '/')}.py").read_text("utf-8"))
    for owner, method, key, names in calls(tree):
        if owner != name:
            continue
        if method == "table":
            keys |= {entry for entry in text.entries if entry.startswith(f"{key}.")}
            continue
        entry = text.entries[key]
        assert (method == "all") == isinstance(entry, tuple), (module, key)
        found = placeholders(*(entry if isinstance(entry, tuple) else (entry,)))
        assert found == names, (module, key)
        keys.add(key)
    return keys


@pytest.mark.parametrize(("number", "module", "level"), registry.EXERCISES)
def test_every_text_is_used_with_its_values(number: str, module: str, level: str):
    """The file of a chapter has what its exercises request, and nothing else."""
    file, _, heading = module.partition(".")
    text = texts(file, heading)
    shared = "torsion.cartan_connection"
    keys = used(text, module, "text") | {"title"}
    if module == "torsion.one_coefficient":
        # Its question comes from the file of exercise 2.2.
        keys.add("connection.prompt")
    if module == shared:
        keys |= used(text, shared, "mistakes")
    assert keys == set(text.entries)


def test_the_scan_sees_wrong_texts():
    """The test above fails for a text that nobody uses, and for a value that a text lacks."""
    tree = ast.parse("Step(text('a' if x else 'b', n=1), text.all('c'), text.table('d'))")
    assert list(calls(tree)) == [
        ("text", "text", "a", {"n"}), ("text", "text", "b", {"n"}),
        ("text", "all", "c", set()), ("text", "table", "d", set()),
    ]  # fmt: skip


@pytest.mark.parametrize("language", languages())
def test_every_file_can_be_read(language: str):
    """Each shipped file has the texts and placeholders of the English one."""
    files = sorted((FOLDER / language).glob("*.toml"))
    assert files
    assert language_name(language) == language
    for path in files:
        [*headings] = (line for line in path.read_text("utf-8").splitlines() if line[:1] == "[")
        for heading in {line.strip("[]").split(".")[0] for line in headings}:
            assert texts(path.stem, heading, language).translated, (path, heading)


def test_each_mistake_has_a_title_and_a_message():
    """The common messages cover the codes that a title names."""
    spoken = {"incomplete", "empty", "unreadable", "too large"}
    assert set(TITLES) - spoken == set(MESSAGES) - {"branch"}


# -- German ---------------------------------------------------------------------------------------


def test_the_german_chapter():
    """Chapter 1 is German in every variant, with the formulas and answers of the English one."""
    assert exercises.chapters("de")["1"] == "Rahmen und Anholonomie"
    for number in GERMAN:
        for seed in (0, 5):
            german = exercises.load(number, seed, "de")
            english = exercises.load(number, seed)
            assert (german.note, english.note) == ("", "")
            assert german.language == "de"
            pairs = [(german.title, english.title), (german.statement, english.statement)]
            pairs += zip(german.hints[:-1], english.hints[:-1], strict=True)
            for one, two in zip(german.questions, english.questions, strict=True):
                assert one.name == two.name
                pairs.append((one.prompt, two.prompt))
                assert [m.code for m in one.mistakes] == [m.code for m in two.mistakes]
            for one, two in zip(german.worked, english.worked, strict=True):
                assert one.question == two.question
                pairs.append((one.text, two.text))
            assert all(one != two for one, two in pairs if "mathrm{d}(f" not in two)
            assert german.answers() == english.answers()
            assert german.check(german.answers()).right


def test_german_messages():
    """Verdicts on a mistake, a wrong part and a right answer are German."""
    legs = exercises.load("1.1", language="de")
    right = legs.answers()["legs"]
    assert legs.check(right)["legs"].message == "Richtig."
    wrong = {
        "[[cos(phi), -r*sin(phi)], [sin(phi), r*cos(phi)]]": "Eine Inverse fehlt",
        "[[cos(phi), 0], [0, 0]]": "1 von 4 richtig. Sieh noch einmal nach: E[1,2], E[2,1]",
        "": "Es gibt keine Antwort.",
        right.replace("cos", "2*cos").replace("sin", "2*sin"): "Ein Faktor 2 ist falsch.",
    }
    for answer, words in wrong.items():
        assert words in legs.check(answer)["legs"].message
    closed = exercises.load("1.3", language="de").check({"closed": "3.1"})["closed"]
    assert closed.message == "Die Zahl ist nicht richtig."
    assert exercises.check("1.1", right, language="de")["legs"].message == "Richtig."


def test_an_untranslated_exercise_is_english_with_a_note():
    """The note is in the requested language; so are the messages."""
    exercise = exercises.load("4.3", language="fr")
    english = exercises.load("4.3")
    note = "Cet exercice n'est pas encore traduit. Son texte est en anglais."
    assert (exercise.note, english.note) == (note, "")
    assert exercise.statement == english.statement
    assert escape(note) in exercise._repr_html_()
    assert note in exercise._repr_markdown_()
    assert escape(note) not in english._repr_html_()
    right = exercise.answers()["equations"]
    assert exercise.check(right)["equations"].message == "Juste."


def test_a_folder_of_ones_own(folder: Path):
    """A folder may translate a single exercise; all others are English, with a note."""
    first, _, _ = FRAMES.partition("# Aufgabe 1.2.")
    exercise = loaded(folder, first.replace("Die Beine eines Korahmens", "Noch einmal"))
    assert (exercise.title, exercise.note) == ("Noch einmal", "")
    second = exercises.load("1.2", language=folder)
    assert second.title == exercises.titles()["1.2"]
    assert second.note == "This exercise is not translated yet. Its text is English."
    assert exercises.titles(folder)["1.1"] == "Noch einmal"
    page, *_ = write_sheet("1", folder / "sheet", language=folder)
    html = page.read_text("utf-8")
    assert '<html lang="eigene">' in html
    assert html.count(second.note) == 3
    for kind in ("sheet", "nbgrader"):
        if kind == "nbgrader":
            exercises.export(kind, folder / kind, ["1.1"], language=folder)
        [notebook] = (folder / kind).rglob("*.ipynb")
        content = notebook.read_text("utf-8")
        # Students have no such folder.
        assert "Noch einmal" in content
        assert str(folder) not in content


def test_copies_keep_their_language():
    """A copied or pickled exercise has the same language."""
    exercise = exercises.load("1.2", 4, "de")
    for other in (copy.copy(exercise), pickle.loads(pickle.dumps(exercise))):
        assert (other.title, other.language) == (exercise.title, "de")


def test_german_sheets_and_exports(tmp_path: Path):
    """The page, the notebook, the solutions and both exports are German."""
    page, notebook, form, teacher = (
        path.read_text("utf-8") for path in write_sheet("1", tmp_path, 2, language="de")
    )
    assert '<html lang="de">' in page
    for words in ("1. Rahmen und Anholonomie", "Hinweis 1", "Antwort: eine Matrix", "Variante 2."):
        assert words in page
    assert "gt.exercises.load(\\\"1.1\\\", seed=2, language='de')" in notebook
    assert "Komponenten" in form
    assert "Schritt für Schritt" in teacher
    assert "das Vorzeichen: <code>" in teacher
    systems = {"stack": "Antwort: eine Komponente", "nbgrader": "in Anführungszeichen"}
    for kind, words in systems.items():
        [*files] = exercises.export(kind, tmp_path / kind, ["1.1"], language="de").files
        content = files[-1].read_text("utf-8")
        assert "Beine eines Korahmens" in content
        assert words in content


def test_german_on_the_command_line():
    """Each command of exercises takes --language; before the command it is refused."""
    assert "Die Beine eines Korahmens" in run("exercises", "--language", "de").stdout
    shown = run("exercises", "show", "1.1", "--language", "de").stdout
    assert "Bestimme die Matrix" in shown
    assert "hint 1.1 --language de`" in shown
    assert "pas encore traduit" in run("exercises", "hint", "3.1", "--language", "fr").stdout
    solved = run("exercises", "solution", "1.1", "--language", "de").stdout
    assert "Teile durch die Determinante" in solved
    checked = run("exercises", "check", "1.1", "[[1,0],[0,1]]", "--language", "de", code=1).stdout
    assert "[einige Komponenten sind falsch]" in checked
    wrong = run("exercises", "--language", "de", "show", "1.1", code=2)
    assert "expected it behind the command" in wrong.stderr


def test_a_served_page_takes_no_folder(folder: Path):
    """A served page takes a language of the package only, since its address names it."""
    (folder / "frames.toml").write_text(FRAMES, "utf-8")
    wrong = run("lab", "--language", str(folder), code=2)
    assert "language: expected one of en, de, fr" in wrong.stderr
