"""Theta series: Jacobi's functions of a free top and the phase of its precession."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from geomtorsion.rigid.free_top_constants import Constants

# exp(-38) is below rounding. The nome is at most exp(-pi): at most four terms are needed.
SMALL = 38.0


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
    >>> from geomtorsion.rigid.free_top_constants import constants
    >>> top = constants((1.0, 2.0, 3.0), (1.0, 1.0, 1.0))
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
