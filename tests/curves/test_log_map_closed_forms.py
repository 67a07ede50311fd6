"""Logarithm map: lengths between random pairs of points agree with closed forms."""

import numpy as np
import pytest
import sympy as sp

from geomtorsion.curves import log_map
from geomtorsion.curves.atlas import atlas_of
from geomtorsion.geometry import Frame, levi_civita
from geomtorsion.spaces import load
from tests.chosen import few

U, V = sp.symbols("u v", real=True)
FULL, ACROSS = ([x > 0, sp.Lt(x, 2 * sp.pi)] for x in (U, V))
# Allowed relative error of a length: log_map hits the end to ten times its accuracy.
LENGTH = 1e-9


def angle_between(one, other):
    """Angle between unit vectors, with all digits near 0 and pi."""
    return 2 * np.arctan2(np.linalg.norm(one - other), np.linalg.norm(one + other))


def of_quaternions(name, is_double):
    """Random pairs of a space with a quaternion chart, and the angle between their quaternions."""
    frame = load(name).frame
    (back,) = atlas_of(frame).route("quaternion", name)

    def pair(rng):
        units = rng.normal(size=(2, 4))
        units /= np.linalg.norm(units, axis=1)[:, None]
        one, other = units
        half = angle_between(one, other)
        angle = 2 * min(half, np.pi - half) if is_double else half
        return back(one, {}), back(other, {}), angle

    return frame, {}, pair


def sphere():
    """Two points of a sphere of the size of the Earth in metres."""
    radius = 6.371e6

    def pair(rng):
        normals = rng.normal(size=(2, 3))
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        points = [(np.arccos(z), np.arctan2(y, x) % (2 * np.pi)) for x, y, z in normals]
        return *points, radius * angle_between(*normals)

    return load("s2").frame, {"R": radius}, pair


def half_plane(size):
    """Two points of the half plane, whose coframe is large where v is small."""
    height = sp.Symbol("v", positive=True)
    frame = Frame([U, height], sp.diag(1 / height, 1 / height))

    def pair(rng):
        one, other = ((size * rng.normal(), size * np.exp(rng.normal())) for _ in "12")
        square = (one[0] - other[0]) ** 2 + (one[1] - other[1]) ** 2
        return one, other, 2 * np.arcsinh(np.sqrt(square / (4 * one[1] * other[1])))

    return frame, {}, pair


def flat(eta, domain):
    """Two points of a plane rolled up over full turns of coordinates with a constant metric."""
    frame = Frame([U, V], sp.eye(2), signature=eta, domain=domain)
    matrix = np.array(frame.eta.to_sympy().tolist(), dtype=float)
    turns = np.arange(-12, 13) * 2 * np.pi
    across = turns if len(domain) > 2 else np.zeros(1)

    def pair(rng):
        one, other = rng.uniform(0, 2 * np.pi, (2, 2))
        images = [other - one + (x, y) for x in turns for y in across]
        return one, other, np.sqrt(min(image @ matrix @ image for image in images))

    return frame, {}, pair


TILTED = [[1, sp.Rational(9, 10)], [sp.Rational(9, 10), 1]]
CASES = {
    "sphere": sphere,
    "three-sphere": lambda: of_quaternions("s3", False),
    "rotations in Euler angles": lambda: of_quaternions("so3", True),
    "rotations in quaternions": lambda: of_quaternions("so3_quaternion", True),
    "rotations in Rodrigues vectors": lambda: of_quaternions("so3_rodrigues", True),
    "rotations by axis and angle": lambda: of_quaternions("so3_axis_angle", True),
    "half plane": lambda: half_plane(1.0),
    "small half plane": lambda: half_plane(1e-12),
    "oblique torus": lambda: flat(TILTED, [*FULL, *ACROSS]),
    "oblique cylinder": lambda: flat(TILTED, FULL),
}


def check_lengths(case, count):
    """Lengths and ends of `count` random pairs are right."""
    frame, parameters, pair = CASES[case]()
    connection, rng = levi_civita(frame), np.random.default_rng(31)
    for _ in range(count):
        start, end, length = pair(rng)
        found = log_map(connection, start, end, parameters=parameters)
        assert found.length == pytest.approx(length, rel=LENGTH), (start, end)
        assert found.miss <= LENGTH * length
        assert found.conjugate == ()
        assert found.guarantee.startswith("shortest of ")


@pytest.mark.parametrize("case", few(5, list(CASES)))
def test_lengths_between_a_few_random_points(case):
    """Four pairs in each space."""
    check_lengths(case, 4)


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_lengths_between_many_random_points(case):
    """Two hundred pairs in each space."""
    check_lengths(case, 200)
