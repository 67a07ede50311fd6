"""Dense frames: laws and numbers of frames whose entries become long when expanded."""

from __future__ import annotations

from typing import Any

import mpmath
import pytest
import sympy as sp
from hypothesis import given, settings

from geomtorsion.errors import LimitError
from geomtorsion.geometry import Frame, cartan, contract, identities, levi_civita
from tests.laws.dense import dense_frames

t, r, x, y, z = sp.symbols("t r x y z", real=True)
M = sp.Symbol("M", positive=True)
f, g = sp.Function("f"), sp.Function("g")
HALF = sp.Rational(1, 2)
DENSE = {
    "polynomial, sine, unknown function": (
        (t, r),
        [[M * t / 2 + 2, (t**2 + 1) ** 2], [sp.sin(r) + HALF, f(t) * sp.cos(r - t) / 2 - 1]],
        None,
    ),
    "hyperbolic and exponential": (
        (t, r),
        [
            [2 + 1 / (2 * (t**2 + 2)), sp.sin(2 * t) / 2],
            [t * (sp.sin(r) + 2), sp.sinh(r) / 3 + 2 + sp.exp(-r) / 3],
        ],
        (-1, 1),
    ),
    "roots, tan and atan": (
        (x, y, z),
        [
            [2 + sp.sqrt(x**2 + 1), sp.tan(y / 2) / 2, 0],
            [sp.atan(z) / 2, 3 + sp.sqrt(y + 3), x / 2],
            [sp.exp(-z) / 3, 0, 2 + sp.cos(x - y)],
        ],
        (-1, 1, 1),
    ),
    "null metric": (
        (t, r),
        [[2 + sp.sqrt(t**2 + r**2 + 1), r * t], [sp.exp(t / 2), 3 + f(r) * t]],
        [[0, 1], [1, 0]],
    ),
}  # fmt: skip


def made(name: str) -> Frame:
    """A dense frame by its name."""
    coordinates, rows, signature = DENSE[name]
    return Frame(coordinates, rows, signature=signature)


@pytest.mark.parametrize("name", DENSE)
def test_identities_hold(name):
    """Metricity, decomposition, both Bianchi identities and the scalar identity hold."""
    for check in identities(cartan(made(name))):
        assert check.holds is True, check
        assert check.certainty.proved or check.certainty.error < 1e-30


@pytest.mark.parametrize("name", DENSE)
def test_numbers_agree_with_finite_differences(name):
    """The curvature scalar agrees with a difference quotient of the metric."""
    frame = made(name)
    coordinates = frame.coordinates
    n = len(coordinates)
    with mpmath.workdps(60):
        known = {f: lambda u: sp.sin(u) + u**2 / 3 + 2}
        rows = sp.Matrix(DENSE[name][1]).subs(M, sp.Rational(7, 5))
        rows = rows.replace(f, known[f])
        coframe = sp.lambdify(coordinates, rows.tolist(), "mpmath")
        eta = mpmath.matrix([[frame.eta[i, j] for j in range(n)] for i in range(n)])
        place = [mpmath.mpf(3 + k) / 7 for k in range(n)]

        def metric(*q):
            e = mpmath.matrix(coframe(*q))
            return e.T * eta * e

        want = curvature_scalar(metric, place)
        values = {s: sp.Rational(3 + k, 7) for k, s in enumerate(coordinates)}
        if M in frame.field.symbols:
            values[M] = sp.Rational(7, 5)
        values |= jets(frame, coordinates, values, known[f])
        have = levi_civita(frame).curvature.scalar.at(values, digits=40).item()
        assert abs(have - want) < mpmath.mpf(10) ** -12 * (1 + abs(want))


@pytest.mark.parametrize("name", DENSE)
def test_both_routes_to_the_scalar_agree(name):
    """The routes by the anholonomy and by the trace of Ricci agree."""
    frame = made(name)
    curvature = levi_civita(frame).curvature
    trace = contract("ab,ab->", frame.inverse_metric, curvature.ricci)
    assert (trace - curvature.scalar).is_zero is True
    assert curvature.scalar.is_zero is False


def test_the_plan_names_the_route():
    """The plan uses the anholonomy where Christoffel symbols are too long, otherwise Ricci."""
    dense = made("polynomial, sine, unknown function").plan("scalar_curvature")
    assert "anholonomy" in dense.graph
    assert "ricci" in dense.left_out
    assert "ricci" in made("null metric").plan("scalar_curvature").graph


def test_written_scalar_has_the_value_of_the_scalar():
    """The written scalar, evaluated by mpmath, equals the scalar's value."""
    frame = made("null metric")
    scalar = levi_civita(frame).curvature.scalar
    shape = sp.sin(r) + r**2
    values = {t: sp.Rational(1, 3), r: sp.Rational(2, 3)}
    given = {f(r).diff(r, k): shape.diff(r, k).subs(values).evalf(60) for k in (3, 2, 1)}
    given[f(r)] = shape.subs(values).evalf(60)
    have = scalar.at(values | given, digits=40).item()
    written = scalar[()].subs(f(r), shape).doit()
    with mpmath.workdps(50):
        want = sp.lambdify((t, r), written, "mpmath")(mpmath.mpf(1) / 3, mpmath.mpf(2) / 3)
        assert abs(have - want) < mpmath.mpf(10) ** -35 * abs(want)
    assert len(str(scalar[()])) < 100_000


def jets(frame, coordinates, values, shape):
    """The values of an unknown function and its derivatives at the coordinates."""
    u, found = sp.Symbol("u"), {}
    for symbol in coordinates:
        for order in range(4):
            key = f(symbol).diff(symbol, order) if order else f(symbol)
            found[key] = sp.diff(shape(u), u, order).subs(u, values[symbol]).evalf(60)
    return found


def curvature_scalar(metric, place):
    """g^bc R_bc by central differences of eighth order, twice."""
    n, step = len(place), mpmath.mpf(10) ** -12
    weights = [mpmath.mpf(w) for w in ("0.8", "-0.2")] + [mpmath.mpf(4) / 105, -mpmath.mpf(1) / 280]

    def slope(function, q, a):
        total: Any = 0
        for k, weight in enumerate(weights, 1):
            up, down = list(q), list(q)
            up[a], down[a] = up[a] + k * step, down[a] - k * step
            total = total + (function(up) - function(down)) * (weight / step)
        return total

    def gamma(q):
        inverse = metric(*q) ** -1
        dg = [slope(lambda p: metric(*p), q, a) for a in range(n)]
        return mpmath.matrix(
            [
                [
                    sum(
                        inverse[c, e] * (dg[a][b, e] + dg[b][a, e] - dg[e][a, b]) / 2
                        for e in range(n)
                    )
                    for c in range(n)
                ]
                for a in range(n)
                for b in range(n)
            ]
        )

    here = gamma(place)
    change = [slope(gamma, place, a) for a in range(n)]
    inverse = metric(*place) ** -1

    def ricci(b, c):
        return sum(
            change[m][b * n + c, m]
            - change[b][m * n + c, m]
            - sum(
                here[m * n + c, k] * here[b * n + k, m] - here[b * n + c, k] * here[m * n + k, m]
                for k in range(n)
            )
            for m in range(n)
        )

    return sum(inverse[b, c] * ricci(b, c) for b in range(n) for c in range(n))


def check_numbers(frame: Frame) -> None:
    """All zeros are decided, and the scalar agrees with difference quotients of the metric."""
    curvature = levi_civita(frame).curvature
    tensors = (
        frame.metric,
        cartan(frame).torsion.S,
        cartan(frame).contortion,
        curvature.riemann,
        curvature.ricci,
        curvature.scalar,
        curvature.kretschmann,
    )
    assert None not in [tensor.is_zero for tensor in tensors]
    coordinates = frame.coordinates
    with mpmath.workdps(60):
        rows = frame.coframe.to_sympy().tolist()
        known = sp.Matrix(rows).replace(f, lambda u: sp.sin(u) + u**2 / 3 + 2)
        parameters = dict.fromkeys(known.free_symbols - set(coordinates), HALF)
        coframe = sp.lambdify(coordinates, known.subs(parameters).tolist(), "mpmath")
        eta = mpmath.matrix(frame.eta.to_sympy().tolist())

        def metric(*q):
            e = mpmath.matrix(coframe(*q))
            return e.T * eta * e

        place = {s: sp.Rational(3 + k, 7) for k, s in enumerate(coordinates)}
        want = curvature_scalar(metric, [mpmath.mpf(3 + k) / 7 for k in range(len(coordinates))])
        values: dict = place | parameters
        if known != sp.Matrix(rows):
            values |= jets(frame, coordinates, place, lambda u: sp.sin(u) + u**2 / 3 + 2)
        have = curvature.scalar.at(values, digits=40).item()
        assert abs(have - want) < mpmath.mpf(10) ** -12 * (1 + abs(want))
        assert curvature.scalar.is_zero is (abs(want) < mpmath.mpf(10) ** -20)


@settings(max_examples=3, deadline=None)
@given(dense_frames(largest=2))
def test_random_dense_frames_have_the_numbers_of_finite_differences(frame):
    """Polynomials, trigonometric and unknown functions, roots; any signature, null legs."""
    check_numbers(frame)


@pytest.mark.slow
@settings(max_examples=100, deadline=None)
@given(dense_frames(largest=6))
def test_many_random_dense_frames_have_the_numbers_of_finite_differences(frame):
    """As above for a hundred frames, up to six dimensions."""
    check_numbers(frame)


def test_many_centres_solve_their_equations():
    """With five centres, Majumdar-Papapetrou and Brill-Lindquist have R = 0."""
    masses, places = sp.symbols("m:5", positive=True), sp.symbols("a:5", real=True)
    roots = [sp.sqrt(x**2 + y**2 + (z - a) ** 2) for a in places]
    potential = 1 + sum(m / root for m, root in zip(masses, roots, strict=True))
    rows = sp.diag(-1 / potential**2, *[potential**2] * 3)
    space = Frame.from_metric([t, x, y, z], rows.tolist(), signature=(-1, 1, 1, 1))
    assert space.metric[0, 0] == -1 / potential**2
    curvature = levi_civita(space).curvature
    assert curvature.ricci.is_zero is False
    assert curvature.scalar.is_zero is True
    slice_ = Frame.from_metric([x, y, z], (sp.eye(3) * potential**4).tolist())
    assert levi_civita(slice_).curvature.scalar.is_zero is True


def test_a_turned_and_boosted_tetrad_of_kerr_is_a_vacuum():
    """Arbitrary functions rotate and boost the tetrad: Ricci vanishes, torsion does not."""
    a = sp.Symbol("a", positive=True)
    theta, phi = sp.symbols("theta phi", real=True)
    sigma = sp.sqrt(r**2 + a**2 * sp.cos(theta) ** 2)
    delta = sp.sqrt(r**2 - 2 * M * r + a**2)
    carter = sp.Matrix([
        [delta / sigma, 0, 0, -delta * a * sp.sin(theta) ** 2 / sigma],
        [0, sigma / delta, 0, 0],
        [0, 0, sigma, 0],
        [-a * sp.sin(theta) / sigma, 0, 0, (r**2 + a**2) * sp.sin(theta) / sigma],
    ])  # fmt: skip
    turn, boost = f(t, r, theta, phi), g(t, r, theta, phi)
    turned = sp.diag(1, sp.Matrix([[sp.cos(turn), -sp.sin(turn)], [sp.sin(turn), sp.cos(turn)]]), 1)
    boosted = sp.eye(4)
    boosted[0, 0] = boosted[3, 3] = sp.cosh(boost)
    boosted[0, 3] = boosted[3, 0] = sp.sinh(boost)
    frame = Frame([t, r, theta, phi], (boosted * turned * carter).tolist(), signature=(-1, 1, 1, 1))
    assert levi_civita(frame).curvature.ricci.is_zero is True
    assert levi_civita(frame).curvature.lower.is_zero is False
    assert cartan(frame).torsion.scalar.is_zero is False
    assert cartan(frame).curvature.riemann.is_zero is True


def test_tolmans_seventh_solution_is_isotropic_and_short():
    """A star of density rho_c (1 - r^2 ...) has one pressure and the published G^t_t."""
    theta, phi = sp.symbols("theta phi", real=True)
    R, A, B, C = sp.symbols("R A B C", positive=True)
    r = sp.Symbol("r", positive=True)
    w = sp.sqrt(1 - r**2 / R**2 + 4 * r**4 / A**4)
    lapse = B * sp.sin(sp.log(sp.sqrt((w + 2 * r**2 / A**2 - A**2 / (4 * R**2)) / C)))
    rows = sp.diag(-(lapse**2), 1 / w**2, r**2, r**2 * sp.sin(theta) ** 2)
    star = Frame.from_metric([t, r, theta, phi], rows, signature=(-1, 1, 1, 1))
    einstein = levi_civita(star).curvature.einstein
    mixed = einstein.raised(0)
    assert (mixed.element(1, 1) - mixed.element(2, 2)).is_zero is True
    assert mixed[0, 0].equals(-3 / R**2 + 20 * r**2 / A**4)
    assert len(str(einstein.nonzero())) < 4000
    assert star.coframe[1, 1].equals(1 / w)


def test_an_arm_of_three_links_has_its_metric_as_given():
    """Kinetic metrics are decided and evaluated without a long determinant."""
    q = sp.symbols("q1:4", real=True)
    m, length = sp.symbols("m1:4", positive=True), sp.symbols("l1:4", positive=True)

    def entry(i: int, j: int) -> sp.Expr:
        return sum(m[max(i, j) :]) * length[i] * length[j] * sp.cos(q[i] - q[j])

    arm = Frame.from_metric(q, [[entry(i, j) for j in range(3)] for i in range(3)])
    curvature = levi_civita(arm).curvature
    assert curvature.ricci.is_zero is False
    assert cartan(arm).torsion.S.is_zero is False
    values = dict(zip((*q, *m, *length), (1, 2, 4, 3, 2, 1, 2, 1, 3), strict=True))
    inverse = arm.inverse_metric.at(values, digits=30)
    metric = arm.metric.at(values, digits=30)
    with mpmath.workdps(40):
        product = inverse @ metric
        assert abs(product[1, 1] - 1) < 1e-28
        assert abs(product[0, 2]) < 1e-28


def test_roots_are_below_the_line_where_that_is_shorter():
    """Legs over a determinant with angles are written so, not multiplied by its conjugates."""
    frame = made("polynomial, sine, unknown function")
    assert len(str(frame.legs[0, 0])) < 300
    have = frame.legs.at({t: 1, r: 2, M: 3, f(t): 5}, digits=30)
    want = frame.coframe.at({t: 1, r: 2, M: 3, f(t): 5}, digits=30)
    with mpmath.workdps(40):
        assert abs((have @ want)[0, 0] - 1) < 1e-28


def test_quotients_without_roots_are_inverted_whole():
    """1 over r / (r - 2 M) is inverted to (r - 2 M) / r, not kept unevaluated."""
    static = Frame.from_metric(
        [t, r], [[2 * M / r - 1, 0], [0, r / (r - 2 * M)]], signature=(-1, 1)
    )
    assert not any(value.is_kept for value in static.inverse_metric.components.independent.values())
    assert static.inverse_metric.certainty.proved


def test_long_scalars_may_be_short_when_collected():
    """A scalar too long to write becomes short when collected by powers of a symbol."""
    a, b, c = sp.symbols("a b c", positive=True)
    rows = [
        [(x + y + z + a) ** 4 + sp.sin(x), y, 0],
        [z, (a * x + b * y + c * z) ** 4 + sp.exp(y), x],
        [0, x * y, (x**2 + y**2 + z**2 + b) ** 3 + sp.cos(z)],
    ]
    frame = Frame([x, y, z], rows)
    scalar = levi_civita(frame).curvature.scalar
    # A refused text is refused again: nothing of it is kept.
    for _ in range(2):
        with pytest.raises(LimitError, match="parts would be written"):
            scalar[()]
    shown = scalar.to_sympy(short=True)
    assert len(str(scalar)) < 100_000
    values = dict(
        zip((a, b, c, x, y, z), (sp.Rational(k, 7) for k in (3, 4, 5, 2, 1, 6)), strict=True)
    )
    with mpmath.workdps(50):
        numbers = [mpmath.mpf(value.p) / value.q for value in values.values()]
        have = sp.lambdify(tuple(values), shown, "mpmath")(*numbers)
        assert abs(have - scalar.at(values, digits=40).item()) < abs(have) * mpmath.mpf(10) ** -35
        # With names for the powers it is much shorter.
        named = frame.named(A="x + y + z + a", B="a*x + b*y + c*z", C="x**2 + y**2 + z**2 + b")
        shorter = levi_civita(named).curvature.scalar.to_sympy(short=True)
        assert len(str(shorter)) < len(str(shown)) / 5
        meant = [sp.lambdify(tuple(values), q, "mpmath")(*numbers) for q in named.names.values()]
        same = sp.lambdify((*values, *named.names), shorter, "mpmath")(*numbers, *meant)
        assert abs(have - same) < abs(have) * mpmath.mpf(10) ** -35


def test_parts_that_vanish_are_not_written():
    """Every written sum has a nonzero value: X - X/2 - X/2 is omitted."""
    scalar = levi_civita(made("polynomial, sine, unknown function")).curvature.scalar
    known = [t, r, M, *(f(t).diff(t, k) for k in range(1, 4)), f(t)]
    with mpmath.workdps(60):
        numbers = [mpmath.mpf(k) / 7 for k in range(2, 2 + len(known))]
        for part in sp.preorder_traversal(scalar[()]):
            if part.is_Add:
                number = sp.lambdify(known, part, "mpmath", dummify=True)(*numbers)
                assert abs(number) > mpmath.mpf(10) ** -40, part
