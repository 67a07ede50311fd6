"""Forces on curves that depend on position, velocity, time and parameters, against closed forms."""

import pickle

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import (
    ArgumentError,
    CoordinateError,
    ExpressionError,
    GeomtorsionError,
    ShapeError,
    StartError,
)
from tests.ode.engines import every_engine

ACCURACY = 1e-10
TIMES = np.array([0.5, 2.0, 10.0])
PLANE = gt.Frame("x y", [[1, 0], [0, 1]], name="plane")
FLAT = gt.cartan(PLANE)


def plane(start=(1, 0), velocity=(0, 3), **options):
    """A curve in the plane."""
    return gt.autoparallel(FLAT, list(start), list(velocity), **options)


def driven(**options):
    """An oscillator of frequency w0 along x, driven with frequency w."""
    spring = {"force": ["cos(w*t)", 0], "potential": "w0**2*x**2/2"}
    return plane((1, 0), (0, 0.5), **spring, parameters={"w0": 2, "w": 3}, **options)


def resonance(times, own=2.0, w=3.0):
    """x of the driven oscillator from x = 1 at rest."""
    part = 1 / (own**2 - w**2)
    return (1 - part) * np.cos(own * times) + part * np.cos(w * times)


@every_engine
def test_a_charge_in_a_uniform_field_moves_on_a_circle(engine):
    """x'' = B y', y'' = -B x': radius v/B, frequency B."""
    problem = plane(force=["B*u2", "-B*u1"], parameters={"B": 2})
    solution = gt.solve(problem, TIMES, ACCURACY, engine)
    x, y = 1 + 1.5 * (1 - np.cos(2 * TIMES)), 1.5 * np.sin(2 * TIMES)
    assert np.abs(solution["x"] - x).max() < 4 * ACCURACY
    assert np.abs(solution["y"] - y).max() < 4 * ACCURACY


@every_engine
def test_linear_drag_is_an_exponential(engine):
    """y' = v exp(-k t)."""
    problem = plane(force=["-k*u1", "-k*u2"], parameters={"k": 0.3})
    solution = gt.solve(problem, TIMES, ACCURACY, engine)
    assert np.abs(solution["y"] - 10 * (1 - np.exp(-0.3 * TIMES))).max() < 10 * ACCURACY
    assert np.abs(solution["u2"] - 3 * np.exp(-0.3 * TIMES)).max() < 3 * ACCURACY


@every_engine
def test_a_driven_oscillator(engine):
    """Own and driving frequency beat; the curve parameter is exact at every time."""
    solution = gt.solve(driven(), TIMES, ACCURACY, engine)
    assert np.abs(solution["x"] - resonance(TIMES)).max() < 2 * ACCURACY


def test_drag_of_the_square_of_the_speed():
    """The speed in a root: y = log(1 + k v t)/k."""
    speed = "sqrt(u1**2 + u2**2)"
    force = [f"-k*u1*{speed}", f"-k*u2*{speed}"]
    solution = gt.solve(plane(force=force, parameters={"k": 0.2}), TIMES, ACCURACY)
    assert np.abs(solution["y"] - np.log(1 + 0.6 * TIMES) / 0.2).max() < 10 * ACCURACY


def test_time_runs_backwards():
    """x'' = cos t from rest gives x = 2 - cos t also before the start."""
    solution = gt.solve(plane(velocity=(0, 0), force=["cos(t)", 0]), [-2.0], ACCURACY)
    assert abs(solution["x"][0] - (2 - np.cos(2.0))) < ACCURACY


def test_a_zero_force_changes_nothing():
    """The trivial case: the straight line."""
    solution = gt.solve(plane(force=[0, "0*u1"]), [2.0])
    assert solution.coordinates.tolist() == [[1.0, 6.0]]


def test_a_proof_holds_the_closed_form():
    """Circle, driven oscillator and a stop: the proved balls contain the truth."""
    for problem, truth in (
        (plane(force=["B*u2", "-B*u1"], parameters={"B": 2}), 1 + 1.5 * (1 - np.cos(20.0))),
        (driven(), resonance(np.float64(10.0))),
    ):
        proof = gt.prove(gt.solve(problem, 10.0))
        # The closed form in doubles is wrong by some roundings of its terms.
        assert abs(proof.values[-1, 0] - truth) < 100 * np.finfo(float).eps
        assert proof.holds
    stopped = plane(force=["-u1 + cos(t)", "-u2"], stop="u2 - 1")
    proof = gt.prove(gt.solve(stopped, 5.0))
    assert proof.holds


def test_derivatives_by_parameters_of_the_force():
    """d/dw and d/dw0 against differences of the closed form, in the same digits."""
    solution = gt.solve(driven().with_derivatives(["w", "w0", "x"]), TIMES, ACCURACY)
    step = 1e-5
    by_w = (resonance(TIMES, w=3 + step) - resonance(TIMES, w=3 - step)) / (2 * step)
    by_own = (resonance(TIMES, 2 + step) - resonance(TIMES, 2 - step)) / (2 * step)
    # A central difference is wrong by step^2 / 6 of the third derivative, up to t^3.
    assert np.abs(solution["dx_dw"] - by_w).max() < step**2 * 1e3
    assert np.abs(solution["dx_dw0"] - by_own).max() < step**2 * 1e3
    assert np.abs(solution["dx_dx"] - np.cos(2 * TIMES)).max() < 10 * ACCURACY


@pytest.mark.parametrize("engine", [None, gt.RungeKutta()])
def test_an_ensemble_is_its_members(engine):
    """With a force the path depends on the speed, so that time is not measured in it."""
    problem = plane(
        force={"drag": ["-k*u1", "-k*u2"], "motor": ["cos(w*t)", 0]},
        potential="x**4/4", parameters={"k": 0.3, "w": 2},
    )  # fmt: skip
    rng = np.random.default_rng(1)
    starts, speeds = rng.normal(size=(40, 2)), 4 * rng.normal(size=(40, 2))
    many = gt.solve_many(problem, starts, [1.0, 3.0], 1e-9, engine, velocities=speeds)
    for k in (0, 7, 39):
        single = gt.solve(problem.with_start(starts[k], velocity=speeds[k]), [1.0, 3.0])
        assert np.abs(many.coordinates[k] - single.coordinates).max() < 1e-7


def test_friction_on_a_top():
    """With equal moments I the rates of a top decay as exp(-k t/I) about a fixed axis."""
    top = gt.geodesic(
        "so3", frame_velocity=[1, 2, 3], metric=[2, 2, 2],
        force=["-k*u1", "-k*u2", "-k*u3"], parameters={"k": 0.5},
    )  # fmt: skip
    rates = gt.solve(top, TIMES, ACCURACY).frame_velocity
    assert np.abs(rates - np.exp(-0.25 * TIMES)[:, None] * [1, 2, 3]).max() < 4 * ACCURACY


def test_a_kinetic_metric_raises_the_force():
    """Moments divide the torque: u3' = F_3/I_3 about an axis of symmetry."""
    top = gt.geodesic("so3", frame_velocity=[0, 0, 0], metric=[1, 1, 4], force=[0, 0, "2*t"])
    assert abs(gt.solve(top, [3.0], ACCURACY)["u3"][0] - 9 / 4) < 3 * ACCURACY


def test_energy_is_an_invariant_where_it_is_one():
    """Not with drag or with a potential of time; with a magnetic field, which does no work."""
    line = gt.levi_civita(PLANE)
    cases = [
        ({"force": ["B*u2", "-B*u1"], "potential": "x**2"}, True),
        ({"force": ["B*t*u2", "-B*t*u1"]}, True),
        ({"force": ["-B*u1", "-B*u2"]}, False),
        ({"force": ["B*u2", "B*u1"]}, False),
        ({"potential": "B*x*sin(t)"}, False),
    ]
    for forces, conserved in cases:
        given = {"B": 2} if "B" in str(forces) else None
        solution = gt.solve(gt.autoparallel(line, [1, 0], [0, 3], parameters=given, **forces), 5.0)
        assert ("energy" in solution.drift) == conserved
        assert all(drift < 100 * solution.error for drift in solution.drift.values())


def test_a_monopole_on_the_sphere_conserves_angular_momentum():
    """sin^2(theta) phi' - B cos(theta) is constant, because the field adds -B sin(theta) theta'."""
    sphere = gt.spaces.load("s2").frame
    curve = gt.geodesic(
        sphere, [1.2, 0], [0.3, 1], force=["B*u2", "-B*u1"], parameters={"R": 1, "B": 2}
    )
    solution = gt.solve(curve, np.linspace(0, 6, 13))
    theta, rate = solution["theta"], solution.velocity[:, 1]
    moment = np.sin(theta) ** 2 * rate - 2 * np.cos(theta)
    assert np.abs(moment - moment[0]).max() < 100 * solution.error


def test_the_curve_parameter_is_tau_where_t_is_a_coordinate():
    """In space-time t is a coordinate; an acceleration cos(tau) along x from rest."""
    flat = gt.Frame("t x", [[1, 0], [0, 1]], signature=(-1, 1), name="flat")
    curve = gt.geodesic(flat, [0, 0], [1, 0], force=[0, "cos(tau)"])
    solution = gt.solve(curve, [2.0], ACCURACY)
    assert abs(solution["x"][0] - (1 - np.cos(2.0))) < 2 * ACCURACY
    assert gt.geodesic(flat, [0, 0], [1, 0], force=[0, "cos(t)"]).equations().clock == ""


def test_velocities_have_another_name_where_u1_is_a_coordinate():
    """The equations and the forces have the same names: w1, w2."""
    frame = gt.Frame("u1 u2", [[1, 0], [0, 1]])
    curve = gt.geodesic(frame, [1, 0], [0, 3], force=["-w1", "-w2"])
    assert abs(gt.solve(curve, [2.0])["u2"][0] - 3 * (1 - np.exp(-2.0))) < 1e-9


def test_under_constraints_only_the_permitted_part_acts():
    """A skate with drag slows down along its blade; the sideways force is taken up."""
    frame = gt.Frame("x y theta", sp.eye(3).tolist())
    skate = gt.constrained(frame, ["cos(theta)*dy - sin(theta)*dx"])
    curve = gt.autoparallel(skate, [0, 0, 0], frame_velocity=[2, 0, 0], force=["-u1", 0, "5*u1"])
    assert abs(gt.solve(curve, [3.0])["x"][0] - 2 * (1 - np.exp(-3.0))) < 1e-9


def test_a_name_of_a_potential_with_a_value_is_a_parameter():
    """As text and as a symbol; it varies, and its declaration holds."""
    text = plane(potential="k*x**2/2", parameters={"k": 4})
    k, x = sp.Symbol("k", positive=True), sp.Symbol("x")
    symbol = plane(potential=k * x**2 / 2, parameters={k: 4})
    for problem in (text, symbol):
        assert abs(gt.solve(problem, [1.0])["x"][0] - np.cos(2.0)) < 1e-9
        faster = problem.with_values({"k": 9})
        assert abs(gt.solve(faster, [1.0])["x"][0] - np.cos(3.0)) < 1e-9
    with pytest.raises(CoordinateError, match="positive"):
        plane(potential=k * x**2 / 2, parameters={k: -4})


def test_forces_leave_the_frame_as_it_was():
    """The frame gets no new parameters, and the next curve has the same velocities."""
    frame = gt.Frame("x y", [[1, 0], [0, 1]])
    gt.geodesic(frame, [0, 0], [1, 0], force=["-k*u1*t", 0], parameters={"k": 1})
    assert gt.geodesic(frame, [0, 0], frame_velocity={"u1": 1, "u2": 0}).text.startswith("x' =")
    assert [symbol.name for symbol in frame.field.symbols] == ["x", "y"]


def test_equal_forces_are_equal_and_copies_are():
    """By content, also in another process."""
    one, two = driven(), driven()
    assert one == two
    assert hash(one) == hash(two)
    assert pickle.loads(pickle.dumps(one)) == one
    assert plane(force=["-u1", 0]) != plane(force=["-u2", 0])
    assert plane(force=["-u1", 0]).without("force") != plane(force=["-u1", 0])


def test_effects_of_forces():
    """Each force is an effect; a drag of a millionth is not called for."""
    problem = plane(
        force={"drag": ["-k*u1", "-k*u2"], "field": ["B*u2", "-B*u1"]},
        parameters={"k": 1e-6, "B": 2},
    )
    budget = gt.called_for(problem, 1e-3, 5.0)
    assert budget.effects == ("field",)
    assert 1e-7 < budget["drag"].influence < 1e-4


def test_equations_are_written_in_the_time_of_users():
    """The text of a driven motion has t, without units of a clock."""
    assert driven().text.splitlines()[2] == "u1' = (-w0**2*x + cos(t*w))"


REFUSALS = [
    ({"force": ["u9", 0]}, ExpressionError, "velocities u1, u2 along the legs"),
    ({"force": ["vx", 0]}, ExpressionError, "the curve parameter t"),
    ({"force": ["-k*u1", 0]}, ExpressionError, "parameters={'name': 1}"),
    ({"force": [-sp.Symbol("k") * sp.Symbol("u1"), 0]}, StartError, "value for k"),
    ({"force": ["-u1"]}, ShapeError, "2 legs"),
    ({"force": "u1"}, ShapeError, "list"),
    ({"force": ["-sqrt(u1**2 + 2*u1 + 1)", 0]}, ExpressionError, "not smooth where u1"),
    ({"potential": "u1**2"}, ExpressionError, "curve parameter t"),
    ({"potential": sp.Symbol("u1") ** 2}, ExpressionError, "depends on the velocity"),
    ({"force": ["-u1", 0], "parameters": {"k": 2}}, StartError, "k"),
    ({"force": ["-u1", 0], "parameters": {"u1": 2}}, ArgumentError, "Rename it"),
    ({"force": {"a": [0, 0]}, "potential": {"a": "x"}}, ArgumentError, "'a' twice"),
]


@pytest.mark.parametrize(("options", "error", "words"), REFUSALS)
def test_refusals(options, error, words):
    """Each names what may be written."""
    with pytest.raises(error, match=None) as caught:
        plane(**options)
    assert isinstance(caught.value, GeomtorsionError)
    assert words in str(caught.value)


def towards_a_wall(plane, **options):
    """A curve in a plane from x = 1 with x' = 1 to x = 5, where the sign of x - 5 changes."""
    return gt.autoparallel(gt.levi_civita(plane), [1, 0], [1, 0], **options)


@pytest.mark.parametrize("first", [{}, {"force": ["sqrt((x - 4)**2)", 0]}], ids=["free", "forced"])
@pytest.mark.parametrize(
    "options",
    [
        {"potential": "sqrt((x - 5)**2)"},
        {"force": ["sqrt((x - 5)**2)", 0]},
        {"force": ["k*sqrt((x - 5)**2)", 0], "parameters": {"k": 1}},
    ],
    ids=["potential", "force", "parameter"],
)
def test_the_sign_of_a_root_ends_its_own_motion(first, options):
    """A force holds up to the zero of its root, whatever moved on the frame before."""
    flat = gt.Frame("x y", [[1, 0], [0, 1]])
    gt.solve(towards_a_wall(flat, **first), 0.1)
    with pytest.raises(gt.errors.ChartEdgeError, match=r"x = 5, .*5 - x >= 0"):
        gt.solve(towards_a_wall(flat, **options), 40)
    assert gt.solve(towards_a_wall(flat), 10)["x"][-1] == pytest.approx(11, abs=ACCURACY)
    assert flat == gt.Frame("x y", [[1, 0], [0, 1]])


def test_the_two_sides_of_a_root_are_two_laws():
    """|x - 5| left of x = 5, read as 5 - x, and the polynomial 5 - x, which holds everywhere."""
    flat = gt.Frame("x y", [[1, 0], [0, 1]])
    root = towards_a_wall(flat, potential="sqrt((x - 5)**2)")
    plain = towards_a_wall(flat, potential="5 - x")
    assert root != plain
    # The closed form: 1 + t + t*t/2 = 13.
    assert gt.solve(plain, 4)["x"][-1] == pytest.approx(13, abs=4 * ACCURACY)
    with pytest.raises(gt.errors.ChartEdgeError):
        gt.solve(pickle.loads(pickle.dumps(root)), 4)
