"""Structure of a star: its equations over the variable of the matter, from the centre outwards."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import sympy as sp

from geomtorsion.errors import GravityError
from geomtorsion.exact import Element
from geomtorsion.geometry import Frame, levi_civita
from geomtorsion.gravity.reduced.beginning import Start
from geomtorsion.gravity.reduced.reduction import Reduction
from geomtorsion.gravity.stars import first_order
from geomtorsion.gravity.stars.first_order import SIZE, R
from geomtorsion.gravity.states.equation_of_state import ETA, EquationOfState
from geomtorsion.gravity.theory.field_equations import FieldEquations, equations
from geomtorsion.gravity.theory.fluids import Fluid
from geomtorsion.gravity.theory.residuals import names_of_inner
from geomtorsion.ode import ODE, At
from geomtorsion.support.caching import cached_property

T, THETA, PHI = sp.symbols("t theta phi")
# Below this share of its value at the centre the variable counts as zero: far below any accuracy.
SURFACE = sp.Rational(1, 2**40)
# The variable that grows from the centre to the surface is eta at its start minus eta.
_DEPTH, _FIRST = sp.Symbol("depth", real=True), sp.Symbol("eta_0", real=True)


@dataclass(frozen=True, eq=False)
class Structure:
    """Equations of stars of one kind of matter in a theory, reduced to functions of a radius.

    reduction: over eta and the functions of the frame; 4 pi r^2 is the area of a sphere.
    matter: its equation of state. mass: inside of a sphere, over the states.
    tides: whether the first order of general relativity is solved as well.
    """

    reduction: Reduction
    matter: EquationOfState
    mass: sp.Expr
    tides: bool

    @classmethod
    def of(cls, source: EquationOfState | FieldEquations) -> Structure:
        """The equations of a star in general relativity, or of equations with such a fluid."""
        if isinstance(source, EquationOfState):
            reduction = _general(source.pressure, source.density, True)
            return cls(reduction, source, _mass(_frame()), True)
        matter = [x.matter for x in source.matter if isinstance(x, Fluid) and x.matter is not None]
        if len(matter) != 1:
            raise GravityError(
                "equations: expected one fluid with an equation of state, got "
                f"{len(matter)}. Give gravity.fluid(p=...) to gravity.equations."
            )
        frame = source.frame
        radial = next((x for x in frame.coordinates if x.name == "r"), None)
        if radial is None or not (_area(frame) - frame.field.read(radial**2)).is_zero:
            raise GravityError(
                "equations: expected a coordinate r such that 4 pi r^2 is the area of a sphere, "
                f"got the coordinates {', '.join(map(str, frame.coordinates))}. Write the "
                "frame with this radius."
            )
        if _is_general(source):
            return cls.of(matter[0])
        reduction = source.reduce("r", names_of_inner(source.inner, "r"))
        return cls(reduction, matter[0], _mass(frame), False)

    @cached_property
    def background(self) -> Structure:
        """The same equations without the first order, which is faster."""
        if not self.tides:
            return self
        reduction = _general(self.matter.pressure, self.matter.density, False)
        return replace(self, reduction=reduction, tides=False)

    @cached_property
    def _rates(self) -> dict[str, sp.Expr]:
        """State -> its derivative by the depth eta_0 - eta, the radius among the states."""
        rates = dict(self.reduction.rates)
        if self.tides:
            rates = {name: rates[name] for name in ("A", "B", "eta")}
            rates |= first_order.rates(self.matter.pressure, self.matter.density)
        # The symbols of the reduction, by name.
        table = {
            x: sp.Symbol(x.name, real=True) for one in rates.values() for x in one.free_symbols
        }
        rates = {name: one.xreplace(table) for name, one in rates.items()}
        falling = -rates.pop("eta")
        rates["r"] = sp.S.One
        here = {ETA: _FIRST - _DEPTH}
        return {name: (one / falling).xreplace(here) for name, one in rates.items()}

    def ode(self, eta: sp.Expr, start: Start) -> tuple[ODE, sp.Expr]:
        """The equations of the star with a value of eta at its centre, and its depth."""
        # A centre where two pieces meet belongs to the lower one: both agree there.
        pieces, last = self.matter.numbers, self.matter.piece_of(float(eta * (1 - SURFACE)))
        numbers = {**start.parameters, **pieces[last]}
        centre = {**start.values, "eta": eta, **({"K": 1, "w": 1} if self.tides else {})}
        beginning = self.reduction.beginning(replace(start, values=centre, parameters=numbers))
        place, values = beginning.first
        knot = sp.Rational(self.matter.knots[last])
        if values["eta"] <= knot:
            # Within this piece: eta falls with the square of the radius.
            share = sp.sqrt((eta - knot) / (eta - values["eta"])) / 2
            reach = place * sp.Rational(2) ** sp.floor(sp.log(share, 2).evalf())
            place, values = beginning.within(reach)
        values = dict(values)
        first = values.pop("eta")
        values["r"] = place
        if self.tides:
            there = {ETA: first} | {sp.Symbol(x, real=True): y for x, y in pieces[last].items()}
            pair = [
                x.xreplace(there).evalf(40) for x in (self.matter.pressure, self.matter.density)
            ]
            values |= first_order.start(place, values, *pair)
        events = [
            At(float(first - sp.Rational(self.matter.knots[k + 1])), pieces[k])
            for k in range(last - 1, -1, -1)
        ]
        problem = ODE.of(
            self._rates,
            {name: values[name] for name in self._rates},
            parameters={**numbers, "eta_0": first},
            outputs={"m": self.mass, "p": self.matter.pressure.xreplace({ETA: _FIRST - _DEPTH}),
                     "rho": self.matter.density.xreplace({ETA: _FIRST - _DEPTH})},
            time="depth",
            events=events,
            name=f"star of {self.matter.name}",
        )  # fmt: skip
        return problem, first * (1 - SURFACE)


def _frame() -> Frame:
    """A static metric whose spheres have the radius r."""
    legs = sp.diag(first_order.A, first_order.B, R, R * sp.sin(THETA))
    return Frame([T, R, THETA, PHI], legs, (-1, 1, 1, 1))


def _is_general(source: FieldEquations) -> bool:
    """Whether field equations are the ones of general relativity for the static metric here."""
    scalars = {"levi-civita": sp.Symbol("R"), "cartan": -sp.Symbol("T")}
    kinds = [one.kind for one in source.connections]
    if len(kinds) > 1 or len(source.matter) > 1:
        return False
    scalar = scalars.get(kinds[0])
    own, other = (x.metric.to_sympy() for x in (source.frame, _frame()))
    return scalar is not None and source.expression == scalar / (16 * sp.pi) and own == other


@lru_cache(maxsize=8)
def _general(pressure: sp.Expr, density: sp.Expr, tides: bool) -> Reduction:
    """General relativity for a kind of matter, perhaps with its first order about the star."""
    at = {ETA: first_order.X}
    fluid = Fluid(density.xreplace(at), pressure.xreplace(at), [1, 0, 0, 0])
    theory = equations(levi_civita(_frame()), "R/(16*pi)", fluid)
    return theory.reduce("r", first_order.conditions(pressure, density) if tides else ())


def _area(frame: Frame) -> Element:
    """The square of the radius of a sphere: g_theta_theta."""
    names = [x.name for x in frame.coordinates]
    k = names.index("theta") if "theta" in names else 2
    return frame.metric.components.get((k, k))


def _mass(frame: Frame) -> sp.Expr:
    """The mass inside of a sphere, (r/2)(1 - g^rr) (Misner, Sharp 1964)."""
    k = [x.name for x in frame.coordinates].index("r")
    expression = frame.inverse_metric.components.get((k, k)).sympy
    table = {
        x: sp.Symbol(x.func.__name__, real=True)
        for x in expression.atoms(sp.core.function.AppliedUndef)
    }
    radial = frame.coordinates[k]
    return (radial * (1 - expression) / 2).xreplace({**table, radial: SIZE})
