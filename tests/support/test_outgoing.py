"""Outgoing text: no command and no format lets a name act as a command of its target."""

from __future__ import annotations

import ast
import csv
import json
import re
import unicodedata
from pathlib import Path

import pytest
import sympy as sp
from typer.testing import CliRunner

import geomtorsion as gt
from geomtorsion.cli.app import app
from geomtorsion.pictures.latex import latex_name
from geomtorsion.spaces.tetrad_files import read_file
from geomtorsion.support.csv_table import write_csv
from geomtorsion.support.files import finite_number
from geomtorsion.support.outgoing import csv_cell

# Each name breaks out of one target: comments of Mathematica and of LaTeX, docstrings, HTML,
# terminals (titles, colours, hidden text, the eight-bit form, text that runs backwards),
# spreadsheets, and mathematics in figures.
NAMES = (
    "a *) Quit[]; (* b",
    "a *\n) Quit[]; (\r* b",
    "a\n\\input{/etc/passwd}",
    "a\r\\immediate\\write18{id}",
    "a\u2028\\input{b}",
    'a"""\nimport os\n"""',
    "a\\",
    "<script>alert(1)</script>",
    "a\x1b]0;title\x07",
    "a\x1b[2J\x1b[8mhidden",
    "a\x9b31m",
    "a\u202egnp.exe",
    "=cmd|' /C calc'!A0",
    "$\\frac$ $x_{$",
    "a\0b\x7f",
)
# All names joined into one, for commands that draw.
TOGETHER = ("".join(NAMES), "$x_{$")
TETRAD = 'coordinates = ["x", "y"]\ncoframe = [[1, 0], [0, "exp(x)"]]\n'
SCENE = "t = 0.1\naccuracy = 1e-6\n[body]\nmoments = [1, 2, 3]\n[start]\nomega = [0.1, 1, 0]\n"
KEYS = ("name", "title", "story", "source", "notes")
COMMANDS = (
    *(f"geometry FILE --only metric --format {form}" for form in
      ("text", "latex", "json", "python", "mathematica")),
    "check FILE",
    "plan FILE metric",
    "plan FILE metric --dot",
    "report FILE -o OUT",
    "curve FILE --start 0,0 --velocity 1,1 --t 0.1 -o OUT",
    "burgers FILE --circle 0,0:1",
    "burgers FILE --circle 0,0:1 --format json",
)  # fmt: skip


def written(folder: Path, name: str, body: str, keys: tuple[str, ...]) -> Path:
    """A file whose texts are all the given name."""
    path = folder / "a.toml"
    path.write_text("".join(f"{key} = {json.dumps(name)}\n" for key in keys) + body, "utf-8")
    return path


def obeyed(text: str) -> list[str]:
    """Characters of a text that a terminal executes or hides."""
    return [
        sign for sign in text
        if (unicodedata.category(sign) in ("Cc", "Zl", "Zp") and sign not in "\n\t")
        or sign in "\u202d\u202e\u2066\u2067\u2068"
    ]  # fmt: skip


def check_written(form: str, text: str) -> None:
    """Check that a program that reads the format executes nothing in the text."""
    if form == "json":
        json.loads(text)
    elif form == "python":
        assert {type(part) for part in ast.parse(text).body} <= {
            ast.Expr, ast.Import, ast.FunctionDef,
        }  # fmt: skip
        assert "import os" not in [row.strip() for row in text.splitlines()]
    elif form == "latex":
        outside = [row for row in text.split("\n") if not row.startswith("%")]
        assert not re.search(r"\\(input|immediate)", "\n".join(outside))
    elif form == "mathematica":
        # Innermost comments first: Mathematica nests them.
        while (rest := re.sub(r"\(\*(?:(?!\(\*|\*\)).)*\*\)", "", text, flags=re.DOTALL)) != text:
            text = rest
        assert "Quit" not in text
        assert "*)" not in text
        assert "(*" not in text


@pytest.mark.parametrize("command", COMMANDS)
def test_no_name_of_a_tetrad_is_obeyed(command: str, tmp_path: Path):
    """No text of a tetrad file acts as a command in the output of any command that reads it."""
    form = re.search(r"--format (\w+)", command)
    for k, name in enumerate(TOGETHER if " -o " in command else NAMES):
        path = written(tmp_path, name, TETRAD, KEYS)
        out = tmp_path / str(k)
        words = command.replace("FILE", str(path)).replace("OUT", str(out)).split()
        result = CliRunner().invoke(app, words)
        assert result.exit_code == 0, (name, result.output, result.exception)
        assert not obeyed(result.output), (name, obeyed(result.output))
        if form is not None:
            check_written(form[1], result.stdout)
        for page in out.glob("*.html"):
            assert "<script>alert" not in page.read_text("utf-8")
        for table in out.glob("*.csv"):
            with table.open(encoding="utf-8", newline="") as stream:
                cells = [cell for row in csv.reader(stream) for cell in row]
            assert all(cell == csv_cell(cell) or finite_number(cell) is not None for cell in cells)
        for file in out.glob("*.json"):
            json.loads(file.read_text("utf-8"))


@pytest.mark.parametrize(
    "command", ["run FILE -o OUT --picture-format svg", "run FILE", "plan FILE"]
)
def test_no_name_of_a_scene_is_obeyed(command: str, tmp_path: Path):
    """No text of a scene file acts as a command; pictures show it even as invalid mathematics."""
    for k, name in enumerate(TOGETHER if " -o " in command else NAMES):
        path = written(tmp_path, name, SCENE, ("name", "title", "story"))
        words = command.replace("FILE", str(path)).replace("OUT", str(tmp_path / str(k))).split()
        result = CliRunner().invoke(app, words)
        assert result.exit_code == 0, (name, result.output, result.exception)
        assert not obeyed(result.output), (name, obeyed(result.output))


@pytest.mark.parametrize("name", NAMES)
def test_no_message_is_obeyed(name: str, tmp_path: Path):
    """Keys, words and rows of a damaged file are harmless in the messages about it."""
    key = json.dumps(name)
    for text in (f"{key} = 1\n", f"coordinates = [{key}]\ncoframe = [[1]]\n", f"x = {name}\n"):
        path = tmp_path / "a.toml"
        path.write_text(text, "utf-8")
        result = CliRunner().invoke(app, ["check", str(path)])
        assert result.exit_code == 2, result.output
        assert not obeyed(result.output), (text, result.output)


@pytest.mark.parametrize("name", NAMES)
def test_any_name_in_latex(name: str):
    """Any name becomes plain letters of a LaTeX formula."""
    assert not re.search(r"\\(input|immediate|write)", latex_name(name))


def test_tables_hold_no_formulas(tmp_path: Path):
    """Texts that a spreadsheet would compute are escaped; numbers stay as written."""
    path = tmp_path / "a.csv"
    write_csv(path, {"=1+1": [-0.5, 1e-300], "@b": ["=cmd|' /C calc'!A0", "-x"]})
    with path.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.reader(stream))
    assert rows[0] == ["'=1+1", "'@b"]
    assert rows[1] == ["-0.5", "'=cmd|' /C calc'!A0"]
    assert rows[2] == ["1e-300", "'-x"]


NOTEBOOK = ("_repr_html_", "_repr_latex_", "_repr_markdown_", "_repr_svg_")
# HTML tags and terminal escapes; LaTeX commands that would be executed instead of shown.
TAGS = re.compile("<(?:script|img)|\x1b")
COMMANDS_OF_LATEX = re.compile(r"(?<!\\)\\(?:input|immediate|write18)")
SYMBOL = "q\\input{b}<img src=x onerror=alert(1)>"


def shown(folder: Path) -> dict[str, object]:
    """Objects that a notebook shows, with names that would act as commands."""
    name = "".join(NAMES)
    space = read_file(written(folder, name, TETRAD, KEYS))
    q, y = sp.Symbol(SYMBOL, real=True), sp.Symbol("y", real=True)
    frame = gt.Frame([q, y], [[1, sp.Function(SYMBOL)(y)], [0, q + 2]], name=name)
    plain = gt.Frame([q, y], [[1, 0], [0, q + 2]], name=name)
    connection, motion = gt.levi_civita(frame), gt.geodesic(plain, [1, 0.1], [0.1, 0.1])
    loop = gt.Loop.circle([1, 1], radius=1, name=name)
    return {
        "space": space,
        "frame": frame,
        "connection": connection,
        "curvature": connection.curvature,
        "tensor": connection.coefficients,
        "torsion": gt.cartan(frame).torsion,
        "identities": gt.identities(plain),
        "curve": motion,
        "solution": gt.solve(motion, 0.1, 1e-6),
        "equations": gt.ODE.of({"x": "-x"}, [1], name=name),
        "burgers": gt.burgers_vector(plain, loop),
        "exact": gt.exact_burgers_vector(plain, loop),
    }


def test_notebooks(tmp_path: Path):
    """No name acts as a command in HTML, LaTeX or Markdown."""
    count = 0
    for what, value in shown(tmp_path).items():
        for method in NOTEBOOK:
            if hasattr(value, method):
                text = getattr(value, method)()
                assert not TAGS.search(text), (what, method)
                if method in ("_repr_latex_", "_repr_markdown_"):
                    assert not COMMANDS_OF_LATEX.search(text), (what, method)
                count += 1
    assert count > 15


def test_symbols_with_commands_that_show_something():
    """LaTeX in the name of a symbol, such as a bar, stays unchanged."""
    x = sp.Symbol(r"\bar{x}", real=True)
    assert r"\bar{x}" in gt.Frame([x], [[sp.exp(x)]])._repr_latex_()
