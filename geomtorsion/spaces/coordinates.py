"""coordinates: spherical coordinates, lengths, and how near to its edge a chart is left."""

from __future__ import annotations

import sympy as sp

# Motions leave a chart of angles when the sine in its determinant falls below this.
MARGIN = 0.25
# So near to an axis its angles are left: by the sine of the colatitude, or in units of length.
AXIS = 0.1


def length(*values: sp.Expr) -> sp.Expr:
    """Euclidean length of a vector.

    Examples
    --------
    >>> length(*sp.symbols("x y"))
    sqrt(x**2 + y**2)
    """
    return sp.sqrt(sum(x**2 for x in values))


def spherical(r: sp.Expr, theta: sp.Expr, phi: sp.Expr) -> tuple[sp.Expr, ...]:
    """Cartesian coordinates of the point with spherical coordinates r, theta, phi.

    Examples
    --------
    >>> spherical(*sp.symbols("r theta phi"))[2]
    r*cos(theta)
    """
    return (
        r * sp.sin(theta) * sp.cos(phi),
        r * sp.sin(theta) * sp.sin(phi),
        r * sp.cos(theta),
    )
