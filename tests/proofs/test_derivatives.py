"""Derivatives of motions: their balls contain known values, over single starts and over balls."""

# pyright: reportArgumentType=false

import random

import pytest
from flint import arb, arb_mat, fmpq

import geomtorsion as gt
from geomtorsion.errors import ArgumentError, StartError, TimeError, UnknownNameError
from geomtorsion.support.precision import ball_precision

S2 = gt.spaces.load("s2").frame
SO3 = gt.spaces.load("so3").frame
SWING = {"x": "v", "v": "-sin(x)"}


def proved(problem, time, digits=15, **options):
    """The proof of a motion at its end, with derivatives."""
    return gt.prove(gt.solve(problem, [time]), digits, **options)


def test_exponential_growth():
    """x' = k x from x: dx/dk = t x exp(k t) and dx/dx = exp(k t)."""
    growth = gt.ODE.of({"x": "k*x"}, [3], parameters={"k": 2})
    proof = proved(growth, 1.5, 30, derivatives=["k", "x"])
    assert proof.names == (("x", "dx_dk", "dx_dx"),)
    assert proof.holds
    with ball_precision(300):
        size = arb(3).exp()
        for name, truth in (("x", 3 * size), ("dx_dk", 4.5 * size), ("dx_dx", size)):
            (ball,) = proof[name]
            assert ball.overlaps(truth)
            assert ball.rel_accuracy_bits() > 98


@pytest.mark.parametrize("seed", range(12))
def test_random_linear_systems(seed):
    """x' = (A + p B) x: the derivatives are blocks of the exponential of [[A, B], [0, A]]."""
    draw = random.Random(seed)
    n = draw.choice([1, 2, 3])
    a, b = ([[fmpq(draw.randint(-9, 9), 8) for _ in range(n)] for _ in range(n)] for _ in "ab")
    names = [f"x{k}" for k in range(n)]
    rates = {
        f"x{i}": " + ".join(f"(({a[i][j]}) + p*({b[i][j]}))*x{j}" for j in range(n))
        for i in range(n)
    }
    start = [draw.randint(-3, 3) for _ in range(n)]
    time, digits = draw.choice([0.25, 1.0, 2.5]), draw.choice([12, 30])
    problem = gt.ODE.of(rates, start, parameters={"p": 0})
    proof = proved(problem, time, digits, derivatives=["p", *names])
    with ball_precision(400):
        zero = [arb(0)] * n
        rows = [[*map(arb, x), *map(arb, y)] for x, y in zip(a, b, strict=True)]
        rows += [[*zero, *map(arb, x)] for x in a]
        power = (arb_mat(rows) * arb(time)).exp()
        balls = proof.at(time)
        for i in range(n):
            by_p = sum((power[i, n + j] * start[j] for j in range(n)), arb(0))
            truths = [by_p, *(power[i, j] for j in range(n))]
            for name, truth in zip(["p", *names], truths, strict=True):
                assert balls[f"dx{i}_d{name}"].overlaps(truth)
                assert balls[f"dx{i}_d{name}"].rad() < arb(10) ** (3 - digits) * (1 + abs(truth))


def test_the_run_agrees_with_the_larger_system():
    """Derivatives of a pendulum at 30 digits, and of the motion solved with its derivatives."""
    problem = gt.ODE.of(SWING, [1, 0])
    one = proved(problem, 5.0, 30, derivatives=["x", "v"]).at(5.0)
    other = gt.prove(gt.solve(problem, [5.0], derivatives=["x", "v"]), 30).at(5.0)
    assert set(one) == set(other)
    for name, ball in one.items():
        assert ball.overlaps(other[name])
        assert ball.rel_accuracy_bits() > 95


@pytest.mark.parametrize("radius", [2.0**-40, 2.0**-20, 2.0**-7])
def test_all_motions_from_a_ball(radius):
    """x' = x^2 from 1 gives x = x0 / (1 - x0 t): the derivative at each start is in the ball."""
    problem = gt.ODE.of({"x": "x**2"}, [1])
    ball = proved(problem, 0.5, start=[arb(1, radius)], derivatives=["x"])["dx_dx"][0]
    with ball_precision(200):
        for side in (-1, 0, 1):
            start = 1 + side * arb(radius)
            assert ball.contains((1 / (1 - start / 2) ** 2).mid())
        assert ball.rad() < 100 * radius


def test_changes_at_given_times():
    """A spring that stiffens at t = 1 and is stopped at t = 2: only earlier numbers count."""
    events = [gt.At(1.0, {"k": 4}), gt.At(2.0, {"v": 0})]
    problem = gt.ODE.of({"x": "v", "v": "-k*x"}, [1, 0], parameters={"k": 1}, events=events)
    balls = proved(problem, 3.0, derivatives=["k", "x"]).at(3.0)
    with ball_precision(200):
        one, two = arb(1), arb(2)
        # x = cos(w), v = -w sin(w) with w = sqrt(k), at t = 1.
        by_k = -one.sin() / 2, -(one.sin() + one.cos()) / 2
        by_x = one.cos(), -one.sin()
        for name, (x, v) in (("k", by_k), ("x", by_x)):
            truth = (x * two.cos() + v / 2 * two.sin()) * two.cos()
            assert balls[f"dx_d{name}"].overlaps(truth)


def test_time_in_the_rates():
    """x' = g t - x from x: dx/dg = t - 1 + exp(-t), dx/dx = exp(-t)."""
    problem = gt.ODE.of({"x": "g*t-x"}, [1], parameters={"g": 3})
    for time in (2.0, -1.0):
        balls = proved(problem, time, 20, derivatives=["g", "x"]).at(time)
        with ball_precision(200):
            fall = (-arb(time)).exp()
            assert balls["dx_dg"].overlaps(arb(time) - 1 + fall)
            assert balls["dx_dx"].overlaps(fall)


def test_nothing_moves():
    """A rate of zero: the derivative by the start is one, by a parameter zero."""
    balls = proved(gt.ODE.of({"x": 0}, [0], parameters={}), 1.0, derivatives=["x"]).at(1.0)
    assert balls["dx_dx"].contains(1)
    balls = proved(gt.ODE.of({"x": "0*k"}, [0], parameters={"k": 1}), 1.0, derivatives=["k"])
    assert balls["dx_dk"][0].contains(0)


CURVES = [
    # Over the pole of a sphere, through two charts.
    (gt.geodesic(S2, [1.0, 0.0], [-1.0, 0.01], parameters={"R": 1}), 3.0, "theta"),
    (gt.geodesic(S2, [1.0, 0.0], frame_velocity=[-1.0, 0.01], parameters={"R": 1}), 3.0, "R"),
    (gt.geodesic(S2, [1.0, 0.0], [-1.0, 0.01], parameters={"R": 1}), 3.0, "phi'"),
    # Constant frame velocities, which are parameters of the equations, and a top.
    (gt.autoparallel(gt.cartan(SO3), [0.3, 1, 0.2], frame_velocity=[1, 0.5, 0.1]), 4.0, "u2"),
    (gt.geodesic(SO3, [0.3, 1, 0.2], frame_velocity=[1, 0.5, 0.1], metric=[1, 2, 3]), 4.0, "u1"),
]


@pytest.mark.parametrize(("problem", "time", "by"), CURVES)
def test_mean_values_along_curves(problem, time, by):
    """The change from one start to another is the change of the start times a derivative."""
    change, solution = 2.0**-20, gt.solve(problem, [time])
    value = float(problem.variables[by])
    other = gt.solve(problem.with_values({by: value + change}), [time])
    assert solution.trajectory.labels == other.trajectory.labels
    ends = gt.prove(solution, 25), gt.prove(other, 25)
    slopes = gt.prove(solution, 15, derivatives=[by]).at(time)
    halfway = gt.solve(problem.with_values({by: value + change / 2}), [time])
    middle = gt.prove(halfway, 15, derivatives=[by]).at(time)
    word = by.replace("'", "dot")
    for name, x, y in zip(ends[0].names[0], *(end.balls[0] for end in ends), strict=True):
        with ball_precision(200):
            quotient = (y - x) / arb(change)
            # A central difference: its error is a third derivative times change^2 / 24.
            gap = abs(quotient - middle[f"d{name}_d{word}"])
            assert gap < arb(change) ** 2 * 100
            assert abs(quotient - slopes[f"d{name}_d{word}"]) < arb(change) * 100


def test_at_a_stop():
    """A body that falls onto z = 0: derivatives at the fixed time at which it arrives."""
    fall = gt.ODE.of({"z": "v", "v": "-g"}, [20, 0], parameters={"g": 10}, events=[gt.When("z")])
    proof = gt.prove(gt.solve(fall, 3.0), derivatives=["g", "v"])
    assert proof["dz_dg"][-1].overlaps(arb(-2))
    assert proof["dz_dv"][-1].overlaps(arb(2))


@pytest.mark.parametrize("time", [0.0, 0.3, 0.5, 0.99, 1.0])
def test_any_time_of_a_solution(time):
    """x'' = -x from a ball: cos t (1 +- 1e-6), with its derivative, at and between the times."""
    spring = gt.ODE.of({"x": "v", "v": "-x"}, [1, 0])
    start = {"x": arb(1, 1e-6)}
    proof = gt.prove(gt.solve(spring, [0.5, 1.0]), start=start, derivatives=["x"])
    balls = proof.at(time)
    with ball_precision(100):
        for x in (arb(1), arb(1) + arb(1e-6).lower(), arb(1) - arb(1e-6).lower()):
            assert balls["x"].overlaps(x * arb(time).cos())
        assert balls["dv_dx"].overlaps(-arb(time).sin())
        assert balls["x"].rad() < 2e-6
    assert gt.prove(gt.solve(spring, 1.0)).at(1.0).keys() == {"x", "v"}


@pytest.mark.parametrize("time", [0.05, 0.77])
def test_any_time_of_a_curve_in_another_chart(time):
    """A great circle over the pole of a sphere: x = sin(0.3 - t) cos(0.2)."""
    curve = gt.geodesic("s2", [0.3, 0.2], frame_velocity=[-1, 0], parameters={"R": 1})
    balls = gt.prove(gt.solve(curve, 1.0)).at(time)
    with ball_precision(100):
        # The other chart measures the angle from the x axis.
        x = (arb(0.3) - arb(time)).sin() * arb(0.2).cos()
        assert balls["theta_x"].cos().overlaps(x)


def test_balls_by_name():
    """Balls of one name at all times, of one time under all names, and of a loop."""
    solution = gt.solve(gt.ODE.of(SWING, [1, 0]), [0.5, 1.0])
    proof = gt.prove(solution)
    assert len(proof["x"]) == 2
    assert proof["v"][1] is proof.balls[1][1]
    assert proof.at(1.0)["x"] is proof.balls[1][0]
    loop = gt.prove(gt.burgers_vector(SO3, gt.Loop.circle([0.3, 1, 0.2], 0.1)))
    assert loop["b1"] is loop.balls[0]
    refused = [
        (lambda: proof["y"], UnknownNameError), (lambda: proof.at(1.1), TimeError),
        (lambda: proof.at(-0.1), TimeError), (lambda: proof.at([0.5]), TimeError),
        (lambda: loop.at(0.0), TimeError), (lambda: loop["x"], UnknownNameError),
        (lambda: gt.prove(solution, derivatives=["k"]), UnknownNameError),
        (lambda: gt.prove(solution, derivatives=["x", "x"]), StartError),
        (lambda: gt.prove(loop.result, derivatives=["x"]), ArgumentError),
    ]  # fmt: skip
    for call, kind in refused:
        with pytest.raises(kind):
            call()
