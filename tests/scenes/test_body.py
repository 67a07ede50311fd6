"""Bodies: moments of shapes agree with integrals over their mass; impossible bodies are refused."""

# The tests pass bad input and arrays for lists, and use results that could be None.
# pyright: reportArgumentType=false, reportGeneralTypeIssues=false, reportOptionalSubscript=false

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geomtorsion.errors import BodyError
from geomtorsion.scenes import Body
from tests.rounding import ROUNDED


def integrated(points, weights):
    """The inertia tensor of a cloud of points about the origin."""
    square = (points**2).sum(1)
    outer = np.einsum("k,ki,kj->ij", weights, points, points)
    return np.eye(3) * (weights * square).sum() - outer


def gauss(a, b, n=8):
    x, w = np.polynomial.legendre.leggauss(n)
    return (b - a) / 2 * x + (a + b) / 2, (b - a) / 2 * w


def axis_of(body):
    axis = body.symmetry_axis
    return None if axis is None else axis.tolist()


def cloud(kind):
    """Quadrature points of a body of mass 1 and sizes 1, 2, 3, exact for quadratic functions."""
    if kind == "box":
        (x, u), (y, v), (z, w) = gauss(-0.5, 0.5), gauss(-1, 1), gauss(-1.5, 1.5)
        points = np.stack(np.meshgrid(x, y, z, indexing="ij"), -1).reshape(-1, 3)
        return points, np.einsum("i,j,k->ijk", u, v, w).ravel() / 6
    t, w = np.linspace(0, 2 * np.pi, 16, endpoint=False), np.full(16, 2 * np.pi / 16)
    if kind == "cylinder":
        (r, u), (z, v) = gauss(0, 2), gauss(-1.5, 1.5)
        r, t, z = (a.ravel() for a in np.meshgrid(r, t, z, indexing="ij"))
        weights = np.einsum("i,j,k->ijk", u, w, v).ravel() * r
        points = np.stack([r * np.cos(t), r * np.sin(t), z], -1)
        return points, weights / (np.pi * 4 * 3)
    (r, u), (c, v) = gauss(0, 1), gauss(-1, 1)
    r, c, t = (a.ravel() for a in np.meshgrid(r, c, t, indexing="ij"))
    weights = np.einsum("i,j,k->ijk", u, v, w).ravel() * r**2
    s = np.sqrt(1 - c**2)
    points = np.stack([r * s * np.cos(t), 2 * r * s * np.sin(t), 3 * r * c], -1)
    return points, weights / (4 * np.pi / 3)


@pytest.mark.parametrize(
    ("kind", "body"),
    [
        ("box", Body.box(1.0, (1, 2, 3))),
        ("cylinder", Body.cylinder(1.0, 2, 3)),
        ("ellipsoid", Body.ellipsoid(1.0, (1, 2, 3))),
    ],
)
def test_shapes(kind, body):
    points, weights = cloud(kind)
    assert weights.sum() == pytest.approx(1, rel=ROUNDED)
    assert np.abs(body.tensor - integrated(points, weights)).max() < 1e-13


def test_equal_sides_give_equal_moments():
    """A cube with sides that are not binary fractions is still a spherical top."""
    one, two, three = Body.box(0.7, (0.1, 0.1, 0.1)).moments
    assert one == two == three
    assert axis_of(Body.cylinder(0.3, 0.1, 0.7)) == [0, 0, 1]


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    st.lists(
        st.tuples(st.floats(0.1, 9), *[st.floats(-5, 5).map(lambda x: round(x, 3))] * 3),
        min_size=4, max_size=9,
    )
)  # fmt: skip
def test_points(masses):
    """Any cloud gives a tensor that passes the checks and agrees with NumPy about its centre."""
    weights = np.array([m[0] for m in masses])
    places = np.array([m[1:] for m in masses])
    places = places - weights @ places / weights.sum()
    expected = integrated(places, weights)
    if np.linalg.eigvalsh(expected)[0] < 1e-6:
        return
    body = Body.points([(m, (x, y, z)) for m, x, y, z in masses])
    assert body.mass == pytest.approx(weights.sum(), rel=ROUNDED)
    assert np.abs(body.tensor - expected).max() <= 1e-13 * np.abs(expected).max()


def test_principal_axes():
    """Rotated axes are found, as a rotation, with moments in ascending order."""
    rng = np.random.default_rng(3)
    for _ in range(20):
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        body = Body(1.0, inertia=turn @ np.diag([3.0, 1.0, 2.5]) @ turn.T)
        assert np.allclose(body.principal_moments, [1, 2.5, 3], rtol=ROUNDED)
        axes = body.principal_axes
        assert np.linalg.det(axes) == pytest.approx(1, abs=ROUNDED)
        again = axes @ np.diag(body.principal_moments) @ axes.T
        assert np.abs(again - body.tensor).max() < ROUNDED
    ordered = Body(moments=(3, 1, 2))
    assert ordered.principal_moments.tolist() == [1, 2, 3]
    assert np.abs(ordered.principal_axes).tolist() == [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    assert np.linalg.det(ordered.principal_axes) == 1


def test_axis_of_symmetry():
    assert axis_of(Body(moments=(1, 2, 3))) is None
    assert axis_of(Body(moments=(1, 1, 1))) == [0, 0, 1]
    assert axis_of(Body(moments=(2, 1, 1))) == [1, 0, 0]
    assert axis_of(Body(moments=(1, 1, 1 + 1e-12))) == [0, 0, 1]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (Body, "got neither"),
        (lambda: Body(moments=(1, 1, 1), inertia=np.eye(3)), "got both"),
        (lambda: Body(mass=-1, moments=(1, 1, 1)), "mass: expected a positive number .kg., got -1"),
        (lambda: Body(mass="heavy", moments=(1, 1, 1)), "a positive number .kg., got 'heavy'"),
        (lambda: Body(moments=(1, 1)), "three principal moments"),
        (lambda: Body(moments=5), "three principal moments"),
        (lambda: Body(moments=(1, 0, 1)), "moments\\[1\\]: expected a positive number"),
        (lambda: Body(moments=(1, float("nan"), 1)), "moments\\[1\\]: .* finite number, got nan"),
        (lambda: Body(moments=(1, 2, 3.1)), "impossible, because 3.1 > 1 \\+ 2"),
        (lambda: Body(inertia=[[1, 2], [3, 4]]), "3 rows of 3 numbers"),
        (
            lambda: Body(inertia=[[1, 0.5, 0], [0.4, 1, 0], [0, 0, 1]]),
            "expected a symmetric matrix, got \\[0",
        ),
        (lambda: Body(inertia=-np.eye(3)), "expected positive principal moments"),
        (lambda: Body(inertia=np.diag([1.0, 1, np.inf])), "inertia\\[2, 2\\] = inf is not finite"),
        (lambda: Body(inertia=[[1, 0.9, 0], [0.9, 1, 0], [0, 0, 1]]), "impossible, because 1.9"),
        (lambda: Body(inertia=np.diag([1.0, 1, 5])), "impossible, because 5 > 1 \\+ 1"),
        (lambda: Body.box(1, (1, 0, 1)), "sides\\[1\\]: expected a positive number .m., got 0"),
        (lambda: Body.box(1, (1, 1)), "three lengths"),
        (lambda: Body.cylinder(1, 1, -2), "height: expected a positive number .m."),
        (lambda: Body.points([]), "at least one"),
        (lambda: Body.points([(1, (0, 0, 0)), (1, (1, 2, 3))]), "got all on one line"),
        (lambda: Body.points([(-1, (0, 0, 0))]), "mass 0: expected a positive number .kg., got -1"),
        (lambda: Body.points([1, 2]), "a list of \\(mass"),
    ],
)  # fmt: skip
def test_bodies_that_cannot_be(make, words):
    with pytest.raises(BodyError, match=words):
        make()


def test_a_plate_is_just_possible():
    """I3 = I1 + I2 is accepted, even when rounding puts it on the wrong side."""
    assert Body(moments=(0.1, 0.2, 0.1 + 0.2)).mass == 1.0
    assert Body.cylinder(3.0, 0.1, 0).moments[2] == pytest.approx(0.015)


def test_how_much_rounding_a_body_may_have():
    """A + B = C may fail by 0.9e-12 but not by 1.1e-12; likewise the symmetry of I12."""
    assert Body(moments=(1, 1, 2 * (1 + 0.9e-12))).moments
    with pytest.raises(BodyError, match="impossible"):
        Body(moments=(1, 1, 2 * (1 + 1.1e-12)))
    tensor = np.diag([1.0, 1, 1])
    tensor[0, 1] = 0.9e-12
    assert Body(inertia=tensor).tensor[1, 0] == 0.9e-12
    tensor[0, 1] = 1.1e-12
    with pytest.raises(BodyError, match="expected a symmetric matrix"):
        Body(inertia=tensor)
