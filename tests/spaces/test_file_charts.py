"""File charts: motions continue in the charts of a file, whose maps are checked when read."""

import pickle

import numpy as np
import pytest

from geomtorsion.curves import autoparallel, geodesic
from geomtorsion.curves.atlas import atlas_of
from geomtorsion.errors import FileFormatError
from geomtorsion.geometry import cartan
from geomtorsion.ode import solve
from geomtorsion.spaces.tetrad_files import read_file
from tests.ode.engines import every_engine

PLANE = """
name = "plane"
coordinates = ["r", "phi"]
coframe = [[1, 0], [0, "r"]]
edge = "r"
margin = 0.2

[[charts]]
name = "cartesian"
coordinates = ["x", "y"]
coframe = [[1, 0], [0, 1]]
from_home = ["r*cos(phi)", "r*sin(phi)"]
to_home = ["sqrt(x**2 + y**2)", "atan2(y, x)"]
angles = ["phi"]
"""
SPHERE = """
coordinates = ["theta", "phi"]
coframe = [["R", 0], [0, "R*sin(theta)"]]
domain = ["0 < theta < pi"]
edge = "sin(theta)"
margin = "1/4"

[parameters]
R = "positive"

[[charts]]
name = "north"
coordinates = ["x", "y"]
coframe = [["2*R/(1 + x**2 + y**2)", 0], [0, "2*R/(1 + x**2 + y**2)"]]
from_home = ["tan(theta/2)*cos(phi)", "tan(theta/2)*sin(phi)"]
to_home = ["2*atan(sqrt(x**2 + y**2))", "atan2(y, x)"]
angles = ["phi"]
edge = "1/(1 + x**2 + y**2)"
margin = "1/4"

[[charts]]
name = "south"
coordinates = ["X", "Y"]
coframe = [["2*R/(1 + X**2 + Y**2)", 0], [0, "2*R/(1 + X**2 + Y**2)"]]
from_home = ["cos(phi)/tan(theta/2)", "sin(phi)/tan(theta/2)"]
to_home = ["pi - 2*atan(sqrt(X**2 + Y**2))", "atan2(Y, X)"]
angles = ["phi"]
edge = "1/(1 + X**2 + Y**2)"
margin = "1/4"
"""


@pytest.fixture
def space(tmp_path):
    """A function from text to the described space."""

    def read(text):
        file = tmp_path / "own.toml"
        file.write_text(text, encoding="utf-8")
        return read_file(file)

    return read


@every_engine
def test_through_the_origin(space, engine):
    """A straight line very close to the origin of polar coordinates."""
    found = solve(geodesic(space(PLANE).frame, [1, 0], [-1, 1e-9]), 3.0, engine=engine)
    assert found.charts.count("cartesian") == 1
    x, y = found.in_chart("cartesian").T
    assert x == pytest.approx(1 - found.times, abs=1e-9)
    assert y == pytest.approx(1e-9 * found.times, abs=1e-9)
    assert found["r"][-1] == pytest.approx(2.0, rel=1e-9)


@every_engine
def test_over_both_poles(space, engine):
    """A great circle through the poles comes back after one turn."""
    frame = space(SPHERE).frame
    problem = geodesic(frame, [1.0, 0.3], [-1.0, 0.0], parameters={"R": 2})
    found = solve(problem, 2 * np.pi, engine=engine)
    assert {"north", "south"} <= set(found.charts)
    assert found["theta"][-1] == pytest.approx(1.0, rel=1e-9)
    assert np.cos(found["phi"][-1] - 0.3) == pytest.approx(1.0, abs=1e-12)


def test_signature_follows_the_file(space):
    """Rindler's wedge in the inertial coordinates around it: a free fall through the horizon."""
    wedge = """
    name = "wedge"
    coordinates = ["s", "rho"]
    signature = [-1, 1]
    coframe = [["rho", 0], [0, 1]]
    domain = ["rho > 0"]
    edge = "rho"
    margin = "1/10"

    [[charts]]
    name = "inertial"
    coordinates = ["t", "x"]
    coframe = [[1, 0], [0, 1]]
    from_home = ["rho*sinh(s)", "rho*cosh(s)"]
    to_home = ["atanh(t/x)", "sqrt(x**2 - t**2)"]
    """
    found = solve(geodesic(space(wedge).frame, [0, 1], [1, 0]), 2.0)
    assert found.charts[-1] == "inertial"
    # At rest in the inertial coordinates, through the horizon t = x.
    t, x = found.in_chart("inertial").T
    assert t == pytest.approx(found.times, abs=1e-9)
    assert x == pytest.approx(1.0, abs=1e-9)


def test_laws_about_the_frame_stay_in_it(space):
    """Autoparallels of the Cartan connection depend on this frame, which other charts change."""
    plane = space(PLANE).frame
    assert autoparallel(cartan(plane), [1, 0], [1, 0]).charts == ("plane",)
    kept = PLANE + "keeps_frame = true\n"
    with pytest.raises(FileFormatError, match=r"own.toml: charts: .*frame"):
        space(kept)


def test_copies(space):
    """A frame with charts is pickled with them."""
    again = pickle.loads(pickle.dumps(space(SPHERE).frame))
    assert atlas_of(again).names == ("own", "north", "south")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"r*cos(phi)"', '"2*r*cos(phi)"', "map from chart 'plane' to chart 'cartesian'"),
        ("atan2(y, x)", "atan2(x, y)", "charts: the map from chart"),
        ("sqrt(x**2 + y**2)", "sqrt(x**2 + 2*y**2)", "charts: the map from chart"),
        ("[[1, 0], [0, 1]]", "[[1, 0], [0, 2]]", "charts: the map from chart"),
        ('["x", "y"]\ncof', '["r", "y"]\ncof', "is a name in the file already"),
        ('["x", "y"]\ncof', '["x", "__import__"]\ncof', "charts"),
        ('name = "cartesian"', 'name = "plane"', "that no other chart has"),
        ('name = "cartesian"', "", "expected a value for name"),
        ('name = "cartesian"', 'nam = "cartesian"', "Did you mean name"),
        ('to_home = ["sqrt(x**2 + y**2)", ', "to_home = [", "expected a list of 2 expressions"),
        ('angles = ["phi"]', 'angles = ["pho"]', "Did you mean phi"),
        ('edge = "r"', "", "Give also edge"),
        ("margin = 0.2", "margin = -1", "expected a positive number"),
        ("margin = 0.2", "margin = nan", "number"),
        ("margin = 0.2", 'margin = "r"', "expected a positive number"),
        ('edge = "r"', 'edge = "__import__(1)"', "edge"),
        ("[[charts]]", "[charts]", r"Write \[\[charts\]\]"),
    ],
)  # fmt: skip
def test_bad_charts(space, old, new, words):
    """Each bad chart is refused with its key in the file."""
    assert old in PLANE
    with pytest.raises((FileFormatError, ValueError), match=words) as caught:
        space(PLANE.replace(old, new))
    assert type(caught.value).__module__ == "geomtorsion.errors"
    assert "own.toml" in str(caught.value)
