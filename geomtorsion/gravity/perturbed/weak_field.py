"""Post-Newtonian: the field of a mass at rest to second order, in any theory."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import sympy as sp

from geomtorsion.errors import GravityError
from geomtorsion.exact import Element, parse_expression
from geomtorsion.geometry import Frame
from geomtorsion.gravity.perturbed.cosmology import WITHOUT_CONNECTION
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
    replacements,
    shown,
    theory_in,
    titled,
)
from geomtorsion.gravity.perturbed.solar_system import CASSINI, MEASUREMENTS, SolarTest
from geomtorsion.gravity.perturbed.taylor import about_flat_space
from geomtorsion.gravity.theory.field_equations import FieldEquations, equations
from geomtorsion.gravity.theory.invariants import Invariant
from geomtorsion.gravity.theory.lagrangian import Lagrangian
from geomtorsion.gravity.theory.matter import scalar_field
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import Plot, drawn_by, figure_by, latex_of

# Wave number and distance; first and second order of the lapse, the lengths and the scalars.
K = sp.Symbol("k")
DISTANCE = sp.Symbol("r", positive=True)
LENGTH, LAPSE2, LENGTH2 = sp.symbols("length lapse2 length2")
# A place outside of the mass where r = 1.
PLACE = {X: sp.Rational(2, 3), Y: sp.Rational(1, 3), Z: sp.Rational(2, 3)}


@dataclass(frozen=True, eq=False, repr=False)
class PostNewtonian:
    """Field of a mass at rest: g_tt = -(1 - 2 U + 2 beta U^2), g_ij = (1 + 2 gamma U) delta_ij.

    lagrangian: the theory.
    build: (potential, order) -> the equations of a static field with this potential.
    scalars: names of the scalar fields.
    couplings: symbols that may have values. values: coupling -> its value, if it has one.

    Examples
    --------
    >>> from geomtorsion.gravity import perturbed
    >>> weak = perturbed.post_newtonian("T + c*T**2", "teleparallel")
    >>> weak.gamma, weak.beta
    (1, 1)
    """

    lagrangian: Lagrangian
    build: Callable[[sp.Expr, int], FieldEquations]
    scalars: tuple[str, ...]
    couplings: tuple[sp.Symbol, ...] = ()
    values: Mapping[sp.Symbol, sp.Expr] = field(default_factory=dict)

    def subs(self, values: Mapping[Any, object] | None = None, **named: object) -> PostNewtonian:
        """The same field for values of couplings.

        Raises
        ------
        GravityError
            A name is not a coupling, or a value not a number or a formula.

        Examples
        --------
        >>> from geomtorsion.gravity import perturbed
        >>> theory = perturbed.post_newtonian(
        ...     "phi*R/2 - om*X/(2*phi)", "riemannian", scalars="phi"
        ... )
        >>> theory.subs(om=40000).gamma
        40001/40002
        """
        return replace(self, values=replacements(self.couplings, {**(values or {}), **named}))

    def _at(self, expression: sp.Expr, name: str) -> sp.Expr:
        """A formula at the values of the couplings."""
        result = sp.factor(expression.xreplace(dict(self.values)))
        if result.has(sp.nan, sp.zoo, sp.oo):
            given = ", ".join(f"{x} = {value}" for x, value in self.values.items())
            raise GravityError(
                f"post_newtonian: expected values at which {name} = {expression} is finite, got "
                f"{given}. Give other values, or write these into the Lagrangian."
            )
        return result

    # -- first order -----------------------------------------------------------------------------

    @cached_property
    def _wave(self) -> tuple[dict[sp.Symbol, sp.Expr], sp.Expr]:
        """First-order values for a wave exp(i k x) of unit potential, and its mass density."""
        rate = sp.Symbol("rate")
        wave = sp.exp(rate * (X + 2 * Y + 2 * Z) / 3)
        system = self.build(wave, 1)
        turn = {X: 0, Y: 0, Z: 0}
        rows = [x.sympy.subs(turn) for x in _rows(system, 1)]
        unknowns = [LENGTH, *self._strengths]
        (values,) = sp.linsolve(rows, unknowns) or [()]
        if not values or {*unknowns} & set().union(*(x.free_symbols for x in values)):
            raise GravityError(
                "post_newtonian: expected equations that determine the field of a mass, got "
                f"{'several fields' if values else 'no field'} for {titled(self.lagrangian)}. A "
                "static field of this theory needs more components."
            )
        # The energy density of L = R/2 is 2 k^2 in E and k^2 in M.
        density = _component(system, 1, (0, 0)).sympy.subs(turn) / _weight(system)
        solved = dict(zip(unknowns, values, strict=True))
        real = {rate: sp.I * K}
        first = {x: sp.factor(value.subs(real)) for x, value in solved.items()}
        return first, sp.factor(density.subs(solved).subs(real) / K**2)

    @property
    def _strengths(self) -> list[sp.Symbol]:
        return [sp.Symbol(f"{name}_1") for name in self.scalars]

    @cached_property
    def gamma_of_k(self) -> sp.Expr:
        """gamma for a wave of the potential with the wave number k."""
        return self._at(self._wave[0][LENGTH], "gamma_of_k")

    @cached_property
    def G_of_k(self) -> sp.Expr:
        """Strength of the attraction for a wave number k; 1 for L = R/2."""
        return self._at(1 / self._wave[1], "G_of_k")

    @cached_property
    def gamma_of_r(self) -> sp.Expr:
        """gamma at the distance r from a point mass; a field of mass m adds exp(-m r).

        Raises
        ------
        GravityError
            A field is not a single wave of one mass.

        Examples
        --------
        The scalar of R^2 (Capone and Ruggiero 2010).

        >>> from geomtorsion.gravity import perturbed
        >>> theory = perturbed.post_newtonian("R/2 + R**2/12", "riemannian")
        >>> theory.gamma_of_r
        (3*exp(r) - 1)/(3*exp(r) + 1)
        """
        lengths = _around_a_point(sp.factor(self.G_of_k * self.gamma_of_k))
        return sp.factor(lengths / _around_a_point(self.G_of_k))

    @cached_property
    def G_of_r(self) -> sp.Expr:
        """Potential at the distance r from a point mass, times r/mass; 1 for L = R/2."""
        return sp.factor(_around_a_point(self.G_of_k))

    def _check_massless(self) -> None:
        if self._is_massless:
            return
        # Both parts of the field have the poles of the propagator: k^2 = -m^2.
        lengths = sp.factor(self.G_of_k * self.gamma_of_k)
        bottoms = sp.denom(lengths) * sp.denom(self.G_of_k)
        factors = [f for f, _ in sp.factor_list(bottoms)[1] if f.has(K)]
        masses = [sp.factor(-x) for f in factors for x in sp.roots(sp.Poly(f.subs(K**2, K), K))]
        listed = ", ".join(f"m^2 = {x}" for x in masses)
        raise GravityError(
            f"post_newtonian: expected massless fields, got a field with {listed or 'a mass'}. Use "
            f"gamma_of_k = {self.gamma_of_k} for a wave number k, gamma_of_r and tests_at(r) for a "
            "distance r."
        )

    @property
    def gamma(self) -> sp.Expr:
        """Curvature of space per unit mass; 1 in general relativity.

        Raises
        ------
        GravityError
            A field has a mass, so that gamma depends on the distance.
        """
        self._check_massless()
        return self.gamma_of_k

    @property
    def G(self) -> sp.Expr:
        """Newton's constant in a Cavendish experiment, in units in which L = R/2 has 1."""
        self._check_massless()
        return self.G_of_k

    # -- second order ----------------------------------------------------------------------------

    @cached_property
    def _beta(self) -> sp.Expr:
        system = self.build(1 / sp.sqrt(X**2 + Y**2 + Z**2), 2)
        known = self._wave[0]
        rows = [sp.factor(x.sympy.subs(PLACE).subs(known)) for x in _rows(system, 2)]
        rows.append(sp.factor(_component(system, 2, (0, 0)).sympy.subs(PLACE).subs(known)))
        unknowns = [LAPSE2, LENGTH2, *(sp.Symbol(f"{name}_2") for name in self.scalars)]
        (values,) = sp.linsolve([x for x in rows if x != 0], unknowns) or [()]
        if not values or values[0].free_symbols & {*unknowns}:
            raise GravityError(
                "post_newtonian: expected a second order 1/r^2 of the field of a mass, got "
                f"{'several' if values else 'none'} for {titled(self.lagrangian)}. Use gamma."
            )
        return sp.factor(sp.Rational(1, 2) + values[0])

    @cached_property
    def beta(self) -> sp.Expr:
        """Nonlinearity of gravity in g_tt; 1 in general relativity.

        Raises
        ------
        GravityError
            A field has a mass, or no field 1/r solves the second order outside of a mass.
        """
        self._check_massless()
        return self._at(self._beta, "beta")

    # -- the solar system ------------------------------------------------------------------------

    @cached_property
    def tests(self) -> tuple[SolarTest, ...]:
        """gamma and beta beside their measured values in the solar system.

        Raises
        ------
        GravityError
            As gamma and beta.

        Examples
        --------
        >>> from geomtorsion.gravity import perturbed
        >>> theory = perturbed.post_newtonian(
        ...     "phi*R/2 - om*X/(2*phi)", "riemannian", scalars="phi"
        ... )
        >>> print(theory.tests[0])
        Cassini, gamma - 1 = (2.1 +- 2.3)e-5: passes where om <= -14927.4 or om >= 39998
        """
        return tuple(SolarTest(one, getattr(self, one.parameter)) for one in MEASUREMENTS)

    @property
    def _tests(self) -> list[SolarTest]:
        """Tests of the numbers that exist."""
        numbers = self.numbers
        return [
            SolarTest(one, numbers[one.parameter])
            for one in MEASUREMENTS
            if one.parameter in numbers
        ]

    def tests_at(self, r: object) -> tuple[SolarTest, ...]:
        """gamma at one distance from the Sun beside the value of Cassini, for massive fields.

        r: in the unit of length in which the Lagrangian is written, so that 1/r is a mass.

        Raises
        ------
        GravityError
            r is not a positive number, or as `gamma_of_r`.

        Examples
        --------
        >>> from geomtorsion.gravity import perturbed
        >>> theory = perturbed.post_newtonian("R/2 + R**2/12", "riemannian")
        >>> [str(theory.tests_at(r)[0].passes) for r in (1, 20)]
        ['False', 'True']
        """
        distance = checks.expression(r, "r", GravityError, read=_number)
        if distance.is_positive is not True or not distance.is_number:
            checks.refuse(GravityError, "r", "a positive number", r)
        return (SolarTest(CASSINI, self.gamma_of_r.xreplace({DISTANCE: distance})),)

    @cached_property
    def _is_massless(self) -> bool:
        return not self.gamma_of_k.has(K) and not self.G_of_k.has(K)

    @cached_property
    def numbers(self) -> Mapping[str, sp.Expr]:
        """gamma, beta where it exists, and G by name; functions of k where a field has a mass."""
        if not self._is_massless:
            return {"gamma(k)": self.gamma_of_k, "G(k)": self.G_of_k}
        try:
            return {"gamma": self.gamma, "beta": self.beta, "G": self.G}
        except GravityError:
            # Some theories have no second order of the form 1/r^2.
            return {"gamma": self.gamma, "G": self.G}

    def to_json(self) -> dict[str, Any]:
        """Numbers and tests as plain data, with formulas as text."""
        return {
            "lagrangian": str(self.lagrangian.expression),
            "values": {x.name: str(value) for x, value in self.values.items()},
            **{name: str(value) for name, value in self.numbers.items()},
            "tests": [one.to_json() for one in self._tests],
        }

    def __str__(self) -> str:
        lines = [f"field of a mass at rest in {titled(self.lagrangian)}"]
        if self.values:
            lines[0] += ", " + ", ".join(f"{x} = {value}" for x, value in self.values.items())
        lines.append(", ".join(f"{name} = {shown(value)}" for name, value in self.numbers.items()))
        return "\n".join([*lines, *map(str, self._tests)])

    __repr__ = __str__
    _repr_html_ = drawn_by("solar_system", "post_newtonian_html")
    plot: ClassVar[Plot] = figure_by("solar_system", "draw_post_newtonian")

    def _repr_latex_(self) -> str:
        """The numbers as formulas, for papers."""
        signs = {"gamma": r"\gamma", "beta": r"\beta", "gamma(k)": r"\gamma(k)"}
        numbers = [(signs.get(x, x), shown(value)) for x, value in self.numbers.items()]
        parts = [f"{name} = {latex_of(value)}" for name, value in numbers]
        return "$" + r",\quad ".join(parts) + "$"


def _number(text: str) -> sp.Expr:
    """A number from text."""
    return parse_expression(text, {})


def _around_a_point(strength: sp.Expr) -> sp.Expr:
    """r times the potential of a point mass whose waves have this strength.

    strength/k^2 as partial fractions: r/(k^2 + m^2) is the wave of exp(-m r)/r.
    """
    q = sp.Symbol("q", positive=True)
    shape = sp.factor(strength.subs(K**2, q))
    total = shape.subs(q, 0)
    for factor, power in sp.factor_list(sp.denom(shape))[1]:
        poly = sp.Poly(factor, q)
        if not poly.degree():
            continue
        if power > 1 or poly.degree() > 1 or shape.has(K):
            raise GravityError(
                f"post_newtonian: expected fields with one mass each, got {factor} = 0 with "
                f"q = k^2 in the denominator. Use gamma_of_k = {strength}, or give numbers."
            )
        mass2 = sp.factor(poly.nth(0) / poly.nth(1))
        residue = sp.cancel(shape / q * (q + mass2)).subs(q, -mass2)
        total += residue * sp.exp(-sp.powdenest(sp.sqrt(mass2), force=True) * DISTANCE)
    return total


def _weight(system: FieldEquations) -> int:
    """2 for the coframe equation, 1 for the metric equation."""
    return 2 if system.connections[0].kind in ("levi-civita", "cartan") else 1


def _component(system: FieldEquations, order: int, index: tuple[int, ...]) -> Element:
    """A component of the equation of coframe or metric, last index up."""
    tensor = system.E if _weight(system) == 2 else system.M.raised(1)
    return tensor.order(order).element(*index)


def _rows(system: FieldEquations, order: int) -> Iterator[Element]:
    """Equations without a source: the coframe equation except its energy, and the scalar fields."""
    for i in range(4):
        for j in range(4):
            if (i, j) != (0, 0):
                yield _component(system, order, (i, j))
    for tensor in system.matter_equations.values():
        yield tensor.order(order).element()


def post_newtonian(
    lagrangian: Lagrangian | str | sp.Expr,
    geometry: str | None = None,
    *,
    scalars: str | Iterable[str] = (),
    far: Mapping[str, object] | None = None,
    constants: str | sp.Symbol | Iterable[str | sp.Symbol] = (),
    invariants: Invariant | Iterable[Invariant] = (),
) -> PostNewtonian:
    """Field of a mass at rest to second order: gamma, beta and Newton's constant of a theory.

    The mass is dust that couples to the metric. A scalar field phi has the value phi0 far away.

    Equation
    --------
    e^0 = (1 - U + (beta - 1/2) U^2) dt, e^i = (1 + gamma U + ...) dx^i, with a harmonic U outside.
    [Will, Theory and Experiment in Gravitational Physics]

    Parameters
    ----------
    lagrangian, geometry, constants, invariants
        As in `tensor_modes`. Unknown functions of invariants become their derivatives in flat
        space, f_T and f_TT of f(T), with f_0 = 0.
    scalars
        Names of scalar fields, "phi".
    far
        Values of scalar fields far away, {"phi": 1}; without them symbols, phi0.

    Raises
    ------
    GravityError
        Flat space does not solve the equations, or a static field needs more components.

    Examples
    --------
    Brans and Dicke: gamma = (1 + omega)/(2 + omega).

    >>> from geomtorsion.gravity import perturbed
    >>> theory = perturbed.post_newtonian("phi*R/2 - om*X/(2*phi)", "riemannian", scalars="phi")
    >>> theory.gamma, theory.beta
    ((om + 1)/(om + 2), 1)
    """
    name = geometry_of(lagrangian, geometry, invariants)
    if name not in WITHOUT_CONNECTION:
        raise GravityError(
            f"post_newtonian: expected a geometry of {', '.join(WITHOUT_CONNECTION)}, got {name}. "
            "List its particles with perturbed.spectrum."
        )
    fields = tuple(names_of(scalars))
    theory = written = theory_in(lagrangian, name)
    values_far = {}
    for one, value in (far or {}).items():
        checks.known_name(one, fields, "scalar field", GravityError)
        values_far[one] = checks.expression(value, f"far[{one}]", GravityError, read=_number)

    def build(potential: sp.Expr, order: int) -> FieldEquations:
        """Equations of a static field with this potential."""
        lapse, length = -potential, LENGTH * potential
        values = {one: sp.Symbol(f"{one}_1") * potential for one in fields}
        small: Sequence[sp.Expr] = [SMALL * lapse, SMALL * length]
        if order == 2:
            square = SMALL**2 * potential**2
            small = [small[0] + LAPSE2 * square, small[1] + LENGTH2 * square]
        rows = sp.diag(1 + small[0], *(3 * [1 + small[1]]))
        symbols = [SMALL, LENGTH, LAPSE2, LENGTH2, sp.Symbol("rate")]
        symbols += [sp.Symbol(f"{one}{end}") for one in fields for end in ("0", "_1", "_2")]
        frame = Frame([T, X, Y, Z], rows, signature=ETA, parameters=symbols)
        matter = []
        for one in fields:
            value = values_far.get(one, sp.Symbol(f"{one}0")) + SMALL * values[one]
            if order == 2:
                value += SMALL**2 * sp.Symbol(f"{one}_2") * potential**2
            matter.append(scalar_field(value, None if one == "phi" else one))
        connections = GEOMETRIES[name].connections(frame.expanded(SMALL, order), theory)
        return equations(connections, theory, matter, constants=constants, invariants=invariants)

    first = build(sp.exp(X), 1)
    # The second order of the equations contains the third derivative of a function.
    flat = about_flat_space(first, order=3, moving=fields)
    if flat.lagrangian is not first.lagrangian:
        theory, constants, invariants = flat.lagrangian, (), ()
        first = build(sp.exp(X), 1)
    # The value of a scalar field far away may occur in its potential.
    far_away = {f"{one}0" for one in fields}
    check_couplings(first, [K, *(x for x in first.frame.parameters if x.name not in far_away)])
    for index, x in sorted(first.E.order(0).components.nonzero.items()):
        raise GravityError(
            f"post_newtonian: expected a theory that flat space solves, got E_{index[0]}{index[1]}"
            f" = {x} there. Omit the cosmological constant, or give the values of scalar fields "
            "far away: far={'phi': 1}."
        )
    own = {sp.Symbol(str(x)) for x in first.constants} | {sp.Symbol(x) for x in far_away}
    return PostNewtonian(written, build, fields, tuple(sorted(own, key=str)))
