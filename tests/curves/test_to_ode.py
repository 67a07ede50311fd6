"""Curves as first-order equations: forces in pieces and from tables, and walls."""

import math

import numpy as np
import pytest
import sympy as sp
from scipy.interpolate import CubicSpline

import geomtorsion as gt
from geomtorsion.errors import ArgumentError, ExpressionError, StuckError

PLANE = gt.Frame("x y", [[1, 0], [0, 1]], name="plane")


def test_a_free_line_is_the_same_motion():
    """Without forces the motion is a straight line."""
    free = gt.geodesic(PLANE, [1, 2], [3, -1])
    solution = gt.solve(free.to_ode(), 2.0)
    assert [solution["x"][-1], solution["y"][-1]] == pytest.approx([7, 0], abs=1e-12)


def test_a_curve_and_its_equations_agree():
    """An orbit in Schwarzschild's space, solved both ways."""
    orbit = gt.geodesic(
        "schwarzschild", [0, 10, math.pi / 2, 0], [1.2, 0, 0, 0.04], parameters={"M": 1}
    )
    curve, ode = gt.solve(orbit, 50.0), gt.solve(orbit.to_ode(), 50.0)
    for name in ("t", "r", "phi"):
        assert ode[name][-1] == pytest.approx(curve[name][-1], rel=1e-8)


def test_a_potential_in_pieces_conserves_energy():
    """A spring that acts for x > 0 only: half a period, then free flight."""
    spring = gt.geodesic(PLANE, [-1, 0], [1, 1], potential="pieces(x, 0, 0, x**2/2)").to_ode()
    solution = gt.solve(spring, 1 + math.pi + 2)
    assert solution["x"][-1] == pytest.approx(-2, rel=1e-9)
    assert solution["y"][-1] == pytest.approx(3 + math.pi, rel=1e-9)
    assert solution.drift["energy"] <= 1e-10


@pytest.mark.parametrize("potential", ["pieces(x - y, x, 0, x**2)", "pieces(x, x, 1, 2*x - 1)"])
def test_forces_of_a_potential_in_pieces_are_its_slopes(potential):
    """The acceleration on each side is minus the slope of that branch."""
    ode = gt.geodesic(PLANE, [2, 0], [0, 0], potential=potential).to_ode()
    texts = {"pieces(x - y, x, 0, x**2)": "-pieces(x - y, 1, 0, 2*x)",
             "pieces(x, x, 1, 2*x - 1)": "-pieces(x, 1, 1, 2)"}  # fmt: skip
    reference = gt.ODE.of({"x": "u1", "y": "0", "u1": texts[potential]}, [2, 0, 0])
    x = gt.solve(reference, 0.5)["x"][-1]
    assert gt.solve(ode, 0.5)["x"][-1] == pytest.approx(x, rel=1e-9)


def test_forces_and_potentials_from_tables():
    """A force over time and a potential over a coordinate agree with the polynomials of scipy."""
    times = np.linspace(0, 2, 9)
    table = gt.Table.of(np.column_stack([times, np.cos(times)]))
    pushed = gt.geodesic(PLANE, [0, 0], [0, 0], force=["F(t)", "0"]).to_ode(tables={"F": table})
    spline = CubicSpline(times, np.cos(times))
    assert gt.solve(pushed, 2.0)["u1"][-1] == pytest.approx(spline.integrate(0, 2), rel=1e-9)
    places = np.linspace(-2, 2, 17)
    hill = gt.Table.of(np.column_stack([places, places**2 / 2]))
    ball = gt.geodesic(PLANE, [1, 0], [0, 0], potential="V(x)").to_ode(tables={"V": hill})
    # A cubic spline goes through a parabola.
    assert gt.solve(ball, 2.0)["x"][-1] == pytest.approx(math.cos(2), rel=1e-9)


def test_a_light_ray_is_reflected_by_a_wall():
    """In polar coordinates a radial line turns at r = 2."""
    line = gt.geodesic("flat_polar", [1, 0], [1, 0])
    wall = [gt.When("2 - r", {"u1": "-u1"})]
    assert gt.solve(line.to_ode(events=wall), 1.5)["r"][-1] == pytest.approx(1.5, rel=1e-9)


def test_curves_without_a_start_and_pieces_in_a_solved_curve_are_refused():
    """The message names what to do."""
    with pytest.raises(ArgumentError, match="start"):
        gt.autoparallel(
            gt.cartan(gt.spaces.load("so3").frame), None, frame_velocity=[1, 0, 0]
        ).to_ode()
    pushed = gt.geodesic(PLANE, [0, 0], [0, 1], force=["pieces(x, 1, 1, 2)", "0"])
    calls = [lambda: gt.solve(pushed, 1.0), lambda: gt.solve_many(pushed, [[0, 0]], 1.0)]
    for call in calls:
        with pytest.raises(ExpressionError, match=r"gt\.solve\(curve\.to_ode\(\), t\)"):
            call()
    hill = gt.geodesic(PLANE, [0, 0], [0, 1], potential="V(x)")
    with pytest.raises(ExpressionError, match=r"to_ode\(tables=\{'V': table\}\)"):
        gt.solve(hill, 1.0)


X, Y = sp.symbols("x y", real=True)
SLOPED = gt.Table.of([(-3, 0), (0, 0), (5, 2)], "linear")
ROOT = math.sqrt(3)
# A ball from x = -1 with x' = 1 for a time of 3; the motion in each piece is a parabola or an arc.
POTENTIALS = [
    ("abs(x)", (4 - ROOT) * ROOT - (4 - ROOT) ** 2 / 2),
    (sp.Abs(X), (4 - ROOT) * ROOT - (4 - ROOT) ** 2 / 2),
    ("max(x, 0)", 0.0),
    ("x*Heaviside(x)", 0.0),
    (sp.Max(0, X), 0.0),
    (sp.Piecewise((0, X < 0), (X**2 / 2, True)), math.sin(2)),
    (SLOPED(X), 2 - 0.4 * 2),
    ("(x + abs(x))*2/5*1/2", 2 - 0.4 * 2),
    # It is y up to y = x, so that nothing acts along x before.
    ("max(y, -10)", 2.0),
]


@pytest.mark.parametrize(("potential", "end"), POTENTIALS, ids=str)
def test_kinks_of_a_potential_are_its_pieces(potential, end):
    """Text, expressions of sympy and values of a table give forces on both sides of a kink."""
    ball = gt.geodesic(PLANE, [-1, 0], [1, 1], potential=potential).to_ode()
    solution = gt.solve(ball, 3.0)
    assert solution["x"][-1] == pytest.approx(end, rel=1e-9, abs=1e-9)
    assert solution.drift["energy"] <= 1e-9


def test_pieces_within_pieces_have_the_slope_of_the_branch_that_holds():
    """The largest of x and the smaller of y and 1, on a line that passes all three."""
    hill = gt.geodesic(PLANE, [-1, 0], [0.5, 1], potential="max(x, min(y, 1))").to_ode()
    # y = t - t^2/2 <= 1/2 stays the largest up to x = y; the curve begins as free flight in x.
    solution = gt.solve(hill, 1.0)
    assert solution["y"][-1] == pytest.approx(0.5, rel=1e-9)
    assert solution["x"][-1] == pytest.approx(-0.5, rel=1e-9)


def test_friction_by_the_square_of_the_speed_slows_both_ways():
    """x'' = -k |x'| x' has x' = v/(1 + k |v| t), for either sign of v."""
    for v in (1, -1):
        law = ["-k*abs(u1)*u1", 0]
        slow = gt.geodesic(PLANE, [0, 0], [v, 0], force=law, parameters={"k": 2}).to_ode()
        assert gt.solve(slow, 3.0)["u1"][-1] == pytest.approx(v / 7, rel=1e-9)


def test_the_size_of_a_parameter_is_read_by_its_sign():
    """Nothing changes on the way, so that the curve itself is solved."""
    slow = gt.geodesic(PLANE, [0, 0], [1, 0], force=["-abs(k)*u1", 0], parameters={"k": 2})
    assert gt.solve(slow, 1.0)["u1"][-1] == pytest.approx(math.exp(-2), rel=1e-9)


@pytest.mark.parametrize("options", [{}, {"potential": "max(r, 1/2)"}])
@pytest.mark.parametrize("derivatives", [[], ["r"]])
def test_equations_end_where_the_chart_does(options, derivatives):
    """A radial line does not pass r = 0 of polar coordinates, with and without pieces."""
    line = gt.geodesic("flat_polar", [1, 0], [-1, 0], **options).to_ode()
    with pytest.raises(StuckError, match="r = 0"):
        gt.solve(line, 2.0, derivatives=derivatives)


def test_a_declared_domain_holds_for_pieces():
    """Slowed by 1/10 from x = 1 on, the ball reaches x = 2 where its domain ends."""
    half = gt.Frame("x y", [[1, 0], [0, 1]], domain=["x < 2"])
    slow = gt.geodesic(half, [0, 0], [1, 0], force=["-max(sign(x - 1), 0)/10", 0]).to_ode()
    with pytest.raises(StuckError, match=r"x = 2, .*x < 2 holds no longer") as caught:
        gt.solve(slow, 9.0)
    end = 1 + 10 * (1 - math.sqrt(1 - 0.2))
    assert caught.value.solution.trajectory.reached == pytest.approx(end, rel=1e-9)


def test_conditions_to_stop_hold_for_the_equations():
    """Free up to x = 1, then faster by 1 for each unit of time: x = 3/2 after 1/2 + sqrt(5) - 2."""
    push = gt.geodesic(PLANE, [0, 0], [2, 0], force=["Heaviside(x - 1)", 0], stop="3/2 - x")
    solution = gt.solve(push.to_ode(), 9.0)
    assert solution.stopped_by == "3/2 - x"
    assert solution.times[-1] == pytest.approx(0.5 + math.sqrt(5) - 2, rel=1e-9)
