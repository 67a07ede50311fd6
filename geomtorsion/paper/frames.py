"""frames: the two frames of the paper, made from only the attitude of the body."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from geomtorsion.geometry import Frame
from geomtorsion.paper.statement import PHI, c2, phi1, phi2, phi3, s2
from geomtorsion.support.caching import cached_property

POSITION = sp.symbols("x1 x2 x3", real=True)


@dataclass(frozen=True)
class PaperFrames:
    """The frames over which the equations of the paper are recomputed.

    rotations: forms dPhi over the angles phi.
    motions: forms (dPhi, dX) over (phi, x).
    """

    rotations: Frame
    motions: Frame

    @cached_property
    def spin_forms(self) -> sp.Matrix:
        """e^i_mu of the rotations."""
        return self.rotations.coframe.to_sympy().tomatrix()

    @cached_property
    def motion_forms(self) -> sp.Matrix:
        """The coframe of the motions, 6 by 6."""
        return self.motions.coframe.to_sympy().tomatrix()


def attitude() -> sp.Matrix:
    """R = Rz(phi3) Ry(phi2) Rz(phi1), from the body to space."""

    def about_z(angle: sp.Expr) -> sp.Matrix:
        c, s = sp.cos(angle), sp.sin(angle)
        return sp.Matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])

    return about_z(phi3) * sp.Matrix([[c2, 0, s2], [0, 1, 0], [-s2, 0, c2]]) * about_z(phi1)


def paper_frames() -> PaperFrames:
    """Row i, column mu of dPhi is the component i of (R^T dR/dphi^mu)^vee; dX = R^T dx."""
    turn, domain = attitude(), (phi2 > 0, phi2 < sp.pi)
    spins = [turn.T * turn.diff(angle) for angle in PHI]
    # Component i of the vee of an antisymmetric matrix is in row i + 2, column i + 1.
    rows = [[spin[(i + 2) % 3, (i + 1) % 3] for spin in spins] for i in range(3)]
    rotations = Frame(PHI, rows, domain=domain, name="so3")
    # First angles, then positions: the paper has the opposite order, see around (21).
    forms = sp.diag(rotations.coframe.to_sympy().tomatrix(), turn.T)
    return PaperFrames(rotations, Frame((*PHI, *POSITION), forms, domain=domain, name="r3xso3"))
