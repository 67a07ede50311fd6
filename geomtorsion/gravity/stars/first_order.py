"""First order of general relativity about a star: a slow rotation and a static tide.

Rotation: w(r) is the angular velocity of the star that its local frame sees (Hartle 1967). Tide:
H(r) = -h_tt/A^2 of the harmonic l = 2 (Hinderer 2008). The static metric is
-A^2 dt^2 + B^2 dr^2 + r^2 (sphere).
"""

from __future__ import annotations

from collections.abc import Mapping

import mpmath
import sympy as sp

from geomtorsion.gravity.states.equation_of_state import ETA

R = sp.Symbol("r")
A, B, X, K, W = (sp.Function(name)(R) for name in ("A", "B", "eta", "K", "w"))
# Symbols of a solution, and the states at first order.
SIZE, LAPSE, RADIAL = sp.symbols("r A B", real=True)
TIDE, SLOPE, SPIN, MOMENT = sp.symbols("H tide_slope w spin_moment", real=True)


def conditions(pressure: sp.Expr, density: sp.Expr) -> list[sp.Eq]:
    """Equations of K = H/r^2 and w for a regular centre.

    pressure, density: functions of eta, with G = c = 1.
    """
    p, rho = (x.xreplace({ETA: X}) for x in (pressure, density))
    tide = _tide(p, rho, R, B, R**2 * K, (R**2 * K).diff(R))
    # The density changes with the logarithm of the enthalpy of a particle, (rho + p) dh = dp.
    softness = (density.diff(ETA) * (pressure + density) / pressure.diff(ETA)).xreplace({ETA: X})
    tide -= 4 * sp.pi * B**2 * R**2 * K * softness
    spin = _drag(p + rho, R, B)
    return [
        sp.Eq(K.diff(R, 2), (tide - 2 * K - 4 * R * K.diff(R)) / R**2),
        sp.Eq(W.diff(R, 2), -(4 / R + spin) * W.diff(R) - 4 / R * spin * W),
    ]


def _drag(inertia: sp.Expr, r: sp.Expr, B: sp.Expr) -> sp.Expr:
    """j'/j for j = 1/(A B)."""
    return -4 * sp.pi * r * B**2 * inertia


def _lapse(pressure: sp.Expr, r: sp.Expr, B: sp.Expr) -> sp.Expr:
    """A'/A."""
    return (B**2 * (1 + 8 * sp.pi * r**2 * pressure) - 1) / (2 * r)


def _tide(p: sp.Expr, rho: sp.Expr, r: sp.Expr, B: sp.Expr, H: sp.Expr, slope: sp.Expr) -> sp.Expr:
    """H'' without the term of the change of the density, - 4 pi B^2 H drho/dh."""
    first = 2 / r + (B**2 - 1) / r + 4 * sp.pi * r * B**2 * (p - rho)
    zeroth = -6 * B**2 / r**2 + 4 * sp.pi * B**2 * (5 * rho + 9 * p) - 4 * _lapse(p, r, B) ** 2
    return -first * slope - zeroth * H


def rates(pressure: sp.Expr, density: sp.Expr) -> dict[str, sp.Expr]:
    """State -> its derivative by r, for H, the slope of the tide, w and its moment.

    The slope is H' - 4 pi B^2 H rho A/A', which does not jump with the density. The moment is
    r^4 j w' with j = 1/(A B).
    """
    r, B, A = SIZE, RADIAL, LAPSE
    lapse = _lapse(pressure, r, B)
    # Its change along r: the pressure falls by (p + rho) A'/A.
    radial = B * (1 - B**2 * (1 - 8 * sp.pi * r**2 * density)) / (2 * r)
    weight = 4 * sp.pi * B**2 / lapse
    falling = -(pressure + density) * lapse
    p = sp.Dummy("p")
    general = _lapse(p, r, B)
    change = general.diff(r) + general.diff(B) * radial + general.diff(p) * falling
    change = change.xreplace({p: pressure})
    weight_rate = weight * (2 * radial / B - change / lapse)
    slope = SLOPE + weight * density * TIDE
    second = _tide(pressure, density, r, B, TIDE, slope)
    j = 1 / (A * B)
    return {
        TIDE.name: slope,
        SLOPE.name: second - density * (weight_rate * TIDE + weight * slope),
        SPIN.name: MOMENT / (r**4 * j),
        MOMENT.name: -4 * r**3 * j * _drag(pressure + density, r, B) * SPIN,
    }


def start(
    place: sp.Expr, values: Mapping[str, sp.Expr], pressure: sp.Expr, density: sp.Expr
) -> dict[str, sp.Expr]:
    """The states at first order beside the centre, from K, w and their derivatives there.

    pressure, density: numbers there.
    """
    r, B = place, values["B"]
    H, slope = r**2 * values["K"], 2 * r * values["K"] + r**2 * values["K_1"]
    weight = 4 * sp.pi * B**2 / _lapse(pressure, r, B)
    return {
        TIDE.name: H,
        SLOPE.name: slope - weight * density * H,
        SPIN.name: values["w"],
        MOMENT.name: r**4 * values["w_1"] / (values["A"] * B),
    }


def love_number(compactness: float, slope: float) -> float:
    """The tidal Love number k2 of a star from y = R H'/H outside of its surface.

    compactness: M/R. slope: y (Hinderer 2008, with the erratum of 2009).

    Examples
    --------
    >>> round(love_number(1e-9, 1e-9), 6)  # no central concentration: a light incompressible star
    0.333333
    >>> round(love_number(1e-9, -1.0), 6)
    0.75
    """
    # The terms of the denominator cancel up to the fifth power of the compactness.
    with mpmath.workdps(80):
        c, y = mpmath.mpf(compactness), mpmath.mpf(slope)
        red = 1 - 2 * c
        above = 2 + 2 * c * (y - 1) - y
        below = 2 * c * (6 - 3 * y + 3 * c * (5 * y - 8))
        below += 4 * c**3 * (13 - 11 * y + c * (3 * y - 2) + 2 * c**2 * (1 + y))
        below += 3 * red**2 * above * mpmath.log(red)
        return float(mpmath.mpf(8) / 5 * c**5 * red**2 * above / below)
