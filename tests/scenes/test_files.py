"""Scene files: they give the described scene, survive writing, and wrong files are refused."""

import math

import numpy as np
import pytest
import sympy as sp

from geomtorsion.errors import FileFormatError, GeomtorsionError, StartError, UnknownNameError
from geomtorsion.scenes import Body, Scene, State, effects, load, names, read_file, to_toml
from geomtorsion.scenes.saving import write_file
from geomtorsion.scenes.scene_files import scene_from
from geomtorsion.scenes.shipped import described
from geomtorsion.support.files import read_toml_text

TOP = """\
name = "top"
title = "a heavy top"
story = "It spins."
watch = ["nutation", "energy"]
t = "2 s"
accuracy = 1e-9
samples = 51

[body]
mass = "500 g"
moments = [1e-3, "1/1000", "10 kg cm^2"]

[[effects]]
kind = "gravity"
g = "981 cm/s^2"

[[effects]]
kind = "pivot"
arm = [0, 0, "5 cm"]

[start]
omega = [0, 0, "600 rpm"]
euler = [0, "30 deg", 0]
"""


def read(text: str, name: str = "a.toml") -> Scene:
    """The scene of a text."""
    return scene_from(read_toml_text(text, name), "a")


def test_a_file_is_the_scene_it_describes():
    """Units, exact expressions and defaults have the values that Python gives."""
    scene = read(TOP)
    assert scene == Scene(
        Body(mass=0.5, moments=(1e-3, 1e-3, 10 * 0.01**2)),
        [effects.Gravity(981 * 0.01), effects.Pivot((0, 0, 5 * 0.01))],
        State(omega=(0, 0, 600 * (2 * math.pi / 60)), euler=(0, math.radians(30), 0)),
        watch=["nutation", "energy"],
        t=2.0,
        accuracy=1e-9,
        name="top",
        title="a heavy top",
        samples=51,
    )


@pytest.mark.parametrize("name", names())
def test_shipped_scenes_come_back_from_their_text(name):
    """Written and read again, a scene is equal; each has a title and a story."""
    scene = load(name)
    assert read(to_toml(scene)) == scene
    assert scene.name == name
    assert scene.title
    assert len(described(name).data["story"]) > 80


def test_all_kinds_of_bodies_and_effects_are_written(tmp_path):
    """Tensors, expressions in text, tables and switches survive writing and reading."""
    acting = [
        effects.Thrust(force=(0, 0, "20*exp(-t/2)"), point=(0, 0, -1), end=3),
        effects.Spring(stiffness=2.5, anchor=(0, 1, 2)),
        effects.Custom(
            moment=(0, 0, "-k*angle"),
            parameters={"k": 2.0},
            states={"angle": "Omega3"},
            start={"angle": 0.1},
            switches=[(1.5, {"k": 3.0})],
        ),
        effects.Rotor((0, 0, 1), momentum=0.2),
    ]
    tensor = ((2.0, 0.1, 0.0), (0.1, 2.0, 0.2), (0.0, 0.2, 3.0))
    scene = Scene(
        Body(mass=2, inertia=tensor),
        acting,
        State(omega=(0.1, 0, 1), quaternion=(1, 0, 0, 0), position=(0, 0, 1), velocity=(1, 0, 0)),
        watch=["position", "omega"],
        t=(0.0, 0.5, 2.0),
        title='with "quotes" and \\ and\nlines',
    )
    path = tmp_path / "scene.toml"
    write_file(scene, path, story="One line.\nAnother.")
    assert read_file(path).with_values(name="") == scene


@pytest.mark.parametrize(("count", "lines"), [(14, 1), (15, 17)])
def test_how_long_lines_of_lists_are(count, lines, tmp_path):
    """A list of 88 characters is on one line; one of 94 has a line for each entry."""
    times = [k + 0.5 for k in range(10, 10 + count)]
    scene = Scene(Body(moments=(1, 1, 2)), (), State(omega=(0, 0, 1)), t=times)
    write_file(scene, tmp_path / "scene.toml")
    written = (tmp_path / "scene.toml").read_text("utf-8")
    part = written[written.index("t = [") : written.index("]", written.index("t = [")) + 1]
    assert len(part.splitlines()) == lines


@pytest.mark.parametrize(
    ("lines", "moments"),
    [
        ('shape = "box"\nmass = 12\nsides = [1, "200 cm", 3]', (13.0, 10.0, 5.0)),
        ('shape = "ellipsoid"\nmass = 5\nsemiaxes = [1, 1, 1]', (2.0, 2.0, 2.0)),
        ('shape = "cylinder"\nmass = 4\nradius = 1\nheight = 0', (1.0, 1.0, 2.0)),
    ],
)
def test_shapes(lines, moments):
    """Each shape gives its moments."""
    text = f"[body]\n{lines}\n[start]\nomega = [0, 0, 1]\n"
    assert read(text).body.moments == pytest.approx(moments)


def test_points():
    """Point masses in a list of tables."""
    points = [f"{{mass = 1, place = [{x}, {y}, 0]}}" for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1))]
    text = f'[body]\nshape = "points"\npoints = [{", ".join(points)}]\n[start]\nomega = [0, 0, 1]\n'
    assert read(text).body.tensor.diagonal().tolist() == [2, 2, 4]


REFUSED = [
    ("watch =", "wach =", "a.toml: line 4: unknown key 'wach'. Did you mean watch?"),
    ('"nutation"', '"nutatoin"', "line 4: nothing called 'nutatoin'.*Did you mean nutation"),
    ('"2 s"', '"2 m"', "line 5: t: expected a value in s, got the unit m"),
    ("1e-9", "-1", "line 6:.*accuracy"),
    ("[body]\n", "[bodi]\n", "unknown key 'bodi'. Did you mean body"),
    ('"500 g"', '"500 gr"', "line 10: body.mass: expected a unit, got 'gr'"),
    ('"500 g"', "-1", "line 10: body: mass: expected a positive number .kg., got -1"),
    ("1e-3,", "-1,", "line 11: body: moments\\[0\\]: expected a positive number .*, got -1"),
    ("1e-3,", "1,", "line 11:.*moments"),
    ('"1/1000"', '"__import__(1)"', "line 11: body.moments\\[1\\]"),
    ("moments", "momnets", "line 11: body: unknown key 'momnets'. Did you mean moments"),
    ('kind = "gravity"', 'kind = "gravty"', "line 14: there is no effect 'gravty'. Did you mean"),
    ('kind = "gravity"', "", "line 13: effects\\[0\\]: kind"),
    ("g = ", "gg = ", "line 15: gravity: unknown key 'gg'. Did you mean g"),
    ("981 cm/s^2", "981 cm/s", "line 15: effects\\[0\\].g: expected a .*, got the unit cm/s"),
    ("981 cm/s^2", "os.system(1)", "line 15:"),
    ("arm = ", "# arm = ", "line 17: pivot: arm \\(m\\) is missing"),
    ("[0, 0, \"5 cm\"]", "[0, 0]", "line 19: pivot.arm: expected three components"),
    ('kind = "pivot"', 'kind = "gravity"', "unknown key 'arm'"),
    ("omega =", "omgea =", "line 22: start: unknown key 'omgea'. Did you mean omega"),
    ("600 rpm", "600 m", "line 22: start.omega\\[2\\]: expected a value in rad/s, got the unit m"),
    ("600 rpm", "600 Hz", "line 22: start.omega\\[2\\]: Hz leaves open"),
    (
        'euler = [0, "30 deg", 0]',
        "quaternion = [0, 0, 0, 0]",
        "line 23: start: quaternion: expected length 1, got 0",
    ),
    ('euler = [0, "30 deg", 0]', "quaternion = [1, 1, 0, 0]", "line 23: start:.*length"),
    ('"a heavy top"', "7", "line 2: title: expected text in quotes"),
    ("[start]", "[[start]]", "start: expected a table"),
    ("[[effects]]\nkind", "[effects]\nkind", "line 13.*expected TOML|effects"),
    ("samples = 51", "samples = 1", "line 7: samples: expected a whole number from 2 on, got 1"),
    ("t = ", "t = = ", "line 5, column 5: expected TOML, got an error"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("old", "new", "words"), REFUSED, ids=[case[1] or "none" for case in REFUSED]
)
def test_bad_calls_are_refused(old, new, words):
    """Each mistake names file, line, and the probable intention."""
    assert old in TOP
    with pytest.raises(FileFormatError, match=words) as caught:
        read(TOP.replace(old, new, 1))
    assert str(caught.value).startswith("a.toml")


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ('[[effects]]\nkind = "drift"\n', "contradict each other"),
        ('[[effects]]\nkind = "gravity"\n', "once, got"),
    ],
)
def test_contradictions(more, words):
    """Effects that exclude each other are refused with the name of the file."""
    with pytest.raises(FileFormatError, match=f"a.toml:.*{words}"):
        read(TOP + more)


FORCED = """watch = ["omega"]
t = [0, 1]

[body]
moments = [1, 2, 2.5]

[[effects]]
kind = "rotor"
axis = [0, 0, 1]
momentum = 0.1
inertia = 0.1

[[effects]]
kind = "body_moment"
moment = [
  0,
  "t",
  "cos(t)",
]

[[effects]]
kind = "body_moment"
moment = [0, 0, "Omega1"]

[start]
omega = [0, 0, 1]
quaternion = [1, 0, 0, 0]
"""


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"cos(t)"', '"cos(s)"', "line 15: body_moment.moment\\[2\\]"),
        ('"Omega1"', '"Omga1"', "line 23: body_moment2.moment\\[2\\].*Did you mean Omega1"),
        ('"Omega1"', "\"__import__('os')\"", "line 23: body_moment2"),
        ('"t"', '"9**9**9*t"', "line 15: body_moment.moment\\[1\\]: the exponent is"),
        ("inertia = 0.1", "inertia = 5", "line 11: rotor.inertia: expected less than .* got 5"),
        (
            "momentum = 0.1",
            'momentum = "t"',
            "line 10: rotor.momentum: expected a finite number",
        ),
        ("[0, 1]", "[1, 0.5]", "line 2: t: expected sorted times"),
        ("quaternion = [1, 0, 0, 0]", "", None),
        ('["omega"]\nt = [0, 1]', '["nutation"]\nt = 1', None),
        ("quaternion = [1, 0, 0, 0]", "velocity = [1, 0, 0]", None),
    ],
)
def test_refusals_of_effects_name_their_lines(old, new, words):
    """An error found only when the equations are assembled also names its line."""
    assert FORCED.count(old) == 1
    text = FORCED.replace(old, new)
    if words is None:
        assert read(text).ode.size in (3, 6)
        return
    with pytest.raises(FileFormatError, match=f"a.toml: {words}"):
        read(text)


def test_a_start_that_lacks_something():
    """The error names the line of [start]; a file without [start] can be planned but not run."""
    text = FORCED.replace('["omega"]', '["nutation"]')
    bare = text.replace("quaternion = [1, 0, 0, 0]", "")
    with pytest.raises(FileFormatError, match="a.toml: line 25: the start has no attitude"):
        read(bare)
    alone = read(text.partition("[start]")[0])
    assert "n1" in alone.selection.states
    with pytest.raises(StartError, match="expected an angular velocity, got none"):
        alone.run()


def test_names_of_scenes():
    """An unknown scene names the nearest one; an unreadable file is an error of ours."""
    assert {"dzhanibekov", "lagrange_cusp", "rolling_disc", "helix"} <= set(names())
    assert len(names()) == 16
    with pytest.raises(UnknownNameError, match="Did you mean helix"):
        load("helx")
    with pytest.raises(GeomtorsionError, match="cannot be read"):
        read_file("nowhere.toml")


def test_what_cannot_be_written():
    """A value that is not data is refused for a scene file."""
    scene = read(TOP)
    with pytest.raises(
        FileFormatError, match="expected numbers or expressions as text for a scene file"
    ):
        to_toml(scene.with_values(title=object()))


def test_floats_of_sympy_keep_all_their_digits():
    """Doubles keep all their 17 digits, where sympy writes 15."""
    third = sp.Float(1 / 3)
    force = third * sp.Symbol("t") + sp.Float(-0.1) ** sp.Symbol("m")
    scene = Scene(
        Body(moments=(third, third, 1 / 3)), [effects.Thrust(force=(force, 0, 0))],
        State(omega=(0, 0, 1), euler=(0, 0, 0)),
    )  # fmt: skip
    back = read(to_toml(scene))
    assert np.diagonal(back.body.tensor).tolist() == [1 / 3] * 3
    [thrust] = back.effects
    assert isinstance(thrust, effects.Thrust)
    assert str(1 / 3) in str(thrust.force[0])
    assert "(-0.1)**m" in str(thrust.force[0])
