"""claims_frames: the frames of the paper, made from the attitude alone."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.cli.printed import PHI, c2, phi1, phi2, phi3, s2

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame

PLACE = sp.symbols("x1 x2 x3", real=True)


def attitude() -> sp.Matrix:
    """R = Rz(phi3) Ry(phi2) Rz(phi1), from the body to space."""

    def about_z(angle: sp.Expr) -> sp.Matrix:
        c, s = sp.cos(angle), sp.sin(angle)
        return sp.Matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])

    return about_z(phi3) * sp.Matrix([[c2, 0, s2], [0, 1, 0], [-s2, 0, c2]]) * about_z(phi1)


@cache
def rotations() -> Frame:
    """Section 2: row i, column mu holds the component i of (R^T dR/dphi^mu)^vee."""
    from geomtorsion.geometry import Frame

    turned = attitude()
    spins = [turned.T * turned.diff(angle) for angle in PHI]
    rows = [[spin[(i + 2) % 3, (i + 1) % 3] for spin in spins] for i in range(3)]
    return Frame(PHI, rows, domain=(phi2 > 0, phi2 < sp.pi), name="so3")


@cache
def motions() -> Frame:
    """Rotations and translations: the forms (dPhi, dX) in the coordinates (phi, x)."""
    from geomtorsion.geometry import Frame

    coframe = sp.diag(rotations().coframe.to_sympy().tomatrix(), attitude().T)
    return Frame((*PHI, *PLACE), coframe, domain=(phi2 > 0, phi2 < sp.pi), name="r3xso3")
