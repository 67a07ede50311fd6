"""Rotor: a wheel inside the body; a body with one is a gyrostat."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import sympy as sp

from geomtorsion.errors import SceneError
from geomtorsion.scenes.body import Expression, Number, exact
from geomtorsion.scenes.context import Context
from geomtorsion.scenes.effects.fields import check_axis, check_numbers, read, unit_axis
from geomtorsion.scenes.effects.protocol import Contribution, Effect, unit


@dataclass(frozen=True)
class Rotor(Effect):
    """A balanced wheel on an axis that is fixed in the body.

    The inertia of the body counts the wheel as if it were locked.

    Equation
    --------
    driven (no inertia given): L = I Omega + h a, h constant: a motor keeps the relative speed
    free: L = (I - J a a^T) Omega + h a, h' = torque, relative speed w = h / J - a . Omega
                                                            [Leimanis1965] section 17

    Parameters
    ----------
    axis
        a, body axes; its length does not matter.
    momentum
        h, N m s: of a driven wheel, by its rotation relative to the body; of a free wheel, by its
        total rotation about the axis, at the start.
    inertia
        J, about the axis, kg m^2. None: the wheel is driven at a constant relative speed.
    torque
        of motor and bearing on a free wheel, N m: a number, or an expression of time and state, in
        which w is the relative speed: "-0.01*w" is friction.

    Raises
    ------
    SceneError
        the axis is not a direction, J is not positive or exceeds the body, a torque without J.
    ExpressionError
        the torque cannot be read, or is code.

    Examples
    --------
    >>> sorted(Rotor((0, 0, 1), momentum=2).needs())
    []
    >>> sorted(Rotor((0, 0, 1), momentum=2, inertia=0.1, torque="-0.01*w").needs())
    ['omega']
    """

    key: ClassVar[str] = "rotor"
    title: ClassVar[str] = "wheel inside the body (gyrostat)"
    several: ClassVar[bool] = True

    axis: Sequence[Number]
    momentum: Number = field(metadata=unit("N m s"))
    inertia: Number | None = field(default=None, metadata=unit("kg m^2"))
    torque: Expression = field(default=0, metadata=unit("N m"))

    def __post_init__(self) -> None:
        """Check axis and numbers."""
        check_axis(self, "axis")
        check_numbers(self, "momentum")
        if self.inertia is not None:
            check_numbers(self, "inertia", sign="positive")
        elif self.torque != 0:
            raise SceneError(
                f"rotor.torque = {self.torque!r}: expected also rotor.inertia (kg m^2), got none. "
                "Give it, or omit the torque: a wheel at constant speed needs no given torque."
            )

    def adds(self, context: Context) -> Contribution:
        """Internal angular momentum; the body loses the inertia of a free wheel about its axis."""
        axis = unit_axis(context, "axis", self.axis)
        if self.inertia is None:
            momentum = context.parameter("h", self.momentum) * axis
            return Contribution(momentum=tuple(momentum))
        self._check_size(context)
        inertia = context.parameter("J", self.inertia)
        # The wheel turns by itself about its axis: the body loses what it had of it there.
        out = -inertia * axis * axis.T
        rows = tuple(tuple(out[i, :]) for i in range(3))
        along = axis.dot(sp.Matrix(context.Omega))
        if self.torque == 0:
            h = context.parameter("h", self.momentum)
            return Contribution(
                momentum=tuple(h * axis),
                inertia=rows,
                energy=h**2 / (2 * inertia),
                outputs={f"{self.called(context)}_speed": h / inertia - along},
            )
        h = context.state(f"h_{self.called(context)}")
        relative = h / inertia - along
        w = sp.Symbol("w")
        torque = read(self.torque, context, "torque", f"{self.called(context)}.torque", {"w": w})
        torque = torque.xreplace({w: relative})
        return Contribution(
            momentum=tuple(h * axis),
            inertia=rows,
            states={h.name: torque},
            start={h.name: self.momentum},
            energy=h**2 / (2 * inertia),
            # The torque turns the wheel one way and the body the other.
            power=torque * relative,
            outputs={f"{self.called(context)}_speed": relative},
        )

    def _check_size(self, context: Context) -> None:
        """The wheel is a part of the body."""
        column = sp.Matrix([exact(x, "axis") for x in self.axis])
        tensor = sp.Matrix(3, 3, lambda i, j: context.body.exact_tensor[i][j])
        whole = (column.T * tensor * column)[0] / column.dot(column)
        if not exact(self.inertia, "inertia") < whole:
            raise SceneError(
                f"{self.called(context)}.inertia: expected less than {float(whole):.6g} kg m^2, "
                f"the moment of the body about that axis including its wheel, got {self.inertia}. "
                "Increase the moment of the body, or decrease the inertia of the wheel."
            )
