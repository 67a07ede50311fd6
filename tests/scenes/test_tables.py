"""Tables and pieces in scenes: torques from rows, from files, and by pieces of time."""

import pytest

import geomtorsion as gt
from geomtorsion.errors import FileFormatError, SceneError
from geomtorsion.scenes import effects, read_file

ROWS = [(0, 0), (1, 2), (2, 2), (3, -1)]
SCENE = """watch = ["omega"]
t = 3
[body]
moments = [1, 2, 3]
[[effects]]
kind = "custom"
moment = [0, 0, "M(t)"]
tables = {M = TABLE}
[start]
omega = [0, 0, 1]
"""


def spun(**fields):
    """A body with moments 1, 2, 3 that a torque turns about its third axis."""
    return gt.Scene(
        body=gt.Body(mass=1, moments=(1, 2, 3)),
        effects=[effects.Custom(**fields)],
        start=gt.State(omega=(0, 0, 1)),
        t=3,
        watch=["omega", "energy"],
    )


def test_a_torque_from_rows_turns_a_body():
    """The final rate is the integral of the broken line, divided by the moment of inertia."""
    table = gt.Table.of(ROWS, "linear")
    result = spun(moment=(0, 0, "M(t)"), tables={"M": table}).run()
    assert result["omega"][-1] == pytest.approx([0, 0, 1 + 3.5 / 3], rel=1e-9)


def test_a_torque_in_pieces_turns_a_body():
    """A torque of 1 N m for a second and 2 N m from there on."""
    result = spun(moment=(0, 0, "pieces(t, 1, 1, 2)")).run()
    assert result["omega"][-1] == pytest.approx([0, 0, 1 + 5 / 3], rel=1e-9)


def test_an_energy_that_changes_late_is_not_taken_for_conserved():
    """A torque that acts late changes the energy, which is not an invariant."""
    scene = spun(moment=(0, 0, "pieces(t, 0, 2, 1)"))
    assert "energy" not in scene.ode.invariants
    assert scene.run()["omega"][-1] == pytest.approx([0, 0, 4 / 3], rel=1e-9)


@pytest.mark.parametrize(
    ("table", "rate"),
    [
        ('"torque.csv"', None),
        ('{rows = "torque.csv", interpolation = "linear"}', 1 + 3.5 / 3),
        ('{rows = [[0, 0], [1, 2], [2, 2], [3, -1]], interpolation = "linear"}', 1 + 3.5 / 3),
    ],
)
def test_a_scene_file_names_a_table_beside_it(tmp_path, table, rate):
    """Rows may be in the file or in a second file; the saved scene holds them."""
    (tmp_path / "torque.csv").write_text("t,M\n" + "".join(f"{a},{b}\n" for a, b in ROWS))
    file = tmp_path / "wheel.toml"
    file.write_text(SCENE.replace("TABLE", table))
    scene = read_file(file)
    expected = spun(moment=(0, 0, "M(t)"), tables={"M": ROWS}).run()["omega"][-1]
    last = scene.run()["omega"][-1]
    assert last == pytest.approx(expected if rate is None else [0, 0, rate], rel=1e-9)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ('"../torque.csv"', "beside the scene"),
        ('"missing.csv"', "missing.csv"),
        ("[[0, 1]]", "two rows"),
        ("[[1, 1], [0, 1]]", "increasing"),
        ('{rows = [[0, 1], [1, 2]], interpolation = "spline"}', "cubic"),
        ("{places = [0, 1]}", "rows"),
    ],
)
def test_a_bad_table_of_a_scene_file_is_refused(tmp_path, table, words):
    """The message names the reason."""
    file = tmp_path / "wheel.toml"
    file.write_text(SCENE.replace("TABLE", table))
    with pytest.raises(FileFormatError, match=words):
        read_file(file)


def test_a_bad_table_in_python_is_refused():
    """As in a file."""
    with pytest.raises(SceneError, match="two rows"):
        effects.Custom(tables={"M": [(0, 1)]})
