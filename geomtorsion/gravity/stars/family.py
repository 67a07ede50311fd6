"""Family: the stars of one kind of matter, from light ones to the heaviest and beyond."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from geomtorsion.errors import GravityError
from geomtorsion.gravity.stars.star import Source, Star, star_of, structure_of
from geomtorsion.gravity.stars.structure import Structure
from geomtorsion.gravity.states.equation_of_state import EquationOfState
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.csv_table import write_csv
from geomtorsion.support.displays import Plot, drawn_by, figure_by
from geomtorsion.support.precision import EPS

# Without densities: eta at the first and the last centre, and the number of stars. It is the energy
# and pressure of a particle beyond its rest mass, so that 1 is relativistic matter.
_RANGE = (1 / 16, 2.0, 21)
# The step in the logarithm of eta at which the error of a difference of masses is least.
_STEP = EPS ** (1 / 3)


@dataclass(frozen=True, eq=False, repr=False)
class Family:
    """Stars of one kind of matter, by increasing density at the centre.

    stars: the stars.
    """

    stars: tuple[Star, ...]
    _structure: Structure
    _options: Mapping[str, Any]

    @property
    def matter(self) -> EquationOfState:
        """The equation of state."""
        return self._structure.matter

    @cached_property
    def columns(self) -> dict[str, np.ndarray]:
        """Numbers of the stars by name, shape (m,), as of `Star.numbers`, and errors."""
        table = {x: np.array([one.numbers[x] for one in self.stars]) for x in self.stars[0].numbers}
        for name in self.stars[0].errors:
            table[f"{name}_error"] = np.array([one.errors[name] for one in self.stars])
        return table

    def __getitem__(self, name: str) -> np.ndarray:
        """A column by its name, shape (m,)."""
        return self.columns[checks.known_name(name, self.columns, "family", GravityError)]

    def __len__(self) -> int:
        return len(self.stars)

    @property
    def heaviest(self) -> Star:
        """The star of the largest mass, beyond which stars are unstable.

        The error of its mass counts how closely the maximum is found.

        Raises
        ------
        GravityError
            the first or the last star of the family is the heaviest.
        """
        if self.peak is None:
            raise GravityError(
                f"heaviest: expected a largest mass between the {len(self)} stars, got one at the "
                "end of the family. Give other densities."
            )
        return self.peak

    @cached_property
    def peak(self) -> Star | None:
        """The heaviest star, or None where `heaviest` raises an error."""
        k = int(np.argmax(self["mass"]))
        if not 0 < k < len(self.stars) - 1:
            return None
        low, _, high = (math.log(self._etas[j]) for j in (k - 1, k, k + 1))
        answer = minimize_scalar(
            lambda x: -self._mass_at(x), bounds=(low, high), method="bounded",
            options={"xatol": _STEP},
        )  # fmt: skip
        best = self._at(float(answer.x))
        # By how much the mass changes within the step about the maximum.
        beside = [self._mass_at(float(answer.x) + step) for step in (-_STEP, _STEP)]
        errors = dict(best.errors)
        errors["mass"] += max(abs(x - best.mass) for x in beside)
        slope = abs(self.stars[k + 1].radius - self.stars[k - 1].radius) / (high - low)
        errors["radius"] += slope * _STEP
        return replace(best, errors=errors)

    def at_mass(self, mass: object) -> Star:
        """The stable star of a mass, on the branch from the lightest star to the heaviest one.

        Raises
        ------
        GravityError
            no star of the family has this mass.
        """
        wanted = checks.positive(mass, "mass", GravityError)
        masses, last = self["mass"], int(np.argmax(self["mass"]))
        heaviest = self.peak
        ends = [math.log(x) for x in self._etas[: last + 1]]
        values = masses[: last + 1].tolist()
        if heaviest is not None and heaviest.mass > values[-1]:
            ends.append(math.log(self._eta_of(heaviest)))
            values.append(heaviest.mass)
        for k in range(len(values) - 2, -1, -1):
            if values[k] <= wanted <= values[k + 1]:
                break
        else:
            raise GravityError(
                f"mass: expected a mass from {min(values):.6g} to {max(values):.6g}, got "
                f"{checks.shown(mass)}. Give other densities to the family, or another mass."
            )
        root = brentq(lambda x: self._mass_at(x) - wanted, ends[k], ends[k + 1], xtol=_STEP**2)
        return self._at(float(root))

    @property
    def _etas(self) -> list[float]:
        return [self._eta_of(one) for one in self.stars]

    def _eta_of(self, one: Star) -> float:
        return self.matter.eta_of(pressure=one.pressure)

    def _at(self, logarithm: float) -> Star:
        """The star with a logarithm of eta at its centre."""
        return star_of(self._structure, math.exp(logarithm), **self._options)

    def _mass_at(self, logarithm: float) -> float:
        """The mass of this star."""
        bare = self._structure.background
        return star_of(bare, math.exp(logarithm), **self._options).mass

    def to_csv(self, path: str | Path) -> None:
        """Write the numbers of the stars and their errors as a table, every digit kept."""
        write_csv(checks.file_name(path), self.columns)

    def to_json(self) -> dict[str, Any]:
        """Numbers of the stars, and the heaviest one, as plain data."""
        heaviest = self.peak
        return {
            "matter": self.matter.name,
            "units": self.matter.units,
            "stars": {name: column.tolist() for name, column in self.columns.items()},
            "heaviest": None if heaviest is None else heaviest.to_json(),
        }

    def __repr__(self) -> str:
        unit = f" {self.matter.scale.mass_word}".rstrip()
        low, high = float(self["mass"].min()), float(self["mass"].max())
        return f"{len(self)} stars of {self.matter.name}: mass from {low:.6g} to {high:.6g}{unit}"

    def __str__(self) -> str:
        heaviest = self.peak
        if heaviest is None:
            return f"{self!r}\nno heaviest star between the densities of the family"
        error = heaviest.errors["mass"]
        return (
            f"{self!r}\nheaviest: mass {heaviest.mass:.8g}, error {error:.1g}; radius "
            f"{heaviest.radius:.8g}, density {heaviest.density:.6g} at the centre"
        )

    _repr_html_ = drawn_by("stars", "stars_html")
    plot: ClassVar[Plot] = figure_by("stars", "draw_stars")


def family(
    source: Source,
    densities: object = None,
    *,
    pressures: object = None,
    start: Mapping[str, object] | None = None,
    parameters: Mapping[str, object] | None = None,
    near: Mapping[str, object] | None = None,
    accuracy: float = 1e-9,
) -> Family:
    """Mass, radius and response of the stars of one kind of matter over the density at the centre.

    Parameters
    ----------
    source, start, parameters, near, accuracy
        As for `star`.
    densities, pressures
        Energy densities or pressures at the centres, in the units of the matter. Without both there
        are 21 stars, from light stars to stars of relativistic matter.

    Raises
    ------
    StartError, GravityError
        As for `star`.

    Examples
    --------
    >>> from geomtorsion.gravity.states.equation_of_state import polytropes
    >>> stars = family(polytropes(100, [2]), [1e-3, 4e-3, 9e-3])
    >>> stars
    3 stars of polytrope with exponent 2: mass from 1.21955 to 1.63685
    >>> round(stars.heaviest.mass, 4)
    1.6373
    """
    structure = structure_of(source)
    matter = structure.matter
    if densities is not None and pressures is not None:
        raise GravityError("family: expected densities or pressures, got both. Omit one.")
    if densities is None and pressures is None:
        light, relativistic, count = _RANGE
        last = min(relativistic, matter.largest)
        etas = np.geomspace(min(light, last * light), last, count).tolist()
    else:
        word, values = ("densities", densities) if pressures is None else ("pressures", pressures)
        given = checks.entries(values, word, GravityError)
        if not given:
            raise GravityError(f"{word}: expected one or more numbers, got none.")
        if pressures is None:
            etas = [matter.eta_of(density=x) for x in given]
        else:
            etas = [matter.eta_of(pressure=x) for x in given]
    options = {"start": start, "parameters": parameters, "near": near, "accuracy": accuracy}
    stars = tuple(star_of(structure, eta, **options) for eta in sorted(etas))
    return Family(stars, structure, options)
