"""Cosmology: gravitational waves on a cosmos of any theory, exactly."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import sympy as sp
from numpy.typing import ArrayLike
from sympy.core.function import AppliedUndef

from geomtorsion.errors import GravityError
from geomtorsion.exact import Element, Truncated, linear_parts
from geomtorsion.geometry import Frame, Tensor
from geomtorsion.gravity.perturbed.evolution import Evolution, evolution
from geomtorsion.gravity.perturbed.geometries import (
    ETA,
    GEOMETRIES,
    SMALL,
    T,
    X,
    Y,
    Z,
    check_couplings,
    geometry_of,
    names_of,
    shown,
    theory_in,
    titled,
)
from geomtorsion.gravity.perturbed.time_orders import TimeOrders, orders_of_cosmos
from geomtorsion.gravity.theory.field_equations import FieldEquations, equations
from geomtorsion.gravity.theory.invariants import Invariant
from geomtorsion.gravity.theory.lagrangian import Lagrangian
from geomtorsion.gravity.theory.matter import ScalarField, scalar_field
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import latex_of

# Geometries without a connection of its own equation.
WITHOUT_CONNECTION = ("riemannian", "teleparallel", "symmetric teleparallel")
# The logarithm of the scale factor, and the rate of expansion.
N = sp.Function("N")(T)
H = sp.Function("H")(T)
WAVE = sp.Function("h")(T, Z)
# Where parity is violated: the sign of the helicity, the wave number and the scale factor.
HELICITY, WAVE_NUMBER, SCALE = sp.Symbol("helicity"), sp.Symbol("k"), sp.Function("a")(T)


def in_rates(
    equations: FieldEquations, element: Element, values: Mapping[sp.Expr, sp.Expr] | None = None
) -> sp.Expr:
    """An element of the background with H for the derivative of N, and values for H'."""
    expression = equations.written(element)
    places = sorted(expression.atoms(sp.Derivative), key=lambda x: -x.derivative_count)
    rates = {x: H.diff(T, x.derivative_count - 1) for x in places if x.expr == N}
    # Functions of an invariant are taken at order zero, f(T_0), which is all there is here.
    zero = {x: sp.Symbol(x.name[:-2]) for x in expression.free_symbols if x.name[-2:] == "_0"}
    return sp.factor(expression.xreplace(rates).xreplace(zero).xreplace(values or {}))


def fields_in_time(names: Iterable[str], own: Iterable[AppliedUndef]) -> list[ScalarField]:
    """Scalar fields that depend on the time. Functions of the cosmos keep their names."""
    reserved = {N.func.__name__, H.func.__name__, *(one.func.__name__ for one in own)}
    fields = []
    for name in names:
        if name in reserved:
            raise GravityError(
                f"scalars: expected names other than {', '.join(sorted(reserved))}, which are "
                f"functions of the cosmos, got {name}. Rename the field."
            )
        fields.append(scalar_field(sp.Function(name)(T), None if name == "phi" else name))
    return fields


def check_signs(equations: FieldEquations) -> None:
    """Refuse roots, powers and logarithms of X, which is negative on a cosmos."""
    kinetic = {
        sp.Symbol(name) for name in equations.invariant_names if re.fullmatch(r"X(_\d+)?", name)
    }
    for x in sorted(equations.expression.atoms(sp.Pow, sp.log), key=str):
        is_whole = isinstance(x, sp.Pow) and x.exp.is_integer
        if x.args[0] in kinetic and not is_whole:
            raise GravityError(
                f"lagrangian: expected functions of X that are real on a cosmos, got {x} with "
                f"{x.args[0]} = -phidot**2. Write {x.func(-x.args[0], *x.args[1:])}."
            )


@dataclass(frozen=True, eq=False, repr=False)
class TensorModes:
    """Gravitational waves on a flat cosmos: M^2 (h'' + friction h' - (c_T/a)^2 h_zz + m^2 h) = 0.

    H(t) is the rate of expansion, a'/a. Functions such as f(T) stay unknown. If parity is violated,
    the waves h = exp(i k z) are circularly polarized with helicity +2 or -2. The results then
    contain the symbols k and helicity, which is +1 or -1.

    equations: field equations of the cosmos with the wave, at first order.

    Examples
    --------
    >>> from geomtorsion.gravity import perturbed
    >>> waves = perturbed.tensor_modes("f(T)", "teleparallel")
    >>> waves.speed2, waves.kinetic
    (1, -2*Derivative(f(T), T))
    """

    equations: FieldEquations

    def check(self) -> None:
        """Refuse waves that are not of second order in time."""
        check_signs(self.equations)
        orders = self._parts.keys()
        if not orders:
            raise GravityError(
                "tensor_modes: expected a theory with gravitational waves, got none for "
                f"{titled(self.equations.lagrangian)}. Add a term of gravity such as R/2."
            )
        if (2, 0) not in orders or orders - {(2, 0), (1, 0), (0, 2), (0, 0)}:
            raise GravityError(
                "tensor_modes: expected waves of second order in time, got derivatives of order "
                f"{max((sum(k) for k in orders), default=0)}. List the particles with "
                "perturbed.spectrum."
            )
        if any(t > 2 or z % 2 == 0 for t, z in self._mixed):
            raise GravityError(
                "tensor_modes: expected polarisations that mix by odd derivatives along the wave, "
                f"got derivatives by t and z of orders {', '.join(map(str, sorted(self._mixed)))}. "
                "List the particles with perturbed.spectrum."
            )
        if self._mixed:
            check_couplings(self.equations, [HELICITY, WAVE_NUMBER])

    @cached_property
    def _tensor(self) -> Tensor:
        """E, or M where the connection is flat and without torsion; last index up."""
        if self.equations.connections[0].kind in ("levi-civita", "cartan"):
            return self.equations.E
        return self.equations.M.raised(1)

    @cached_property
    def _parts(self) -> dict[tuple[int, int], Element]:
        """Order in t and in z -> coefficient."""
        tensor = self._tensor
        one, two = tensor.element(1, 1), tensor.element(2, 2)
        assert isinstance(one, Truncated)
        assert isinstance(two, Truncated)
        parts = linear_parts(one.parts[1] - two.parts[1], [WAVE])
        return {(k[0], k[1]): x for (_, k), x in parts.items()}

    @cached_property
    def _mixed(self) -> dict[tuple[int, int], Element]:
        """Order in t and in z -> coefficient of h in E_1^2, which violates parity."""
        one, two = self._tensor.element(1, 2), self._tensor.element(2, 1)
        assert isinstance(one, Truncated)
        assert isinstance(two, Truncated)
        parts = linear_parts((one.parts[1] + two.parts[1]) / 2, [WAVE])
        return {(k[0], k[1]): x for (_, k), x in parts.items()}

    @property
    def violates_parity(self) -> bool:
        """Whether waves of both helicities differ, as with a field times pontryagin or nieh_yan."""
        return bool(self._mixed)

    def _circular(self, order: int, *, is_rate: bool = False) -> sp.Expr:
        """Factor of a time derivative of a circular wave exp(i k z), or d/dt of the factor.

        A wave h_+ has (E_1^1 - E_2^2)/2 = P h_+ and E_1^2 = Q h_+; turned by 45 degrees about z, a
        wave h_x has -Q h_x and P h_x. So h_+ + i s h_x with s = +-1 has P + i s Q.
        """
        total = sp.S.Zero
        whole = ((self._parts, sp.Rational(1, 2)), (self._mixed, sp.I * HELICITY))
        for parts, weight in whole:
            for (t, z), x in parts.items():
                if t == order:
                    value = self._written(x.diff(T) if is_rate else x)
                    total += weight * (sp.I * WAVE_NUMBER) ** z * value.subs(sp.exp(N), SCALE)
        return sp.expand(total)

    def _written(self, element: Element) -> sp.Expr:
        return in_rates(self.equations, element)

    def _part(self, t: int, z: int) -> Element:
        return self._parts.get((t, z), self.equations.E.order(0).frame.field.zero)

    @cached_property
    def kinetic(self) -> sp.Expr:
        """The square of the effective Planck mass M^2, 1 for L = R/2; negative for a ghost."""
        is_metric_equation = self._tensor is not self.equations.E
        # The kinetic factor of L = R/2 is -2 in E and -1 in M.
        if self.violates_parity:
            return sp.factor(-self._circular(2) * (2 if is_metric_equation else 1))
        return self._written(-self._part(2, 0) / (1 if is_metric_equation else 2))

    @cached_property
    def speed2(self) -> sp.Expr:
        """The squared speed of the waves, c_T^2; the phase speed where it depends on k."""
        if self.violates_parity:
            waves = self._circular(0) - self._circular(0).subs(WAVE_NUMBER, 0)
            return sp.factor(waves * SCALE**2 / WAVE_NUMBER**2 / self._circular(2))
        scale = self.equations.E.order(0).frame.field.read(sp.exp(2 * N))
        return self._written(-self._part(0, 2) * scale / self._part(2, 0))

    @cached_property
    def friction(self) -> sp.Expr:
        """The factor of h': 3 H + d ln M^2 / dt."""
        if self.violates_parity:
            return sp.factor(self._circular(1) / self._circular(2))
        return self._written(self._part(1, 0) / self._part(2, 0))

    @cached_property
    def mass2(self) -> sp.Expr:
        """The square of the mass of the waves."""
        if self.violates_parity:
            return sp.factor(self._circular(0).subs(WAVE_NUMBER, 0) / self._circular(2))
        return self._written(self._part(0, 0) / self._part(2, 0))

    @cached_property
    def alpha_M(self) -> sp.Expr:
        """d ln M^2 / d ln a, the running of the Planck mass (Bellini and Sawicki 2014)."""
        if self.violates_parity:
            return sp.factor(self._circular(2, is_rate=True) / self._circular(2) / H)
        rate = self.equations.E.order(0).frame.field.read(N.diff(T))
        kinetic = self._part(2, 0)
        return self._written(kinetic.diff(T) / (kinetic * rate))

    @cached_property
    def alpha_T(self) -> sp.Expr:
        """c_T^2 - 1, the excess of the speed of the waves."""
        return sp.factor(self.speed2 - 1)

    @cached_property
    def time_orders(self) -> TimeOrders:
        """The highest time derivatives of a and of the scalar fields in the background equations.

        An order above two means further modes beside these waves.

        Examples
        --------
        >>> from geomtorsion.gravity import perturbed
        >>> waves = perturbed.tensor_modes("R/2 - X/2 + c*Box(phi)**2", "riemannian", scalars="phi")
        >>> print(waves.time_orders)
        a to order 3, phi to order 4, not degenerate
        """
        return orders_of_cosmos(self.equations, self._tensor, N)

    @property
    def equation(self) -> sp.Eq:
        """The wave equation for h(t, z), or for the amplitude h(t) of a circular wave."""
        wave, space = WAVE, WAVE.diff(Z, 2)
        if self.violates_parity:
            wave = sp.Function("h")(T)
            space = -(WAVE_NUMBER**2) * wave
        left = wave.diff(T, 2) + self.friction * wave.diff(T)
        left += self.mass2 * wave - self.speed2 / SCALE**2 * space
        return sp.Eq(left, 0)

    def over_time(self, times: ArrayLike, **cosmos: object) -> Evolution:
        """Squared speed, kinetic factor, alpha_M and alpha_T as numbers on a given cosmos.

        times: values of t, shape (n,). cosmos: the scale factor a and the fields as functions of t,
        and couplings as numbers, by name.

        Raises
        ------
        GravityError
            A function or a coupling has no value, or a name does not occur.
        SingularPointError
            A number is not finite at a time.

        Examples
        --------
        >>> from geomtorsion.gravity import perturbed
        >>> waves = perturbed.tensor_modes("R/2 - X/2 + c*phi*GB", "riemannian", scalars="phi")
        >>> waves.over_time([1, 2], a="t**(1/2)", phi="t**2", c="1/16").values["speed2"].tolist()
        [1.3333333333333333, 1.3333333333333333]
        """
        names = ("speed2", "kinetic", "alpha_M", "alpha_T")
        formulas = {name: getattr(self, name) for name in names}
        return evolution(self.equations.lagrangian, formulas, times, cosmos)

    def to_json(self) -> dict[str, Any]:
        """The results as text, by their names."""
        return {
            "lagrangian": str(self.equations.lagrangian.expression),
            "kinetic": str(self.kinetic),
            "speed2": str(self.speed2),
            "friction": str(self.friction),
            "mass2": str(self.mass2),
            "alpha_M": str(self.alpha_M),
            "alpha_T": str(self.alpha_T),
            "time_orders": dict(self.time_orders.orders),
            "degenerate": self.time_orders.is_degenerate,
            "violates_parity": self.violates_parity,
        }

    def __str__(self) -> str:
        lines = [
            f"gravitational waves of {titled(self.equations.lagrangian)}",
            f"M^2 = {shown(self.kinetic)}",
            f"c_T^2 = {shown(self.speed2)}",
            f"friction = {shown(self.friction)}",
            f"alpha_M = {shown(self.alpha_M)}, alpha_T = {shown(self.alpha_T)}",
        ]
        if self.mass2 != 0:
            lines.append(f"m^2 = {shown(self.mass2)}")
        if self.violates_parity:
            lines.append("parity is violated: waves exp(i k z) of helicity +1 or -1 (times two)")
        if self.time_orders.is_higher:
            lines.append(self.time_orders.meaning)
        return "\n".join(lines)

    __repr__ = __str__

    def _repr_latex_(self) -> str:
        """The wave equation, for notebooks."""
        return f"${latex_of(shown(self.equation))}$"


def tensor_modes(
    lagrangian: Lagrangian | str | sp.Expr,
    geometry: str | None = None,
    *,
    scalars: str | Iterable[str] = (),
    constants: str | sp.Symbol | Iterable[str | sp.Symbol] = (),
    invariants: Invariant | Iterable[Invariant] = (),
) -> TensorModes:
    """Gravitational waves on a flat cosmos of a theory, exactly, for any expansion.

    Equation
    --------
    e^i = a (dx^i + epsilon h_ij dx^j), h_ij = h(t, z) diag(1, -1, 0): first order of E_1^1 - E_2^2.

    Parameters
    ----------
    lagrangian
        As in `gravity.equations`; functions such as f(R) stay unknown.
    geometry
        "riemannian", "teleparallel" or "symmetric teleparallel"; the default is read from the
        Lagrangian, see `spectrum`. Beside T or Q, it may contain Rbar: f(T, Rbar + T).
    scalars
        Names of scalar fields that depend on the time, "phi".
    constants, invariants
        As in `gravity.equations`.

    Raises
    ------
    GravityError
        The waves obey an equation of higher order, or the connection has an equation of its own.

    Examples
    --------
    The speed of waves with a Gauss-Bonnet term (Kobayashi et al. 2011).

    >>> from geomtorsion.gravity import perturbed
    >>> perturbed.tensor_modes("R/2 - X/2 + c*phi*GB", "riemannian", scalars="phi").speed2
    (8*c*Derivative(phi(t), (t, 2)) + 1)/(8*c*H(t)*Derivative(phi(t), t) + 1)
    """
    name = geometry_of(lagrangian, geometry, invariants)
    if name not in WITHOUT_CONNECTION:
        raise GravityError(
            f"tensor_modes: expected a geometry of {', '.join(WITHOUT_CONNECTION)}, got {name}. "
            "Waves of the connection are listed by perturbed.spectrum."
        )
    scale = sp.exp(N)
    rows = sp.diag(1, scale * (1 + SMALL * WAVE), scale * (1 - SMALL * WAVE), scale)
    frame = Frame([T, X, Y, Z], rows, signature=ETA, parameters=[SMALL]).expanded(SMALL, 1)
    matter = fields_in_time(names_of(scalars), [WAVE])
    theory = theory_in(lagrangian, name)
    connections = GEOMETRIES[name].connections(frame, theory)
    modes = TensorModes(
        equations(connections, theory, matter, constants=constants, invariants=invariants)
    )
    modes.check()
    return modes
