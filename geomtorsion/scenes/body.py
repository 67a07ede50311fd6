"""Body: a mass with an inertia that some rigid body can have."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp

from geomtorsion.errors import BodyError
from geomtorsion.scenes import inertia as shapes
from geomtorsion.scenes.context import Number, exact


@dataclass(frozen=True)
class Body:
    """A rigid body: how heavy it is and how it resists turning, about its centre of mass.

    mass: kg.
    moments: principal moments of inertia about the body axes 1, 2, 3 (kg m^2); or
    inertia: the whole tensor in body axes, 3 x 3 (kg m^2), symmetric.

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
    >>> Body(mass=1.0, moments=(1, 2, -4))
    Traceback (most recent call last):
    geomtorsion.errors.BodyError: moments[2] = -4: a positive number (kg m^2) was needed.
    """

    mass: Number = 1.0
    moments: Sequence[Number] | None = None
    inertia: Sequence[Sequence[Number]] | np.ndarray | None = None

    def __post_init__(self) -> None:
        """Check, and keep tuples."""
        shapes.positive(self.mass, "mass", "kg")
        if (self.moments is None) == (self.inertia is None):
            given = "neither was" if self.moments is None else "both were"
            raise BodyError(f"a body has moments=(I1, I2, I3) or inertia=3 x 3; {given} given.")
        if self.moments is not None:
            object.__setattr__(self, "moments", shapes.checked_moments(self.moments))
        else:
            object.__setattr__(self, "inertia", shapes.checked_tensor(self.inertia))

    @classmethod
    def box(cls, mass: Number, sides: Sequence[Number]) -> Body:
        """A homogeneous box; sides along the body axes, m.

        Examples
        --------
        >>> Body.box(3.0, (2, 2, 2)).moments
        (2.0, 2.0, 2.0)
        """
        return cls(shapes.positive(mass, "mass", "kg"), shapes.box(mass, sides))

    @classmethod
    def ellipsoid(cls, mass: Number, semiaxes: Sequence[Number]) -> Body:
        """A homogeneous ellipsoid; semiaxes along the body axes, m.

        Examples
        --------
        >>> Body.ellipsoid(5.0, (1, 1, 1)).moments
        (2.0, 2.0, 2.0)
        """
        return cls(shapes.positive(mass, "mass", "kg"), shapes.ellipsoid(mass, semiaxes))

    @classmethod
    def cylinder(cls, mass: Number, radius: Number, height: Number) -> Body:
        """A homogeneous cylinder about the third body axis; height 0 is a disc; m.

        Examples
        --------
        >>> Body.cylinder(4.0, 1.0, 0.0).moments
        (1.0, 1.0, 2.0)
        """
        return cls(shapes.positive(mass, "mass", "kg"), shapes.cylinder(mass, radius, height))

    @classmethod
    def points(cls, masses: Iterable[tuple[Number, Sequence[Number]]]) -> Body:
        """Point masses (kg) at places (m) in axes parallel to the body's; any origin will do.

        Examples
        --------
        >>> Body.points([(1.0, (1, 0, 0)), (1.0, (-1, 0, 0)), (1.0, (0, 1, 0)), \
(1.0, (0, -1, 0))]).tensor.tolist()
        [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 4.0]]
        """
        mass, tensor, _ = shapes.points(masses)
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
        return shapes.principal(self.tensor)[0]

    @cached_property
    def principal_axes(self) -> np.ndarray:
        """Principal axes as columns, in the order of the moments: a rotation, shape (3, 3)."""
        return shapes.principal(self.tensor)[1]

    @cached_property
    def symmetry_axis(self) -> np.ndarray | None:
        """Unit vector of the axis of symmetry, body axes; None where two moments never agree.

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
