"""Constraints linear in the velocities: published solutions, and reactions."""

import pytest
import sympy as sp
from sympy.physics.mechanics import (
    KanesMethod,
    LagrangesMethod,
    Point,
    ReferenceFrame,
    RigidBody,
    dynamicsymbols,
    inertia,
)

import geomtorsion as gt
from geomtorsion.errors import ConstraintError

X, Y, THETA = sp.symbols("x y theta", real=True)
U1, U2, U3 = sp.symbols("u1 u2 u3")
M, A, MOMENT, R, G = sp.symbols("m a MOMENT r g", positive=True)
# Forward, sideways and turning velocity of a sledge: a left-invariant frame of the plane's motions.
SLEDGE = gt.Frame(
    [X, Y, THETA],
    [[sp.cos(THETA), sp.sin(THETA), 0], [-sp.sin(THETA), sp.cos(THETA), 0], [0, 0, 1]],
    name="se2",
)
SLEIGH = M * (U1**2 + (U2 + A * U3) ** 2) / 2 + MOMENT * U3**2 / 2


def test_chaplygin_sleigh():
    """v' = a w^2, (I + m a^2) w' = - m a v w [Chaplygin 1911; Bloch, 1.7]; energy is kept."""
    found = gt.equations_of_motion(SLEDGE, SLEIGH, constraints=[U2])
    assert found.velocities == (U1, U3)
    assert set(found.rates) == {"x", "y", "theta", "u1", "u3"}
    assert sp.simplify(found.rates["u1"] - A * U3**2) == 0
    assert sp.simplify(found.rates["u3"] + M * A * U1 * U3 / (MOMENT + M * A**2)) == 0
    assert found.rates["x"] == U1 * sp.cos(THETA)
    assert found.agrees is True
    energy = M * U1**2 / 2 + (MOMENT + M * A**2) * U3**2 / 2
    assert sp.expand(found.invariants["energy"] - energy) == 0
    assert len(found.invariants) == 1, "the blade takes away all momenta"


def test_knife_edge_in_coordinates_moves_the_same_way():
    """The blade as sin(theta) x' - cos(theta) y' = 0 over dx, dy gives the same motion."""
    plain = gt.Frame([X, Y, THETA], sp.eye(3).tolist())
    turn = {
        U1: sp.cos(THETA) * U1 + sp.sin(THETA) * U2,
        U2: -sp.sin(THETA) * U1 + sp.cos(THETA) * U2,
    }
    lagrangian = SLEIGH.subs(turn, simultaneous=True)
    blade = sp.sin(THETA) * U1 - sp.cos(THETA) * U2
    found = gt.equations_of_motion(plain, lagrangian, constraints=[blade])
    assert found.agrees is True
    turning = found.rates["u3"].subs(U1, sp.cos(THETA) * U1)
    expected = -M * A * U1 * U3 / (MOMENT + M * A**2)
    assert sp.simplify(turning - expected) == 0


def test_reaction_on_an_inclined_knife_edge():
    """The force by the multiplier of LagrangesMethod is the reaction along the blade's form."""
    slope = sp.Symbol("s")
    lagrangian = M * (U1**2 + U2**2) / 2 + MOMENT * U3**2 / 2 - M * G * slope * X
    found = gt.equations_of_motion(SLEDGE, lagrangian, constraints=[U2])
    x, y, theta = dynamicsymbols("x y theta")
    xd, yd, thetad = dynamicsymbols("x y theta", 1)
    same = M * (xd**2 + yd**2) / 2 + MOMENT * thetad**2 / 2 - M * G * slope * x
    across = -sp.sin(theta) * xd + sp.cos(theta) * yd
    method = LagrangesMethod(same, [x, y, theta], nonhol_coneqs=[across])
    method.form_lagranges_equations()
    solved = method.rhs()
    t = dynamicsymbols._t
    names = {x: X, y: Y, theta: THETA}
    speeds = {xd: U1 * sp.cos(THETA), yd: U1 * sp.sin(THETA), thetad: U3}
    assert len(solved) == 7, "three rates, three accelerations, one multiplier"

    def here(expression):
        return sp.simplify(expression.subs(speeds).subs(names).subs(sp.Derivative(x, t), 0))

    # sympy's multiplier is on the left: m q'' + lambda a = Q or m q'' - lambda a = Q.
    force = here(solved[6])
    assert sp.simplify(force**2 - found.reactions["u2"] ** 2) == 0
    # By Newton: mass times sideways acceleration, minus the sideways part of the weight.
    newton = M * U1 * U3 - M * G * slope * sp.sin(THETA)
    assert sp.expand(found.reactions["u2"] - newton) == 0
    forward = here(solved[3] * sp.cos(theta) + solved[4] * sp.sin(theta))
    assert sp.simplify(forward - found.rates["u1"]) == 0
    assert sp.simplify(found.rates["u3"]) == 0


def disc_equations():
    """A thin disc rolling on a table, with velocities along the leaning axes of sympy's manual."""
    q1, q2, q3 = sp.symbols("q1 q2 q3", real=True)
    place = sp.symbols("x1 x2 x3", real=True)
    turn = sp.rot_ccw_axis3(q1) * sp.rot_ccw_axis1(q2)
    spins = [[0, 1, 0], [sp.sin(q2), 0, 1], [sp.cos(q2), 0, 0]]
    frame = gt.Frame((q1, q2, q3, *place), sp.diag(sp.Matrix(spins), turn.T), name="disc")
    u = sp.symbols("u1:7")
    inertias = (M * R**2 / 4, M * R**2 / 2, M * R**2 / 4)
    kinetic = sum(j * w**2 for j, w in zip(inertias, u[:3], strict=True)) / 2
    kinetic += M * sum(v**2 for v in u[3:]) / 2
    # The centre is r above the contact along the leaning z axis: V = omega x r z.
    rolling = [u[3] - R * u[1], u[4] + R * u[0], u[5]]
    height = (turn * sp.Matrix([0, 0, R]))[2]
    found = gt.equations_of_motion(frame, kinetic - M * G * height, constraints=rolling)
    return found, u, q2


def test_rolling_disc_as_in_the_manual_of_sympy():
    """u1' = (4 g sin q2 + 6 r u2 u3 - r u3^2 tan q2) / (5 r), u2' = -2 u1 u3 / 3, u3' = ..."""
    found, u, lean = disc_equations()
    u1, u2, u3 = u[:3]
    expected = (
        (4 * G * sp.sin(lean) + 6 * R * u2 * u3 - R * u3**2 * sp.tan(lean)) / (5 * R),
        -2 * u1 * u3 / 3,
        (-2 * u2 + u3 * sp.tan(lean)) * u1,
    )
    assert found.velocities == u[:3]
    for one, two in zip(found.accelerations, expected, strict=True):
        assert sp.simplify(one - two) == 0
    assert found.agrees is True
    assert set(found.invariants) == {"energy"}


def test_rolling_disc_by_kane():
    """The same equations by Kane's method, from bodies and points instead of a frame of forms."""
    q1, q2, q3, u1, u2, u3 = dynamicsymbols("q1 q2 q3 u1 u2 u3")
    q1d, q2d, q3d = dynamicsymbols("q1 q2 q3", 1)
    space = ReferenceFrame("N")
    yaw = space.orientnew("Y", "Axis", [q1, space.z])
    lean = yaw.orientnew("L", "Axis", [q2, yaw.x])
    disc = lean.orientnew("R", "Axis", [q3, lean.y])
    disc.set_ang_vel(space, u1 * lean.x + u2 * lean.y + u3 * lean.z)
    contact = Point("C")
    contact.set_vel(space, 0)
    centre = contact.locatenew("D", R * lean.z)
    centre.v2pt_theory(contact, space, disc)
    dyad = inertia(lean, M * R**2 / 4, M * R**2 / 2, M * R**2 / 4)
    # The chain rule of the angles gives the angular velocity of the leaning frame.
    lean.set_ang_vel(space, q2d * lean.x + q1d * sp.sin(q2) * lean.y + q1d * sp.cos(q2) * lean.z)
    lean.set_ang_acc(space, lean.ang_vel_in(space).dt(space))
    body = RigidBody("disc", centre, disc, M, (dyad, centre))
    angles = [q2d - u1, q3d + sp.sin(q2) * q1d - u2, sp.cos(q2) * q1d - u3]
    method = KanesMethod(space, [q1, q2, q3], [u1, u2, u3], kd_eqs=angles)
    method.kanes_equations([body], [(centre, -M * G * space.z)])
    rates = method.rhs()[3:, :].subs(method.kindiffdict())
    found, u, q = disc_equations()
    plain = dict(zip((u1, u2, u3, q2), (*u[:3], q), strict=True))
    for one, two in zip(found.accelerations, rates, strict=True):
        assert sp.simplify(one - two.subs(plain)) == 0


def test_steady_motions_of_the_disc():
    """The upright disc, and circles with the balanced tan(lean): u1' = u2' = u3' = 0."""
    found, u, lean = disc_equations()
    upright = {lean: 0, u[0]: 0, u[2]: 0}
    assert [value.subs(upright) for value in found.accelerations] == [0, 0, 0]
    circle = {u[0]: 0, u[1]: (R * u[2] ** 2 * sp.tan(lean) - 4 * G * sp.sin(lean)) / (6 * R * u[2])}
    assert [sp.simplify(value.subs(circle)) for value in found.accelerations] == [0, 0, 0]


def test_one_constraint_may_be_given_in_text():
    """Text and expressions give the same equations; coefficients may contain coordinates."""
    one = gt.equations_of_motion(SLEDGE, SLEIGH, constraints=["u2"])
    two = gt.equations_of_motion(SLEDGE, SLEIGH, constraints=["(2 + cos(theta))*u2"])
    assert {k: sp.simplify(v) for k, v in one.rates.items()} == {
        k: sp.simplify(v) for k, v in two.rates.items()
    }


@pytest.mark.parametrize(
    ("constraints", "words"),
    [
        (["u2**2"], "expected a constraint linear in the velocities"),
        (["x"], "expected a constraint linear in the velocities"),
        (["u1*u2 + 1"], "expected a constraint linear in the velocities"),
        (["t*u2"], "expected a constraint linear in the velocities"),
        (["u2", "2*u2"], r"constraints\[1\]: expected .* follows from"),
        (["u2", "u2 - 1"], r"constraints\[1\]: expected .* follows from.*or contradicts"),
        (["u1 + u2", "2*u1 + 2*u2"], r"constraints\[1\]: expected .* follows from"),
        (["u1", "u2", "u1 + x*u2"], "nothing could move"),
        (["0"], "expected a constraint linear in the velocities"),
    ],
)
def test_bad_constraints(constraints, words):
    """A constraint that is not linear, or follows from others, is refused by its index."""
    with pytest.raises(ConstraintError, match=words):
        gt.equations_of_motion(SLEDGE, SLEIGH, constraints=constraints)


def test_particle_on_a_rotating_line_is_free_where_it_should_be():
    """An integrable constraint gives the motion of the reduced system."""
    x, y = sp.symbols("x y", real=True)
    frame = gt.Frame([x, y], [[1, 0], [0, 1]])
    slope = sp.Symbol("k", positive=True)
    found = gt.equations_of_motion(
        frame, M * (U1**2 + U2**2) / 2 - M * G * y, constraints=[U2 - slope * U1]
    )
    assert sp.simplify(found.rates["u1"] + slope * G / (1 + slope**2)) == 0
    assert sp.simplify(found.reactions["u2"] - M * G / (1 + slope**2)) == 0


def test_forces_under_constraints():
    """A force along a fixed velocity acts through the free ones: F_1 + k F_2 on a line."""
    x, y = sp.symbols("x y", real=True)
    frame = gt.Frame([x, y], [[1, 0], [0, 1]])
    slope, drag = sp.symbols("k c", positive=True)
    push = [sp.cos(sp.Symbol("t")), -drag * U2 + x]
    found = gt.equations_of_motion(
        frame, M * (U1**2 + U2**2) / 2, push, constraints=[U2 - slope * U1]
    )
    along = push[0] + slope * push[1].subs(U2, slope * U1)
    assert sp.simplify(found.rates["u1"] - along / (M * (1 + slope**2))) == 0
    assert found.agrees is True
    # Newton for y: m y'' = F_2 + reaction.
    reaction = M * slope * found.rates["u1"] - push[1].subs(U2, slope * U1)
    assert sp.simplify(found.reactions["u2"] - reaction) == 0


@pytest.mark.parametrize(
    ("constraint", "left"),
    [
        ("x*u1 + u2", ("u1", "u3")),
        ("u1 + x*u2", ("u2", "u3")),
        ("u1 + u2", ("u1", "u3")),
        ("m*u1 + x*u2", ("u2", "u3")),
        ("x*u1 + y*u2", ("u1", "u3")),
    ],
)
def test_which_velocity_goes(constraint, left):
    """A velocity with a constant coefficient is eliminated; of several, the last one."""
    found = gt.equations_of_motion(SLEDGE, SLEIGH, constraints=[constraint])
    assert tuple(symbol.name for symbol in found.velocities) == left
    assert found.agrees is True


def test_ball_on_a_turntable():
    """The centre of a homogeneous ball moves in circles at 2/7 of the table's rate."""
    spin = gt.spaces.load("so3_right").frame
    x, y = sp.symbols("x y", real=True)
    forms = sp.diag(spin.coframe.to_sympy().tomatrix(), sp.eye(2))
    frame = gt.Frame((*spin.coordinates, x, y), forms)  # angular velocity in space, then x', y'
    u = sp.symbols("u1:6")
    table = sp.Symbol("Omega")
    energy = M * (u[3] ** 2 + u[4] ** 2) / 2 + M * R**2 * sum(w**2 for w in u[:3]) / 5
    # At the contact the ball moves with the table: v - r z x w = Omega z x (x, y).
    rolling = [u[3] - R * u[1] + table * y, u[4] + R * u[0] - table * x]
    found = gt.equations_of_motion(frame, energy, constraints=rolling)
    assert found.velocities == u[:3]
    assert found.agrees is True
    speed = [found.rates["x"], found.rates["y"]]
    change = [sum(sp.diff(v, s) * found.rates[s.name] for s in (x, y, *u[:3])) for v in speed]
    rate = sp.Rational(2, 7) * table
    assert sp.simplify(change[0] + rate * speed[1]) == 0
    assert sp.simplify(change[1] - rate * speed[0]) == 0
    assert "energy" not in found.invariants


def test_driven_wheel():
    """A bead on a rod of given angular velocity: r'' = w(t)^2 r, with the torque for that."""
    frame = gt.spaces.load("flat_polar").frame
    radius, t = frame.coordinates[0], sp.Symbol("t")
    drive = sp.Function("w")(t)
    plain = gt.Frame(frame.coordinates, [[1, 0], [0, 1]])
    energy = M * (U1**2 + radius**2 * U2**2) / 2
    found = gt.equations_of_motion(plain, energy, constraints=[U2 - drive])
    assert sp.simplify(found.rates["u1"] - drive**2 * radius) == 0
    assert found.agrees is True
    torque = M * radius * (2 * drive * U1 + drive.diff(t) * radius)
    assert sp.simplify(found.reactions["u2"] - torque) == 0
    steady = gt.equations_of_motion(plain, energy, constraints=["u2 - w"], parameters=["m", "w"])
    assert set(steady.invariants) == {"jacobi integral"}
