"""Dust: how strongly a theory of gravity pulls dust together on a cosmos."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import sympy as sp
from numpy.typing import ArrayLike
from sympy.core.function import AppliedUndef

from geomtorsion.errors import GravityError
from geomtorsion.exact import Element, Truncated, linear_parts
from geomtorsion.geometry import Frame
from geomtorsion.gravity.perturbed.cosmology import H, N, check_signs, fields_in_time, in_rates
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
    riemannian_only,
    shown,
    theory_in,
    titled,
)
from geomtorsion.gravity.theory.field_equations import FieldEquations, equations
from geomtorsion.gravity.theory.invariants import Invariant
from geomtorsion.gravity.theory.lagrangian import Lagrangian
from geomtorsion.gravity.theory.matter import MatterField, scalar_field
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import latex_of

# Geometries without curvature, with the invariant of which a theory may be a function.
SCALAR_OF = {"teleparallel": "T", "symmetric teleparallel": "Q"}
# Potentials of clocks and of lengths, the scale factor, a wave number and the density of dust.
CLOCK, SPACE = (sp.Function(name)(T, Z) for name in ("Psi", "Phi"))
SCALE, WAVE_NUMBER, DENSITY = sp.symbols("a k rho")


@dataclass(frozen=True, eq=False, repr=False)
class Growth:
    """Potentials of dust on a flat cosmos, inside the horizon: k^2 Psi / a^2 = -G rho delta / 2.

    Omitted are time derivatives of the potentials (the quasi-static limit), and rates of the
    cosmos, which are small compared with k/a and masses. Rates that multiply the highest power of k
    remain, as in the theories of Horndeski. Units have 8 pi G = 1 for L = R/2.

    equations: field equations of the cosmos with the potentials, at first order.
    fields: the small change of each scalar field.

    Examples
    --------
    >>> from geomtorsion.gravity import perturbed
    >>> perturbed.growth("F(phi)*R/2 - X/2", scalars="phi").G
    2*(F(phi) + 2*Derivative(F(phi), phi)**2)/((2*F(phi) + 3*Derivative(F(phi), phi)**2)*F(phi))
    >>> perturbed.growth("f(T)", "teleparallel").G
    -1/(2*Derivative(f(T), T))
    """

    equations: FieldEquations
    fields: tuple[AppliedUndef, ...]

    def check(self) -> None:
        """Refuse a theory of higher order whose potentials depend on the rates of the cosmos."""
        for x in self._matrix:
            # In second order, rates of the cosmos are factors of k^2 only.
            if x.has(WAVE_NUMBER**4) and (x.has(H) or _rates(x)):
                raise GravityError(
                    "growth: expected potentials that do not depend on rates of the cosmos, got "
                    f"{shown(x)}. See the waves with perturbed.scalar_modes."
                )
        if not self._potentials[0].has(WAVE_NUMBER):
            raise GravityError(
                "growth: expected dust to have a potential, got none. Add a term of gravity."
            )

    @cached_property
    def _rows(self) -> list[Element]:
        """Derivatives of the action by the potentials and the scalar fields."""
        frame, E = self.equations.frame, self.equations.E
        volume = frame.determinant.element()
        # The metric equation is half the derivative by the coframe.
        tensor, weight = E, 1
        if self.equations.connections[0].kind not in ("levi-civita", "cartan"):
            tensor, weight = self.equations.M.raised(1), 2
        mixed = [weight * volume * tensor.element(i, i) for i in range(4)]
        rows = [mixed[0], mixed[1] + mixed[2] + mixed[3]]
        return rows + [volume * x.element() for x in self.equations.matter_equations.values()]

    @cached_property
    def _matrix(self) -> sp.Matrix:
        """The first order in the quasi-static limit, on a wave of unit potentials."""
        columns = [CLOCK, SPACE, *self.fields]
        matrix = sp.zeros(len(columns), len(columns))
        for i, row in enumerate(self._rows):
            assert isinstance(row, Truncated)
            entries: dict[int, dict[int, Element]] = {}
            for (function, (t, z)), x in linear_parts(row.parts[1], columns).items():
                if t == 0:
                    entries.setdefault(columns.index(function), {})[z] = x
            for j, entry in entries.items():
                # Potential terms of the metric are as small as H^2, by the background equations.
                least = 0 if min(i, j) >= 2 else 2
                for z, x in entry.items():
                    if z >= least:
                        matrix[i, j] += self._term(x, z, z == max(entry))
        return matrix

    def _term(self, element: Element, z: int, is_leading: bool) -> sp.Expr:
        """(i k)^z times a coefficient, without rates of the cosmos below the leading order."""
        written = in_rates(self.equations, element).subs(sp.exp(N), SCALE)
        if not is_leading:
            zero = dict.fromkeys(_rates(written), sp.S.Zero)
            written = written.xreplace(zero).xreplace({H: sp.S.Zero})
        return (sp.I * WAVE_NUMBER) ** z * written

    @cached_property
    def _potentials(self) -> list[sp.Expr]:
        """Psi, Phi and the scalar fields for rho delta = 1."""
        size = self._matrix.rows
        unknowns = sp.symbols(f"unknown:{size}")
        source = sp.Matrix([SCALE**3, *[0] * (size - 1)])
        (values,) = sp.linsolve((self._matrix, source), *unknowns) or [()]
        if not values or any(x.has(*unknowns) for x in values):
            raise GravityError(
                "growth: expected equations that determine the potentials of dust, got "
                f"{'several' if values else 'no'} potentials for "
                f"{titled(self.equations.lagrangian)}. Add a term of gravity such as R/2."
            )
        return [sp.factor(x) for x in values]

    @cached_property
    def G(self) -> sp.Expr:
        """Strength of gravity for dust at the wave number k, 1 for L = R/2."""
        return sp.factor(-2 * WAVE_NUMBER**2 * self._potentials[0] / SCALE**2)

    @cached_property
    def slip(self) -> sp.Expr:
        """Phi / Psi, 1 for L = R/2."""
        return sp.factor(self._potentials[1] / self._potentials[0])

    @property
    def equation(self) -> sp.Eq:
        """Equation of growth of the contrast of density delta(t)."""
        delta = sp.Function("delta")(T)
        left = delta.diff(T, 2) + 2 * H * delta.diff(T) - self.G * DENSITY * delta / 2
        return sp.Eq(left, 0)

    def over_time(self, times: ArrayLike, **cosmos: object) -> Evolution:
        """G and the slip as numbers on a given cosmos, for one wave number k.

        times, cosmos, errors: as in `TensorModes.over_time`, with k where it occurs.

        Examples
        --------
        >>> from geomtorsion.gravity import perturbed
        >>> theory = perturbed.growth("R/2 + R**2/6")
        >>> theory.over_time([1], a="t**(2/3)", k=0).values["G"].tolist()
        [1.0]
        """
        formulas = {"G": self.G, "slip": self.slip}
        return evolution(self.equations.lagrangian, formulas, times, cosmos)

    def to_json(self) -> dict[str, str]:
        """The results as text, by their names."""
        return {
            "lagrangian": str(self.equations.lagrangian.expression),
            "G": str(self.G),
            "slip": str(self.slip),
        }

    def __str__(self) -> str:
        head = f"growth of dust in {titled(self.equations.lagrangian)}"
        return f"{head}\nG = {shown(self.G)}\nPhi/Psi = {shown(self.slip)}"

    __repr__ = __str__

    def _repr_latex_(self) -> str:
        """The equation of growth, for notebooks."""
        return f"${latex_of(shown(self.equation))}$"


def _rates(expression: sp.Expr) -> set[sp.Expr]:
    """Derivatives by the time."""
    return {x for x in expression.atoms(sp.Derivative) if T in x.variables}


def _geometry_of_dust(lagrangian: object, geometry: object) -> str:
    """The name of the geometry: riemannian, or the geometry of functions of T or Q."""
    name = geometry_of(lagrangian, geometry)
    return name if name in SCALAR_OF else riemannian_only(lagrangian, geometry, "growth")


def _check_torsion(equations: FieldEquations, name: str) -> None:
    """Refuse theories of torsion or nonmetricity with more small fields than one that drops out."""
    scalar = SCALAR_OF.get(name)
    if scalar is None:
        return
    own = [one for one in equations.matter if isinstance(one, MatterField)]
    fields = {x for one in own for x in one.names}
    others = sorted(equations.scalars.keys() - {scalar} - fields)
    if others:
        raise GravityError(
            f"growth: expected a function of {scalar} for the geometry {name}, got a theory with "
            f"{others[0]}. List the particles with perturbed.spectrum."
        )
    slope = equations.expression.diff(sp.Symbol(scalar))
    mixed = sorted(str(x) for x in slope.free_symbols if x.name in fields)
    if mixed:
        raise GravityError(
            f"growth: expected a sum of a function of {scalar} and of terms of the scalar field, "
            f"got a factor that contains {mixed[0]} and {scalar}: the legs move as much as the "
            "potentials there. Couple the field to R of the geometry riemannian."
        )


def growth(
    lagrangian: Lagrangian | str | sp.Expr,
    geometry: str | None = None,
    *,
    scalars: str | Iterable[str] = (),
    constants: str | sp.Symbol | Iterable[str | sp.Symbol] = (),
    invariants: Invariant | Iterable[Invariant] = (),
) -> Growth:
    """Strength of gravity for dust on a flat cosmos, inside the horizon, in the quasi-static limit.

    Equation
    --------
    e^0 = (1 + epsilon Psi) dt, e^i = a (1 - epsilon Phi) dx^i; delta'' + 2 H delta' = G rho
    delta / 2. For f(R): [Tsujikawa 2007]. For f(T), a boost of the legs solves E_[0z] = 0; it is as
    small as the rates of the cosmos against k/a, and drops out [Zheng and Huang 2011]; for f(Q) the
    same holds for the coordinates [Jimenez et al. 2020].

    Parameters
    ----------
    lagrangian, constants, invariants
        As in `scalar_modes`. The dust couples to the metric.
    geometry
        "riemannian", "teleparallel" for f(T), or "symmetric teleparallel" for f(Q); the default is
        read from the Lagrangian, see `spectrum`. Scalar fields may be added to these.
    scalars
        Names of scalar fields that depend on the time, "phi".

    Raises
    ------
    GravityError
        The geometry is another one, the potentials are not unique, or they depend on rates of the
        cosmos.

    Examples
    --------
    >>> from geomtorsion.gravity import perturbed
    >>> perturbed.growth("R/2 + c*R**2/2", constants="c").slip
    (a**2 + 4*c*k**2)/(a**2 + 8*c*k**2)
    """
    name = _geometry_of_dust(lagrangian, geometry)
    names = names_of(scalars)
    small = tuple(sp.Function(f"delta_{one}")(T, Z) for one in names)
    matter = [
        scalar_field(one.phi + SMALL * change, one.name)
        for one, change in zip(fields_in_time(names, [CLOCK, SPACE]), small, strict=True)
    ]
    space = sp.exp(N) * (1 - SMALL * SPACE)
    rows = sp.diag(1 + SMALL * CLOCK, space, space, space)
    frame = Frame([T, X, Y, Z], rows, signature=ETA, parameters=[SMALL]).expanded(SMALL, 1)
    theory = theory_in(lagrangian, name)
    result = Growth(
        equations(
            GEOMETRIES[name].connection(frame),
            theory,
            matter,
            constants=constants,
            invariants=invariants,
        ),
        small,
    )
    check_signs(result.equations)
    _check_torsion(result.equations, name)
    check_couplings(result.equations, [SCALE, WAVE_NUMBER, DENSITY])
    result.check()
    return result
