"""Charged holes: gravitational and electromagnetic waves are coupled, in both parities."""

from __future__ import annotations

import mpmath
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError
from geomtorsion.gravity import perturbed

t, r, theta, phi, M, Q, w, x = sp.symbols("t r theta phi M Q w x")
FIELD = gt.gravity.maxwell(["Q/r", 0, 0, 0])
# Horizons at 8/5 and 2/5.
NUMBERS = {"M": 1, "Q": "4/5"}


def charged() -> gt.Frame:
    f = 1 - 2 * M / r + Q**2 / r**2
    rows = sp.diag(sp.sqrt(f), 1 / sp.sqrt(f), r, r * sp.sin(theta))
    domain = [r > M + sp.sqrt(M**2 - Q**2), theta > 0, sp.pi > theta]
    return gt.Frame([t, r, theta, phi], rows, signature="-+++", parameters=[M, Q], domain=domain)


def moncrief(sign: int, start: complex, count: int = 160) -> mpmath.mpc:
    """A root of the equation of Moncrief (1974) for l = 2, M = 1, Q = 4/5, sign of its potential.

    psi = exp(i w r) ... sum a_n x^n with x = (r - r_+)/(r - r_-), where a_n decreases only at a
    frequency of the hole [Leaver 1990]. The recursion is derived here and run forwards.
    """
    outer, inner, squared = sp.Rational(8, 5), sp.Rational(2, 5), sp.Rational(16, 25)
    root = sp.sqrt(9 + 16 * squared)
    one, two = 3 + sign * root, 3 - sign * root
    f = (r - outer) * (r - inner) / r**2
    potential = f / r**3 * (6 * r - two * (1 + one / (4 * r)))
    slope = sp.I * w * (1 + 2 / (r - inner))
    slope -= sp.I * w * outer**2 / (outer - inner) * (1 / (r - outer) - 1 / (r - inner))
    bend = f.diff(r) / f
    rest = slope.diff(r) + slope**2 + bend * slope + (w**2 - potential) / f**2
    rate = (outer - inner) / (r - inner) ** 2
    back = (outer - inner * x) / (1 - x)
    terms = (rate**2, rate.diff(r) + (2 * slope + bend) * rate, rest)
    parts = [sp.cancel(sp.together(one.subs(r, back))) for one in terms]
    common = sp.lcm_list([sp.denom(one) for one in parts])
    rows = [sp.Poly(sp.cancel(one * common), x).all_coeffs()[::-1] for one in parts]
    functions = [[sp.lambdify(w, c, "mpmath") for c in row] for row in rows]
    factors = (lambda m: m * (m - 1), lambda m: m, lambda m: 1)

    def last(value: mpmath.mpc) -> mpmath.mpc:
        """The coefficient a_n of the series for a large n."""
        numbers = [[mpmath.mpc(g(value)) for g in row] for row in functions]
        shifts = [k - 2 + i for i, row in enumerate(rows) for k, c in enumerate(row) if c != 0]
        a = [mpmath.mpc(1)]
        for n in range(1, count + 1):
            total = lead = mpmath.mpc(0)
            for i, row in enumerate(numbers):
                for k, c in enumerate(row):
                    m = n + min(shifts) - k + 2 - i
                    if m == n:
                        lead += c * factors[i](m)
                    elif 0 <= m < n:
                        total += c * factors[i](m) * a[m]
            a.append(-total / lead)
        return a[-1]

    with mpmath.workdps(40):
        near = [
            mpmath.mpc(start) * (1 + e) for e in (0, mpmath.mpf("0.001"), mpmath.mpc(0, "0.001"))
        ]
        return mpmath.findroot(last, near, solver="muller", verify=False)


@pytest.mark.parametrize(
    ("parity", "sign", "start", "number"),
    [("axial", -1, 0.4 - 0.09j, 0), ("axial", 1, 0.57 - 0.1j, 1), ("polar", -1, 0.4 - 0.09j, 0)],
)
def test_both_parities_ring_as_published(
    parity: str, sign: int, start: complex, number: int
) -> None:
    """Gravity and light mix; axial and polar waves have the frequencies of Moncrief's equations."""
    rings = perturbed.ringing(
        "R - F2", charged(), parity=parity, modes=number + 1, parameters=NUMBERS, matter=FIELD
    )
    mode = rings.modes[number]
    assert abs(mode.omega - moncrief(sign, start)) < mode.error


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"matter": None}, "Give matter="),
        ({"matter": gt.gravity.maxwell(["2*Q/r", 0, 0, 0])}, "solves the equations, got E_00"),
        ({"matter": gt.gravity.maxwell([0, 0, 0, "Q*cos(theta)"])}, "electric charge"),
        ({"matter": gt.gravity.maxwell(["Q*t", 0, 0, 0])}, "electric charge"),
        ({"matter": "Q/r"}, "matter"),
        ({"parameters": {"M": 1}}, "'Q': 1"),
        ({"l": 1}, "l"),
    ],
)
def test_refusals(options: dict, words: str) -> None:
    arguments = {"parity": "axial", "parameters": NUMBERS, "matter": FIELD} | options
    with pytest.raises(GeomtorsionError, match=words):
        perturbed.ringing("R - F2", charged(), **arguments)
