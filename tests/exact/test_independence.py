"""Independence: a long expression is written without symbols on which it does not depend."""

import mpmath
import pytest
import sympy as sp

from geomtorsion.exact.points import point_of
from geomtorsion.geometry import Frame, levi_civita

t, r, theta, phi = sp.symbols("t r theta phi", positive=True)
Lambda = sp.Symbol("Lambda", positive=True)


def de_sitter() -> Frame:
    """De Sitter space whose radius is a function of two coordinates, from its metric."""
    s = r * (2 + sp.sin(phi))
    rho = s + s / (1 + s**2)
    f = 1 - Lambda * rho**2 / 3
    slope = sp.Matrix([sp.diff(rho, x) for x in (t, r, theta, phi)])
    metric = slope * slope.T / f + sp.diag(-f, 0, rho**2, rho**2 * sp.sin(theta) ** 2)
    return Frame.from_metric([t, r, theta, phi], metric, signature=(-1, 1, 1, 1))


@pytest.fixture(scope="module")
def curvature():
    """Curvature of that de Sitter space."""
    return levi_civita(de_sitter()).curvature


def test_the_scalar_of_de_sitter_space(curvature):
    """The scalar has hundreds of thousands of parts as it is built, and is written as 4 Lambda."""
    known = len(curvature.scalar.frame.field.generators)
    assert curvature.scalar[()] == 4 * Lambda
    assert str(curvature.scalar).endswith("R = 4*Lambda")
    assert sp.simplify(curvature.kretschmann[()] - sp.Rational(8, 3) * Lambda**2) == 0
    # Numbers such as sin(1) do not enter the field of the frame.
    assert len(curvature.scalar.frame.field.generators) == known


def test_symbols_that_matter_stay(curvature):
    """R_ab = Lambda g_ab, by the zero test and by numbers of the written component."""
    ricci, metric = curvature.ricci, curvature.ricci.frame.metric
    assert (ricci - Lambda * metric).is_zero is True
    assert {r, phi, Lambda} <= ricci[0, 0].free_symbols
    place = {
        t: 1,
        r: sp.Rational(3, 7),
        theta: 1,
        phi: sp.Rational(2, 5),
        Lambda: sp.Rational(1, 3),
    }
    with mpmath.workdps(50):
        want = metric.at(place, digits=40)[0, 0] / 3
        have = mpmath.mpmathify(ricci[0, 0].subs(place).evalf(50))
        assert abs(have - want) < mpmath.mpf(10) ** -38


def test_earlier_queries_change_no_form():
    """Equal components are written in equal letters, however many points earlier queries used."""
    shown = []
    # The prime changes at the 256th point: between two queries, or between two compared points.
    for asked in (0, 253, 255):
        frame = de_sitter()
        scalar = levi_civita(frame).curvature.scalar
        point = point_of(frame.field)
        for _ in range(asked):
            assert point.moves(frame.metric.element(0, 0), r) is True
        assert point.moves(scalar.element(), r) is False
        shown.append((str(scalar), str(levi_civita(frame).curvature.ricci[0, 0])))
    assert shown[0] == shown[1] == shown[2]
