"""Shadow: edges against closed forms, images, redshift, other light, refusals."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import MetricError, ShapeError, StartError

M, FAR = 1.0, 30.0


def flat():
    """Minkowski space in Cartesian coordinates."""
    return gt.Frame(sp.symbols("t x y z", real=True), sp.eye(4), signature=(-1, 1, 1, 1))


def test_a_black_ball_in_flat_space():
    """Straight light: the sine of the angle is radius over distance, in each direction."""
    ends = {"dark": "x**2 + y**2 + z**2 - 4", "sky": ["400 - x**2 - y**2 - z**2"]}
    view = gt.shadow(flat(), [0, 10, 0, 0], **ends)
    assert view.axis == pytest.approx([-1, 0, 0])
    edge = view.edge(5, 1e-8)
    assert np.abs(edge.radii - np.arcsin(0.2)).max() <= edge.error <= 1e-8
    assert np.hypot(*edge.points.T) == pytest.approx(np.tan(edge.radii))


@pytest.mark.parametrize("distance", [4.0, 30.0, 1000.0])
def test_schwarzschild(distance):
    """sin(chi) = sqrt(27) M sqrt(1 - 2 M/r)/r (Synge 1966)."""
    edge = gt.shadow("schwarzschild", [0, distance, 1.2, 0], parameters={"M": M}).edge(3, 1e-8)
    truth = np.arcsin(np.sqrt(27) * np.sqrt(1 - 2 / distance) / distance)
    assert np.abs(edge.radii - truth).max() <= 1.01 * edge.error <= 1.01e-8


def bardeen(a, r0, theta, radius):
    """Angle in the image and angle from the axis of a spherical photon orbit (Bardeen 1973).

    The camera has Carter's tetrad; xi = L/E and eta = Q/E**2 of the orbit at a radius.
    """
    delta, D = radius**2 - 2 * radius + a**2, r0**2 - 2 * r0 + a**2
    xi = (radius**2 + a**2) / a - 2 * radius * delta / (a * (radius - 1))
    eta = radius**3 * (4 * a**2 - radius * (radius - 3) ** 2) / (a**2 * (radius - 1) ** 2)
    c, s = np.cos(theta), np.sin(theta)
    size = np.sqrt(r0**2 + a**2 * c**2)
    p0 = (r0**2 + a**2 - a * xi) / np.sqrt(D) / size
    p2 = np.sqrt(eta + a**2 * c**2 - xi**2 * c**2 / s**2) / size
    p3 = (xi - a * s**2) / s / size
    return np.arctan2(p2, -p3), np.arcsin(np.hypot(p2, p3) / p0)


@pytest.mark.parametrize(("a", "theta"), [(0.9, np.pi / 2), (0.5, 1.0), (0.998, np.pi / 2)])
def test_bardeens_edge_of_kerr(a, theta):
    """Spherical photon orbits between the equatorial ones, seen from any latitude."""
    low, high = (2 * (1 + np.cos(2 / 3 * np.arccos(-sign * a))) for sign in (1, -1))
    turns, truth = [], []
    for radius in low + (high - low) * np.array([0.3, 0.45, 0.6, 0.7]):
        angle, chi = bardeen(a, FAR, theta, radius)
        if np.isfinite(angle):
            turns.append(angle)
            truth.append(chi)
    assert len(turns) >= 3
    view = gt.shadow("kerr", [0, FAR, theta, 0], parameters={"M": M, "a": a})
    edge = view.edge(turns, 1e-7)
    assert np.abs(edge.radii - truth).max() <= 1e-6
    assert edge.error <= 1e-7


def wormhole():
    """Ellis' wormhole with a throat of radius b."""
    t, length, theta, phi = sp.symbols("t l theta phi", real=True)
    b = sp.Symbol("b", positive=True)
    r = sp.sqrt(length**2 + b**2)
    return gt.Frame(
        [t, length, theta, phi], sp.diag(1, 1, r, r * sp.sin(theta)), signature=(-1, 1, 1, 1),
        parameters=[b], domain=[theta > 0, theta < sp.pi, phi > 0, phi < 2 * sp.pi],
    )  # fmt: skip


def test_ellis_wormhole():
    """Light passes the throat below the impact parameter b: sin(chi) = b/sqrt(b**2 + l**2)."""
    view = gt.shadow(
        wormhole(), [0, 3, 1.3, 0], parameters={"b": 2}, dark="l + 10", sky="10 - l"
    )  # fmt: skip
    truth = np.arcsin(2 / np.sqrt(13))
    edge = view.edge([0.0, 0.4, 2.0], 1e-8)
    assert np.abs(edge.radii - truth).max() <= 1.01 * edge.error <= 1.01e-8
    # A ray of the meridian meets the axis of this only chart; its bracket is wider.
    upwards = view.edge([np.pi / 2], 1e-8)
    assert abs(upwards.radii[0] - truth) <= upwards.error < 1e-4


def test_light_along_autoparallels():
    """With Cartan's connection u is constant: what looks inwards is captured, chi = pi/2."""
    static = gt.spaces.load("schwarzschild").frame
    view = gt.shadow(
        gt.cartan(static), [0, 10, 1.3, 0], parameters={"M": M}, light="autoparallel"
    )  # fmt: skip
    edge = view.edge([0.3, 2.0], 1e-4)
    assert np.abs(edge.radii - np.pi / 2).max() <= edge.error + 1e-4
    # The metric's own light has another shadow for the same legs.
    other = gt.shadow(gt.cartan(static), [0, 10, 1.3, 0], parameters={"M": M})
    assert other.edge([0.3], 1e-4).radii[0] < 0.6


def test_an_image_agrees_with_the_edge():
    """Dark pixels are those within the edge; their light is redshifted as between static legs."""
    view = gt.shadow("schwarzschild", [0, 10, 1.3, 0], parameters={"M": M})
    image = view.image(12, field=1.6)
    side = np.tan(0.8) * ((2 * np.arange(12) + 1) / 12 - 1)
    away = np.arctan(np.hypot(side[None, :], side[:, None]))
    truth = np.arcsin(np.sqrt(27 * 0.8) / 10)
    assert np.array_equal(image.dark, away < truth)
    assert not image.undecided.any()
    bright = image.fate == 0
    r = image.coordinates[bright][:, 1]
    assert image.redshift[bright] == pytest.approx(np.sqrt(0.8 / (1 - 2 / r)), rel=1e-5)
    assert np.array_equal(np.asarray(image), image.fate)
    assert set(image.stopped_by[bright]) == {view.rays.stop_texts[-1]}


def test_light_winds_near_the_edge():
    """Outside the edge by d a ray turns more by ln(10) for each tenth of d (Darwin 1959)."""
    view = gt.shadow("schwarzschild", [0, 30, np.pi / 2, 0], parameters={"M": M})
    truth = np.arcsin(np.sqrt(27 * (1 - 2 / 30)) / 30)
    away = truth * (1 + np.array([1e-3, 1e-4, 1e-5, 1e-6]))
    lines = np.cos(away)[:, None] * view.axis + np.sin(away)[:, None] * view.right
    u = np.insert(lines, view.time, -1.0, axis=1)
    rays = gt.solve_many(view.rays, None, view.length, 1e-7, frame_velocities=u)
    steps = np.diff(np.abs(rays.end["phi"]))
    assert steps == pytest.approx(np.log(10), rel=2e-3)


def test_one_camera_turned():
    """Another axis and another upward direction move the image as a whole."""
    plain = schwarzschild().image(6, field=1.6)
    turned = schwarzschild(up=[0, 0, 1]).image(6, field=1.6)
    assert turned.redshift == pytest.approx(np.rot90(plain.redshift), rel=1e-5)


def test_any_number_of_workers_gives_the_same_bits():
    """Fates, places and velocities."""
    hole, place = {"M": M, "a": 0.7}, [0, 10, 1.3, 0]
    plain = gt.shadow("kerr", place, parameters=hole).image(16, field=1.0)
    with ThreadPoolExecutor(2) as pool:
        sent = gt.shadow("kerr", place, parameters=hole, executor=pool).image(16, field=1.0)
    for name in ("fate", "coordinates", "frame_velocity", "errors"):
        assert getattr(plain, name).tobytes() == getattr(sent, name).tobytes(), name


def schwarzschild(**more):
    return gt.shadow("schwarzschild", [0, 10, 1.3, 0], parameters={"M": M}, **more)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: gt.shadow("kerr_kinnersley", [0, 9, 1, 0], parameters={"M": 1, "a": 0.5}),
         MetricError, "expected an orthonormal tetrad with one timelike"),
        (lambda: gt.shadow("s2", [1, 0]), MetricError, "three spatial legs"),
        (lambda: gt.shadow(flat(), [0, 1, 0, 0]), StartError, "expected conditions at which rays"),
        (lambda: gt.shadow("schwarzschild", [0, 1, 1, 0], parameters={"M": 1}),
         StartError, "schwarzschild"),
        (lambda: gt.shadow("schwarzschild", [0, 9, 1, 0]), StartError, "parameters"),
        (lambda: schwarzschild(light="ray"), StartError, "light: expected"),
        (lambda: schwarzschild(axis=[1, 0]), ShapeError, "axis"),
        (lambda: schwarzschild(axis=[0, 0, 0]), ShapeError, "axis: expected a direction"),
        (lambda: schwarzschild(up=[1, 0, 0]), ShapeError, "up: expected a direction"),
        (lambda: schwarzschild(axis=[1, 0, 0]).edge(1), StartError, "axis points into the shadow"),
        (lambda: schwarzschild().edge([]), ShapeError, "angles: expected at least one"),
        (lambda: schwarzschild().image(4, field=4.0), StartError, "field: expected an angle below"),
        (lambda: schwarzschild().image(0), StartError, "pixels"),
        (lambda: schwarzschild(dark="q - 1", sky="50 - r"), gt.errors.ExpressionError, "q"),
    ],
)  # fmt: skip
def test_refusals(call, error, words):
    """Frames and cameras without a shadow are refused, with a remedy."""
    with pytest.raises(error, match=words):
        call()
