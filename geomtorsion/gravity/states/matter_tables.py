"""Matter tables: equations of state from files and rows of numbers, and published ones."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from os import PathLike

import numpy as np
import sympy as sp
from scipy.integrate import quad
from scipy.interpolate import CubicSpline, PchipInterpolator

from geomtorsion.errors import FileFormatError, GravityError
from geomtorsion.gravity.states.equation_of_state import (
    ETA,
    NUMBERS,
    EquationOfState,
    polytropes,
)
from geomtorsion.gravity.states.units import units_of
from geomtorsion.support import checks
from geomtorsion.support.files import finite_number, read_text
from geomtorsion.support.text_rows import lines_of

# Within a row p = exp(a + b log(eta) + c eta + d eta^2), which has the pressures and densities of
# both ends.
_A, _B, _C, _D = NUMBERS
_PRESSURE = sp.exp(_A + _B * sp.log(ETA) + _C * ETA + _D * ETA**2)
_DENSITY = _PRESSURE * ((1 + ETA) / ETA * (_B + _C * ETA + 2 * _D * ETA**2) - 1)
_WAYS = {"monotone": PchipInterpolator, "cubic": CubicSpline}

# Read, Lackey, Owen, Friedman, Phys. Rev. D 79, 124032 (2009), tables II and III: exponents and
# densities of the crust in g/cm^3 after its first constant in cgs; logarithm of the pressure at the
# first density of the core, and three exponents of the core.
_CRUST = (
    6.80110e-9 * 2.99792458e10**2,
    (1.58425, 1.28733, 0.62223, 1.35692),
    (2.44034e7, 3.78358e11, 2.62780e12),
)
_CORE = (10**14.7, 1e15)
_CORES = {
    "SLy": (34.384, 3.005, 2.988, 2.851),
    "APR4": (34.269, 2.830, 3.445, 3.348),
    "WFF1": (34.031, 2.519, 3.791, 3.660),
    "ENG": (34.437, 3.514, 3.130, 3.168),
    "MPA1": (34.495, 3.446, 3.572, 2.887),
    "MS1": (34.858, 3.224, 3.033, 1.325),
    "H4": (34.669, 2.909, 2.246, 2.144),
}


def equation_of_state(
    source: str | PathLike[str] | Sequence[Sequence[float]] | EquationOfState,
    *,
    units: str | None = None,
    interpolation: str = "monotone",
) -> EquationOfState:
    """Equation of state of a table, or of published neutron matter by its name.

    Between two rows the logarithm of the pressure is a smooth function with the pressures and
    densities of both rows that obeys the first law. Below the first row the matter is a polytrope
    with the exponent of the first two rows. A star cannot have a higher pressure than the last row.

    Parameters
    ----------
    source
        A CSV file with a column of pressures and a column of energy densities, both increasing and
        positive; the columns are found by the names p or pressure and rho, e, eps, density or
        energy_density in the first row; without names the pressure is the first column. Or the rows
        as an array, shape (m, 2). Or the name of matter of Read et al. (2009): SLy, APR4, WFF1,
        ENG, MPA1, MS1 or H4.
    units
        Units of all numbers that are read and returned, as for `polytropes`; by default "geometric"
        for a table, and "cgs" for published matter.
    interpolation
        "monotone" or "cubic": interpolation of the logarithm of the density over the logarithm of
        the pressure, for the integral of the enthalpy.

    Raises
    ------
    FileFormatError, GravityError
        the file or the rows hold no such table.

    Examples
    --------
    >>> p = [1e-7, 1e-6, 1e-5, 1e-4]
    >>> table = equation_of_state([(x, (x / 100) ** 0.5 + x) for x in p])
    >>> table
    table: 4 pieces
    >>> equation_of_state("SLy")
    SLy: 7 pieces
    """
    if units is not None:
        units_of(units)
    if isinstance(source, EquationOfState):
        return source if units is None else replace(source, units=units)
    if isinstance(source, str) and source in _CORES:
        return replace(_published(source), units=units or "cgs")
    units = units or "geometric"
    if isinstance(source, str | PathLike):
        path = checks.file_name(source)
        if isinstance(source, str) and "." not in path.name and not path.exists():
            checks.known_name(
                source, _CORES, "matter", GravityError, expected="a file or the name of matter"
            )
        return from_rows(*_read(source), units, interpolation, path.stem)
    entries = checks.entries(source, "rows", GravityError)
    rows = [
        checks.numbers(row, 2, f"rows[{k}]", GravityError, expected="a pressure and a density")
        for k, row in enumerate(entries)
    ]
    table = np.array(rows, dtype=float).reshape(-1, 2)
    return from_rows(table, [f"rows[{k}]" for k in range(len(rows))], units, interpolation, "table")


def _published(name: str) -> EquationOfState:
    """Polytropes of Read et al.: the crust meets the core where their pressures agree."""
    logarithm, *exponents = _CORES[name]
    first, crust, densities = _CRUST
    constant, last = first, crust[0]
    for density, exponent in zip(densities, crust[1:], strict=True):
        constant *= density ** (last - exponent)
        last = exponent
    core = 10**logarithm / _CORE[0] ** exponents[0]
    meeting = (constant / core) ** (1 / (exponents[0] - last))
    return polytropes(
        first,
        [*crust, *exponents],
        [*densities, meeting, *_CORE],
        units="cgs",
        name=name,
    )


_NAMES = {
    "pressure": ("p", "pressure"),
    "density": ("rho", "e", "eps", "epsilon", "density", "energy_density"),
}


def _read(source: str | PathLike[str]) -> tuple[np.ndarray, list[str]]:
    """Pressures and densities of a CSV file, shape (m, 2), and the place of each row."""
    path = checks.file_name(source)
    columns, rows, places = [0, 1], [], []
    for number, line in enumerate(lines_of(read_text(path)), 1):
        text = line.partition("#")[0].strip().rstrip(",;")
        if not text:
            continue
        words = [word.strip().strip('"') for word in text.replace(";", ",").split(",")]
        if len(words) == 1:
            words = text.split()
        place = f"{path.name}: line {number}"
        if not rows and finite_number(words[0]) is None:
            columns = [_column(words, names, place) for names in _NAMES.values()]
            continue
        if len(words) <= max(columns):
            raise FileFormatError(
                f"{place}: expected a pressure and a density, got {checks.shown(text)}. Write two "
                "numbers with a comma."
            )
        pair = [finite_number(words[k]) for k in columns]
        if None in pair:
            raise FileFormatError(
                f"{place}: expected finite numbers, got {checks.shown(text)}. Correct the row."
            )
        rows.append(pair)
        places.append(place)
    return np.array(rows, dtype=float).reshape(-1, 2), places


def _column(words: Sequence[str], names: Sequence[str], place: str) -> int:
    """The place of the column that has one of some names, with or without a unit in brackets."""
    plain = [word.lower().replace("[", "(").partition("(")[0].strip() for word in words]
    for k, word in enumerate(plain):
        if word in names:
            return k
    raise FileFormatError(
        f"{place}: expected a column named {' or '.join(names)}, got {', '.join(words)}. Name the "
        "columns pressure and density."
    )


def from_rows(
    table: np.ndarray, places: Sequence[str], units: str, interpolation: str, name: str
) -> EquationOfState:
    """The equation of state of rows of pressures and energy densities, shape (m, 2)."""
    way = _WAYS[checks.choice(interpolation, tuple(_WAYS), "interpolation", GravityError)]
    scale = units_of(units)
    if len(table) < 3:
        raise FileFormatError(
            f"{name}: expected three or more rows of a pressure and a density, got {len(table)}. "
            "Give more rows."
        )
    for k, (pressure, density) in enumerate(table):
        if not (0 < pressure < math.inf and 0 < density < math.inf):
            raise FileFormatError(
                f"{places[k]}: expected positive numbers, got pressure {pressure:g} and density "
                f"{density:g}. Omit the row."
            )
        if k and not (pressure > table[k - 1, 0] and density > table[k - 1, 1]):
            raise FileFormatError(
                f"{places[k]}: expected a larger pressure and a larger density than in the row "
                f"before, got pressure {pressure:g} and density {density:g}. Order the rows, and "
                "give a jump of the density a small step of the pressure."
            )
    p, rho = table[:, 0] * scale.pressure, table[:, 1] * scale.density
    first = math.log(rho[1] / rho[0]) / math.log(p[1] / p[0])
    # A polytrope of the rest mass: eta = (n + 1) p/r, and rho = r + n p.
    index = first / (1 - first) if first < 1 else math.inf
    start = (index + 1) * p[0] / (rho[0] - index * p[0])
    if not (0 < start < math.inf):
        raise FileFormatError(
            f"{places[1]}: expected a density that grows less than the pressure, as of a gas that "
            f"ends at zero pressure, got p = {table[0, 0]:g} to {table[1, 0]:g} for rho = "
            f"{table[0, 1]:g} to {table[1, 1]:g}. Begin the table at lower pressures."
        )
    curve = way(np.log(p), np.log(rho))

    def rate(logarithm: float) -> float:
        return 1 / (1 + math.exp(float(curve(logarithm)) - logarithm))

    pairs = list(pairwise(np.log(p)))
    steps = [quad(rate, low, high)[0] for low, high in pairs]
    enthalpy = math.log1p(start) + np.concatenate(([0.0], np.cumsum(steps)))
    eta = np.concatenate(([start], np.expm1(enthalpy[1:])))
    power = start / (1 + start) * (p[0] + rho[0]) / p[0]
    pieces = [_numbers(math.log(p[0]) - power * math.log(start), power, 0.0, 0.0)]
    slopes = eta / (1 + eta) * (p + rho) / p
    for k in range(len(eta) - 1):
        ends = eta[k : k + 2]
        rows = [[1, math.log(x), x, x**2] for x in ends] + [[0, 1, x, 2 * x**2] for x in ends]
        sizes = np.abs(rows).max(axis=0)
        right = [*np.log(p[k : k + 2]), *slopes[k : k + 2]]
        pieces.append(_numbers(*np.linalg.solve(rows / sizes, right) / sizes))
    matter = EquationOfState(
        name, _PRESSURE, _DENSITY, (0.0, *eta[:-1].tolist()), tuple(pieces), float(eta[-1]), units
    )
    _check_between(matter, eta, rho, places)
    return matter


def _numbers(a: float, b: float, c: float, d: float) -> dict[str, float]:
    return dict(zip([x.name for x in NUMBERS], map(float, (a, b, c, d)), strict=True))


def _check_between(
    matter: EquationOfState, eta: np.ndarray, rho: np.ndarray, places: Sequence[str]
) -> None:
    """Refuse rows between which the density does not increase with the pressure."""
    for k in range(len(eta) - 1):
        inner = [matter.values(x)[1] for x in np.linspace(eta[k], eta[k + 1], 9)[1:-1]]
        every = [rho[k], *inner, rho[k + 1]]
        if not all(low < high for low, high in pairwise(every)):
            raise FileFormatError(
                f"{places[k + 1]}: expected a density that the row before leads to smoothly, got "
                "one between which the density would fall. Give the numbers with more digits, or "
                "omit the row."
            )
