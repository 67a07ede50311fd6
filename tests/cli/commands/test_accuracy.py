"""accuracy: the table, the recommendation and the plot of cost against accuracy."""

import json

import pytest

from tests.cli.running import run

CHEAP = ("--engines", "rungekutta", "--accuracies", "1e-3,1e-6", "--t", "1")


def test_help_has_an_example():
    """The help shows an example."""
    assert "geomtorsion accuracy so3" in run("accuracy", "--help").stdout


@pytest.mark.parametrize("name", ["so3", "flat_polar"])
def test_table_and_files(name, tmp_path):
    """Each accuracy has a row with a smaller error; the JSON holds the printed recommendation."""
    text = run("accuracy", name, *CHEAP, "-o", str(tmp_path)).stdout
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
    """The plot is written as an SVG file of more than 10 kB."""
    pytest.importorskip("matplotlib")
    run("accuracy", "s2", "--curve", "autoparallel", *CHEAP, "-o", str(tmp_path), "--format", "svg")
    assert (tmp_path / "accuracy.svg").stat().st_size > 10_000


def test_without_matplotlib(tmp_path, no_pictures):
    """The JSON file is written, and the text names the missing extra."""
    text = run("accuracy", "flat_polar", *CHEAP, "-o", str(tmp_path)).stdout
    assert "geomtorsion[plots]" in text
    assert [path.name for path in tmp_path.iterdir()] == ["accuracy.json"]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("so3", "--accuracies", "0"), "positive number"),
        (("so3", "--accuracies", "much"), "expected a number"),
        (("so3", "--engines", "magic"), "engine: expected one of"),
        (("so3", "--moments", "1,2"), "got 2"),
        (("goedel", "--start", "1"), "expected 4 numbers"),
        (("lagrange_cusp", "--curve", "autoparallel"), "--curve: expected a space, got a scene"),
    ],
)
def test_bad_input_is_refused(arguments, says):
    """A wrong argument ends the command with code 2 and one message."""
    result = run("accuracy", *arguments, code=2)
    assert says in result.stderr
    assert "Traceback" not in result.output


def test_what_accuracy_costs_for_a_scene(tmp_path):
    """Achieved errors are at most the requested ones; the table and the plot are written."""
    arguments = ("--accuracies", "1e-4,1e-8", "--engines", "rungekutta", "--t", "0.2")
    text = run("accuracy", "lagrange_cusp", *arguments, "-o", str(tmp_path)).stdout
    assert "errors against" in text
    table = json.loads((tmp_path / "accuracy.json").read_text())
    assert [row["asked"] for row in table["rows"]] == [1e-4, 1e-8]
    assert all(row["achieved"] <= row["asked"] for row in table["rows"])
    assert (tmp_path / "accuracy.png").stat().st_size > 5000
    text = run("accuracy", "euler_top", "--accuracies", "1e-6", "--engines", "rungekutta").stdout
    assert "the closed form" in text
    assert (
        "expected a space, got a scene"
        in run("accuracy", "euler_top", "--start", "1", code=2).stderr
    )
