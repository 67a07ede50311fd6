"""Invariants: the Killing fields and Casimirs that are found agree with books."""

# Sums of expressions that start with the number 0.
# pyright: reportAttributeAccessIssue=false

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion import spaces
from geomtorsion.action.ansatz import ansatz_functions, fitting_functions, right_invariant
from geomtorsion.action.invariants import depends, relations
from geomtorsion.exact import Field
from tests.action.test_equations import FLIGHT, MASS, MOMENTS, SPIN, U


def kinetic(frame):
    """Kinetic energy of unit mass."""
    return sum(frame.eta[k, k] * u**2 for k, u in enumerate(U[: frame.dimension])) / 2


def momenta(found):
    """Names of the invariants that are linear in the velocities."""
    return [
        name
        for name in found
        if name.startswith(("momentum", "body", "space"))
        or (name.startswith("killing ") and "tensor" not in name)
    ]


def test_how_many_candidates_are_tried():
    """Three directions have 192 candidates from 1, q, cos q, sin q; four use only 1 and q."""
    q = sp.symbols("x y z t")
    flat = gt.Frame(q[:3], sp.eye(3))
    found, words = ansatz_functions(flat, fitting_functions(flat, []))
    assert len(found) == len(set(found)) == 64
    assert words.endswith("(1, z, cos(z), sin(z))")
    found, _ = ansatz_functions(flat, fitting_functions(flat, [q[2] ** 2]))
    assert len(found) == len(set(found)) == 32
    assert {q[0] * q[2], sp.cos(q[0]) * sp.sin(q[1]) * q[2]} <= set(found)
    four = gt.Frame(q, sp.eye(4))
    found, words = ansatz_functions(four, fitting_functions(four, []))
    assert (found, words) == ([1, *q], "one of (1, x, y, z, t)")


@pytest.mark.parametrize(
    ("name", "number"),
    [
        ("flat_polar", 3),
        ("flat_cylindrical", 6),
        ("flat_spherical", 6),
        ("s2", 3),
        ("so3", 6),
        ("so3_zxz", 6),
        # The helical combination counts once more: its coefficient kappa is not a number.
        ("twisted_bar", 7),
        ("schwarzschild", 4),
        ("schwarzschild_isotropic", 4),
        ("heisenberg", 4),
        ("ax_plus_b", 3),
    ],
)
def test_number_of_killing_fields(name, number):
    """Plane 3, space 6, sphere 3, rotations 3 + 3: as many as the geometry has."""
    frame = spaces.load(name).frame
    found = gt.conserved_quantities(frame, kinetic(frame))
    assert len(momenta(found)) == number
    assert not [name for name in found if "tensor" in name], "products of invariants are listed"
    assert next(iter(found)) == "energy"


def test_free_body_keeps_its_momentum_in_space():
    """so3 with unequal moments of inertia: all components of R L, and L.L in the body."""
    frame = spaces.load("so3").frame
    found = gt.conserved_quantities(frame, SPIN)
    assert set(found) == {
        "energy", "momentum of phi3", "space momentum 1", "space momentum 2", "casimir 1",
    }  # fmt: skip
    turn = sp.rot_ccw_axis3(frame.coordinates[2]) * sp.rot_ccw_axis2(frame.coordinates[1])
    turn = turn * sp.rot_ccw_axis3(frame.coordinates[0])
    momentum = sp.Matrix([i * u for i, u in zip(MOMENTS, U[:3], strict=True)])
    names = ("space momentum 1", "space momentum 2", "momentum of phi3")
    for one, name in zip(turn * momentum, names, strict=True):
        assert sp.expand(one - found[name]) == 0
    assert sp.expand(found["casimir 1"] - momentum.dot(momentum)) == 0


def test_free_flight_keeps_twelve():
    """r3xso3: momenta P, R L and x cross P, and the two Casimirs of se(3)."""
    found = gt.conserved_quantities(spaces.load("r3xso3").frame, FLIGHT)
    assert len(momenta(found)) == 9, "R L, x cross P and P, three of each"
    spin = sum(i * u * v for i, u, v in zip(MOMENTS, U[:3], U[3:], strict=True))
    assert sp.expand(found["casimir 1"] - MASS * spin) == 0
    assert sp.expand(found["casimir 2"] - MASS**2 * sum(v**2 for v in U[3:])) == 0


def test_falling_body():
    """Under gravity: P_1, P_2, the vertical angular momentum, the energy and L.L of the spin."""
    frame = spaces.load("r3xso3").frame
    height, g = frame.coordinates[5], sp.Symbol("g")
    found = gt.conserved_quantities(frame, FLIGHT - MASS * g * height)
    assert set(found) == {
        "energy", "momentum of phi3", "momentum of x1", "momentum of x2", "space momentum 3",
        "killing tensor 1",
    }  # fmt: skip
    spin = sum((i * u) ** 2 for i, u in zip(MOMENTS, U[:3], strict=True))
    assert sp.expand(found["killing tensor 1"] - spin) == 0


def test_almost_symmetric_is_not_symmetric():
    """Zero is decided exactly: moments that differ in the fortieth digit keep no p_psi."""
    frame = spaces.load("so3").frame
    weight = sp.cos(frame.coordinates[1])
    close = {MOMENTS[0]: 1, MOMENTS[1]: 1 + sp.Rational(1, 10**40), MOMENTS[2]: 2}
    assert "momentum of phi1" not in gt.conserved_quantities(frame, SPIN.subs(close) - weight)
    close[MOMENTS[1]] = 1
    assert "momentum of phi1" in gt.conserved_quantities(frame, SPIN.subs(close) - weight)


def test_helical_symmetry_is_a_combination():
    """A potential of phi - 2 z keeps 2 p_phi + p_z, but neither of the two."""
    frame = spaces.load("flat_cylindrical").frame
    _, phi, z = frame.coordinates
    found = gt.conserved_quantities(frame, kinetic(frame) - sp.cos(phi - 2 * z))
    assert list(found) == ["energy", "momentum 1"]
    symbol = frame.coordinates[0]
    assert sp.expand(found["momentum 1"] - (2 * symbol * U[1] + U[2])) == 0


def test_forces_and_time_take_invariants_away():
    """Drag leaves no invariant; a radial force leaves the momentum of phi."""
    frame = spaces.load("flat_polar").frame
    drag = [-sp.Symbol("c") * u for u in U[:2]]
    assert gt.conserved_quantities(frame, kinetic(frame), drag) == {}
    pulled = gt.conserved_quantities(frame, kinetic(frame), [-1 / frame.coordinates[0] ** 2, 0])
    assert list(pulled) == ["momentum of phi"]


def test_gyroscopic_force_keeps_the_energy():
    """F = B x u does no work, so that the energy is found, although there is a force."""
    frame = spaces.load("flat_polar").frame
    field = sp.Symbol("B")
    found = gt.conserved_quantities(frame, kinetic(frame), [field * U[1], -field * U[0]])
    assert "energy" in found


@pytest.mark.parametrize("name", ["so3", "heisenberg", "ax_plus_b", "sl2r", "r3xso3", "sol"])
def test_right_invariant_fields_commute_with_the_legs(name):
    """[E_k, xi] = 0 to 30 digits, by sympy's derivatives at a point."""
    frame = spaces.load(name).frame
    found = right_invariant(frame)
    assert found is not None
    n, q = range(frame.dimension), frame.coordinates
    place = {s: sp.Rational(5 + 2 * k, 11) for k, s in enumerate((*q, *frame.parameters))}
    legs, twist = frame.legs.to_sympy(), frame.anholonomy
    fields = sp.Matrix(found)
    assert abs(sp.N(fields.subs(place).det(), 30)) > 1e-6
    for row in found:
        for k in n:
            for i in n:
                change = sp.Add(*(legs[mu, k] * sp.diff(row[i], q[mu]) for mu in n))
                left = sp.Add(*(twist[k, j, i] * row[j] for j in n))
                assert abs(sp.N((change - left).subs(place), 30)) < 1e-25


def test_no_right_invariant_fields_off_groups():
    """A sphere is not a group, so that no such fields exist."""
    assert right_invariant(spaces.load("s2").frame) is None


def test_relations_over_the_rationals():
    """Combinations are found exactly; coefficients are numbers and contain no parameters."""
    x, k = sp.symbols("x k")
    field = Field([x, k])
    values = [field.read(v) for v in (sp.sin(x) ** 2, sp.cos(x) ** 2, 1 / x, k / x, sp.Integer(3))]
    (row,) = relations([[value] for value in values])
    assert row == {0: 3, 1: 3, 4: -1}
    assert depends(field.read(sp.cos(2 * x)), values)
    assert not depends(field.read(k), values)
    assert relations([[field.zero], [field.zero]]) == [{0: 1}, {1: 1}]
    assert relations([]) == []


def test_flow_gets_the_invariants():
    """gt.ODE.of accepts the equations directly, and gt.solve measures the drift of invariants."""
    frame = spaces.load("so3").frame
    found = gt.equations_of_motion(frame, SPIN - sp.Symbol("w") * sp.cos(frame.coordinates[1]))
    start = {"phi1": 0, "phi2": 1, "phi3": 0, "u1": 0.1, "u2": 0, "u3": 5}
    values = {"I1": 1, "I2": 2, "I3": 3, "w": 0.5}
    solution = gt.solve(gt.ODE.of(found, start, parameters=values), 3.0, accuracy=1e-10)
    assert set(solution.drift) == {"energy", "momentum of phi3"}
    assert max(solution.drift.values()) < 1e-9
    assert solution.error < 1e-10


def test_lines_that_begin_where_their_integral_is_not_zero():
    """dx/x^2 from x = 1: the right-invariant fields commute with the legs and are momenta.

    With -1/x instead of 1 - 1/x one field would be wrong, and its momentum would be missing.
    """
    x, y = sp.symbols("x y", positive=True)
    frame = gt.Frame([x, y], [[1 / x**2, 0], [0, sp.exp(1 / x)]])
    legs, curl = frame.legs.to_sympy(), frame.anholonomy
    fields = right_invariant(frame)
    assert fields is not None
    for field in fields:
        for k in range(2):
            for i in range(2):
                along = sum(legs[mu, k] * sp.diff(field[i], q) for mu, q in enumerate((x, y)))
                turned = sum(curl[k, j, i] * field[j] for j in range(2))
                assert sp.simplify(along - turned) == 0
    found = gt.conserved_quantities(frame, "(u1**2 + u2**2)/2")
    assert "space momentum 1" in found


X, Y, Z, T = sp.symbols("x y z t", real=True)
K = sp.Symbol("k", positive=True)


def verified(frame, lagrangian, found):
    """Whether each quantity is constant along the motion, at a point without symmetry."""
    equations = gt.equations_of_motion(frame, lagrangian)
    numbers = [sp.Rational(k, 7) for k in (9, 4, 5, -3, 2, -6, 8, 1)]
    names = [*frame.coordinates, *equations.velocities]
    place = dict(zip(names, numbers, strict=False))
    place |= dict.fromkeys(sp.sympify(lagrangian).free_symbols - set(place), sp.Rational(6, 5))
    rates = [equations.rates[symbol.name] for symbol in names]
    for value in found.values():
        change = sum(value.diff(s) * rate for s, rate in zip(names, rates, strict=True))
        assert abs(sp.N(change.subs(place), 30)) < 1e-25
    return True


@pytest.mark.parametrize(
    ("place", "potential", "number"),
    [
        ((X, Y), K * (X**2 + Y**2) / 2, 1),
        ((X, Y), -K / sp.sqrt(X**2 + Y**2), 1),
        ((X, Y, Z), K * (X**2 + Y**2 + Z**2) / 2, 3),
        ((X, Y, Z), -K / sp.sqrt(X**2 + Y**2 + Z**2), 3),
        ((X, Y, Z), K * (X**2 + Y**2) / 2, 2),
        ((X, Y, Z), sp.S.Zero, 6),
    ],
)
def test_angular_momentum_in_cartesian_coordinates(place, potential, number):
    """Oscillators, Kepler and the free particle have the same number as in any coordinates."""
    frame = gt.Frame(place, sp.eye(len(place)))
    lagrangian = kinetic(frame) - potential
    found = gt.conserved_quantities(frame, lagrangian)
    assert len(momenta(found)) == number
    assert verified(frame, lagrangian, found)
    # The angular momentum about z is a combination of these momenta.
    values = [value for name, value in found.items() if name in momenta(found)]
    field = Field([*place, *U[:3], K])
    turning = field.read(place[0] * U[1] - place[1] * U[0])
    assert depends(turning, [field.read(value) for value in values])


def test_minkowski_has_ten():
    """Translations, rotations and boosts, in Cartesian and in spherical coordinates."""
    signature = (-1, 1, 1, 1)
    flat = gt.Frame((T, X, Y, Z), sp.eye(4), signature=signature)
    found = gt.conserved_quantities(flat, kinetic(flat))
    assert len(momenta(found)) == 10
    assert len(found) == 11
    r, theta, phi = sp.symbols("r theta phi", real=True)
    legs = sp.diag(1, 1, r, r * sp.sin(theta))
    round_one = gt.Frame((T, r, theta, phi), legs, signature=signature)
    found = gt.conserved_quantities(round_one, kinetic(round_one))
    assert len(momenta(found)) == 10
    assert verified(round_one, kinetic(round_one), found)


@pytest.mark.parametrize("name", ["kerr", "kerr_newman"])
def test_carters_constant(name):
    """K = r^2 (u3^2 + u4^2) + a^2 cos^2 (u1^2 - u2^2) [Carter 1968] is found for Kerr."""
    q = sp.symbols("t r theta phi", real=True)
    _, r, theta, _ = q
    mass, a, charge = sp.symbols("M a Q", positive=True)
    c, s = sp.cos(theta), sp.sin(theta)
    extra = charge**2 if name == "kerr_newman" else 0
    slow = sp.sqrt(r**2 - 2 * mass * r + a**2 + extra) / sp.sqrt(r**2 + a**2 * c**2)
    long = sp.sqrt(r**2 + a**2 * c**2)
    rows = [
        [slow, 0, 0, -a * s**2 * slow],
        [0, 1 / slow, 0, 0],
        [0, 0, long, 0],
        [-a * s / long, 0, 0, (r**2 + a**2) * s / long],
    ]
    frame = gt.Frame(q, rows, signature=(-1, 1, 1, 1), parameters=(mass, a, charge))
    found = gt.conserved_quantities(frame, kinetic(frame))
    assert list(found) == ["energy", "momentum of t", "momentum of phi", "killing tensor 1"]
    u = U[:4]
    published = r**2 * (u[2] ** 2 + u[3] ** 2) + a**2 * c**2 * (u[0] ** 2 - u[1] ** 2)
    assert sp.expand(found["killing tensor 1"] - published) == 0
    # (L - a E)^2 + Q, with Carter's constant Q of Boyer-Lindquist coordinates.
    energy, turn = -found["momentum of t"], found["momentum of phi"]
    square = -2 * found["energy"]
    carter = (long * u[2]) ** 2 + c**2 * (a**2 * (square - energy**2) + turn**2 / s**2)
    numbers = [r, theta, mass, a, charge, *u]
    place = {
        x: sp.Rational(k, 11) for x, k in zip(numbers, (40, 9, 10, 6, 3, 14, 2, 5, 7), strict=True)
    }
    gap = found["killing tensor 1"] - (turn - a * energy) ** 2 - carter
    assert abs(sp.N(gap.subs(place), 30)) < 1e-25


def test_curved_spaces_in_cartesian_coordinates():
    """A sphere from its pole and the half plane have three fields, quadratic in coordinates."""
    for factor in (2 / (1 + X**2 + Y**2), 1 / Y):
        frame = gt.Frame((X, Y), factor * sp.eye(2))
        found = gt.conserved_quantities(frame, kinetic(frame))
        assert len(momenta(found)) == 3
        assert verified(frame, kinetic(frame), found)


def test_the_ansatz_is_reported():
    """The searched ansatz is printed with the result, also if nothing was found."""
    frame = gt.Frame((X, Y), sp.eye(2))
    found = gt.conserved_quantities(frame, kinetic(frame) - K * (X**2 + X * Y**3))
    assert list(found) == ["energy"]
    assert "sums of c*f(q)*p_k, f a product of one of each (1, x) (1, y)" in found.ansatz
    assert repr(found).endswith("\n".join(f"  {line}" for line in found.ansatz))
    drag = [-U[0], -U[1]]
    none = gt.conserved_quantities(frame, kinetic(frame) - T * X - Y**2, drag)
    assert repr(none).startswith("nothing was found\nsearched:")
    assert gt.conserved_quantities(frame, kinetic(frame)) == dict(
        gt.conserved_quantities(frame, kinetic(frame))
    )
