"""Spin: the rotation of a body by its own inertia, in every scene without being named."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from geomtorsion.scenes.context import Context
from geomtorsion.scenes.effects.protocol import Contribution, Effect


@dataclass(frozen=True)
class Spin(Effect):
    """Euler's equations of the free body; every scene has it, named or not.

    Equation
    --------
    L' + Omega x L = M, L = I Omega, body axes                 [FizievKleinert1994], (1)

    Examples
    --------
    >>> sorted(Spin().needs())
    []
    """

    key: ClassVar[str] = "spin"
    title: ClassVar[str] = "rotation by its own inertia (Euler)"

    def adds(self, context: Context) -> Contribution:
        """No terms: these are the equations of every body."""
        return Contribution()
