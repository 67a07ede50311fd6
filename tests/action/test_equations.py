"""Equations of motion: Euler's equations, autoparallels and geodesics from one derivation."""

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion import spaces
from geomtorsion.errors import CoordinateError, LagrangianError
from geomtorsion.ode import ODE

U = sp.symbols("u1:7")
MOMENTS = sp.symbols("I1 I2 I3")
MASS = sp.Symbol("M")
SPIN = sp.Add(*(moment * u**2 for moment, u in zip(MOMENTS, U[:3], strict=True))) / 2
FLIGHT = SPIN + MASS * (U[3] ** 2 + U[4] ** 2 + U[5] ** 2) / 2


def equal(found, expected):
    """Whether two sequences of expressions are equal, term by term."""
    assert len(found) == len(expected)
    return all(
        sp.expand(one - two) == 0 for one, two in zip(found, map(sp.sympify, expected), strict=True)
    )


def test_euler_equations_on_so3():
    """Equation (1) of the paper without torques: I_i u'^i + (u x I u)^i = 0."""
    found = gt.equations_of_motion(spaces.load("so3").frame, SPIN)
    omega = sp.Matrix(U[:3])
    momentum = sp.Matrix([i * u for i, u in zip(MOMENTS, U[:3], strict=True)])
    gyroscopic = omega.cross(momentum)
    dots = sp.symbols("u1dot u2dot u3dot")
    expected = [i * d + g for i, d, g in zip(MOMENTS, dots, gyroscopic, strict=True)]
    assert equal(found.residuals, expected)
    assert equal(found.momenta, momentum)
    assert found.agrees is True


def test_euler_equations_with_torques():
    """Equation (1) with torques that depend on q, u, t and a parameter."""
    frame = spaces.load("so3").frame
    phi2, t, k = frame.coordinates[1], sp.Symbol("t"), sp.Symbol("k")
    forces = [sp.sin(phi2), -k * U[1], sp.cos(3 * t)]
    found = gt.equations_of_motion(frame, SPIN, forces)
    free = gt.equations_of_motion(frame, SPIN)
    pushed = [one - two for one, two in zip(free.residuals, found.residuals, strict=True)]
    assert equal(pushed, forces)
    assert found.agrees is True
    mapped = gt.equations_of_motion(frame, SPIN, dict(enumerate(forces)))
    assert mapped.rates == found.rates


def test_missile_on_r3xso3():
    """Equations (1) and (2): M V' + Omega x M V = F and Euler's equations, in one 6-frame."""
    force = sp.symbols("F1:7")
    found = gt.equations_of_motion(spaces.load("r3xso3").frame, FLIGHT, force)
    omega, speed = sp.Matrix(U[:3]), sp.Matrix(U[3:])
    momentum = sp.Matrix([i * u for i, u in zip(MOMENTS, U[:3], strict=True)])
    turn = sp.Matrix(force[:3]) - omega.cross(momentum)
    push = sp.Matrix(force[3:]) - omega.cross(MASS * speed)
    expected = [m / i for m, i in zip(turn, MOMENTS, strict=True)] + list(push / MASS)
    assert equal(found.accelerations, expected)
    assert found.agrees is True


@pytest.mark.parametrize("name", ["so3", "r3xso3", "flat_polar", "s2", "heisenberg"])
def test_closed_in_image_gives_autoparallels(name):
    """Kleinert's principle with L = eta_ij u^i u^j / 2: the equations of gt.autoparallel."""
    frame = spaces.load(name).frame
    kinetic = sum(u**2 for u in U[: frame.dimension]) / 2
    found = gt.equations_of_motion(frame, kinetic, principle="closed_in_image")
    assert set(found.accelerations) == {0}
    assert found.agrees is True
    problem = gt.autoparallel(
        gt.cartan(frame), [1] * frame.dimension, [1] * frame.dimension,
        parameters={symbol.name: 1 for symbol in frame.parameters},
    )  # fmt: skip
    assert same_rates(found, problem)


@pytest.mark.parametrize("name", ["so3", "r3xso3", "flat_polar", "s2", "heisenberg"])
def test_closed_in_coordinates_gives_geodesics(name):
    """Hamilton's principle with the same L: the equations of gt.geodesic."""
    frame = spaces.load(name).frame
    kinetic = sum(u**2 for u in U[: frame.dimension]) / 2
    found = gt.equations_of_motion(frame, kinetic)
    problem = gt.geodesic(
        frame, [1] * frame.dimension, [1] * frame.dimension,
        parameters={symbol.name: 1 for symbol in frame.parameters},
    )  # fmt: skip
    assert same_rates(found, problem)


def same_rates(equations, problem):
    """Whether the rates equal the rates of a problem of curves/, exactly."""
    written = problem.equations()
    letters = {s.name: s for s in (*equations.frame.coordinates, *equations.velocities)}
    compared = 0
    for name, products in zip(written.states, written.rates, strict=True):
        rate = sum(c.sympy * sp.prod([letters[n] for n in names]) for c, names in products)
        assert sp.simplify(rate - equations.rates[name]) == 0, name
        compared += 1
    return compared >= equations.frame.dimension


def test_torsion_force_has_the_opposite_sign_of_the_connection():
    """With p = u it is minus the torsion force of the connection, 2 S_a^c_b q'^a q'^b lowered."""
    frame = spaces.load("r3xso3").frame
    found = gt.equations_of_motion(frame, sum(u**2 for u in U) / 2)
    rates = [found.rates[q.name] for q in frame.coordinates]
    own = gt.Frame(frame.coordinates, frame.coframe.to_sympy())
    force = gt.cartan(own).torsion.force(rates).in_frame()
    for k in range(6):
        one, two = own.read([("one", force[k]), ("two", found.torsion_force[k])])
        assert one == -two
    assert any(found.torsion_force)
    turning = gt.equations_of_motion(spaces.load("so3").frame, sum(u**2 for u in U[:3]) / 2)
    assert turning.torsion_force == (0, 0, 0)


def test_principles_differ_on_so3():
    """Equal moments of inertia: all three agree; else only Hamilton's has a gyroscopic term."""
    frame = spaces.load("so3").frame
    equal_moments = SPIN.subs(dict.fromkeys(MOMENTS, MOMENTS[0]))
    names = ("closed_in_coordinates", "closed_in_image", "naive")
    rates = [gt.equations_of_motion(frame, equal_moments, principle=p).accelerations for p in names]
    assert rates[0] == rates[1] == rates[2] == (0, 0, 0)
    rates = [gt.equations_of_motion(frame, SPIN, principle=p).accelerations for p in names]
    assert rates[1] == rates[2] == (0, 0, 0)
    assert all(value != 0 for value in rates[0])


def test_screws_and_flights_on_r3xso3():
    """Autoparallels are screws, with V constant in the body; geodesics are straight in space."""
    frame = spaces.load("r3xso3").frame
    screw = gt.equations_of_motion(frame, FLIGHT, principle="closed_in_image")
    flight = gt.equations_of_motion(frame, FLIGHT)
    assert set(screw.accelerations) == {0}
    for name in ("momentum of x1", "momentum of x2", "momentum of x3"):
        assert name in flight.invariants
        assert name not in screw.invariants


def test_reduced_equations():
    """On a group the velocities have their own equations and invariants; gravity is refused."""
    frame = spaces.load("so3").frame
    alone = gt.equations_of_motion(frame, SPIN).reduced
    assert set(alone.rates) == {"u1", "u2", "u3"}
    assert set(alone.invariants) == {"energy", "casimir 1"}
    assert str(alone).startswith("u1' = ")
    assert alone.latex.count(r"\dot") == 3
    heavy = gt.equations_of_motion(frame, SPIN - sp.cos(frame.coordinates[1]))
    with pytest.raises(LagrangianError, match="rate of u1 that depends on phi1"):
        _ = heavy.reduced


def test_text_and_latex():
    """Text has one line per state, and LaTeX dots its letters."""
    found = gt.equations_of_motion(spaces.load("so3").frame, SPIN)
    lines = found.text.splitlines()
    assert [line.split("'")[0] for line in lines] == list(found.rates)
    assert r"\dot{\phi}_{1} &=" in found.latex
    assert repr(found).startswith("equations of motion on so3, closed_in_coordinates:")
    assert str(found) == found.text
    assert found._repr_latex_().startswith("$$")


def test_text_is_read_like_expressions():
    """Text with listed parameters gives the same equations as sympy expressions."""
    frame = spaces.load("so3").frame
    one = gt.equations_of_motion(
        frame, "(I1*u1**2 + I2*u2**2 + I3*u3**2)/2 - w*cos(phi2)", ["-c*u1", 0, "sin(t)"],
        parameters=["I1", "I2", "I3", "w", "c"],
    )  # fmt: skip
    energy = SPIN - sp.Symbol("w") * sp.cos(frame.coordinates[1])
    two = gt.equations_of_motion(
        frame, energy, {0: -sp.Symbol("c") * U[0], 2: sp.sin(sp.Symbol("t"))}
    )
    assert one.rates == two.rates


def test_the_frame_of_the_user_is_unchanged():
    """Mechanics adds no symbol to the frame of the user."""
    x, y = sp.symbols("x y", positive=True)
    frame = gt.Frame([x, y], [[1, 0], [0, x]])
    before = frame.field.symbols
    found = gt.equations_of_motion(frame, sp.Symbol("m") * (U[0] ** 2 + U[1] ** 2) / 2)
    assert found.agrees is True
    assert found.invariants
    assert gt.variation(frame).proved is True
    assert frame.field.symbols == before


def test_other_letters_where_the_frame_has_taken_them():
    """A coordinate u1 makes the velocities w1, w2; a coordinate t makes the time `time`."""
    u1, t = sp.symbols("u1 t")
    found = gt.equations_of_motion(gt.Frame([u1, t], [[1, u1], [0, 1]]), "w1**2 + w2**2 - u1")
    assert list(found.rates) == ["u1", "t", "w1", "w2"]
    assert found.time.name == "time"


def test_values_against_declarations():
    """A value against the assumptions of a parameter of the Lagrangian is refused."""
    m, x = sp.Symbol("m", positive=True), sp.Symbol("x", real=True)
    u = sp.Symbol("u1", real=True)
    found = gt.equations_of_motion(gt.Frame([x], [[1]]), u**2 / 2 - sp.sqrt(m**2) * x**2)
    with pytest.raises(
        CoordinateError,
        match="m: expected a value that is positive, nonnegative, as declared, got -2",
    ):
        ODE.of(found, [1, 0], parameters={"m": -2})
    assert ODE.of(found, [1, 0], parameters={"m": 2}).parameters == {"m": 2}
