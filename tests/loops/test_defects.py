"""Defects: singular lines without torsion; closed forms, winding numbers and names."""

import numpy as np
import pytest
import sympy as sp

import geomtorsion.spaces as spaces
from geomtorsion.errors import (
    ChartEdgeError,
    LoopError,
    MissingValueError,
    ShapeError,
    SingularPointError,
)
from geomtorsion.geometry import Frame, cartan, levi_civita
from geomtorsion.loops import (
    Defect,
    Loop,
    burgers_map,
    burgers_vector,
    develop,
    dispiration,
    enclosed_defects,
    find_defects,
    parallel_dislocations,
    parallel_edges,
    parallel_screws,
)
from geomtorsion.loops.defects import charge
from tests.rounding import ROUNDED

LINES = [(0, 0), (1, 0), (0, "1/2")]
STEPS = [1, -2, sp.sqrt(2)]


@pytest.fixture(scope="module")
def screws() -> Frame:
    return parallel_screws([(x, sp.Rational(y)) for x, y in LINES], STEPS)


@pytest.mark.parametrize("space", ["screw_dislocation", "edge_dislocation"])
@pytest.mark.parametrize("radius", [1e-9, 1e-3, 1.0, 1e6])
@pytest.mark.parametrize("turns", [1, -2])
def test_one_line_gives_its_burgers_vector_at_every_radius(space, radius, turns):
    """b per winding, although torsion vanishes along the whole loop; the reason is stated."""
    frame = spaces.load(space).frame
    loop = Loop.circle([0, 0, 0.5], radius).times(turns)
    if space == "edge_dislocation" and radius < 0.25 / (2 * np.pi):
        # There the legs of the edge dislocation are linearly dependent, outside its domain.
        with pytest.raises(ChartEdgeError, match="Outside, the coframe is singular"):
            develop(cartan(frame), loop, parameters={"b": 0.25})
        return
    turn = develop(cartan(frame), loop, parameters={"b": 0.25})
    expected = np.zeros(3)
    expected[2 if space.startswith("screw") else 0] = 0.25 * turns
    assert np.abs(turn.burgers - expected).max() <= max(1e-13, ROUNDED * radius)
    assert turn.check.agrees is False
    assert "enclosed defect: singular line at x = 0, y = 0" in turn.check.text
    (inside,) = turn.enclosed
    assert inside.turns == turns
    assert inside.charge is not None
    assert np.abs(inside.charge.burgers * turns - expected).max() < max(1e-13, ROUNDED * radius)


def test_smooth_core_has_no_defect():
    """With a smooth core both routes agree, and no defect is reported."""
    frame = spaces.load("screw_core").frame
    turn = develop(cartan(frame), Loop.circle([0, 0, 0], 2), parameters={"b": 1, "c": 1})
    assert turn.check.agrees is True
    assert turn.enclosed == ()
    assert abs(turn.burgers[2] - 4 / 5) < ROUNDED


def test_parallel_lines_add_up_by_their_windings(screws):
    """Each loop has the sum of winding numbers times b_k, and the windings are found."""
    assert [defect.place() for defect in find_defects(screws)] == [
        (0, 0, 0),
        (1, 0, 0),
        (0, 0.5, 0),
    ]
    shapes = {
        (1, 0, 0): Loop.circle([0, 0, 0], 0.3),
        (1, 1, 1): Loop.ellipse([0.4, 0.2, 1], (3, 2)),
        (0, -1, 0): Loop.circle([1, 0.1, 0], 0.4).reversed(),
        (1, 0, 1): Loop.polygon([[-1, -1, 0], [0.5, -1, 2], [0.5, 1, 1], [-1, 1, 0]]),
        (0, 0, 0): Loop.polygon([[2, 2, 0], [3, 2, 0], [2, 3, 0]]),
        (1, -1, 0): Loop.parametric(
            ["1/2 - 9/10*cos(s)", "-sin(2*s)/4 - 1/50", "0"], "s", (0, "2*pi")
        ),
    }
    for windings, loop in shapes.items():
        turn = develop(cartan(screws), loop)
        expected = sum(w * float(b) for w, b in zip(windings, STEPS, strict=True))
        found = {one.defect.place()[:2]: one.turns for one in enclosed_defects(screws, loop)}
        places = [(0, 0), (1, 0), (0, 0.5)]
        assert np.abs(turn.burgers - [0, 0, expected]).max() < 2e-13, loop.name
        assert found == {p: w for p, w in zip(places, windings, strict=True) if w}, loop.name


def test_edges_and_mixed_lines():
    """Burgers vectors in the plane and in any direction."""
    edges = parallel_edges([(0, 0), (2, 0)], [(1, 0), (0, 3)])
    b = develop(cartan(edges), Loop.circle([1, 0, 0], 4)).burgers
    assert np.abs(b - [1, 3, 0]).max() < 1e-13
    mixed = parallel_dislocations([(0, 0)], [("1/2", "-1/3", "1/7")])
    b = develop(cartan(mixed), Loop.circle([0, 0, 0], 1)).burgers
    assert np.abs(b - [1 / 2, -1 / 3, 1 / 7]).max() < ROUNDED
    assert mixed.anholonomy.is_zero


@pytest.mark.parametrize("alpha", [0.9, 0.75, 0.55, 1.25])
def test_cone_turns_by_its_wedge(alpha):
    """Wedge disclination: Frank 2 pi (1 - alpha), closure 2 R sin(pi (1 - alpha))."""
    cone = levi_civita(dispiration(alpha, 0))
    assert cone.is_flat
    for radius in (1e-6, 0.5, 30.0):
        turn = develop(cone, Loop.circle([0, 0, 0], radius))
        wedge = 2 * np.pi * (1 - alpha)
        assert np.abs(turn.motion.frank_vector - [0, 0, wedge]).max() < 1e-13
        chord = abs(2 * radius * np.sin(np.pi * (1 - alpha)))
        assert abs(np.hypot(*turn.burgers[:2]) - chord) < 1e-13 * radius
        centre = turn.motion.centre
        assert centre is not None
        # Seen in the frame at the base point, the tip is at distance radius.
        assert abs(np.hypot(*centre[:2]) - radius) < 1e-13 * radius / (1 - np.cos(wedge)) ** 0.5
    with pytest.raises(LoopError, match="half a turn"):
        _ = develop(levi_civita(dispiration("1/2", 0)), Loop.circle([0, 0, 0], 1)).frank


def test_dispiration_has_a_screw_motion_that_no_shape_changes():
    """Angle and translation along the axis are the same for all loops around the line."""
    left, step = sp.Rational(5, 6), sp.Rational(3, 10)
    crystal = levi_civita(dispiration(left, step))
    assert crystal.is_flat
    loops = [
        Loop.circle([0, 0, 0], 1),
        Loop.ellipse([0.3, -0.2, 4], (3, 1)),
        Loop.polygon([[1, -1, 0], [2, 3, 1], [-1, 1, -2], [-1, -0.1, 0]]),
    ]
    for loop in loops:
        turn = develop(crystal, loop)
        assert abs(turn.angle - np.pi / 3) < 1e-12
        assert abs(turn.along_axis - 0.3) < 1e-12
        assert [one.turns for one in turn.enclosed] == [1]
    outside = develop(crystal, Loop.circle([5, 0, 0], 1))
    assert np.abs(outside.motion.increment).max() < 1e-13
    assert outside.enclosed == ()


def test_loop_through_a_line_is_an_error_that_names_the_place(screws):
    """A loop through a line is refused, and the error names the point."""
    for loop in (
        Loop.circle([0.5, 0, 3], 0.5),
        Loop.polygon([[-1, 0, 0], [3, 0, 0], [1, 4, 0]]),
    ):
        with pytest.raises(SingularPointError, match=r"passes through \((0|1|-0), "):
            develop(cartan(screws), loop)
        with pytest.raises(SingularPointError, match="passes through"):
            enclosed_defects(screws, loop)


def test_declared_defects_take_the_place_of_found_ones():
    """A line without a denominator can be declared, and encircled in any direction."""
    x, y, z = sp.symbols("x y z", real=True)
    flat = Frame([x, y, z], [[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    assert find_defects(flat) == ()
    axis = Defect((1, 0, 0), ((0, 1, 0), (0, 0, 1)), "line along x")
    loop = Loop.circle([0, 0, 0], 1, (1, 2)).times(2)
    (inside,) = enclosed_defects(flat, loop, defects=[axis])
    assert inside.turns == 2
    assert "line along x" in str(inside)
    moved = Defect((sp.Symbol("a"), 0, 0), (0, 1))
    assert moved.winding(Loop.circle([3, 0, 0], 1), {"a": 2.5}) == 1
    with pytest.raises(MissingValueError, match="depends on a"):
        moved.winding(Loop.circle([3, 0, 0], 1))
    with pytest.raises(LoopError, match="closed surface"):
        Defect((0, 0, 0), None, "point").winding(Loop.circle([0, 0, 0], 1))


def test_point_defect_is_found_but_not_enclosed():
    """1 / (x^2 + y^2 + z^2) has a point defect, which no loop encloses."""
    x, y, z = sp.symbols("x y z", real=True)
    square = x**2 + (y - 1) ** 2 + z**2
    frame = Frame([x, y, z], [[1, z / square, 0], [0, 1, 0], [0, 0, 1]])
    (point,) = find_defects(frame)
    assert point.place() == (0, 1, 0)
    assert str(point) == "singular point at x = 0, y = 1, z = 0"
    assert point.across is None
    assert enclosed_defects(frame, Loop.circle([0, 1, 0], 1)) == ()


def test_burgers_vector_and_development_agree_around_lines(screws):
    """The plain loop integral gives the same vector as the development."""
    loop = Loop.ellipse([0.4, 0.2, 1], (3, 2))
    b = burgers_vector(screws, loop)
    assert np.abs(b.vector - develop(cartan(screws), loop).burgers).max() < 1e-13


def test_bad_lines_are_refused():
    """Refused: unequal numbers of positions and vectors, two lines at one position."""
    with pytest.raises(ShapeError, match="1 positions and 2 vectors"):
        parallel_screws([(0, 0)], [1, 2])
    with pytest.raises(ShapeError, match="same position"):
        parallel_screws([(0, 0), (0, 0)], [1, 2])
    with pytest.raises(ShapeError, match=r"positions\[0\]"):
        parallel_screws([(0, 0, 0)], [1])


def test_declared_lines_are_looked_for_even_where_both_routes_agree():
    """A declared line in a smooth frame: turns are counted, and a loop through it is refused."""
    core = cartan(spaces.load("screw_core").frame)
    values, axis = {"b": 1, "c": 1}, Defect((0, 0, 0), (0, 1), "core")
    turn = develop(core, Loop.circle([0, 0, 0], 2), parameters=values, defects=[axis])
    assert turn.check.agrees is True
    assert "winds around core" in turn.check.text
    assert [one.turns for one in turn.enclosed] == [1]
    with pytest.raises(SingularPointError, match="passes through the core at q0 = 0, q1 = 0, at"):
        develop(core, Loop.circle([2, 0, 0], 2), parameters=values, defects=[axis])


def test_a_burgers_vector_names_the_defect_inside() -> None:
    """b of a loop around a screw names the defect; a loop beside it encloses nothing."""
    frame = spaces.load("screw_dislocation").frame
    round_it = burgers_vector(frame, Loop.circle([0.2, 0, 0], 1), parameters={"b": 1})
    (inside,) = round_it.enclosed
    assert inside.turns == 1
    assert "enclosed defect: singular line at x = 0, y = 0" in repr(round_it)
    assert "x = 0, y = 0" in round_it.to_json()["check"]["enclosed"][0]
    beside = burgers_vector(frame, Loop.circle([3, 0, 0], 1), parameters={"b": 1})
    assert beside.enclosed == ()


def test_a_near_miss_still_has_a_winding_number() -> None:
    """A circle at 1e-9 of its radius from an axis has winding number 1 or 0."""
    assert Loop.circle([1 - 1e-9, 0, 0], 1).winding([0, 0, 0]) == 1
    assert Loop.circle([1 + 1e-9, 0, 0], 1).winding([0, 0, 0]) == 0
    with pytest.raises(LoopError, match="passes through the axis"):
        Loop.circle([1, 0, 0], 1).winding([0, 0, 0])


@pytest.mark.parametrize(("size", "gap"), [(1, 3), (12, 1)])
def test_a_charge_is_measured_on_a_quarter_of_the_free_distance(size, gap):
    """The charge is measured on a circle of a quarter of the free distance. Smooth torsion adds as
    much as on this circle, and rounding nearly nothing, although the denominator cancels."""
    x, y, z = sp.symbols("x y z", real=True)
    u, twist = x - sp.Rational("10.1"), sp.Rational("0.1")
    lines = [b / (2 * sp.pi * ((u - at) ** 2 + y**2)) for at, b in ((0, 1), (gap, 5))]
    along = [u - at for at in (0, gap)]
    entries = (
        -y * (lines[0] + lines[1] + twist / 2),
        along[0] * (lines[0] + twist / 2) + along[1] * lines[1],
        1,
    )
    frame = Frame([x, y, z], [[1, 0, 0], [0, 1, 0], entries])
    one = next(line for line in find_defects(frame) if line.point[0] == sp.Rational("10.1"))
    found = charge(cartan(frame), one, Loop.circle([10.1, 0, 0], size)).burgers[2]
    free = min(size, gap)
    assert found - 1 == pytest.approx(0.1 * np.pi * (free / 4) ** 2, rel=1e-5)


@pytest.mark.parametrize("radius", [1, 1e14, 1e155])
@pytest.mark.parametrize("name", ["screw_dislocation", "edge_dislocation"])
def test_a_charge_below_the_rounding_of_its_loop_is_within_the_error(name, radius):
    """The flux of a singular line is zero: it agrees with a line integral whose error is larger."""
    frame = spaces.load(name).frame.subs({"b": sp.Rational(1, 10**16) if radius == 1 else 1})
    charge = 1e-16 if radius == 1 else 1
    row = 2 if name == "screw_dislocation" else 0
    b = burgers_vector(frame, Loop.circle([0, 0, 0], radius, plane=(0, 1)))
    assert abs(b.vector[row] - charge) <= b.error
    assert [one.turns for one in b.enclosed] == [1]
    assert burgers_vector(frame, Loop.circle([9 * radius, 0, 0], radius, plane=(0, 1))).error == 0


def test_maps_and_developments_keep_a_charge_below_rounding():
    frame = spaces.load("screw_dislocation").frame.subs({"b": sp.Rational(1, 10**16)})
    table = burgers_map(frame, ([-3, -1, 1, 3], [-3, -1, 1, 3]))
    assert table.enclosed.sum() == table.enclosed[1, 1] == 1
    assert abs(table.vectors[2, 1, 1] - 1e-16) <= table.errors[1, 1]
    moved = develop(cartan(frame), Loop.circle([0, 0, 0], 1, plane=(0, 1)))
    assert abs(moved.burgers[2] - 1e-16) <= moved.error
    assert [one.turns for one in moved.enclosed] == [1]
