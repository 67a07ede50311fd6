"""Kinds of connections: each constructor gives the kind that its coefficients have."""

from collections.abc import Callable

import pytest
import sympy as sp

import geomtorsion as gt

X, Y, Z, S = sp.symbols("x y z s")
FRAME = gt.Frame([X, Y, Z], [[1 + Y**2, 0, X], [0, 1, Z], [0, 0, 1]], (-1, 1, 1))
BAR, CARTAN = gt.levi_civita(FRAME), gt.cartan(FRAME)
GENERAL = gt.from_coefficients(
    FRAME, [[[X, 0, 1], [Y, Z, 0], [0, 1, X]], [[0, Z, 0], [1, 0, Y], [X, 0, 0]], [[0] * 3] * 3]
)
# omega_ai^j of a metric connection: omega_aij antisymmetric, signature (-, +, +).
TURNING = [[[0, X, 0], [X, 0, Y], [0, -Y, 0]]] + [[[0] * 3] * 3] * 2
BENT = [[[X, 0, 0], [0, 0, Y], [0, Y, 0]]] + [[[0] * 3] * 3] * 2
CONTORTION = CARTAN.contortion * S

KINDS: dict[str, tuple[Callable[[], gt.Connection], str]] = {
    "levi_civita": (lambda: BAR, "levi-civita"),
    "cartan": (lambda: CARTAN, "cartan"),
    "from_coefficients": (lambda: GENERAL, "general"),
    "from_coefficients of metric ones": (
        lambda: gt.from_coefficients(FRAME, CARTAN.coefficients),
        "general",
    ),
    "from_spin_connection": (lambda: gt.from_spin_connection(FRAME, TURNING), "metric"),
    "from_spin_connection, bent": (lambda: gt.from_spin_connection(FRAME, BENT), "general"),
    "from_contortion": (lambda: gt.from_contortion(FRAME, CONTORTION), "metric"),
    "from_torsion": (lambda: gt.from_torsion(FRAME, CARTAN.torsion.S * S), "metric"),
    "from_nonmetricity": (
        lambda: gt.from_nonmetricity(FRAME, GENERAL.nonmetricity, CARTAN.torsion),
        "general",
    ),
    "blend": (lambda: gt.blend(BAR, CARTAN, S), "metric"),
    "blend, first general": (lambda: gt.blend(GENERAL, CARTAN, S), "general"),
    "blend, second general": (lambda: gt.blend(BAR, GENERAL), "general"),
    "blend, one end": (lambda: gt.blend(GENERAL, BAR, 1), "general"),
    "subs": (lambda: gt.blend(BAR, GENERAL, S).subs({S: 2}), "general"),
    "subs of a metric one": (lambda: gt.blend(BAR, CARTAN, S).subs({S: 2}), "metric"),
    "in_coordinates": (
        lambda: GENERAL.in_coordinates([X, Y, Z], [X + Y, Y, Z]),
        "general",
    ),
    "in_coordinates of a metric one": (
        lambda: gt.from_contortion(FRAME, CONTORTION).in_coordinates([X, Y, Z], [X + Y, Y, Z]),
        "metric",
    ),
}


def lower_curvature(gamma: sp.Array, metric: sp.Matrix, index: tuple[int, ...]) -> sp.Expr:
    """R_mnlk from its definition, by sympy."""
    m, n, low, k = index
    q = (X, Y, Z)

    def mixed(up: int) -> sp.Expr:
        value = sp.diff(gamma[n, low, up], q[m]) - sp.diff(gamma[m, low, up], q[n])
        for t in range(3):
            value += gamma[n, low, t] * gamma[m, t, up] - gamma[m, low, t] * gamma[n, t, up]
        return value

    return sp.Add(*(metric[k, up] * mixed(up) for up in range(3)))


@pytest.mark.parametrize("name", KINDS)
def test_a_kind_is_true(name: str) -> None:
    """The kind is right, and what depends on it agrees with the bare coefficients."""
    make, kind = KINDS[name]
    connection = make()
    assert connection.kind == kind
    if kind != "general":
        assert connection.metric_compatible
    frame = connection.frame
    bare = gt.from_coefficients(frame, gt.Tensor(frame, "ddu", connection.coefficients.components))
    assert bare.kind == "general"
    assert bare.contortion == connection.contortion
    assert bare.nonmetricity == connection.nonmetricity
    assert bare.curvature.riemann == connection.curvature.riemann
    assert bare.curvature.lower == connection.curvature.lower


def test_a_general_connection_by_its_definitions() -> None:
    """Contortion K_abc = S_abc - S_bca + S_cab and curvature of a connection with nonmetricity."""
    half = gt.blend(BAR, GENERAL)
    assert half.metric_compatible is False
    gamma = sp.Array(half.coefficients.to_sympy())
    metric = sp.Matrix(FRAME.metric.to_sympy())
    lower = sp.MutableDenseNDimArray.zeros(3, 3, 3)
    for a in range(3):
        for b in range(3):
            for c in range(3):
                lower[a, b, c] = sp.Add(
                    *((gamma[a, b, m] - gamma[b, a, m]) / 2 * metric[m, c] for m in range(3))
                )
    K = half.contortion.lowered(2)
    for a, b, c in [(0, 0, 1), (0, 1, 0), (1, 0, 2), (2, 2, 1), (1, 1, 2)]:
        wanted = lower[a, b, c] - lower[b, c, a] + lower[c, a, b]
        assert (FRAME.scalar(K[a, b, c]) - wanted).is_zero
    R = half.curvature.lower
    for index in [(0, 1, 0, 0), (0, 1, 0, 2), (0, 1, 2, 0), (0, 2, 1, 1), (1, 2, 2, 0)]:
        assert (FRAME.scalar(R[index]) - lower_curvature(gamma, metric, index)).is_zero
    assert not (R + gt.contract("mnlk->mnkl", R)).is_zero
