"""Developments: rows as motions, products over arcs and turns, agree with the library and laws."""

import pytest
import sympy as sp
from flint import arb, arb_mat

import geomtorsion as gt
from geomtorsion.proofs import developments
from geomtorsion.support.precision import ball_precision

S2 = gt.spaces.load("s2").frame
SPHERE = gt.levi_civita(S2)
CAP = gt.Loop.circle([1.0, 0.5], 0.2)


def matrix(proof):
    """[[rotation, burgers], [0, 1]] of a proof in two dimensions."""
    b1, b2, *rotation = proof.balls
    return arb_mat([[*rotation[:2], b1], [*rotation[2:], b2], [0, 0, 1]])


def proved(connection, loop, digits=20, **parameters):
    """The proof of a development."""
    return gt.prove(gt.develop(connection, loop, parameters=parameters), digits)


@pytest.mark.parametrize(
    "loop",
    [
        CAP,
        gt.Loop.circle([1.0, 0.5], 1e-7),
        gt.Loop.plaquette([1, 0], (0.5, 0.25)),
        gt.Loop.polygon([[1, 0], [1.3, 0.1], [1.1, 0.4]]),
        gt.Loop.spline([[1, 0], [1.3, 0.1], [1.1, 0.4], [0.9, 0.2]]),
        gt.Loop.parametric(["1 + cos(s)/5", "sin(2*s)/5"], interval=(0, "2*pi")),
        gt.Loop.parametric(["1 + cos(s)/5", "s"], interval=(0, "2*pi"), periods={1: "2*pi"}),
        CAP.times(2),
        CAP.reversed(),
    ],
    ids=lambda loop: loop.name,
)
def test_errors_hold_on_a_sphere(loop):
    """Errors hold for every kind of arc, several turns, backwards, and around the axis."""
    proof = proved(SPHERE, loop, R=1)
    assert proof.holds
    with ball_precision(200):
        # Parallel transport keeps lengths, so this is a rotation.
        _, _, a, b, c, d = proof.balls
        assert (a * d - b * c).contains(1)
        assert (a * a + c * c).contains(1)


def test_a_loop_and_its_reverse_are_the_identity():
    """The product of both contains the identity, and so does the loop followed by its reverse."""
    with ball_precision(200):
        both = matrix(proved(SPHERE, CAP, R=1)) * matrix(proved(SPHERE, CAP.reversed(), R=1))
        fro = matrix(proved(SPHERE, CAP.then(CAP.reversed()), R=1))
        for found in (both, fro):
            for i in range(3):
                for j in range(3):
                    assert found[i, j].contains(int(i == j))


def test_turns_multiply():
    """Two turns are the square of one."""
    with ball_precision(200):
        once, twice = (matrix(proved(SPHERE, loop, R=1)) for loop in (CAP, CAP.times(2)))
        square = once * once
        assert all(square[i, j].overlaps(twice[i, j]) for i in range(3) for j in range(3))


def test_the_angle_is_the_area():
    """A circle of latitude rotates vectors by the area of its cap, 2 pi (1 - cos theta)."""
    loop = gt.Loop.parametric(["1", "s"], interval=(0, "2*pi"), periods={1: "2*pi"})
    with ball_precision(200):
        found = matrix(proved(SPHERE, loop, R=1))
        area = 2 * arb.pi() * (1 - arb(1).cos())
        assert found[0, 0].overlaps(area.cos())
        assert abs(found[1, 0]).overlaps(abs(area.sin()))


def test_legs_that_turn_in_a_period():
    """Legs of the plane that turn by phi/3 have turned by a third after a circle: b = 0, R = 1."""
    r, phi = sp.symbols("r phi", real=True)
    c, s = sp.cos(phi / 3), sp.sin(phi / 3)
    plane = gt.levi_civita(gt.Frame([r, phi], [[c, r * s], [-s, r * c]]))
    loop = gt.Loop.parametric(["1", "s"], interval=(0, "2*pi"), periods={1: "2*pi"})
    proof = proved(plane, loop)
    for ball, exact in zip(proof.balls, [0, 0, 1, 0, 0, 1], strict=True):
        assert ball.contains(exact)
        assert ball.rad() < 1e-18


def test_a_connection_with_torsion_and_curvature():
    """The library's error holds for a connection that is neither flat nor torsion-free."""
    so3 = gt.spaces.load("so3").frame
    half = gt.blend(gt.cartan(so3), gt.levi_civita(so3), sp.Rational(1, 3))
    proof = gt.prove(gt.develop(half, gt.Loop.circle([0.3, 1, 0.2], 0.1)))
    assert proof.holds
    assert len(proof.balls) == 12


def test_rows_that_miss_a_term_would_be_seen(monkeypatch):
    """Without the connection in the rates the errors do not hold."""
    theta, phi = sp.symbols("theta phi", real=True)

    def turn():
        frame = gt.Frame([theta, phi], [[1, 0], [0, sp.sin(theta)]])
        return gt.develop(gt.levi_civita(frame), CAP)

    assert gt.prove(turn()).holds
    plain = developments._rates
    monkeypatch.setattr(developments, "_rates", lambda frame, _: plain(frame, gt.cartan(frame)))
    assert gt.prove(turn()).holds is False
