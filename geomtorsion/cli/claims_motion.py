"""claims_motion: what the paper says of both kinds of motion, worked out once over a frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import sympy as sp

from geomtorsion.cli.claims_frames import attitude
from geomtorsion.cli.printed import short

if TYPE_CHECKING:
    from geomtorsion.action import EquationsOfMotion, Variation
    from geomtorsion.geometry import Frame

MOMENTS = sp.symbols("I1 I2 I3", positive=True)
MASS = sp.Symbol("M", positive=True)
# Phi'^i and X'^i as the library calls them: u1 ... u6.
TURN, SPEED = sp.symbols("u1 u2 u3"), sp.symbols("u4 u5 u6")
TORQUE, FORCE = sp.symbols("M1 M2 M3"), sp.symbols("F1 F2 F3")
ROTATION_ENERGY = sum(
    (moment * u**2 / 2 for moment, u in zip(MOMENTS, TURN, strict=True)), start=sp.S.Zero
)
FLIGHT_ENERGY = MASS * sum((u**2 for u in SPEED), start=sp.S.Zero) / 2

Row = Sequence[sp.Expr]


def cross(one: Row, two: Row) -> list[sp.Expr]:
    """eps^i_jk a^j b^k."""
    return list(sp.Matrix(one).cross(sp.Matrix(two)))


def angular_momentum() -> list[sp.Expr]:
    """L_i = I_i Phi'^i."""
    return [moment * u for moment, u in zip(MOMENTS, TURN, strict=True)]


def momentum() -> list[sp.Expr]:
    """P = M V."""
    return [MASS * u for u in SPEED]


def equal(one: Row, two: Row) -> bool:
    """Whether two rows of polynomials in the velocities are the same."""
    pairs = zip(one, two, strict=True)
    return all(sp.expand(first - second) == 0 for first, second in pairs)


def written(values: Row) -> str:
    """A row of expressions."""
    return "(" + ", ".join(short(value) for value in values) + ")"


@dataclass(frozen=True)
class Mechanics:
    """One frame with its kinetic energy and forces, and everything that follows.

    frame: so3 or r3xso3. energy: the Lagrangian in the body. forces: their components in it.
    """

    frame: Frame
    energy: sp.Expr
    forces: tuple[sp.Expr, ...]

    @cached_property
    def right(self) -> EquationsOfMotion:
        """From variations that close in the coordinates."""
        from geomtorsion.action import equations_of_motion

        return equations_of_motion(self.frame, self.energy, self.forces)

    def varied(self, principle: str) -> EquationsOfMotion:
        """From other variations, without forces."""
        from geomtorsion.action import equations_of_motion

        return equations_of_motion(self.frame, self.energy, principle=principle)

    @cached_property
    def variation(self) -> Variation:
        """delta-bar of the velocities."""
        from geomtorsion.action import variation

        return variation(self.frame)

    def residuals(self) -> list[sp.Expr]:
        """The equations of motion, each as an expression that vanishes."""
        return [sp.expand(value) for value in self.right.residuals]

    def change_in_space(self, vector: Row) -> list[sp.Expr]:
        """R^T d/dt (R vector) along the motion: the change of a vector of the body, in space.

        Reduced to the body axes, so that it is a polynomial in the velocities.
        """
        hamel, turn = self.right.hamel, attitude()
        exact = hamel.phase.frame
        fixed = exact.read([("vector", value) for value in turn * sp.Matrix(vector)])
        changes = [hamel.derivative(value) for value in fixed]
        back = exact.read([("turn", value) for value in turn.T])
        n = range(3)
        sums = [hamel.phase.field.sum([(1, back[3 * i + j], changes[j]) for j in n]) for i in n]
        return [value.sympy for value in sums]

    def transformed(self, kinetic: sp.Matrix) -> bool:
        """Whether the energy is q'^T K q' / 2 once u = e q' is put in."""
        phase = self.right.hamel.phase
        rates = phase.letters.rates
        v = sp.Matrix(rates)
        difference = self.energy.xreplace(self.right.lagrange.velocities)
        printed = (v.T * kinetic * v)[0] / 2
        return phase.frame.read([("energy", difference - printed)])[0].is_zero is True


class Strip:
    """Paths phi(s, t), x(s, t): variation is d/ds, change is d/dt; sympy differentiates."""

    def __init__(self, frame: Frame) -> None:
        s, t = sp.symbols("s t", real=True)
        self.s, self.t = s, t
        self.paths = {q: sp.Function(q.name, real=True)(s, t) for q in frame.coordinates}
        self.coframe = frame.coframe.to_sympy().tomatrix()
        self.coordinates = frame.coordinates

    def on(self, expression: Any) -> Any:
        """A function of the coordinates on the strip."""
        return sp.sympify(expression).subs(self.paths)

    def row(self, i: int, by: sp.Symbol) -> sp.Expr:
        """e^i_mu dq^mu/ds or e^i_mu dq^mu/dt."""
        return sp.Add(
            *(self.on(self.coframe[i, mu]) * self.paths[q].diff(by)
              for mu, q in enumerate(self.coordinates))
        )  # fmt: skip

    def curl(self, i: int, rows: Sequence[int], columns: Sequence[int]) -> sp.Expr:
        """d_la e^i_mu (x'^mu dphi^la - phi'^la dx^mu) with la in rows and mu in columns."""
        terms = []
        for la in rows:
            for mu in columns:
                slope = self.on(sp.diff(self.coframe[i, mu], self.coordinates[la]))
                one, two = (self.paths[self.coordinates[k]] for k in (mu, la))
                terms.append(
                    slope
                    * (one.diff(self.t) * two.diff(self.s) - two.diff(self.t) * one.diff(self.s))
                )
        return sp.Add(*terms)

    def holds(self, i: int, rows: Sequence[int], columns: Sequence[int]) -> bool:
        """Whether delta (e^i q') = d/dt (e^i dq) + curl, identically."""
        varied = self.row(i, self.t).diff(self.s)
        changed = self.row(i, self.s).diff(self.t)
        return sp.expand(varied - changed - self.curl(i, rows, columns)) == 0
