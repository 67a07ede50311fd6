"""Attitude: every convention agrees with multiplied matrices and scipy, at gimbal lock as well."""

import warnings

import mpmath
import numpy as np
import pytest
import sympy as sp
from scipy.spatial.transform import Rotation

from geomtorsion.errors import StartError
from geomtorsion.rigid import attitude as att
from tests.rounding import ROUNDED

ANGLES = np.random.default_rng(5).uniform(-3.1, 3.1, (40, 3))


def matrix_of(angles, name):
    """The matrix of Euler angles of a convention."""
    return att.matrix_from_quaternion(att.quaternion_from_euler(angles, name))


def turn(axis, angle):
    """The matrix of a rotation around one axis, written by hand."""
    c, s = np.cos(angle), np.sin(angle)
    matrix = np.eye(3)
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    matrix[i, i] = matrix[j, j] = c
    matrix[j, i], matrix[i, j] = s, -s
    return matrix


def test_the_papers_angles():
    """R = Rz(phi3) Ry(phi2) Rz(phi1), as in READING; "zyz" and "paper" name it."""
    for phi1, phi2, phi3 in ANGLES[:5]:
        expected = turn("z", phi3) @ turn("y", phi2) @ turn("z", phi1)
        for name in ("zyz", "paper"):
            assert np.allclose(matrix_of([phi1, phi2, phi3], name), expected, atol=ROUNDED)


@pytest.mark.parametrize("name", att.CONVENTIONS)
def test_all_conventions(name):
    """Angles give the multiplied matrix and scipy's matrix, and come back as equal attitudes."""
    assert len(set(att.CONVENTIONS)) == 24
    matrices = matrix_of(ANGLES, name)
    for angles, matrix in zip(ANGLES, matrices, strict=True):
        one, two, three = (turn(c, a) for c, a in zip(name.lower(), angles, strict=True))
        by_hand = three @ two @ one if name.islower() else one @ two @ three
        assert np.abs(matrix - by_hand).max() < ROUNDED
    assert np.abs(matrices - Rotation.from_euler(name, ANGLES).as_matrix()).max() < ROUNDED
    back = att.euler_from_quaternion(att.quaternion_from_matrix(matrices), name)
    assert np.abs(back - Rotation.from_matrix(matrices).as_euler(name)).max() < 1e-12
    assert np.abs(matrix_of(back, name) - matrices).max() < ROUNDED


@pytest.mark.parametrize("name", ["zyz", "ZXZ", "xyz", "ZYX"])
@pytest.mark.parametrize("gap", [0.0, 1e-300, 1e-17, 1e-12, 1e-8, 1e-3])
@pytest.mark.parametrize("side", [0, 1])
def test_near_the_lock(name, gap, side):
    """The middle angle keeps its relative accuracy, and the attitude is restored."""
    proper = name[0] == name[2]
    lock = side * np.pi if proper else (2 * side - 1) * np.pi / 2
    middle = lock + gap * (1 - 2 * side)
    angles = np.array([0.4, middle, 1.1])
    q = att.quaternion_from_euler(angles, name)
    back = att.euler_from_quaternion(q, name)
    assert np.abs(matrix_of(back, name) - matrix_of(angles, name)).max() < (ROUNDED)
    if proper and side == 0:
        assert back[1] == pytest.approx(gap, rel=ROUNDED, abs=0)
        if gap > 1e-13:
            assert np.allclose(back, angles, atol=ROUNDED / max(gap, 1e-2))


@pytest.mark.parametrize("name", att.CONVENTIONS)
@pytest.mark.parametrize("side", [0, 1])
def test_the_third_angle_is_0_at_the_lock(name, side):
    """At gimbal lock the first angle takes the whole rotation, as in scipy."""
    proper = name[0].lower() == name[2].lower()
    lock = side * np.pi if proper else (2 * side - 1) * np.pi / 2
    given = Rotation.from_euler(name, [0.4, lock, 1.1])
    first, middle, third = att.euler_from_quaternion(
        att.quaternion_from_matrix(given.as_matrix()), name
    )
    assert third == 0
    assert abs(middle - lock) < 1e-7
    back = Rotation.from_euler(name, [first, middle, third])
    assert np.abs(back.as_matrix() - given.as_matrix()).max() < 1e-7
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        expected = given.as_euler(name)
    assert said, "scipy sees no gimbal lock here"
    assert np.abs(np.exp(1j * expected) - np.exp(1j * np.array([first, middle, 0]))).max() < 1e-7


def test_where_an_angle_is_lost():
    """Halves of 2e-14 still keep an angle; halves of 0.5e-14 are taken for rounding."""
    for gap, kept in ((4e-14, True), (1e-14, False)):
        back = att.euler_from_quaternion(att.quaternion_from_euler([0.4, gap, 1.1]))
        assert np.allclose(back[[0, 2]], [0.4, 1.1] if kept else [1.5, 0.0], atol=1e-12)


def test_middle_angle_in_thirty_digits():
    """phi2 of a quaternion near the lock agrees with mpmath: an arc cosine would lose digits."""
    q = att.quaternion_from_euler([0.3, 1e-7, 0.2])
    with mpmath.workdps(40):
        w, x, y, z = (mpmath.mpf(float(v)) for v in q)
        true = 2 * mpmath.atan2(mpmath.hypot(x, y), mpmath.hypot(w, z))
    assert abs(float(att.euler_from_quaternion(q)[1] - true)) < 1e-22


def test_angles_continue_without_jumps():
    """A top spins ten turns: continuous angles count them, other angles do not."""
    spin = np.linspace(0, 20 * np.pi, 501)
    angles = np.stack([spin, 0.4 + 0 * spin, -0.5 * spin], -1)
    q = att.quaternion_from_euler(angles)
    assert np.abs(att.euler_from_quaternion(q, continuous=True) - angles).max() < 1e-12
    assert np.abs(att.euler_from_quaternion(q)).max() <= np.pi


def test_through_the_lock_in_a_series():
    """Samples exactly at the lock take the lost angle from their neighbours, not from rounding."""
    tilt = np.linspace(-0.2, 0.2, 5)
    q = att.quaternion_from_euler(np.stack([0.3 + 0 * tilt, tilt, 0.9 + 0 * tilt], -1))
    found = att.euler_from_quaternion(q)
    assert tilt[2] == 0
    assert np.allclose(found[2], found[1] * [1, 0, 1], atol=ROUNDED)


def test_quaternions_of_half_turns():
    """Where the scalar part vanishes each component can be the largest."""
    for axis in np.vstack([np.eye(3), np.ones(3) / np.sqrt(3)]):
        matrix = 2 * np.outer(axis, axis) - np.eye(3)
        q = att.quaternion_from_matrix(matrix)
        assert np.abs(att.matrix_from_quaternion(q) - matrix).max() < ROUNDED
        assert abs(np.linalg.norm(q) - 1) < ROUNDED
    many = Rotation.random(300, random_state=1)
    q = att.quaternion_from_matrix(many.as_matrix())
    assert np.abs(q - many.as_quat(canonical=True, scalar_first=True)).max() < ROUNDED


def test_products_and_turned_vectors():
    """A product rotates by the second factor, then the first; scipy agrees for arrays."""
    p, q = (Rotation.random(6, random_state=seed) for seed in (2, 3))
    left, right = (r.as_quat(scalar_first=True).reshape(2, 3, 4) for r in (p, q))
    expected = (p * q).as_matrix().reshape(2, 3, 3, 3)
    assert np.abs(att.matrix_from_quaternion(att.product(left, right)) - expected).max() < ROUNDED
    v = np.random.default_rng(4).normal(size=(2, 3, 3))
    assert np.abs(att.rotated(left, v) - p.apply(v.reshape(6, 3)).reshape(2, 3, 3)).max() < ROUNDED


def test_rotation_vectors():
    """Rotation vectors agree with scipy up to half a turn; tiny ones are right to the last bit."""
    many = Rotation.random(200, random_state=7)
    vectors = many.as_rotvec()
    q = att.quaternion_from_rotation_vector(vectors)
    assert np.abs(att.matrix_from_quaternion(q) - many.as_matrix()).max() < ROUNDED
    for size in (0.0, 1e-150, 1e-20, 1e-9):
        tiny = size * np.array([0.6, 0.0, -0.8])
        scalar, *axis = att.quaternion_from_rotation_vector(tiny)
        assert scalar == 1
        assert np.abs(np.array(axis) - tiny / 2).max() <= ROUNDED * size
    half = att.quaternion_from_rotation_vector(np.pi * np.array([0.6, 0, 0.8]))
    assert np.abs(half - [0, 0.6, 0, 0.8]).max() < ROUNDED


def test_rates_agree_with_the_matrix():
    """q' = q (0, Omega) / 2 in symbols gives R' = R [Omega]x and keeps the length."""
    q, omega = sp.symbols("q0:4"), sp.symbols("a b c")
    rates = att.quaternion_rates(q, omega)
    assert sp.expand(sum(x * rate for x, rate in zip(q, rates, strict=True))) == 0
    matrix = sp.Matrix(att.rotation_rows(q))
    change = sum((matrix.diff(x) * rate for x, rate in zip(q, rates, strict=True)), sp.zeros(3, 3))
    a, b, c = omega
    cross = sp.Matrix([[0, -c, b], [c, 0, -a], [-b, a, 0]])
    assert (change - matrix * cross).expand() == sp.zeros(3, 3)


def test_how_much_rounding_is_allowed():
    """Lengths and columns wrong by less than 1e-6 are corrected; larger errors are refused."""
    for excess, fine in ((0.9e-6, True), (1.1e-6, False)):
        for check, value in (
            (att.checked_quaternion, [1 + excess, 0, 0, 0]),
            (att.checked_matrix, np.diag([np.sqrt(1 + excess), 1, 1])),
        ):
            if fine:
                assert check(value).tolist() == [1, 0, 0, 0]
            else:
                with pytest.raises(StartError):
                    check(value)


def test_rounded_input_is_normalised():
    """Seven printed digits are accepted and give a rotation exact to the last digit."""
    q = att.checked_quaternion([0.7071068, 0, 0.7071068, 0])
    assert abs(np.linalg.norm(q) - 1) < ROUNDED
    matrix = np.round(matrix_of([0.1, 0.2, 0.3], "paper"), 7)
    r = att.matrix_from_quaternion(att.checked_matrix(matrix))
    assert np.abs(r.T @ r - np.eye(3)).max() < ROUNDED
    assert np.abs(r - matrix).max() < 1e-7


def exact_vector(q):
    """The rotation vector of a quaternion, with 50 digits."""
    with mpmath.workdps(50):
        w, *part = map(mpmath.mpf, q)
        if w < 0:
            w, part = -w, [-x for x in part]
        length = mpmath.sqrt(sum(x * x for x in part))
        angle = 2 * mpmath.atan2(length, w)
        return np.array([float(angle * x / length) for x in part])


@pytest.mark.parametrize(
    "scalar", [0.0, 1e-300, 1e-16, -1e-16, 1e-9, 0.1, -0.5, 1.0, 1e9, 1e160, -1e300]
)
@pytest.mark.parametrize("scale", [1.0, 1e-250, 1e5])
def test_rotation_vector_of_a_quaternion(scalar, scale):
    """The vector agrees with 50 digits, for any length, near 0 and near half a turn."""
    for part in np.random.default_rng(3).normal(size=(5, 3)):
        q = np.array([scalar, *part]) * scale
        expected = exact_vector(q)
        found = att.rotation_vector_from_quaternion(q)
        assert np.abs(found - expected).max() <= ROUNDED * np.abs(expected).max()


@pytest.mark.parametrize("gap", [0.0, 1e-15, 1e-12, 1e-9, 1e-7, 1e-4])
def test_rotation_vector_of_a_matrix_near_half_a_turn(gap):
    """A matrix rounded to doubles gives axis and angle to 1e-14; acos would lose half of this."""
    for axis in np.random.default_rng(4).normal(size=(8, 3)):
        with mpmath.workdps(50):
            n = mpmath.matrix([mpmath.mpf(x) for x in axis])
            n = n / mpmath.norm(n)
            angle = mpmath.pi - gap
            c, s = mpmath.cos(angle), mpmath.sin(angle)
            cross = mpmath.matrix([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
            exact = c * mpmath.eye(3) + s * cross + (1 - c) * n * n.T
            expected = np.array([float(angle * x) for x in n])
        found = att.rotation_vector_from_matrix(np.array(exact.tolist(), dtype=float))
        # Within a rounding of half a turn the two possible vectors cannot be distinguished.
        sign = np.sign(found @ expected) if gap < ROUNDED else 1.0
        assert np.abs(sign * found - expected).max() < ROUNDED


def test_rotation_vectors_go_through_quaternions_and_matrices():
    """Vectors shorter than half a turn are restored; arrays may have any leading shape."""
    vectors = np.random.default_rng(6).uniform(-1.8, 1.8, (4, 5, 3))
    q = att.quaternion_from_rotation_vector(vectors)
    assert np.abs(att.rotation_vector_from_quaternion(q) - vectors).max() < ROUNDED
    matrices = att.matrix_from_quaternion(q)
    assert np.abs(att.rotation_vector_from_matrix(matrices) - vectors).max() < ROUNDED
    assert (att.rotation_vector_from_quaternion([3, 0, 0, 0]) == 0).all()
    tiny = np.array([3e-200, -4e-200, 1e-310])
    matrix = att.matrix_from_quaternion(att.quaternion_from_rotation_vector(tiny))
    assert att.rotation_vector_from_matrix(matrix) == pytest.approx(tiny, rel=ROUNDED, abs=1e-320)
