"""Body: a mass with an inertia that some rigid body can have."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import sympy as sp

from geomtorsion.errors import BodyError, SceneError
from geomtorsion.exact.units import in_unit
from geomtorsion.ode.numbers import mpf
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import short_repr
from geomtorsion.support.precision import CALCULATED, EXACT_BITS, working_precision

# A number as users give it: exact ones stay exact. An expression may also be text.
Number = float | Fraction | sp.Expr | str
Expression = Number | str


@dataclass(frozen=True)
class Body:
    """Mass and moments of inertia of a rigid body about its centre of mass.

    mass: kg.
    moments: principal moments of inertia about the body axes 1, 2, 3 (kg m^2).
    inertia: instead of `moments`, the tensor in body axes, 3 x 3 (kg m^2), symmetric.

    Numbers may be texts with a unit, such as "200 g".

    Raises
    ------
    BodyError
        mass or a moment is not positive, the tensor is not symmetric, or a moment is larger than
        the sum of the other two.

    Examples
    --------
    >>> Body(mass=1.0, moments=(1, 2, 3)).tensor.tolist()
    [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]]
    >>> Body.box(12.0, (1, 2, 3)).moments
    (13.0, 10.0, 5.0)
    >>> Body(mass="200 g", moments=("5 g m^2", "5 g m^2", "8 g m^2")).moments
    (0.005, 0.005, 0.008)
    >>> Body(mass=1.0, moments=(1, 2, -4))
    Traceback (most recent call last):
    geomtorsion.errors.BodyError: moments[2]: expected a positive number (kg m^2), got -4.
    """

    mass: Number = 1.0
    moments: Sequence[Number] | None = None
    inertia: Sequence[Sequence[Number]] | np.ndarray | None = None

    __repr__ = short_repr

    def __post_init__(self) -> None:
        """Check, and keep tuples."""
        for key, unit in (("mass", "kg"), ("moments", "kg m^2"), ("inertia", "kg m^2")):
            object.__setattr__(self, key, in_unit(getattr(self, key), unit, key, BodyError))
        positive(self.mass, "mass", "kg")
        if (self.moments is None) == (self.inertia is None):
            phrase = "neither" if self.moments is None else "both"
            raise BodyError(
                f"body: expected either moments=(I1, I2, I3) or inertia=3 x 3, got {phrase}."
            )
        if self.moments is not None:
            object.__setattr__(self, "moments", checked_moments(self.moments))
        else:
            object.__setattr__(self, "inertia", checked_tensor(self.inertia))

    @classmethod
    def box(cls, mass: Number, sides: Sequence[Number]) -> Body:
        """A homogeneous box; sides along the body axes, m.

        Examples
        --------
        >>> Body.box(3.0, (2, 2, 2)).moments
        (2.0, 2.0, 2.0)
        """
        mass, sides = _in_units(mass, sides=sides)
        return cls(positive(mass, "mass", "kg"), box_moments(mass, sides))

    @classmethod
    def ellipsoid(cls, mass: Number, semiaxes: Sequence[Number]) -> Body:
        """A homogeneous ellipsoid; semiaxes along the body axes, m.

        Examples
        --------
        >>> Body.ellipsoid(5.0, (1, 1, 1)).moments
        (2.0, 2.0, 2.0)
        """
        mass, semiaxes = _in_units(mass, semiaxes=semiaxes)
        return cls(positive(mass, "mass", "kg"), ellipsoid_moments(mass, semiaxes))

    @classmethod
    def cylinder(cls, mass: Number, radius: Number, height: Number) -> Body:
        """A homogeneous cylinder about the third body axis; height 0 is a disc; m.

        Examples
        --------
        >>> Body.cylinder(4.0, 1.0, 0.0).moments
        (1.0, 1.0, 2.0)
        """
        mass, radius, height = _in_units(mass, radius=radius, height=height)
        return cls(positive(mass, "mass", "kg"), cylinder_moments(mass, radius, height))

    @classmethod
    def points(cls, masses: Iterable[tuple[Number, Sequence[Number]]]) -> Body:
        """Point masses (kg) at positions (m) in axes parallel to the body axes, from any origin.

        Examples
        --------
        >>> Body.points([(1.0, (1, 0, 0)), (1.0, (-1, 0, 0)), (1.0, (0, 1, 0)), \
(1.0, (0, -1, 0))]).tensor.tolist()
        [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 4.0]]
        """
        mass, tensor, _ = point_masses(masses)
        return cls(mass, inertia=tensor)

    @cached_property
    def exact_tensor(self) -> tuple[tuple[sp.Expr, ...], ...]:
        """The inertia tensor as exact numbers (sympy), 3 x 3, kg m^2."""
        if self.moments is not None:
            values = [exact(v, f"moments[{k}]") for k, v in enumerate(self.moments)]
            return tuple(map(tuple, sp.diag(*values).tolist()))
        return tuple(
            tuple(exact(v, f"inertia[{i}][{j}]") for j, v in enumerate(row))
            for i, row in enumerate(self.inertia if self.inertia is not None else ())
        )

    @cached_property
    def tensor(self) -> np.ndarray:
        """The inertia tensor about the centre of mass, body axes, shape (3, 3), kg m^2."""
        return np.array([[float(v) for v in row] for row in self.exact_tensor])

    @cached_property
    def principal_moments(self) -> np.ndarray:
        """Principal moments of inertia in rising order, shape (3,), kg m^2."""
        return principal(self.tensor)[0]

    @cached_property
    def principal_axes(self) -> np.ndarray:
        """Principal axes as columns, in the order of the moments: a rotation, shape (3, 3)."""
        return principal(self.tensor)[1]

    def in_principal_axes(
        self, vector: Sequence[Number]
    ) -> tuple[tuple[Number, ...], tuple[Number, ...], np.ndarray]:
        """Principal moments and a vector in principal axes, to many digits, and these axes.

        Axes as columns, shape (3, 3). A diagonal tensor keeps its axes and exact numbers; otherwise
        all numbers have EXACT_BITS bits, and those that differ by rounding only are equal.
        """
        rows = self.exact_tensor
        if not any(rows[i][j] != 0 for i in range(3) for j in range(3) if i != j):
            return tuple(rows[k][k] for k in range(3)), tuple(vector), np.eye(3)
        with working_precision(EXACT_BITS):
            least = mpmath.ldexp(1, -EXACT_BITS + EXACT_BITS // 8)
            matrix = mpmath.matrix([[mpf(x, EXACT_BITS) for x in row] for row in rows])
            moments, axes = mpmath.eigsy(matrix)
            if mpmath.det(axes) < 0:
                axes[:, 2] = -axes[:, 2]
            for k in (1, 2):
                if moments[k] - moments[k - 1] <= least * moments[2]:
                    moments[k] = moments[k - 1]
            turned = axes.T * mpmath.matrix([mpf(x, EXACT_BITS) for x in vector])
            size = mpmath.norm(turned)
            parts = [x if abs(x) > least * size else mpmath.mpf(0) for x in turned]
            columns = np.array([[float(axes[i, j]) for j in range(3)] for i in range(3)])
            return tuple(moments), tuple(parts), columns

    @cached_property
    def symmetry_axis(self) -> np.ndarray | None:
        """Unit vector of the axis of symmetry, body axes; None if no two moments are equal.

        A body with three equal moments has the third axis.

        Examples
        --------
        >>> Body(moments=(2, 1, 2)).symmetry_axis.tolist()
        [0.0, 1.0, 0.0]
        """
        moments, axes = self.principal_moments, self.principal_axes
        close = np.abs(np.diff(moments)) <= 1e-14 * moments[2]
        if close.all():
            return np.array([0.0, 0.0, 1.0])
        if not close.any():
            return None
        # The axis of the moment that differs, with its largest component positive.
        axis = axes[:, 2 if close[0] else 0]
        return axis * np.sign(axis[np.abs(axis).argmax()])


def positive(value: Number, name: str, unit: str) -> Number:
    """A positive finite number, unchanged."""
    checks.positive(value, name, BodyError, expected=f"a positive number ({unit})")
    return value


def checked_moments(moments: object) -> tuple[Number, ...]:
    """Three principal moments that some body can have."""
    values = _positives(moments, "moments", "three principal moments of inertia", "kg m^2")
    check_triangle([float(v) for v in values], "moments")
    return values


def checked_tensor(inertia: Any) -> tuple[tuple[Number, ...], ...]:
    """A symmetric 3 x 3 tensor, positive, that some body can have."""
    nine = "3 rows of 3 numbers (kg m^2)"
    matrix = checks.array(inertia, "inertia", BodyError, shape=(3, 3), expected=nine)
    if np.abs(matrix - matrix.T).max() > CALCULATED * np.abs(matrix).max():
        i, j = np.unravel_index(int(np.abs(matrix - matrix.T).argmax()), (3, 3))
        raise BodyError(
            f"inertia: expected a symmetric matrix, got [{i}][{j}] = {matrix[i, j]:.6g} and "
            f"[{j}][{i}] = {matrix[j, i]:.6g}. Give the same value twice."
        )
    moments = np.linalg.eigvalsh(matrix)
    if moments[0] <= 0:
        raise BodyError(
            f"inertia: expected positive principal moments, got {_listed(moments)}. Products of "
            "inertia enter with a minus sign: I12 = -sum m x y."
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
            f"{what}: principal moments {_listed(moments)} are impossible, because "
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


def box_moments(mass: Number, sides: Sequence[Number]) -> tuple[float, ...]:
    """Moments of a homogeneous box: I1 = m (b^2 + c^2) / 12 and so on."""
    m, (a, b, c) = _exact(mass), _three(sides, "sides")
    return _plain(m * (b * b + c * c) / 12, m * (c * c + a * a) / 12, m * (a * a + b * b) / 12)


def ellipsoid_moments(mass: Number, semiaxes: Sequence[Number]) -> tuple[float, ...]:
    """Moments of a homogeneous ellipsoid: I1 = m (b^2 + c^2) / 5 and so on."""
    m, (a, b, c) = _exact(mass), _three(semiaxes, "semiaxes")
    return _plain(m * (b * b + c * c) / 5, m * (c * c + a * a) / 5, m * (a * a + b * b) / 5)


def cylinder_moments(mass: Number, radius: Number, height: Number) -> tuple[float, ...]:
    """Moments of a homogeneous cylinder about the third axis; height 0 is a disc."""
    m, r = _exact(mass), _exact(positive(radius, "radius", "m"))
    wanted = "a positive number (m), or 0 for a disc"
    checks.not_negative(height, "height", BodyError, expected=wanted)
    h = _exact(height)
    across = m * (3 * r * r + h * h) / 12
    return _plain(across, across, m * r * r / 2)


def point_masses(
    masses: Iterable[tuple[Number, Sequence[Number]]],
) -> tuple[float, tuple[tuple[float, ...], ...], tuple[float, ...]]:
    """Total mass, inertia tensor about the centre of mass, and that centre, of point masses."""
    try:
        listed = [(m, tuple(place)) for m, place in masses]
    except (TypeError, ValueError):
        raise BodyError(
            f"points: expected a list of (mass, (x, y, z)), in kg and m, got "
            f"{checks.shown(masses)}."
        ) from None
    if not listed:
        raise BodyError("points: expected at least one (mass, (x, y, z)), got none.")
    weights = [_exact(positive(m, f"mass {k}", "kg")) for k, (m, _) in enumerate(listed)]
    places = [
        [_exact(x) for x in checks.numbers(place, 3, f"place {k}", BodyError)]
        for k, (_, place) in enumerate(listed)
    ]
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
            "points: expected masses with three positive moments of inertia, got all on one line, "
            "whose moment is 0. Give the line a thickness, or the body moments=(I1, I2, I3)."
        )
    rows = tuple(_plain(*row) for row in tensor)
    return _plain(total)[0], rows, _plain(*centre)


def _on_a_line(tensor: list[list[Fraction]]) -> bool:
    """Whether the moment about some axis is 0, exactly."""
    (a, d, e), (_, b, f), (_, _, c) = tensor
    return a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e) == 0


def _three(values: Sequence[Number], name: str) -> list[Fraction]:
    """Three positive lengths."""
    return [_exact(value) for value in _positives(values, name, "three lengths", "m")]


def _positives(values: object, name: str, three: str, unit: str) -> tuple[Number, ...]:
    """Three positive numbers, unchanged."""
    numbers = checks.numbers(values, 3, name, BodyError, expected=f"{three} ({unit})")
    for k, value in enumerate(numbers):
        positive(value, f"{name}[{k}]", unit)
    return numbers


def _in_units(mass: Number, **lengths: Any) -> list[Any]:
    """A mass and lengths, texts read in kg and m."""
    read = [in_unit(value, "m", name, BodyError) for name, value in lengths.items()]
    return [in_unit(mass, "kg", "mass", BodyError), *read]


def _exact(value: Number) -> Fraction:
    """A number as a fraction, so that equal sides give equal moments."""
    return checks.fraction(value) or Fraction(float(value))


def _plain(*values: Fraction) -> tuple[float, ...]:
    """Moments, a row of a tensor or a place, as floats."""
    try:
        return tuple(float(v) for v in values)
    except OverflowError:
        raise BodyError(
            "body: expected masses and lengths whose moments of inertia fit into a float, below "
            "1.8e308, got larger ones. Use other units."
        ) from None


def _listed(values: Iterable[float]) -> str:
    return ", ".join(f"{float(v):.6g}" for v in values)


def exact(value: object, name: str) -> sp.Expr:
    """A finite number as an exact rational; roots and pi as they are.

    Raises
    ------
    SceneError
        It is not a finite real number.
    """
    return checks.rational(value, name, SceneError)
