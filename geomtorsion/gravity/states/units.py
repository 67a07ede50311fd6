"""Units of stars: factors from the units that users choose to kilometres, with G = c = 1."""

from __future__ import annotations

from dataclasses import dataclass

from geomtorsion.errors import GravityError
from geomtorsion.support import checks


@dataclass(frozen=True)
class Units:
    """Factors to units with G = c = 1, and words.

    density, pressure: factor of each. mass: geometric unit of a mass that users read.
    mass_word, length_word: names for tables, empty without units.
    """

    density: float = 1.0
    pressure: float = 1.0
    mass: float = 1.0
    mass_word: str = ""
    length_word: str = ""


# CODATA 2018 and IAU 2015: G in m^3/kg/s^2, c in m/s, G times the mass of the sun in m^3/s^2, and a
# million electron volts for each cubic femtometre in pascals.
_SI = {"G": 6.67430e-11, "c": 299792458.0, "sun": 1.3271244e20, "mev": 1.602176634e32}
_SQUARE = _SI["c"] ** 2
# One kilogram for each cubic metre, and one pascal, in inverse square kilometres.
_DENSITY = 1e6 * _SI["G"] / _SQUARE
_PRESSURE = _DENSITY / _SQUARE
_SUN = {"mass": 1e-3 * _SI["sun"] / _SQUARE, "mass_word": "solar masses", "length_word": "km"}

UNITS = {
    "geometric": Units(),
    "si": Units(_DENSITY, _PRESSURE, **_SUN),
    "cgs": Units(1e3 * _DENSITY, 0.1 * _PRESSURE, **_SUN),
    "mev": Units(_SI["mev"] * _PRESSURE, _SI["mev"] * _PRESSURE, **_SUN),
}


def units_of(name: object) -> Units:
    """The units of a name.

    Raises
    ------
    GravityError
        there is no such name.

    Examples
    --------
    >>> units_of("geometric").density
    1.0
    """
    return UNITS[checks.choice(name, tuple(UNITS), "units", GravityError)]
