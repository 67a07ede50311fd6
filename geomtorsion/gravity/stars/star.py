"""Star: mass, radius, tidal Love number and moment of inertia of a ball of matter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import Any, ClassVar

import numpy as np
import sympy as sp

from geomtorsion.errors import ArgumentError, GravityError
from geomtorsion.gravity.reduced.beginning import Start
from geomtorsion.gravity.stars.first_order import MOMENT, RADIAL, SIZE, SLOPE, SPIN, TIDE
from geomtorsion.gravity.stars.first_order import love_number as love_number_of
from geomtorsion.gravity.stars.structure import SURFACE, Structure
from geomtorsion.gravity.states.equation_of_state import EquationOfState
from geomtorsion.gravity.states.matter_tables import equation_of_state
from geomtorsion.gravity.theory.field_equations import FieldEquations
from geomtorsion.ode import Solution
from geomtorsion.ode import solve as solve_ode
from geomtorsion.support import checks
from geomtorsion.support.displays import Plot, drawn_by, figure_by

Source = EquationOfState | FieldEquations | str | PathLike[str] | Sequence[Sequence[float]]


@dataclass(frozen=True, eq=False, repr=False)
class Star:
    """Star in equilibrium; numbers are in solar masses and km if the matter has units.

    matter: its equation of state. density, pressure: at the centre, in the units of the matter.
    mass, radius: as seen from outside, and the circumference of the surface over 2 pi.
    response: Love number and moment of inertia by name, empty for equations other than general
    relativity. errors: name -> estimate of the error of each of these numbers.
    solution: over the depth, from the centre to the surface, with G = c = 1.
    """

    matter: EquationOfState
    density: float
    pressure: float
    mass: float
    radius: float
    response: Mapping[str, float]
    errors: Mapping[str, float]
    solution: Solution

    @property
    def compactness(self) -> float:
        """G M/(c^2 R)."""
        return self.mass * self.matter.scale.mass / self.radius

    @property
    def love_number(self) -> float:
        """The Love number k2 of a static tide.

        Raises
        ------
        GravityError
            the theory is not general relativity.
        """
        return self._answer("love_number")

    @property
    def moment_of_inertia(self) -> float:
        """The moment of inertia of a slow rotation, mass times the square of a length.

        Raises
        ------
        GravityError
            as for `love_number`.
        """
        return self._answer("moment_of_inertia")

    @property
    def deformability(self) -> float:
        """The dimensionless tidal deformability 2 k2/3 (R/M)^5.

        Raises
        ------
        GravityError
            as for `love_number`.
        """
        return 2 / 3 * self.love_number / self.compactness**5

    def _answer(self, name: str) -> float:
        if name not in self.response:
            raise GravityError(
                f"{name}: expected a star of general relativity, got one of other field equations, "
                "whose field outside of the star is not solved. Give the equation of state to star."
            )
        return self.response[name]

    @property
    def numbers(self) -> dict[str, float]:
        """All numbers of the star by name, for tables."""
        names = ("density", "pressure", "mass", "radius", "compactness")
        table = {name: float(getattr(self, name)) for name in names}
        if self.response:
            table |= {**self.response, "deformability": self.deformability}
        return table

    def to_json(self) -> dict[str, Any]:
        """Numbers and errors as plain data."""
        return {"matter": self.matter.name, **self.numbers, "errors": dict(self.errors)}

    def __repr__(self) -> str:
        scale = self.matter.scale
        words = [
            f"mass {self.mass:.8g} {scale.mass_word}".rstrip(),
            f"radius {self.radius:.8g} {scale.length_word}".rstrip(),
        ]
        if self.response:
            words.append(f"k2 {self.love_number:.6g}")
        return f"star of {self.matter.name}: {', '.join(words)}"

    _repr_html_ = drawn_by("stars", "stars_html")
    plot: ClassVar[Plot] = figure_by("stars", "draw_stars")


def star(
    source: Source,
    *,
    density: object = None,
    pressure: object = None,
    start: Mapping[str, object] | None = None,
    parameters: Mapping[str, object] | None = None,
    near: Mapping[str, object] | None = None,
    accuracy: float = 1e-9,
) -> Star:
    """Star of an equation of state, in general relativity or another theory.

    The variable of the matter is the independent variable, so that the surface and the places where
    pieces meet are known, and the solver restarts there (Lindblom 1992). With general relativity a
    static tide (Hinderer 2008) and a slow rotation (Hartle 1967) are solved at the same time.

    Parameters
    ----------
    source
        equation of state, or a table or a name as `equation_of_state` takes it: a star in general
        relativity. Or field equations of a static frame with a radius r whose only source is
        `fluid(p=...)`.
    density, pressure
        energy density or pressure at the centre, one of them, in the units of the matter.
    start, parameters, near
        as for `solve`, at the centre, for field equations; by default A = 1 and B near 1. An
        invariant inside of a function, as T in exp(c*T), is a function S(r), by default near 0.
    accuracy
        of the solution.

    Raises
    ------
    StartError, GravityError
        the matter has no such state, or the equations do not describe a star.

    Examples
    --------
    >>> import geomtorsion as gt
    >>> matter = gt.gravity.polytropes(100, [2])
    >>> gt.gravity.star(matter, pressure=100 * 1.28e-3**2)
    star of polytrope with exponent 2: mass 1.4001..., radius 9.5856..., k2 0.0738...
    """
    structure = structure_of(source)
    return star_of(structure, structure.matter.eta_of(pressure, density), start, parameters, near,
                   accuracy)  # fmt: skip


def structure_of(source: Source) -> Structure:
    """The equations of stars of a source."""
    if isinstance(source, FieldEquations):
        return Structure.of(source)
    if source is None or isinstance(source, Mapping | bool | int | float):
        checks.refuse(
            ArgumentError,
            "matter",
            "an equation of state, a table, a name of matter or field equations",
            source,
            'Give gravity.equation_of_state("table.csv"), for example.',
        )
    return Structure.of(equation_of_state(source))


def star_of(
    structure: Structure,
    eta: float,
    start: Mapping[str, object] | None,
    parameters: Mapping[str, object] | None,
    near: Mapping[str, object] | None,
    accuracy: float,
) -> Star:
    """The star with a value of eta at its centre."""
    names = structure.reduction.states
    first = {"A": 1} if start is None and "A" in names else dict(start or {})
    # Invariants inside of functions, which vanish in flat space.
    usual = {x: 1 if x == "B" else 0 for x in names if x == "B" or x.startswith("S")}
    rough = usual if near is None else dict(near)
    problem, depth = structure.ode(sp.Rational(eta), Start(first, parameters or {}, rough))
    solution = solve_ode(problem, float(depth), accuracy)
    if not solution.complete:
        raise GravityError(
            f"star: expected a star that ends, got a solution that ends at r = "
            f"{float(solution['r'][-1]):.6g} inside of it: {solution.outcome}. Change the pressure."
        )
    return _read(structure, solution, eta)


def _read(structure: Structure, solution: Solution, eta: float) -> Star:
    """Numbers of the star from the end of its solution, with errors."""
    matter = structure.matter
    scale = matter.scale
    last = {name: float(solution[name][-1]) for name in (*solution.problem.states, "m")}
    share = {name: solution.error_of(name) for name in last}
    # The last layer, which the solution omits, has nearly the rate of growth at its end.
    states = np.array([[last[name] for name in solution.problem.states]])
    arguments = solution.problem.arguments(solution.times[-1:].astype(float), states)
    growth = np.asarray(solution.problem.rates.rate_graph.numpy()(*arguments))[:, 0]
    layer = float(SURFACE * eta * abs(growth[solution.problem.states.index("r")]))
    mass, radius = last["m"] / scale.mass, last["r"]
    share["r"] += layer / radius
    share = {name: float(x) for name, x in share.items()}
    errors = {"mass": (share["m"] + layer / radius) * abs(mass), "radius": share["r"] * radius}
    response: dict[str, float] = {}
    if structure.tides:
        k2, errors["love_number"] = _love_number(last, share)
        inertia, errors["moment_of_inertia"] = (x / scale.mass for x in _inertia(last, share))
        response = {"love_number": k2, "moment_of_inertia": inertia}
    pressure, density = matter.values(eta)
    centre = density / scale.density, pressure / scale.pressure
    return Star(matter, *centre, mass, radius, response, errors, solution)


def _love_number(last: Mapping[str, float], share: Mapping[str, float]) -> tuple[float, float]:
    """k2 and its error, from states at the surface and their relative errors."""
    compactness, y = last["m"] / last["r"], last["r"] * last[SLOPE.name] / last[TIDE.name]
    k2 = love_number_of(compactness, y)
    # Outside of the surface y is no longer a difference of larger terms.
    changes = (
        (compactness * (share["m"] + share["r"]), 0.0),
        (0.0, (1 + abs(y)) * (share[SLOPE.name] + share[TIDE.name] + share["r"])),
    )
    return k2, sum(abs(love_number_of(compactness + dc, y + dy) - k2) for dc, dy in changes)


def _inertia(last: Mapping[str, float], share: Mapping[str, float]) -> tuple[float, float]:
    """J/Omega and its error, with G = c = 1 (Hartle 1967): J = R^4 w'(R)/6, Omega = w + 2 J/R^3."""
    names = (MOMENT.name, SPIN.name, "A", RADIAL.name, SIZE.name)
    moment, spin, lapse, radial, radius = (last[name] for name in names)
    # The moment holds w'/(A B) in the unit of time of the centre, as w does.
    momentum = moment * lapse * radial / 6
    inertia = momentum / (spin + 2 * momentum / radius**3)
    return inertia, abs(inertia) * sum(share[name] for name in names)
