"""fit: values from a table of data, files, and refusals."""

import csv
import json

import numpy as np
import pytest

import geomtorsion as gt
from tests.cli.running import run

OPTIONS = ("--start", "1.5,0", "--velocity", "0.1,1", "--free", "R,theta", "--set", "R=2.05")
CHEAP = ("--engine", "rungekutta", "--accuracy", "1e-8")


@pytest.fixture
def track(tmp_path):
    """A noisy great circle on a sphere of radius 2, at a known speed."""
    start = {"start": [1.5, 0.0], "frame_velocity": [0.2, 2.0], "parameters": {"R": 2}}
    times = np.linspace(0.5, 6, 12)
    solution = gt.solve(gt.geodesic("s2", **start), times)
    draws = np.random.default_rng(5).normal(size=(2, 12)) * 1e-3
    rows = np.stack([times, solution["theta"] + draws[0], solution["phi"] + draws[1]], axis=1)
    file = tmp_path / "track.csv"
    lines = [",".join(map(repr, row)) for row in rows.tolist()]
    lines[3] = lines[3].rpartition(",")[0] + ","
    file.write_text("# a sphere\nt, theta, phi\n" + "\n".join(lines) + "\n")
    return file


def test_radius_of_a_sphere(track, tmp_path):
    """Values with errors on the terminal, and the same in files."""
    options = ["--start", "1.5,0", "--frame-velocity", "0.2,2", "--free", "R,theta"]
    text = run(
        "fit", "s2", str(track), *options, "--set", "R=2.05", "--sigma", "0.001", *CHEAP,
        "-o", str(tmp_path / "out"),
    ).stdout  # fmt: skip
    assert "R = 2.00" in text
    assert "chi^2 = " in text
    facts = json.loads((tmp_path / "out" / "fit.json").read_text("utf-8"))
    assert abs(facts["values"]["R"] - 2) < 4 * facts["errors"]["R"] < 0.01
    assert facts["degrees"] == 23 - 2
    with (tmp_path / "out" / "residuals.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert rows[3]["phi"] == rows[3]["residual_phi"] == ""
    squares = [float(row[f"residual_{x}"] or 0) ** 2 for row in rows for x in ("theta", "phi")]
    assert sum(squares) == pytest.approx(facts["chi2"], rel=1e-9)
    assert (tmp_path / "out" / "fit.png").exists()


def test_noise_in_the_file(track):
    """Columns sigma_NAME give the noise of each number."""
    lines = track.read_text().splitlines()
    body = [f"{line},0.001,0.001" for line in lines[2:]]
    track.write_text("\n".join(["t,theta,phi,sigma_theta,sigma_phi", *body]))
    options = ("--start", "1.5,0", "--frame-velocity", "0.2,2", "--free", "R", "--set", "R=2.05")
    assert "R = 2.00" in run("fit", "s2", str(track), *options, *CHEAP).stdout


@pytest.mark.parametrize(
    ("table", "more", "words"),
    [
        ("t,theta\n1,1.5", (), "sigma: expected a value for theta"),
        ("t,theta\n1,1.5", ("--sigma", "x"), "sigma"),
        ("t,psi\n1,1.5\n2,1", ("--sigma", "1"), "expected quantities of the model, got 'psi'"),
        ("t,theta\n1,a", ("--sigma", "1"), "line 2: expected a number in column 2"),
        ("t,theta\n1", ("--sigma", "1"), "expected 2 columns, got 1"),
        ("t,theta\n,1.5", ("--sigma", "1"), "Delete the row"),
        ("t,theta,theta\n1,1,1", ("--sigma", "1"), "Name each column once"),
        ("", ("--sigma", "1"), "expected a header"),
    ],
)
def test_bad_tables_are_refused(table, more, words, tmp_path):
    """Missing noise, unknown columns and damaged rows, each by its line."""
    file = tmp_path / "bad.csv"
    file.write_text(table)
    assert words in run("fit", "s2", str(file), *OPTIONS, *CHEAP, *more, code=2).stderr
