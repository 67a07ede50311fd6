"""Called for: effects of motions and theories, and the smallest set of them for an accuracy."""

# The tests pass bad input.
# pyright: reportArgumentType=false, reportOptionalMemberAccess=false
# pyright: reportAttributeAccessIssue=false

import json
import math
import pickle
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import (
    AccuracyError,
    ArgumentError,
    GravityError,
    StartError,
    UnknownNameError,
)
from geomtorsion.ode import RungeKutta

HALF_PI = math.pi / 2
RK = RungeKutta()
# Runge-Kutta compiles nothing, so that many small problems are quick.
PLANE = gt.from_torsion(
    gt.Frame("x y", [["1", "0"], ["0", "1"]]), np.zeros((2, 2, 2), int).tolist()
)


def change(one, two, names):
    """Largest change of a watched quantity, relative to its largest size."""
    return max(np.abs(two[name] - one[name]).max() / np.abs(one[name]).max() for name in names)


def pushed(**forces):
    """A body on a plane that starts along x, under forces."""
    return gt.autoparallel(PLANE, [1, 0], [1, 0.5], force=forces)


def orbit(spin):
    """A body with spin around a black hole."""
    start, velocity = [0, 10, HALF_PI, 0], [1.2, 0, 0, 0.04]
    return gt.spinning(
        "schwarzschild",
        start,
        velocity,
        [0, 0, -spin, 0],
        coupling="orbital",
        parameters={"M": 1},
    )


def cosmos(lagrangian, *matter, connection=gt.levi_civita):
    """Field equations of a flat universe."""
    a = sp.Function("a")(sp.Symbol("t"))
    coframe = sp.diag(1, a, a, a)
    frame = gt.Frame([*sp.symbols("t x y z")], coframe, (-1, 1, 1, 1))
    return gt.gravity.equations(connection(frame), lagrangian, list(matter))


DUST = gt.gravity.fluid("rho(t)", 0, [1, 0, 0, 0])
RADIATION = gt.gravity.fluid("sigma(t)", "p(t)", [1, 0, 0, 0])


@cache
def universe(alpha=1e-5, times=1.0):
    """Dust, a little radiation and a cosmological constant, with a weak square of the curvature."""
    theory = cosmos("R/2 - Lambda + alpha*R**2", DUST, RADIATION)
    start = {"a": 1, "rho": 2, "sigma": 1e-5, "a_1": 1, "a_2": 0}
    parameters = {"Lambda": 1, "alpha": alpha}
    return gt.gravity.solve(
        theory, "t", times, start, parameters, conditions="p = sigma/3", engine=RK, accuracy=1e-9
    )


# -- curves ---------------------------------------------------------------------------------------


def test_an_influence_has_a_closed_form():
    """A constant force F moves a body by F t^2/2, against a way x of 1 + t."""
    budget = gt.called_for(pushed(weak=[sp.Rational(1, 10**6), 0]), 1e-3, 2, engine=RK)
    row = budget["weak"]
    # x = 1 + t + F t^2/2 at t = 2; nothing moves it along y.
    assert row.changes["x"] == pytest.approx(2e-6 / 3, rel=1e-5)
    assert row.changes["y"] < 1e-12
    assert budget.effects == ()
    assert budget.chosen.law == gt.geodesic(PLANE, [1, 0], [1, 0.5]).law


@pytest.mark.parametrize(
    ("size", "chosen"), [(sp.Rational(1, 10), 2), (sp.Rational(1, 1000), 1), (0, 0)]
)
def test_forces_that_cancel_each_other_stay(size, chosen):
    """Two opposite forces change nothing together; they are not omitted for that."""
    budget = gt.called_for(pushed(push=[size, 0], pull=[-size, 0]), 1e-3, 2, engine=RK)
    assert len(budget.effects) == chosen
    together = gt.solve(pushed(push=[size, 0], pull=[-size, 0]), 2.0)
    assert change(together, gt.solve(gt.geodesic(PLANE, [1, 0], [1, 0.5]), 2.0), ["x"]) < 1e-12


def test_torsion_is_an_effect():
    """A twisted frame of flat space: without its torsion its autoparallel is a straight line."""
    x, y, z = sp.symbols("x y z")
    twist = sp.Matrix([[1, 0, 0], [0, sp.cos(z), sp.sin(z)], [0, -sp.sin(z), sp.cos(z)]])
    frame = gt.Frame([x, y, z], twist)
    curve = gt.autoparallel(gt.cartan(frame), [0, 0, 1], [0, 1, sp.Rational(1, 10**4)])
    budget = gt.called_for(curve, 1e-3, [0, 1, 2], engine=RK)
    # The torsion turns the path by v_z t: y = t to second order, z = 1 + v_z t^... in both.
    assert budget["torsion"].influence == pytest.approx(
        change(gt.solve(curve, [0, 1, 2.0]), gt.solve(curve.without("torsion"), [0, 1, 2.0]), "yz"),
        rel=1e-6,
    )
    straight = gt.solve(curve.without("torsion"), [0, 1, 2.0])
    assert straight["y"] == pytest.approx([0, 1, 2])
    assert straight["z"] == pytest.approx([1, 1.0001, 1.0002])


def test_nonmetricity_is_an_effect():
    """Each of torsion and nonmetricity can be omitted by itself."""
    frame = gt.Frame("x y", [["1", "0"], ["0", "1"]])
    gamma = [[["x/9", "0"], ["1/5", "0"]], [["0", "0"], ["0", "0"]]]
    connection = gt.from_coefficients(
        frame, [[[sp.sympify(e) for e in r] for r in m] for m in gamma]
    )
    curve = gt.autoparallel(connection, [1, 0], [1, 1])
    assert list(curve.effects) == ["torsion", "nonmetricity"]
    metric = curve.without("nonmetricity").law.connection
    assert metric.metric_compatible
    assert metric.torsion.S == connection.torsion.S
    symmetric = curve.without("torsion").law.connection
    assert symmetric.is_torsion_free
    assert symmetric.nonmetricity == connection.nonmetricity
    assert curve.without("torsion", "nonmetricity").effects == {}


def test_a_force_stays_where_another_is_omitted():
    """What remains has the energy of its own potential."""
    curve = gt.autoparallel(
        PLANE, [1, 0], [0, 1], potential={"well": "x**2/2 + y**2/2", "wall": "x"}, force=["0", "1"]
    )
    assert list(curve.effects) == ["force", "well", "wall"]
    assert list(gt.solve(curve, 1.0).drift) == []
    alone = gt.solve(curve.without("force", "wall"), HALF_PI, engine=RK)
    assert alone["x"][-1] == pytest.approx(0, abs=1e-9)
    assert alone.drift["energy"] < 1e-9


# -- bodies with spin -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("accuracy", "effects", "equations"), [(1e-3, "", 8), (1e-6, "spin_force", 14)]
)
def test_a_small_spin_matters_only_for_a_high_accuracy(accuracy, effects, equations):
    """A body with a small spin moves as one without it, to three digits."""
    budget = gt.called_for(orbit(0.01), accuracy, 20.0)
    assert budget.effects == tuple(effects.split())
    assert budget.equations == equations
    whole = gt.solve(orbit(0.01), 20.0, accuracy / 100)
    assert change(whole, budget.result, budget.watch) <= budget.error <= accuracy
    assert not budget.growth.chaotic


def test_the_force_is_linear_in_the_spin():
    """The influence of the force is proportional to the spin, of hidden momentum to its square."""
    small, large = (gt.called_for(orbit(spin), 1e-8, 20.0) for spin in (0.01, 0.02))
    ratio = large["spin_force"].influence / small["spin_force"].influence
    assert ratio == pytest.approx(2, rel=1e-2)
    ratio = large["hidden_momentum"].influence / small["hidden_momentum"].influence
    assert ratio == pytest.approx(4, rel=1e-2)


def test_without_all_its_effects_a_spin_follows_a_geodesic():
    """The coordinates agree with a geodesic, and the spin keeps its length."""
    bare = orbit(0.1).without("spin_force", "hidden_momentum")
    solution = gt.solve(bare, 20.0)
    speed = gt.solve(orbit(0.0), [0, 1e-3])["velocity"][0]
    line = gt.geodesic("schwarzschild", [0, 10, HALF_PI, 0], speed, parameters={"M": 1})
    assert solution["phi"] == pytest.approx(gt.solve(line, 20.0)["phi"], rel=1e-8)
    assert solution.drift["spin"] < 1e-9
    # phi does not depend on t.
    assert bare.restricted(["phi"]).size == 7


def test_torsion_acts_on_the_intrinsic_spin_only():
    """Torsion is an effect of an intrinsic spin; without it the equations are the orbital ones."""
    start, velocity, spin = [0.3, 1.0, 0.2], [0.2, 0.1, 0.3], [[0, 1, 0], [-1, 0, 0], [0, 0, 0]]
    body = gt.spinning("so3", start, velocity, spin)
    assert list(body.effects) == ["spin_force", "hidden_momentum", "torsion"]
    other = gt.spinning("so3", start, velocity, spin, coupling="orbital")
    assert body.without("torsion").rates == other.rates
    # A changed number is changed in the part as well.
    moved = body.with_start({"p1": 2})
    assert float(moved.without("torsion").start[3]) == 2


# -- theories -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("accuracy", "omitted"),
    [
        (1e-3, ("R**2*alpha", "fluid sigma(t)")),
        (2e-6, ("fluid sigma(t)",)),
        (1e-7, ()),
    ],
)
def test_terms_of_a_lagrangian_are_effects(accuracy, omitted):
    """The true error of the theory without some terms is within the accuracy."""
    solution = universe()
    budget = gt.called_for(solution, accuracy, engine=RK)
    assert budget.watch == ("a",)
    assert budget.omitted == omitted
    assert change(solution, budget.result, "a") <= budget.error <= accuracy
    assert math.isclose(budget["fluid sigma(t)"].influence, 4.5e-7, rel_tol=0.1)


def test_the_chosen_theory_has_a_closed_form():
    """Without R**2 and radiation this universe is a power of a hyperbolic sine."""
    chosen = gt.called_for(universe(), 1e-3, engine=RK).chosen
    assert chosen.states == ("rho", "a", "a_1")
    solution = gt.solve(chosen, 1.0, 1e-11)
    # a^3 = (rho_0/Lambda) sinh(phi)^2, with phi' = sqrt(3 Lambda)/2 and sinh(phi(0))^2 = 1/2
    phase = math.asinh(math.sqrt(1 / 2)) + math.sqrt(3) / 2
    assert solution["a"][-1] == pytest.approx((2 * math.sinh(phase) ** 2) ** (1 / 3), rel=1e-10)
    assert solution.drift["constraint"] < 1e-10


def test_a_theory_with_fewer_unknowns_begins_with_the_first_numbers():
    """Without dust the constraint determines the last number of the start, near its value."""
    theory = cosmos("R/2 - Lambda", DUST)
    ode = gt.gravity.solve(theory, "t", 1, {"a": 1, "rho": 2, "a_1": 1}, {"Lambda": 1}).problem
    empty = ode.without("fluid rho(t)")
    assert empty.states == ("a", "a_1")
    assert float(empty.start[1]) == pytest.approx(math.sqrt(1 / 3))
    first = {"a_1": 1, "a": 1, "rho": 2}
    ode = gt.gravity.solve(theory, "t", 1, first, {"Lambda": 1}).problem
    without = ode.without("-Lambda")
    table = dict(zip(without.states, map(float, without.start), strict=True))
    assert table == pytest.approx({"a": 1, "rho": 3, "a_1": 1})


def test_what_a_theory_needs_gives_its_reason():
    """A density exists only with its fluid; a Lagrangian needs a term of gravity."""
    solution = gt.gravity.solve(cosmos("R/2", DUST), "t", 1, {"a": 1, "rho": 3}, near={"a_1": 1})
    budget = gt.called_for(solution, 0.5, watch="rho", engine=RK)
    assert budget.effects == ("R/2", "fluid rho(t)")
    assert budget["fluid rho(t)"].note == "without it there is no rho"
    assert budget["R/2"].note.startswith("without it: ")
    assert math.isinf(budget["R/2"].influence)


def test_a_field_without_terms_leaves_the_theory():
    """Omitting both terms of a scalar field omits the field."""
    theory = cosmos(
        "-T/2 - X/2 - phi**2/100", gt.gravity.scalar_field("phi(t)"), connection=gt.cartan
    )
    start = {"phi": 1, "phi_1": 0, "a": 1}
    ode = gt.gravity.solve(theory, "t", 0.1, start, near={"a_1": 0.1}).problem
    assert list(ode.effects) == ["-T/2", "-X/2", "-phi**2/100"]
    assert ode.without("-X/2", "-phi**2/100").states == ("a",)


# -- all of them ----------------------------------------------------------------------------------


def test_a_scene_is_chosen_by_the_same_function():
    """`scene.called_for` and `gt.called_for` give the same rows."""
    scene = gt.scenes.load("thrown_body")
    assert gt.called_for(scene, 1e-3).rows == scene.called_for(1e-3).rows
    assert gt.called_for(scene, 1e-3, watch=["omega"]).watch == ("omega",)


def test_a_quantity_that_is_small_beside_its_neighbours_has_its_own_size():
    """All of z = -5e-9 comes from the tilt; the well, which moves x and y, does not matter to z."""
    plane = gt.Frame("x y z", np.eye(3).astype(int).tolist())
    forces = {"well": "(x**2 + y**2)/2", "tilt": "z/10000000000"}
    curve = gt.autoparallel(gt.cartan(plane), [1, 0, 0], [0, 1, 0], potential=forces)
    budget = gt.called_for(curve, 1e-3, 10.0, watch="z")
    assert budget.effects == ("tilt",)
    # Known: z = -t^2 / 2 of 1e-10.
    assert abs(budget.result["z"][-1] / -5e-9 - 1) <= budget.error
    assert gt.called_for(curve, 1e-3, 10.0).effects == ("well", "tilt")


def test_what_rounding_hides_is_reported():
    """On the equator u1 is the rounding of pi/2: it counts as zero, and the result reports it."""
    sphere = gt.levi_civita(gt.spaces.load("s2").frame.subs({"R": 1}))
    curve = gt.autoparallel(sphere, [HALF_PI, 0], [0, 1], force={"drag": [0, "-u2/10"]})
    budget = gt.called_for(curve, 1e-3, 3.0, watch=["phi", "u1"])
    assert budget.effects == ("drag",)
    assert budget.unresolved == ("u1",)
    assert "Not resolved: u1" in str(budget)
    assert budget.to_json()["unresolved"] == ["u1"]
    assert gt.called_for(curve, 1e-3, 3.0, watch="phi").unresolved == ()


def test_a_pulse_that_steps_pass_over_is_not_called_without_influence():
    """A torque of 2 ms in 40 s whose shape no step shows; the samples between steps do."""
    pulse = gt.effects.Custom(
        moment=("A*exp(log((1 + sin(pi*t/40)**2)/2)/w**2)", 0, 0),
        parameters={"A": 5000, "w": 0.0001},
    )
    body, start = gt.Body(mass=1, moments=(1, 2, 3)), gt.State(omega=(0, 0.1, 1))
    scene = gt.Scene(body, [pulse], start, watch=["omega"], t=40, accuracy=1e-6)
    budget = scene.called_for(1e-3)
    assert budget.effects == ("custom",)
    assert "not resolved: it acts near t = 20" in budget["custom"].note
    # The same torque over seconds is resolved, and so is a blow as short whose shape is simple.
    slow = replace(pulse, parameters={"A": 1, "w": 0.2})
    blow = gt.effects.Custom(moment=("5000*exp(-((t - 20)/0.0003)**2)", 0, 0))
    for effect in (slow, blow):
        row = replace(scene, effects=[effect]).called_for(1e-3)["custom"]
        assert row.note == ""
        assert 0.1 < row.influence < math.inf


def test_an_exactly_upright_top_needs_its_weight():
    """At the equilibrium nothing changes; beside it the top falls."""
    top = gt.scenes.load("lagrange_cusp")
    upright = gt.State(omega=(0, 0, 1), quaternion=(1, 0, 0, 0))
    budget = replace(top, start=upright, watch=("axis",)).called_for(1e-3)
    assert set(budget.effects) == {"gravity", "pivot"}
    assert "start moved by" in budget["gravity"].note


def test_showing():
    """The table, the figure, JSON; copies have the same effects; equal calls give equal rows."""
    curve = pushed(push=["1", "0"], weak=["0", "1/100000"])
    budget = gt.called_for(curve, 1e-3, 2, engine=RK)
    text = str(budget)
    assert "autoparallel" in text
    assert "accuracy 0.001 of x, y calls for 1 of 2 effects" in text
    assert "omitted  weak" in text
    assert "up to t = 2" in text
    assert "<svg" in budget._repr_html_()
    data = json.loads(json.dumps(budget.to_json(), allow_nan=False))
    assert data["omitted"] == ["weak"]
    shown = [one.get_text() for one in budget.plot().axes[0].texts]
    assert "weak (omitted)" in shown
    assert budget.rows == gt.called_for(pickle.loads(pickle.dumps(curve)), 1e-3, 2, engine=RK).rows
    assert "L = R/2" in str(gt.called_for(universe(), 1e-3, engine=RK)).replace(
        "-Lambda + R**2*alpha + ", ""
    )


def test_nothing_to_omit():
    """A geodesic and an ODE have no effects."""
    swing = gt.ODE.of({"x": "v", "v": "-x"}, [1, 0])
    for thing in (swing, gt.geodesic(PLANE, [1, 0], [1, 0.5])):
        budget = gt.called_for(thing, 1e-3, 2, engine=RK)
        assert budget.effects == budget.omitted == ()
        assert "calls for 0 of 0 effects" in str(budget)


def test_a_quantity_that_does_not_matter_is_exact():
    """An effect that no watched quantity depends on has no influence at all."""
    body = orbit(0.1).without("hidden_momentum")
    row = gt.called_for(body, 1e-3, 1.0, watch=["theta"])["spin_force"]
    assert row.influence < 1e-12


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: gt.called_for(3, 1e-3), ArgumentError, "expected a scene, a problem"),
        (lambda: gt.called_for(pushed(a=["1", "0"]), 0), AccuracyError, "expected"),
        (lambda: gt.called_for(pushed(a=["1", "0"]), "much"), AccuracyError, "expected"),
        (lambda: gt.called_for(pushed(a=["1", "0"]), watch=["z"]), UnknownNameError, "z"),
        (lambda: gt.called_for(pushed(a=["1", "0"]), watch=[]), ArgumentError, "expected a name"),
        (lambda: gt.called_for(pushed(a=["1", "0"]), watch=[3]), ArgumentError, "watch"),
        (lambda: gt.called_for(gt.scenes.load("helix"), at=3), ArgumentError, "at: expected"),
        (lambda: gt.called_for(orbit(0.1), 1e-3, 1, watch="x"), UnknownNameError, "x"),
        (lambda: pushed(a=["1", "0"]).without("b"), UnknownNameError, "effect"),
        (lambda: orbit(0.1).without("torsion"), UnknownNameError, "There are spin_force"),
        (lambda: orbit(0.1).restricted(["x"]), UnknownNameError, "names"),
        (lambda: gt.ODE.of({"x": "-x"}, [1]).without("x"), UnknownNameError, "none"),
        (lambda: pushed(torsion=["1", "0"], b=["1"]), gt.errors.ShapeError, "for each of 2"),
        (
            lambda: gt.autoparallel("so3", [0, 1, 0], [1, 0, 0], force={"torsion": [1, 0, 0]}),
            ArgumentError,
            "expected different names, got 'torsion'",
        ),
        (
            lambda: gt.autoparallel(PLANE, [0, 1], [1, 0], force={3: [1, 0]}),
            ArgumentError,
            "name of a force",
        ),
    ],
)
def test_refusals(call, error, words):
    with pytest.raises(error, match=words):
        call()


def test_refusals_of_a_theory():
    """Numbers that were changed afterwards are refused, as is a Lagrangian without terms."""
    ode = universe().problem
    with pytest.raises(StartError, match="got changed ones"):
        ode.with_start({"rho": 3}).without("-Lambda")
    with pytest.raises(GravityError):
        ode.without("-Lambda", "R/2", "R**2*alpha")
