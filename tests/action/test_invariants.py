"""Invariants: Killing fields and Casimirs that are found, against those that books list."""

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion import spaces
from geomtorsion.action.invariants import (
    ansatz_functions,
    depends,
    relations,
    right_invariant,
)
from geomtorsion.exact import Field
from tests.action.test_equations import FLIGHT, MASS, MOMENTS, SPIN, U


def kinetic(frame):
    """Half the square of the velocity, of unit mass."""
    return sum(u**2 for u in U[: frame.dimension]) / 2


def momenta(found):
    """What is linear in the velocities."""
    return [name for name in found if name.startswith(("momentum", "body", "space", "killing"))]


def test_how_many_candidates_are_tried():
    """Of 1, q, cos q, sin q in three directions there would be 192; with 1 and q in one 96."""
    q = sp.symbols("x y z")
    flat = gt.Frame(q, sp.eye(3))
    assert ansatz_functions(flat, []) == []
    found = ansatz_functions(flat, [q[2] ** 2])
    assert len(found) == len(set(found)) == 32
    assert {q[0] * q[2], sp.cos(q[0]) * sp.sin(q[1]) * q[2]} <= set(found)


@pytest.mark.parametrize(
    ("name", "number"),
    [
        ("flat_polar", 3),
        ("flat_cylindrical", 6),
        ("flat_spherical", 6),
        ("s2", 3),
        ("so3", 6),
        ("so3_zxz", 6),
        ("twisted_bar", 4),
    ],
)
def test_number_of_killing_fields(name, number):
    """Plane 3, space 6, sphere 3, rotations 3 + 3: as many as the geometry has."""
    frame = spaces.load(name).frame
    found = gt.conserved_quantities(frame, kinetic(frame))
    assert len(momenta(found)) == number
    assert next(iter(found)) == "energy"


def test_free_body_keeps_its_momentum_in_space():
    """so3 with unequal moments: R L, all three, and L.L in the body."""
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


def test_free_flight_keeps_ten():
    """r3xso3: energy, momentum, angular momentum about the origin and the two Casimirs of se(3)."""
    found = gt.conserved_quantities(spaces.load("r3xso3").frame, FLIGHT)
    assert len(momenta(found)) == 7, "R L + x cross P, P, and L_3 alone, as phi3 is cyclic"
    spin = sum(i * u * v for i, u, v in zip(MOMENTS, U[:3], U[3:], strict=True))
    assert sp.expand(found["casimir 1"] - MASS * spin) == 0
    assert sp.expand(found["casimir 2"] - MASS**2 * sum(v**2 for v in U[3:])) == 0


def test_falling_body():
    """Under gravity: P_1, P_2, the vertical angular momentum and the energy stay."""
    frame = spaces.load("r3xso3").frame
    height, g = frame.coordinates[5], sp.Symbol("g")
    found = gt.conserved_quantities(frame, FLIGHT - MASS * g * height)
    assert set(found) == {
        "energy", "momentum of phi3", "momentum of x1", "momentum of x2", "space momentum 3",
    }  # fmt: skip


def test_almost_symmetric_is_not_symmetric():
    """Zero is decided: moments that differ in the fortieth place keep no p_psi."""
    frame = spaces.load("so3").frame
    weight = sp.cos(frame.coordinates[1])
    close = {MOMENTS[0]: 1, MOMENTS[1]: 1 + sp.Rational(1, 10**40), MOMENTS[2]: 2}
    assert "momentum of phi1" not in gt.conserved_quantities(frame, SPIN.subs(close) - weight)
    close[MOMENTS[1]] = 1
    assert "momentum of phi1" in gt.conserved_quantities(frame, SPIN.subs(close) - weight)


def test_helical_symmetry_is_a_combination():
    """A potential of phi - 2 z keeps 2 p_phi + p_z and neither alone."""
    frame = spaces.load("flat_cylindrical").frame
    _, phi, z = frame.coordinates
    found = gt.conserved_quantities(frame, kinetic(frame) - sp.cos(phi - 2 * z))
    assert list(found) == ["energy", "momentum 1"]
    symbol = frame.coordinates[0]
    assert sp.expand(found["momentum 1"] - (2 * symbol * U[1] + U[2])) == 0


def test_forces_and_time_take_invariants_away():
    """Drag leaves nothing; a force along z leaves what has no z in it."""
    frame = spaces.load("flat_polar").frame
    drag = [-sp.Symbol("c") * u for u in U[:2]]
    assert gt.conserved_quantities(frame, kinetic(frame), drag) == {}
    pulled = gt.conserved_quantities(frame, kinetic(frame), [-1 / frame.coordinates[0] ** 2, 0])
    assert list(pulled) == ["momentum of phi"]


def test_gyroscopic_force_keeps_the_energy():
    """F = B x u does no work: found although it is a force."""
    frame = spaces.load("flat_polar").frame
    field = sp.Symbol("B")
    found = gt.conserved_quantities(frame, kinetic(frame), [field * U[1], -field * U[0]])
    assert "energy" in found


@pytest.mark.parametrize("name", ["so3", "heisenberg", "ax_plus_b", "sl2r", "r3xso3", "sol"])
def test_right_invariant_fields_commute_with_the_legs(name):
    """[E_k, xi] = 0, by sympy's own derivatives at a point, to 30 digits."""
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
    """A sphere is no group; a quaternion chart needs no such fields to be refused quietly."""
    assert right_invariant(spaces.load("s2").frame) is None


def test_relations_over_the_rationals():
    """Combinations are found exactly; parameters are no numbers."""
    x, k = sp.symbols("x k")
    field = Field([x, k])
    values = [field.read(v) for v in (sp.sin(x) ** 2, sp.cos(x) ** 2, 1 / x, k / x, sp.Integer(3))]
    (row,) = relations(field, [[value] for value in values])
    assert row == {0: 3, 1: 3, 4: -1}
    assert depends(field, field.read(sp.cos(2 * x)), values)
    assert not depends(field, field.read(k), values)
    assert relations(field, [[field.zero], [field.zero]]) == [{0: 1}, {1: 1}]
    assert relations(field, []) == []


def test_flow_gets_the_invariants():
    """gt.ODE.of takes the equations as they are, and gt.solve measures how well they are kept."""
    frame = spaces.load("so3").frame
    found = gt.equations_of_motion(frame, SPIN - sp.Symbol("w") * sp.cos(frame.coordinates[1]))
    start = {"phi1": 0, "phi2": 1, "phi3": 0, "u1": 0.1, "u2": 0, "u3": 5}
    values = {"I1": 1, "I2": 2, "I3": 3, "w": 0.5}
    solution = gt.solve(gt.ODE.of(found, start, parameters=values), 3.0, accuracy=1e-10)
    assert set(solution.drift) == {"energy", "momentum of phi3"}
    assert max(solution.drift.values()) < 1e-9
    assert solution.error < 1e-10


def test_lines_that_begin_where_their_integral_is_not_zero():
    """dx/x^2 from x = 1: the fields on the right commute with the legs, and are momenta.

    With -1/x in place of 1 - 1/x one of them was none, and its momentum was not found.
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
