"""Free tops to fifty digits by two routes independent of the package."""

import mpmath

BITS = 200
ORDER = 60


def by_series(moments, omega, quaternion, end, step=0.125):
    """States at `end` by Taylor series in fixed point numbers of 200 bits.

    I_i Omega_i' = (I_j - I_k) Omega_j Omega_k and q' = q (0, Omega) / 2 are quadratic: their series
    follow from Cauchy products of whole numbers.
    """
    one = 1 << BITS

    def fixed(x):
        with mpmath.workprec(2 * BITS):
            return int(mpmath.nint(mpmath.mpf(x) * one))

    def fixed_ratio(j, k, i):
        with mpmath.workprec(2 * BITS):
            return int(mpmath.nint((mpmath.mpf(j) - k) / i * one))

    a, b, c = moments
    gains = [fixed_ratio(b, c, a), fixed_ratio(c, a, b), fixed_ratio(a, b, c)]
    state = [fixed(x) for x in (*omega, *quaternion)]
    steps = abs(round(end / step))
    assert steps * step == abs(end)
    step = step if end > 0 else -step
    h = fixed(step)

    def cauchy(x, y):
        return sum(p * q for p, q in zip(x, reversed(y), strict=True)) >> BITS

    for _ in range(steps):
        series = [[x] for x in state]
        for n in range(ORDER):
            w1, w2, w3, q0, q1, q2, q3 = series
            slopes = [
                gains[0] * cauchy(w2, w3) >> BITS,
                gains[1] * cauchy(w3, w1) >> BITS,
                gains[2] * cauchy(w1, w2) >> BITS,
                (-cauchy(q1, w1) - cauchy(q2, w2) - cauchy(q3, w3)) >> 1,
                (cauchy(q0, w1) + cauchy(q2, w3) - cauchy(q3, w2)) >> 1,
                (cauchy(q0, w2) + cauchy(q3, w1) - cauchy(q1, w3)) >> 1,
                (cauchy(q0, w3) + cauchy(q1, w2) - cauchy(q2, w1)) >> 1,
            ]
            for each, slope in zip(series, slopes, strict=True):
                each.append(slope // (n + 1))
        state = []
        for each in series:
            total = 0
            for coefficient in reversed(each):
                total = (total * h >> BITS) + coefficient
            state.append(total)
    with mpmath.workprec(2 * BITS):
        return [mpmath.mpf(x) / one for x in state]


def by_integrals(moments, omega, time):
    """Rates and body-to-space matrix from mpmath's ellipfun and quadrature of the precession.

    For moments in ascending order and L^2 > 2 T I_2. Euler angles are about axis 3, around which
    the momentum moves (the package counts its precession about another axis); space is the body at
    t = 0.
    """
    with mpmath.workdps(40):
        i1, i2, i3 = (mpmath.mpf(x) for x in moments)
        w1, w2, w3 = (mpmath.mpf(x) for x in omega)
        energy2 = i1 * w1**2 + i2 * w2**2 + i3 * w3**2
        square = (i1 * w1) ** 2 + (i2 * w2) ** 2 + (i3 * w3) ** 2
        size1 = mpmath.sqrt((energy2 * i3 - square) / (i1 * (i3 - i1)))
        size2 = mpmath.sqrt((energy2 * i3 - square) / (i2 * (i3 - i2)))
        size3 = mpmath.sqrt((square - energy2 * i1) / (i3 * (i3 - i1)))
        assert w3 > 0
        assert square > energy2 * i2
        rate = mpmath.sqrt((i3 - i2) * (square - energy2 * i1) / (i1 * i2 * i3))
        m = (i2 - i1) * (energy2 * i3 - square) / ((i3 - i2) * (square - energy2 * i1))
        # Omega_2' has the sign of Omega_3 Omega_1: sn and cn with one sign for both.
        phase = mpmath.atan2(w2 / size2, w1 / size1)
        u0 = mpmath.ellipf(phase, m)
        quarter = mpmath.ellipk(m)

        def rates(t):
            u = rate * t + u0
            u -= 4 * quarter * mpmath.nint(u / (4 * quarter))
            sn, cn, dn = (mpmath.ellipfun(name, u, m=m) for name in ("sn", "cn", "dn"))
            return size1 * cn, size2 * sn, size3 * dn

        length = mpmath.sqrt(square)

        def precession(t):
            a, b, _ = rates(t)
            across = (i1 * a) ** 2 + (i2 * b) ** 2
            return length * (i1 * a**2 + i2 * b**2) / across

        whole = 2 * quarter / rate
        count = mpmath.floor(time / whole)
        pieces = mpmath.linspace(0, 1, 5)
        angle = count * mpmath.quad(precession, [whole * x for x in pieces])
        rest = time - whole * count
        angle += mpmath.quad(precession, [rest * x for x in pieces])

        def attitude(t, about):
            a, b, c = (i * w / length for i, w in zip((i1, i2, i3), rates(t), strict=True))
            flat = mpmath.sqrt(a * a + b * b)
            # Rows: e_x, e_y, e_z of the axes of L, written in the body, then rotated around L.
            x = mpmath.matrix([a * c / flat, b * c / flat, -flat])
            y = mpmath.matrix([-b / flat, a / flat, 0])
            rows = mpmath.zeros(3, 3)
            for k in range(3):
                rows[0, k] = -mpmath.cos(about) * x[k] + mpmath.sin(about) * y[k]
                rows[1, k] = -mpmath.sin(about) * x[k] - mpmath.cos(about) * y[k]
                rows[2, k] = (a, b, c)[k]
            return rows

        return rates(time), attitude(mpmath.mpf(0), mpmath.mpf(0)).T * attitude(time, angle)
