"""Scalar waves: density waves of a scalar field and gravity on a cosmos, exactly."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import sympy as sp
from numpy.typing import ArrayLike
from sympy.core.function import AppliedUndef

from geomtorsion.errors import GravityError
from geomtorsion.exact import Element, Truncated, linear_parts
from geomtorsion.geometry import Frame, levi_civita
from geomtorsion.gravity.perturbed.cosmology import H, N, check_signs, fields_in_time, in_rates
from geomtorsion.gravity.perturbed.evolution import Evolution, evolution
from geomtorsion.gravity.perturbed.geometries import (
    ETA,
    SMALL,
    T,
    X,
    Y,
    Z,
    names_of,
    riemannian_only,
    shown,
    theory_in,
    titled,
)
from geomtorsion.gravity.perturbed.time_orders import orders_of_cosmos
from geomtorsion.gravity.theory.field_equations import FieldEquations, equations
from geomtorsion.gravity.theory.invariants import Invariant
from geomtorsion.gravity.theory.lagrangian import Lagrangian
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import latex_of

# Small changes of the lapse, the shift and the curvature of space.
LAPSE, SHIFT, CURVATURE = (sp.Function(name)(T, Z) for name in ("alpha", "beta", "zeta"))
# Derivatives, by t and by z, that occur in theories of second order.
ORDERS = {
    (LAPSE, LAPSE): {(0, 0)},
    (LAPSE, SHIFT): {(0, 1)},
    (LAPSE, CURVATURE): {(0, 0), (1, 0), (0, 2)},
    (SHIFT, LAPSE): {(0, 1)},
    (SHIFT, SHIFT): {(0, 0)},
    (SHIFT, CURVATURE): {(1, 1)},
    (CURVATURE, LAPSE): {(0, 0), (1, 0), (0, 2)},
    (CURVATURE, SHIFT): {(0, 1), (1, 1)},
    (CURVATURE, CURVATURE): {(0, 0), (1, 0), (2, 0), (0, 2)},
}


@dataclass(frozen=True, eq=False, repr=False)
class ScalarModes:
    """Scalar waves on a flat cosmos: zeta'' + friction zeta' - (c_s/a)^2 zeta_zz = 0.

    The action is the integral of a^3 Q_s (zeta'^2 - (c_s/a)^2 zeta_z^2). H(t) is the rate of
    expansion, a'/a; the background equation replaces H'. Functions such as V(phi) stay unknown.

    equations: field equations of the cosmos with the wave, at first order.

    Examples
    --------
    A field with any potential moves with the speed of light.

    >>> from geomtorsion.gravity import perturbed
    >>> waves = perturbed.scalar_modes("R/2 - X/2 - V(phi)")
    >>> waves.speed2, waves.kinetic
    (1, Derivative(phi(t), t)**2/(2*H(t)**2))
    """

    equations: FieldEquations

    def check(self) -> None:
        """Refuse a theory that does not have exactly one scalar wave, of second order."""
        check_signs(self.equations)
        orders = orders_of_cosmos(self.equations, self.equations.E, N)
        if orders.is_higher:
            raise GravityError(
                "scalar_modes: expected equations of second order in time, got "
                f"{orders.meaning}, or list the particles with perturbed.spectrum."
            )
        for (row, column), orders in ORDERS.items():
            excess = self._rows[row][1].get(column, {}).keys() - orders
            if excess:
                raise GravityError(
                    "scalar_modes: expected a theory with one scalar wave of second order in time, "
                    f"got derivatives of {column.func} by t and z of orders "
                    f"{', '.join(map(str, sorted(excess)))} in the equation of {row.func}. List "
                    "the particles with perturbed.spectrum."
                )
        shift = self._part(SHIFT, LAPSE, 0, 1), self._part(SHIFT, CURVATURE, 1, 1)
        if any(x.is_zero for x in shift):
            raise GravityError(
                "scalar_modes: expected a theory whose equation of the shift gives the lapse, got "
                f"{titled(self.equations.lagrangian)}. Add a term of gravity such as R/2."
            )
        if self._density.is_zero and self._written(self._gradient) != 0:
            raise GravityError(
                "scalar_modes: expected a theory with a scalar wave, got the kinetic factor 0 with "
                f"a gradient for {titled(self.equations.lagrangian)}: a cuscuton, whose field "
                "follows from the other fields at each instant (Afshordi, Chung and Geshnizjani "
                "2007). "
                "It has no wave to report; see the gravitational waves with perturbed.tensor_modes."
            )
        if self._density.is_zero:
            raise GravityError(
                "scalar_modes: expected a theory with a scalar wave, got the kinetic factor 0 for "
                f"{titled(self.equations.lagrangian)}. Add a kinetic term such as -X/2."
            )
        if self._rate.has(H.diff(T)):
            raise GravityError(
                "scalar_modes: expected a background equation linear in Hdot, got "
                f"Hdot = {shown(self._rate)}. List the particles with perturbed.spectrum."
            )

    @cached_property
    def _rows(self) -> dict[AppliedUndef, tuple[Element, dict]]:
        """Field -> (derivative of the action by it at order 0, coefficients of the first order)."""
        frame, E = self.equations.frame, self.equations.E
        volume, legs, n = frame.determinant.element(), frame.legs, range(4)

        def derivative(i: int, mu: int) -> Element:
            """e E_i^mu, by the component mu of the leg i of the coframe."""
            terms = ((1, volume, legs.element(mu, k), E.element(i, k)) for k in n)
            return frame.field.sum(list(terms))

        space = [(1, frame.field.read(sp.exp(N)), derivative(i, i)) for i in (1, 2, 3)]
        rows = {LAPSE: derivative(0, 0), SHIFT: derivative(3, 0)}
        rows[CURVATURE] = frame.field.sum(space)
        result = {}
        for field, row in rows.items():
            assert isinstance(row, Truncated)
            entries: dict[AppliedUndef, dict[tuple[int, int], Element]] = {}
            for (function, k), x in linear_parts(row.parts[1], list(rows)).items():
                entries.setdefault(function, {})[k[0], k[1]] = x
            result[field] = row.parts[0], entries
        return result

    def _part(self, row: AppliedUndef, column: AppliedUndef, t: int, z: int) -> Element:
        """Coefficient of d_t^t d_z^z of a field in the equation of another."""
        zero = self.equations.E.order(0).frame.field.zero
        return self._rows[row][1].get(column, {}).get((t, z), zero)

    @cached_property
    def _solved(self) -> Element:
        """The lapse that solves the equation of the shift, divided by zeta'."""
        return -self._part(SHIFT, CURVATURE, 1, 1) / self._part(SHIFT, LAPSE, 0, 1)

    @cached_property
    def _density(self) -> Element:
        """a^3 Q_s. The shift is a Lagrange multiplier and drops out of the action."""
        lapse, two = self._solved, self.equations.E.order(0).frame.field.rational(2)
        half = self._part(LAPSE, LAPSE, 0, 0) * lapse * lapse
        half = half - self._part(CURVATURE, CURVATURE, 2, 0)
        return half / two + self._part(LAPSE, CURVATURE, 1, 0) * lapse

    @cached_property
    def _gradient(self) -> Element:
        """a Q_s c_s^2, after a partial integration of zeta' zeta_zz."""
        mixed = self._solved * self._part(LAPSE, CURVATURE, 0, 2)
        return (self._part(CURVATURE, CURVATURE, 0, 2) - mixed.diff(T)) / 2

    @cached_property
    def _rate(self) -> sp.Expr:
        """H' from the equations of the background, without the terms that L itself has in them."""
        energy, pressure = (self._rows[field][0] for field in (LAPSE, CURVATURE))
        second = self.equations.E.order(0).frame.field.read(N.diff(T, 2))
        rest = (pressure - 3 * energy) / self._part(CURVATURE, CURVATURE, 2, 0)
        return in_rates(self.equations, second - rest)

    def _written(self, element: Element) -> sp.Expr:
        """An element with H', by the background equation."""
        return in_rates(self.equations, element, {H.diff(T): self._rate})

    @property
    def _scale(self) -> Element:
        return self.equations.E.order(0).frame.field.read(sp.exp(N))

    @property
    def background(self) -> tuple[sp.Eq, sp.Eq]:
        """The equation of Friedmann and the equation for H', which the background obeys."""
        energy = in_rates(self.equations, self._rows[LAPSE][0] / self._scale**3)
        return sp.Eq(energy, 0), sp.Eq(H.diff(T), self._rate)

    @cached_property
    def lapse(self) -> sp.Expr:
        """The change of the lapse alpha, divided by zeta': 1/H for L = R/2 - X/2."""
        return self._written(self._solved)

    @cached_property
    def kinetic(self) -> sp.Expr:
        """Q_s, the kinetic factor of zeta; negative for a ghost."""
        return self._written(self._density / self._scale**3)

    @cached_property
    def speed2(self) -> sp.Expr:
        """The square of the speed of the waves, c_s^2; negative for unstable ones."""
        return self._written(self._gradient * self._scale**2 / self._density)

    @cached_property
    def friction(self) -> sp.Expr:
        """The factor of zeta': 3 H + d ln Q_s / dt."""
        return self._written(self._density.diff(T) / self._density)

    @property
    def equation(self) -> sp.Eq:
        """The wave equation for zeta(t, z)."""
        scale = sp.Function("a")(T)
        left = CURVATURE.diff(T, 2) + self.friction * CURVATURE.diff(T)
        return sp.Eq(left - self.speed2 / scale**2 * CURVATURE.diff(Z, 2), 0)

    def over_time(self, times: ArrayLike, **cosmos: object) -> Evolution:
        """Squared speed, kinetic factor and the left side of the Friedmann equation as numbers.

        times, cosmos, errors: as in `TensorModes.over_time`. The left side vanishes where a and the
        field solve the Friedmann equation.

        Examples
        --------
        A stiff field, a = t^(1/3), phi' = sqrt(2/3) / t.

        >>> from geomtorsion.gravity import perturbed
        >>> waves = perturbed.scalar_modes("R/2 - X/2")
        >>> values = waves.over_time([1, 2], a="t**(1/3)", phi="sqrt(2/3)*log(t)").values
        >>> values["speed2"].tolist(), values["friedmann"].tolist()
        ([1.0, 1.0], [0.0, 0.0])
        """
        formulas = {"speed2": self.speed2, "kinetic": self.kinetic}
        formulas["friedmann"] = self.background[0].lhs
        return evolution(self.equations.lagrangian, formulas, times, cosmos)

    def to_json(self) -> dict[str, str]:
        """The results as text, by their names."""
        return {
            "lagrangian": str(self.equations.lagrangian.expression),
            "kinetic": str(self.kinetic),
            "speed2": str(self.speed2),
            "friction": str(self.friction),
            "lapse": str(self.lapse),
        }

    def __str__(self) -> str:
        lines = [
            f"scalar waves of {titled(self.equations.lagrangian)}",
            f"Q_s = {shown(self.kinetic)}",
            f"c_s^2 = {shown(self.speed2)}",
            f"friction = {shown(self.friction)}",
        ]
        return "\n".join(lines)

    __repr__ = __str__

    def _repr_latex_(self) -> str:
        """The wave equation, for notebooks."""
        return f"${latex_of(shown(self.equation))}$"


def scalar_modes(
    lagrangian: Lagrangian | str | sp.Expr,
    geometry: str | None = None,
    *,
    scalars: str | Iterable[str] = "phi",
    constants: str | sp.Symbol | Iterable[str | sp.Symbol] = (),
    invariants: Invariant | Iterable[Invariant] = (),
) -> ScalarModes:
    """Scalar waves on a flat cosmos with a scalar field, exactly, for any expansion.

    Equation
    --------
    e^0 = (1 + epsilon alpha) dt, e^i = a (1 + epsilon zeta) dx^i + epsilon beta delta^i_z dt, with
    an unchanged field phi(t) (unitary gauge). The equations of alpha and beta are solved; zeta has
    the action of Kobayashi, Yamaguchi and Yokoyama (2011), with G_S = Q_s and F_S = Q_s c_s^2.

    Parameters
    ----------
    lagrangian
        As in `gravity.equations`; functions such as K(X) stay unknown, X = g^ab phi_a phi_b.
    geometry
        Only "riemannian"; see `spectrum` for the default.
    scalars
        The name of the scalar field that depends on the time.
    constants, invariants
        As in `gravity.equations`.

    Raises
    ------
    GravityError
        There is not exactly one scalar field, the geometry is another one, there is no scalar wave,
        or waves obey an equation of higher order.

    Examples
    --------
    A field with L = X^2 has the speed of sound of radiation (Garriga and Mukhanov 1999).

    >>> from geomtorsion.gravity import perturbed
    >>> perturbed.scalar_modes("R/2 + X**2", scalars="phi").speed2
    1/3
    """
    name = riemannian_only(lagrangian, geometry, "scalar_modes")
    names = names_of(scalars)
    if len(names) != 1:
        raise GravityError(
            f"scalar_modes: expected one scalar field, got {len(names)}. Give scalars='phi' and "
            "its terms in the Lagrangian, such as -X/2."
        )
    matter = fields_in_time(names, [LAPSE, SHIFT, CURVATURE])
    space = sp.exp(N) * (1 + SMALL * CURVATURE)
    rows = sp.diag(1 + SMALL * LAPSE, space, space, space)
    rows[3, 0] = SMALL * SHIFT
    frame = Frame([T, X, Y, Z], rows, signature=ETA, parameters=[SMALL]).expanded(SMALL, 1)
    theory = theory_in(lagrangian, name)
    modes = ScalarModes(
        equations(levi_civita(frame), theory, matter, constants=constants, invariants=invariants)
    )
    modes.check()
    return modes
