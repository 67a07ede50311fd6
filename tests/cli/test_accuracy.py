"""accuracy: the table, the recommendation and the picture of what accuracy costs."""

import json

import pytest
from typer.testing import CliRunner

from geomtorsion.cli.app import app

CHEAP = ("--engines", "rungekutta", "--accuracies", "1e-3,1e-6", "--t", "1")


def run(*arguments: str, code: int = 0):
    """The result of `geomtorsion accuracy` that has to end with a code."""
    result = CliRunner().invoke(app, ["accuracy", *arguments])
    assert result.exit_code == code, result.output
    return result


def test_help_has_an_example():
    """The command explains itself."""
    assert "geomtorsion accuracy so3" in run("--help").stdout


@pytest.mark.parametrize("name", ["so3", "flat_polar"])
def test_table_and_files(name, tmp_path):
    """A row for each accuracy, errors below it, a line that says what to take; files agree."""
    text = run(name, *CHEAP, "-o", str(tmp_path)).stdout
    assert text.count("\nRungeKutta") == 2
    assert "\nTake RungeKutta: 1e-06 in " in text
    assert "(chosen)" in text
    data = json.loads((tmp_path / "accuracy.json").read_text("utf-8"))
    assert [row["asked"] for row in data["rows"]] == [1e-3, 1e-6]
    for row in data["rows"]:
        assert row["achieved"] <= row["asked"]
    assert data["recommendation"] in text
    if (picture := tmp_path / "accuracy.png").exists():
        assert picture.stat().st_size > 10_000
    else:
        assert "No picture" in text


def test_the_picture_is_written(tmp_path):
    """As SVG, with the name of the engine in it."""
    pytest.importorskip("matplotlib")
    run("s2", "--curve", "autoparallel", *CHEAP, "-o", str(tmp_path), "--format", "svg")
    assert (tmp_path / "accuracy.svg").stat().st_size > 10_000


def test_without_matplotlib(tmp_path, monkeypatch):
    """Data are written, and the missing extra is named."""
    monkeypatch.setattr("geomtorsion.pictures.album.can_draw", lambda: False)
    text = run("flat_polar", *CHEAP, "-o", str(tmp_path)).stdout
    assert "geomtorsion[plots]" in text
    assert [path.name for path in tmp_path.iterdir()] == ["accuracy.json"]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("so3", "--accuracies", "0"), "positive number"),
        (("so3", "--accuracies", "much"), "a number was needed"),
        (("so3", "--engines", "magic"), "there is no engine"),
        (("so3", "--moments", "1,2"), "2 came"),
        (("goedel", "--start", "1"), "4 numbers were needed"),
    ],
)
def test_bad_input_is_refused(arguments, says):
    """One clean message, code 2."""
    result = run(*arguments, code=2)
    assert says in result.stderr
    assert "Traceback" not in result.output
