"""Numbers at hard points: near edges, under cancellation, at high precision, very large."""

import mpmath
import numpy as np
import pytest
import sympy as sp
from sympy import cos, cosh, exp, expand, log, sin, sinh, sqrt

import geomtorsion as gt
from geomtorsion.codegen import numpy_function
from geomtorsion.errors import SingularPointError
from geomtorsion.exact import Field
from tests.differences import numeric
from tests.rounding import ROUNDED

x, y = sp.symbols("x y", real=True)

CANCELLING = {
    "power of one minus cosine": ((1 - cos(x)) ** 10, 1e-3),
    "expanded power": (expand((x - 1) ** 20), 1.001),
    "exponential less its series": (exp(x) - 1 - x - x**2 / 2 - x**3 / 6, 1e-5),
    "hyperbolic functions far out": (cosh(x) - sinh(x), 100.0),
    "their reciprocal": (1 / (cosh(x) - sinh(x)), 300.0),
    "root less its argument": (sqrt(x**2 + 1) - x, 1e12),
    "nested root": (sqrt(x**2 + 2) - sqrt(x**2 + 1), 1e10),
    "logarithm near one": (log(1 + x) - x, 1e-12),
    "reciprocal of a small sine": (1 / sin(x) ** 6, 1e-8),
    "near a multiple of pi": (sin(x), 355.0),
    "far exponent": (exp(-x), 600.0),
}


@pytest.mark.parametrize("label", CANCELLING)
def test_cancellation(label):
    """A float is right to 14 digits even where the terms cancel almost completely."""
    expression, at = CANCELLING[label]
    found = Field([x]).read(expression).evaluate({x: at})
    with mpmath.workdps(400):
        wanted = mpmath.mpmathify(numeric([expression], [x], {})([mpmath.mpf(at)])[0])
    assert isinstance(found, float)
    assert found == pytest.approx(float(wanted), rel=ROUNDED, abs=0)


@pytest.mark.parametrize("bits", [53, 113, 237, 1000])
def test_results_have_the_requested_precision(bits):
    """At any precision nearly all bits are right."""
    expression = (1 - cos(x)) ** 3 / (exp(x) - 1 - x) + sqrt(2) * sp.pi
    point = sp.Rational(1, 1000)
    found = Field([x]).read(expression).evaluate({x: point}, precision=bits)
    with mpmath.workprec(2 * bits + 200):
        wanted = numeric([expression], [x], {})([mpmath.mpf(1) / 1000])[0]
        assert abs(mpmath.mpmathify(found) - wanted) < abs(wanted) * mpmath.mpf(2) ** (4 - bits)


def test_so3_near_gimbal_lock():
    """At a distance of 1e-7 from the edge of the chart the inverse metric keeps 13 digits."""
    frame = gt.spaces.load("so3").frame
    phi1, phi2, phi3 = frame.coordinates
    near = 1e-7
    found = frame.inverse_metric.at({phi1: 0.3, phi2: near, phi3: 0.1})
    with mpmath.workdps(60):
        s2, c2 = mpmath.sin(mpmath.mpf(near)), mpmath.cos(mpmath.mpf(near))
        wanted = np.array(
            [
                [float(1 / s2**2), 0, float(-c2 / s2**2)],
                [0, 1, 0],
                [float(-c2 / s2**2), 0, float(1 / s2**2)],
            ]
        )
    np.testing.assert_allclose(found, wanted, rtol=1e-13)
    with pytest.raises(SingularPointError):
        frame.inverse_metric.at({phi1: 0, phi2: 0, phi3: 0})


def test_kerr_next_to_the_horizon():
    """Kretschmann scalar of Kerr, close to r+, agrees with the textbook's closed form."""
    frame = gt.spaces.load("kerr").frame
    r, theta = frame.coordinates[1:3]
    spin, mass = sorted(frame.parameters, key=lambda s: s.name.lower())
    at = {r: 1.8000001, theta: 0.7, mass: 1.0, spin: 0.6}
    found = float(gt.levi_civita(frame).curvature.kretschmann.at(at))
    u = 0.6 * np.cos(0.7)
    rr = 1.8000001
    wanted = 48 * (rr**2 - u**2) * ((rr**2 + u**2) ** 2 - 16 * rr**2 * u**2) / (rr**2 + u**2) ** 6
    assert found == pytest.approx(wanted, rel=1e-12)


def test_numpy_function_at_many_points():
    """Vectorised numbers agree with evaluate() away from cancellation, for a whole tensor."""
    frame = gt.spaces.load("schwarzschild").frame
    ricci = gt.levi_civita(frame).coefficients.components.nonzero
    symbols = [*frame.coordinates, *frame.parameters]
    function = numpy_function(list(ricci.values()), symbols)
    radii = np.linspace(3, 30, 7)
    arrays = [radii if s.name == "r" else np.full(7, 0.8) for s in symbols]
    values = function(*arrays)
    for column, radius in enumerate(radii):
        point = {s: radius if s.name == "r" else 0.8 for s in symbols}
        for row, element in enumerate(ricci.values()):
            assert values[row, column] == pytest.approx(element.evaluate(point), rel=1e-12)
