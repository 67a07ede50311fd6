"""curve: tables, metadata and figures of geodesic and autoparallel, and refusals."""

import csv
import json
import math
from pathlib import Path

import mpmath
import pytest

from geomtorsion.ode import RungeKutta
from geomtorsion.spaces import load
from geomtorsion.spaces.pair import solve_pair
from tests.cli.running import run
from tests.ode.engines import needs_heyoka

DATA = Path(__file__).parent.parent.parent / "data"
CHEAP = ("--engine", "rungekutta", "--accuracy", "1e-8", "--samples", "21")


def table_of(folder: Path) -> dict[str, list[str]]:
    """Columns of the written table, by their names."""
    with (folder / "curve.csv").open(encoding="utf-8", newline="") as file:
        head, *rows = csv.reader(file)
    return dict(zip(head, map(list, zip(*rows, strict=True)), strict=True))


def test_help_has_an_example():
    """The help shows an example."""
    assert "geomtorsion curve s2" in run("curve", "--help").stdout


@pytest.mark.parametrize("dimension", [4, 5])
def test_up_to_four_coordinates_are_side_by_side(dimension, tmp_path, no_pictures):
    """Up to four coordinates, both curves share a row; with five, each has its own table."""
    names = [f"x{k}" for k in range(dimension)]
    rows = [[int(k == m) for m in range(dimension)] for k in range(dimension)]
    file = tmp_path / "flat.toml"
    file.write_text(f"coordinates = {json.dumps(names)}\ncoframe = {json.dumps(rows)}\n")
    heads = [line for line in run("curve", str(file), *CHEAP).stdout.splitlines() if "x3" in line]
    heads = [line for line in heads if "distance" in line]
    assert [line.count("x3") for line in heads] == ([2] if dimension == 4 else [1, 1])


@pytest.mark.parametrize("name", ["flat_polar", "so3"])
def test_files_hold_what_the_library_computes(name, tmp_path, no_pictures):
    """The table equals the library's numbers; a missing directory is created."""
    folder = tmp_path / "deep" / name
    text = run("curve", name, *CHEAP, "-o", str(folder)).stdout
    assert "(chosen)" in text
    assert "No pictures: matplotlib is not installed" in text
    assert sorted(path.name for path in folder.iterdir()) == ["curve.csv", "curve.json"]
    pair = solve_pair(load(name), engine=RungeKutta(), accuracy=1e-8, samples=21)
    table = table_of(folder)
    assert {key: [float(x) for x in column] for key, column in table.items()} == {
        key: column.tolist() for key, column in pair.columns().items()
    }
    facts = json.loads((folder / "curve.json").read_text("utf-8"))
    assert facts["start"] == [float(x) for x in pair.problem.start or ()]
    assert facts["curves"]["geodesic"]["error"] == pair.shortest.error <= facts["accuracy"]
    assert facts["coincide"] == (name == "so3")


@pytest.mark.parametrize("name", ["s2", str(DATA / "legs.toml")])
def test_pictures_are_written(name, tmp_path):
    """The figures are written and listed in the metadata; each has more than 5 kB."""
    pytest.importorskip("matplotlib")
    run("curve", name, *CHEAP, "-o", str(tmp_path), "--picture-format", "svg")
    listed = json.loads((tmp_path / "curve.json").read_text("utf-8"))["pictures"]
    assert {"coordinates.svg", "distance.svg", "quality.svg"} <= set(listed)
    for file in listed:
        assert (tmp_path / file).stat().st_size > 5000


def test_given_values_are_used():
    """Given values with pi, parameters and moments are used; the text does not call them chosen."""
    given = ("--start", "pi/2,0", "--velocity=0,-1/2", "--t", "pi", "--set", "R=2")
    text = run("curve", "s2", *given, *CHEAP).stdout
    assert "theta = 1.5708" in text
    assert "phi' = -0.5" in text
    assert "R = 2" in text
    assert "(chosen)" not in text
    text = run("curve", "so3", "--moments", "1,2,3", "--t", "1", *CHEAP).stdout
    assert "at the end," in text


def test_chosen_values_suit_given_values():
    """For M = 3 the chosen start is outside the horizon r = 6 of a black hole from a file."""
    arguments = (str(DATA / "schwarzschild.toml"), "--set", "M=3", "--t", "1", *CHEAP)
    text = run("curve", *arguments).stdout
    assert float(text.partition(" r = ")[2].split(",")[0]) > 6
    assert "(chosen)" in text


def test_a_motion_that_ends_early_ends_with_1(tmp_path, no_pictures):
    """The message names the curve and the time of the stop; the computed part is written."""
    given = ("--start", "0.5,0", "--velocity=-0.2,1", "--t", "6", "-o", str(tmp_path))
    result = run("curve", "s2", *given, *CHEAP, code=1)
    assert "autoparallel: the motion stops at t = 2." in result.stderr
    table = table_of(tmp_path)
    assert table["geodesic phi"][-1]
    assert not table["autoparallel phi"][-1]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("s2", "--start", "1"), "expected 2 numbers, got 1"),
        (("s2", "--start", "a,b"), "expected a number, got 'a'"),
        (("s2", "--start", "nan,0"), "expected a finite number, got nan"),
        (("s2", "--start", "0,0"), "is singular at the start"),
        (("s2", "--start", "1,__import__('os')"), "expected a number"),
        (("s2", "--velocity", "1,2", "--frame-velocity", "1,2"), "got both. Give one of them"),
        (("s2", "--t", "0"), "t: expected a time other than 0"),
        (("s2", "--accuracy", "0"), "expected a positive number"),
        (("s2", "--accuracy", "1e-15", "--engine", "rungekutta"), "RungeKutta gets to"),
        (("s2", "--samples", "1"), "a whole number from 2 on"),
        (("s2", "--parameters", "R"), "expected NAME=NUMBER"),
        (("s2", "--parameters", "Q=1"), "expected a parameter of this frame, got 'Q'"),
        (
            ("s2", "--set", "R=-1"),
            "R: expected a value that is positive, nonnegative, as declared, got -1",
        ),
        (("s2", "--parameters", "R=1,R=2"), "expected R once, got it twice"),
        (("s2", "--engine", "magic"), "got 'magic'"),
        (("so3", "--moments", "1,0,1"), "singular"),
        (("schwarzschild", "--start", "0,1,1,0", "--set", "M=1"), "The domain is r > 2*M."),
        (("frw",), "unknown function a"),
        (("kerr_kinnersley",), "complex"),
        (("nowhere",), "the name of a shipped space, got 'nowhere'"),
    ],
)
def test_bad_input_is_refused(arguments, words):
    """A wrong argument ends the command with code 2 and one message, without a traceback."""
    result = run("curve", *arguments, code=2)
    assert words in result.stderr
    assert "Traceback" not in result.output
    assert result.stderr.startswith("geomtorsion: ")


@needs_heyoka
def test_all_digits_of_an_accuracy_beyond_doubles(tmp_path, no_pictures):
    """A straight line in the plane to 1e-25: the table holds r = sqrt(5)/2 to that accuracy."""
    motion = ("--start", "1,0", "--velocity", "0,1/2", "--t", "1", "--samples", "3")
    run("curve", "flat_polar", *motion, "--accuracy", "1e-25", "-o", str(tmp_path))
    last = table_of(tmp_path)["geodesic r"][-1]
    with mpmath.workdps(40):
        assert abs(mpmath.mpf(last) - mpmath.sqrt(5) / 2) < 1e-25


def test_proved_prints_certain_digits():
    """Both curves are printed with 15 certain digits, and both errors are proved."""
    text = run("curve", "s2", "--t", "2", "--accuracy", "1e-8", "--proved").stdout
    assert text.count("proved at t = 2, 15 digits") == 2
    assert text.count("holds: proved") == 2
    assert "theta = 1." in text


def test_forces_and_their_parameters(tmp_path):
    """--force and --potential act on both curves; an unknown name is refused with its remedy."""
    file = tmp_path / "plane.toml"
    file.write_text('coordinates = ["x", "y"]\ncoframe = [[1, 0], [0, 1]]\n')
    place = "--start 1,0 --velocity 0,0 --t 2".split()
    options = [*place, "-o", str(tmp_path / "out"), *CHEAP]
    made = run("curve", str(file), "--force=-k*u1+sin(t), 0", "--set", "k=0", *options)
    assert "geodesic" in made.stdout
    table = table_of(tmp_path / "out")
    column = next(name for name in table if name.endswith("x") and "geodesic" in name)
    assert abs(float(table[column][-1]) - (1 + 2 - math.sin(2))) < 1e-7
    refused = run("curve", str(file), "--force", "-k*u1, 0", *options, code=2)
    assert "u1, u2 along the legs" in refused.output
    assert "--set" in refused.output
