"""Integrability: whether the velocities that constraints permit belong to surfaces (Frobenius)."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import sympy as sp

from geomtorsion.errors import UndecidedError
from geomtorsion.geometry.components import Index
from geomtorsion.geometry.tensor import Tensor


@dataclass(frozen=True, repr=False)
class Integrability:
    """Whether constraints are integrable (holonomic), with the torsion that prevents it.

    holds: True if they are, None if zero cannot be decided.
    obstructions: (i, j, k) -> T_ij^k in the frame, with permitted legs i < j and a forbidden leg k,
        for all components that do not vanish; legs count from 0.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame, constrained
    >>> x, y, theta = sp.symbols("x y theta", real=True)
    >>> plane = Frame([x, y, theta], [[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> constrained(plane, ["cos(theta)*dy - sin(theta)*dx"]).integrable
    not integrable: T_12^3 = 1
    >>> bool(constrained(plane, ["dy - dx"]).integrable)
    True
    """

    holds: bool | None
    obstructions: Mapping[Index, sp.Expr]

    def __bool__(self) -> bool:
        if self.holds is None:
            raise UndecidedError(
                "whether the constraints are integrable cannot be decided exactly: functions occur "
                "whose relations are not known. Read the components in `obstructions`."
            )
        return self.holds

    def __repr__(self) -> str:
        if self.holds:
            return "integrable: no torsion along the forbidden legs"
        components = "; ".join(
            f"T_{i + 1}{j + 1}^{k + 1} = {value}" for (i, j, k), value in self.obstructions.items()
        )
        return f"{'undecided' if self.holds is None else 'not integrable'}: {components}"


def integrability(torsion: Tensor, allowed: Collection[int]) -> Integrability:
    """Verdict of Frobenius on the span of permitted legs, from T_ab^c of a constrained connection.

    Along a forbidden leg k the torsion of two permitted legs is minus the bracket of the two, so
    that all brackets stay permitted exactly where these components vanish.
    """
    verdicts: list[bool | None] = []
    obstructions: dict[Index, sp.Expr] = {}
    for (i, j, k), value in sorted(torsion.in_frame().components.nonzero.items()):
        if i < j and i in allowed and j in allowed and k not in allowed:
            verdicts.append(value.is_zero)
            if value.is_zero is not True:
                obstructions[i, j, k] = value.sympy
    holds = False if False in verdicts else None if None in verdicts else True
    return Integrability(holds, obstructions)
