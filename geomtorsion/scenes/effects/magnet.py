"""Magnet: a magnetic moment of the body in a field."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import sympy as sp

from geomtorsion.errors import SceneError
from geomtorsion.scenes.body import Expression, Number
from geomtorsion.scenes.context import Context
from geomtorsion.scenes.effects.fields import check_vectors, read_three
from geomtorsion.scenes.effects.protocol import Contribution, Effect, unit


@dataclass(frozen=True)
class Magnet(Effect):
    """Magnetic dipole fixed to the body, in a uniform field.

    Equation
    --------
    M = mu x R^T B, V = -mu . R^T B

    Parameters
    ----------
    dipole
        mu, body axes, A m^2.
    field
        B, space axes, T: numbers, or expressions of the time t.

    Raises
    ------
    SceneError
        a vector does not have three components, or the field depends on more than the time.
    ExpressionError
        an expression cannot be read, or is code.

    Examples
    --------
    >>> sorted(Magnet((0, 0, 1), (0, 0, 5e-5)).needs())
    ['vertical']
    >>> sorted(Magnet((0, 0, 1), ("cos(t)", 0, 1)).needs())
    ['attitude', 'time']
    """

    key: ClassVar[str] = "magnet"
    title: ClassVar[str] = "magnetic moment in a field"
    several: ClassVar[bool] = True

    dipole: Sequence[Number] = field(metadata=unit("A m^2"))
    field: Sequence[Expression] = field(metadata=unit("T"))

    def __post_init__(self) -> None:
        """Check the vectors."""
        check_vectors(self, "dipole", "field")

    def adds(self, context: Context) -> Contribution:
        """Torque, its potential, and the power of a changing field."""
        dipole = context.vector("mu", self.dipole)
        outside = read_three(self.field, context, "B", f"{self.called(context)}.field")
        # A field that changed with the place would also push, and its energy would be another.
        state = {symbol.name for symbol in outside.free_symbols} - {"t", *context.values}
        if state:
            raise SceneError(
                f"{self.called(context)}.field: expected a uniform field, which may depend only on "
                f"the time t, got {', '.join(sorted(state))} in it. Use Custom for other fields."
            )
        seen = context.in_body(outside)
        change = context.in_body(sp.diff(outside, context.t))
        return Contribution(
            moment=tuple(dipole.cross(seen)), energy=-dipole.dot(seen), power=-dipole.dot(change)
        )
