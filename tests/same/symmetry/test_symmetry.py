"""Symmetry: dimensions for known spaces, exact vectors, good and bad tetrads."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import HealthCheck, given, settings

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError
from geomtorsion.same import IntegratedSymmetry
from tests.laws.frames import frames

t, x, y, z, r, theta, phi = sp.symbols("t x y z r theta phi", positive=True)
a = sp.Function("a")(t)
S = sp.sin(theta)


def diagonal(symbols: list, *entries: sp.Expr) -> gt.Frame:
    """A diagonal coframe with the signature (-+++)."""
    return gt.Frame(symbols, sp.diag(*entries), signature=(-1, 1, 1, 1))


def shipped(name: str) -> gt.Frame:
    """The frame of a shipped space."""
    return gt.spaces.load(name).frame


SPHERICAL = diagonal([t, r, theta, phi], 1, a, a * r, a * r * S)
CARTESIAN = diagonal([t, x, y, z], 1, a, a, a)
FLAT = diagonal([t, x, y, z], 1, 1, 1, 1)
BALL = diagonal([t, r, theta, phi], 1, 1, r, r * S)

u, v, H = sp.symbols("u v H", positive=True)
ELLIPTIC = gt.Frame([u, v], sp.eye(2) * sp.sqrt(sp.sinh(u) ** 2 + sp.sin(v) ** 2))
PARABOLIC = gt.Frame([u, v], sp.eye(2) * sp.sqrt(u**2 + v**2))
SPACE = gt.Frame([r, u, theta, phi], sp.diag(1, r, r * sp.sin(u), r * sp.sin(u) * S))

# Frame, invariant quantity, dimension, dimension of the orbits, number of vectors found.
KNOWN = {
    "Minkowski": (FLAT, "metric", 10, 4, 10),
    "Minkowski, spherical": (BALL, "metric", 10, 4, 10),
    "de Sitter, static": (shipped("de_sitter"), "metric", 10, 4, 10),
    "de Sitter, flat slices": (
        diagonal([t, x, y, z], 1, *[sp.exp(H * t)] * 3),
        "metric",
        10,
        4,
        10,
    ),
    "four dimensions, spherical": (SPACE, "metric", 10, 4, 10),
    "plane, elliptic": (ELLIPTIC, "metric", 3, 2, 3),
    "plane, parabolic": (PARABOLIC, "metric", 3, 2, 3),
    "seven-sphere": (shipped("s7"), "metric", 28, 7, 28),
    "FLRW": (CARTESIAN, "metric", 6, 3, 6),
    "FLRW, spherical": (SPHERICAL, "metric", 6, 3, 6),
    "FLRW, good tetrad": (CARTESIAN, "teleparallel", 6, 3, 6),
    "FLRW, bad tetrad": (SPHERICAL, "teleparallel", 1, 1, 1),
    "Schwarzschild": (shipped("schwarzschild"), "metric", 4, 3, 4),
    "static tetrad": (shipped("schwarzschild"), "teleparallel", 2, 2, 2),
    "Kerr": (shipped("kerr"), "metric", 2, 2, 2),
    "Kerr, null tetrad": (shipped("kerr_kinnersley"), "metric", 2, 2, 2),
    "S3": (shipped("s3"), "metric", 6, 3, 6),
    "so3": (shipped("so3"), "metric", 6, 3, 6),
    # Rotations from the left and from the right keep its torsion.
    "so3, parallel legs": (shipped("so3"), "teleparallel", 6, 3, 6),
    "Goedel": (shipped("goedel"), "metric", 5, 4, 5),
    "Heisenberg": (shipped("heisenberg"), "metric", 4, 3, 4),
    "Heisenberg, parallel legs": (shipped("heisenberg"), "teleparallel", 4, 3, 4),
    "Sol": (shipped("sol"), "metric", 3, 3, 3),
    "half plane": (gt.Frame([x, y], sp.diag(1 / y, 1 / y)), "metric", 3, 2, 3),
    "hyperbolic plane": (gt.Frame([r, phi], sp.diag(1, sp.sinh(r))), "metric", 3, 2, 3),
    "a line": (gt.Frame([x], [[1 + x**2]]), "metric", 1, 1, 1),
    "none": (gt.Frame([x, y], [[1, x * y], [0, 1 + x**3 + y]]), "metric", 0, 0, 0),
}


@pytest.mark.parametrize("name", KNOWN)
def test_known_dimensions(name: str) -> None:
    """Killing vectors of the metric, and those that also keep the connection of the tetrad."""
    frame, keep, dimension, orbits, count = KNOWN[name]
    found = gt.symmetries(frame, keep)
    assert found.dimension == dimension
    assert found.orbits == orbits
    assert found.isotropy == dimension - orbits
    assert found.ranks[-1] == found.ranks[-2]
    assert len(found.vectors) == count
    for xi in found.vectors:
        assert gt.lie(xi, frame).is_zero
        assert gt.lie(xi, found.connection).is_zero


def test_vectors_form_an_algebra() -> None:
    """Brackets of the Killing vectors of Schwarzschild are Killing; they span three directions."""
    frame = shipped("schwarzschild")
    vectors = gt.symmetries(frame).vectors
    for one in vectors:
        for two in vectors:
            assert gt.lie(gt.lie_bracket(frame, one, two), frame).is_zero
    point = {"t": 1, "r": 5, "theta": 1, "phi": 2}
    rows = sp.Matrix([one.at(point).tolist() for one in vectors])
    assert rows.rank(iszerofunc=lambda value: abs(value) < 1e-12) == 3


def test_a_connection_over_a_flat_metric() -> None:
    """T_12^3 = 1 keeps the translations and the rotation about z; Gamma_00^0 = x keeps fewer."""
    torsion = [[[0] * 4 for _ in range(4)] for _ in range(4)]
    torsion[1][2][3], torsion[2][1][3] = 1, -1
    found = gt.symmetries(FLAT, gt.from_torsion(FLAT, torsion))
    assert (found.dimension, len(found.vectors)) == (5, 5)
    assert "connection from torsion" in str(found)
    coefficients = [[[0] * 4 for _ in range(4)] for _ in range(4)]
    coefficients[0][0][0] = x
    # Translations along t, y, z and the rotation about x.
    assert gt.symmetries(FLAT, gt.from_coefficients(FLAT, coefficients)).dimension == 4
    assert gt.symmetries(FLAT, gt.levi_civita(FLAT)).dimension == 10


def test_dimension_does_not_depend_on_the_legs() -> None:
    """A rotated tetrad has the dimension of its metric; S7 has 28."""
    assert gt.symmetries(shipped("s7")).dimension == 28
    turned = gt.Frame([x, y], [[sp.cos(x * y), -sp.sin(x * y)], [sp.sin(x * y), sp.cos(x * y)]])
    assert gt.symmetries(turned).dimension == 3
    # Its angle is constant only on the hyperbolas x y = const, which no motion of the plane keeps.
    assert gt.symmetries(turned, keep="teleparallel").dimension == 0


@settings(
    max_examples=10, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
@given(frames(largest=3))
def test_no_more_vectors_than_dimensions(frame: gt.Frame) -> None:
    """All symmetries have vectors; legs keep no more than the metric."""
    metric, legs = gt.symmetries(frame), gt.symmetries(frame, keep="teleparallel")
    assert len(metric.closed_form) <= len(metric.vectors) == metric.dimension
    assert len(legs.vectors) == legs.dimension <= metric.dimension
    assert 0 <= metric.orbits <= frame.dimension


KASNER = diagonal([t, x, y, z], 1, *[t**p for p in sp.sympify("[6/7, 3/7, -2/7]")])
PLANE_WAVE = shipped("pp_wave").subs({"H": "x**2 - y**2"})

# Frame, dimension of homotheties and of conformal vectors, number of conformal ones in closed form,
# name of the conformal algebra.
SCALED = {
    "Minkowski": (FLAT, 11, 15, 15, "so(4, 2)"),
    "Minkowski, spherical": (BALL, 11, 15, 15, "so(4, 2)"),
    "de Sitter": (shipped("de_sitter"), 10, 15, 15, "so(4, 2)"),
    "S3": (shipped("s3"), 6, 10, 10, "so(4, 1)"),
    "Schwarzschild": (shipped("schwarzschild"), 4, 4, 4, "so(3) + R"),
    "Kasner": (KASNER, 4, 4, 4, "solvable algebra of dimension 4, derived series 4, 3, 0"),
    "plane wave": (
        PLANE_WAVE, 7, 7, 7, "solvable algebra of dimension 7, derived series 7, 5, 1, 0",
    ),
    "FLRW": (CARTESIAN, 6, 15, 6, "so(4, 2)"),
    "Heisenberg": (shipped("heisenberg"), 4, 4, 4, "oscillator algebra"),
}  # fmt: skip


@pytest.mark.parametrize("name", SCALED)
def test_homotheties_and_conformal_vectors(name: str) -> None:
    """Dimensions of known spaces; each vector changes the metric by a factor, which is checked."""
    frame, homotheties, conformal, count, algebra = SCALED[name]
    assert gt.symmetries(frame, "homothetic").dimension == homotheties
    found = gt.symmetries(frame, "conformal")
    assert (found.dimension, len(found.closed_form)) == (conformal, count)
    assert found.algebra.name == algebra
    n, bar = frame.dimension, gt.levi_civita(frame)
    for xi in found.closed_form:
        factor = bar.divergence(xi)[()] * sp.Rational(2, n)
        assert (gt.lie(xi, frame) - frame.metric * factor).is_zero


@pytest.mark.parametrize("name", ["Minkowski", "S3", "Kasner"])
def test_brackets_of_conformal_vectors(name: str) -> None:
    """[xi_i, xi_j] = C_ij^k xi_k holds exactly for conformal vectors as well."""
    frame = SCALED[name][0]
    found = gt.symmetries(frame, "conformal")
    constants = found.algebra.structure_constants
    vectors = found.closed_form
    for i in range(0, len(vectors), 2):
        for j in range(i + 1, len(vectors)):
            total = gt.lie_bracket(frame, vectors[i], vectors[j])
            for k, xi in enumerate(vectors):
                if constants[i, j, k]:
                    total = total - xi * constants[i, j, k]
            assert total.is_zero


def test_an_integrated_conformal_vector() -> None:
    """A conformal vector of the group manifold S3 satisfies its equation, by differences."""
    frame = shipped("so3")
    found = gt.symmetries(frame, "conformal")
    assert (found.dimension, len(found.closed_form)) == (10, 6)
    one = found.vectors[-1]
    assert isinstance(one, IntegratedSymmetry)
    names = [q.name for q in frame.coordinates]
    start = np.array([0.4, 1.1, 0.3])
    h = 1e-3

    def at(q: np.ndarray) -> np.ndarray:
        return one.at(dict(zip(names, q.tolist(), strict=True)), accuracy=1e-12)

    slope = np.array([(at(start + h * e) - at(start - h * e)) / (2 * h) for e in np.eye(3)])
    place = dict(zip(names, start.tolist(), strict=True))
    g, gamma = frame.metric.at(place), gt.levi_civita(frame).coefficients.at(place)
    lower = (slope + np.einsum("abc,b->ac", gamma, at(start))) @ g
    symmetric = lower + lower.T
    phi = np.trace(np.linalg.solve(g, symmetric)) / 3
    assert abs(phi) > 1e-2
    assert np.abs(symmetric - phi * g).max() < 1e-4 * np.abs(lower).max()


# x + i y = (u + i v)^5: too high a power for the products that are searched.
FIFTH_POWER = gt.Frame([u, v], sp.eye(2) * 5 * (u**2 + v**2) ** 2)


def test_report() -> None:
    """The report has dimensions, algebra and vectors, and the functions that were searched."""
    text = repr(gt.symmetries(BALL))
    assert text.startswith("10 symmetries of the metric, orbits of dimension 4\nalgebra: iso(3, 1)")
    assert "\nvectors:\n  [1, 0, 0, 0]\n" in text
    assert "searched" not in text
    text = str(gt.symmetries(FIFTH_POWER))
    assert "1 of 3 vectors have a closed form here:\n  [-v, u]\n" in text
    assert "searched: components along coordinates or legs" in text
    assert "e(2)" in gt.symmetries(FIFTH_POWER)._repr_html_()


def test_integrated_vectors() -> None:
    """Vectors without a closed form agree with the motions of the plane to their error."""
    found = gt.symmetries(FIFTH_POWER)
    assert len(found.closed_form) == 1
    assert found.algebra.name == "e(2)"
    points = [complex(1, 0.2), complex(0.8, 0.5), complex(1.1, 0.7), complex(2, 1)]
    for one in found.vectors[1:]:
        assert isinstance(one, IntegratedSymmetry)
        rows, right, largest = [], [], 0.0
        for w in points:
            vector, error = one.with_error({"u": w.real, "v": w.imag})
            assert np.array_equal(vector, one.at({u: w.real, v: w.imag}))
            z, slope = w**5, 5 * w**4
            image = slope * complex(*vector)
            rows += [[1, 0, -z.imag], [0, 1, z.real]]
            right += [image.real, image.imag]
            largest = max(largest, error * abs(slope))
        motion, *_ = np.linalg.lstsq(np.array(rows), np.array(right), rcond=None)
        assert np.abs(motion).max() > 1e-4
        assert np.abs(np.array(rows) @ motion - right).max() <= 2 * largest


def test_an_integrated_vector_with_parameters() -> None:
    """Parameters take their values from the point; a missing one is named."""
    k = sp.Symbol("k", positive=True)
    frame = gt.Frame([u, v], sp.eye(2) * 5 * k * (u**2 + v**2) ** 2)
    one = gt.symmetries(frame).vectors[1]
    assert isinstance(one, IntegratedSymmetry)
    place = {"u": 1, "v": 0.5}
    # A constant factor changes no symmetry.
    assert np.allclose(one.at(place | {"k": 1}), one.at(place | {"k": 3}), rtol=1e-8)
    with pytest.raises(GeomtorsionError, match="k"):
        one.at(place)
    # For k = 0 the plane is flat, and has more symmetries.
    x_of_w = sp.expand(sp.re(sp.expand((u + sp.I * v) ** 5)))
    fold = sp.sqrt(1 + sp.Symbol("k", real=True) * x_of_w**2)
    folded = gt.Frame([u, v], sp.eye(2) * 5 * (u**2 + v**2) ** 2 * fold)
    shift = gt.symmetries(folded).vectors[0]
    assert isinstance(shift, IntegratedSymmetry)
    assert np.isfinite(shift.at(place | {"k": 1})).all()
    with pytest.raises(GeomtorsionError, match="frame.subs"):
        shift.at(place | {"k": 0})
    with pytest.raises(GeomtorsionError, match="v"):
        one.at({"u": 1, "k": 1})


def test_killing_equations() -> None:
    """A rotation about a horizontal axis solves the Killing equations of the sphere."""
    sphere = shipped("s2")
    q = sphere.coordinates
    equations = gt.same.killing_equations(sphere)
    assert len(equations) == 3
    names = [sp.Function(f"xi^{one.name}")(*q) for one in q]
    turn = dict(zip(names, (sp.sin(q[1]), sp.cos(q[1]) * sp.cot(q[0])), strict=True))
    for one in equations:
        assert sp.simplify(one.lhs.subs(turn).doit()) == 0


REFUSALS = [
    (lambda: gt.symmetries(CARTESIAN, "metrics"), "metric"),
    (lambda: gt.symmetries(CARTESIAN, gt.cartan(SPHERICAL)), "over the frame"),
    (lambda: gt.symmetries(shipped("s2"), "conformal"), "infinitely many"),
    (lambda: gt.symmetries(3), "frame"),  # pyright: ignore[reportArgumentType]
]


@pytest.mark.parametrize(("call", "words"), REFUSALS)
def test_bad_arguments_of_symmetries_are_refused(call, words):
    """Each bad argument is refused with its own message."""
    with pytest.raises(GeomtorsionError, match=words):
        call()
