"""Conventions: each is compared with sums written out here in plain sympy."""

from __future__ import annotations

from itertools import product

import pytest
import sympy as sp

from geomtorsion.conventions import CONVENTIONS, convention
from geomtorsion.errors import UnknownNameError
from geomtorsion.geometry import Frame, cartan, levi_civita

q = sp.symbols("q1:4", real=True)
N = range(3)
COFRAME = sp.Matrix([[q[1], 1, 0], [0, sp.exp(q[0]), q[2]], [1, 0, 2]])
ETA = sp.diag(-1, 1, 1)


@pytest.fixture(scope="module")
def frame() -> Frame:
    return Frame(q, COFRAME, signature=(-1, 1, 1))


@pytest.fixture(scope="module")
def plain() -> dict:
    """All quantities by explicit sums, without symmetries."""
    e, legs = COFRAME, COFRAME.inv()
    g = e.T * ETA * e
    up = g.inv()
    d = [lambda f, s=s: sp.diff(f, s) for s in q]
    gamma = {
        (a, b, c): sum(legs[c, i] * d[a](e[i, b]) for i in N) for a, b, c in product(N, repeat=3)
    }
    bar = {
        (a, b, c): sum(up[c, f] * (d[a](g[b, f]) + d[b](g[a, f]) - d[f](g[a, b])) for f in N) / 2
        for a, b, c in product(N, repeat=3)
    }
    torsion = {(a, b, c): (gamma[a, b, c] - gamma[b, a, c]) / 2 for a, b, c in gamma}
    lower = {(a, b, c): sum(torsion[a, b, f] * g[f, c] for f in N) for a, b, c in torsion}
    return {
        "e": e,
        "E": legs,
        "g": g,
        "G": gamma,
        "bar": bar,
        "S": torsion,
        "lower": lower,
        "up": up,
    }


def same(tensor, wanted: dict) -> bool:
    """Whether a tensor equals expressions made without the package, exactly."""
    for index, value in wanted.items():
        (expected,) = tensor.frame.read([("expected", value)])
        if tensor.element(*index) != expected:
            return False
    return len(wanted) == tensor.frame.dimension ** len(tensor.slots)


def indices(rank: int) -> list:
    return list(product(N, repeat=rank))


def test_matrices(frame: Frame, plain: dict) -> None:
    """Coframe rows, legs as columns, metric e^T eta e."""
    assert same(frame.coframe, {i: plain["e"][i] for i in indices(2)})
    assert same(frame.legs, {i: plain["E"][i] for i in indices(2)})
    assert same(frame.metric, {i: plain["g"][i] for i in indices(2)})
    assert same(frame.inverse_metric, {i: plain["up"][i] for i in indices(2)})


def test_connections(frame: Frame, plain: dict) -> None:
    """Both connections have the direction of differentiation first."""
    assert same(cartan(frame).coefficients, plain["G"])
    assert same(levi_civita(frame).coefficients, plain["bar"])


def test_torsion_and_contortion(frame: Frame, plain: dict) -> None:
    """The half in torsion, the index order of contortion, and anholonomy as 2 S in the frame."""
    gamma, lower, up = plain["G"], plain["lower"], plain["up"]
    assert same(cartan(frame).torsion.S, plain["S"])
    mixed = {
        (a, b, c): sum(up[c, f] * (lower[a, b, f] - lower[b, f, a] + lower[f, a, b]) for f in N)
        for a, b, c in indices(3)
    }
    assert same(cartan(frame).contortion_from_torsion, mixed)
    assert same(cartan(frame).contortion, {i: gamma[i] - plain["bar"][i] for i in indices(3)})
    e, legs = plain["e"], plain["E"]
    bend = {
        (i, j, k): sum(
            2 * legs[a, i] * legs[b, j] * e[k, c] * plain["S"][a, b, c] for a, b, c in indices(3)
        )
        for i, j, k in indices(3)
    }
    assert same(frame.anholonomy, bend)
    # [E_i, E_j] = - C_ij^k E_k
    for i, j in indices(2):
        for a in N:
            bracket = sum(
                legs[b, i] * sp.diff(legs[a, j], q[b]) - legs[b, j] * sp.diff(legs[a, i], q[b])
                for b in N
            )
            expected = -sum(bend[i, j, k] * legs[a, k] for k in N)
            (zero,) = frame.read([("difference", bracket - expected)])
            assert zero.is_zero is True


def test_curvature_signs(frame: Frame, plain: dict) -> None:
    """Curvature by the formula of READING.md; Ricci contracts the first index with the last."""
    bar, up = plain["bar"], plain["up"]
    riemann = {
        (m, n, b, k): sp.diff(bar[n, b, k], q[m])
        - sp.diff(bar[m, b, k], q[n])
        + sum(bar[n, b, t] * bar[m, t, k] - bar[m, b, t] * bar[n, t, k] for t in N)
        for m, n, b, k in indices(4)
    }
    curvature = levi_civita(frame).curvature
    assert same(curvature.riemann, riemann)
    ricci = {(n, b): sum(riemann[m, n, b, m] for m in N) for n, b in indices(2)}
    assert same(curvature.ricci, ricci)
    assert same(curvature.scalar, {(): sum(up[i] * ricci[i] for i in indices(2))}) is True


def test_torsion_parts_and_scalar(frame: Frame, plain: dict) -> None:
    """Torsion vector, axial part and torsion scalar with their factors."""
    lower, up, torsion = plain["lower"], plain["up"], cartan(frame).torsion
    vector = {(a,): sum(2 * plain["S"][a, b, b] for b in N) for a in N}
    assert same(torsion.vector, vector)
    axial = {
        (a, b, c): sp.Rational(2, 3) * (lower[a, b, c] + lower[b, c, a] + lower[c, a, b])
        for a, b, c in indices(3)
    }
    assert same(torsion.axial, axial)
    first = {(a, b, c): sum(2 * lower[f, b, c] * up[f, a] for f in N) for a, b, c in indices(3)}
    second = {(a, b, c): sum(first[a, f, c] * up[f, b] for f in N) for a, b, c in indices(3)}
    raised = {(a, b, c): sum(second[a, b, f] * up[f, c] for f in N) for a, b, c in indices(3)}
    scalar = (
        sum(2 * lower[i] * raised[i] for i in indices(3)) / 4
        + sum(2 * lower[a, b, c] * raised[c, b, a] for a, b, c in indices(3)) / 2
        - sum(vector[a,] * vector[b,] * up[a, b] for a, b in indices(2))
    )
    assert torsion.scalar.element() == frame.read([("scalar", scalar)])[0]


def test_torsion_force(frame: Frame, plain: dict) -> None:
    """f^c = 2 S_a^c_b q'^a q'^b is minus the symmetric part of the contortion."""
    u = sp.symbols("u1:4", real=True)
    gamma, bar = plain["G"], plain["bar"]
    wanted = {
        (c,): sum((bar[a, b, c] - gamma[a, b, c]) * u[a] * u[b] for a, b in indices(2)) for c in N
    }
    assert same(cartan(frame).torsion.force(u), wanted)


def test_list() -> None:
    """Each convention has its own name; the error for an unknown name lists known ones."""
    assert len({item.name for item in CONVENTIONS}) == len(CONVENTIONS) >= 15
    assert "half" in convention("torsion").note
    with pytest.raises(UnknownNameError, match="torsion force"):
        convention("tension")
