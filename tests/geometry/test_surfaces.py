"""Surfaces: induced metric, normal and extrinsic curvature against textbooks and Gauss."""

from itertools import product

import pytest
import sympy as sp
from hypothesis import HealthCheck, given, settings

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError
from tests.laws.frames import frames

x, y, z, t = sp.symbols("x y z t", real=True)
u, v = sp.symbols("u v", real=True)
R = sp.Symbol("R", positive=True)
SPACE = gt.Frame([x, y, z], sp.eye(3))
MINKOWSKI = gt.Frame([t, x, y, z], sp.eye(4), signature=(-1, 1, 1, 1))
HOLE = gt.spaces.load("schwarzschild").frame


def test_tube_around_a_black_hole() -> None:
    """r = const: K_tt = -M sqrt(f)/r^2, K_theta theta = r sqrt(f), K_phi phi with sin^2."""
    tube = gt.surface(HOLE, "t theta phi")
    _, r, theta, _ = HOLE.coordinates
    (M,) = HOLE.parameters
    f = 1 - 2 * M / r
    over = tube.frame
    assert tube.metric[0, 0] == -(r - 2 * M) / r
    K = tube.extrinsic_curvature
    assert over.scalar(K[0, 0]) == -M * sp.sqrt(f) / r**2
    assert over.scalar(K[1, 1]) == r * sp.sqrt(f)
    assert over.scalar(K[2, 2]) == r * sp.sqrt(f) * sp.sin(theta) ** 2
    assert set(K.nonzero()) == {(0, 0), (1, 1), (2, 2)}
    assert over.scalar(tube.normal[1]) == sp.sqrt(f)
    assert tube.normal_sign == 1
    other = gt.surface(HOLE, "t theta phi", {"r": R}, orientation=-1)
    assert other.frame.scalar(other.extrinsic_curvature[1, 1]) == -R * sp.sqrt(1 - 2 * M / R)


def test_slice_of_constant_time() -> None:
    """A static slice has no extrinsic curvature and a timelike normal; a universe expands."""
    slice_ = gt.surface(HOLE, "r theta phi")
    assert slice_.extrinsic_curvature.is_zero
    assert slice_.normal_sign == -1
    a = sp.Function("a")(t)
    universe = gt.Frame([t, x, y, z], sp.diag(1, a, a, a), signature=(-1, 1, 1, 1))
    now = gt.surface(universe, "x y z")
    # n_t is positive: the normal points to the past, and volumes shrink along it.
    slope = now.frame.scalar(now.mean_curvature[()])
    assert slope == -3 * a.diff(t) / a


def test_sphere_torus_and_curve() -> None:
    """The sphere has mean curvature 2/R, the torus both signs of curvature; a helix in space."""
    s, c = sp.sin(u), sp.cos(u)
    ball = gt.surface(
        SPACE,
        [u, v],
        [R * s * sp.cos(v), R * s * sp.sin(v), R * c],
        domain=[u > 0, u < sp.pi / 2, v > 0, v < sp.pi / 2],
    )
    assert ball.mean_curvature == 2 / R
    assert ball.extrinsic_curvature == ball.metric / R
    assert gt.levi_civita(ball.frame).curvature.scalar == 2 / R**2
    torus = gt.surface(
        SPACE, [u, v], [(R + 2 + c) * sp.cos(v), (R + 2 + c) * sp.sin(v), s], domain=[u > 0, v > 0]
    )
    scalar = gt.levi_civita(torus.frame).curvature.scalar
    assert scalar == 2 * c / (R + 2 + c)
    helix = gt.surface(SPACE, [u], [sp.cos(u), sp.sin(u), 2 * u])
    assert helix.metric[0, 0] == 5
    with pytest.raises(GeomtorsionError, match="only a hypersurface"):
        _ = helix.normal
    assert repr(helix) == "surface (u): x = cos(u), y = sin(u), z = 2*u"


def test_pullback_of_forms_and_tensors() -> None:
    """The pullback commutes with d and wedge; the helicoid is minimal."""
    sheet = gt.surface(SPACE, [u, v], [u * sp.cos(v), u * sp.sin(v), v])
    one = gt.Form(SPACE, 1, {0: -y, 1: x * z, 2: z})
    two = gt.Form(SPACE, 1, {0: z, 2: x * y})
    assert sheet.pullback(one).d == sheet.pullback(one.d)
    assert sheet.pullback(one ^ two) == sheet.pullback(one) ^ sheet.pullback(two)
    assert sheet.pullback(gt.Form.of(SPACE.epsilon)).is_zero
    assert sheet.pullback(SPACE.metric) == sheet.metric
    assert sheet.pullback(SPACE.scalar(x**2 + y**2))[()] == u**2
    # Minimal surface: the mean curvature vanishes.
    assert sheet.mean_curvature.is_zero
    assert sheet.extrinsic_curvature.is_zero is False


def test_equation_of_gauss() -> None:
    """Gauss: R_abcd of the surface is R_abcd of the space plus squares of K, on random frames."""

    @settings(
        max_examples=8,
        deadline=None,
        derandomize=True,
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
    )
    @given(frames(smallest=3, largest=3))
    def law(frame: gt.Frame) -> None:
        q = frame.coordinates
        inside = gt.surface(frame, [q[0], q[1]], {q[2]: q[0] / 2 + 3})
        own = gt.levi_civita(inside.frame).curvature.lower
        around = inside.pullback(gt.levi_civita(frame).curvature.lower)
        K, sign = inside.extrinsic_curvature, inside.normal_sign
        for a, b, c, d in product(range(2), repeat=4):
            # The last two indices have the order of R_mnlk in this package.
            squares = K.element(a, d) * K.element(b, c) - K.element(a, c) * K.element(b, d)
            left = own.element(a, b, c, d) - around.element(a, b, c, d)
            assert left == squares * sign

    law()


REFUSALS = [
    (lambda: gt.surface(SPACE, [x, y, z]), "fewer than 3"),
    (lambda: gt.surface(SPACE, [u, v], {"w": u}), "names of coordinates"),
    (lambda: gt.surface(SPACE, [u, v], [u, v, 0], orientation=0), "orientation"),
    (lambda: gt.surface(MINKOWSKI, [u], [u, u, 0, 0]).metric, "metric"),
    (lambda: gt.surface(MINKOWSKI, [u, x, y], {"t": u, "z": u}).frame, "degenerate"),
    (lambda: gt.surface(SPACE, [x, y]).pullback(MINKOWSKI.metric), "over another"),
    (lambda: gt.surface(SPACE, [x, y]).pullback(SPACE.inverse_metric), "lower indices"),
    (lambda: gt.surface(SPACE, [x, y]).pullback(SPACE.coframe_form()), "scalar-valued"),
]


@pytest.mark.parametrize(("call", "words"), REFUSALS)
def test_anything_but_a_surface_is_refused(call, words):
    """Each bad surface or argument is refused with its own message."""
    with pytest.raises(GeomtorsionError, match=words):
        call()
