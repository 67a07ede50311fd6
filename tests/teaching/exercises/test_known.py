"""Known answers: solutions compared with the paper, with books, or with results by hand."""

import math

import pytest
import sympy as sp

from geomtorsion import exercises

phi1, phi2, phi3 = sp.symbols("phi1 phi2 phi3", real=True)
c2, s2 = sp.cos(phi2), sp.sin(phi2)


def solution(number: str, name: str, seed: int = 0):
    """The right answer to a question."""
    return exercises.load(number, seed).question(name).solution


def equal(one, two) -> bool:
    """Whether two tables of expressions agree."""
    keys = {*one, *two}
    return all(sp.simplify(one.get(key, 0) - two.get(key, 0)) == 0 for key in keys)


def test_metric_of_the_rotations():
    """Eq. (9), left."""
    assert equal(
        solution("1.2", "metric"), {(0, 0): 1, (0, 2): c2, (1, 1): 1, (2, 0): c2, (2, 2): 1}
    )


def test_body_rates():
    """Above eq. (5): Omega^1 = s1 phi2' - c1 s2 phi3' and so on."""
    v1, v2, v3 = sp.symbols("phi1_d phi2_d phi3_d", real=True)
    s1, c1 = sp.sin(phi1), sp.cos(phi1)
    printed = {(0,): s1 * v2 - c1 * s2 * v3, (1,): c1 * v2 + s1 * s2 * v3, (2,): v1 + c2 * v3}
    assert equal(solution("1.4", "rates"), printed)


def test_cartan_connection():
    """Eq. (10)."""
    printed = {(0, 1, 0): c2 / s2, (1, 2, 2): c2 / s2, (0, 1, 2): -1 / s2, (1, 2, 0): -1 / s2}
    assert equal(solution("2.2", "connection"), {**printed, (0, 2, 1): s2})


def test_torsion_in_the_frame():
    """Eq. (12): 2 S_ijk = - eps_ijk."""
    printed = {(i, j, k): -sp.LeviCivita(i, j, k) for i in range(3) for j in range(3)
               for k in range(3)}  # fmt: skip
    assert equal(solution("2.4", "torsion"), printed)


def test_curvature_of_the_rotations():
    """Below eq. (9): Ricci g/2, scalar 3/2; the Cartan curvature vanishes."""
    half = sp.Rational(1, 2)
    assert equal(solution("3.4", "ricci"), {(k, k): half for k in range(3)})
    assert solution("3.4", "scalar") == {(): sp.Rational(3, 2)}
    assert solution("3.5", "scalar") == {(): sp.Rational(2, 9)}
    assert solution("3.5", "surface") == {(): "sphere"}
    assert solution("3.1", "cartan") == {(): "zero"}
    assert solution("3.1", "riemann") == {(): "not zero"}


def test_the_sphere():
    """cot on the unit sphere; the scalar is 2 / R^2 for radius R."""
    radius, r = sp.Symbol("R", positive=True), sp.Symbol("r", real=True)
    assert equal(solution("3.2", "christoffel"), {(): c2 / s2})
    assert equal(solution("3.3", "scalar"), {(): 2 / radius**2})
    assert equal(solution("3.3", "ricci"), {(0, 0): radius**-2, (1, 1): sp.sin(r / radius) ** 2})


def test_the_spiral():
    """r = r0 + u1 t, phi = phi0 + (u2/u1) ln(1 + u1 t / r0)."""
    assert solution("4.1", "radius")[()] == pytest.approx(2.0, rel=1e-7)
    assert solution("4.1", "angle")[()] == pytest.approx(0.2 + 2 * math.log(2), rel=1e-7)


def test_sailing():
    """Loxodrome and great circle by their closed forms."""
    theta, course = 1.0, math.radians(60)
    end = theta - math.cos(course)
    along = math.tan(course) * math.log(math.tan(theta / 2) / math.tan(end / 2))
    assert solution("4.4", "compass")[()] == pytest.approx(along, rel=1e-7)
    n, e = math.cos(course), math.sin(course)
    start = (math.sin(theta), 0.0, math.cos(theta))
    speed = (-n * math.cos(theta), e, n * math.sin(theta))
    x, y, z = (a * math.cos(1) + b * math.sin(1) for a, b in zip(start, speed, strict=True))
    assert solution("4.4", "circle")[()] == pytest.approx(math.atan2(y, x), rel=1e-7)
    loxodrome = (math.sin(end) * math.cos(along), math.sin(end) * math.sin(along), math.cos(end))
    cosine = sum(a * b for a, b in zip((x, y, z), loxodrome, strict=True))
    assert solution("4.4", "cosine")[()] == pytest.approx(cosine, rel=1e-7)


def test_constraints():
    """A skate with unit lengths: de^3 = e^1 ^ e^2, and no surface holds it."""
    assert equal(solution("4.5", "torsion"), {(): sp.S.One})
    assert solution("4.5", "integrable") == {(): "no"}


def test_loops():
    """-A on so3; -pi R^2 in Heisenberg's group; 2 b for two turns around a screw, 0 beside it."""
    area, radius = sp.Symbol("A", positive=True), sp.Symbol("R", positive=True)
    b = sp.Symbol("b", positive=True)
    assert equal(solution("5.1", "burgers"), {(2,): -area})
    assert equal(solution("5.2", "burgers"), {(2,): -sp.pi * radius**2})
    assert equal(solution("5.4", "around"), {(2,): 2 * b})
    assert equal(solution("5.4", "beside"), {})
    turned = (math.cos(0.6) - math.cos(1.1)) * 0.4
    assert solution("5.5", "riemann")[()] == pytest.approx(turned, rel=1e-9)


def test_a_circle_over_varying_torsion():
    """The mean of f'(x) over the disk by hand: for x^3 it is 3 x0^2 + 3 R^2 / 4."""
    radius = sp.Symbol("R", positive=True)
    for seed in range(1, 97):
        statement = exercises.load("5.2", seed).statement
        if "x^{3}" in statement and "(2, 0, 0)" in statement and r"x^{3}\,\mathrm{d}y" in statement:
            break
    else:
        pytest.fail("no such variant")
    found = solution("5.2", "burgers", seed)[(2,)]
    quotient = sp.simplify(found.subs(radius, 2) / found.subs(radius, 1))
    across = exercises.load("5.2", seed).question("burgers").mistakes
    assert across
    mean = sp.Poly(sp.expand(found / (sp.pi * radius**2)), radius)
    assert mean.degree() == 2
    assert abs(mean.coeff_monomial(radius**2)) in (sp.Rational(3, 4), sp.Rational(3, 2))
    assert quotient != 4


def test_eulers_equations():
    """Eq. (1): I1 Omega1' = (I2 - I3) Omega2 Omega3 and its cyclic permutations."""
    a, b, c = sp.symbols("Omega1 Omega2 Omega3", real=True)
    i, j, k = sp.symbols("I1 I2 I3", positive=True)
    printed = {(0,): (j - k) / i * b * c, (1,): (k - i) / j * c * a, (2,): (i - j) / k * a * b}
    assert equal(solution("6.1", "equations"), printed)


def test_the_moment_is_a_cross_product():
    """M = - W l x n with the vertical n in body axes, in each variant."""
    weight = sp.Symbol("W", positive=True)
    s1, c1 = sp.sin(phi1), sp.cos(phi1)
    vertical = sp.Matrix([-c1 * s2, s1 * s2, c2])
    for seed in range(4):
        text = exercises.load("6.2", seed).statement
        place = text.partition("centre of mass is at $(")[2].partition(")")[0]
        arm = sp.Matrix([int(x) for x in place.split(",")])
        moment = -weight * arm.cross(vertical)
        assert equal(solution("6.2", "moment", seed), {(k,): moment[k] for k in range(3)})


def test_the_variation():
    """Eq. (17), second term: eps^i_jk u^j dPhi^k."""
    u = sp.Matrix(sp.symbols("u1 u2 u3", real=True))
    d = sp.Matrix(sp.symbols("dPhi1 dPhi2 dPhi3", real=True))
    cross = u.cross(d)
    assert equal(solution("6.3", "terms"), {(k,): cross[k] for k in range(3)})


def test_the_symmetric_top():
    """(C - A) w / A in the body, |L| / A in space."""
    a, c, w, v = sp.symbols("A C w v", positive=True)
    assert equal(solution("6.4", "body"), {(): (c - a) * w / a})
    assert equal(solution("6.4", "space"), {(): sp.sqrt(a**2 * v**2 + c**2 * w**2) / a})


def test_the_carried_velocity():
    """Eq. (2): V' = - Omega x V + F / M."""
    turn = sp.Matrix(sp.symbols("Omega1 Omega2 Omega3", real=True))
    speed = sp.Matrix(sp.symbols("V1 V2 V3", real=True))
    mass = sp.Symbol("M", positive=True)
    cross = -turn.cross(speed)
    assert equal(solution("6.5", "equations"), {(k,): cross[k] for k in range(3)})
    pushed = solution("6.5", "equations", 1)
    push = [sp.simplify((pushed.get((k,), 0) - cross[k]) * mass) for k in range(3)]
    said = exercises.load("6.5", 1).statement
    assert f"$F = ({', '.join(map(str, push))})$" in said


def test_helix_and_line():
    """Radius V/Omega; the gap between circle and tangent; the line is a geodesic."""
    assert solution("6.6", "torsion") == {(): -1}
    assert solution("6.6", "radius")[()] == pytest.approx(0.5, rel=1e-6)
    spin, time = 2.0, 1.0
    circle = (math.sin(spin * time) / spin, (1 - math.cos(spin * time)) / spin)
    gap = math.hypot(circle[0] - time, circle[1])
    assert solution("6.6", "apart")[()] == pytest.approx(gap, rel=1e-6)
    assert solution("6.6", "principle") == {(): "coordinates"}
    assert solution("6.6", "law") == {(): "geodesic"}


def test_costs():
    """8 right digits of a sum over a tiny loop; order 2; growth by sinh; numbers of states."""
    assert solution("7.1", "line")[()] == pytest.approx(8, abs=0.8)
    assert solution("7.2", "order")[()] == pytest.approx(2, abs=1e-2)
    growth = math.sinh(3.5) / math.sinh(0.5)
    assert solution("7.3", "length")[()] == pytest.approx(growth, rel=1e-6)
    names = ("omega", "angles", "quaternion", "straightest")
    assert [solution("7.4", name)[()] for name in names] == [3, 6, 7, 3]


def test_a_right_handed_screw_from_atom_to_atom():
    """b = a/2 <111> against the line, as in conventions.py: SF/RH is minus the textbook's b."""
    half = sp.Rational(1, 2)
    assert equal(solution("5.6", "burgers"), {(k,): -half for k in range(3)})
    assert solution("5.6", "length") == {(): sp.sqrt(3) / 2}
    assert solution("5.6", "handed") == {(): "right"}
    for seed in range(1, 12):
        b = solution("5.6", "burgers", seed)
        assert {abs(x) for x in b.values()} == {half}
        assert len(b) == 3


def test_the_half_plane_follows_the_conventions():
    """The textbook's b, minus the SF/RH b, rotated by 90 degrees, points to the half plane."""
    directions = {"above": (0, 1), "below": (0, -1), "left": (-1, 0), "right": (1, 0)}
    for seed in range(20):
        b = solution("5.7", "burgers", seed)
        textbook = [-int(b.get((k,), 0)) for k in (0, 1)]
        towards = (-textbook[1], textbook[0])
        planes = max(map(abs, textbook))
        place = solution("5.7", "place", seed)[()]
        assert towards == tuple(planes * x for x in directions[place])
