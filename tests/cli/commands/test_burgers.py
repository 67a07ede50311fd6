"""The command `burgers`: text and JSON, files and pipes, exit codes of failures."""

import json
import math
from pathlib import Path
from typing import Any

import pytest

from geomtorsion.cli.commands import burgers
from geomtorsion.loops import BurgersVector
from tests.cli import running
from tests.materials.test_readers import grid


def run(*arguments: str, code: int = 0, given: str = "") -> Any:
    """Result of `geomtorsion burgers`, which must end with the given code."""
    return running.run("burgers", *arguments, code=code, given=given)


def data(*arguments: str, code: int = 0, given: str = "") -> dict[str, Any]:
    """Parsed JSON that `geomtorsion burgers` prints."""
    return json.loads(run(*arguments, "--format", "json", code=code, given=given).stdout)


def test_help_has_examples() -> None:
    """The help shows an example."""
    assert "geomtorsion burgers so3 --circle" in run("--help").stdout


def test_every_kind_of_loop_on_the_line() -> None:
    """One loop of each kind; the results have the order of the options."""
    found = data(
        "heisenberg",
        *("--circle", "1,2,0:1e-9", "--circle", "0,0,0:1/2:y,x", "--ellipse", "0,0,0:2,1:0,1"),
        *("--polygon", "0,0,0;1,0,0;0,1,0", "--plaquette", "0,0,0:2,3"),
        *("--curve", "cos(s);sin(s)**3;0", "--spline", "1,0,0;0,1,0;-1,0,0;0,-1,0"),
    )
    pi = 3.141592653589793
    areas = [pi * 1e-18, -pi / 4, 2 * pi, 0.5, 6, 3 * pi / 4, 3.05]
    assert [-r["vector"][2] for r in found["results"]] == pytest.approx(areas, rel=1e-3)
    assert found["complete"]
    assert found["space"] == "heisenberg"
    assert all(r["reached"] and r["check"]["agrees"] for r in found["results"])


def test_text_names_route_check_and_cost() -> None:
    """The text names the vector, the route, the check and the number of evaluations."""
    shown = run("so3", "--circle", "0.3,1,0.2:1e-12").stdout
    for words in ("b = (3.0012", "flux: the loop is so small", "checked: line", "evaluations"):
        assert words in shown
    assert "smaller than any double" in run("so3", "--circle", "0.3,1,0.2:1e-300").stdout
    assert (
        "encloses a defect"
        in run("screw_dislocation", "--set", "b=1/2", "--circle", "0,0,0:1").stdout
    )


def test_closed_forms() -> None:
    """--exact prints b as an exact expression, in JSON and in text."""
    found = data("heisenberg", "--circle", "0,0,0:1/2", "--exact")
    assert found["results"][0]["exact"] == ["0", "0", "-pi/4"]
    assert "b = (0, 0, -pi/4)" in run("heisenberg", "--circle", "0,0,0:1/2", "--exact").stdout


def test_closed_forms_take_values() -> None:
    """--exact inserts values of --set exactly; --interval sets the bounds of a curve."""
    half = ("--curve", "cos(s);sin(s);0", "--interval", "0,4*pi")
    found = data("screw_dislocation", "--set", "b=1/3", "--exact", *half)
    assert found["results"][0]["exact"] == ["0", "0", "2/3"]
    found = data("heisenberg", "--loop", half[0][2:] + " " + half[1], *half[2:])
    assert found["results"][0]["vector"][2] == pytest.approx(-2 * math.pi)


def test_a_pipeline(tmp_path: Path) -> None:
    """Loops are read from standard input, JSON and CSV; -o writes JSON and one figure per loop."""
    loops = json.dumps(
        {
            "loops": [{"circle": {"centre": [0, 0, 0], "radius": 1}, "times": 3, "name": "three"}],
            "parameters": {"b": 2},
            "accuracy": 1e-9,
        }
    )
    found = data("screw_dislocation", "--loops", "-", given=loops)
    assert found["results"][0]["vector"] == pytest.approx([0, 0, 6], abs=1e-9)
    assert found["results"][0]["accuracy"] == 1e-9
    file, table, target = tmp_path / "a.json", tmp_path / "b.csv", tmp_path / "out"
    file.write_text(loops, "utf-8")
    table.write_text("x,y,z,radius\n0,0,0,1\n9,0,0,1\n", "utf-8")
    found = data(
        "screw_dislocation", "--loops", str(file), "--loops", str(table), "-o", str(target)
    )
    assert [round(r["vector"][2], 9) for r in found["results"]] == [6, 2, 0]
    assert json.loads((target / "burgers.json").read_text("utf-8")) == found
    pictures = sorted(path.name for path in target.glob("*.svg"))
    assert pictures == ["loop-1.svg", "loop-2.svg", "loop-3.svg"]


def test_files_of_loops_have_to_agree(tmp_path: Path) -> None:
    """Files that disagree in accuracy or a parameter are refused unless an option decides."""
    loop = {"circle": {"centre": [0, 0, 0], "radius": 1}}
    one, other, third = (tmp_path / name for name in ("one.json", "other.json", "third.json"))
    one.write_text(json.dumps({"loops": [loop], "parameters": {"b": 2}, "accuracy": 1e-9}))
    other.write_text(json.dumps({"loops": [loop], "parameters": {"b": 2}, "accuracy": 1e-3}))
    third.write_text(json.dumps({"loops": [loop], "parameters": {"b": 3}}))
    name, files = "screw_dislocation", ("--loops", str(one), "--loops", str(other))
    said = run(name, *files, code=2).stderr
    assert "other.json: expected accuracy = 1e-09 as in" in said
    assert "got 0.001. Choose one by --accuracy" in said
    found = data(name, *files, "--accuracy", "1e-6")["results"]
    assert [result["accuracy"] for result in found] == [1e-6, 1e-6]
    files = ("--loops", str(one), "--loops", str(third))
    assert "third.json: expected b = 2 as in" in run(name, *files, code=2).stderr
    found = data(name, *files, "--set", "b=5")["results"]
    assert [round(result["vector"][2], 9) for result in found] == [5, 5]


def test_a_crowd_of_loops_has_twelve_pictures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The JSON file holds all loops; only the first twelve are drawn."""
    drawn: list[str] = []
    monkeypatch.setattr(burgers, "draw_closure", lambda vector: vector)
    monkeypatch.setattr(burgers, "save", lambda vector, path: drawn.append(path.name))
    loops = [word for k in range(13) for word in ("--circle", f"0,0,{k}:1")]
    for count in (12, 13):
        drawn.clear()
        run("heisenberg", *loops[: 2 * count], "-o", str(tmp_path))
        assert drawn == [f"loop-{k}.svg" for k in range(1, 13)]
        assert len(json.loads((tmp_path / "burgers.json").read_text("utf-8"))["results"]) == count


def test_a_failed_loop_is_reported_beside_the_other() -> None:
    """A loop that meets the axis is reported as failed, the other has its result, the code is 1."""
    both = ("--circle", "1,0,0:1", "--circle", "1,0,0:2")
    found = data("screw_dislocation", "--set", "b=1", *both, code=1)
    assert "passes through" in found["results"][0]["failed"]
    assert found["results"][1]["vector"][2] == pytest.approx(1)
    assert "failed:" in run("screw_dislocation", "--set", "b=1", *both, code=1).stdout


def test_an_interruption_prints_finished_results(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C: the finished results are printed, and the command ends with 130."""
    to_json, calls = BurgersVector.to_json, []

    def interrupted(self: BurgersVector) -> dict[str, Any]:
        calls.append(1)
        if len(calls) == 2:
            raise KeyboardInterrupt
        return to_json(self)

    monkeypatch.setattr(BurgersVector, "to_json", interrupted)
    found = data("so3", *("--circle", "0,1,0:0.5") * 3, code=130)
    assert not found["complete"]
    assert len(found["results"]) == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "expected a loop, got none"),
        (("--circle", "0,1,0"), "expected CENTRE:RADIUS[:PLANE], got 1 part"),
        (("--circle", "0,1:1"), "the loop has 2 coordinates, the frame 3"),
        (("--circle", "0,1,0:-1"), "expected a positive length"),
        (("--circle", "0,1,0:one"), "one is neither"),
        (("--circle", "0,1,0:0.5:phi1,psi"), "expected a coordinate, got 'psi'"),
        (("--circle", "0,1,0:nan"), "a finite number"),
        (("--polygon", "0,0,0;1,1,1"), "at least three points"),
        (("--curve", "s;s;s"), "the gap between its ends is (6.28319, 6.28319, 6.28319)"),
        (("--curve", "cos(s);sin(s);__import__('os')"), "__import__"),
        (("--set", "R", "--circle", "0,1,0:0.5"), "expected NAME=VALUE"),
        (("--set", "R=1", "--circle", "0,1,0:0.5"), "expected a parameter of this frame, got 'R'"),
        (("--accuracy", "0", "--circle", "0,1,0:0.5"), "accuracy"),
        (
            ("--interval", "0,pi", "--circle", "0,1,0:0.5"),
            "expected a --curve in s, got none. Omit it",
        ),
        (
            ("--exact", "--accuracy", "1e-3", "--circle", "0,1,0:0.5"),
            "accuracy 0.001: expected numbers, got --exact",
        ),
        (("--loops", "none.json"), "cannot be read"),
        (("--spline", "0,1,0;1,1,0;0,2,0", "--exact"), "only known numerically"),
    ],
)
def test_bad_input_ends_with_two(arguments: tuple[str, ...], message: str) -> None:
    """A wrong argument ends the command with code 2 and a message, without a traceback."""
    result = run("so3", *arguments, code=2)
    said = " ".join(result.stderr.replace("│", " ").split())
    assert message in said
    assert "Traceback" not in said


def test_a_missing_parameter_is_named() -> None:
    """The message names the missing parameter b and the option --set."""
    result = run("screw_dislocation", "--circle", "0,0,0:1", code=2)
    assert "expected a value for b, got none" in result.stderr
    assert "--set" in result.stderr


def test_any_kind_of_loop_by_one_option() -> None:
    """--loop "circle ..." equals --circle; its errors quote the typed text."""
    found = data("heisenberg", "--loop", "circle 0,0,0:1/2", "--circle", "0,0,0:1/2")["results"]
    assert found[0]["vector"] == found[1]["vector"]
    assert "--loop: expected one of circle, ellipse" in run(
        "heisenberg", "--loop", "ring 1", code=2
    ).stderr  # fmt: skip
    assert "--loop circle 1,2: expected CENTRE:RADIUS" in run(
        "heisenberg", "--loop", "circle 1,2", code=2
    ).stderr  # fmt: skip


def test_closed_forms_have_no_accuracy_in_files() -> None:
    """--exact refuses an accuracy that a file of loops sets."""
    circle = {"circle": {"centre": [2, 3, 0], "radius": 1.5}}
    given = json.dumps({"loops": [circle], "accuracy": 0.1})
    said = run("heisenberg", "--exact", "--loops", "-", code=2, given=given).stderr
    assert "expected numbers, got --exact" in said


def test_a_value_that_contradicts_its_declaration_is_refused() -> None:
    """A value that contradicts a declaration is refused, with numbers and with --exact."""
    for more in ((), ("--exact",)):
        result = run("s2", "--set", "R=-1", "--circle", "1,1:1/2", *more, code=2)
        assert (
            "R: expected a value that is positive, nonnegative, as declared, got -1"
            in result.stderr
        )


def test_proved_prints_certain_digits() -> None:
    """A circle close to the core has 15 certain digits, as text and as data; --exact is refused."""
    past = ("screw_dislocation", "--set", "b=1", "--circle", "1,0,0:1.000001", "--proved")
    assert "b3 = 1.00000000000000" in run(*past).stdout
    proof = data(*past)["results"][0]["proof"]
    assert proof["holds"] is True
    assert proof["values"][2] == "b3 = 1.00000000000000"
    assert len(proof["assumes"]) == 3
    assert "--exact" in run(*past, "--exact", code=2).stderr


def test_measured_data_have_their_own_command(tmp_path) -> None:
    """A measured file is refused with the name of the other command."""
    said = run(str(grid(tmp_path)), "--circle", "2,3:1.5", code=2).stderr
    assert "expected a space or a tetrad file, got measured data" in said
    assert "geomtorsion circuit FILE" in said
    assert "No such option: --sigma" in run("so3", "--sigma", "1", code=2).stderr


def test_a_loop_that_cannot_be_proved_is_reported() -> None:
    """A circle through the core ends with code 2, also with --proved."""
    assert run("screw_dislocation", "--set", "b=1", "--circle", "1,0,0:1", "--proved", code=2)


def test_digits_end_where_the_error_begins():
    """A component below its error is 0, and a zero difference is never printed as 0e+00."""
    text = run("screw_dislocation", "--set", "b=1", "--circle", "0,0,0:1").stdout
    assert "b = (0, 0, 1) +- " in text
    assert "0e+00" not in run("heisenberg", "--plaquette", "0,0,0:1,1").stdout
