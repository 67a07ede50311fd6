"""Loops, curves, costs and tops: the page compared with closed forms and the library."""

from __future__ import annotations

import json
import math
import re

import numpy as np
import pytest

from geomtorsion import Loop, burgers_vector, spaces
from geomtorsion.errors import GeomtorsionError
from geomtorsion.teaching.lab.closure_failure import closure_failure
from geomtorsion.teaching.lab.costs import costs
from geomtorsion.teaching.lab.paths import paths
from geomtorsion.teaching.lab.space_info import drawable, space_info
from geomtorsion.teaching.lab.top import WATCHED, top
from tests.chosen import one_in
from tests.rounding import ROUNDED

PI = math.pi


def test_a_loop_in_the_heisenberg_group():
    """b = (0, 0, -+ A): the torsion is constant, so 2 S A is exact at any size."""
    for radius in (1e-12, 1e-3, 0.5, 1.0):
        found = closure_failure("heisenberg", [0.3, -0.2, 0.1], radius, [0, 1])
        assert abs(found["b"][2]) == pytest.approx(PI * radius**2, rel=1e-12)
        assert np.allclose(found["b"], found["expected"], rtol=0, atol=1e-11 * PI * radius**2)


@pytest.mark.parametrize("radius", [1e-12, 1e-3, 0.3, 1.0])
def test_an_exact_estimate_misses_nothing(radius):
    """With constant torsion 2 S A equals b; rounding is not reported as a difference."""
    said = closure_failure("heisenberg", [0.3, -0.2, 0.1], radius, [0, 1])["sentence"]
    assert "2 S A agrees with b within its error" in said
    assert "differs" not in said
    assert "0e+00" not in said
    assert "differs" in closure_failure("so3", [0.3, 1.0, 0.2], 0.3, [0, 1])["sentence"]


def test_colours_have_one_meaning_on_a_page():
    """Animation and chart of the top share no colour, nor do figure and chart of two paths."""
    found = top([1, 1, 1.8], [1, 0, 2], 0.3, 5.0)
    film = re.search(r'id="data">(.*?)</script>', found["space"], re.DOTALL)
    assert film is not None
    data = json.loads(film[1])
    colours = {part["color"].lower() for part in (*data["curves"], *data["moving"])}
    lines = r"stroke: (#[0-9a-f]{6}); stroke-width: 1.6"
    chart = set(re.findall(lines, found["compared"]))
    assert len(chart) == 2
    assert not chart & colours
    both = paths("r3xso3", [0, 0.6, 2, 0.8, 0.2, 0.8], 5.0)
    assert not set(re.findall(lines, both["distance"])) & {"#0072b2", "#d55e00"}


def test_the_plane_has_a_sense():
    """A loop in the plane (n, m) has the opposite sense, so each number changes its sign."""
    one = closure_failure("so3", [0.3, 1.0, 0.2], 0.2, [0, 1])
    two = closure_failure("so3", [0.3, 1.0, 0.2], 0.2, [1, 0])
    assert np.allclose(one["expected"], -np.array(two["expected"]), rtol=ROUNDED, atol=0)
    assert one["expected"] != two["expected"]


def test_two_s_a_is_the_limit_of_small_loops():
    """The relative difference of b and 2 S A at the centre is of second order in the radius."""
    apart = []
    for radius in (0.2, 0.1):
        found = closure_failure("so3", [0.3, 1.0, 0.2], radius, [0, 1])
        gap = np.abs(np.array(found["b"]) - found["expected"]).max()
        apart.append(gap / np.abs(found["expected"]).max())
    assert apart[0] / apart[1] == pytest.approx(4, rel=0.05)


def test_the_table_shows_the_library():
    """The table shows the Burgers vector of the library."""
    found = closure_failure("so3", [0.3, 1.0, 0.2], 0.45, [0, 1])
    frame = spaces.load("so3").frame
    b = burgers_vector(frame, Loop.circle((0.3, 1.0, 0.2), 0.45, (0, 1)))
    shown = re.findall(r"<td>([^<]*)</td>", found["table"])[::4]
    assert np.allclose([float(x.replace("−", "-")) for x in shown], b.vector, atol=1e-6)


@pytest.mark.parametrize("name", one_in(6, list(drawable().values())))
def test_every_offered_space_has_a_loop_and_a_path(name):
    """The initial loop and path of each offered space are computed without an error."""
    known = space_info(name)
    for low, high, step in known["ranges"]:
        assert low <= high
        assert step > 0
    radius = 0.05 if name == "de_sitter" else 0.3
    found = closure_failure(name, known["start"], radius, known["planes"][0])
    assert len(found["pictures"]) == 2
    drawn = paths(name, known["velocity"], known["t"] / 4)
    assert "space" in drawn or "picture" in drawn


def test_curves_of_the_plane():
    """From r = 1 with u = (0, 1), the autoparallel is a circle and the geodesic a straight line."""
    found = paths("flat_polar", [0.0, 1.0], 1.0)
    circle, line = np.array([math.cos(1), math.sin(1)]), np.array([1.0, 1.0])
    # Distances use the metric half-way, not the straight line between the points.
    assert found["largest"] == pytest.approx(float(np.linalg.norm(circle - line)), rel=0.01)


@pytest.mark.parametrize(
    ("name", "component"),
    [("screw_dislocation", 2), ("edge_dislocation", 0), ("edge_dislocation_elastic", 0)],
)
def test_the_first_loop_goes_around_the_line(name, component):
    """The initial loop shows the whole Burgers vector of a dislocation, at each radius."""
    known = space_info(name)
    b = known["values"]["b"]
    for radius in (0.3, 1.0):
        found = closure_failure(name, known["loop_centre"], radius, known["planes"][0])
        expected = [b if k == component else 0.0 for k in range(3)]
        assert np.allclose(found["b"], expected, rtol=0, atol=1e-12)
        assert "all of b comes from the line inside the loop" in found["sentence"]


@pytest.mark.parametrize("name", ["wedge_disclination", "wedge_disclination_periodic"])
def test_the_first_loop_goes_around_the_axis_of_a_disclination(name):
    """Legs rotate by 2 pi alpha: the image of a circle is an arc, and b is its chord."""
    known = space_info(name)
    alpha = known["values"]["alpha"]
    found = closure_failure(name, known["loop_centre"], 0.3, known["planes"][0])
    assert len(found["pictures"]) == 2
    if name == "wedge_disclination":
        turn = 2 * math.pi * alpha
        # b is in the legs at the end of the loop, which are the rotated legs of its start.
        assert math.hypot(*found["b"]) == pytest.approx(2 * 0.3 * abs(math.sin(turn / 2)))
        angle = abs((turn + math.pi) % (2 * math.pi) - math.pi)
        assert f"turned by {angle:.6g} rad" in found["sentence"]
        assert "does not close" in found["pictures"][1]
    else:
        assert found["b"] == pytest.approx([0, 0, 0], abs=1e-12)
        assert "The legs come back unchanged" in found["sentence"]
    # Beside the axis a loop is a circle in the coordinates, and the frame is regular there.
    assert known["loop_ranges"][0][0] == 0
    beside = closure_failure(name, [1.0, 1.0, 0.0], 0.3, known["planes"][0])
    assert beside["error"] < 1e-10


@pytest.mark.parametrize(
    ("name", "centre", "condition"),
    [("flat_polar", [0.2, 1.0], "r > 0"), ("so3", [0.3, 0.1, 0.2], "phi2 > 0"),
     ("edge_dislocation", [0.3, 0.1, 0.2], "2*pi*(x**2 + y**2) > b*y")],
)  # fmt: skip
def test_a_loop_that_leaves_the_coordinates_is_reported(name, centre, condition):
    """The sentence reports a loop beyond the domain, because the coframe is not valid there."""
    outside = closure_failure(name, centre, 0.3, [0, 1])["sentence"]
    assert f"leaves these coordinates (the domain is {condition})" in outside
    inside = closure_failure(name, [1.0, 1.0, 1.0][: len(centre)], 0.3, [0, 1])["sentence"]
    assert "leaves" not in inside


def test_a_path_that_ends_is_named():
    """The sentence names the curve that ends and the time of its end."""
    said = paths("s2", [1.0, 1.0], 5.0)["sentence"]
    assert "The straightest curve: the motion stops at t = 1.24159" in said
    assert "The shortest curve:" not in said


def test_a_core_is_seen_from_its_middle():
    """b r^2 / (r^2 + c^2) around the axis of a smooth core."""
    known = space_info("screw_core")
    b, core = known["values"]["b"], known["values"]["c"]
    found = closure_failure("screw_core", known["loop_centre"], 0.3, known["planes"][0])
    assert found["b"][2] == pytest.approx(b * 0.09 / (0.09 + core**2), rel=1e-12)


def test_components_are_counted_from_one():
    """Rows of the table and axes of the figure are counted from 1, as in the paper."""
    found = closure_failure("so3", [0.3, 1.0, 0.2], 0.3, [0, 1])
    assert re.findall(r'scope="row">(b.)<', found["table"]) == ["b¹", "b²", "b³"]
    assert "X⁰" not in found["pictures"][1]


@pytest.mark.parametrize("watch", list(WATCHED))
def test_each_watched_quantity_has_a_chart(watch):
    """Each watched quantity has its own chart with its unit."""
    found = top([1, 2, 3], [0.1, 2, 0.1], 0.3, 3.0, ["gravity"], [watch])["compared"]
    unit = {"nutation": "rad", "energy": "J", "position": "m", "matrix": ""}.get(watch, "rad/s")
    [label] = re.findall(r'aria-label="([^"]*) over time', found)
    assert f">{label} in {unit}<" in found if unit else f">{label}<" in found


def test_equal_moments_make_one_curve_of_two():
    """On SO(3) autoparallel and geodesic agree for equal moments and separate for unequal ones."""
    velocity = [0.4, 0.3, 1.0]
    assert paths("so3", velocity, 5.0)["largest"] < 1e-9
    assert "curve coincide here" in paths("so3", velocity, 5.0, [2, 2, 2])["sentence"]
    assert paths("so3", velocity, 5.0, [1, 2, 3])["largest"] > 0.1


def test_the_document_of_a_picture_is_whole():
    """The figure contains its data as JSON and refers to no other file."""
    document = paths("s2", [-0.2, 1.0], 6.0)["space"]
    text = re.search(r'id="data">(.*?)</script>', document, re.DOTALL)
    assert text
    data = json.loads(text[1])
    points = np.array(data["curves"][0]["points"])
    assert np.allclose(np.linalg.norm(points, axis=1), 1, atol=1e-4)
    assert len(data["times"]) == len(points)
    # The name of the SVG language is not a link.
    bare = document.replace("http://www.w3.org/2000/svg", "")
    assert not re.search(r"(src|href)=|https?:|@import|url\(", bare)


def test_costs_are_measured():
    """Each row has an error and a time; the requested accuracy is reached."""
    case = {"space": "so3", "velocity": [0.4, 0.3, 1.0], "t": 2.0, "moments": [1, 2, 3]}
    found = costs("shortest", case)
    assert len(found["rows"]) >= 4
    assert all(error <= asked and seconds > 0 for _, asked, error, seconds in found["rows"])
    assert {row[0] for row in found["rows"]} <= set(
        re.findall(r">([^<]+)</text>", found["picture"])
    )


def test_costs_of_the_top():
    """The case of the top is measured on its own equations."""
    case = {"moments": [1, 2, 3], "omega": [0.1, 2, 0.1], "tilt": 0.3, "t": 3.0}
    found = costs("top", case | {"watch": ["omega"]})
    assert found["truth"] in {"quadruple precision", "the finest Runge-Kutta solution"}
    assert any(row[0] == "closed form" for row in found["rows"])
    assert all(error <= asked for _, asked, error, _ in found["rows"])


def test_a_symmetric_top_precesses():
    """Omega_1 and Omega_2 of a free symmetric body rotate with (I3 - I1) Omega_3 / I1."""
    found = top([1, 1, 1.8], [1, 0, 2], 0.3, 5.0)
    rate = 0.8 * 2 * 5.0
    assert np.allclose(found["omega"], [math.cos(rate), math.sin(rate), 2], atol=1e-7)
    assert found["naive"] == pytest.approx([1, 0, 2], abs=1e-9)


def test_the_naive_law_is_right_for_equal_moments():
    """Both laws agree if all moments are equal."""
    assert "Both laws agree here" in top([2, 2, 2], [0.5, 1, 2], 0.3, 5.0)["sentence"]


def test_the_plan_follows_the_switches():
    """For the nutation, gravity is omitted without a fixed point, and included with one."""

    def row(effects: list[str]) -> str:
        plan = top([1, 2, 3], [0.1, 2, 0.1], 0.3, 1.0, effects, ["nutation"])["plan"]
        [found] = [line for line in plan.split("<tr>") if ">gravity<" in line]
        return found

    assert "omitted" in row(["gravity"])
    assert "omitted" not in row(["gravity", "pivot"])
    alone = top([1, 2, 3], [0.1, 2, 0.1], 0.3, 1.0, [], ["omega"])["plan"]
    assert "body axes: 3<" in alone


def test_impossible_scenes_are_refused():
    """An impossible body and contradictory effects are refused."""
    with pytest.raises(GeomtorsionError, match="are impossible, because"):
        top([1, 1, 3], [0, 0, 1], 0.3, 1.0)
    with pytest.raises(GeomtorsionError, match="contradict"):
        top([1, 2, 3], [0, 0, 1], 0.3, 1.0, ["torsion", "pivot"])
