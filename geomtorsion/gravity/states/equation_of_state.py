"""Equation of state: pressure and density of cold matter, piece by piece."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import sympy as sp
from scipy.optimize import brentq

from geomtorsion.codegen import Graph, graph
from geomtorsion.errors import GravityError, StartError
from geomtorsion.gravity.states.units import Units, units_of
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.precision import EPS

# The variable of an equation of state, and the numbers of one of its pieces.
ETA = sp.Symbol("eta", real=True)
N, C, Q, D = NUMBERS = sp.symbols("eos_N eos_c eos_q eos_d", real=True)


@dataclass(frozen=True, eq=False, repr=False)
class EquationOfState:
    """Pressure p and energy density rho of cold matter, functions of one variable eta, by pieces.

    The variable vanishes with the pressure and increases with it. The first law
    dp/dh = p + rho holds in each piece, for the logarithm h of the enthalpy of a particle.

    name: for tables and figures.
    pressure, density: expressions in eta and the numbers of a piece, in units with G = c = 1.
    knots: eta where each piece begins, increasing from 0.
    numbers: name -> number for each piece.
    largest: eta where the last piece ends, or infinity.
    units: of the numbers that users give and read: "geometric", "cgs", "si" or "mev".

    Examples
    --------
    >>> matter = polytropes(100, [2])
    >>> matter
    polytrope with exponent 2: 1 piece
    >>> round(matter.density_at(1e-4), 9)
    0.0011
    """

    name: str
    pressure: sp.Expr
    density: sp.Expr
    knots: tuple[float, ...]
    numbers: tuple[Mapping[str, float], ...]
    largest: float = math.inf
    units: str = "geometric"

    @property
    def pieces(self) -> int:
        """How many pieces there are."""
        return len(self.knots)

    @cached_property
    def scale(self) -> Units:
        """The units of numbers that users give and read."""
        return units_of(self.units)

    def piece_of(self, eta: float) -> int:
        """The piece that a value of the variable is in, from 0."""
        return int(np.searchsorted(self.knots, eta, "right")) - 1

    def values(self, eta: float) -> tuple[float, float]:
        """Pressure and energy density for a value of the variable, G = c = 1."""
        if eta <= 0:
            return 0.0, 0.0
        table = self.numbers[self.piece_of(eta)]
        with np.errstate(all="ignore"):
            pressure, density = self._graph.numpy()(eta, *table.values())
        return float(pressure), float(density)

    @cached_property
    def _graph(self) -> Graph:
        """Pressure and density over the variable and the numbers of a piece."""
        return graph(["eta", *self.numbers[0]], [self.pressure, self.density], factor=False)

    def eta_of(self, pressure: object = None, density: object = None) -> float:
        """The variable for a pressure or an energy density in the units of the matter.

        Raises
        ------
        StartError
            the number is not positive, both or none are given, or the matter has no such state.
        """
        if (pressure is None) == (density is None):
            raise StartError(
                "expected a pressure or a density, got both or none. Give one of them."
            )
        which, value = (0, pressure) if density is None else (1, density)
        word, scale = ("pressure", self.scale.pressure) if which == 0 else (
            "density", self.scale.density
        )  # fmt: skip
        wanted = checks.positive(value, word, StartError) * scale
        high = self.largest if math.isfinite(self.largest) else max(1.0, 2 * self.knots[-1])
        while self.values(high)[which] < wanted:
            if high >= self.largest or high > 1 / EPS:
                raise StartError(
                    f"{word}: expected at most {self.values(high)[which] / scale:.6g}, where "
                    f"{self.name} ends, got {checks.shown(value)}. Give a smaller number."
                )
            high *= 2
        # A constant density is found with a rounding.
        low, least = high, wanted * (1 - 4 * EPS)
        while low > EPS**4 and self.values(low)[which] >= least:
            low /= 2
        if self.values(low)[which] >= least:
            raise StartError(
                f"{word}: expected a number that fixes the state, got {checks.shown(value)}, where "
                f"the density of {self.name} is constant. Give the pressure."
            )

        def left(logarithm: float) -> float:
            return self.values(math.exp(logarithm))[which] / wanted - 1

        root = brentq(left, math.log(low), math.log(high), xtol=EPS, rtol=4 * EPS)
        return math.exp(float(root))

    def density_at(self, pressure: object) -> float:
        """Energy density at a pressure, both in the units of the matter."""
        return self.values(self.eta_of(pressure=pressure))[1] / self.scale.density

    def pressure_at(self, density: object) -> float:
        """Pressure at an energy density, both in the units of the matter."""
        return self.values(self.eta_of(density=density))[0] / self.scale.pressure

    def __repr__(self) -> str:
        words = "1 piece" if self.pieces == 1 else f"{self.pieces} pieces"
        return f"{self.name}: {words}"


# -- polytropes ------------------------------------------------------------------------------------

# The rest-mass density r is a power of a linear function of eta = (p + rho)/r - 1.
_BASE = C + Q * ETA
_REST = D * sp.exp(N * sp.log(_BASE))
REST_PRESSURE = D / ((N + 1) * Q) * sp.exp((N + 1) * sp.log(_BASE))
REST_DENSITY = (1 + ETA) * _REST - REST_PRESSURE


def piece(index: float, base: float, slope: float, rest: float) -> dict[str, float]:
    """The numbers of one polytropic piece: r = rest (base + slope eta)^index."""
    return {N.name: index, C.name: base, Q.name: slope, D.name: rest}


def polytropes(
    constant: object,
    exponents: Sequence[object],
    densities: Sequence[object] = (),
    *,
    units: str = "geometric",
    name: str = "",
) -> EquationOfState:
    """Cold matter from pieces of polytropes, p = K r^Gamma with the rest-mass density r.

    Equation
    --------
    p = K_i r^(Gamma_i),  rho = (1 + a_i) r + p/(Gamma_i - 1),  a_0 = 0  (Read et al. 2009)

    Parameters
    ----------
    constant
        K of the first piece, pressure over density to the power Gamma in the given units.
    exponents
        Gamma of each piece, from low densities to high ones; the first is greater than 1.
    densities
        rest-mass densities at which the pieces meet, increasing.
    units
        "geometric" (G = c = 1), "cgs" (g/cm^3, dyn/cm^2), "si" or "mev" (MeV/fm^3).

    Raises
    ------
    GravityError
        a number is missing or not positive, or the densities do not increase.

    Examples
    --------
    >>> polytropes(100, [2, 3], [1e-3]).pieces
    2
    """
    scale = units_of(units)
    gammas = [
        checks.positive(x, f"exponents[{k}]", GravityError)
        for k, x in enumerate(checks.entries(exponents, "exponents", GravityError))
    ]
    where = [
        checks.positive(x, f"densities[{k}]", GravityError) * scale.density
        for k, x in enumerate(checks.entries(densities, "densities", GravityError))
    ]
    if not gammas or len(where) != len(gammas) - 1:
        raise GravityError(
            f"densities: expected {max(len(gammas) - 1, 0)}, one between any two exponents, got "
            f"{len(where)}. Give one exponent for each piece."
        )
    if any(low >= high for low, high in pairwise(where)):
        raise GravityError(
            f"densities: expected increasing numbers, got {checks.shown(list(densities))}. Order "
            "them."
        )
    if gammas[0] <= 1 or 1 in gammas:
        raise GravityError(
            f"exponents: expected a first one above 1 and no 1, got {checks.shown(gammas)}. A star "
            "of such matter has no surface."
        )
    strength = checks.positive(constant, "constant", GravityError)
    # The pressure at some density, in both units, fixes the constant in ours.
    first = where[0] if where else scale.density
    pressure = strength * (first / scale.density) ** gammas[0] * scale.pressure
    index = 1 / (gammas[0] - 1)
    eta = (index + 1) * pressure / first
    knots, pieces = [0.0], [piece(index, 0.0, 1 / eta, first)]
    for low, high, gamma in zip(where, [*where[1:], math.inf], gammas[1:], strict=False):
        index = 1 / (gamma - 1)
        slope = low / (pressure * (index + 1))
        knots.append(eta)
        pieces.append(piece(index, 1 - slope * eta, slope, low))
        if high < math.inf:
            ratio = high / low
            eta += (ratio ** (gamma - 1) - 1) / slope
            pressure *= ratio**gamma
    word = "polytrope with exponent" if len(gammas) == 1 else "polytropes with exponents"
    title = name or f"{word} {', '.join(f'{gamma:g}' for gamma in gammas)}"
    return EquationOfState(
        title, REST_PRESSURE, REST_DENSITY, tuple(knots), tuple(pieces), units=units
    )


def energy_polytrope(
    constant: object, exponent: object, *, units: str = "geometric"
) -> EquationOfState:
    """Cold matter with p = K rho^Gamma, a power of the energy density rho (Tooper 1964).

    constant: K in the given units. exponent: Gamma > 1. units: as for `polytropes`.

    Raises
    ------
    GravityError
        a number is not positive, or the exponent is not above 1.

    Examples
    --------
    >>> round(energy_polytrope(100, 2).pressure_at(1e-3), 12)
    0.0001
    """
    scale = units_of(units)
    gamma = checks.positive(exponent, "exponent", GravityError)
    if gamma <= 1:
        raise GravityError(f"exponent: expected a number above 1, got {checks.shown(exponent)}.")
    strength = checks.positive(constant, "constant", GravityError)
    index = 1 / (gamma - 1)
    # eta = p/rho = K rho^(1/n), and rho = d eta^n.
    unit_eta = strength * scale.pressure / scale.density
    rest = scale.density * unit_eta**-index
    density = D * sp.exp(N * sp.log(ETA))
    return EquationOfState(
        f"polytrope of the energy density with exponent {gamma:g}",
        D * sp.exp((N + 1) * sp.log(ETA)),
        density,
        (0.0,),
        ({N.name: index, D.name: rest},),
        units=units,
    )


def incompressible(density: object, *, units: str = "geometric") -> EquationOfState:
    """Matter of a constant energy density, at any pressure (Schwarzschild 1916).

    density: in the given units. units: as for `polytropes`.

    Raises
    ------
    GravityError
        the density is not positive.

    Examples
    --------
    >>> round(incompressible(1e-3).density_at(1e-4), 12)
    0.001
    """
    size = checks.positive(density, "density", GravityError) * units_of(units).density
    numbers = piece(0.0, 0.0, 1.0, size)
    return EquationOfState(
        "matter of constant density", REST_PRESSURE, REST_DENSITY, (0.0,), (numbers,), units=units
    )
