"""Thrust: forces and moments that turn with the body, on and off at exact times."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar

from geomtorsion.errors import SceneError
from geomtorsion.scenes.body import Expression, Number
from geomtorsion.scenes.context import Context
from geomtorsion.scenes.effects.fields import between, check_numbers, check_vectors, read_three
from geomtorsion.scenes.effects.protocol import Contribution, Effect, unit


@dataclass(frozen=True)
class Thrust(Effect):
    """A force fixed to the body: the engine of a missile.

    Equation
    --------
    P' + Omega x P = F, L' + Omega x L = point x F, body axes      [FizievKleinert1994], (1), (2)

    Parameters
    ----------
    force
        three components in body axes, N: numbers, or expressions such as "20*exp(-t)" of time
        and state (t, Omega1..3, n1..3, R11..R23, x, y, z, vx, vy, vz, m, I1..3).
    point
        point of action, from the centre of mass, body axes, m.
    start, end
        it is on between these times, s; None: from the beginning, to the end. The motion
        restarts at both, so that no step passes over them.

    Raises
    ------
    SceneError
        a vector or a time is invalid, or the end is before the start.
    ExpressionError
        an expression cannot be read, or is code.

    Examples
    --------
    >>> burn = Thrust(force=(0, 0, "20*exp(-t)"), point=(0, 0, -1), end=3)
    >>> sorted(burn.needs())
    ['attitude', 'time']
    """

    key: ClassVar[str] = "thrust"
    title: ClassVar[str] = "force fixed to the body"
    several: ClassVar[bool] = True

    force: Sequence[Expression] = field(metadata=unit("N"))
    point: Sequence[Number] = field(default=(0, 0, 0), metadata=unit("m"))
    start: Number | None = field(default=None, metadata=unit("s"))
    end: Number | None = field(default=None, metadata=unit("s"))

    def __post_init__(self) -> None:
        """Check vectors and times."""
        check_vectors(self, "force", "point")
        _check_times(self)

    def adds(self, context: Context) -> Contribution:
        """Force, its torque, and the times at which it switches."""
        burn, switches = between(context, "burn", self.start, self.end)
        force = burn * read_three(self.force, context, "F", f"{self.called(context)}.force")
        point = context.vector("point", self.point)
        moment = tuple(point.cross(force)) if any(point) else None
        return Contribution(moment=moment, force=tuple(context.in_space(force)), switches=switches)


@dataclass(frozen=True)
class BodyMoment(Effect):
    """Torque with fixed components in body axes, for example by a pair of jets.

    Equation
    --------
    L' + Omega x L = M, body axes                                  [FizievKleinert1994], (1)

    Parameters
    ----------
    moment
        three components in body axes, N m: numbers, or expressions of time and state.
    start, end
        it is on between these times, s; None: from the beginning, to the end.

    Raises
    ------
    SceneError
        the torque or a time is invalid, or the end is before the start.
    ExpressionError
        an expression cannot be read, or is code.

    Examples
    --------
    >>> sorted(BodyMoment(("0.1*sin(t)", 0, "-Omega3")).needs())
    ['omega', 'time']
    """

    key: ClassVar[str] = "body_moment"
    title: ClassVar[str] = "moment fixed to the body"
    several: ClassVar[bool] = True

    moment: Sequence[Expression] = field(metadata=unit("N m"))
    start: Number | None = field(default=None, metadata=unit("s"))
    end: Number | None = field(default=None, metadata=unit("s"))

    def __post_init__(self) -> None:
        """Check vector and times."""
        check_vectors(self, "moment")
        _check_times(self)

    def adds(self, context: Context) -> Contribution:
        """Torque, and the times at which it switches."""
        factor, switches = between(context, "motor", self.start, self.end)
        moment = factor * read_three(self.moment, context, "M", f"{self.called(context)}.moment")
        return Contribution(moment=tuple(moment), switches=switches)


def _check_times(effect: Thrust | BodyMoment) -> None:
    """Times are numbers or None, in order."""
    for name in ("start", "end"):
        if getattr(effect, name) is not None:
            check_numbers(effect, name)
    if effect.end is not None and float(effect.end) <= float(effect.start or 0):
        raise SceneError(
            f"{effect.key}: expected an end after the start at {effect.start or 0} s, got "
            f"{effect.end} s. Exchange them."
        )
