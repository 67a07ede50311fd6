"""Free bodies with exact data keep their digits for a long time."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp

from geomtorsion.rigid import attitude, free_top
from geomtorsion.scenes import Body, Scene, State
from geomtorsion.support.precision import working_digits
from tests.rounding import ROUNDED

# No float holds these; the momentum is near the third axis.
MOMENTS = (Fraction(6, 5), Fraction(2), Fraction(29, 10))
OMEGA = (Fraction(2, 5), Fraction(0), Fraction(11, 10))
# A rotation by whole numbers, that takes principal axes to body axes.
TURN = sp.Matrix([[2, -2, 1], [1, 2, 2], [-2, -1, 2]]) / 3
LONG = [1.0, 1e2, 1e4, 1e6, 1e8]


def numbers(moments, omega):
    """Moments, amplitudes of cn, sn, dn, the frequency, the modulus k^2 and |L|, of many digits."""
    first, middle, last = (mpmath.mpf(x.numerator) / x.denominator for x in moments)
    one, _, three = (mpmath.mpf(x.numerator) / x.denominator for x in omega)
    energy2 = first * one**2 + last * three**2
    momentum2 = (first * one) ** 2 + (last * three) ** 2
    above, below = energy2 * last - momentum2, momentum2 - energy2 * first
    sizes = [
        mpmath.sqrt(above / (first * (last - first))),
        mpmath.sqrt(above / (middle * (last - middle))),
        mpmath.sqrt(below / (last * (last - first))),
    ]
    frequency = mpmath.sqrt((last - middle) * below / (first * middle * last))
    modulus2 = (middle - first) * above / ((last - middle) * below)
    return (first, middle, last), sizes, frequency, modulus2, mpmath.sqrt(momentum2)


def exact_rates(t, moments=MOMENTS, omega=OMEGA):
    """Rates at a time to 50 digits, [LandauLifshitz1] (37.10); omega has no middle part."""
    with working_digits(60):
        _, sizes, frequency, modulus2, _ = numbers(moments, omega)
        kinds = ("cn", "sn", "dn")
        functions = [mpmath.ellipfun(k, frequency * mpmath.mpf(t), m=modulus2) for k in kinds]
        return [size * value for size, value in zip(sizes, functions, strict=True)]


def exact_precession(t):
    """The angle of the third axis about the momentum at a time, less whole turns."""
    with working_digits(40):
        (first, middle, _), sizes, frequency, modulus2, momentum = numbers(MOMENTS, OMEGA)

        def rate(tau):
            cn, sn = (mpmath.ellipfun(k, tau, m=modulus2) for k in ("cn", "sn"))
            one, two = sizes[0] * cn, sizes[1] * sn
            flat = (first * one) ** 2 + (middle * two) ** 2
            return momentum * (first * one**2 + middle * two**2) / flat / frequency

        half = 2 * mpmath.ellipk(modulus2)
        count = mpmath.floor(frequency * t / half)
        rest = frequency * mpmath.mpf(t) - count * half
        angle = count * mpmath.quad(rate, [0, half / 2, half]) + mpmath.quad(rate, [0, rest])
        return float(mpmath.fmod(angle, 2 * mpmath.pi))


def scene(moments, omega, t, **body):
    """A free body whose rates are watched."""
    inertia = body or {"moments": moments}
    return Scene(Body(**inertia), [], State(omega=omega), watch=["omega"], t=[t], accuracy=1e-12)


@pytest.mark.parametrize("t", LONG)
def test_rates_are_right_however_late(t):
    """The true error stays below the reported one, from one second to a hundred million."""
    result = scene(MOMENTS, OMEGA, t).run()
    truth = exact_rates(t)
    away = max(abs(float(a - b)) for a, b in zip(result["omega"][-1], truth, strict=True))
    assert result.closed_form is not None
    assert away <= result.error
    assert away < 50 * np.finfo(float).eps


def test_the_reported_error_grows_with_time():
    """The error contains the digits of the period: a later time has a larger error."""
    early, late = (scene(MOMENTS, OMEGA, t).run().error for t in (1e6, 1e14))
    assert early < late


@pytest.mark.parametrize("t", LONG)
def test_the_third_axis_is_right_however_late(t):
    """Tilt and precession of the third axis about the momentum."""
    top = free_top(MOMENTS, OMEGA)
    directions = [
        attitude.matrix_from_quaternion(top.quaternion(at))[:, 2] for at in (np.zeros(1)[0], t)
    ]
    up = top.momentum / np.linalg.norm(top.momentum)
    across = np.cross(up, directions[0])
    aside = np.cross(across, up)
    angle = np.arctan2(directions[1] @ across, directions[1] @ aside)
    gap = (angle - exact_precession(t) + np.pi) % (2 * np.pi) - np.pi
    assert abs(gap) < 100 * np.finfo(float).eps


@pytest.mark.parametrize("t", LONG)
def test_an_exact_tensor_stays_exact(t):
    """The same body in other axes: its rates, turned back, are as good."""
    tensor = TURN * sp.diag(*(sp.Rational(x.numerator, x.denominator) for x in MOMENTS)) * TURN.T
    omega = TURN * sp.Matrix([sp.Rational(x.numerator, x.denominator) for x in OMEGA])
    result = scene(None, list(omega), t, inertia=tensor.tolist()).run()
    found = np.array(TURN.T.tolist(), dtype=float) @ result["omega"][-1]
    assert result.closed_form is not None
    assert np.abs(found - np.array(exact_rates(t), dtype=float)).max() <= result.error


def test_a_turned_symmetric_body_precesses_evenly():
    """Equal moments in a tensor with products of inertia are equal: the rate is constant."""
    tensor = TURN * sp.diag(sp.sqrt(2), sp.sqrt(2), 2) * TURN.T
    omega = list(TURN * sp.Matrix([sp.Rational(1, 3), 0, 1]))
    result = scene(None, omega, 1e7, inertia=tensor.tolist()).run()
    turned = np.array(TURN.T.tolist(), dtype=float) @ result["omega"][-1]
    with working_digits(40):
        angle = (2 / mpmath.sqrt(2) - 1) * mpmath.mpf(10) ** 7
        truth = [float(mpmath.cos(angle) / 3), float(mpmath.sin(angle) / 3), 1.0]
    assert np.abs(turned - truth).max() <= result.error


def test_irrational_moments_keep_digits():
    """Roots are taken to many digits: sqrt(2) and its square agree with 2 at late times."""
    roots = (sp.sqrt(2), 2, sp.sqrt(5))
    fine = free_top(roots, (sp.Rational(1, 3), 0, 1)).omega(1e7)
    long = tuple(Fraction(str(sp.N(x, 60))) for x in roots)
    assert np.abs(fine - free_top(long, (Fraction(1, 3), 0, 1)).omega(1e7)).max() < ROUNDED
    rounded = free_top([float(x) for x in roots], (1 / 3, 0, 1)).omega(1e7)
    assert np.abs(fine - rounded).max() > 1e-11


def test_a_steady_rotation_of_a_turned_body_stays_steady():
    """A rotation exactly about the middle axis does not flip, whatever the axes of the body."""
    tensor = TURN * sp.diag(1, 2, 3) * TURN.T
    omega = list(TURN * sp.Matrix([0, 1, 0]))
    result = scene(None, omega, 1e4, inertia=tensor.tolist()).run()
    assert np.abs(result["omega"][-1] - np.array(omega, dtype=float)).max() <= result.error
