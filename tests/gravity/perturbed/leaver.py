"""Leaver's series for a static hole: a second route to quasi-normal frequencies, for tests."""

import mpmath
import sympy as sp

r, w, k, x = sp.symbols("r w k x")


def frequency(
    potential: sp.Expr,
    horizons: tuple[sp.Rational, sp.Rational],
    start: complex,
    mass2: sp.Rational = sp.S.Zero,
    count: int = 160,
) -> mpmath.mpc:
    """A root of psi'' + (w^2 - V) psi = 0 in the tortoise radius, f = (r - r_+)(r - r_-)/r^2.

    psi = exp(i k r) ... sum a_n x^n with x = (r - r_+)/(r - r_-), where a_n decreases only at a
    frequency of the hole [Leaver 1985, 1990]. The recursion is derived here and run forwards.
    """
    outer, inner = horizons
    f = (r - outer) * (r - inner) / r**2
    # exp(i k r) r^(i M (2 k^2 + m^2)/k) far away, and falling waves at the horizon.
    mass = (outer + inner) / 2
    fall = w * outer**2 / (outer - inner)
    far = mass * (2 * k**2 + mass2) / k
    slope = sp.I * (k + (far + fall) / (r - inner) - fall / (r - outer))
    bend = f.diff(r) / f
    rest = slope.diff(r) + slope**2 + bend * slope + (w**2 - potential) / f**2
    rest = sp.cancel(sp.together(rest.subs(w**2, k**2 + mass2)))
    rate = (outer - inner) / (r - inner) ** 2
    back = (outer - inner * x) / (1 - x)
    terms = (rate**2, rate.diff(r) + (2 * slope + bend) * rate, rest)
    squared = sp.Poly(w**2 - k**2 - mass2, w)
    parts = [sp.cancel(sp.together(one.subs(r, back))) for one in terms]
    common = sp.lcm_list([sp.denom(one) for one in parts])
    rows = [sp.Poly(sp.cancel(one * common), x).all_coeffs()[::-1] for one in parts]
    # w^2 = k^2 + m^2, so that coefficients that vanish are zero.
    rows = [
        [sp.cancel(sp.rem(sp.Poly(sp.numer(c), w), squared).as_expr() / sp.denom(c)) for c in row]
        for row in (list(map(sp.together, row)) for row in rows)
    ]
    functions = [[sp.lambdify((w, k), c, "mpmath") for c in row] for row in rows]
    shifts = [p - 2 + i for i, row in enumerate(rows) for p, c in enumerate(row) if c != 0]
    factors = (lambda m: m * (m - 1), lambda m: m, lambda m: 1)

    def last(value: mpmath.mpc) -> mpmath.mpc:
        """The coefficient a_n of the series for a large n."""
        root = mpmath.sqrt(value**2 - mpmath.mpf(mass2.p) / mass2.q)
        root = root if root.real > 0 else -root
        numbers = [[mpmath.mpc(g(value, root)) for g in row] for row in functions]
        a = [mpmath.mpc(1)]
        for n in range(1, count + 1):
            total = lead = mpmath.mpc(0)
            for i, row in enumerate(numbers):
                for p, c in enumerate(row):
                    m = n + min(shifts) - p + 2 - i
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


def schwarzschild(
    l: int,  # noqa: E741
    start: complex,
    spin: int = 0,
    mass2: sp.Rational = sp.S.Zero,
    count: int = 160,
) -> mpmath.mpc:
    """A frequency of Regge and Wheeler's equation of a spin, or of a massive scalar, M = 1."""
    potential = (1 - 2 / r) * (sp.Integer(l * (l + 1)) / r**2 + 2 * (1 - spin**2) / r**3 + mass2)
    return frequency(potential, (sp.Integer(2), sp.Integer(0)), start, mass2, count)


def reissner_nordstrom(l: int, sign: int, start: complex, count: int = 160) -> mpmath.mpc:  # noqa: E741
    """A frequency of Moncrief's equation (1974), M = 1, Q = 4/5, with a sign of its potential."""
    horizons, squared = (sp.Rational(8, 5), sp.Rational(2, 5)), sp.Rational(16, 25)
    f = (r - horizons[0]) * (r - horizons[1]) / r**2
    pull = 3 - sign * sp.sqrt(9 + 4 * squared * (l - 1) * (l + 2))
    potential = f / r**3 * (l * (l + 1) * r - pull + 4 * squared / r)
    return frequency(potential, horizons, start, count=count)
