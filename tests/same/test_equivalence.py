"""Equivalence: one geometry is recognised in other coordinates, and another one is refused."""

# Some results may be None in general, and some tests pass bad input.
# pyright: reportOptionalOperand=false, reportOptionalMemberAccess=false, reportArgumentType=false

import math
import random
from fractions import Fraction

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import ArgumentError, CoordinateError, UndecidedError
from geomtorsion.same import classified
from tests.chosen import few

M = sp.Rational(1, 3)
MASS, DOUBLE = {"M": M}, {"M": 2 * M}
KERR = {"M": 1, "a": M}
WITH_FUNCTIONS = ("pp_wave", "frw", "frw_flat", "frw_closed", "frw_open")


def space(name: str, values: dict | None = None) -> gt.Frame:
    """A shipped frame, with values for its parameters."""
    frame = gt.spaces.load(name).frame
    return frame.subs(values) if values else frame


# (first space, its values, second space, its values, verdicts for legs, teleparallel, metric)
S, D = "same", "different"
PAIRS = [
    ("so3", None, "so3_quaternion", None, S, S, S),
    ("so3", None, "so3_right", None, D, S, S),
    ("so3", None, "bianchi_ix", None, S, S, S),
    ("heisenberg", None, "bianchi_ii", None, D, S, S),
    ("sol", None, "bianchi_vi_0", None, D, S, S),
    ("schwarzschild", MASS, "schwarzschild", DOUBLE, D, D, D),
    ("schwarzschild", MASS, "schwarzschild_cartesian", MASS, D, D, S),
    ("schwarzschild", MASS, "schwarzschild_falling", MASS, D, D, S),
    *(
        pytest.param(pair, marks=pytest.mark.slow)
        for pair in (
            ("schwarzschild_cartesian", MASS, "schwarzschild_isotropic", MASS, S, S, S),
            ("schwarzschild_cartesian", MASS, "schwarzschild_isotropic", DOUBLE, D, D, D),
            ("kerr", KERR, "kerr_kinnersley", KERR, D, D, S),
            ("kerr", KERR, "kerr", {"M": 1, "a": 2 * M}, D, D, D),
        )
    ),
]


@pytest.mark.parametrize("pair", PAIRS, ids=lambda p: f"{p[0]}-{p[2]}")
def test_shipped_tetrads_are_compared(pair):
    """Each pair of tetrads has the verdict that its geometry has, in all three senses."""
    first, values, second, others, *expected = pair
    one, two = space(first, values), space(second, others)
    keeps = ("legs", "teleparallel", "metric")
    results = [gt.same_geometry(one, two, keep) for keep in keeps]
    assert [result.verdict for result in results] == expected
    for result in results:
        assert result.certainty.error < 1e-40, result
        if result.verdict == "same":
            assert result.difference < 1e-50
            assert result.symmetries[0] == result.symmetries[1]


@pytest.mark.parametrize("name", few(20, gt.spaces.names()))
def test_ranks_agree_with_the_count_of_symmetries(name):
    """gt.symmetries, by Killing's equations, counts as many symmetries as ranks of invariants."""
    frame = gt.spaces.load(name).frame
    for keep in ("metric", "teleparallel"):
        counted = gt.symmetries(frame, keep)
        if name in WITH_FUNCTIONS:
            with pytest.raises(ArgumentError, match="expected a frame without unknown functions"):
                classified(frame, keep)
            continue
        by_ranks = classified(frame, keep)
        assert (by_ranks.symmetries, by_ranks.isotropy) == (counted.dimension, counted.isotropy)


def test_the_reason_names_the_difference():
    """A proof names the invariant, the rank, the dimension or the signature that differs."""
    sphere = gt.Frame("a b", [[2, 0], [0, "2*sin(a)"]], domain="0 < a < pi")
    cases = [
        (("s2", "s3"), "dimensions are 2 and 3"),
        (("so3", "ads3"), "signatures are"),
        ((sphere, space("s2", {"R": 1})), "the curvature scalar is 1/2 for the first and 2"),
        (("flat_polar", space("s2", {"R": 1})), "vanishes for the first geometry only"),
        (("bianchi_iv", "bianchi_v"), "symmetries"),
    ]
    for (one, two), words in cases:
        result = gt.same_geometry(one, two)
        assert result.verdict == "different"
        assert words in result.reason, result
        assert result.certainty.error < 1e-60
        assert not result


def test_minus_a_metric_is_named():
    """A metric with the other choice of signs is refused with the remedy."""
    frame = gt.Frame("t x", [[1, 0], [0, 1]], "-+")
    other = gt.Frame("t x y", [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "-++")
    minus = gt.Frame("t x y", [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "+--")
    assert gt.same_geometry(frame, frame).verdict == "same"
    assert "minus the other metric" in gt.same_geometry(other, minus).reason


def test_constant_curvature_is_proved():
    """Equal constants prove that two spaces of constant curvature are the same."""
    half_plane = gt.Frame("x y", [["1/y", 0], [0, "1/y"]], domain="y > 0")
    disc = gt.Frame("u v", [["2/(1-u^2-v^2)", 0], [0, "2/(1-u^2-v^2)"]], domain="u^2 + v^2 < 1")
    result = gt.same_geometry(half_plane, disc)
    assert result
    assert result.certainty.proved
    assert result.isotropy == (1, 1)


def test_parameters_of_one_name_are_one_constant():
    """The verdict holds for all values of a parameter, not only where it is one."""
    assert gt.same_geometry("schwarzschild", "schwarzschild_isotropic").verdict == "same"
    unit = space("s2", {"R": 1})
    assert gt.same_geometry(space("s2"), unit).verdict == "different"
    assert gt.same_geometry("s2", "s2").parameters.keys() == {"R"}


def test_orientation_counts_if_it_should():
    """Left- and right-invariant legs of the rotations differ by a reflection."""
    assert gt.same_geometry("so3", "so3_right", "teleparallel")
    mirrored = gt.same_geometry("so3", "so3_right", "teleparallel", orientation=True)
    assert mirrored.verdict == "different"
    assert "the axial torsion is" in mirrored.reason
    assert mirrored.certainty.proved
    assert "up to one constant reflection" in str(
        gt.same_geometry("so3", "so3_right", "teleparallel")
    )
    assert "up to one constant turn" in str(gt.same_geometry("so3", "so3_zxz", "teleparallel"))
    assert gt.same_geometry("so3", "so3_quaternion", "teleparallel", orientation=True)


def nil(sign: int) -> gt.Frame:
    """The Heisenberg group, for each sign the mirror image of the other."""
    return gt.Frame("x y z", [[1, 0, 0], [0, 1, 0], [0, f"{sign}*x", 1]])


def bar(sign: int) -> gt.Frame:
    """A crystal whose lattice turns along z, to the left or to the right."""
    turn = [["cos(z)", f"{sign}*sin(z)", 0], [f"{-sign}*sin(z)", "cos(z)", 0], [0, 0, 1]]
    return gt.Frame("x y z", turn)


@pytest.mark.parametrize(("pair", "keep"), [(nil, "metric"), (bar, "teleparallel")])
def test_mirror_images_differ_by_the_sign_of_a_scalar(pair, keep):
    """A chiral pair is the same after a reflection, and different where left and right count."""
    left, right = pair(1), pair(-1)
    result = gt.same_geometry(left, right, keep)
    assert result.verdict == "same"
    assert result.match.reflects
    assert "turn" not in result.compared
    proper = gt.same_geometry(left, right, keep, orientation=True)
    assert proper.verdict == "different"
    assert "for the first and" in proper.reason
    assert proper.certainty.proved
    assert gt.same_geometry(left, pair(1), keep, orientation=True)


def test_equal_formulas_are_the_same_at_once():
    """A frame without domain is the same as itself, for each kind of comparison."""
    rows = [["sqrt(1-2/r)", 0, 0, 0], [0, "1/sqrt(1-2/r)", 0, 0], [0, 0, "r", 0]]
    frame = gt.Frame("t r theta phi", [*rows, [0, 0, 0, "r*sin(theta)"]], "-+++")
    for keep in ("metric", "teleparallel", "legs"):
        result = gt.same_geometry(frame, frame, keep)
        assert result.verdict == "same"
        assert result.certainty.proved
        assert "r > 2" in str(result)
        assert "assumed" in str(result)
    image = gt.same_geometry(frame, frame).map({"t": 1, "r": 5, "theta": 1, "phi": 2})
    assert image["r"] == pytest.approx(5, abs=1e-9)


def test_points_of_a_verdict_are_in_the_declared_domains():
    """Both points of a match satisfy the domains of their frames."""
    for name, other in (("s2", "s2"), ("schwarzschild", "schwarzschild_cartesian")):
        one = space(name, MASS if "black" in gt.spaces.titles()[name] else {"R": 2})
        two = space(other, MASS if "black" in gt.spaces.titles()[other] else {"R": 2})
        x, y = sp.symbols("x y", real=True)
        if name == "s2":
            shape = 4 / (1 + x**2 + y**2)
            one = gt.Frame([x, y], [[shape, 0], [0, shape]], domain="x > 3, y > 2")
        result = gt.same_geometry(one, two)
        assert result.verdict == "same"
        for frame, point in ((one, result.match.start), (two, result.match.goal)):
            values = {q: sp.Float(float(v)) for q, v in point.items()}
            assert all(relation.subs(values) == sp.true for relation in frame.domain), point


def test_light_that_falls_in_and_light_that_leaves_differ():
    """The mass of Vaidya's metric grows by energy that falls in, and shrinks otherwise."""

    def vaidya(sign: int) -> gt.Frame:
        rows = [["-(1 - 2*m/r)", sign, 0, 0], [sign, 0, 0, 0], [0, 0, "r**2", 0]]
        rows = [[str(x).replace("m", "v/10") for x in row] for row in rows]
        last = [0, 0, 0, "r**2*sin(theta)**2"]
        return gt.Frame.from_metric(
            "v r theta phi", [*rows, last], domain="0 < v < 1, r > 1, 0 < theta < pi"
        )

    result = gt.same_geometry(vaidya(1), vaidya(-1))
    assert result.verdict == "different"
    assert "null energy" in result.reason
    assert gt.same_geometry(vaidya(1), vaidya(1))


def test_static_walls_and_an_expanding_universe_differ():
    """Gradients of invariants are space-like for the walls, time-like for the universe."""
    walls = gt.Frame.from_metric(
        "t z x y", [["-1/z", 0, 0, 0], [0, "z", 0, 0], [0, 0, "z**2", 0], [0, 0, 0, "z**2"]]
    )
    kasner = gt.Frame.from_metric(
        "t x y z", [["-t", 0, 0, 0], [0, "1/t", 0, 0], [0, 0, "t**2", 0], [0, 0, 0, "t**2"]]
    )
    result = gt.same_geometry(walls, kasner)
    assert result.verdict == "different"
    assert "gradients" in result.reason
    # Monomials in positive coordinates: the signs are proved for the whole regions.
    assert result.certainty.error < 1e-50


def test_connections_are_compared_with_their_metrics():
    """Equal metrics with different torsion differ; a change of coordinates does not."""
    x, y, z, u = sp.symbols("x y z u", real=True)
    flat = gt.Frame([x, y, z], sp.eye(3).tolist())

    def twisted(strength):
        entries = {(0, 1, 2): strength, (1, 2, 0): strength, (2, 0, 1): strength}
        torsion = [[[0] * 3 for _ in range(3)] for _ in range(3)]
        for (a, b, c), value in entries.items():
            torsion[a][b][c], torsion[b][a][c] = value, -value
        return gt.from_torsion(flat, torsion)

    one = twisted(1 + x**2)
    moved = one.in_coordinates([u, y, z], {x: u + u**3 / 3})
    assert gt.same_geometry(one, moved).verdict == "same"
    assert gt.same_geometry(one, twisted(1 + 2 * x**2)).verdict == "different"
    assert gt.same_geometry(one, gt.levi_civita(flat)).verdict == "different"
    assert gt.same_geometry(one, gt.levi_civita(flat), "metric").verdict == "same"


@pytest.mark.slow
def test_kerr_is_recognised_in_disguise():
    """A metric in crooked coordinates, without its tetrad, is Kerr's."""
    kerr = space("kerr", KERR)
    t, r, theta, phi = kerr.coordinates
    u, v, w, z = sp.symbols("u v w z", real=True)
    domain = (v > 3, w > 0, w < 3)
    old = {t: u + v * w / 3, r: v + 1 / v, theta: w, phi: z + v / 2 + w / 5}
    metric = kerr.in_coordinates([u, v, w, z], old, domain).metric.to_sympy().tomatrix()
    disguise = gt.Frame.from_metric([u, v, w, z], metric, domain=domain)
    result = gt.same_geometry(kerr, disguise)
    assert result.verdict == "same"
    assert [step.rank for step in result.growth] == [6, 8]
    assert result.symmetries == (2, 2)
    assert result.difference < 1e-50


def test_the_map_has_its_closed_form():
    """The radius of Schwarzschild maps to the isotropic radius, to all digits."""
    one, two = space("schwarzschild", MASS), space("schwarzschild_isotropic", MASS)
    result = gt.same_geometry(one, two)
    start = {str(q): float(value) for q, value in result.match.start.items()}
    image = result.map({**start, "r": 3})
    rho = math.sqrt(sum(image[q] ** 2 for q in "xyz"))
    mass = float(M)
    assert rho == pytest.approx((3 - mass + math.sqrt(9 - 6 * mass)) / 2, abs=1e-10)
    assert image.error < 1e-9


def test_the_map_of_fixed_legs_has_its_closed_form():
    """Legs fix the map up to a symmetry: here a shift of the squares."""
    one = gt.Frame("x y", [[1, 0], [0, "x"]], domain="x > 0")
    two = gt.Frame("u v", [["2*u", 0], [0, "u^2"]], domain="u > 0")
    image = gt.same_geometry(one, two, "legs").map({"x": 2, "y": 0.5})
    assert image["u"] == pytest.approx(math.sqrt(2), abs=1e-10)


def test_printing_shows_verdict_and_certainty():
    """Text and HTML show the verdict, the certainty and the points."""
    frame = gt.Frame("theta phi", [[1, 0], [0, "1 + theta^2"]])
    result = gt.same_geometry(frame, gt.Frame("u v", [["1 + v^2", 0], [0, 1]]))
    for text in (str(result), result._repr_html_()):
        assert "same" in text
        assert "pair of generic points" in text
        assert "theta" in text


REFUSALS = [
    (lambda: gt.same_geometry("s2", 3), ArgumentError, "expected"),
    (lambda: gt.same_geometry("s2", "s2", "legz"), ArgumentError, "keep"),
    (lambda: gt.same_geometry("frw", "frw"), ArgumentError, "without unknown functions"),
    (lambda: gt.same_geometry("s2", gt.cartan("s2")), ArgumentError, "one of each"),
    (lambda: gt.same_geometry("s2", "s2", orientation=1), ArgumentError, "orientation"),
    (lambda: gt.same_geometry("s2", "s3").map, UndecidedError, "have a map"),
    (lambda: gt.same_geometry("s3", "s3").map({"x": 1}), CoordinateError, "expected numbers"),
]


@pytest.mark.parametrize(("call", "error", "words"), REFUSALS)
def test_bad_requests_are_refused(call, error, words):
    """A request that makes no sense raises an error that names the remedy."""
    with pytest.raises(error, match=words):
        call()


# -- random disguises ------------------------------------------------------------------------------

SPACES = [
    ("s2", {"R": 1}),
    ("heisenberg", None),
    ("bianchi_iii", None),
    ("flat_polar", None),
    ("schwarzschild", MASS),
]


def changed(frame: gt.Frame, seed: int, strength: Fraction) -> gt.Frame:
    """A frame in random rational coordinates, its legs turned by a constant rational matrix.

    strength: of a change of its first leg that no coordinates remove.
    """
    rng = random.Random(seed)
    n = frame.dimension
    new = sp.symbols(f"w1:{n + 1}", real=True)
    old, point = {}, frame.sample_point
    for k, q in enumerate(frame.coordinates):
        shift = sp.Rational(rng.randint(1, 9), 10)
        # Triangular, so that it can be inverted; zero goes to a point of the domain.
        rest = sum(sp.Rational(rng.randint(-3, 3), 10) * new[j] ** 2 for j in range(k))
        old[q] = point[q] + new[k] / (2 + shift * new[k]) / 4 + rest / 8
    near = [relation for w in new for relation in (w > -sp.Rational(1, 4), w < sp.Rational(1, 4))]
    moved = frame.in_coordinates(new, old, near)
    rows = moved.coframe.to_sympy().tomatrix()
    rows[0, 0] += sp.Rational(strength.numerator, strength.denominator) * new[-1] ** 2
    spatial = [k for k in range(n) if frame.eta[k, k] == 1][:2]
    turn = sp.eye(n)
    c, s = sp.Rational(3, 5), sp.Rational(4, 5) * rng.choice((1, -1))
    i, j = spatial
    turn[i, i], turn[i, j], turn[j, i], turn[j, j] = c, s, -s, c
    eta = [[frame.eta[a, b] for b in range(n)] for a in range(n)]
    return gt.Frame(new, (turn * rows).tolist(), eta, domain=moved.domain)


QUICK = (0, 3, 4)
SLOW = [pytest.param(k, marks=pytest.mark.slow) for k in range(20) if k not in QUICK]


@pytest.mark.parametrize("number", [*QUICK, *SLOW])
def test_random_disguises_are_recognised_and_changes_refused(number):
    """A turned frame in other coordinates is the same up to a turn; a changed one is not."""
    name, values = SPACES[number % len(SPACES)]
    frame = space(name, values)
    result = gt.same_geometry(frame, changed(frame, number, Fraction(0)), "teleparallel")
    assert result.verdict == "same", result
    other = gt.same_geometry(frame, changed(frame, number, Fraction(1, 20)), "teleparallel")
    assert other.verdict == "different", other
    assert other.certainty.error < 1e-40


@pytest.mark.parametrize("pair", PAIRS[:4], ids=lambda p: f"{p[0]}-{p[2]}")
def test_the_relation_is_symmetric(pair):
    """The verdict does not depend on the order of the two frames."""
    first, values, second, others, *_ = pair
    one, two = space(first, values), space(second, others)
    for keep in ("metric", "teleparallel"):
        verdicts = {gt.same_geometry(*sides, keep).verdict for sides in ((one, two), (two, one))}
        assert len(verdicts) == 1, keep


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_constant_boosts_and_turns_change_nothing(seed):
    """Legs changed by a constant Lorentz transformation are the same up to one turn."""
    rng = random.Random(seed)
    frame = space("schwarzschild", MASS)
    turn = sp.eye(4)
    for i, k in ((0, rng.randint(1, 3)), (1, 2), (2, 3)):
        plane = sp.eye(4)
        a, b = (
            (sp.Rational(5, 4), sp.Rational(3, 4))
            if i == 0
            else (sp.Rational(3, 5), sp.Rational(4, 5))
        )
        plane[i, i] = plane[k, k] = a
        plane[i, k], plane[k, i] = (b, b) if i == 0 else (b, -b)
        turn = plane * turn
    rows = (turn * frame.coframe.to_sympy().tomatrix()).tolist()
    moved = gt.Frame(frame.coordinates, rows, "-+++", domain=frame.domain)
    result = gt.same_geometry(frame, moved, "teleparallel", orientation=True)
    assert result.verdict == "same", result
    assert gt.same_geometry(frame, moved, "legs").verdict == "different"
