"""Inertia: tensors that a body can have, their principal axes, and those of simple shapes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from geomtorsion import checks
from geomtorsion.errors import BodyError
from geomtorsion.precision import CALCULATED
from geomtorsion.scenes.context import Number


def positive(value: Number, name: str, unit: str) -> Number:
    """A positive finite number, as it came."""
    needed = f"{{subject}} = {{value}}: a positive number ({unit}) was needed."
    none = f"{{subject}} = {{value}} is no number; give it in {unit}."
    checks.positive(value, name, BodyError, message=needed, number_message=none, infinite=needed)
    return value


def checked_moments(moments: object) -> tuple[Number, ...]:
    """Three principal moments that some body can have."""
    values = _positives(moments, "moments", "three principal moments of inertia", "kg m^2")
    check_triangle([float(v) for v in values], "moments")
    return values


def checked_tensor(inertia: Any) -> tuple[tuple[Number, ...], ...]:
    """A symmetric 3 x 3 tensor, positive, that some body can have."""
    nine = "{subject} = {value}: 3 rows of 3 numbers (kg m^2) were needed."
    matrix = checks.array(
        inertia, "inertia", BodyError, shape=(3, 3), message=nine, shaped=nine, infinite=None
    )
    if not np.isfinite(matrix).all():
        raise BodyError(f"inertia contains a number that is not finite: {matrix.tolist()}.")
    if np.abs(matrix - matrix.T).max() > CALCULATED * np.abs(matrix).max():
        i, j = np.unravel_index(int(np.abs(matrix - matrix.T).argmax()), (3, 3))
        raise BodyError(
            f"inertia is not symmetric: [{i}][{j}] = {matrix[i, j]:.6g}, "
            f"[{j}][{i}] = {matrix[j, i]:.6g}. Give the same value twice."
        )
    moments = np.linalg.eigvalsh(matrix)
    if moments[0] <= 0:
        raise BodyError(
            f"inertia has the principal moments {_listed(moments)}: all must be positive. "
            "Products of inertia enter with a minus sign: I12 = -sum m x y."
        )
    check_triangle(moments.tolist(), "inertia")
    rows = [list(row) for row in inertia]
    # One of two values that differ by rounding is as good as the other: the upper one is kept.
    return tuple(tuple(rows[min(i, j)][max(i, j)] for j in range(3)) for i in range(3))


def check_triangle(moments: Sequence[float], what: str) -> None:
    """The largest moment is at most the sum of the others: I1 + I2 - I3 = 2 sum m z^2 >= 0."""
    small, middle, large = sorted(moments)
    # A plate has A + B = C, and rounding may leave it a little on the wrong side.
    if large > (small + middle) + CALCULATED * large:
        raise BodyError(
            f"{what}: principal moments {_listed(moments)} are impossible, for "
            f"{large:.6g} > {small:.6g} + {middle:.6g}. No distribution of mass has them; "
            "the largest may be at most the sum of the other two."
        )


def principal(tensor: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Principal moments, rising, and their axes as columns of a rotation matrix.

    A tensor that is diagonal already keeps its axes (in the order of rising moments).
    """
    matrix = tensor
    if np.count_nonzero(matrix - np.diag(np.diagonal(matrix))) == 0:
        order = np.argsort(np.diagonal(matrix), kind="stable")
        moments, axes = np.diagonal(matrix)[order], np.eye(3)[:, order]
    else:
        moments, axes = np.linalg.eigh(matrix)
    # A reflection turned into a rotation, for axes are to be right-handed.
    if np.linalg.det(axes) < 0:
        axes = axes * np.array([1.0, 1.0, -1.0])
    return moments, axes


def box(mass: Number, sides: Sequence[Number]) -> tuple[float, ...]:
    """Moments of a homogeneous box: I1 = m (b^2 + c^2) / 12 and so on."""
    m, (a, b, c) = _exact(mass), _three(sides, "sides")
    return _plain(m * (b * b + c * c) / 12, m * (c * c + a * a) / 12, m * (a * a + b * b) / 12)


def ellipsoid(mass: Number, semiaxes: Sequence[Number]) -> tuple[float, ...]:
    """Moments of a homogeneous ellipsoid: I1 = m (b^2 + c^2) / 5 and so on."""
    m, (a, b, c) = _exact(mass), _three(semiaxes, "semiaxes")
    return _plain(m * (b * b + c * c) / 5, m * (c * c + a * a) / 5, m * (a * a + b * b) / 5)


def cylinder(mass: Number, radius: Number, height: Number) -> tuple[float, ...]:
    """Moments of a homogeneous cylinder about the third axis; height 0 is a disc."""
    m, r = _exact(mass), _exact(positive(radius, "radius", "m"))
    size = checks.real(height)
    if size is None or not 0 <= size < math.inf:
        raise BodyError(f"height = {height!r}: a positive number (m), or 0 for a disc, was needed.")
    h = _exact(height)
    across = m * (3 * r * r + h * h) / 12
    return _plain(across, across, m * r * r / 2)


def points(
    masses: Iterable[tuple[Number, Sequence[Number]]],
) -> tuple[float, tuple[tuple[float, ...], ...], tuple[float, ...]]:
    """Total mass, inertia tensor about the centre of mass, and that centre, of point masses."""
    try:
        listed = [(m, tuple(place)) for m, place in masses]
    except (TypeError, ValueError):
        raise BodyError(
            f"points = {masses!r}: a list of (mass, (x, y, z)) was needed, kg and m."
        ) from None
    if not listed or any(len(place) != 3 for _, place in listed):
        raise BodyError("points: at least one (mass, (x, y, z)) was needed, each with 3 numbers.")
    weights = [_exact(positive(m, f"mass {k}", "kg")) for k, (m, _) in enumerate(listed)]
    wanted = "points: finite numbers were needed ({subject} = {value})."
    places = [
        [_exact(checks.exact_number(x, f"place {k}", BodyError, message=wanted, infinite=wanted))
         for x in place]
        for k, (_, place) in enumerate(listed)
    ]  # fmt: skip
    # In fractions, so that a plate or a line is recognised exactly.
    total = sum(weights, Fraction(0))
    centre = [sum((m * p[k] for m, p in zip(weights, places, strict=True)), Fraction(0)) / total
              for k in range(3)]  # fmt: skip
    tensor = [[Fraction(0)] * 3 for _ in range(3)]
    for m, place in zip(weights, places, strict=True):
        d = [x - c for x, c in zip(place, centre, strict=True)]
        square = sum(x * x for x in d)
        for i in range(3):
            for j in range(3):
                tensor[i][j] += m * ((square if i == j else 0) - d[i] * d[j])
    if _on_a_line(tensor):
        raise BodyError(
            "points: the masses lie on one line, about which nothing resists turning: all must be "
            "positive, but the moment about it is 0. Give the line a thickness, or the body "
            "moments=(I1, I2, I3)."
        )
    rows = tuple(_plain(*row) for row in tensor)
    return float(total), rows, _plain(*centre)


def _on_a_line(tensor: list[list[Fraction]]) -> bool:
    """Whether the moment about some axis is 0, exactly."""
    (a, d, e), (_, b, f), (_, _, c) = tensor
    return a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e) == 0


def _three(values: Sequence[Number], name: str) -> list[Fraction]:
    """Three positive lengths."""
    return [_exact(value) for value in _positives(values, name, "three lengths", "m")]


def _positives(values: object, name: str, three: str, unit: str) -> tuple[Number, ...]:
    """Three positive numbers, as they came."""
    needed = f"{{subject}} = {{value}}: {three} ({unit}) were needed."
    none = f"{{subject}} = {{value}} is no number; give it in {unit}."
    found = checks.numbers(
        values, 3, name, BodyError, listed=needed, counted=needed, message=none, infinite=none
    )
    for k, value in enumerate(found):
        positive(value, f"{name}[{k}]", unit)
    return found


def _exact(value: Number) -> Fraction:
    """A number as a fraction, so that equal sides give equal moments."""
    return checks.fraction(value) or Fraction(float(value))


def _plain(*values: Fraction) -> tuple[float, ...]:
    return tuple(float(v) for v in values)


def _listed(values: Iterable[float]) -> str:
    return ", ".join(f"{float(v):.6g}" for v in values)
