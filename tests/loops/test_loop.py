"""Loops: construction, operations and refusals."""

from collections.abc import Callable
from typing import Any, cast

import networkx as nx
import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from geomtorsion.errors import ArgumentError, ExpressionError, LoopError, MissingValueError
from geomtorsion.loops import Loop
from tests.rounding import ROUNDED

SAME = ROUNDED  # areas and lengths are sums of a few dozen rounded terms

TRIANGLE = [[0, 0], [1, 0], [0, 1]]
numbers = st.floats(-3, 3, allow_nan=False)


def eight() -> Loop:
    """A figure of eight: it crosses itself, and its two halves have opposite areas."""
    return Loop.parametric(["sin(s)", "sin(2*s)"], interval=(0, "2*pi"))


def test_areas_of_simple_shapes() -> None:
    """Circle, ellipse, polygon, plaquette, spline and curve have the areas of textbooks."""
    assert Loop.circle([1, 2], 3).area[0, 1] == pytest.approx(9 * np.pi, rel=SAME)
    assert Loop.ellipse([1, 2], (3, 2)).area[0, 1] == pytest.approx(6 * np.pi, rel=SAME)
    assert Loop.polygon(TRIANGLE).area[0, 1] == pytest.approx(0.5, rel=SAME)
    assert Loop.plaquette([1, 1], (2, 3)).area[0, 1] == pytest.approx(6, rel=SAME)
    assert eight().area[0, 1] == pytest.approx(0, abs=SAME)
    lemon = Loop.parametric(["cos(t)", "sin(t)**3"], "t", (0, 2 * sp.pi))
    assert lemon.area[0, 1] == pytest.approx(3 * np.pi / 4, rel=SAME)


@pytest.mark.parametrize(
    "loop",
    [
        Loop.ellipse([1, 2], (3, 2)),
        Loop.spline([[0, 0], [2, 0], [1, 1], [0, 3]]),
        eight(),
    ],
    ids=["ellipse", "spline", "curve"],
)
def test_slopes_are_derivatives_of_the_exact_curve(loop: Loop) -> None:
    """Offsets, up to the centre, and slopes agree with the exact expression of each arc."""
    s, places = sp.Symbol("s"), [0.0, 0.3, 0.9]
    for part in loop.parts:
        for arc in part.arcs:
            exact = arc.exact(s)
            offsets, slopes = arc.shape(np.array(places))
            points, rates = (
                np.array([[float(x.subs(s, place)) for place in places] for x in wanted])
                for wanted in (exact, [x.diff(s) for x in exact])
            )
            assert slopes == pytest.approx(rates, rel=1e-12, abs=1e-12)
            steps = np.diff(offsets, axis=1)
            assert steps == pytest.approx(np.diff(points, axis=1), rel=1e-12, abs=1e-12)


@given(st.lists(st.tuples(numbers, numbers), min_size=3, max_size=9, unique=True))
def test_area_of_polygons_is_the_shoelace_formula(points: list[tuple[float, float]]) -> None:
    """Holds for any polygon, also if it crosses itself."""
    x, y = np.array(points).T
    steps = np.abs(np.diff(np.array([*points, points[0]]), axis=0)).max(axis=1)
    if steps.min() < 1e-9:
        return
    shoelace = (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2
    area = Loop.polygon(points).area
    assert area[0, 1] == pytest.approx(shoelace, abs=1e-13)
    assert area[1, 0] == -area[0, 1]


def test_centre_and_offsets_stay_apart() -> None:
    """A loop of size 1e-150 about a point of order one keeps all digits of its shape."""
    tiny = Loop.polygon(TRIANGLE, centre=[7, 7], size=1e-150)
    assert tiny.area[0, 1] == pytest.approx(5e-301, rel=SAME)
    assert Loop.circle([7, 7], 1e-300).size == 1e-300


def test_circle_in_a_spanned_plane() -> None:
    """Two vectors span the plane of a circle and are made orthonormal."""
    area = Loop.circle([0, 0, 0], 2, ([1, 1, 0], [0, 3, 3])).area
    normal = np.array([area[1, 2], area[2, 0], area[0, 1]]) / (4 * np.pi)
    assert normal == pytest.approx(np.array([1, -1, 1]) / np.sqrt(3), rel=SAME)


def test_length() -> None:
    """Length in coordinates, without a metric."""
    assert Loop.circle([0, 0], 2).times(-3).length == pytest.approx(12 * np.pi, rel=1e-10)
    assert Loop.polygon(TRIANGLE).length == pytest.approx(2 + np.sqrt(2), rel=1e-10)


def test_composition_reversal_and_multiples() -> None:
    """Areas add, change sign and multiply; a reversed loop has its sides in reverse order."""
    circle = Loop.circle([0, 0], 1)
    square = Loop.polygon([[1, 0], [1, 1], [2, 1]])
    both = circle.then(square)
    assert both.area == pytest.approx(circle.area + square.area, rel=SAME)
    assert both.reversed().area == pytest.approx(-both.area, rel=SAME)
    assert both.times(3).area == pytest.approx(3 * both.area, rel=SAME)
    assert both.times(-2).area == pytest.approx(-2 * both.area, rel=SAME)
    walk = [(side, backwards) for _, side, backwards in both.reversed().arcs()]
    assert [backwards for _, backwards in walk] == [True] * 4
    assert walk[-1][0] is circle.parts[0].arcs[0]
    assert both.points(100)[:, 0] == pytest.approx(both.points(100)[:, -1], abs=SAME)


def test_loops_from_different_points_do_not_follow_each_other() -> None:
    """The error names the gap between the two base points."""
    with pytest.raises(LoopError, match=r"the gap is \(-1, 0\)"):
        Loop.circle([0, 0], 1).then(Loop.circle([0, 0], 2))
    tiny = Loop.circle([7, 7], 1e-12)
    assert tiny.then(tiny).area[0, 1] == pytest.approx(2e-24 * np.pi)
    with pytest.raises(LoopError, match="the gap is"):
        tiny.then(Loop.circle([7, 7], 2e-12))


def test_winding() -> None:
    """Turns are counted with their sign, about any axis and for all kinds of loops."""
    circle = Loop.circle([0, 0, 5], 1)
    assert circle.winding([0.99, 0, 0]) == 1
    assert circle.winding([1.01, 0, 0]) == 0
    assert circle.times(-4).winding([0, 0, 0]) == -4
    assert circle.winding([0, 0, 0], plane=(1, 0)) == -1
    assert eight().winding([0.5, 0.1]) * eight().winding([-0.5, 0.1]) == -1
    assert Loop.polygon([[1, 1], [-1, 1], [-1, -1], [1, -1]]).winding([0.2, 0.3]) == 1
    assert Loop.spline([[1, 0], [0, 1], [-1, 0], [0, -1]]).winding([0, 0]) == 1
    wiggly = Loop.parametric(
        ["(1 + cos(1000*s)/10)*cos(3*s)", "(1 + cos(1000*s)/10)*sin(3*s)"], interval=(0, "2*pi")
    )
    assert wiggly.winding([0, 0]) == 3
    tilted = Loop.circle([0, 0, 0], 1, ([1, 0, 1], [0, 1, 0]))
    assert tilted.winding([0, 0, 0], plane=([1, 0, 0], [0, 1, 0])) == 1


@pytest.mark.parametrize(
    "loop", [Loop.circle([0, 0], 1), Loop.polygon([[-1, 0], [1, 0], [1, 1], [-1, 1]])]
)
def test_a_loop_through_the_axis_has_no_winding(loop: Loop) -> None:
    """The error names the point at which the loop meets the axis."""
    axis = [0.0, 1.0]
    with pytest.raises(LoopError, match=r"passes through the axis, at"):
        loop.winding(axis)


def test_cycle_of_a_graph() -> None:
    """A cycle becomes a polygon; a missing edge, node or position is named."""
    graph = nx.cycle_graph(4)
    corners = {0: (0, 0), 1: (2, 0), 2: (2, 1), 3: (0, 1)}
    nx.set_node_attributes(graph, corners, "position")
    assert Loop.from_cycle(graph, [0, 1, 2, 3, 0]).area[0, 1] == pytest.approx(2)
    with pytest.raises(LoopError, match="no edge between 0 and 2"):
        Loop.from_cycle(graph, [0, 2, 3])
    with pytest.raises(LoopError, match="node 9 is not in the graph"):
        Loop.from_cycle(graph, [0, 1, 9])
    with pytest.raises(LoopError, match="node 0 has no 'place'"):
        Loop.from_cycle(graph, [0, 1, 2, 3], position="place")


def test_waves_are_found() -> None:
    """The highest frequency of a curve is found, also if samples could miss it."""
    for frequency in (3, 251, 1000, 1009):
        loop = Loop.parametric([f"cos(s) + cos({frequency}*s)/100", "sin(s)"], interval=(0, "2*pi"))
        assert loop.parts[0].arcs[0].waves == frequency


def test_a_curve_that_is_smooth_only_between_its_ends() -> None:
    """A curve that is not smooth where it closes is not treated as periodic."""
    drop = Loop.parametric(["s*(1 - s)", "s*(1 - s)*(1 - 2*s)"])
    assert not drop.parts[0].arcs[0].is_periodic
    assert drop.area[0, 1] == pytest.approx(-1 / 30, rel=1e-12)


def test_symbols_in_a_loop() -> None:
    """A radius may be a symbol whose value is given later."""
    radius = sp.Symbol("R", positive=True)
    loop = Loop.circle([1, 0], radius)
    assert loop.symbols == {radius}
    assert loop.at({"R": 2}).area[0, 1] == pytest.approx(4 * np.pi)
    assert loop.at({"R": 2}).centre == (1.0, 0.0)
    with pytest.raises(MissingValueError, match="loop: expected a value for R, got none"):
        loop.at({})


NAN = float("nan")
BAD = [
    (lambda: Loop.circle([0, 0], 0), "expected a positive length, got 0"),
    (lambda: Loop.circle([0, 0], -1), "positive length"),
    (lambda: Loop.circle([0, NAN], 1), r"centre\[1\]: expected a finite number"),
    (lambda: Loop.circle([0, 0], float("inf")), "radius: expected a finite number"),
    (lambda: Loop.circle([0, 0], "1"), "radius: expected a number, got '1'"),
    (lambda: Loop.circle([0], 1), "expected two coordinates or more, got"),
    (lambda: Loop.circle("xy", 1), "expected two coordinates or more, got 'xy'"),
    (lambda: Loop.circle([0, 0], 1, (0, 2)), "from 0 to 1, or vectors, got 2"),
    (lambda: Loop.circle([0, 0], 1, (0, 0)), "span no plane"),
    (lambda: Loop.circle([0, 0], 1, ([1, 2], [2, 4])), "span no plane"),
    (lambda: Loop.circle([0, 0], 1, cast(Any, "xy")), "two coordinates such as"),
    (lambda: Loop.circle([0, 0], 1, cast(Any, (0.5, 1))), "numbers from 0 to 1, .*, got 0.5"),
    (lambda: Loop.plaquette([0, 0], (sp.Symbol("R"), 1)), "contains symbols"),
    (lambda: Loop.ellipse([0, 0], cast(Any, 2)), "two semi-axes"),
    (lambda: Loop.polygon([]), "expected at least three points, got 0"),
    (lambda: Loop.polygon([[0, 0], [1, 1]]), "got 2"),
    (lambda: Loop.polygon([[0, 0], [1, 1], [0, 0]]), "vertex 2 and vertex 0 coincide"),
    (lambda: Loop.polygon([[0, 0], [1, 1], [1, 1], [0, 1]]), "vertex 1 and vertex 2 coincide"),
    (lambda: Loop.polygon([[0, 0], [1, 1], [NAN, 1]]), r"vertices\[2\]\[0\]: expected a finite"),
    (lambda: Loop.polygon([[0, 0], [1, 1], [1, 1, 1]]), r"vertices\[2\]: expected 2 coordinates"),
    (lambda: Loop.polygon(TRIANGLE, size=2), "give the centre as well"),
    (lambda: Loop.polygon([[0, 0]] * 4), "coincide"),
    (lambda: Loop.plaquette([0, 0], (0, 1)), "expected two steps that are not zero"),
    (lambda: Loop.plaquette([0, 0], cast(Any, 1)), "two steps"),
    (lambda: Loop.spline([[0, 0], [1, 0]]), "got 2"),
    (lambda: Loop.spline([[0, 0], [1, 0], [1, 0], [0, 1]]), "point 1 and point 2 coincide"),
    (lambda: Loop.parametric(["s", "s**2"]), r"does not close.*the gap is \(1, 1\)"),
    (lambda: Loop.parametric(["1", "2"]), "has no length"),
    (lambda: Loop.parametric(["cos(s)"]), "two expressions or more"),
    (lambda: Loop.parametric(["cos(s)", "sin(s)"], interval=(1, 1)), "no length"),
    (lambda: Loop.parametric(["cos(s)", "sin(s)"], interval=cast(Any, 3)), "two bounds"),
    (lambda: Loop.parametric(["1/(s - 1/2)**2", "s*(1-s)"], interval=(0, 1)), "not finite"),
    (lambda: Loop.parametric(["cos(s)", "sin(s)"], "s s"), "a name or a symbol"),
    (lambda: Loop.circle([0, 0], 1).times(0), "other than 0"),
    (lambda: Loop.circle([0, 0], 1).times(cast(Any, 0.5)), "whole number of turns"),
    (lambda: Loop.circle([0, 0], 1).then(Loop.circle([0, 0, 0], 1)), "in the same space"),
]


@pytest.mark.parametrize(("make", "message"), BAD)
def test_bad_loops_are_refused(make: Callable[[], Loop], message: str) -> None:
    """Each bad loop is refused with its own message."""
    with pytest.raises(LoopError, match=message):
        make()


@pytest.mark.parametrize(
    ("expression", "message"),
    [
        ("q*s", "q is neither"),
        ("__import__('os')", "import"),
        ("I*s", "not real"),
    ],
)
def test_bad_expressions_are_refused(expression: object, message: str) -> None:
    """Expressions pass the whitelist, and must be smooth and real."""
    with pytest.raises(ExpressionError, match=message):
        Loop.parametric([expression, "s*(1 - s)"])


def test_turns_are_whole_numbers_of_any_kind() -> None:
    """Whole numbers of NumPy count as turns; `then` takes only a loop."""
    loop = Loop.circle([0, 0], 1)
    assert loop.times(cast("int", np.int64(-2))).winding([0, 0]) == -2
    with pytest.raises(LoopError, match="a whole number of turns"):
        loop.times(cast("int", np.float64(2)))
    with pytest.raises(ArgumentError, match="other: expected a Loop"):
        loop.then(cast("Loop", "circle"))
