"""Logarithm map: near conjugate points, guesses, lengths at all scales."""

import numpy as np
import pytest
import sympy as sp

from geomtorsion.curves import exponential_map, log_map
from geomtorsion.errors import EndpointError, GeomtorsionError
from geomtorsion.geometry import Frame, cartan, levi_civita
from geomtorsion.ode import RungeKutta, Taylor
from geomtorsion.spaces import load


@pytest.mark.parametrize(("short", "found"), [(1e-5, True), (1e-7, True), (1e-9, False)])
def test_how_near_to_a_conjugate_point_geodesics_are_found(short, found):
    """Near the antipode of a sphere a geodesic is found at 1e-7 from it, but not at 1e-9."""
    start, end = [np.pi / 2, 0.0], [np.pi / 2, np.pi - short]
    call = {"parameters": {"R": 1}, "guess": [0.0, np.pi - 3 * short]}
    connection = levi_civita(load("s2").frame)
    if found:
        vector = log_map(connection, start, end, **call).vector
        assert np.abs(vector) == pytest.approx([0, np.pi - short], abs=1e-6)
    else:
        with pytest.raises(EndpointError):
            log_map(connection, start, end, **call)


def great_circle(start, angle, length):
    """The end of a great circle from a point in spherical coordinates."""
    theta, phi = start
    radial = np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
    south = np.array([np.cos(theta) * np.cos(phi), np.cos(theta) * np.sin(phi), -np.sin(theta)])
    east = np.array([-np.sin(phi), np.cos(phi), 0])
    ahead = np.cos(angle) * south + np.sin(angle) * east
    x, y, z = np.cos(length) * radial + np.sin(length) * ahead
    return [float(np.arctan2(np.hypot(x, y), z)), float(np.arctan2(y, x))]


@pytest.mark.parametrize("short", [1e-5, 1e-6])
def test_a_generic_great_circle_almost_to_the_antipode(short):
    """The length is right, and the direction to what the answer states."""
    end = great_circle([1.0, 0.3], 0.4, np.pi - short)
    answer = log_map(levi_civita(load("s2").frame), [1.0, 0.3], end, parameters={"R": 1})
    assert answer.length == pytest.approx(np.pi - short, abs=1e-9)
    turn = np.abs(answer.vector / answer.length - [np.cos(0.4), np.sin(0.4)]).max()
    _, _, stated = answer.guarantee.partition("direction is good to ")
    assert turn < (float(stated) if stated else 1e-8)


def test_the_reason_is_that_the_end_is_almost_conjugate():
    """Near the antipode errors hide the direction, and the refusal gives this reason."""
    end = great_circle([0.7, -1.2], 0.4, np.pi - 1e-9)
    with pytest.raises(EndpointError, match="conjugate|cut locus"):
        log_map(levi_civita(load("s2").frame), [0.7, -1.2], end, parameters={"R": 1})


@pytest.mark.parametrize(
    "radius",
    [
        lambda r: 2 + sp.besselj(1, r), lambda r: 2 + sp.gamma(r + 2), lambda r: 3 + sp.erf(r),
        lambda r: 2 + sp.LambertW(r + 1), lambda r: 2 + sp.polygamma(1, r + 3),
    ],
)  # fmt: skip
def test_metrics_with_special_functions(radius):
    """The end is hit without naming an engine, and as RungeKutta hits it."""
    r, phi = sp.symbols("r phi", real=True)
    surface = levi_civita(Frame([r, phi], [[1, 0], [0, radius(r)]]))
    answer = log_map(surface, [0.5, 0.0], [1.0, 0.3])
    assert exponential_map(surface, [0.5, 0.0], answer.vector) == pytest.approx([1, 0.3], abs=1e-8)
    other = log_map(surface, [0.5, 0.0], [1.0, 0.3], engine=RungeKutta())
    assert answer.vector == pytest.approx(other.vector, abs=1e-8)


def test_an_engine_without_series_names_the_reason():
    """Taylor has no series of Bessel functions: that is the reason, and not the end."""
    r, phi = sp.symbols("r phi", real=True)
    surface = levi_civita(Frame([r, phi], [[1, 0], [0, 2 + sp.besselj(1, r)]]))
    with pytest.raises(GeomtorsionError, match="besselj has no Taylor series"):
        log_map(surface, [0.5, 0.0], [1.0, 0.3], engine=Taylor())


SPHERE = levi_civita(load("s2").frame), [1.5, 0.0], [1.6, 3.0], {"R": 1}
R, PHI = sp.symbols("r phi", real=True)
POLAR = Frame([R, PHI], sp.diag(1, R), domain=[R > 0, sp.Gt(PHI, -sp.pi), sp.Lt(PHI, sp.pi)])
PLANE = levi_civita(POLAR), [1, 0], [1, 0.5], {}


def test_a_guess_in_the_wrong_direction_leads_to_the_end():
    """A guess away from the end still leads there; on a sphere it may lead nowhere."""
    connection, start, end, parameters = PLANE
    call = {"accuracy": 1e-9, "engine": RungeKutta()}
    found = log_map(connection, start, end, guess=[-3.0, 0.1], parameters=parameters, **call)
    assert found.vector == pytest.approx([np.cos(0.5) - 1, np.sin(0.5)], abs=1e-8)
    connection, start, end, parameters = SPHERE
    with pytest.raises(EndpointError):
        log_map(connection, start, end, guess=[3.0, 0.1], parameters=parameters, **call)


def test_a_long_way_over_a_sphere():
    """The vector leads to the end, along an arc of the great circle."""
    connection, start, end, parameters = SPHERE
    found = log_map(connection, start, end, guess=[0.3, -1.0], parameters=parameters)
    (a, b), (c, d) = start, end
    arc = np.arccos(np.cos(a) * np.cos(c) + np.sin(a) * np.sin(c) * np.cos(b - d))
    assert min(found.length, 2 * np.pi - found.length) == pytest.approx(arc, abs=1e-8)


def test_what_counts_modulo_a_full_turn():
    """A coordinate whose domain is a full turn is an angle; one that only ends at 2 pi is not."""
    x, y = sp.symbols("x y", real=True)
    plane = levi_civita(Frame([x, y], sp.eye(2), domain=[x < 2 * sp.pi]))
    assert log_map(plane, [0, 0], [5, 0]).vector == pytest.approx([5, 0], abs=1e-9)
    found = log_map(levi_civita(POLAR), [1, 3], [1, -3])
    chord = 2 * np.sin(np.pi - 3)
    assert np.linalg.norm(found.vector) == pytest.approx(chord, abs=1e-9)


X, Y = sp.symbols("x y", real=True)
HEIGHT = sp.Symbol("y", positive=True)
HALF_PLANE = Frame([X, HEIGHT], sp.diag(1 / HEIGHT, 1 / HEIGHT))
PLAIN = Frame([X, Y], sp.eye(2))
TURNS = [X > 0, sp.Lt(X, 2 * sp.pi), Y > 0, sp.Lt(Y, 2 * sp.pi)]
TORUS = Frame(
    [X, Y],
    sp.eye(2),
    signature=[[1, sp.Rational(9, 10)], [sp.Rational(9, 10), 1]],
    domain=TURNS,
)
# Each turn around the axis climbs by pi.
HELIX = Frame([X, Y], [[1, 0], [sp.Rational(1, 2), 1]], domain=TURNS[:2])
S2, S3 = load("s2").frame, load("s3").frame
UNIT = {"R": 1}


@pytest.mark.parametrize(
    ("frame", "start", "end", "parameters", "length"),
    [
        (HALF_PLANE, [0, 1e-10], [1e-10, 2e-10], {}, np.arccosh(1.5)),
        (HALF_PLANE, [0, 1e-4], [1e-4, 2e-4], {}, np.arccosh(1.5)),
        (HALF_PLANE, [0, 1e10], [1e10, 2e10], {}, np.arccosh(1.5)),
        (HALF_PLANE, [0, 1e-10], [0, 1], {}, np.log(1e10)),
        (HALF_PLANE, [0, 1e-3], [1, 1e-3], {}, np.arccosh(1 + 5e5)),
        (load("flat_polar").frame, [1e-9, 0], [1e-9, 1.5], {}, 2e-9 * np.sin(0.75)),
        (POLAR, [1e-9, 0], [1e-9, 1.5], {}, 2e-9 * np.sin(0.75)),
        (POLAR, [1e9, 0], [1e9, 3.1], {}, 2e9 * np.sin(1.55)),
        (S2, [1, 0.3], [2, 3.3], UNIT, 2.953353592554937),
        (S2, [1, 0], [np.pi - 1, np.pi - 1e-3], UNIT, np.pi - 1e-3 * np.sin(1)),
        (S2, [1, 0], [np.pi - 1 + 1e-5, np.pi], UNIT, np.pi - 1e-5),
        (S2, [0.1, 0], [0.1, np.pi], UNIT, 0.2),
        (S3, [0.205, 2.2719, 2.333], [1.3993, -2.2588, -2.3847], {}, 1.599925653274959),
        (TORUS, [0, 0], [3, 2.8], {}, 1.4394623347259896),
        (HELIX, [0, 0], [1, 100], {}, 89.50484690990505),
        (PLAIN, [0, 0], [3e-300, 4e-300], {}, 5e-300),
        (PLAIN, [0, 0], [3e300, 4e300], {}, 5e300),
        (PLAIN, [1, 2], [1, 2], {}, 0.0),
        (S2, [1, 0.3], [1 + 1e-10, 0.3], UNIT, (1 + 1e-10) - 1),
        (HALF_PLANE, [0, 1], [1e-300, 1], {}, 1e-300),
    ],
)
def test_lengths_at_all_scales(frame, start, end, parameters, length):
    """Lengths are right for large and small coframes, near the cut locus, tiny and huge."""
    found = log_map(levi_civita(frame), start, end, parameters=parameters)
    # In the third case of S2 the sine of a small angle replaces the angle, near the antipode.
    assert found.length == pytest.approx(length, rel=1e-7 if frame is S2 else 1e-9)
    assert found.guarantee


def test_rotations_by_nearly_half_a_turn():
    """The answer is unique at pi - 1e-6, also for a quaternion of the other sign; not at pi."""
    so3 = levi_civita(load("so3").frame)
    start, axis = [0.3, 1.0, 0.2], np.array([0.36, 0.48, 0.8])
    for sign in (1, -1):
        vector = sign * (np.pi - 1e-6) * axis
        end = exponential_map(so3, start, vector)
        assert log_map(so3, start, end).vector == pytest.approx(vector, abs=1e-8)
    with pytest.raises(EndpointError, match="no unique answer.*cut locus"):
        log_map(so3, start, exponential_map(so3, start, np.pi * axis))


FACTORS = [
    (1, sp.Rational(3, 2), 2),
    (1, sp.sqrt(2), sp.sqrt(3)),
    (sp.pi, 1, 1),
]


@pytest.mark.parametrize("factors", FACTORS, ids=str)
@pytest.mark.parametrize("name", ["so3", "so3_quaternion", "so3_rodrigues"])
def test_left_invariant_metrics(name, factors):
    """The logarithm inverts the exponential map, also for irrational moments."""
    base = load(name).frame
    rows = sp.diag(*factors) * sp.Matrix(base.coframe.to_sympy().tolist())
    connection = levi_civita(Frame(base.coordinates, rows.tolist(), domain=base.domain))
    start = [0.3, 1.0, 0.2] if name == "so3" else [0.1, 0.2, 0.3]
    for vector in ([0.2, -0.4, 0.3], [0.5, 0.6, 0.1]):
        end = exponential_map(connection, start, vector)
        assert log_map(connection, start, end).vector == pytest.approx(vector, abs=1e-8)


def test_conjugate_points_are_reported():
    """The long way around a sphere or a three-sphere passes the antipode, which is conjugate.

    Between the 64 samples the conjugate point is interpolated.
    """
    sphere = levi_civita(S2)
    short = log_map(sphere, [1, 0.3], [2, 1.3], parameters=UNIT)
    assert short.conjugate == ()
    back = -short.vector * (2 * np.pi - short.length) / short.length
    found = log_map(sphere, [1, 0.3], [2, 1.3], guess=back * 1.01, parameters=UNIT)
    assert found.length == pytest.approx(2 * np.pi - short.length, rel=1e-9)
    assert found.conjugate == pytest.approx((np.pi / found.length,), abs=1e-3)
    assert "guess" in found.guarantee
    # Just beyond the antipode, between the last two samples.
    beyond = log_map(
        sphere, [1, 0], [np.pi - 1 + 1e-3, np.pi], guess=[-np.pi - 1e-3, 0], parameters=UNIT
    )
    assert beyond.conjugate == pytest.approx((np.pi / beyond.length,), abs=1e-3)
    three = levi_civita(S3)
    short = log_map(three, [0.5, 1, 2], [0.9, 1.5, 2.2])
    back = -short.vector * (2 * np.pi - short.length) / short.length
    found = log_map(three, [0.5, 1, 2], [0.9, 1.5, 2.2], guess=back)
    assert found.conjugate == pytest.approx((np.pi / found.length,), abs=1e-3)


def test_the_shortest_through_the_edge_of_a_chart():
    """Rotations as vectors up to length 1: the short way leaves and enters on the far side."""
    turns = levi_civita(load("so3_quaternion").frame)
    near = np.array([0.7, 0.5, 0.45])
    found = log_map(turns, near, -near)
    scalar = 1 - near @ near
    assert found.length == pytest.approx(2 * np.arccos(abs(scalar - near @ near)), rel=1e-9)


def test_indefinite_metrics():
    """Length is proper time; the frame velocity decides the choice, and the guarantee names it."""
    flat = levi_civita(Frame([X, Y], sp.eye(2), signature=[-1, 1]))
    found = log_map(flat, [0, 0], [3, 1])
    assert found.length == pytest.approx(np.sqrt(8), rel=1e-12)
    assert found.miss < 1e-9
    hole = levi_civita(load("schwarzschild").frame)
    mass = {"M": 1}
    vector = [1.2, 0.1, 0.2, 0.1]
    end = exponential_map(hole, [0, 8, 1.5, 1], vector, parameters=mass)
    found = log_map(hole, [0, 8, 1.5, 1], end, parameters=mass)
    assert found.vector == pytest.approx(vector, abs=1e-7)
    assert found.length == pytest.approx(np.sqrt(1.2**2 - 0.06), rel=1e-8)
    assert "least frame velocity" in found.guarantee


def test_autoparallels_with_torsion():
    """Autoparallels of the rotations are their geodesics: both give the same vector."""
    frame = load("so3").frame
    ends = [0.3, 1.0, 0.2], [2.0, 2.0, 4.0]
    straight, shortest = (log_map(kind(frame), *ends) for kind in (cartan, levi_civita))
    assert straight.vector == pytest.approx(shortest.vector, abs=1e-8)


@pytest.mark.parametrize(
    ("frame", "start", "end", "words"),
    [
        (S2, [np.pi / 2, 0], [np.pi / 2, np.pi], "no unique answer"),
        (TORUS, [0, 0], [np.pi, np.pi], "no unique answer"),
        (HALF_PLANE, [0, 1], [0, 1e-10], "depends too much on its start"),
        (HALF_PLANE, [0, 1e-10], [1, 1e-10], "got none"),
    ],
)
def test_refused_ends(frame, start, end, words):
    """Ends on the cut locus, and ends that doubles cannot hit, are refused."""
    parameters = UNIT if frame is S2 else None
    with pytest.raises(EndpointError, match=words):
        log_map(levi_civita(frame), start, end, parameters=parameters)
