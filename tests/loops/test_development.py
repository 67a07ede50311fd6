"""Development: closed forms, small loops, base points, composition and error bounds."""

import mpmath
import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

import geomtorsion.spaces as spaces
from geomtorsion.errors import ArgumentError, LoopError, MissingValueError, UnknownNameError
from geomtorsion.geometry import (
    Connection,
    Frame,
    blend,
    cartan,
    from_coefficients,
    levi_civita,
)
from geomtorsion.loops import Loop, burgers_vector, develop, develop_path
from geomtorsion.loops.affine_form import AffineForm
from geomtorsion.loops.paths import developed_path
from geomtorsion.loops.transport import product
from tests.loops.digits import sphere_closure
from tests.rounding import ROUNDED

theta, phi = sp.symbols("theta phi", real=True)
x, y, z = sp.symbols("x y z", real=True)


@pytest.fixture(scope="module")
def sphere() -> Connection:
    return levi_civita(Frame([theta, phi], [[1, 0], [0, sp.sin(theta)]]))


@pytest.fixture(scope="module")
def general() -> Connection:
    """Torsion, curvature and nonmetricity together, in three dimensions."""
    frame = Frame([x, y, z], [[1 + y**2, 0, x], [z, 2, 0], [0, sp.sin(x), 1]])
    gamma = [[[sp.Integer(0)] * 3 for _ in range(3)] for _ in range(3)]
    gamma[0][1][2], gamma[1][0][0], gamma[2][2][1] = x * y, sp.cos(z), y
    gamma[1][2][1], gamma[0][0][1], gamma[2][1][0] = z**2, 1 + x, x - y
    return from_coefficients(frame, gamma)


@pytest.fixture(scope="module")
def so3_half() -> Connection:
    """A blend of the two connections of SO(3), with torsion and curvature."""
    frame = spaces.load("so3").frame
    return blend(levi_civita(frame), cartan(frame), sp.Rational(1, 3))


@pytest.mark.parametrize("plane", [(0, 1), (1, 2), (2, 0)])
@pytest.mark.parametrize("radius", [0.5, 1e-2, 1e-7])
def test_cartan_development_is_the_burgers_vector(plane, radius):
    """With parallel legs nothing turns, and the translation is the plain loop integral."""
    frame = spaces.load("so3").frame
    loop = Loop.circle([0.3, 1.0, 0.2], radius, plane)
    turn, b = develop(cartan(frame), loop), burgers_vector(frame, loop)
    scale = np.abs(b.vector).max()
    assert not turn.motion.turn.any()
    assert np.abs(turn.burgers - b.vector).max() <= ROUNDED * scale + 1e-17 * radius**2
    assert turn.check.agrees


@pytest.mark.parametrize("radius", ["0.4", "1e-2", "1e-4", "1e-8", "1e-12", "1e-60"])
def test_sphere_turns_by_the_area_at_every_radius(sphere, radius):
    """Levi-Civita on the sphere: angle = area, with full relative accuracy at any size."""
    with mpmath.workdps(120):
        r = mpmath.mpf(float(radius))
        centre = mpmath.mpf(1)
        area = mpmath.quad(
            lambda t: -mpmath.cos(centre + r * mpmath.cos(t)) * r * mpmath.cos(t),
            mpmath.linspace(0, 2 * mpmath.pi, 9),
        )
        turn = develop(sphere, Loop.circle([1.0, 0.3], float(radius)))
        missed = abs(mpmath.mpf(turn.angle) / area - 1)
    assert missed < ROUNDED
    assert turn.turn_error >= abs(turn.angle) * float(missed) * 0.5 or missed < ROUNDED


@pytest.mark.parametrize("radius", [1e-1, 1e-3, 1e-6])
def test_closure_on_the_sphere_against_fifty_digits(sphere, radius):
    """The translation, of third order in the radius, agrees with a 50-digit computation."""
    reference = sphere_closure(radius)
    turn = develop(sphere, Loop.circle([1.0, 0.3], radius))
    size = max(abs(value) for value in reference)
    missed = max(
        abs(mpmath.mpf(float(b)) - r) for b, r in zip(turn.burgers, reference, strict=True)
    )
    assert missed <= 1e-12 * size
    assert missed <= turn.error


def test_closure_on_the_sphere_is_of_third_order(sphere):
    """Without torsion b is of third order: the slope of log |b| over log r is 3."""
    radii = np.array([1e-2, 1e-3, 1e-4, 1e-5])
    sizes = [np.abs(develop(sphere, Loop.circle([1.0, 0.3], r)).burgers).max() for r in radii]
    slopes = np.diff(np.log(sizes)) / np.diff(np.log(radii))
    assert np.abs(slopes - 3).max() < 1e-3


@pytest.mark.parametrize("name", ["general", "so3_half"])
def test_small_loops_expand_in_torsion_and_curvature(name, request):
    """Order 2 is curvature and torsion, order 3 their derivatives; the remainder has order 4."""
    connection = request.getfixturevalue(name)
    form = AffineForm(connection)
    corner = np.array([0.3, 0.9, 0.2])
    one, two = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])

    def field(place):
        rho, tau = form.over(place[:, None], one[:, None], two[:, None])
        return _affine(rho[0], tau[0])

    def potential(direction):
        omega, theta_ = form.along(corner[:, None], direction[:, None])
        return _affine(omega[0], theta_[0])

    second = field(corner)
    third = np.zeros_like(second)
    for direction in (one, two):
        slope = sum(
            weight * field(corner + k * 1e-3 * direction) / 1e-3
            for k, weight in ((1, 2 / 3), (-1, -2 / 3), (2, -1 / 12), (-2, 1 / 12))
        )
        a = potential(direction)
        third += (slope + a @ second - second @ a) / 2
    left = {}
    for h in (2e-2, 1e-2, 5e-3):
        found = develop(connection, Loop.plaquette(corner.tolist(), (h, h))).motion.increment
        left[h] = np.abs(found - h**2 * second - h**3 * third).max()
        assert np.abs(found - h**2 * second).max() > 5 * left[h]
    slopes = [np.log2(left[2e-2] / left[1e-2]), np.log2(left[1e-2] / left[5e-3])]
    assert min(slopes) > 3.8


def _affine(turn: np.ndarray, shift: np.ndarray) -> np.ndarray:
    """A matrix and a vector as one affine generator."""
    result = np.zeros((len(shift) + 1,) * 2)
    result[:-1, :-1], result[:-1, -1] = turn, shift
    return result


@pytest.mark.parametrize("name", ["general", "so3_half"])
def test_base_point_changes_by_conjugation(name, request):
    """Another corner as base point conjugates by the path between them; invariants stay."""
    connection = request.getfixturevalue(name)
    corners = [[0.1, 0.8, 0.0], [0.5, 0.8, 0.1], [0.4, 1.2, 0.3], [0.0, 1.1, 0.2]]
    here = develop(connection, Loop.polygon(corners))
    there = develop(connection, Loop.polygon(corners[1:] + corners[:1]))
    path = develop_path(connection, corners[:2])
    assert np.abs(here.seen_from(path).increment - there.motion.increment).max() < 1e-13
    assert np.abs(here.burgers - there.burgers).max() > 1e-3
    assert abs(np.trace(here.rotation) - np.trace(there.rotation)) < 1e-13
    if name == "so3_half":
        assert abs(here.angle - there.angle) < 1e-13
        assert abs(here.along_axis - there.along_axis) < 1e-13


def test_loops_compose_reverse_and_repeat(so3_half):
    """Joined loops multiply their motions, reversal inverts, repetition gives powers."""
    one = Loop.polygon([[0, 1, 0], [0.4, 1, 0], [0.4, 1.3, 0.2]])
    two = Loop.polygon([[0, 1, 0], [0, 1.4, 0], [0.1, 1.0, 0.5]])
    a, b = develop(so3_half, one).motion, develop(so3_half, two).motion
    both = develop(so3_half, one.then(two)).motion
    assert np.abs(both.increment - (a @ b).increment).max() < ROUNDED
    assert np.abs((a @ b).increment - (b @ a).increment).max() > 1e-4
    back = develop(so3_half, one.reversed()).motion
    assert np.abs((a @ back).increment).max() < ROUNDED
    thrice = develop(so3_half, one.times(3)).motion
    assert np.abs(thrice.matrix - np.linalg.matrix_power(a.matrix, 3)).max() < ROUNDED


def test_development_does_not_depend_on_the_parameter(general):
    """The same ellipse in two parametrisations has the same development."""
    ellipse = Loop.ellipse([0.2, 0.3, 0.1], (0.4, 0.2))
    s = sp.Symbol("s", real=True)
    angle = s + sp.Rational(1, 3) * sp.sin(s)
    curve = Loop.parametric(
        [2 * sp.cos(angle) / 5, sp.sin(angle) / 5, 0], s, (0, 2 * sp.pi), [0.2, 0.3, 0.1]
    )
    one, two = develop(general, ellipse), develop(general, curve)
    assert np.abs(one.motion.increment - two.motion.increment).max() < 1e-13


def test_both_routes_agree_with_a_third(so3_half):
    """Line, cone and scipy's Runge-Kutta give the same motion."""
    loop = Loop.circle([0.3, 1.2, 0.2], 0.4, (1, 2))
    form = AffineForm(so3_half)
    (part,) = loop.parts

    def rate(s, flat):
        points, slopes = part.points(part.arcs[0], np.array([s]))
        omega, step = form.along(points, slopes)
        return (flat.reshape(4, 4) @ _affine(omega[0], step[0])).ravel()

    found = solve_ivp(rate, (0, 1), np.eye(4).ravel(), "DOP853", rtol=1e-12, atol=1e-13)
    third = found.y[:, -1].reshape(4, 4)
    turn = develop(so3_half, loop)
    assert turn.check.cone is not None
    assert np.abs(turn.check.line.matrix - third).max() < 1e-10
    assert np.abs(turn.check.cone.matrix - turn.check.line.matrix).max() < 1e-13


@pytest.mark.parametrize("size", [0.3, 1e-2, 1e-5])
def test_error_estimates_hold(so3_half, size):
    """The stated errors bound the distance to a tighter result, and are not too large."""
    loop = Loop.polygon([[0, 0, 0], [1, 0, 0.3], [0.2, 1, 0]], [0.3, 1.1, 0.2], size)
    rough, fine = develop(so3_half, loop, 1e-6), develop(so3_half, loop, 1e-14)
    apart = np.abs(rough.motion.increment - fine.motion.increment)
    assert apart[:-1, -1].max() <= rough.error + fine.error
    assert apart[:-1, :-1].max() <= rough.turn_error + fine.turn_error
    assert rough.error < 1e-5 * np.abs(fine.burgers).max()
    assert fine.error < 1e-12 * np.abs(fine.burgers).max()


def test_boosts_keep_the_lorentz_metric():
    """Schwarzschild: the loop turns by an element of the Lorentz group, here a boost."""
    frame = spaces.load("schwarzschild").frame
    bar = levi_civita(frame)
    loop = Loop.plaquette([0.0, 6.0, 1.2, 0.3], (3.0, 0.5), (0, 1))
    turn = develop(bar, loop, parameters={"M": 1.0})
    eta = frame.eta.at({})
    assert np.abs(turn.rotation @ eta @ turn.rotation.T - eta).max() < 1e-13
    # dt dr plaquette at fixed angles: a boost by integral of d(h h')... = M (1/r1^2 - 1/r2^2) dt.
    rapidity = 1.0 * (1 / 6.0**2 - 1 / 6.5**2) * 3.0
    assert abs(np.arcsinh(turn.rotation[0, 1]) ** 2 - rapidity**2) < ROUNDED
    with pytest.raises(LoopError, match="not a rotation"):
        _ = turn.angle
    assert np.abs(np.abs(turn.frank[0, 1]) - rapidity) < ROUNDED


def test_open_paths_follow_straight_lines_of_the_plane():
    """In polar coordinates the development of the plane is the plane itself."""
    r, a = sp.symbols("r phi", positive=True)
    plane = levi_civita(Frame([r, a], [[1, 0], [0, r]]))
    path = develop_path(plane, [[1, 0.2], [3, 0.2], [3, 1.4], [0.5, 0.9]])
    start, end = (
        np.array([p[0] * np.cos(p[1]), p[0] * np.sin(p[1])]) for p in ([1, 0.2], [0.5, 0.9])
    )
    legs = np.array([[np.cos(0.2), np.sin(0.2)], [-np.sin(0.2), np.cos(0.2)]])
    assert np.abs(path.burgers - legs @ (end - start)).max() < 1e-13


def test_symbols_of_a_loop_have_values_among_the_parameters():
    """A symbol of the loop gets its value from the parameters, as in burgers_vector."""
    k, R = sp.symbols("k R", positive=True)
    frame = Frame([theta, phi], [[1, 0], [0, k * sp.sin(theta)]])
    loop, values = Loop.circle([1, 0], R), {"k": 2, "R": sp.Rational(1, 2)}
    for connection in (levi_civita(frame), cartan(frame)):
        found = develop(connection, loop, parameters=values)
        path = developed_path(connection, loop, 40, parameters=values)
        # A loop of expressions is the same to all digits, but its sums differ.
        known = develop(connection, Loop.circle([1, 0], 0.5), parameters={"k": 2})
        assert np.abs(found.motion.increment - known.motion.increment).max() < 1e-13
        assert np.abs(path.places[:, -1] - known.burgers).max() < 1e-12
    with pytest.raises(MissingValueError, match="loop: expected a value for R, got none"):
        develop(cartan(frame), loop, parameters={"k": 2})
    with pytest.raises(UnknownNameError, match="expected a parameter of this frame, got 'q'"):
        develop(cartan(frame), loop, parameters=values | {"q": 1})
    with pytest.raises(UnknownNameError, match="expected a parameter of this frame, got 'q'"):
        burgers_vector(frame, loop, parameters=values | {"q": 1})


def test_bad_input_is_refused(sphere):
    """Dimension, accuracy and missing parameters each have their own message."""
    with pytest.raises(LoopError, match="3 coordinates, the frame 2"):
        develop(sphere, Loop.circle([0, 0, 0], 1))
    with pytest.raises(LoopError, match="accuracy"):
        develop(sphere, Loop.circle([1, 0], 0.1), 1e-20)
    with pytest.raises(LoopError, match="accuracy"):
        develop(sphere, Loop.circle([1, 0], 0.1), float("nan"))
    with pytest.raises(ArgumentError, match="connection: expected a Connection"):
        develop_path(sphere.frame, [[1, 0], [1, 1]])  # type: ignore[arg-type]
    with pytest.raises(LoopError, match="points: expected a list"):
        develop_path(sphere, 3)  # type: ignore[arg-type]
    with pytest.raises(LoopError, match="each different from the next"):
        develop_path(sphere, [[1, 0], [1, 0]])
    screw = cartan(spaces.load("screw_core").frame)
    with pytest.raises(MissingValueError, match="c"):
        develop(screw, Loop.circle([0, 0, 0], 1), parameters={"b": 1})


def test_underflow_widens_the_error_bound(sphere):
    """If the area of a loop underflows, the error bound still covers the true angle."""
    turn = develop(sphere, Loop.circle([1.0, 0.3], 1e-200))
    assert turn.route == "line"
    assert turn.check.agrees is None
    assert turn.turn_error > abs(turn.angle)


@pytest.mark.parametrize("radius", [1e-7, 1e-10, 1e-13])
def test_tiny_loops_are_the_flux_at_their_centre(general, radius):
    """A tiny loop has torsion and curvature at its centre, up to a share of its radius."""
    centre = [0.3, 0.9, 0.2]
    unit = np.eye(3)[:, :, None]
    rho, tau = AffineForm(general).over(np.array(centre)[:, None], unit[0], unit[1])
    found = develop(general, Loop.circle(centre, radius)).motion.increment / (np.pi * radius**2)
    expected = _affine(rho[0], tau[0])
    assert np.abs(found - expected).max() < 20 * radius + ROUNDED
    assert np.abs(expected).max() > 0.5


def test_intervals_have_as_many_points_as_suit_nine_digits() -> None:
    """Points per interval suit nine digits: more or fewer would cost more evaluations."""
    loop = Loop.circle([0.3, 1, 0.2], 0.5)
    found = develop(levi_civita(spaces.load("so3").frame), loop, 1e-9)
    assert found.evaluations < 600


@pytest.mark.parametrize("count", [2, 3, 5])
def test_the_error_of_a_product_bounds_perturbed_factors(count):
    """A turned first motion moves all shifts after it: the change is within the carried error."""
    rng = np.random.default_rng(count)
    largest = 0.0
    for _ in range(50):
        turns = np.linalg.qr(rng.normal(size=(count, 2, 2)))[0]
        motions, moved = np.zeros((2, count, 3, 3))
        motions[:, :2, :2] = turns - np.eye(2)
        motions[:, :2, 2] = rng.normal(size=(count, 2)) * [[0.01]] + [[0, 5]]
        change = rng.normal(size=(count, 2, 3)) * 1e-7
        # Only some of the motions are wrong.
        change[rng.random(count) < 0.5] = 0
        moved[:] = motions
        moved[:, :2] += change
        errors = np.stack(
            [
                np.linalg.norm(change[:, :, :2], 2, axis=(1, 2)),
                np.linalg.norm(change[:, :, 2], axis=1),
            ],
            axis=1,
        )
        exact, carried = product(motions, errors)
        gap = product(moved, errors)[0] - exact
        turn, shift = np.linalg.norm(gap[:2, :2], 2), np.linalg.norm(gap[:2, 2])
        assert turn <= carried[0] * 1.000001
        assert shift <= carried[1] * 1.000001
        largest = max(largest, shift / carried[1] if carried[1] else 0.0)
    # The bound is not empty.
    assert largest > 0.3


def test_legs_that_turn_around_the_origin_have_no_holonomy_in_the_plane() -> None:
    """Legs that turn by another third of the angle end up turned; vectors and points do not."""
    r = sp.Symbol("r", positive=True)
    c, s = sp.cos(phi / 3), sp.sin(phi / 3)
    plane = levi_civita(Frame([r, phi], [[c, r * s], [-s, r * c]]))
    circle = Loop.parametric(["2", "s"], interval=(0, "2*pi"), periods={1: "2*pi"})
    found = develop(plane, circle)
    assert np.abs(found.rotation - np.eye(2)).max() <= found.turn_error
    assert np.abs(found.burgers).max() <= found.error


def test_an_uncertain_turn_adds_to_the_error_of_the_loop_after_it(sphere: Connection) -> None:
    """The first loop turns the Burgers vector of the second, with the error of its turn."""
    first = Loop.polygon([[1, 0], [1.5, 0.1], [1.2, 0.4]])
    second = Loop.polygon([[1, 0], [1.2, -0.6], [1.8, -0.3]])
    one, two = develop(sphere, first), develop(sphere, second)
    both = develop(sphere, first.then(second))
    assert both.error > one.error + two.error
    moved = one.burgers + one.rotation @ two.burgers
    assert np.abs(both.burgers - moved).max() <= both.error
