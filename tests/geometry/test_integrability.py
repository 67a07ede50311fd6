"""Integrability: parallel volumes and transposed connections, against their definitions."""

from __future__ import annotations

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError, UndecidedError

t, x, y, z = sp.symbols("t x y z", real=True)
Theta = sp.Function("Theta")(t, x)
FLAT = gt.Frame([t, x, y, z], sp.eye(4), signature=(-1, 1, 1, 1))
BENT = gt.Frame([x, y, z], [[1 + y**2, 0, x], [0, 1, z], [0, 0, 1]], (-1, 1, 1))
HALF = sp.Rational(1, 2)


def with_vector(frame: gt.Frame, vector: list[sp.Expr]) -> gt.Connection:
    """The metric connection whose torsion is T_ab^c = (v_a delta_b^c - v_b delta_a^c) / (n - 1)."""
    n = frame.dimension
    d = sp.KroneckerDelta
    share = HALF / (n - 1)
    torsion = [
        [[share * (vector[a] * d(b, c) - vector[b] * d(a, c)) for c in range(n)] for b in range(n)]
        for a in range(n)
    ]
    return gt.from_torsion(frame, torsion)


def general(frame: gt.Frame, trace: list[sp.Expr]) -> gt.Connection:
    """A connection that is not metric: the Cartan connection and a change with this trace."""
    n = frame.dimension
    change = [
        [[trace[a] if b == c == 0 else 0 for c in range(n)] for b in range(n)] for a in range(n)
    ]
    change[0][1][2] = x * y
    extra = sp.Array(change)
    return gt.from_coefficients(frame, (gt.cartan(frame).coefficients.to_sympy() + extra).tolist())


def test_exponential_of_the_torsion_potential():
    """v_a = 3 d_a Theta gives exp(-3 Theta), Theta an unknown function (Saa 1993, Fiziev 1998)."""
    connection = with_vector(FLAT, [3 * Theta.diff(q) for q in (t, x, y, z)])
    volume = connection.transposed.volume
    assert volume
    assert (FLAT.scalar(volume.factor) - sp.exp(-3 * Theta)).is_zero
    assert connection.volume.density == 1


@pytest.mark.parametrize(
    "potential", [x * y * z, sp.log(1 + x**2) + y, sp.sin(x) * z + y**2, sp.exp(x) * y]
)
def test_divergence_follows_the_transposed_volume(potential):
    """D_a w^a = d_a (mu w^a) / mu for the parallel volume mu of the transposed connection."""
    connection = with_vector(BENT, [potential.diff(q) for q in BENT.coordinates])
    mu = connection.transposed.volume.density
    w = [x * y, sp.cos(z) + x, y * z]
    plain = sp.Add(*((mu * part).diff(q) for part, q in zip(w, BENT.coordinates, strict=True))) / mu
    assert (connection.divergence(BENT.vector(w)) - plain).is_zero
    bar = gt.levi_civita(BENT).divergence(BENT.vector(w))
    assert not (connection.divergence(BENT.vector(w)) - bar).is_zero


def test_volume_of_a_general_connection_is_parallel():
    """D_d (f epsilon_abc) vanishes for the factor f, and not without it."""
    potential = x**2 * y + sp.log(2 + sp.sin(z))
    connection = general(BENT, [potential.diff(q) for q in BENT.coordinates])
    assert connection.metric_compatible is False
    volume = connection.volume
    assert connection.covariant_derivative(BENT.epsilon * volume.factor).is_zero
    assert not connection.covariant_derivative(BENT.epsilon).is_zero


def test_obstruction_is_the_trace_of_the_curvature():
    """There is a parallel volume exactly where R_ab c^c vanishes; the two agree up to the sign."""
    connection = general(BENT, [y * z, x**2, 0])
    volume = connection.volume
    assert volume.holds is False
    trace = gt.contract("abcc->ab", connection.curvature.riemann)
    assert set(volume.obstructions) == {(a, b) for a, b in trace.nonzero() if a < b}
    sign = trace[0, 1] / volume.obstructions[0, 1]
    assert sp.simplify(sign) in (1, -1)
    for index, value in volume.obstructions.items():
        assert (BENT.scalar(trace[index]) - sp.simplify(sign) * value).is_zero
    assert "d_x W_y - d_y W_x" in repr(volume)


@pytest.mark.parametrize("name", ["so3", "schwarzschild", "heisenberg", "edge_dislocation"])
def test_metric_connections_keep_the_metric_volume(name):
    """D_a sqrt|g| = 0 by Gamma_ab^b = d_a log sqrt|g|; bare coefficients show the same."""
    frame = gt.spaces.load(name).frame
    volume = gt.cartan(frame).volume
    assert (frame.volume - volume.density).is_zero
    bare = gt.from_coefficients(frame, gt.cartan(frame).coefficients)
    assert bare.volume.gradient.is_zero


def test_volume_of_a_group():
    """Unimodular groups have a volume that both connections keep; ax + b has two."""
    so3 = gt.cartan(gt.spaces.load("so3").frame)
    assert so3.transposed.volume.factor == 1
    affine = gt.cartan(gt.spaces.load("ax_plus_b").frame)
    factor = affine.transposed.volume.factor
    assert sp.diff(factor, affine.frame.coordinates[0]) != 0


def test_transposed_connection():
    """The opposite torsion, the same symmetric part; twice transposed is the same."""
    connection = general(BENT, [x, z, y])
    other = connection.transposed
    assert (other.torsion.T + connection.torsion.T).is_zero
    n = range(3)
    assert all(other[a, b, c] == connection[b, a, c] for a in n for b in n for c in n)
    assert other.transposed.coefficients == connection.coefficients
    bar = gt.levi_civita(BENT)
    assert bar.transposed is bar


def test_transposed_autoparallels():
    """Autoparallels depend on the symmetric part only: both connections have the same."""
    so3 = gt.spaces.load("so3").frame
    ends = [
        gt.solve(gt.autoparallel(one, [0.3, 1.0, 0.2], [0.5, 0.4, -0.3]), 2.0, 1e-11).at(2.0)
        for one in (gt.cartan(so3), gt.cartan(so3).transposed)
    ]
    assert abs(ends[0].coordinates - ends[1].coordinates).max() < 1e-10


UNKNOWN = with_vector(BENT, [sp.exp(sp.sin(x)), 0, 0]).transposed.volume
OPEN = with_vector(BENT, [y, 0, 0]).transposed.volume


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: OPEN.factor, UndecidedError, r"expected a connection with a parallel volume"),
        (lambda: OPEN.density, UndecidedError, r"no parallel volume: d_x W_y - d_y W_x = 1"),
        (lambda: UNKNOWN.factor, UndecidedError, "no closed form of its integral"),
        (
            lambda: bool(gt.geometry.ParallelVolume(OPEN.gradient, None, {})),
            GeomtorsionError,
            "cannot be decided exactly",
        ),
    ],
)
def test_refusals(call, error, words):
    """Each message gives the reason."""
    with pytest.raises(error, match=words):
        call()


def test_volume_without_a_closed_form_exists():
    """The verdict does not need the integral; the text shows the gradient."""
    assert UNKNOWN
    assert "d log f" in repr(UNKNOWN)


def test_scalar_curvature_with_the_factor():
    """exp(-3 Theta) (R - R_bar - 12 (d Theta)^2) is the divergence of 6 exp(-3 Theta) d Theta."""
    frame = gt.spaces.load("frw").frame
    time = frame.coordinates[0]
    potential = sp.Function("Theta")(time)
    slopes = [potential.diff(q) for q in frame.coordinates]
    connection, bar = with_vector(frame, [3 * slope for slope in slopes]), gt.levi_civita(frame)
    factor = connection.transposed.volume.factor
    rise = frame.vector(
        [sum(frame.inverse_metric[a, b] * slopes[b] for b in range(4)) for a in range(4)]
    )
    square = sum(rise[a] * slopes[a] for a in range(4))
    rest = (connection.curvature.scalar - bar.curvature.scalar - 12 * square) * factor
    assert (rest - bar.divergence(rise * factor) * 6).is_zero
    equations = gt.gravity.equations(
        bar, "exp(-3*chi)*(R + 12*X)", gt.gravity.scalar_field(potential, name="chi")
    )
    expected = (bar.curvature.scalar + 12 * square) * factor
    assert (equations.L - expected).is_zero
