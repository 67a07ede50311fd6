"""SE(3): exponential, logarithm and adjoint agree with matrices of mpmath with 50 digits."""

import mpmath
import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.rigid import attitude, se3
from tests.rounding import ROUNDED

EPS = np.finfo(float).eps
RNG = np.random.default_rng(11)
AXES = RNG.normal(size=(6, 3))
ANGLES = (0.0, 1e-300, 1e-12, 1e-5, 0.3, 2.0, 3.1415926, np.pi - 1e-9)


def twist_of(axis, angle, v):
    """(omega, v) of an axis of any length."""
    return np.array([*(axis / np.linalg.norm(axis) * angle), *v])


def expm(twist):
    """exp of the 4 x 4 matrix of a twist, with 50 digits."""
    with mpmath.workdps(50):
        x, y, z, *v = map(mpmath.mpf, twist)
        rows = [[0, -z, y, v[0]], [z, 0, -x, v[1]], [-y, x, 0, v[2]], [0, 0, 0, 0]]
        found = mpmath.expm(mpmath.matrix(rows), method="taylor")
        return np.array(found.tolist(), dtype=float)


@pytest.mark.parametrize("angle", ANGLES)
def test_exponential_and_logarithm(angle):
    """A screw agrees with 50 digits, and its twist is restored, near pi as well."""
    for axis in AXES:
        v = RNG.normal(size=3)
        twist = twist_of(axis, angle, v)
        found = se3.exp(twist)
        assert np.abs(found - expm(twist)).max() < 30 * EPS
        back = se3.log(found)
        # A pose near half a turn is known to a rounding error, and so is its twist.
        assert np.abs(back - twist).max() < 60 * EPS
        # Tiny rotations keep their relative accuracy.
        assert np.abs(back[:3] - twist[:3]).max() <= 30 * EPS * angle


def test_two_turns_give_the_shortest():
    """log returns the rotation vector of at most half a turn that gives the same pose."""
    twist = twist_of(AXES[0], 5.0, [1, 2, 3])
    back = se3.log(se3.exp(twist))
    assert np.linalg.norm(back[:3]) == pytest.approx(2 * np.pi - 5, rel=ROUNDED)
    assert np.abs(se3.exp(back) - se3.exp(twist)).max() < 30 * EPS


def test_adjoint():
    """g exp(xi) g^-1 = exp(Ad_g xi), and Ad of a product is the product of both."""
    g, h = (se3.exp(RNG.normal(size=6)) for _ in range(2))
    xi = RNG.normal(size=6)
    moved = g @ se3.exp(xi) @ np.linalg.inv(g)
    assert np.abs(se3.exp(se3.adjoint(g) @ xi) - moved).max() < 100 * EPS
    assert np.abs(se3.adjoint(g @ h) - se3.adjoint(g) @ se3.adjoint(h)).max() < 100 * EPS


def test_any_leading_shape():
    """Arrays of twists and poses give the results of their elements."""
    twists = RNG.normal(size=(2, 3, 6))
    poses = se3.exp(twists)
    assert poses.shape == (2, 3, 4, 4)
    assert (se3.log(poses)[1, 2] == se3.log(poses[1, 2])).all()
    assert (se3.adjoint(poses)[0, 1] == se3.adjoint(poses[0, 1])).all()
    assert (se3.pose(poses[..., :3, :3], poses[..., :3, 3]) == poses).all()


def test_screw_of_the_shipped_frame():
    """The 6-frame of the paper orders a twist the same way: its autoparallel is exp(t xi)."""
    twist = np.array([0.3, -0.5, 0.7, 1.0, 0.2, -0.4])
    frame = gt.spaces.load("r3xso3").frame
    start = [0.4, 1.0, -0.3, 0.1, 0.2, 0.3]
    curve = gt.solve(gt.autoparallel(gt.cartan(frame), start, frame_velocity=twist), 1.5)

    def pose(q):
        return se3.pose(
            attitude.matrix_from_quaternion(attitude.quaternion_from_euler(q[:3])), q[3:]
        )

    expected = pose(start) @ se3.exp(1.5 * twist)
    end = curve.coordinates[-1]
    turned = attitude.matrix_from_quaternion(attitude.quaternion_from_euler(end[:3]))
    assert np.abs(turned - expected[:3, :3]).max() < 1e-8
