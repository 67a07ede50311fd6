"""Spectrum: the particles of a theory about flat space, with mass, spin, parity and energy."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import sympy as sp

from geomtorsion.errors import GravityError, SingularPointError
from geomtorsion.gravity.perturbed.blocks import VARIABLE, Block, Waves
from geomtorsion.gravity.perturbed.conditions import all_positive, positive_part, positive_roots
from geomtorsion.gravity.perturbed.geometries import (
    GEOMETRIES,
    Component,
    check_couplings,
    geometry_of,
    names_of,
    replacements,
    small_frame,
    small_matter,
    theory_in,
    titled,
)
from geomtorsion.gravity.perturbed.sectors import Sector, helicities, spins
from geomtorsion.gravity.perturbed.taylor import about_flat_space
from geomtorsion.gravity.theory.field_equations import equations
from geomtorsion.gravity.theory.invariants import Invariant
from geomtorsion.gravity.theory.lagrangian import Lagrangian
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import Plot, drawn_by, figure_by, latex_of

# Frequency and wave number of a wave exp(i k z - i w t), in the factors of field equations.
FREQUENCY, WAVE_NUMBER = sp.symbols("w k")


@dataclass(frozen=True, kw_only=True)
class Particle:
    """One kind of particle.

    spin: spin of a massive particle, size of the helicity of a massless one.
    parity: +1 or -1; 0 where terms of both parities mix, and for massless particles.
    mass2: the square of the mass, a formula in the couplings; None where only `equation` is known.
        The particle is then one for each root.
    equation: polynomial in m2 that the square of the mass solves.
    energy: an expression in the couplings, and m2 where mass2 is None, that has the sign of the
        energy; None for a dipole (a double pole).
    number: of independent modes.
    """

    spin: int
    parity: int
    mass2: sp.Expr | None
    equation: sp.Expr
    energy: sp.Expr | None
    number: int

    @property
    def is_massless(self) -> bool:
        """Whether it moves with the speed of light."""
        return self.mass2 == 0

    @property
    def is_tachyon(self) -> bool:
        """Whether its mass^2 is a number that is not positive."""
        mass2 = self.mass2
        return mass2 is not None and mass2 != 0 and (mass2.is_negative or mass2.is_real is False)

    @property
    def is_dipole(self) -> bool:
        """Whether its propagator has a double pole, so that its waves grow in time."""
        return self.energy is None

    @property
    def factor(self) -> sp.Expr:
        """Factor of the field equations on a wave exp(i k z - i w t): w^2 - k^2 - m^2."""
        place = FREQUENCY**2 - WAVE_NUMBER**2
        return place - self.mass2 if self.mass2 is not None else self.equation.subs(VARIABLE, place)

    @property
    def label(self) -> str:
        """Spin and parity, 2+, or the helicities, +-2."""
        if self.is_massless:
            return f"+-{self.spin}" if self.spin else "0"
        return f"{self.spin}{'-+'[self.parity > 0] if self.parity else ''}"

    def to_json(self) -> dict[str, Any]:
        """The particle as plain data, with formulas as text."""
        return {
            "spin": self.spin,
            "parity": self.parity,
            "massless": self.is_massless,
            "mass2": None if self.mass2 is None else str(self.mass2),
            "equation": str(self.equation),
            "energy": None if self.energy is None else str(self.energy),
            "factor": str(self.factor),
            "number": self.number,
        }

    def __str__(self) -> str:
        kind = "massless, helicity " if self.is_massless else "spin "
        mass = "" if self.is_massless else f", m^2 = {self.mass2}"
        if self.mass2 is None:
            mass = f", m^2 from {self.equation} = 0"
        elif self.is_tachyon:
            mass += " (tachyon)"
        energy = f"double pole ({self.factor})**2"
        if self.energy is not None:
            energy = f"energy {_energy_text(self.energy)}"
        modes = f"{self.number} mode{'s' if self.number > 1 else ''}"
        return f"{kind}{self.label}{mass}, {energy}, {modes}"


def _latex_row(one: Particle) -> str:
    """A particle as a row of an array in LaTeX."""
    spin = rf"\pm {one.spin}" if one.is_massless and one.spin else f"{one.spin}"
    if not one.is_massless and one.parity:
        spin += f"^{{{'-+'[one.parity > 0]}}}"
    mass = f"m^2 = {latex_of(one.mass2)}"
    if one.mass2 is None:
        mass = f"{latex_of(one.equation.subs(VARIABLE, sp.Symbol('m') ** 2))} = 0"
    energy = rf"\text{{double pole }} \left({latex_of(one.factor)}\right)^2"
    if one.energy is not None:
        energy = rf"\text{{energy {_energy_text(one.energy)}}}"
        if not one.energy.is_number:
            energy = rf"\text{{energy of the sign of }} {latex_of(one.energy)}"
    return f"{spin} & {mass} & {energy} & {one.number}"


def _energy_text(energy: sp.Expr) -> str:
    if energy.is_positive:
        return "positive"
    if energy.is_negative:
        return "negative (ghost)"
    return f"of the sign of {energy}"


@dataclass(frozen=True, eq=False, repr=False)
class Spectrum:
    """Particles of a theory about flat space.

    lagrangian: the theory. geometry: the name of its geometry. waves: the operator.
    components: the small fields. conditions: values of unknown functions for which flat space is a
    solution, f_0 = 0.

    Examples
    --------
    >>> from geomtorsion.gravity import perturbed
    >>> print(perturbed.spectrum("R/2 + c*R**2", "riemannian"))
    particles of L = R/2 + c*R**2 (riemannian)
    2 particles, 3 degrees of freedom, 10 gauge functions
    massless, helicity +-2, energy positive, 2 modes
    spin 0+, m^2 = 1/(12*c), energy positive, 1 mode
    healthy where c > 0
    """

    lagrangian: Lagrangian
    geometry: str
    waves: Waves
    components: tuple[Component, ...]
    conditions: Mapping[sp.Symbol, sp.Expr] = field(default_factory=dict)

    @cached_property
    def particles(self) -> tuple[Particle, ...]:
        """All particles: massless ones first, then by spin and parity."""
        return (*self._massless(), *self._massive)

    @property
    def gauge(self) -> int:
        """The number of gauge functions: combinations of fields that the equations leave free."""
        return self.waves.size - self.waves.rank

    @property
    def degrees_of_freedom(self) -> int:
        """The number of independent modes."""
        return sum(one.number for one in self.particles)

    @cached_property
    def lorentz_violating(self) -> tuple[sp.Expr, ...]:
        """Factors of waves along z that belong to no particle, as polynomials in w for k = 1.

        Empty for each Lagrangian that has no preferred direction.
        """
        blocks = [
            self.waves.block(sector, at_rest=False)
            for sector in _coupled(self.waves, helicities(self.components), at_rest=False)
        ]
        if sum(one.divisor.degree() for one in blocks) == 2 * self.degrees_of_freedom:
            return ()
        known = [one.factor.subs(WAVE_NUMBER, 1) for one in self.particles]
        waves = sp.prod(sp.fraction(sp.together(x))[0] for x in known)
        found: dict[sp.Expr, None] = {}
        for block in blocks:
            for factor in block.factors:
                one = factor.as_expr().subs(VARIABLE, FREQUENCY)
                if block.multiplicity(factor) and sp.rem(waves, one, FREQUENCY) != 0:
                    found[one] = None
        return tuple(found)

    @cached_property
    def healthy(self) -> sp.Basic:
        """The condition in the couplings that there is no ghost and no tachyon.

        True or False where it holds for all couplings or for none.
        """
        if self.lorentz_violating:
            return sp.false
        return self._condition(1)

    @cached_property
    def healthy_opposite(self) -> sp.Basic:
        """The condition in the couplings that -L, the opposite of the Lagrangian, is healthy.

        The sign of L multiplies the energies of all particles, and no equation in a vacuum shows
        it. L = T is -R up to a divergence, so that gravitons of -T have positive energy.
        """
        return sp.false if self.lorentz_violating else self._condition(-1)

    def _condition(self, sign: int) -> sp.Basic:
        """The condition that there is no ghost and no tachyon; sign: of the Lagrangian."""
        expressions: list[sp.Expr] = []
        for one in self.particles:
            if one.energy is None:
                return sp.false
            energy = one.energy * sign
            if one.mass2 is None:
                expressions += positive_roots(sp.Poly(one.equation, VARIABLE), energy)
            elif one.is_tachyon:
                return sp.false
            else:
                expressions += [energy] if one.is_massless else [one.mass2, energy]
        return all_positive(expressions)

    def subs(self, values: Mapping[Any, object] | None = None, **named: object) -> Spectrum:
        """The spectrum for values of couplings, counted again.

        A particle whose mass goes to infinity at these values is omitted.

        Examples
        --------
        >>> from geomtorsion.gravity import perturbed
        >>> perturbed.spectrum("R/2 + c*R**2", "riemannian").subs(c=0).degrees_of_freedom
        2
        """
        replaced = replacements(self.waves.couplings, {**(values or {}), **named})
        return replace(self, waves=self.waves.subs(replaced))

    def __str__(self) -> str:
        count = len(self.particles)
        title = f"particles of {titled(self.lagrangian, self.geometry)}"
        head = f"{count} particle{'s' if count != 1 else ''}, {self.degrees_of_freedom} degrees of "
        head += f"freedom, {self.gauge} gauge functions"
        if self.conditions:
            head += f", for {', '.join(f'{x} = {y}' for x, y in self.conditions.items())}"
        odd = [
            f"not Lorentz invariant: waves with {x} = 0 for k = 1" for x in self.lorentz_violating
        ]
        last = _healthy_text(self.healthy)
        if self.healthy == sp.false and self.healthy_opposite != sp.false:
            other = _healthy_text(self.healthy_opposite)
            last += f"\nthe opposite action, L = -({self.lagrangian.expression}): {other}"
        return "\n".join([title, head, *map(str, self.particles), *odd, last])

    __repr__ = __str__

    def to_latex(self) -> str:
        r"""The particles as an `array`: spin, squared mass, sign of the energy, number of modes.

        `sympy.latex(spectrum)` gives the same.

        Examples
        --------
        >>> from geomtorsion.gravity import perturbed
        >>> print(perturbed.spectrum("R/2", "riemannian").to_latex())
        \begin{array}{llll} \pm 2 & m^2 = 0 & \text{energy positive} & 2 \end{array}
        """
        if not self.particles:
            return r"\text{no particles}"
        body = r" \\ ".join(_latex_row(one) for one in self.particles)
        return rf"\begin{{array}}{{llll}} {body} \end{{array}}"

    def _latex(self, _: object) -> str:
        return self.to_latex()

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {self.to_latex()}$"

    _repr_html_ = drawn_by("particles", "spectrum_html")
    plot: ClassVar[Plot] = figure_by("particles", "draw_particles")

    def to_json(self) -> dict[str, Any]:
        """Particles and counts as plain data, with formulas as text."""
        return {
            "lagrangian": str(self.lagrangian.expression),
            "geometry": self.geometry,
            "conditions": {x.name: str(y) for x, y in self.conditions.items()},
            "degrees_of_freedom": self.degrees_of_freedom,
            "gauge_functions": self.gauge,
            "particles": [one.to_json() for one in self.particles],
            "lorentz_violating": [str(x) for x in self.lorentz_violating],
            "healthy": str(self.healthy),
            "healthy_opposite": str(self.healthy_opposite),
        }

    # -- particles at rest -----------------------------------------------------------------------

    @cached_property
    def _massive(self) -> tuple[Particle, ...]:
        return tuple(
            one
            for sector in _coupled(self.waves, spins(self.components), at_rest=True)
            for one in _particles(self.waves.block(sector, at_rest=True))
        )

    # -- along the light cone --------------------------------------------------------------------

    def _massless(self) -> list[Particle]:
        particles = []
        for sector in _coupled(self.waves, helicities(self.components), at_rest=False):
            helicity, mirror = sector.label
            # Both mirror signs of a helicity have the same waves.
            if helicity and mirror < 0:
                continue
            block = self.waves.block(sector, at_rest=False)
            w = sp.Dummy("w")
            count = block.multiplicity(sp.Poly(w - 1, w))
            if not count:
                continue
            share = 2 if helicity and mirror else 1
            weights = block.modes(sp.S.One)
            rest = (count - len(weights)) * share
            energies = [positive_part(weight.sympy) for weight in weights]
            if helicity and not mirror:
                # Terms of odd parity mix both mirror signs, and each wave occurs twice.
                pairs = [x for x in dict.fromkeys(energies) for _ in range(energies.count(x) // 2)]
                particles += [_massless(helicity, energy, 2) for energy in pairs]
                energies = [x for x in dict.fromkeys(energies) if energies.count(x) % 2]
            particles += [_massless(helicity, energy, share) for energy in energies]
            if rest:
                particles.append(_massless(helicity, None, rest))
        return particles


def _massless(helicity: int, energy: sp.Expr | None, number: int) -> Particle:
    return Particle(
        spin=helicity, parity=0, mass2=sp.S.Zero, equation=VARIABLE, energy=energy, number=number
    )


def _coupled(waves: Waves, sectors: list[Sector], *, at_rest: bool) -> list[Sector]:
    """Sectors; both parities of a spin are one sector where terms of odd parity mix them."""
    joined: list[Sector] = []
    for sector in sectors:
        partner = next((one for one in joined if one.label[0] == sector.label[0]), None)
        if partner is not None and waves.couples(partner, sector, at_rest):
            joined[joined.index(partner)] = partner.joined(sector)
        else:
            joined.append(sector)
    return joined


def _particles(block: Block) -> Iterator[Particle]:
    """Massive particles of a block at rest."""
    spin, parity = block.sector.label
    for factor in block.factors:
        if factor.as_expr() == VARIABLE or not (count := block.multiplicity(factor)):
            continue
        # Mass and energy of one or more particles.
        kinds: list[tuple[sp.Expr | None, sp.Expr | None, int]] = []
        if factor.degree() == 1:
            mass2 = sp.factor(-factor.nth(0) / factor.nth(1))
            weights = block.modes(mass2)
            kinds = [(mass2, positive_part(x.sympy), 1) for x in weights]
            if count > len(kinds):
                kinds.append((mass2, None, count - len(kinds)))
        else:
            weight = block.weight(factor) if count == 1 else None
            if factor.free_symbols_in_domain:
                kinds = [(None, weight and positive_part(weight), count * factor.degree())]
            else:
                for root in factor.all_roots():
                    energy = weight and sp.sign(weight.xreplace({VARIABLE: root}).evalf(50))
                    kinds.append((root, energy, count))
        for mass2, energy, number in kinds:
            yield Particle(
                spin=spin,
                parity=parity,
                mass2=mass2,
                equation=factor.as_expr(),
                energy=energy,
                number=number * (2 * spin + 1),
            )


def _healthy_text(condition: sp.Basic) -> str:
    if condition == sp.true:
        return "healthy: no ghost, no tachyon"
    if condition == sp.false:
        return "not healthy for any couplings: a ghost, a tachyon or a double pole remains"
    parts = condition.args if isinstance(condition, sp.And) else (condition,)
    return f"healthy where {', '.join(map(str, parts))}"


def spectrum(
    lagrangian: Lagrangian | str | sp.Expr,
    geometry: str | None = None,
    *,
    scalars: str | Iterable[str] = (),
    vectors: int = 0,
    constants: str | sp.Symbol | Iterable[str | sp.Symbol] = (),
    invariants: Invariant | Iterable[Invariant] = (),
) -> Spectrum:
    """Particles of a theory of gravity about flat space, exactly.

    Parameters
    ----------
    lagrangian
        As in `gravity.equations`; couplings stay symbols. Unknown functions become their values and
        derivatives in flat space: f_0, f_R, f_RR of f(R), where f_0 = 0 makes it a solution.
    geometry
        "riemannian", "teleparallel", "symmetric teleparallel", "poincare" (metric connection with
        torsion) or "metric-affine". By default the geometry of a `gravity.Lagrangian`, or the
        geometry with the fewest fields in which no invariant vanishes: riemannian for R,
        teleparallel for T, symmetric teleparallel for Q, poincare for R and T.
    scalars
        Names of scalar fields, "phi" or "phi chi"; the first has the kinetic term X.
    vectors
        Number of vector fields, which the Lagrangian names F2, F2_2, ...
    constants, invariants
        As in `gravity.equations`.

    Returns
    -------
    Spectrum

    Raises
    ------
    GravityError
        Flat space is not a solution, or the Lagrangian is not one of the geometry.

    Examples
    --------
    >>> from geomtorsion.gravity import perturbed
    >>> perturbed.spectrum("T", "teleparallel").degrees_of_freedom
    2
    """
    name = geometry_of(lagrangian, geometry, invariants)
    kind = GEOMETRIES[name]
    frame, fields = small_frame()
    matter, more = small_matter(
        names_of(scalars), checks.count(vectors, "vectors", GravityError, 0)
    )
    components = [*fields, *kind.fields, *more]
    theory = theory_in(lagrangian, name)
    connections = kind.connections(frame, theory)
    system = equations(connections, theory, matter, constants=constants, invariants=invariants)
    check_couplings(system, [VARIABLE])
    flat = about_flat_space(system, order=2)
    if flat.lagrangian is not system.lagrangian:
        system = equations(connections, flat.lagrangian, matter)
    try:
        operator = system.operator([one.function for one in components])
    except SingularPointError:
        raise GravityError(
            "spectrum: expected a Lagrangian with a power series about flat space, where "
            f"invariants and fields vanish, got {theory.expression}. Write 1 + phi for a field "
            "that is 1 in flat space; terms such as 1/R have no particles there."
        ) from None
    return Spectrum(theory, name, Waves.of(operator), tuple(components), flat.conditions)
