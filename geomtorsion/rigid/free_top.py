"""Free top: rates and attitude of a force-free rigid body at any time, without stepping."""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import flint
import numpy as np
from numpy.typing import ArrayLike, NDArray

from geomtorsion.codegen import exact_number
from geomtorsion.errors import StartError, TimeError
from geomtorsion.ode.numbers import Real, checked_numbers, floats
from geomtorsion.rigid.attitude import product, rotated
from geomtorsion.rigid.double_double import DoubleDouble, reduced, turns
from geomtorsion.rigid.free_top_series import Constants, constants, functions, is_steady, root
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.precision import EPS, EXACT_BITS, PRINTED, ball_precision


def tilted(momentum: NDArray[Any], precession: NDArray[Any], top: Constants) -> NDArray[Any]:
    """Quaternion of Rz(precession) Ry(tilt) Rz(spin), which takes this momentum to axis z.

    z is axis c here. The spin never leaves a half turn about its middle, since the momentum
    about axis a keeps its sign: no jumps, and the quaternion is continuous.
    """
    a, b, c = top.axes
    sign_a = math.copysign(1.0, top.amplitudes[0])
    even = (a, b, c) in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
    la, lb, lc = sign_a * momentum[..., a], sign_a * momentum[..., b], momentum[..., c]
    if even:
        # x = a, y = b: sin spin ~ L_y, cos spin ~ -L_x.
        spin = (math.pi if sign_a > 0 else 0.0) + np.arctan2(-lb, la)
    else:
        # x = b, y = a.
        spin = sign_a * math.pi / 2 + np.arctan2(lb, la)
    flat = np.hypot(la, lb)
    tilt = np.arctan2(flat, lc) / 2
    plus, minus = (precession + spin) / 2, (precession - spin) / 2
    cos, sin = np.cos(tilt), np.sin(tilt)
    turned = np.empty((*precession.shape, 4))
    turned[..., 0] = cos * np.cos(plus)
    # Ry leaves sin(tilt) (x, y) = sin(tilt) (-sin minus, cos minus); x, y, z are cyclic axes.
    x, y = (a, b) if even else (b, a)
    turned[..., 1 + x] = -sin * np.sin(minus)
    turned[..., 1 + y] = sin * np.cos(minus)
    turned[..., 1 + c] = cos * np.sin(plus)
    return turned


FULL = 4 * math.pi  # quaternions return after two turns
# Products of four moments or rates between 1/WIDE and WIDE are doubles.
WIDE = 10.0 ** (sys.float_info.max_10_exp // 4)
# Beyond so many half periods doubles no longer distinguish one from the next.
FLIPS = 0.5 / EPS


@dataclass(frozen=True)
class FreeTop:
    """Torque-free rigid body in closed form; made by `free_top`.

    moments: principal moments of inertia, shape (3,); mass times length squared.
    omega0: body-fixed angular velocity at t = 0, shape (3,); radians per time.
    quaternion0: attitude at t = 0, body to space, scalar part first, shape (4,).

    Numbers that no float holds, such as Fraction(6, 5), stay exact.
    """

    moments: tuple[Real, Real, Real]
    omega0: tuple[Real, Real, Real]
    quaternion0: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)

    @cached_property
    def _exact(self) -> tuple[tuple[Fraction, ...], tuple[Fraction, ...]]:
        """Moments and rates as fractions, irrational ones to many digits.

        Whether two moments agree, or a rate is 0, must not depend on rounding; and an error of the
        period would be multiplied by the number of periods.
        """
        moments, rates = (tuple(map(_fraction, row)) for row in (self.moments, self.omega0))
        return moments, rates

    @cached_property
    def _moments(self) -> NDArray[np.float64]:
        return np.array(floats(self.moments))

    @cached_property
    def _omega0(self) -> NDArray[np.float64]:
        return np.array(floats(self.omega0))

    @cached_property
    def constants(self) -> Constants | None:
        """Modulus, period, precession; None where the rates are constant."""
        return None if is_steady(*self._exact) else constants(*self._exact)

    @property
    def kind(self) -> str:
        """rest, spherical, steady, symmetric, asymmetric or separatrix.

        Examples
        --------
        >>> free_top((1, 2, 3), (0, 1, 0)).kind, free_top((1, 2, 3), (1e-12, 1, 0)).kind
        ('steady', 'asymmetric')
        """
        if not any(self.omega0):
            return "rest"
        different = len(set(self._exact[0]))
        if different == 1:
            return "spherical"
        if self.constants is None:
            return "steady"
        if different == 2:
            return "symmetric"
        return "separatrix" if self.constants.complement2 == 0 else "asymmetric"

    @property
    def energy(self) -> float:
        """Kinetic energy T = (1/2) I_i Omega_i^2."""
        return float(sum(i * w * w for i, w in zip(*self._exact, strict=True)) / 2)

    @property
    def momentum(self) -> NDArray[Any]:
        """Angular momentum in space, constant, shape (3,)."""
        return rotated(np.array(self.quaternion0), self._moments * self._omega0)

    @property
    def period(self) -> float:
        """Period of the rates; infinite on the separatrix, nan if constant.

        Examples
        --------
        >>> round(free_top((1, 2, 3), (1, 1, 1)).period, 6)
        6.422703
        """
        return math.nan if self.constants is None else 2 * self.constants.half.high

    @property
    def flip_time(self) -> float:
        """Time between two changes of sign of the rate about the middle axis: half a period.

        Infinite on the separatrix, nan for constant rates. See `first_flip` for when it begins.
        """
        return math.nan if self.constants is None else self.constants.half.high

    @property
    def first_flip(self) -> float:
        """First time t > 0 at which the rate about the middle axis changes sign.

        nan if it never does.

        Examples
        --------
        A racket thrown 1e-12 off its middle axis:

        >>> racket = free_top((1, 2, 3), (1e-12, 1, 0))
        >>> round(racket.first_flip, 6), round(racket.flip_time, 6)
        (50.259465, 100.518929)
        """
        top = self.constants
        if top is None:
            return math.nan
        if top.offset.high < 0:
            return -top.offset.high
        later = (top.half.high - top.offset.high) + (top.half.low - top.offset.low)
        return later if math.isfinite(later) else math.nan

    def omega(self, times: ArrayLike) -> NDArray[Any]:
        """Body-fixed angular velocity, radians per time, shape (..., 3) for times of shape (...).

        Equation
        --------
        Omega_a = A_a dn u, Omega_b = A_b sn u, Omega_c = A_c cn u      [Jacobi1849]

        Examples
        --------
        >>> top = free_top((1, 2, 3), (1, 1, 1))
        >>> bool(abs(top.omega(top.period) - 1).max() < 1e-15)
        True
        """
        t = self._checked(times)
        if self.constants is None:
            return np.broadcast_to(self._omega0, (*t.shape, 3)).copy()
        return self._rates(t, self.constants)[0]

    def quaternion(self, times: ArrayLike) -> NDArray[Any]:
        """Attitude, body to space, scalar part first, continuous in time; shape (..., 4).

        Equation
        --------
        Two turns, about L by the precession of axis c (an integral of the third kind, written
        as the argument of theta1), and in the body by atan2(Omega_b I_b, Omega_a I_a)
        [LandauLifshitz1] section 37

        Raises
        ------
        TimeError
            A time is not finite, or so late that doubles cannot distinguish one flip from the next.

        Examples
        --------
        >>> top = free_top((1, 1, 2), (0, 0, 3))
        >>> top.quaternion([0.0, 1.0]).round(12).tolist() == [
        ...     [1, 0, 0, 0], [round(math.cos(1.5), 12), 0, 0, round(math.sin(1.5), 12)]]
        True
        """
        return self._at(times)[1]

    def states(self, times: ArrayLike) -> NDArray[Any]:
        """Rates, then attitude: shape (..., 7), as Omega1..3, q0..q3."""
        return np.concatenate(self._at(times), axis=-1)

    def _at(self, times: ArrayLike) -> tuple[NDArray[Any], NDArray[Any]]:
        """Rates and attitude."""
        t = self._checked(times)
        top = self.constants
        if top is None:
            omega = np.broadcast_to(self._omega0, (*t.shape, 3)).copy()
            return omega, product(np.array(self.quaternion0), self._uniform(t))
        omega, precession = self._rates(t, top)
        turned = tilted(omega * self._moments, precession, top)
        return omega, product(self._space, turned)

    @cached_property
    def _space(self) -> NDArray[Any]:
        """Quaternion that takes the axes along L to the axes of space."""
        top = self.constants
        assert top is not None
        omega, precession = self._rates(np.zeros(1), top)
        begin = tilted(omega * self._moments, precession, top)[0]
        return product(np.array(self.quaternion0), begin * np.array([1.0, -1.0, -1.0, -1.0]))

    def _uniform(self, t: NDArray[Any]) -> NDArray[Any]:
        """The turn of constant rates."""
        # More than two doubles, for the turns that are taken out before the cosine.
        with ball_precision(140):
            speed = root(sum((w**2 for w in self._exact[1]), Fraction(0)))
            axis = self._omega0 / (float(speed) or 1.0)
            half = FULL / 2 * turns(t, DoubleDouble.of(speed / (4 * flint.arb.pi())))
        return np.stack([np.cos(half), *(np.sin(half) * x for x in axis)], axis=-1)

    def _checked(self, times: ArrayLike) -> NDArray[Any]:
        """Times as an array of finite numbers, early enough to be distinguished."""
        infinite = "a time of a free top is not finite. Give finite times."
        t = checks.array(times, "times", TimeError, infinite=infinite)
        top = self.constants
        if top is not None and t.size and np.abs(t).max() > FLIPS * top.half.high:
            raise TimeError(
                f"expected times up to {FLIPS * top.half.high:.3g} (the period of "
                f"the rates is {self.period:.6g}), got {np.abs(t).max():.3g}. A double has too few "
                "digits to locate later times within a period."
            )
        return t

    def _rates(self, t: NDArray[Any], top: Constants) -> tuple[NDArray[Any], NDArray[Any]]:
        """Body-fixed rates, and the angle of precession about L."""
        count, left = reduced(t, top.offset, top.half)
        # The phase at the start of the half period is omitted: attitudes count from t = 0.
        steady = turns(t, top.slope) + turns(count, top.jump)
        sn, cn, dn, phase = functions(top.rate * left, top)
        sign = 1 - 2 * np.mod(count, 2)
        a, b, c = top.axes
        omega = np.empty((*t.shape, 3))
        size_a, size_b, size_c = top.amplitudes
        omega[..., a] = size_a * dn
        omega[..., b] = size_b * sign * sn
        omega[..., c] = size_c * sign * cn
        return omega, FULL * steady - top.side * phase


def _fraction(value: Real) -> Fraction:
    """A number as a fraction; an irrational one to EXACT_BITS bits."""
    exact = exact_number(value, EXACT_BITS)
    return Fraction(checks.fraction(exact) or 0)


def _shortest(value: Real) -> Real:
    """A number as a float where a float holds it, else as it came."""
    return float(value) if _fraction(value) == Fraction(float(value)) else value


def free_top(moments: object, omega: object, quaternion: object = (1.0, 0.0, 0.0, 0.0)) -> FreeTop:
    """Torque-free top with given principal moments and initial angular velocity.

    Equation
    --------
    I_i Omega_i' + eps_ijk Omega_j I_k Omega_k = 0, q' = (1/2) q (0, Omega)

    Parameters
    ----------
    moments
        Principal moments of inertia, shape (3,), any order, positive.
    omega
        Body-fixed angular velocity at t = 0, shape (3,), radians per time. Fractions and exact
        numbers of sympy stay exact, here and in moments.
    quaternion
        Attitude at t = 0, body to space, scalar part first, shape (4,), of unit length.

    Returns
    -------
    FreeTop, with `.omega(t)`, `.quaternion(t)`, `.period`, `.flip_time`, `.kind`, `.energy`,
    `.momentum`. Errors stay at rounding next to the separatrix, for moments that nearly agree,
    and at any time: no error accumulates, since there are no steps.

    Raises
    ------
    StartError
        A moment is not positive, a number is not finite or huge, or the quaternion not of length 1.
    ShapeError
        A list is of the wrong length.

    Examples
    --------
    >>> top = free_top((1, 2, 3), (1e-3, 1, 1e-3))
    >>> top.kind, round(top.flip_time, 6)
    ('asymmetric', 27.530841)
    """
    given = [checked_numbers(moments, 3, "moments"), checked_numbers(omega, 3, "omega")]
    sizes, rates = (floats(row) for row in given)
    start = floats(checked_numbers(quaternion, 4, "quaternion"))
    for k, size in enumerate(sizes):
        checks.positive(size, f"moments[{k}]", StartError, expected="a positive moment of inertia")
    if not all(1 / WIDE <= x <= WIDE for x in (*sizes, max(map(abs, rates)) or 1.0)):
        raise StartError(
            f"moments and rates: expected sizes between {1 / WIDE:g} and {WIDE:g}, got others. Use "
            "other units."
        )
    length = math.hypot(*start)
    if not abs(length - 1) <= PRINTED:
        raise StartError(
            f"quaternion: expected length 1, got {start} of length {length:.9g}. Divide it by its "
            "length."
        )
    (a, b, c), (u, v, w) = ([_shortest(x) for x in row] for row in given)
    q, x, y, z = (part / length for part in start)
    return FreeTop((a, b, c), (u, v, w), (q, x, y, z))
