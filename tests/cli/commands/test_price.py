"""price: the table, the prediction for seconds, and the files."""

import csv
import json

import numpy as np
import pytest

import geomtorsion as gt
from tests.cli.running import run

CHEAP = ("--engines", "rungekutta", "--accuracies", "1e-3,1e-6", "--proofs", "none")
MOTION = (*CHEAP, "--t", "1")


def test_help_has_an_example():
    """The help shows an example."""
    assert "geomtorsion price so3" in run("price", "--help").stdout


def test_table_and_files(tmp_path):
    """Each accuracy has a row with a smaller error; JSON and CSV hold the printed rows."""
    text = run("price", "flat_polar", *MOTION, "-o", str(tmp_path)).stdout
    assert text.count("\nRungeKutta") == 4
    assert "\nTake RungeKutta: 1e-06 in " in text
    assert "(chosen)" in text
    data = json.loads((tmp_path / "price.json").read_text("utf-8"))
    assert data["recommendation"] in text
    rows = [row for row in data["rows"] if row["certainty"] == "estimate"]
    assert [row["requested"] for row in rows] == [1e-3, 1e-6]
    assert all(row["true"][1] <= row["requested"] for row in rows)
    with (tmp_path / "price.csv").open(encoding="utf-8", newline="") as file:
        table = list(csv.DictReader(file))
    assert [float(row["seconds"]) for row in table] == [row["seconds"] for row in data["rows"]]
    if (picture := tmp_path / "price.png").exists():
        assert picture.stat().st_size > 10_000
    else:
        assert "No picture" in text


def test_a_loop_and_what_seconds_buy():
    """A loop has rows of numbers, of its formula and of its proof; a second buys the finest."""
    text = run("price", "so3", "--loop", "circle 0.3,1,0.2:0.01", "--budget", "1").stdout
    for name in ("line and flux", "formula", "proof"):
        assert f"\n{name} " in text
    assert "a proof, so that they are enclosed" in text
    assert text.endswith("1 s buys 1e-12\n")


def test_a_scene():
    """A scene has its effects as well."""
    text = run("price", "lagrange_cusp", *CHEAP, "--t", "0.2").stdout
    assert "\nwith gravity: " in text


def test_measured_data(tmp_path):
    """The error of a grid is shown against its spacing, with its noise."""
    axes = [np.linspace(-1, 1, 33)] * 2
    x, y = np.meshgrid(*axes, indexing="ij")
    values = np.array([[-np.sin(3 * y), np.sin(2 * x)]]) / 2
    gt.SampledFrame(axes, values, sigma=1e-4).save(tmp_path / "field.npz")
    text = run("price", str(tmp_path / "field.npz"), "--loop", "circle 0,0:0.6").stdout
    assert text.count("\ncircuit ") == 4
    assert "Noise: " in text


def test_without_matplotlib(tmp_path, no_pictures):
    """The data files are written, and the text names the missing extra."""
    text = run("price", "flat_polar", *MOTION, "-o", str(tmp_path)).stdout
    assert "geomtorsion[plots]" in text
    assert sorted(path.name for path in tmp_path.iterdir()) == ["price.csv", "price.json"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("so3", "--accuracies", "0"), "positive number"),
        (("so3", "--accuracies", "much"), "expected a number"),
        (("so3", "--engines", "magic"), "engine: expected one of"),
        (("so3", "--moments", "1,2"), "got 2"),
        (("so3", "--proofs", "1.5"), "whole number"),
        (("so3", "--loop", "ring 1"), "--loop: expected one of"),
        (("so3", "--loop", "circle 0.3,1,0.2:0.01", "--t", "1"), "expected a motion, got a loop"),
        (("goedel", "--start", "1"), "expected 4 numbers"),
        (("lagrange_cusp", "--curve", "autoparallel"), "expected a motion, got a scene"),
    ],
)
def test_bad_input_is_refused(arguments, words):
    """A wrong argument ends the command with code 2 and one message."""
    result = run("price", *arguments, code=2)
    assert words in result.stderr
    assert "Traceback" not in result.output
