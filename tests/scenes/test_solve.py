"""Closed form of free bodies: agrees with the integrator, and is refused where unchecked."""

from dataclasses import replace
from fractions import Fraction
from functools import partial
from importlib import import_module

import mpmath
import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.rigid.double_double import DoubleDouble
from geomtorsion.scenes import effects as E
from geomtorsion.scenes.solve import ClosedForm, checked_states
from tests.chosen import one_in
from tests.ode.engines import ENGINES
from tests.rounding import ROUNDED
from tests.scenes.test_exact_inputs import exact_rates

SKEW = np.array([[0.12, 0.01, -0.015], [0.01, 0.16, 0.02], [-0.015, 0.02, 0.2]])


@pytest.mark.parametrize(
    "moments", [(1, 2, 3), (2, 2, 1), (1, 1, 1)], ids=["asymmetric", "symmetric", "spherical"]
)
def test_closed_form_and_integrator_agree(moments):
    """Elliptic functions and series give the same values of all watched quantities."""
    names = ["omega", "quaternion", "angular_momentum_space", "axis", "nutation", "position"]
    start = gt.State(omega=(0.3, 1, 0.2), euler=(0.3, 0.5, 2), velocity=(1, 0, 2))
    scene = gt.Scene(gt.Body(moments=moments), (), start, names, t=30, accuracy=1e-11)
    closed, stepped = scene.run(), scene.run(engine=gt.Taylor())
    assert closed.closed_form == "free top (Jacobi elliptic functions)"
    assert stepped.closed_form is None
    for name in names:
        assert np.abs(closed[name] - stepped[name]).max() < 1e-10 * np.abs(stepped[name]).max()
    assert max(closed.drift.values()) < 5e-15
    between = closed.at([0.1, 12.34])
    assert np.abs(between["axis"] - stepped.at([0.1, 12.34])["axis"]).max() < 1e-10
    assert closed.at(0.1)["nutation"].shape == ()


def test_closed_form_in_any_axes():
    """A body with other principal axes than the body axes, watched only through the vertical."""
    start = gt.State(omega=(0.3, 1, 0.2), euler=(0.3, 0.5, 2))
    scene = gt.Scene(gt.Body(1, inertia=SKEW), (), start, ["omega", "vertical"], t=20)
    closed, stepped = scene.run(), scene.run(engine=gt.RungeKutta())
    assert closed.closed_form
    assert np.abs(closed["omega"] - stepped["omega"]).max() < 2e-10
    assert np.abs(closed["vertical"] - stepped["vertical"]).max() < 2e-10


def test_closed_form_is_not_taken_for_what_it_is_not():
    """Damping, a pivot with weight, falling positions and the naive law are integrated."""
    start = gt.State(omega=(0.3, 1, 0.2), euler=(0.3, 0.5, 2))
    body = gt.Body(moments=(1, 2, 3))
    for effects, watch in (
        ([E.AngularDamping(0.1)], "omega"),
        ([E.Gravity(), E.Pivot([0, 0, 1])], "omega"),
        ([E.Gravity()], "position"),
        ([E.Naive()], "omega"),
    ):
        assert gt.Scene(body, effects, start, [watch], t=1).run().closed_form is None
    falling = gt.Scene(body, [E.Gravity()], start, ["omega"], t=1).run()
    assert falling.closed_form


@pytest.mark.parametrize("push", [1e-3, 1e-8, 1e-12])
def test_next_to_the_unstable_axis(push):
    """Where doubles lose ten digits, the closed form is used and its error is below 1e-10."""
    start = gt.State(omega=(push, 1, 0), quaternion=(1, 0, 0, 0))
    scene = gt.Scene(gt.Body(moments=(1, 2, 3)), (), start, ["omega", "matrix"], t=80)
    result = scene.run()
    assert result.closed_form
    assert result.error < 1e-10
    long = gt.solve(scene.ode, scene.times, 1e-17, gt.Taylor(113))
    states = np.asarray(long.states, dtype=float)
    assert np.abs(result["omega"] - states[:, :3]).max() < ROUNDED


def test_a_closed_form_that_fails_its_check_is_not_used(monkeypatch):
    """A closed form off by one part in 10^7 is replaced by the integrator."""
    start = gt.State(omega=(0.3, 1, 0.2))
    scene = gt.Scene(gt.Body(moments=(1, 2, 3)), (), start, ["omega"], t=5)
    right, states = scene.run(), ClosedForm.states
    assert right.closed_form
    monkeypatch.setattr(ClosedForm, "states", lambda self, t: states(self, t) * (1 + 1e-7))
    other = scene.run()
    assert other.closed_form is None
    assert np.abs(other["omega"] - right["omega"]).max() < 1e-9


WRONG = 1 + 1e-10


def clock(monkeypatch):
    """Time runs wrong."""
    states = ClosedForm.states
    monkeypatch.setattr(ClosedForm, "states", lambda form, t: states(form, t * WRONG))


def scale(monkeypatch):
    """All states are wrong by a factor."""
    states = ClosedForm.states
    monkeypatch.setattr(ClosedForm, "states", lambda form, t: states(form, t) * WRONG)


def constant(name, monkeypatch):
    """A constant of the formulas is wrong by a factor."""
    module = import_module("geomtorsion.rigid.free_top")  # the function of this name hides it
    right = module.constants

    def wrong(moments, omega):
        found = right(moments, omega)
        value = getattr(found, name)
        return replace(found, **{name: DoubleDouble(value.high * WRONG, value.low)})

    monkeypatch.setattr(module, "constants", wrong)


def smallest(monkeypatch):
    """The smallest rate at the start is wrong by a factor."""
    module = import_module("geomtorsion.scenes.solve")
    right = module.free_top

    def wrong(moments, omega, quaternion):
        least = min(range(3), key=lambda k: abs(float(omega[k])) or 1.0)
        changed = [float(x) * (WRONG if k == least else 1.0) for k, x in enumerate(omega)]
        return right(moments, changed, quaternion)

    monkeypatch.setattr(module, "free_top", wrong)


@pytest.mark.parametrize("t", [80.0, 1e4])
@pytest.mark.parametrize("omega", [(0.3, 1, 0.2), (1e-3, 1, 0), (1e-12, 1, 0), (0.2, 0.1, 1)])
@pytest.mark.parametrize(
    "mistake",
    [clock, scale, partial(constant, "slope"), partial(constant, "offset"), smallest],
    ids=["clock", "scale", "precession", "offset", "smallest rate"],
)
def test_small_mistakes_of_a_closed_form_are_seen(mistake, omega, t, monkeypatch):
    """An error of 1e-10 in a formula is seen, near the unstable axis and far from it."""
    start = gt.State(omega=omega, quaternion=(0.8, 0, 0.6, 0))
    body, watch = gt.Body(moments=(1, 2, 3)), ["omega", "quaternion"]
    scene = gt.Scene(body, (), start, watch, t=t, accuracy=1e-3)
    assert scene.run().closed_form
    mistake(monkeypatch)
    with pytest.raises(gt.errors.AccuracyError, match="expected the equations to hold to"):
        checked_states(ClosedForm(scene.with_values(accuracy=1e-3)), scene.times)


def test_the_reason_names_the_defect_of_a_refused_closed_form(monkeypatch):
    """The reason for the engine names the defect, and the motion is right all the same."""
    scene = gt.scenes.load("dzhanibekov")
    right = scene.run()
    clock(monkeypatch)
    other = scene.with_values(accuracy=1e-9).run()
    assert other.closed_form is None
    assert "closed form: expected the equations to hold to" in other.reason
    assert np.abs(other["omega"] - right["omega"]).max() < 1e-9


def test_an_error_of_the_engine_names_the_refusal_of_the_closed_form():
    """Where neither closed form nor engine reach a time, the error gives both reasons."""
    scene = gt.scenes.load("dzhanibekov").with_values(t=1e17)
    with pytest.raises(gt.errors.StuckError, match="The closed form was refused: expected times"):
        scene.run()


@pytest.mark.parametrize("push", [1e-3, 1e-8, 1e-12])
@pytest.mark.parametrize("t", [1.0, 1e2, 1e4, 1e6])
def test_reported_errors_next_to_the_unstable_axis(push, t):
    """Rates at late times agree with elliptic functions of 50 digits to the reported error."""
    # Equal rates about the outer axes are on the separatrix of these moments.
    moments, omega = (
        (Fraction(1), Fraction(5, 2), Fraction(3)),
        (1, Fraction(0), 1 + Fraction(push)),
    )
    scene = gt.Scene(gt.Body(moments=moments), (), gt.State(omega=omega), ["omega"], t=[t])
    result = scene.run()
    truth = np.array([float(x) for x in exact_rates(t, moments, omega)])
    assert result.closed_form
    assert result.error < 1e-11
    assert np.abs(result["omega"][-1] - truth).max() <= result.error * np.abs(truth).max()


@pytest.mark.parametrize("omega", [(0, 1, 1e-3), (0, 0, 0), (0, 0, 1)])
@pytest.mark.parametrize("t", [0.0, 1e-300, -50.0])
def test_trivial_times_and_rates(omega, t):
    """The start itself, next to no time, time backwards; rest and constant rates."""
    start = gt.State(omega=omega, quaternion=(1, 0, 0, 0))
    scene = gt.Scene(gt.Body(moments=(1, 2, 3)), (), start, ["omega", "quaternion"], t=[t])
    result, stepped = scene.run(), scene.run(engine=gt.RungeKutta())
    assert result.closed_form
    assert result.error < ROUNDED
    for name in ("omega", "quaternion"):
        assert np.abs(result[name] - stepped[name]).max() < 1e-9


def test_solution_of_a_closed_form():
    """States one by one come from an integration that is made on request."""
    scene = gt.Scene(gt.Body(moments=(1, 2, 3)), (), gt.State(omega=(0.1, 1, 0.1)), ["omega"], t=9)
    result = scene.run()
    assert result.solved is None
    assert np.abs(result.solution["Omega2"] - result["omega"][:, 1]).max() < 1e-10


def test_free_bodies_without_more_digits(monkeypatch):
    """Near an unstable axis Runge-Kutta checks the closed form as far as it can."""
    module = import_module("geomtorsion.ode.solve")  # the function of this name hides it
    monkeypatch.setattr(module, "is_available", lambda: False)
    scene = gt.scenes.load("dzhanibekov").with_values(accuracy=1e-11)
    result = scene.run()
    assert result.closed_form
    assert result.error <= 1e-11
    monkeypatch.undo()
    assert np.abs(result["omega"] - scene.run()["omega"]).max() < 1e-13


@pytest.mark.parametrize(
    ("moments", "omega"),
    [
        ((1, 2, 2.5), (1e-300, 2e-300, 0)),
        ((1e300,) * 3, (1e10, 2, 3)),
        ((1, 2, 2.5), (1e200, 1, 0)),
    ],
)
def test_values_with_overflowing_squares_are_refused(moments, omega):
    """Values whose squares are not doubles are refused with a remedy."""
    scene = gt.Scene(gt.Body(moments=moments), [], gt.State(omega=omega), ["omega"], t=10)
    with pytest.raises(gt.errors.StartError, match="Use other units"):
        scene.run()


def test_a_closed_form_without_values_is_not_believed(monkeypatch):
    """Not a number is not a small difference."""
    scene = gt.Scene(gt.Body(moments=(1, 2, 2.5)), [], gt.State(omega=(1, 2, 3)), ["omega"], t=3)
    right = scene.run()
    states = ClosedForm.states
    monkeypatch.setattr(ClosedForm, "states", lambda form, t: states(form, t) * np.nan)
    found = scene.run()
    assert found.closed_form is None
    assert np.abs(found["omega"] - right["omega"]).max() < 1e-9


def test_how_many_turns_of_a_closed_form_are_checked(monkeypatch):
    """One time in each of 32 turns is checked: an error at turn 25 of 40 is found."""
    t = 40 * 2 * np.pi / np.sqrt(14)
    scene = gt.Scene(gt.Body(moments=(1, 2, 2.5)), [], gt.State(omega=(1, 2, 3)), ["omega"], t=t)
    states, asked = ClosedForm.states, []

    def wrong_at_last(form, times):
        asked.append(times)
        found = np.array(states(form, times))
        found[np.asarray(times) > 25 / 40 * t] += 1e-3
        return found

    monkeypatch.setattr(ClosedForm, "states", wrong_at_last)
    assert scene.run().closed_form is None
    checked = next(times for times in asked if len(times) < 65)
    assert checked[[1, -1]] == pytest.approx([t / 40, 32 / 40 * t])
    assert len(checked) == 33


def test_estimates_of_closed_forms_are_close():
    """The check of a closed form is accurate to 1e-9, even for a low requested accuracy."""
    result = gt.scenes.load("dzhanibekov").with_values(accuracy=1e-3).run()
    assert result.closed_form
    assert result.error < 3e-9


@pytest.mark.parametrize(
    ("engine", "moments"), one_in(2, [None, *ENGINES], [(1, 1, 1.3), (2, 2, 1), (1, 1, 1.5)])
)
def test_a_long_free_symmetric_top(engine, moments):
    """Up to t = 1000 it agrees with the product of two rotations with 40 digits.

    The chosen engine reaches 1e-12. An engine in doubles cannot distinguish its rounding from an
    error of some 1e-11 and refuses that, so these runs request 1e-10.
    """
    omega = (0.3, 0.1, 1.0)
    scene = gt.Scene(
        gt.Body(moments=moments),
        start=gt.State(omega=omega, quaternion=(1, 0, 0, 0)),
        t=1000, watch=("quaternion",), accuracy=1e-12 if engine is None else 1e-10,
    )  # fmt: skip
    result = scene.run(engine=engine)
    with mpmath.workdps(40):
        a, _, c = (mpmath.mpf(repr(x)) for x in moments)
        w = [mpmath.mpf(repr(x)) for x in omega]
        axis = [w[0], w[1], c * w[2] / a]
        rate = mpmath.sqrt(sum(x * x for x in axis))
        worst = 0.0
        for t, q in zip(result.times.tolist(), result["quaternion"], strict=True):
            cos, sin = mpmath.cos(rate * t / 2), mpmath.sin(rate * t / 2) / rate
            first = [cos, *(sin * x for x in axis)]
            spin = (1 - c / a) * w[2] * mpmath.mpf(t) / 2
            cos, sin = mpmath.cos(spin), mpmath.sin(spin)
            wanted = [
                first[0] * cos - first[3] * sin, first[1] * cos + first[2] * sin,
                first[2] * cos - first[1] * sin, first[3] * cos + first[0] * sin,
            ]  # fmt: skip
            signs = (max(abs(x - s * y) for x, y in zip(q, wanted, strict=True)) for s in (1, -1))
            worst = max(worst, float(min(signs)))
    assert result.error <= scene.accuracy
    assert worst <= scene.accuracy
    assert worst <= 2 * result.error


@pytest.mark.parametrize("accuracy", [1e-20, 1.1e-16])
@pytest.mark.parametrize("acting", [(), (E.AngularDamping(0.1),)], ids=["free", "damped"])
def test_an_accuracy_beyond_doubles_is_refused(acting, accuracy):
    """Watched quantities are doubles; solving the equations themselves gives more digits."""
    start = gt.State(omega=(0.3, 1, 0.2), euler=(0.3, 0.5, 2))
    scene = gt.Scene(gt.Body(moments=(1, 2, 3)), acting, start, ["omega"], t=1, accuracy=accuracy)
    with pytest.raises(gt.errors.AccuracyError, match=r"expected 1.11e-16 or more, got 1.*solve"):
        scene.run()
    assert scene.with_values(accuracy=1.2e-16).run(engine=gt.Taylor(64)).error <= 1.2e-16
