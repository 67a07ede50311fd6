"""Torsion: what bends geodesics into autoparallels, and the naive law that leaves it out."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import sympy as sp

from geomtorsion.scenes.body import Number
from geomtorsion.scenes.context import Context
from geomtorsion.scenes.effects.fields import check_numbers
from geomtorsion.scenes.effects.protocol import Contribution, Effect, unit


@dataclass(frozen=True)
class Torsion(Effect):
    """The torsion force of R^3 x SO(3): a free body then moves on an autoparallel.

    Without it the centre of a free body moves along a straight line (a geodesic); with it, Omega
    and the velocity in body axes stay constant, and the centre moves on a helix. Real bodies do not
    feel it.

    Equation
    --------
    f^c = 2 S_a^c_b q'^a q'^b                              [FizievKleinert1994], below (6)
    with the kinetic metric: M = Omega x I Omega, F = m R (Omega x R^T v)

    Parameters
    ----------
    strength
        1 gives the autoparallels, 0 the geodesics; values in between give a blend.

    Raises
    ------
    SceneError
        the strength is not a number.

    Examples
    --------
    >>> sorted(Torsion().needs())
    ['attitude', 'omega', 'velocity']
    """

    key: ClassVar[str] = "torsion"
    title: ClassVar[str] = "torsion force (autoparallels instead of geodesics)"
    excludes: ClassVar[frozenset[str]] = frozenset({"naive", "rolling", "knife_edge", "pivot"})

    strength: Number = field(default=1, metadata=unit(""))

    def __post_init__(self) -> None:
        """Check the number."""
        check_numbers(self, "strength")

    def adds(self, context: Context) -> Contribution:
        """Force and torque; both are perpendicular to the motion and do no work."""
        size = context.parameter("torsion", self.strength)
        omega = sp.Matrix(context.Omega)
        moment = size * omega.cross(context.inertia * omega)
        force = size * context.mass * context.in_space(omega).cross(sp.Matrix(context.velocity))
        # Stated, since a product of symbols would have to be simplified to show it.
        return Contribution(moment=tuple(moment), force=tuple(force), power=sp.S.Zero)


@dataclass(frozen=True)
class Naive(Effect):
    """Naive law I Omega' = M: a wrong result that the paper warns of.

    This wrong law follows if variations are required to close in the image Phi, which is not a
    coordinate. It does not conserve the angular momentum in space; it conserves the energy, because
    the omitted term does no work.

    Equation
    --------
    L' = M instead of L' + Omega x L = M: I_i Omega_i' = M_i [FizievKleinert1994], section 3
    L with the momentum of rotors, and about the pivot where there is one

    Examples
    --------
    >>> sorted(Naive().needs())
    []
    """

    key: ClassVar[str] = "naive"
    title: ClassVar[str] = "naive law without Omega x L (wrong on purpose)"
    excludes: ClassVar[frozenset[str]] = frozenset({"torsion", "rolling", "knife_edge"})
    wrong: ClassVar[bool] = True

    def adds(self, context: Context) -> Contribution:
        """No terms: it removes Omega x L from the equations."""
        return Contribution(naive=True)
