"""Brownian motion with torsion: generators, measures and means against closed forms."""

from typing import Any

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError

X, Y = sp.symbols("x y", real=True)
K = sp.Symbol("k", positive=True)
PLANE = gt.Frame([X, Y], [[1, 0], [0, 1]], parameters=[K])
POLAR = gt.spaces.load("flat_polar").frame


def with_vector(one: object, two: object) -> gt.Connection:
    """The plane with a torsion vector v = (one, two): T_12^2 = v_1 and T_12^1 = -v_2."""
    torsion = np.zeros((2, 2, 2), dtype=object)
    torsion[0, 1, 1], torsion[0, 1, 0] = sp.sympify(one) / 2, -sp.sympify(two) / 2
    torsion[1, 0] = -torsion[0, 1]
    return gt.from_torsion(PLANE, torsion.tolist())


def backwards(motion: gt.loops.Diffusion, density: sp.Expr) -> sp.Expr:
    """The rate of a density, from L on coordinates and on their products (Fokker and Planck)."""
    q = motion.connection.frame.coordinates
    pushed = [motion.generator(x) for x in q]
    rate = -sum(sp.diff(b * density, x) for b, x in zip(pushed, q, strict=True))
    for i, x in enumerate(q):
        for j, y in enumerate(q):
            spread = motion.generator(x * y) - x * pushed[j] - y * pushed[i]
            rate += sp.diff(spread * density, x, y) / 2
    return sp.simplify(rate)


def test_the_torsion_vector_is_the_drift() -> None:
    """B is minus half the torsion vector, also where the rest of the torsion is large."""
    motion = gt.diffusion(with_vector(K * X, X * Y))
    assert [sp.simplify(motion.drift[i] - b) for i, b in enumerate((-K * X / 2, -X * Y / 2))] == [
        0,
        0,
    ]
    f = X**3 * Y
    expected = (f.diff(X, 2) + f.diff(Y, 2) - K * X * f.diff(X) - X * Y * f.diff(Y)) / 2
    assert sp.expand(motion.generator(f) - expected) == 0
    axial = gt.spaces.load("axial_torsion").connection
    assert axial is not None
    assert gt.diffusion(axial).drift.is_zero


@pytest.mark.parametrize(
    "name", ["so3", "s2", "s3", "heisenberg", "sol", "ax_plus_b", "bianchi_iv", "flat_spherical",
             "kustaanheimo_stiefel", "sl2r"]
)  # fmt: skip
@pytest.mark.parametrize("kind", [gt.cartan, gt.levi_civita])
def test_the_invariant_measure_does_not_change(name: str, kind: Any) -> None:
    """The equation of Fokker and Planck maps the exact density to zero."""
    motion = gt.diffusion(kind(gt.spaces.load(name).frame))
    measure = motion.invariant_measure
    assert measure.density is not None
    assert measure.reversible is True
    assert backwards(motion, measure.density) == 0


def test_measures_with_closed_and_open_torsion_vectors() -> None:
    """A closed vector has a reversible measure; without divergence the area is invariant."""
    bound = gt.diffusion(with_vector(K * X, 0)).invariant_measure
    assert bound.reversible
    assert sp.simplify(bound.density / sp.exp(-K * X**2 / 2)).is_constant()
    turning = gt.diffusion(with_vector(-Y, X))
    assert turning.invariant_measure.density == 1
    assert turning.invariant_measure.reversible is False
    assert dict(turning.invariant_measure.obstructions) == {(0, 1): -2}
    assert backwards(turning, sp.Integer(1)) == 0
    none = gt.diffusion(with_vector(0, X * Y)).invariant_measure
    assert none.density is None
    assert repr(none) == "InvariantMeasure(density not known, not reversible, d(2 b)_12 = -y)"


def test_a_reversible_measure_may_have_no_closed_form() -> None:
    """A gradient whose integral no formula gives has a reversible measure all the same."""
    measure = gt.diffusion(with_vector(sp.exp(sp.exp(X) + X**2), 0)).invariant_measure
    assert measure.reversible is True
    assert measure.density is None
    assert repr(measure) == "InvariantMeasure(density not known, reversible)"


def test_a_measure_with_an_unknown_function() -> None:
    """The frame (dx, f(x) dy) with parallel legs keeps the measure dx dy for any f."""
    f = sp.Function("f")(X)
    measure = gt.diffusion(gt.cartan(gt.Frame([X, Y], [[1, 0], [0, f]]))).invariant_measure
    assert measure.density == 1


def means(connection: gt.Connection, start: list, t: float, functions: list, **more: Any) -> list:
    """Means of functions over an ensemble of 20000 members."""
    options: dict[str, Any] = {"members": 20_000, "steps": 64, "seed": 3, **more}
    run = gt.diffusion(connection).ensemble(start, t, **options)
    return [run.mean(f) for f in functions]


def agrees(mean: Any, expected: float) -> bool:
    """Whether a mean agrees within three errors, and the error is below 5 percent of 1."""
    return abs(mean.value - expected) < 3 * mean.error and mean.error < 0.05


def test_heat_on_the_sphere() -> None:
    """On the unit sphere, cos(theta) and P_2(cos(theta)) decay as exp(-t) and exp(-3 t)."""
    sphere = gt.levi_civita(gt.spaces.load("s2").frame)
    one, two = means(
        sphere, [1.1, 0.0], 0.5, ["cos(theta)", "3*cos(theta)**2/2 - 1/2"], parameters={"R": 1}
    )
    c = np.cos(1.1)
    assert agrees(one, c * np.exp(-0.5))
    assert agrees(two, (1.5 * c**2 - 0.5) * np.exp(-1.5))


def test_the_plane_in_polar_coordinates_with_and_without_torsion() -> None:
    """Without torsion r^2 grows by 2 t and x stays; the polar frame with torsion gives t and r."""
    square, x = means(gt.levi_civita(POLAR), [2.0, 0.0], 0.3, ["r**2", "r*cos(phi)"])
    assert agrees(square, 4.6)
    assert agrees(x, 2.0)
    square, radius = means(gt.cartan(POLAR), [2.0, 0.0], 0.3, ["r**2", "r"])
    assert agrees(square, 4.3)
    assert agrees(radius, 2.0)


def test_torsion_pulls_a_particle_back() -> None:
    """The vector v = k x dx gives the process of Ornstein and Uhlenbeck."""
    k, t, x = 2.0, 0.7, 1.5
    mean, square = means(with_vector(K * X, 0), [x, 0.0], t, ["x", "x**2"], parameters={"k": k})
    assert agrees(mean, x * np.exp(-k * t / 2))
    assert agrees(square, x**2 * np.exp(-k * t) + (1 - np.exp(-k * t)) / k)


def test_brownian_motion_in_space_by_the_map_of_kustaanheimo_and_stiefel() -> None:
    """With torsion r^2 grows by 3 t as in space, without it by 4 t as in four dimensions."""
    frame = gt.spaces.load("kustaanheimo_stiefel").frame
    square = "(q1**2 + q2**2 + q3**2 + q4**2)**2"
    start = [1.0, 0.0, 0.5, 0.0]
    for connection, rate in ((gt.cartan(frame), 3), (gt.levi_civita(frame), 4)):
        assert sp.simplify(gt.diffusion(connection).generator(square)) == rate
        (mean,) = means(connection, start, 0.1, [square])
        assert agrees(mean, 1.25**2 + rate * 0.1)


def test_the_error_of_the_steps_covers_coarse_steps_and_falls() -> None:
    """Few steps give a large error, which is reported; with steps halved it falls by half."""
    bound = with_vector(K * X, 0)
    results = [
        means(bound, [1.5, 0.0], 1.0, ["x"], parameters={"k": 4}, steps=steps)[0]
        for steps in (4, 8, 16)
    ]
    assert all(abs(m.value - 1.5 * np.exp(-2)) < 3 * m.error for m in results)
    assert results[0].step_error > 1.8 * results[1].step_error > 3 * results[2].step_error


def test_equal_calls_give_equal_bits() -> None:
    """A seed decides the ensemble."""
    one, two, other = (
        gt.diffusion(gt.cartan(POLAR)).ensemble([1.0, 0.0], 0.1, members=5, steps=4, seed=seed)
        for seed in (1, 1, 2)
    )
    assert (one.places == two.places).all()
    assert (one.places != other.places).all()
    assert repr(one) == "StochasticEnsemble(5 members at t = 0.1, 4 steps, seed 1)"


MOTION = gt.diffusion(gt.levi_civita(gt.spaces.load("s2").frame))
RUN: dict[str, Any] = {"members": 10, "steps": 4, "seed": 0, "parameters": {"R": 1}}
FRAMELESS: Any = POLAR


def ensemble(start: Any = (1, 0), t: Any = 1, **more: Any) -> object:
    """An ensemble with some options replaced."""
    return MOTION.ensemble(start, t, **RUN | more)


REFUSALS = (
    (lambda: gt.diffusion(gt.cartan(gt.spaces.load("schwarzschild").frame)), "positive metric"),
    (lambda: gt.diffusion(gt.constrained(PLANE, ["dy - x*dx"])), "without constraints"),
    (lambda: gt.diffusion(FRAMELESS), "connection"),
    (lambda: ensemble(start=[1]), "expected 2"),
    (lambda: ensemble(start=[1, np.nan]), "finite"),
    (lambda: ensemble(t=0), "positive number"),
    (lambda: ensemble(members=1), "whole number"),
    (lambda: ensemble(steps=5), "even number, got 5"),
    (lambda: ensemble(seed=-1), "whole number"),
    (lambda: ensemble(members=10**9), "GB of memory"),
    (lambda: ensemble(parameters={}), "expected a value for R, got none"),
    (lambda: ensemble(parameters={"R": 1, "Q": 2}), "Q"),
    (lambda: ensemble(start=[0, 0]), "no finite position"),
    (lambda: MOTION.generator("cos(rho)"), "rho"),
    (lambda: MOTION.ensemble((1, 0), 0.1, **RUN).mean("1/(theta - theta)"), "zero"),
    (lambda: MOTION.ensemble((1, 0), 0.1, **RUN).mean("log(theta - 1)"), "finite values"),
)  # fmt: skip


@pytest.mark.parametrize(("call", "words"), REFUSALS)
def test_refusals(call, words) -> None:
    """Bad input is refused, and the message names the expected input."""
    with pytest.raises(GeomtorsionError, match=words):
        call()
