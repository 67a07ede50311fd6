"""Closed orbits: theorems contain published and closed forms, and nothing else is proved."""

# pyright: reportArgumentType=false

import pickle
import random

import pytest
import sympy as sp
from flint import acb, arb

import geomtorsion as gt
from geomtorsion.errors import ArgumentError, ProofError, UnknownNameError
from geomtorsion.support.precision import ball_precision
from tests.chosen import few

SWING = gt.ODE.of({"x": "v", "v": "-sin(x)"}, [1, 0], invariants={"E": "v**2/2-cos(x)"})
CIRCLE = gt.ODE.of({"x": "x*(1-x**2-y**2)-y", "y": "y*(1-x**2-y**2)+x"}, [1.1, 0])
MU = sp.Rational("0.0009537")


def within(ball, text, slack=0):
    """Whether a ball agrees with a published number, up to units of its last digit."""
    with ball_precision(400):
        digits = len(text.partition(".")[2])
        return ball.overlaps(arb(arb(text).mid(), (1 + slack) * arb(10) ** -digits))


def three_bodies():
    """The planar restricted problem of the Sun and Jupiter, with Jacobi's constant C."""
    x, y, u, v = sp.symbols("x y u v", real=True)
    one, two = ((x + MU) ** 2 + y**2), ((x - 1 + MU) ** 2 + y**2)
    half = sp.Rational(-1, 2)
    pull = (1 - MU) * one**-1 * one**half, MU * two**-1 * two**half
    rates = {
        x: u, y: v,
        u: x - pull[0] * (x + MU) - pull[1] * (x - 1 + MU) + 2 * v,
        v: y * (1 - sum(pull)) - 2 * u,
    }  # fmt: skip
    sizes = 2 * ((1 - MU) * one**half + MU * two**half)
    c = x**2 + y**2 - u**2 - v**2 + sizes + MU * (1 - MU)
    return gt.ODE.of(rates, [0.92, 0, 0, 0.1], invariants={"C": c}), c


def test_the_limit_cycle_of_a_circle():
    """r' = r (1 - r^2), phi' = 1: r = 1, T = 2 pi, the multiplier is exp(-4 pi)."""
    orbit = gt.closed_orbit(CIRCLE, 6, section="y", digits=40)
    with ball_precision(300):
        assert orbit["x"].contains(1)
        assert orbit["y"].contains(0)
        assert orbit.period.overlaps(2 * arb.pi())
        assert orbit.period.rad() < arb(10) ** -39
        (multiplier,) = orbit.multipliers
        assert multiplier.overlaps((-4 * arb.pi()).exp())
        assert multiplier.real.rel_accuracy_bits() > 40
    assert orbit.box["x"].contains(orbit["x"])
    assert (orbit.stability, orbit.trivial) == ("attracting", 1)
    slow = gt.ODE.of({"x": "-x*(1-x**2-y**2)/8-y", "y": "-y*(1-x**2-y**2)/8+x"}, [0.9, 0])
    assert gt.closed_orbit(slow, 6).stability == "repelling"


@pytest.mark.parametrize("options", [
    {"conserved": ["E"], "section": "v"}, {"symmetry": ["v"], "section": "x-1"},
    {"symmetry": {"v": 0}, "conserved": {"v**2/2-cos(x)": "-cos(1)"}},
])  # fmt: skip
def test_a_pendulum(options):
    """From the angle 1 the period is 4 K(sin 1/2) = 6.69997566437045271270121..., each way."""
    orbit = gt.closed_orbit(SWING, 6.5, digits=30, **options)
    assert within(orbit.period, "6.699975664370452712701211379161")
    assert orbit.period.rad() < arb(10) ** -29
    assert (orbit.trivial, orbit.multipliers, orbit.stability) == (2, (), "neutral")


@pytest.mark.slow
def test_lyapunovs_orbit_of_the_first_point():
    """CAPD: at C = 3.03 the orbit of L1 starts at x = 0.9208034913207435 +- 5e-15."""
    problem, c = three_bodies()
    orbit = gt.closed_orbit(problem, 3.1, symmetry=["y", "u"], conserved={c: "3.03"})
    assert within(orbit["x"], "0.9208034913207435", 50)
    assert orbit["x"].rad() < arb(10) ** -15
    assert (orbit.stability, orbit.trivial) == ("saddle", 2)
    large, small = (x.real for x in orbit.multipliers)
    with ball_precision(100):
        assert large > 1000
        assert (large * small).contains(1)


def test_the_shortest_orbit_of_lorenz():
    """Viswanath: the orbit AB has the period 1.55865221071617472757 and leaves its plane."""
    rates = {"x": "10*(y-x)", "y": "x*(28-z)-y", "z": "x*y-8*z/3"}
    problem = gt.ODE.of(rates, [-13.7, -19.5, 27])
    orbit = gt.closed_orbit(problem, 1.56, section="z-27", digits=20)
    assert within(orbit.period, "1.55865221071617472757")
    assert orbit.stability == "saddle"
    large, small = (x.real for x in orbit.multipliers)
    with ball_precision(100):
        # The divergence is -41/3.
        assert (large * small).overlaps((-orbit.period * 41 / 3).exp())
        assert abs(large) > 4.7


def test_lyapunovs_orbit_of_the_second_point():
    """Wilczak, Zgliczynski 2003: at C = 3.03 it starts at x = 1.081929486841799903."""
    problem, c = three_bodies()
    problem = problem.with_start([1.082, 0, 0, -0.0985])
    orbit = gt.closed_orbit(problem, 3.3, symmetry=["y", "u"], conserved={c: "3.03"}, digits=12)
    assert within(orbit["x"], "1.0819294868418", 1)
    assert orbit["x"].rad() < arb(10) ** -12
    assert (orbit.stability, orbit.trivial) == ("saddle", 2)


# Interval Newton of CAPD: y, z and the return time of its example RosslerPeriodicOrbit.
ROESSLER = [
    (1, ("-8.38094174282987582", "6.6e-14"), ("0.0295900606306671", "1.3e-15"),
     ("5.8810884555538999", "1.8e-13")),
    pytest.param(2, ("-5.42407382266520610", "1.8e-13"), ("0.0310812108078764", "7.4e-15"),
                 ("11.758626071660096", "5.3e-13"), marks=pytest.mark.slow),
    (3, ("-6.23315862853797675", "3.5e-13"), ("0.0306401116581606", "1.1e-14"),
     ("17.515791070335764", "8.6e-13")),
]  # fmt: skip


@pytest.mark.parametrize(("times", "y", "z", "period"), ROESSLER)
def test_roesslers_orbits(times, y, z, period):
    """CAPD proves orbits that return after one, two and three crossings of x = 0."""
    rates = {"x": "-y-z", "y": "x+y/5", "z": "1/5+z*(x-57/10)"}
    near = [0, float(y[0]) + 1e-4, float(z[0])]
    orbit = gt.closed_orbit(gt.ODE.of(rates, near), 5.85 * times, section="x")
    for ball, (middle, radius) in ((orbit["y"], y), (orbit["z"], z), (orbit.period, period)):
        assert ball.overlaps(arb(middle, float(radius)))
    assert orbit.stability == "saddle"


def test_keplers_ellipse():
    """In polar coordinates with E = -1/2 and L = 4/5: the period is 2 pi, the angle grows by it."""
    rates = {"r": "v", "v": "L**2/r**3-1/r**2", "phi": "L/r**2"}
    problem = gt.ODE.of(rates, [1.6, 0, 0], parameters={"L": "4/5"})
    energy = {"v**2/2+L**2/r**2/2-1/r": "-1/2"}
    orbit = gt.closed_orbit(problem, 6.2, section="v", conserved=energy, shift={"phi": None})
    with ball_precision(100):
        assert orbit["r"].contains(arb(8) / 5)
        assert orbit.period.overlaps(2 * arb.pi())
        assert orbit.growth["phi"].overlaps(2 * arb.pi())


@pytest.mark.parametrize(("side", "near", "stability"), [
    (3, [0.01, 0], "elliptic"), (1, [3.14, 0], "saddle"),
])  # fmt: skip
def test_equators_of_a_torus(side, near, stability):
    """Radii 2 and 1: lengths 6 pi and 2 pi, curvature 1/3 and -1 along them."""
    theta, phi = sp.symbols("theta phi", real=True)
    frame = gt.Frame([theta, phi], [[1, 0], [0, 2 + sp.cos(theta)]])
    problem = gt.geodesic(frame, near, frame_velocity=[0.001, 1])
    orbit = gt.closed_orbit(problem, 6.2 * side, section="phi", conserved={"u1**2+u2**2": 1},
                            shift={"phi": "2*pi"}, digits=12)  # fmt: skip
    with ball_precision(100):
        length = 2 * arb.pi() * side
        assert orbit.period.overlaps(length)
        trace = (orbit.multipliers[0] + orbit.multipliers[1]).real
        turn = length / arb(3).sqrt()
        assert trace.overlaps(2 * (turn.cos() if side == 3 else length.cosh()))
    assert orbit.stability == stability


def test_a_top_of_a_scene():
    """Landau, Lifshitz, paragraph 37: moments 1, 2, 3 from (1, 0, 2) give 2 K(1/12)."""
    equations = gt.scenes.load("dzhanibekov").ode
    with pytest.raises(ArgumentError, match="restricted"):
        gt.closed_orbit(equations, 3)
    top = equations.restricted(["Omega1", "Omega2", "Omega3"]).with_start([1, 0, 2])
    quantities = ["rotational_energy", "angular_momentum_squared"]
    orbit = gt.closed_orbit(top, 3.2, section="Omega2", conserved=quantities)
    with ball_precision(100):
        assert orbit.period.overlaps(2 * acb(arb(1) / 12).elliptic_k().real)
    assert orbit.trivial == 3


def test_a_constrained_motion():
    """A skate on a plane, speed 1, turning by 2: a circle in the time pi, whose centre is fixed."""
    x, y, f = sp.symbols("x y phi", real=True)
    c, s = sp.cos(f), sp.sin(f)
    frame = gt.Frame([x, y, f], [[c, s, 0], [-s, c, 0], [0, 0, 1]])
    skate = gt.autoparallel(gt.constrained(frame, [[-s, c, 0]]), [0, 0, 0], velocity=[1, 0, 2])
    centre = {"x-(u1*sin(phi)+u3*cos(phi))/u2": 0, "y+(u1*cos(phi)-u3*sin(phi))/u2": "1/2"}
    orbit = gt.closed_orbit(
        skate, 3, section="phi", conserved=centre, shift={"phi": "2*pi"}, digits=20
    )
    with ball_precision(100):
        assert orbit.period.overlaps(arb.pi())
        assert orbit["x"].contains(0)
        assert orbit["y"].contains(0)


@pytest.mark.slow
def test_light_on_a_sphere_around_kerrs_hole():
    """Teo 2003: for a = M/2 light at r = 5M/2 has L/E = 3 and Q/E^2 = 125/12; it is unstable."""
    light = gt.geodesic(
        "kerr", [0, 2.5, 0.746, 0], frame_velocity=[1.6, 0, 0, 1.6], parameters={"M": 1, "a": 0.5}
    )
    size, horizon = "(r**2+a**2*cos(theta)**2)", "(r**2-2*M*r+a**2)"
    energy = f"sqrt({horizon}/{size})*u1+a*sin(theta)/sqrt({size})*u4"
    orbit = gt.closed_orbit(
        light, 9.1, symmetry=["u2", "u3"], section="r-5/2", shift={"t": None, "phi": None},
        conserved={"u1**2-u2**2-u3**2-u4**2": 0, energy: 1},
    )  # fmt: skip
    with ball_precision(100):
        height = orbit["theta"].cos() ** 2
        # It turns where 125/12 = cos^2 (9/sin^2 - 1/4).
        assert (height * (9 / (1 - height) - arb(1) / 4)).overlaps(arb(125) / 12)
        big, sine = arb(25) / 4 + height / 4, (1 - height).sqrt()
        spin = ((arb(3) / 2).sqrt() / big.sqrt() * orbit["u1"] * sine**2 / 2
                + arb(13) / 2 * sine / big.sqrt() * orbit["u4"])  # fmt: skip
        assert spin.overlaps(arb(3))
    assert orbit.stability == "saddle"


def test_a_family_of_ellipses():
    """All orbits of Kepler's problem are closed: from one point none is the only one."""
    rates = {"x": "u", "y": "v", "u": "-x/(x**2+y**2)**(3/2)", "v": "-y/(x**2+y**2)**(3/2)"}
    problem = gt.ODE.of(rates, [0.5, 0, 0, 1.7])
    with pytest.raises(ProofError, match="family"):
        gt.closed_orbit(problem, 6, symmetry=["y", "u"], section="x-1/2")


def test_the_equator_of_an_ellipsoid():
    """Axes 1, 1, 3: length 2 pi, curvature 1/9, so that multipliers are exp(+-2 pi i / 3)."""
    theta, phi = sp.symbols("theta phi", real=True)
    rows = [[sp.sqrt(sp.cos(theta) ** 2 + 9 * sp.sin(theta) ** 2), 0], [0, sp.sin(theta)]]
    frame = gt.Frame([theta, phi], rows)
    problem = gt.geodesic(frame, [1.57, 0], frame_velocity=[0.01, 1])
    orbit = gt.closed_orbit(
        problem, 6.2, section="phi", conserved={"u1**2+u2**2": 1}, shift={"phi": "2*pi"}
    )
    with ball_precision(100):
        assert orbit.period.overlaps(2 * arb.pi())
        assert orbit["theta"].overlaps(arb.pi() / 2)
        assert orbit.growth["phi"].overlaps(2 * arb.pi())
        assert [x.real.overlaps(arb(-1) / 2) for x in orbit.multipliers] == [True, True]
        assert orbit.multipliers[0].imag.overlaps(arb(3).sqrt() / 2)
    assert orbit.stability == "elliptic"


def test_a_free_top():
    """Euler's equations with a^2 + b^2 = 1 and c^2 = 4 - b^2/2: the period is 2 K(1/8)."""
    top = gt.ODE.of({"a": "-b*c", "b": "a*c", "c": "-b*a/2"}, [1, 0, 2],
                    invariants={"E": "a**2+b**2", "L": "a**2/2-c**2"})  # fmt: skip
    orbit = gt.closed_orbit(top, 3.2, section="b", conserved=["E", "L"], digits=20)
    with ball_precision(200):
        # a = cos, b = sin of an angle with angle'^2 = c^2 = 4 - sin^2/2.
        assert orbit.period.overlaps(2 * acb(arb(1) / 8).elliptic_k().real)
    assert orbit.stability == "neutral"


@pytest.mark.parametrize("seed", few(3, range(6)))
def test_random_cycles_with_known_truth(seed):
    """r' = m r (R^2 - r^2), phi' = w, in turned and stretched coordinates: all is known."""
    draw = random.Random(seed)
    m, size, w = (sp.Rational(draw.randint(2, 9), draw.randint(4, 9)) for _ in range(3))
    stretch = sp.Rational(draw.randint(2, 7), 3)
    x, y = sp.symbols("x y", real=True)
    a, b = x, y * stretch + x / 3
    grow = m * (size**2 - a**2 - b**2)
    da, db = grow * a - w * b, grow * b + w * a
    rates = {x: da, y: (db - da / 3) / stretch}
    near = [float(size) * draw.uniform(0.9, 1.1), 0.0]
    near[1] = -near[0] / 3 / float(stretch)
    guess = 2 * 3.1 / float(w)
    orbit = gt.closed_orbit(gt.ODE.of(rates, near), guess, section=b, digits=draw.choice([12, 25]))
    with ball_precision(300):
        period = 2 * arb.pi() * w.q / w.p
        assert orbit.period.overlaps(period)
        assert orbit["x"].contains(arb(size.p) / size.q)
        rate = sp.Rational(2 * m * size**2)
        assert orbit.multipliers[0].real.overlaps((-period * rate.p / rate.q).exp())


def test_a_spiral_has_no_closed_orbit():
    """x'' = -x - x'/10 has none; nothing is proved from any guess."""
    spiral = gt.ODE.of({"x": "v", "v": "-x-v/10"}, [1, 0])
    for guess in (3.0, 6.28):
        with pytest.raises(ProofError, match=r"equilibrium|no closed orbit|singular|not followed"):
            gt.closed_orbit(spiral, guess, section="v")


REFUSED = [
    (lambda: gt.closed_orbit(SWING, -1), ArgumentError, "period"),
    (lambda: gt.closed_orbit(SWING, 6, section=["v", "x-1"]), ArgumentError, "too many"),
    (lambda: gt.closed_orbit(SWING, 6, symmetry=["v"]), ArgumentError, "too few"),
    (lambda: gt.closed_orbit(SWING, 6, conserved=["x"]), ArgumentError, "proved not to change"),
    (lambda: gt.closed_orbit(SWING, 6, symmetry=["x", "v"]), ArgumentError, "reverses"),
    (lambda: gt.closed_orbit(SWING, 6, shift={"x": 1}), ArgumentError, "period of all rates"),
    (lambda: gt.closed_orbit(SWING, 6, shift={"x": None}), ArgumentError, "nothing depends"),
    (lambda: gt.closed_orbit(SWING, 6, symmetry=["w"]), UnknownNameError, "w"),
    (lambda: gt.closed_orbit(gt.ODE.of({"x": "v", "v": "-x", "z": "x"}, [1, 0, 0]), 6,
                             symmetry=["v", "z"], shift={"z": None}, section="x-1"),
     ArgumentError, "which need not return"),
    (lambda: gt.closed_orbit(3, 6), ArgumentError, "ODE"),
    (lambda: gt.closed_orbit(SWING.with_start([0, 0]), 6), ProofError, "nothing moves"),
    (lambda: gt.closed_orbit(SWING, 6, section="v"), ProofError, "equilibrium|family"),
    (lambda: gt.closed_orbit(gt.ODE.of({"x": "cos(t)"}, [0]), 6), ArgumentError, "time"),
    (lambda: gt.closed_orbit(SWING, 6, digits=0), ArgumentError, "digits"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "error", "words"), REFUSED)
def test_refusals(call, error, words):
    """Each refusal names the missing part."""
    with pytest.raises(error, match=words):
        call()


def test_displays():
    """Certain digits, JSON, a copy by pickle, and the orbit in floats."""
    orbit = gt.closed_orbit(SWING, 6.5, conserved=["E"], section="v")
    assert "period = 6.6999756643704" in str(orbit)
    assert orbit.to_json()["stability"] == "neutral"
    copy = pickle.loads(pickle.dumps(orbit))
    assert str(copy) == str(orbit)
    assert abs(float(orbit.solution["x"][-1]) - 1) < 2 * orbit.solution.accuracy
    with pytest.raises(UnknownNameError):
        orbit["y"]
