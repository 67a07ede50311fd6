"""Drift: the body is free to move away."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from geomtorsion.scenes.context import Context
from geomtorsion.scenes.effects.protocol import Contribution, Effect


@dataclass(frozen=True)
class Drift(Effect):
    """The centre of mass moves freely by Newton's law: m v' = F in space axes.

    A body without a constraint always has it. A scene with this effect and a constraint on the
    centre of mass (pivot, rolling, knife edge) is refused.

    Equation
    --------
    P' + Omega x P = F, body axes                              [FizievKleinert1994], (2)

    Examples
    --------
    >>> sorted(Drift.excludes)
    ['knife_edge', 'pivot', 'rolling']
    """

    key: ClassVar[str] = "drift"
    title: ClassVar[str] = "free translation of the centre of mass (Newton)"
    excludes: ClassVar[frozenset[str]] = frozenset({"pivot", "rolling", "knife_edge"})

    def adds(self, context: Context) -> Contribution:
        """No terms: these are the equations of every free body."""
        return Contribution()
