"""Prove: balls contain known values, errors are judged, and unprovable results are refused."""

# pyright: reportArgumentType=false

import pickle
from dataclasses import replace
from types import SimpleNamespace

import flint
import numpy as np
import pytest
import sympy as sp
from flint import arb

import geomtorsion as gt
from geomtorsion.errors import ArgumentError, ProofError, ShapeError, UnknownNameError
from geomtorsion.proofs import arc_integrals, motions
from geomtorsion.support import allowance
from geomtorsion.support.precision import ball_precision
from tests.ode.engines import needs_heyoka

SO3 = gt.spaces.load("so3").frame
SCREW = gt.spaces.load("screw_dislocation").frame
S2 = gt.spaces.load("s2").frame
SWING = {"x": "v", "v": "-sin(x)"}
X, Y = sp.symbols("x y", real=True)


def ode(rates, start, end, *, digits=15, **options):
    """The proof of a solution at its end."""
    return gt.prove(gt.solve(gt.ODE.of(rates, start, **options), end), digits)


def contains(ball, truth, digits):
    """Whether a ball contains a truth, a function of the precision, as sharply as requested."""
    with ball_precision(1000):
        value = truth() if callable(truth) else arb(truth)
    # A decimal truth is known to one unit of its last digit.
    sharp = ball.rad() <= abs(ball.mid()) * arb(10) ** (1 - digits)
    return bool(ball.overlaps(value)) and bool(sharp)


def decimal(text):
    """A number with this many known digits, as a ball of the open rest."""
    with ball_precision(400):
        digits = len(text.partition(".")[2])
        return arb(arb(text).mid(), arb(10) ** -digits)


@pytest.mark.parametrize("digits", [12, 30])
def test_cosine(digits):
    """x'' = -x gives cos 50 at t = 50."""
    proof = ode({"x": "v", "v": "-x"}, [1, 0], 50.0, digits=digits)
    assert proof.holds
    assert contains(proof.balls[-1][0], lambda: arb(50).cos(), digits)
    assert contains(proof.balls[-1][1], lambda: -arb(50).sin(), digits)


def test_pole_in_the_future():
    """x' = x^2 gives 1 / (1 - t): 64 at t = 63/64."""
    proof = ode({"x": "x**2"}, [1], 63 / 64, digits=20)
    assert contains(proof.balls[-1][0], 64, 20)


def test_wall():
    """x' = 2 + tanh x: (2 x - log(2 cosh x + sinh x)) / 3 grows by the time."""
    proof = ode({"x": "2+tanh(x)"}, [-40], 60.0, digits=20)
    x = proof.balls[-1][0]
    with ball_precision(400):
        start = arb(-40)
        spent = [(2 * y - (2 * y.cosh() + y.sinh()).log()) / 3 for y in (start, x)]
        assert (spent[1] - spent[0]).contains(60)
    assert contains(x, decimal("61.0986122886681096914"), 20)


def test_half_period_of_a_pendulum():
    """From angle 1 a pendulum is at rest again after 3.34998783218522635635."""
    options = {"events": [gt.When("-v")]}
    proof = ode(SWING, [1, 0], 10.0, digits=20, **options)
    assert proof.holds
    assert contains(proof.balls[-1][0], -1, 20)
    # The time of the event is a state of a clock that runs along.
    clocked = ode({**SWING, "s": "1"}, [1, 0, 0], 10.0, digits=20, **options)
    assert contains(clocked.balls[-1][2], decimal("3.3499878321852263563506"), 20)


def test_straight_line_in_polar_coordinates():
    """A geodesic of the plane has r and phi of the point (1 + t/2, t)."""
    r, phi = sp.symbols("r phi", positive=True)
    frame = gt.Frame([r, phi], [[1, 0], [0, r]])
    problem = gt.geodesic(frame, [1, 0], [sp.Rational(1, 2), 1])
    proof = gt.prove(gt.solve(problem, 3.0), 20)
    with ball_precision(300):
        x, y = arb(5) / 2, arb(3)
        truth = [(x * x + y * y).sqrt(), arb.atan2(y, x)]
    for ball, value in zip(proof.balls[-1], truth, strict=False):
        assert contains(ball, lambda value=value: value, 20)
    assert proof.names[-1][:2] == ("r", "phi")


@needs_heyoka
def test_lorenz():
    """The attractor at t = 20, to 18 digits."""
    rates = {"x": "10*(y-x)", "y": "x*(28-z)-y", "z": "x*y-8*z/3"}
    proof = ode(rates, [1, 1, 1], 20.0, digits=18)
    known = ("13.7931995951286188316", "12.9518039361898985400", "34.9016086811351429071")
    assert proof.holds
    for ball, text in zip(proof.balls[-1], known, strict=True):
        assert contains(ball, lambda text=text: decimal(text), 18)


def test_henon_heiles():
    """Chaos of two oscillators at t = 30."""
    rates = {"x": "px", "y": "py", "px": "-x-2*x*y", "py": "-y-x**2+y**2"}
    proof = ode(rates, [0.0, 0.1, 0.48, 0.0], 30.0, digits=20)
    assert contains(proof.balls[-1][0], lambda: decimal("-0.299197607328482062604"), 20)


def test_over_the_pole_of_a_sphere():
    """A great circle through two charts has the height of its closed form."""
    problem = gt.geodesic(S2, [1.0, 0.0], [-1.0, 0.01], parameters={"R": 1})
    proof = gt.prove(gt.solve(problem, 6.0))
    assert proof.holds
    assert set(proof.charts) == {"s2", "s2_x"}
    # z = cos(theta) oscillates with the frequency sqrt(1 + (sin(1) 0.01)^2).
    with ball_precision(200):
        rate = (1 + (arb(1).sin() * arb(0.01)) ** 2).sqrt()
        height = arb(1).cos() * (6 * rate).cos() + arb(1).sin() / rate * (6 * rate).sin()
        assert proof.charts[-1] == "s2"
        assert proof.balls[-1][0].cos().overlaps(height)


def test_circles_of_all_sizes():
    """The digits of a small circle in the rotations do not depend on its size."""
    for radius in (0.1, 1e-8, 1e-12, 1e-150):
        b = gt.burgers_vector(SO3, gt.Loop.circle([0.3, 1, 0.2], radius))
        proof = gt.prove(b, 20)
        assert proof.holds
        assert proof.balls[0].rel_accuracy_bits() >= 64


def test_a_loop_past_a_core():
    """A loop past the core of a screw dislocation, at 1e-6 of its radius: b = 1."""
    for far in (sp.Rational(1, 10**2), sp.Rational(1, 10**6)):
        b = gt.burgers_vector(SCREW, gt.Loop.circle([1, 0, 0], 1 + far), parameters={"b": 1})
        proof = gt.prove(b)
        assert contains(proof.balls[2], 1, 15)
        assert proof.holds


def test_a_loop_and_its_reverse_cancel():
    """The sum of both contains zero, and so does the proof of the joined loop."""
    spline = gt.Loop.spline([[0.3, 1, 0.2], [0.4, 1, 0.2], [0.3, 1.2, 0.3], [0.2, 1.1, 0.1]])
    for loop in (gt.Loop.circle([0.3, 1, 0.2], 0.1), spline):
        one = gt.prove(gt.burgers_vector(SO3, loop)).balls
        other = gt.prove(gt.burgers_vector(SO3, loop.reversed())).balls
        both = gt.prove(gt.burgers_vector(SO3, loop.then(loop.reversed()))).balls
        for x, y, z in zip(one, other, both, strict=True):
            assert (x + y).contains(0)
            assert z.contains(0)


def test_area_of_a_plaquette():
    """The rotation around a plaquette of the sphere is its area, (cos 1 - cos 1.5) / 4."""
    turn = gt.develop(
        gt.levi_civita(S2), gt.Loop.plaquette([1, 0], (0.5, 0.25)), parameters={"R": 1}
    )
    proof = gt.prove(turn, 20)
    assert proof.holds
    table = dict(zip(proof.names, proof.balls, strict=True))
    with ball_precision(200):
        angle = arb.atan2(table["R21"], table["R11"])
        assert (abs(angle) - (arb(1).cos() - arb(1.5).cos()) / 4).contains(0)
        assert abs(angle).overlaps(decimal("0.11739127605010920182819"))


def test_a_development_of_parallel_legs_is_the_burgers_vector():
    """The integral and the motion along the loop give overlapping balls."""
    loop = gt.Loop.circle([0.3, 1, 0.2], 0.1)
    one = gt.prove(gt.burgers_vector(SO3, loop), 20)
    other = gt.prove(gt.develop(gt.cartan(SO3), loop), 20)
    for x, y in zip(one.balls, other.balls, strict=False):
        assert x.overlaps(y)


def test_gaussian_integral():
    """exp(-x^2 / 2) / sqrt(2 pi) from -20 to 20: 1 except for 5.5e-89."""
    rates = {"p": "exp(-x**2/2)/sqrt(2*pi)", "x": "1"}
    proof = ode(rates, [0, -20], 40.0, digits=19)
    with ball_precision(400):
        truth = (20 / arb(2).sqrt()).erf()
    assert contains(proof.balls[-1][0], lambda: truth, 19)


def test_changes_at_given_times():
    """A spring that stiffens at t = 1: cos and sin, then with twice the frequency."""
    proof = ode({"x": "v", "v": "-k*x"}, [1, 0], 3.0, parameters={"k": 1},
                events=[gt.At(1.0, {"k": 4}), gt.At(2.0, {"v": 0})])  # fmt: skip
    assert proof.holds
    with ball_precision(200):
        x, v = arb(1).cos(), -arb(1).sin()
        x = x * arb(2).cos() + v / 2 * arb(2).sin()
        assert proof.balls[-1][0].overlaps(x * arb(2).cos())


def test_backwards_and_with_the_time_in_the_rates():
    """x' = t - x runs to negative times: x = t - 1 + 2 exp(-t) from 1."""
    proof = ode({"x": "t-x"}, [1], -3.0, digits=20)
    assert contains(proof.balls[-1][0], lambda: -4 + 2 * arb(3).exp(), 20)
    assert proof.holds


@needs_heyoka
def test_a_stop_between_two_samples_is_seen():
    """Where the solution missed a stop, its error does not hold."""
    problem = gt.ODE.of({"x": "1"}, [0], events=[gt.When("1-x")])
    other = gt.ODE.of({"x": "1"}, [0])
    honest, missed = gt.solve(problem, 2.0), gt.solve(other, 2.0)
    assert gt.prove(honest).holds
    assert gt.prove(_as_if(missed, problem)).holds is False


def _as_if(solution, problem):
    """A solution of other equations, presented as a solution of these."""
    return replace(solution, problem=problem)


def test_a_wrong_result_is_found():
    """A result off by more than its error does not hold; with a larger error it may."""
    b = gt.burgers_vector(SO3, gt.Loop.circle([0.3, 1, 0.2], 0.1))
    wrong = replace(b, reduced=b.reduced * (1 + 1e-9))
    proof = gt.prove(wrong)
    assert proof.holds is False
    assert proof.error > 1e-12
    assert gt.prove(replace(wrong, reduced_error=1.0)).holds
    solution = gt.solve(gt.ODE.of(SWING, [1, 0]), 5.0, accuracy=1e-6)
    assert gt.prove(solution).holds
    assert gt.prove(replace(solution, error=1e-16)).holds is False
    turn = gt.develop(gt.levi_civita(S2), gt.Loop.circle([1, 0], 0.1), parameters={"R": 1})
    assert gt.prove(replace(turn, turn_error=1e-30)).holds is False


def test_balls_of_starts_and_parameters():
    """Motions from a ball of starts: growth widens the ball as exp does."""
    solution = gt.solve(gt.ODE.of({"x": "k*x"}, [1], parameters={"k": 1}), 2.0)
    wide = gt.prove(solution, start=[arb(1, 0.125)])
    with ball_precision(200):
        assert wide.balls[-1][0].contains(arb("1.125") * arb(2).exp())
        assert wide.balls[-1][0].contains(arb("0.875") * arb(2).exp())
        assert wide.balls[-1][0].rad() < 1.2
    assert wide.holds is None
    assert "balls" in wide.assumes[-1]
    other = gt.prove(solution, parameters={"k": arb(1, 1e-6)})
    with ball_precision(200):
        assert other.balls[-1][0].contains((2 * (1 + arb(1e-6).lower())).exp())
    b = gt.burgers_vector(SCREW, gt.Loop.circle([0, 0, 0], 1), parameters={"b": 1})
    assert gt.prove(b, parameters={"b": arb(1, 1e-3)}).balls[2].contains(arb("1.0009"))


def test_what_a_proof_shows():
    """Values, radii and text agree with the balls."""
    proof = ode({"x": "v", "v": "-x"}, [1, 0], np.array([1.0, 2.0]))
    assert proof.values.shape == proof.radii.shape == (2, 2)
    assert abs(proof.values[0, 0] - np.cos(1)) <= proof.radii[0, 0] + 1e-16
    assert proof.names[0] == ("x", "v")
    text = str(proof)
    assert "the reported error" in text
    assert "holds" in text
    assert "x = -0.416146836547142" in text
    assert len(proof.assumes) == 3
    assert proof.bits > 50
    assert proof.steps > 0
    assert proof.seconds > 0


def test_equal_calls_give_equal_balls():
    """Two equal proofs agree bit by bit."""
    solution = gt.solve(gt.ODE.of(SWING, [1, 0]), 5.0)
    one, other = gt.prove(solution), gt.prove(solution)
    for x, y in zip(one.balls[-1], other.balls[-1], strict=True):
        assert x.mid() == y.mid()
        assert x.rad() == y.rad()


def test_a_copy_has_the_same_balls():
    """A pickled copy has the same centres, and radii at most 0.1 % larger."""
    one = gt.prove(B, 40)
    other = pickle.loads(pickle.dumps(one))
    for x, y in zip(one.balls, other.balls, strict=True):
        assert x.mid() == y.mid()
        assert x.rad() <= y.rad() <= x.rad() * 1.001


def _solved(rates, start, end, **options):
    return gt.solve(gt.ODE.of(rates, start, **options), end)


def _beyond(rates, start, end, later):
    """A solution, presented as if it had continued to a later time."""
    solution = _solved(rates, start, end)
    segment = solution.trajectory.segments[-1]
    run = replace(segment.run, reached=later)
    times = segment.run.times.copy()
    times[-1] = later
    run = replace(run, times=times)
    segments = (*solution.trajectory.segments[:-1], replace(segment, run=run))
    trajectory = replace(solution.trajectory, segments=segments)
    return replace(solution, trajectory=trajectory, times=np.append(solution.times[:-1], later))


B = gt.burgers_vector(SO3, gt.Loop.circle([0.3, 1, 0.2], 0.1))
LOG = gt.Frame([X, Y], [[sp.log(X), 0], [0, 1]])
RADICAL = gt.Frame([X, Y], [[1, 0], [sp.sqrt(X), 1]])
STIFF = gt.ODE.of({"x": "-k*(x-cos(t))"}, [1], time="t", parameters={"k": 1e5})


def as_if_around(result, loop):
    """A result presented as computed for another loop."""
    return replace(result, loop=loop)


def _through(frame, loop, **options):
    """A result whose loop differs from the computed one."""
    start = gt.Loop.circle([5, 5, 0][: frame.dimension], 1)
    return as_if_around(gt.burgers_vector(frame, start, **options), loop)


REFUSED = [
    (lambda: gt.prove(_beyond({"x": "x**2"}, [1], 0.5, 2.0)), ProofError, "t = 1:"),
    (lambda: gt.prove(_beyond({"x": "-sqrt(x)"}, [1], 1.5, 3.0)), ProofError, "t = 2:"),
    (lambda: gt.prove(_beyond({"x": "sqrt(1-x)"}, [0], 1.5, 3.0)), ProofError, "t = 2:"),
    (lambda: gt.prove(_beyond({"x": "1", "y": "sqrt(x-1)"}, [1, 0], 0.5, 1.0)), ProofError,
     "a root has no power series there"),
    (lambda: gt.prove(gt.solve(STIFF, 1.0, 1e-6, gt.Stiff())), ProofError,
     "the equations are stiff"),
    (lambda: gt.prove(gt.solve(gt.ODE.of({"x": 1, "y": "Si(x)"}, [-0.5, 0]), 1.0)), ProofError,
     "the edge of a function is near"),
    pytest.param(
     lambda: gt.prove(_solved({"x": "v", "v": "-x"}, [1, 0], 3.0, events=[gt.When("1-v**2")])),
     ProofError, "touches the stop", marks=needs_heyoka),
    (lambda: gt.prove(_through(SCREW, gt.Loop.circle([1, 0, 0], 1), parameters={"b": 1})),
     ProofError, "a pole or an edge is on the loop"),
    (lambda: gt.prove(_through(LOG, gt.Loop.circle([0.5, 0], 1))), ProofError, "no finite value"),
    (lambda: gt.prove(_through(RADICAL, gt.Loop.circle([0.5, 0], 1))), ProofError, "finite value"),
    (lambda: gt.prove(B, 0), ArgumentError, "digits"),
    (lambda: gt.prove(B, 1001), ArgumentError, "digits"),
    (lambda: gt.prove(B, 2.5), ArgumentError, "digits"),
    (lambda: gt.prove(B, "many"), ArgumentError, "digits"),
    (lambda: gt.prove(3.0), ArgumentError, "expected a BurgersVector"),
    (lambda: gt.prove(B, start=[1]), ArgumentError, "start"),
    (lambda: gt.prove(B, parameters={"b": 1}), UnknownNameError, "parameters"),
    (lambda: gt.prove(_solved({"x": "-x"}, [1], 1.0), start=[float("nan")]), ArgumentError, "nan"),
    (lambda: gt.prove(_solved({"x": "-x"}, [1], 1.0), start=[arb("inf")]), ArgumentError,
     "finite ball"),
    (lambda: gt.prove(_solved({"x": "-x"}, [1], 1.0), start=[1, 2]), ShapeError, "1 numbers"),
    (lambda: gt.prove(_solved({"x": "-x"}, [1], 1.0), start={"y": 2}), UnknownNameError, "got 'y'"),
    (lambda: gt.prove(_solved({"x": "-x"}, [1], 1.0), start=["one"]), ArgumentError, "start"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "error", "words"), REFUSED)
def test_bad_calls_are_refused(monkeypatch, call, error, words):
    """Without a true value no ball is given; the refusal takes at most a few hundred steps."""
    steps = []
    plain = motions.prove_step
    monkeypatch.setattr(motions, "prove_step", lambda *given: steps.append(1) or plain(*given))
    with pytest.raises(error) as caught:
        call()
    assert words in str(caught.value)
    assert len(steps) < 600


def test_precision_is_restored():
    """The precision and the length of series are restored, also after an error."""
    before = flint.ctx.prec, flint.ctx.cap
    gt.prove(B, 50)
    with pytest.raises(ProofError):
        REFUSED[0][0]()
    assert (flint.ctx.prec, flint.ctx.cap) == before


def test_limits_are_obeyed(monkeypatch):
    """A proof asks for its limits often, and stops at the first check past them."""
    rates = {"x": "10*(y-x)", "y": "x*(28-z)-y", "z": "x*y-8*z/3"}
    solution = _solved(rates, [1, 1, 1], 15.0)
    before = flint.ctx.prec, flint.ctx.cap
    for call in (
        lambda: gt.prove(solution, 100),
        lambda: gt.prove(_near_core(), 300),
    ):
        looks = []

        def clock(looks=looks):
            looks.append(1)
            return 0.0 if len(looks) < 30 else 1e6

        with monkeypatch.context() as patch:
            patch.setattr(allowance, "time", SimpleNamespace(monotonic=clock))
            with pytest.raises(gt.errors.AllowanceError), gt.limits(seconds=1):
                call()
        assert len(looks) == 30
    assert (flint.ctx.prec, flint.ctx.cap) == before


def _near_core():
    loop = gt.Loop.circle([1, 0, 0], 1 + sp.Rational(1, 10**6))
    return gt.burgers_vector(SCREW, loop, parameters={"b": 1})


def test_a_raise_inside_an_integral_comes_out(monkeypatch):
    """An exception of a callback is raised unchanged, where FLINT would raise a SystemError."""

    def integrand(*_):
        def raising(s, analytic):
            raise ZeroDivisionError("inside")

        return raising

    monkeypatch.setattr(arc_integrals, "_integrand", integrand)
    with pytest.raises(ZeroDivisionError, match="inside"):
        gt.prove(B)
