"""Kustaanheimo and Stiefel: the frame of their map, its torsion and its motions."""

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt

SPACE = gt.spaces.load("kustaanheimo_stiefel")
FRAME = SPACE.frame
CARTAN = gt.cartan(FRAME)
U = FRAME.coordinates
START = [1.0, 0.2, 0.4, -0.3]
R = sum(u**2 for u in U)


def place(u: tuple[sp.Symbol, ...]) -> list[sp.Expr]:
    """x, y, z with spinors: x^i = z* sigma^i z for z = (q1 + i q2, q3 + i q4)."""
    z = sp.Matrix([u[0] + sp.I * u[1], u[2] + sp.I * u[3]])
    pauli = ([[0, 1], [1, 0]], [[0, -sp.I], [sp.I, 0]], [[1, 0], [0, -1]])
    return [sp.expand((z.H * sp.Matrix(sigma) * z)[0]) for sigma in pauli]


def places(curve: gt.ode.Solution) -> np.ndarray:
    """Points in space along a curve."""
    assert SPACE.embedding is not None
    return SPACE.embedding(FRAME).places(curve.coordinates, {})


def test_three_forms_are_the_differentials_of_a_point_in_space() -> None:
    """The embedding is the map by Pauli matrices, and |x| = q^2."""
    assert SPACE.embedding is not None
    shown = SPACE.embedding(FRAME).place
    assert [sp.expand(a - b) for a, b in zip(shown, place(U), strict=True)] == [0, 0, 0]
    assert sp.expand(sum(x**2 for x in shown) - R**2) == 0
    for i, x in enumerate(shown):
        for k, u in enumerate(U):
            assert sp.expand(x.diff(u) - FRAME.coframe[i, k]) == 0


def test_only_the_fourth_form_has_torsion() -> None:
    """The fourth form is not closed: T^4 = -4 (dq1 ^ dq2 + dq3 ^ dq4)."""
    assert all(CARTAN.torsion_form(k).is_zero for k in range(3))
    assert str(CARTAN.torsion_form(3)) == "-4 dq1 ^ dq2 - 4 dq3 ^ dq4"


def test_autoparallels_are_straight_lines_in_space() -> None:
    """With the fourth velocity zero a point moves straight; geodesics agree, as no torsion acts."""
    speed = [0.3, -0.2, 0.5, 0.0]
    straight = gt.solve(gt.autoparallel(CARTAN, START, frame_velocity=speed), 2.0, 1e-12)
    points = places(straight)
    expected = points[0] + np.outer(straight.times, speed[:3])
    assert np.abs(points - expected).max() < 1e-12
    short = gt.solve(gt.geodesic(FRAME, START, frame_velocity=speed), 2.0, 1e-12)
    assert np.abs(places(short)[-1] - expected[-1]).max() < 1e-11


def test_torsion_acts_with_the_fourth_velocity() -> None:
    """With a fourth velocity autoparallels stay straight and geodesics do not."""
    speed = [0.3, -0.2, 0.5, 0.7]
    straight, short = (
        places(gt.solve(problem, 1.0, 1e-11))[-1]
        for problem in (
            gt.autoparallel(CARTAN, START, frame_velocity=speed),
            gt.geodesic(FRAME, START, frame_velocity=speed),
        )
    )
    begin = [float(x.subs(dict(zip(U, START, strict=True)))) for x in place(U)]
    assert straight == pytest.approx(np.add(begin, speed[:3]), abs=1e-10)
    assert np.abs(short - straight).max() > 0.01


def test_the_laplacian_with_torsion_is_the_flat_one_over_4_r() -> None:
    """g^ab D_a D_b f = (sum of d_a d_a f) / (4 r); without torsion a drift is added."""
    f = U[0] ** 3 * U[1] + U[2] ** 2 * U[3]
    flat = sum(f.diff(u, 2) for u in U) / (4 * R)
    scalar = FRAME.scalar(f)
    assert sp.simplify(CARTAN.laplacian(scalar)[()] - flat) == 0
    drift = sum(2 * u * f.diff(u) for u in U) / (4 * R**2)
    assert sp.simplify(gt.levi_civita(FRAME).laplacian(scalar)[()] - flat - drift) == 0
