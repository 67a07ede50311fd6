"""mechanics: a body over one of the paper's frames, and everything that follows from its energy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from geomtorsion.action import EquationsOfMotion, Variation, equations_of_motion, variation
from geomtorsion.geometry import Frame
from geomtorsion.paper.frames import PaperFrames, attitude
from geomtorsion.paper.statement import short
from geomtorsion.support.caching import cached_property

MOMENTS = sp.symbols("I1 I2 I3", positive=True)
MASS = sp.Symbol("M", positive=True)
# Phi'^i and X'^i as the library calls them: u1 ... u6.
OMEGA, VELOCITY = sp.symbols("u1 u2 u3"), sp.symbols("u4 u5 u6")
TORQUE, FORCE = sp.symbols("M1 M2 M3"), sp.symbols("F1 F2 F3")
ANGULAR_MOMENTUM = [moment * u for moment, u in zip(MOMENTS, OMEGA, strict=True)]
MOMENTUM = [MASS * u for u in VELOCITY]

Row = Sequence[sp.Expr]


def dot(one: Row, two: Row) -> sp.Expr:
    """a_i b^i."""
    return sp.Add(*(a * b for a, b in zip(one, two, strict=True)))


def cross(one: Row, two: Row) -> list[sp.Expr]:
    """eps^i_jk a^j b^k."""
    return list(sp.Matrix(one).cross(sp.Matrix(two)))


def total(*rows: Row) -> list[sp.Expr]:
    """The sum of rows, component by component."""
    return [sp.Add(*parts) for parts in zip(*rows, strict=True)]


def minus(row: Row) -> list[sp.Expr]:
    """The row with the other sign."""
    return [-value for value in row]


def equal(one: Row, two: Row) -> bool:
    """Whether two rows of polynomials in the velocities are the same."""
    pairs = zip(one, two, strict=True)
    return all(sp.expand(first - second) == 0 for first, second in pairs)


def written(values: Row) -> str:
    """A row of expressions."""
    return "(" + ", ".join(short(value) for value in values) + ")"


def euler() -> tuple[list[sp.Expr], list[sp.Expr]]:
    """L' and Omega x L."""
    rates = sp.symbols("u1dot u2dot u3dot")
    change = [moment * rate for moment, rate in zip(MOMENTS, rates, strict=True)]
    return change, cross(OMEGA, ANGULAR_MOMENTUM)


def newton() -> tuple[list[sp.Expr], list[sp.Expr]]:
    """P' and Omega x P."""
    change = [MASS * rate for rate in sp.symbols("u4dot u5dot u6dot")]
    return change, cross(OMEGA, MOMENTUM)


def by_parts(momenta: Row, changes: Row, images: Row, rates: Row) -> list[sp.Expr]:
    """Coefficients of dPhi^k in p_i delta-bar u^i - d/dt (p_i dPhi^i), p' written u'dot."""
    integrand = sp.expand(dot(momenta, total(changes, minus(rates))))
    return [integrand.coeff(image) for image in images]


@dataclass(frozen=True)
class Mechanics:
    """One frame with its kinetic energy and forces, and everything that follows.

    frame: rotations or motions. energy: the Lagrangian in the body. forces: their components in it.
    """

    frame: Frame
    energy: sp.Expr
    forces: tuple[sp.Expr, ...]

    @cached_property
    def right(self) -> EquationsOfMotion:
        """From variations that close in the coordinates."""
        return equations_of_motion(self.frame, self.energy, self.forces)

    def varied(self, principle: str) -> EquationsOfMotion:
        """From other variations, without forces."""
        return equations_of_motion(self.frame, self.energy, principle=principle)

    @cached_property
    def variation(self) -> Variation:
        """delta-bar of the velocities."""
        return variation(self.frame)

    def residuals(self) -> list[sp.Expr]:
        """The equations of motion, each as an expression that vanishes."""
        return [sp.expand(value) for value in self.right.residuals]

    def change_in_space(self, vector: Row) -> list[sp.Expr]:
        """R^T d/dt (R vector) along the motion: the change of a vector of the body, in space.

        Reduced to the body axes, so that it is a polynomial in the velocities.
        """
        # By the chain rule along the equations of motion, in exact arithmetic.
        hamel, turn = self.right.hamel, attitude()
        exact = hamel.bundle.frame
        fixed = exact.read([("vector", value) for value in turn * sp.Matrix(vector)])
        changes = [hamel.derivative(value) for value in fixed]
        back = exact.read([("turn", value) for value in turn.T])
        # R^T (R vector)' has no angles left in it: the equations can be compared term by term.
        n = range(3)
        sums = [hamel.bundle.field.sum([(1, back[3 * i + j], changes[j]) for j in n]) for i in n]
        return [value.sympy for value in sums]

    def transformed(self, kinetic: sp.Matrix) -> bool:
        """Whether the energy is q'^T K q' / 2 once u = e q' is inserted."""
        bundle = self.right.hamel.bundle
        v = sp.Matrix(bundle.symbols.rates)
        # The energy in the coordinates minus the printed one: zero is decided, not simplified.
        difference = self.energy.xreplace(self.right.lagrange.velocities)
        printed = (v.T * kinetic * v)[0] / 2
        return bundle.frame.read([("energy", difference - printed)])[0].is_zero is True


def turning_body(frames: PaperFrames) -> Mechanics:
    """Sections 1 and 3: a body that turns."""
    return Mechanics(frames.rotations, dot(ANGULAR_MOMENTUM, OMEGA) / 2, TORQUE)


def flying_body(frames: PaperFrames) -> Mechanics:
    """Sections 1 and 4: a body that turns and flies."""
    energy = (dot(ANGULAR_MOMENTUM, OMEGA) + dot(MOMENTUM, VELOCITY)) / 2
    return Mechanics(frames.motions, energy, (*TORQUE, *FORCE))


class Strip:
    """Paths phi(s, t), x(s, t): variation is d/ds, change is d/dt; sympy differentiates."""

    def __init__(self, frame: Frame) -> None:
        s, t = sp.symbols("s t", real=True)
        self.s: sp.Symbol = s
        self.t: sp.Symbol = t
        self.paths = {q: sp.Function(q.name, real=True)(s, t) for q in frame.coordinates}
        self.coframe = frame.coframe.to_sympy().tomatrix()
        self.coordinates = frame.coordinates

    def form(self, i: int, by: sp.Symbol) -> sp.Expr:
        """e^i_mu dq^mu/ds or e^i_mu dq^mu/dt."""
        parts = zip(self.coframe[i, :], self.paths.values(), strict=True)
        return sp.Add(*(value.subs(self.paths) * path.diff(by) for value, path in parts))

    def curl(self, i: int, first: Sequence[int], second: Sequence[int]) -> sp.Expr:
        """d_la e^i_mu (x'^mu dphi^la - phi'^la dx^mu) with la in first and mu in second."""
        terms = []
        for la in first:
            for mu in second:
                slope = sp.diff(self.coframe[i, mu], self.coordinates[la]).subs(self.paths)
                x, phi = (self.paths[self.coordinates[k]] for k in (mu, la))
                area = x.diff(self.t) * phi.diff(self.s) - phi.diff(self.t) * x.diff(self.s)
                terms.append(slope * area)
        return sp.Add(*terms)

    def holds(self, i: int, first: Sequence[int], second: Sequence[int]) -> bool:
        """Whether delta (e^i q') = d/dt (e^i dq) + curl, identically."""
        varied = self.form(i, self.t).diff(self.s)
        changed = self.form(i, self.s).diff(self.t)
        return sp.expand(varied - changed - self.curl(i, first, second)) == 0
