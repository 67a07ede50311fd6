"""Free top series: constants, theta functions and phase of a free top, from exact invariants."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import flint
import numpy as np

from geomtorsion.rigid.double_double import DoubleDouble
from geomtorsion.support.precision import CONSTANT_BITS, EPS, ball_precision

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Constants:
    """Constants of the closed form of a free top that is not steady.

    axes: (a, b, c), the axis that the momentum goes around, the middle one, the other one.
    amplitudes: of Omega_a = A_a dn, Omega_b = A_b sn, Omega_c = A_c cn, signs included.
    side: +1 if axis a has the largest moment, -1 if the smallest.
    rate: u = rate * t + const, in 1 / time.
    modulus2, complement2: k^2 and 1 - k^2.
    near_one: whether k^2 > 1/2 (the series are turned then).
    log_nome, scale, shift: of the series; z = scale * u, and theta1(z - i shift) has the phase.
    half: 2K / rate, the time between two flips; infinite on the separatrix.
    offset: u / rate at t = 0; |u| <= K.
    slope: precession per time beside the part that repeats, in units of 4 pi.
    jump: precession in half a period less slope times it, in units of 4 pi.
    momentum: |L|.
    """

    axes: tuple[int, int, int]
    amplitudes: tuple[float, float, float]
    side: int
    rate: float
    modulus2: float
    complement2: float
    near_one: bool
    log_nome: float
    scale: float
    shift: float
    half: DoubleDouble
    offset: DoubleDouble
    slope: DoubleDouble
    jump: DoubleDouble
    momentum: float


def circled_axis(moments: tuple[Fraction, ...], omega: tuple[Fraction, ...]) -> tuple[int, ...]:
    """Axes (a, b, c): the momentum goes around a; b has the middle moment.

    Equation
    --------
    L^2 - 2 T I_b = I_3 (I_3 - I_2) Omega_3^2 - I_1 (I_2 - I_1) Omega_1^2, moments in order.

    Examples
    --------
    >>> moments = Fraction(1), Fraction(2), Fraction(3)
    >>> circled_axis(moments, (Fraction(2), Fraction(1), Fraction(0)))
    (0, 1, 2)
    """
    low, mid, high = sorted(range(3), key=lambda k: moments[k])
    excess = moments[high] * (moments[high] - moments[mid]) * omega[high] ** 2
    excess -= moments[low] * (moments[mid] - moments[low]) * omega[low] ** 2
    return (high, mid, low) if excess >= 0 else (low, mid, high)


def is_steady(moments: tuple[Fraction, ...], omega: tuple[Fraction, ...]) -> bool:
    """Whether the rates stay as they are: Omega x L = 0, exactly."""
    return all(
        omega[i] * omega[j] * (moments[i] - moments[j]) == 0 for i, j in ((0, 1), (1, 2), (2, 0))
    )


def constants(moments: tuple[Fraction, ...], omega: tuple[Fraction, ...]) -> Constants:
    """The constants of a top with these principal moments and rates; not for steady ones.

    Equation
    --------
    P = s (L^2 - 2 T I_c), Q = s (2 T I_a - L^2), R = s (L^2 - 2 T I_b) > 0
    rate^2 = s (I_a - I_b) P / (I_a I_b I_c), k^2 = s (I_b - I_c) Q / (s (I_a - I_b) P)
    precession of axis c about L: phi' = L / I_c - s L P / (I_c (L^2 - L_c^2)):
    an integral of the third kind with n = - I_c Q / (I_a P)    [LandauLifshitz1] section 37

    The data are rational: P, Q, R have no rounding error at all, and one minus the modulus is as
    good next to the separatrix as anywhere else.

    Examples
    --------
    >>> top = constants((Fraction(1), Fraction(2), Fraction(3)), (Fraction(1),) * 3)
    >>> top.axes, top.side, top.modulus2
    ((2, 1, 0), 1, 0.5)
    """
    axes = circled_axis(moments, omega)
    ia, ib, ic = (moments[k] for k in axes)
    wa, wb, wc = (omega[k] for k in axes)
    s = 1 if ia > ib else -1
    p = s * (ib * (ib - ic) * wb**2 + ia * (ia - ic) * wa**2)
    q = s * (ib * (ia - ib) * wb**2 + ic * (ia - ic) * wc**2)
    r = s * (ia * (ia - ib) * wa**2 - ic * (ib - ic) * wc**2)
    k2 = (ib - ic) * q / ((ia - ib) * p)
    m1 = (ia - ic) * r / ((ia - ib) * p)
    n = -ic * q / (ia * p)
    size_a2, size_b2 = p / (ia * s * (ia - ic)), q / (ib * s * (ia - ib))
    size_c2 = q / (ic * s * (ia - ic))
    parity = 1 if axes in ((0, 1, 2), (1, 2, 0), (2, 0, 1)) else -1
    sign_a = 1 if wa > 0 else -1
    # cos am is positive for |u| < K; its sign goes to the amplitude, so that |u| <= K at t = 0.
    sign_c = -1 if wc < 0 else 1
    sign_b = -parity * s * sign_a * sign_c

    # The third kind loses as many bits as |n| has, twice over.
    bits = CONSTANT_BITS + 2 * max(
        0, (1 - n).numerator.bit_length() - (1 - n).denominator.bit_length()
    )
    with ball_precision(bits):
        pi = flint.arb.pi()
        momentum = root(ia**2 * wa**2 + ib**2 * wb**2 + ic**2 * wc**2)
        rate = root(s * (ia - ib) * p / (ia * ib * ic))
        zeta = _first_kind(1 / (1 - n), m1)
        u0 = _first_kind(wb**2 / size_b2, k2) * (1 if (wb > 0) == (sign_b > 0) else -1)
        near_one = k2 > Fraction(1, 2)
        # Only one of the two can be infinite, the one that is not scaled by.
        quarter = None if m1 == 0 else _first_kind(Fraction(1), k2)
        other = None if k2 == 0 else _first_kind(Fraction(1), m1)
        near, far = (other, quarter) if near_one else (quarter, other)
        assert near is not None
        half, jump, slope = DoubleDouble(math.inf, 0.0), flint.arb(0), momentum / _real(ib)
        if quarter is not None:
            half = DoubleDouble.of(2 * quarter / rate)
            third = quarter + _real(n / 3) * _third_kind(m1, n)
            advance = 2 * momentum / rate * (quarter - _real((ia - ic) / ia) * third) / _real(ic)
            # The phase of theta1 grows by pi in half a period, in the turned form by less.
            jump = -s * (pi - pi * zeta / near) if near_one else -s * pi
            slope = (advance - jump) / (2 * quarter) * rate
        return Constants(
            axes=(axes[0], axes[1], axes[2]),
            amplitudes=(
                sign_a * float(root(size_a2)),
                sign_b * float(root(size_b2)),
                sign_c * float(root(size_c2)),
            ),
            side=s,
            rate=float(rate),
            modulus2=float(k2),
            complement2=float(m1),
            near_one=near_one,
            log_nome=-math.inf if far is None else -float(pi * far / near),
            scale=float(pi / (2 * near)),
            shift=float(zeta * pi / (2 * near)),
            half=half,
            offset=DoubleDouble.of(u0 / rate),
            slope=DoubleDouble.of(slope / (4 * pi)),
            jump=DoubleDouble.of(jump / (4 * pi)),
            momentum=float(momentum),
        )


def _real(x: Fraction) -> Any:
    """A fraction at the precision in use."""
    return flint.arb(flint.fmpq(x.numerator, x.denominator))


def root(x: Fraction) -> Any:
    """A square root at the precision in use."""
    return _real(x).sqrt()


def _first_kind(sine2: Fraction, modulus2: Fraction) -> Any:
    """F for an amplitude up to a quarter turn, from the square of its sine [DLMF] 19.25.5."""
    cosine2, delta2 = _real(1 - sine2), _real(1 - modulus2 * sine2)
    return root(sine2) * flint.acb.elliptic_rf(cosine2, delta2, 1).real


def _third_kind(complement2: Fraction, n: Fraction) -> Any:
    """R_J of the complete integral of the third kind [DLMF] 19.25.2."""
    return flint.acb.elliptic_rj(0, _real(complement2), 1, _real(1 - n)).real


# exp(-SMALL) is below rounding. The nome is at most exp(-pi): at most four terms are needed.
SMALL = -math.log(EPS / 8)


def functions(u: NDArray[np.float64], top: Constants) -> tuple[Any, Any, Any, Any]:
    """sn, cn, dn and the periodic part of the phase for |u| <= K.

    Equation
    --------
    sn = theta3 theta1(z) / (theta2 theta4(z)), and so on       [DLMF] 22.2.4 to 22.2.6
    phase = arg(i theta1(z - i y)), from -pi/2 at -K to pi/2 at K

    For moduli near one the series are turned by Jacobi's imaginary transformation: sums of
    hyperbolic functions, whose terms fall off just as fast [DLMF] 20.7.30.

    Examples
    --------
    >>> from geomtorsion.rigid.free_top_series import constants
    >>> top = constants((Fraction(1), Fraction(2), Fraction(3)), (Fraction(1),) * 3)
    >>> sn, cn, dn, phase = functions(np.array([0.3]), top)
    >>> bool(abs(sn**2 + cn**2 - 1) < 1e-15), bool(abs(dn**2 + top.modulus2 * sn**2 - 1) < 1e-15)
    (True, True)
    """
    return _turned(u * top.scale, top) if top.near_one else _plain(u * top.scale, top)


def _powers(top: Constants) -> tuple[list[float], list[float]]:
    """Exponents n(n+1) ln q and n^2 ln q for n = 1, 2 ...; minus infinity for q = 0."""
    log = top.log_nome
    # Term n + 1 is below q^(n(n+1)) of the first, for arguments stay within a quarter period.
    terms = range(1, 1 + math.ceil((math.sqrt(1 - 4 * SMALL / log) - 1) / 2))
    return [n * (n + 1) * log for n in terms], [n * n * log for n in terms]


def _plain(z: NDArray[np.float64], top: Constants) -> tuple[Any, Any, Any, Any]:
    """The functions for k^2 <= 1/2; z = pi u / 2K."""
    y = top.shift
    odd, even = _powers(top)
    s1, c2 = np.sin(z), np.cos(z)
    t3, t4 = np.ones_like(z), np.ones_like(z)
    null2 = null3 = null4 = 1.0
    # Both parts of theta1 are divided by cosh y, which overflows where the cone closes.
    across, along = np.sin(z), np.cos(z) * np.tanh(y)
    damp = 1 + np.exp(-2 * y)
    for n in range(1, 1 + len(odd)):
        sign = -1 if n % 2 else 1
        m = 2 * n + 1
        q_odd, q_even = np.exp(odd[n - 1]), np.exp(even[n - 1])
        sine, cosine = np.sin(m * z), np.cos(m * z)
        s1 += sign * q_odd * sine
        c2 += q_odd * cosine
        wave = 2 * q_even * np.cos(2 * n * z)
        t3 += wave
        t4 += sign * wave
        null2 += q_odd
        null3 += 2 * q_even
        null4 += sign * 2 * q_even
        size = sign * np.exp(odd[n - 1] + 2 * n * y) / damp
        across += size * (1 + np.exp(-2 * m * y)) * sine
        along += size * -np.expm1(-2 * m * y) * cosine
    sn = (null3 / null2) * s1 / t4
    cn = (null4 / null2) * c2 / t4
    dn = (null4 / null3) * t3 / t4
    return sn, cn, dn, np.arctan2(across, along)


def _turned(w: NDArray[np.float64], top: Constants) -> tuple[Any, Any, Any, Any]:
    """The functions for k^2 > 1/2; w = pi u / 2K', nome of the complementary modulus."""
    y = top.shift
    odd, even = _powers(top)
    v = np.abs(w)
    # All sums are divided by exp(v) / 2, so that nothing overflows far out.
    sinh, cosh = -np.expm1(-2 * v), 1 + np.exp(-2 * v)
    across, along = sinh * np.cos(y), cosh * np.sin(y)
    flat = 2 * np.exp(-v)
    t3, t4 = flat.copy(), flat.copy()
    null2 = null3 = null4 = 1.0
    sh, ch = sinh.copy(), cosh.copy()
    for n in range(1, 1 + len(odd)):
        sign = -1 if n % 2 else 1
        m = 2 * n + 1
        q_odd, q_even = np.exp(odd[n - 1]), np.exp(even[n - 1])
        size = np.exp(odd[n - 1] + 2 * n * v)
        sine, cosine = size * -np.expm1(-2 * m * v), size * (1 + np.exp(-2 * m * v))
        sh += sign * sine
        ch += cosine
        across += sign * sine * np.cos(m * y)
        along += sign * cosine * np.sin(m * y)
        wave = 2 * np.exp(even[n - 1] + (2 * n - 1) * v) * (1 + np.exp(-4 * n * v))
        t3 += wave
        t4 += sign * wave
        null2 += q_odd
        null3 += 2 * q_even
        null4 += sign * 2 * q_even
    sign_w = np.sign(w)
    sn = sign_w * (null3 / null4) * sh / ch
    cn = (null2 / null4) * t4 / ch
    dn = (null2 / null3) * t3 / ch
    return sn, cn, dn, np.arctan2(sign_w * across, along)
