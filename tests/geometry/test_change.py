"""Change: frames, tensors and connections in other coordinates; unknown functions by name."""

import pytest
import sympy as sp
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError
from tests.laws.frames import connections

x, y, z, w = sp.symbols("x y z w", real=True)
t, r, theta, phi = sp.symbols("t r theta phi", positive=True)
PLANE = gt.Frame([x, y], sp.eye(2))
POLAR = {x: r * sp.cos(phi), y: r * sp.sin(phi)}
few = settings(
    max_examples=15,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)


def test_cartesian_to_spherical() -> None:
    """The legs stay along x, y, z; metric and gradient agree with textbooks."""
    space = gt.Frame([x, y, z], sp.eye(3))
    s, c = sp.sin(theta), sp.cos(theta)
    old = [r * s * sp.cos(phi), r * s * sp.sin(phi), r * c]
    ball = space.in_coordinates("r theta phi", old)
    assert ball.metric.nonzero() == {(0, 0): 1, (1, 1): r**2, (2, 2): r**2 * s**2}
    assert ball.coframe[2, 1] == -r * s
    assert gt.cartan(ball).torsion.T.is_zero
    assert space.in_coordinates("r theta phi", old) is ball
    gradient = gt.Form(space, 0, {(): x**2 + y**2 + z**2}).d.tensor
    assert gradient.in_coordinates("r theta phi", old).nonzero() == {(0,): 2 * r}


def test_schwarzschild_in_other_coordinates() -> None:
    """Schwarzschild in ingoing Eddington-Finkelstein and isotropic coordinates, and back."""
    hole = gt.spaces.load("schwarzschild").frame
    radius = hole.coordinates[1]
    mass = hole.parameters[0]
    v = sp.Symbol("v")
    tortoise = radius + 2 * mass * sp.log(radius / (2 * mass) - 1)
    falling = hole.in_coordinates(["v", *map(str, hole.coordinates[1:])], {"t": v - tortoise})
    assert falling.metric[0, 1] == 1
    assert falling.metric[1, 1] == 0
    assert gt.levi_civita(falling).curvature.ricci.is_zero
    rho = sp.Symbol("rho", positive=True)
    own = hole.in_coordinates(
        ["t", "rho", "theta", "phi"],
        {"r": rho * (1 + mass / (2 * rho)) ** 2},
        domain=[rho > mass / 2],
    )
    assert sp.simplify(own.metric[1, 1] - (1 + mass / (2 * rho)) ** 4) == 0
    back = own.in_coordinates(
        hole.coordinates, {"rho": (radius - mass + sp.sqrt(radius**2 - 2 * mass * radius)) / 2}
    )
    assert back.scalar(back.metric[0, 0]) == 2 * mass / radius - 1
    given_ = (["t", "rho", "theta", "phi"], {"r": rho * (1 + mass / (2 * rho)) ** 2})
    size = gt.levi_civita(hole).curvature.kretschmann
    moved = size.in_coordinates(*given_, domain=[rho > mass / 2])
    assert moved == gt.levi_civita(own).curvature.kretschmann


MAPS = [
    lambda q: {q[0]: q[0] + 2 * q[1], q[1]: q[1]},
    lambda q: {q[0]: q[1], q[1]: q[0]},
    lambda q: {q[0]: q[0] * sp.exp(q[1]), q[1]: q[1]},
    lambda q: {q[0]: q[0], q[1]: q[1] + q[0] ** 2},
]


def test_tensors_of_any_connection_go_along() -> None:
    """Torsion and curvature of the changed connection are the changed torsion and curvature."""

    @few
    @given(connections(largest=3), st.sampled_from(MAPS))
    def law(connection: gt.Connection, make) -> None:
        frame = connection.frame
        given = (frame.coordinates, make(frame.coordinates))
        changed = connection.in_coordinates(*given)
        assert changed.frame is frame.in_coordinates(*given)
        assert connection.torsion.T.in_coordinates(*given) == changed.torsion.T
        curvature = connection.curvature.riemann
        assert changed.curvature.riemann == curvature.in_coordinates(*given)
        assert changed.nonmetricity == connection.nonmetricity.in_coordinates(*given)
        # The legs are the same, so that frame components keep their values at each point.
        mixed = connection.torsion.T.in_frame()
        assert changed.torsion.T.in_frame() == mixed.in_coordinates(*given)

    law()


def test_frames_made_from_metric_and_legs() -> None:
    """A frame made from a metric keeps its shape, legs go through the coframe; parameters stay."""
    k = sp.Symbol("k", positive=True)
    cone = gt.Frame.from_metric([x, y], [[1 + k * y**2, 0], [0, 1]], domain=[y > 0])
    moved = cone.in_coordinates([r, phi], POLAR, domain=[r > 0])
    assert moved.shape == "metric"
    assert moved.parameters == (k,)
    assert moved.domain == (r * sp.sin(phi) > 0,)
    one = gt.levi_civita(cone).curvature.scalar.in_coordinates([r, phi], POLAR, [r > 0])
    assert one == gt.levi_civita(moved).curvature.scalar
    given = gt.cartan(cone).in_coordinates([r, phi], POLAR, [r > 0])
    assert given.is_flat
    assert gt.cartan(cone).torsion.T.in_coordinates([r, phi], POLAR, [r > 0]) == given.torsion.T
    legs = gt.Frame.from_frame([x, y], [[1, y], [0, 1]])
    assert legs.in_coordinates([z, w], [z + w, w]).metric[0, 0] == 1


def test_unknown_functions_by_name() -> None:
    """frame.subs({"Y": 0}) works where the frame contains Y(r) or only its derivative."""
    Y = sp.Function("Y")(r)
    frame = gt.Frame([t, r], [[1 + Y, 0], [Y.diff(r), 1]])
    assert frame.subs({"Y": 0}).coframe.nonzero() == {(0, 0): 1, (1, 1): 1}
    assert frame.subs({"Y": "r**2"}) is frame.subs({Y: r**2})
    assert frame.subs({sp.Function("Y"): r}).coframe[1, 0] == 1
    assert gt.cartan(frame).torsion.subs({"Y": 0}).S.is_zero
    slope = gt.Frame([t, r], [[1, Y.diff(r)], [0, 1]])
    assert slope.subs({"Y": "3*r"}).coframe[0, 1] == 3
    two = gt.Frame([t, r], [[1 + Y, sp.Function("Y")(t)], [0, 1]])
    with pytest.raises(GeomtorsionError, match=r"got Y\(r\), Y\(t\)"):
        two.subs({"Y": 0})


def test_spin_connection_in_other_slots() -> None:
    """The first slot is the direction (coordinate or leg); the other two have either order."""
    frame = gt.Frame([x, y], [[1, x], [0, 1 + y**2]])
    bar = gt.levi_civita(frame)
    omega = bar.spin_connection
    get = omega.components.get
    book = gt.Tensor(frame, "dUD", lambda i: get((i[0], i[2], i[1])))
    for given_ in (omega, omega.in_frame(), omega.lowered(2), book):
        made = gt.from_spin_connection(frame, given_)
        assert made.coefficients == bar.coefficients
    with pytest.raises(GeomtorsionError, match="slots"):
        gt.from_spin_connection(frame, frame.metric)


REFUSALS = [
    (lambda: PLANE.in_coordinates([r], {x: r, y: r}), "expected 2, got 1"),
    (lambda: PLANE.in_coordinates([r, phi], {x: r}), "an expression for y"),
    (lambda: PLANE.in_coordinates([r, phi], {"z": r}), "names of coordinates"),
    (
        lambda: PLANE.in_coordinates([r, phi], [r]),
        "one for each of 2 coordinates x, y, got 1",
    ),
    (lambda: PLANE.in_coordinates([r, phi], [r, r]), "singular"),
    (lambda: PLANE.in_coordinates([r, r], [r, r]), "repeated"),
    (lambda: PLANE.in_coordinates([r, phi], ["r*q", "phi"]), "q is neither"),
    (
        lambda: gt.Frame([x, y], sp.eye(2), domain=[x > 0]).in_coordinates([z, y], {x: -1 - z**2}),
        "does not hold",
    ),
    (
        lambda: gt.cartan(PLANE).coefficients.in_coordinates([r, phi], POLAR),
        "connection.in_coordinates",
    ),
]


@pytest.mark.parametrize(("call", "words"), REFUSALS)
def test_anything_but_a_change_of_coordinates_is_refused(call, words):
    """Each bad change of coordinates is refused with its own message."""
    with pytest.raises(GeomtorsionError, match=words):
        call()


def test_chosen_roots_stay_chosen_in_other_coordinates():
    """sqrt(x^2) = -x remains so in the coordinate u = x - 1, also where x is positive."""
    x, u, y = sp.symbols("x u y", real=True)
    root = sp.sqrt(x**2)
    frame = gt.Frame([x, y], [[1, 0], [0, 2 + root]], branches={root: -x})
    moved = frame.in_coordinates([u, y], {x: u + 1})
    assert sp.simplify(moved.coframe[1, 1] - (1 - u)) == 0
