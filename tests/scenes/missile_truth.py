"""A missile to fifty digits: Taylor series in fixed point numbers."""

import mpmath

BITS = 200
ORDER = 50


def missile(mass, moments, force, point, start, spans):
    """State (Omega, q, v, x) after a sequence of burns.

    mass, moments: of the body; force: body axes, N; point: where it acts, body axes.
    start: 13 numbers. spans: (seconds, whether it burns); seconds are multiples of 1/8.

    Equation
    --------
    I Omega' + Omega x I Omega = point x F, q' = q (0, Omega) / 2, m v' = R(q) F, x' = v
    """
    one = 1 << BITS

    def fixed(x):
        return int(mpmath.nint(x * one))

    with mpmath.workprec(2 * BITS):
        i1, i2, i3 = (mpmath.mpf(x) for x in moments)
        gains = [fixed((i2 - i3) / i1), fixed((i3 - i1) / i2), fixed((i1 - i2) / i3)]
        f = [mpmath.mpf(x) for x in force]
        a = [mpmath.mpf(x) for x in point]
        arm = [a[1] * f[2] - a[2] * f[1], a[2] * f[0] - a[0] * f[2], a[0] * f[1] - a[1] * f[0]]
        turning = [fixed(m / i) for m, i in zip(arm, (i1, i2, i3), strict=True)]
        pushing = [fixed(x / mpmath.mpf(mass)) for x in f]
        state = [fixed(mpmath.mpf(x)) for x in start]
    h = one >> 3

    def cauchy(x, y):
        return sum(p * q for p, q in zip(x, reversed(y), strict=True)) >> BITS

    for seconds, burning in spans:
        assert seconds * 8 == int(seconds * 8)
        for _ in range(int(seconds * 8)):
            series = [[x] for x in state]
            for n in range(ORDER):
                w1, w2, w3, q0, q1, q2, q3, v1, v2, v3, *_ = series
                on = burning and n == 0
                matrix = [
                    [(q0, q0, 1), (q1, q1, 1), (q2, q2, -1), (q3, q3, -1)],
                    [(q1, q2, 2), (q0, q3, -2)],
                    [(q1, q3, 2), (q0, q2, 2)],
                    [(q1, q2, 2), (q0, q3, 2)],
                    [(q0, q0, 1), (q1, q1, -1), (q2, q2, 1), (q3, q3, -1)],
                    [(q2, q3, 2), (q0, q1, -2)],
                    [(q1, q3, 2), (q0, q2, -2)],
                    [(q2, q3, 2), (q0, q1, 2)],
                    [(q0, q0, 1), (q1, q1, -1), (q2, q2, -1), (q3, q3, 1)],
                ]
                slopes = [
                    (gains[0] * cauchy(w2, w3) >> BITS) + on * turning[0],
                    (gains[1] * cauchy(w3, w1) >> BITS) + on * turning[1],
                    (gains[2] * cauchy(w1, w2) >> BITS) + on * turning[2],
                    (-cauchy(q1, w1) - cauchy(q2, w2) - cauchy(q3, w3)) >> 1,
                    (cauchy(q0, w1) + cauchy(q2, w3) - cauchy(q3, w2)) >> 1,
                    (cauchy(q0, w2) + cauchy(q3, w1) - cauchy(q1, w3)) >> 1,
                    (cauchy(q0, w3) + cauchy(q1, w2) - cauchy(q2, w1)) >> 1,
                ]
                for row in range(3):
                    pull = 0
                    for column in range(3):
                        entry = sum(s * cauchy(x, y) for x, y, s in matrix[3 * row + column])
                        pull += entry * pushing[column] >> BITS
                    slopes.append(pull if burning else 0)
                slopes += [v1[n], v2[n], v3[n]]
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
