"""Equations of motion: Euler's, autoparallels and geodesics out of one derivation."""

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion import spaces

U = sp.symbols("u1:7")
MOMENTS = sp.symbols("I1 I2 I3")
MASS = sp.Symbol("M")
SPIN = sum(moment * u**2 for moment, u in zip(MOMENTS, U[:3], strict=True)) / 2
FLIGHT = SPIN + MASS * (U[3] ** 2 + U[4] ** 2 + U[5] ** 2) / 2


def equal(found, expected):
    """Whether two sequences of expressions are the same, term by term."""
    assert len(found) == len(expected)
    return all(
        sp.expand(one - two) == 0 for one, two in zip(found, map(sp.sympify, expected), strict=True)
    )


def test_euler_equations_on_so3():
    """Equation (1) of the paper without moments: I_i u'^i + (u x I u)^i = 0."""
    found = gt.equations_of_motion(spaces.load("so3").frame, SPIN)
    omega = sp.Matrix(U[:3])
    momentum = sp.Matrix([i * u for i, u in zip(MOMENTS, U[:3], strict=True)])
    gyroscopic = omega.cross(momentum)
    dots = sp.symbols("u1dot u2dot u3dot")
    expected = [i * d + g for i, d, g in zip(MOMENTS, dots, gyroscopic, strict=True)]
    assert equal(found.residuals, expected)
    assert equal(found.momenta, momentum)
    assert found.agrees is True


def test_euler_equations_with_moments_of_force():
    """Equation (1) with moments that depend on q, u, t and a parameter."""
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
    """Equations (1) and (2): M V' + Omega x M V = F beside Euler's, in one 6-frame."""
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
    """Whether the rates are those of a problem of motion/, exactly."""
    system = problem.equations().system
    letters = {s.name: s for s in (*equations.frame.coordinates, *equations.velocities)}
    compared = 0
    for name, products in zip(system.states, system.rates, strict=True):
        rate = sum(c.sympy * sp.prod([letters[n] for n in names]) for c, names in products)
        assert sp.simplify(rate - equations.rates[name]) == 0, name
        compared += 1
    return compared >= equations.frame.dimension
