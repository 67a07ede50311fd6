"""The charts of the rotation group: each coframe is the angular velocity of its attitude matrix."""

import pytest
import sympy as sp

from geomtorsion.spaces import load, names

AXES = {"x": 0, "y": 1, "z": 2}


def turn(axis: str, angle: sp.Expr) -> sp.Matrix:
    """Rotation about a coordinate axis, right-handed."""
    k = AXES[axis]
    i, j = (k + 1) % 3, (k + 2) % 3
    matrix = sp.eye(3)
    matrix[i, i] = matrix[j, j] = sp.cos(angle)
    matrix[i, j], matrix[j, i] = -sp.sin(angle), sp.sin(angle)
    return matrix


def cross(v: sp.Matrix) -> sp.Matrix:
    """Matrix of v x."""
    return sp.Matrix([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def quaternion(q0: sp.Expr, v: sp.Matrix) -> sp.Matrix:
    """Rotation by a quaternion of any length."""
    square = v.dot(v)
    rotation = (q0**2 - square) * sp.eye(3) + 2 * v * v.T + 2 * q0 * cross(v)
    return rotation / (q0**2 + square)


def attitude(name: str, q: tuple[sp.Symbol, ...]) -> sp.Matrix:
    """Attitude matrix, body to space, in the chart of this name."""
    sequences = {
        "so3": "z2 y1 z0", "so3_right": "z2 y1 z0", "r3xso3": "z2 y1 z0",
        "so3_zxz": "z0 x1 z2", "so3_xyz": "x0 y1 z2", "so3_zyx": "z0 y1 x2",
    }  # fmt: skip
    if name in sequences:
        matrix = sp.eye(3)
        for axis, place in sequences[name].split():
            matrix = matrix * turn(axis, q[int(place)])
        return matrix
    if name == "so3_quaternion":
        v = sp.Matrix(q)
        return quaternion(sp.sqrt(1 - v.dot(v)), v)
    if name == "so3_rodrigues":
        return quaternion(sp.Integer(1), sp.Matrix(q))
    chi, theta, phi = q
    axis = [sp.sin(theta) * sp.cos(phi), sp.sin(theta) * sp.sin(phi), sp.cos(theta)]
    return quaternion(sp.cos(chi / 2), sp.sin(chi / 2) * sp.Matrix(axis))


@pytest.mark.parametrize("name", [n for n in names() if n.startswith("so3") or n == "r3xso3"])
def test_coframe_is_the_angular_velocity(name: str) -> None:
    """R^T dR (body) or dR R^T (space) agrees with the coframe at a point."""
    frame = load(name).frame
    q = frame.coordinates[:3]
    rotation = attitude(name, q)
    # Floating point on both sides; entries are of order one.
    point = {symbol: sp.Float(0.3 + 0.2 * k, 30) for k, symbol in enumerate(q)}
    here = rotation.subs(point)
    for column, symbol in enumerate(q):
        change = rotation.diff(symbol).subs(point)
        spin = change * here.T if name == "so3_right" else here.T * change
        velocity = (spin[2, 1], spin[0, 2], spin[1, 0])
        for row in range(3):
            entry = frame.coframe[row, column].subs(point)
            assert abs(sp.N(velocity[row] - entry, 20)) < 1e-15, (row, column)
    if name == "r3xso3":
        for row in range(3):
            for column in range(3):
                entry = frame.coframe[3 + row, 3 + column].subs(point)
                assert abs(sp.N(here[column, row] - entry, 20)) < 1e-15, (row, column)
