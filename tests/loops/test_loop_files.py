"""Files of loops: JSON and CSV, their meaning and refusals."""

import json
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

from geomtorsion.errors import ExpressionError, FileFormatError, GeomtorsionError, LoopError
from geomtorsion.geometry import Frame
from geomtorsion.loops import burgers_vector
from geomtorsion.loops.loop_files import loop_from_data, loops_from_csv, loops_from_json, read_loops

PLANE = Frame("x y", [[1, 0], [0, 1]])


def test_every_kind_of_loop() -> None:
    """All kinds are read from JSON, with names, turns, planes by name and exact numbers."""
    text = json.dumps(
        {
            "loops": [
                {"circle": {"centre": [0, 0], "radius": "pi/2", "plane": ["y", "x"]}, "name": "c"},
                {"ellipse": {"centre": ["1/2", 0], "axes": [2, 1]}, "times": -2},
                {"polygon": {"vertices": [[0, 0], [1, 0], [0, 1]]}},
                {"polygon": {"vertices": [[0, 0], [1, 0], [0, 1]], "centre": [5, 5], "size": 1e-9}},
                {"plaquette": {"corner": [0, 0], "steps": [1, 2], "plane": [[1, 0], [1, 1]]}},
                {"curve": {"expressions": ["cos(t)", "sin(t)"], "parameter": "t",
                           "interval": [0, "2*pi"]}},
                {"spline": {"points": [[1, 0], [0, 1], [-1, 0], [0, -1]]}},
            ],
            "parameters": {"R": "3/2", "b": 1},
            "accuracy": 1e-9,
        }
    )  # fmt: skip
    read = loops_from_json(PLANE, text)
    areas = [loop.area[0, 1] for loop in read.loops]
    pi = 3.141592653589793
    expected = [-(pi**3) / 4, -4 * pi, 0.5, 0.5e-18, 2, pi, 3.05]
    assert areas == pytest.approx(expected, rel=1e-3)
    assert read.loops[0].name == "c"
    assert read.accuracy == 1e-9
    assert float(read.parameters["R"]) == 1.5


def test_csv_of_circles_and_polygons(tmp_path: Path) -> None:
    """A CSV file has one circle per row, or one vertex per row."""
    circles = loops_from_csv(PLANE, "name, x, y, radius, plane\na, 0, 0, 1,\nb, 1/2, 0, 2, y x\n")
    assert [loop.area[0, 1] > 0 for loop in circles.loops] == [True, False]
    file = tmp_path / "loops.csv"
    file.write_text("loop,x,y\nt,0,0\nt,1,0\nt,0,1\nu,0,0\nu,2,0\nu,0,2\n", "utf-8")
    read = read_loops(PLANE, file)
    assert [loop.name for loop in read.loops] == ["t", "u"]
    assert read.loops[1].area[0, 1] == pytest.approx(2)


def test_json_from_a_file(tmp_path: Path) -> None:
    """The suffix of a file decides on its format."""
    file = tmp_path / "loops.json"
    file.write_text('[{"circle": {"centre": [0, 0], "radius": 1}}]', "utf-8")
    assert burgers_vector(PLANE, read_loops(PLANE, file).loops[0]).vanishes


JSON = [
    ('[{"circle": {"centre": [0, 0], "radius": 1}', "line 1, column .* Check that the"),
    ("", "expected JSON, got an error"),
    ("{}", "expected a list of loops"),
    ("[]", "at least one"),
    ("3", "a list of loops"),
    ('[{"circl": {}}]', "expected a known key, got 'circl'. Did you mean circle"),
    ('[{"circle": {"centre": [0, 0]}}]', "expected a value for radius, got none. Add the key"),
    ('[{"circle": {"centre": [0, 0], "radius": NaN}}]', "NaN is not a number"),
    ('[{"circle": {"centre": [0, 0], "radius": true}}]', "expected a number, got True"),
    ('[{"circle": {"centre": [0, null], "radius": 1}}]', r"centre\[1\]: expected a number"),
    (
        '[{"circle": {"centre": [0, 0], "radius": 1, "plane": ["x", "q"]}}]',
        "expected a coordinate, got 'q'",
    ),
    (
        '[{"circle": {"centre": [0, 0], "radius": 1, "plane": "xy"}}]',
        "plane: expected two coordinates",
    ),
    ('[{"circle": 3}]', "expected names with values, got 3"),
    ("[3]", "expected names with values, got 3"),
    ('[{"times": 3}]', "exactly one of .* got none"),
    ('[{"circle": {"centre": [0, 0], "radius": 1}, "name": 3}]', "name: expected text"),
    ('{"loops": [1], "q": 3}', "expected a known key, got 'q'"),
    ('{"loops": [1], "parameters": 3}', "parameters: expected names with values, got 3"),
    ('{"loops": [1], "accuracy": "x"}', "accuracy: expected a number"),
    ("[" * 100000, "nested too deeply|expected JSON"),
]


@pytest.mark.parametrize(("text", "message"), JSON)
def test_malformed_json(text: str, message: str) -> None:
    """Truncated text, unknown and missing keys, and wrong types are refused."""
    with pytest.raises(GeomtorsionError, match=message):
        loops_from_json(PLANE, text)


def test_code_is_not_run() -> None:
    """Numbers and expressions pass the whitelist, so that code is refused."""
    for text in (
        '[{"circle": {"centre": [0, 0], "radius": "__import__(\'os\')"}}]',
        '[{"curve": {"expressions": ["exec(1)", "s"]}}]',
    ):
        with pytest.raises(ExpressionError):
            loops_from_json(PLANE, text)


def test_a_bad_loop_is_named() -> None:
    """The error names the bad loop among many."""
    good = '{"circle": {"centre": [0, 0], "radius": 1}}'
    with pytest.raises(LoopError, match=r"loops\[1\]: radius: expected a positive length"):
        loops_from_json(PLANE, f"[{good}, {good.replace('1}', '-1}')}]")


CSV = [
    ("", "the file is empty"),
    ("x,radius\n0,1\n", "needed are x, y and either radius"),
    ("x,y\n0,1\n", "needed are x, y and either radius"),
    ("x,y,radius\n", "no rows"),
    ("x,y,radius\n0,0,1\n0,0", "line 3: expected 3 columns, got 2"),
    ("x,y,radius\n0,0,\n", "line 2: radius"),
    ("x,y,radius\n0,0,-1\n", "line 2: radius: expected a positive length"),
    ("x,y,radius\n0,0,nan\n", "a finite number"),
    ("loop,x,y\na,0,0\na,1,1\n", "loop a: vertices: expected at least three"),
    ("x,y,radius,plane\n0,0,1,x z\n", "expected a coordinate, got 'z'"),
]


@pytest.mark.parametrize(("text", "message"), CSV)
def test_malformed_csv(text: str, message: str) -> None:
    """Bad headers, rows and cells are refused."""
    with pytest.raises(GeomtorsionError, match=message):
        loops_from_csv(PLANE, text)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    """A missing file and a file that is not text are refused."""
    with pytest.raises(FileFormatError, match="cannot be read"):
        read_loops(PLANE, tmp_path / "none.json")
    binary = tmp_path / "binary.json"
    binary.write_bytes(b"\xff\xfe\x00\x01")
    with pytest.raises(FileFormatError, match="expected UTF-8"):
        read_loops(PLANE, binary)


def test_curves_in_files_may_have_periods() -> None:
    """Periods are given by names of coordinates; unknown names are refused."""
    r, phi = sp.symbols("r phi", positive=True)
    polar = Frame([r, phi], [[1, 0], [0, r]])
    curve = {"expressions": ["2 + cos(s)/2", "s"], "parameter": "s", "interval": [0, "2*pi"]}
    loop = loop_from_data(polar, {"curve": {**curve, "periods": {"phi": "2*pi"}}})
    assert loop.gap.tolist() == [0, 2 * np.pi]
    assert burgers_vector(polar, loop).vector == pytest.approx([0, 4 * np.pi])
    for periods, message in (({"q": 1}, "expected a known name, got 'q'"), ("phi", "periods")):
        with pytest.raises(FileFormatError, match=message):
            loop_from_data(polar, {"curve": {**curve, "periods": periods}})
    with pytest.raises(LoopError, match="does not close"):
        loop_from_data(polar, {"curve": curve})
