"""Solar system: measured post-Newtonian numbers, and whether a theory agrees with them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import sympy as sp

from geomtorsion.gravity.perturbed.geometries import shown

# A theory disagrees with a measurement from this many standard errors on (95 percent).
STANDARD_ERRORS = 2


@dataclass(frozen=True)
class Measurement:
    """A measured post-Newtonian number.

    name: of the experiment. parameter: gamma or beta. excess, error: measured value minus one, and
    its standard error. source: the publication.
    """

    name: str
    parameter: str
    excess: sp.Rational
    error: sp.Rational
    source: str

    @property
    def limits(self) -> tuple[sp.Rational, sp.Rational]:
        """Lowest and highest value within two standard errors."""
        width = STANDARD_ERRORS * self.error
        return 1 + self.excess - width, 1 + self.excess + width

    def __str__(self) -> str:
        exponent = sp.floor(sp.log(self.error, 10))
        excess, error = (float(x / sp.Integer(10) ** exponent) for x in (self.excess, self.error))
        return f"{self.parameter} - 1 = ({excess:.1f} +- {error:.1f})e{exponent}"


CASSINI = Measurement(
    "Cassini",
    "gamma",
    sp.Rational(21, 10**6),
    sp.Rational(23, 10**6),
    "Bertotti, Iess, Tortora 2003",
)
LUNAR = Measurement(
    "lunar laser ranging",
    "beta",
    sp.Rational(12, 10**5),
    sp.Rational(11, 10**5),
    "Williams, Turyshev, Boggs 2004",
)
MEASUREMENTS = (CASSINI, LUNAR)


@dataclass(frozen=True, repr=False)
class SolarTest:
    """A measurement beside the prediction of a theory.

    predicted: gamma or beta, a number or a formula in the couplings.

    Examples
    --------
    >>> from geomtorsion.gravity import perturbed
    >>> perturbed.post_newtonian("R/2", "riemannian").tests[0].passes
    True
    """

    measurement: Measurement
    predicted: sp.Expr

    @property
    def deviation(self) -> sp.Expr:
        """Predicted minus measured value, in standard errors."""
        one = self.measurement
        return sp.factor((self.predicted - 1 - one.excess) / one.error)

    @property
    def _allowed(self) -> sp.Set | None:
        """Values of the one coupling that agree; None for other formulas."""
        free = self.predicted.free_symbols
        if len(free) != 1 or not self.predicted.is_rational_function(*free):
            return None
        real = sp.Dummy(real=True)
        value = self.predicted.xreplace(dict.fromkeys(free, real))
        low, high = self.measurement.limits
        ends = (value >= low, value <= high)
        sets = [sp.solve_univariate_inequality(x, real, relational=False) for x in ends]
        return sp.Intersection(*sets)

    @property
    def passes(self) -> sp.Basic:
        """Whether the theory agrees within two standard errors; a condition for a formula.

        Solved for the coupling where the formula is a rational function of one coupling.
        """
        low, high = self.measurement.limits
        free = self.predicted.free_symbols
        if not free:
            return sp.true if low <= self.predicted <= high else sp.false
        if self._allowed is not None:
            return self._allowed.as_relational(*free)
        return sp.And(self.predicted >= low, self.predicted <= high)

    def to_json(self) -> dict[str, Any]:
        """The test as plain data, with formulas as text."""
        one = self.measurement
        return {
            "experiment": one.name,
            "source": one.source,
            "parameter": one.parameter,
            "measured_minus_one": float(one.excess),
            "standard_error": float(one.error),
            "predicted": str(self.predicted),
            "deviation": str(self.deviation),
            "passes": str(self.passes),
        }

    def __str__(self) -> str:
        if not self.predicted.free_symbols:
            errors = f"{float(abs(self.deviation)):.3g} standard errors away"
            text = f"{'passes' if self.passes == sp.true else 'fails'}, {errors}"
        elif self._allowed is None:
            low, high = (sp.N(x, 7) for x in self.measurement.limits)
            text = f"passes where {low} <= {shown(self.predicted)} <= {high}"
        else:
            (symbol,) = self.predicted.free_symbols
            text = _allowed_text(str(symbol), self._allowed)
        return f"{self.measurement.name}, {self.measurement}: {text}"

    __repr__ = __str__


def _allowed_text(name: str, allowed: sp.Set) -> str:
    """Intervals and single values of a coupling in one line."""
    if allowed == sp.S.EmptySet:
        return f"fails for any {name}"
    parts = []
    for one in allowed.args if isinstance(allowed, sp.Union) else (allowed,):
        if isinstance(one, sp.Interval):
            low, high = _short(one.start), _short(one.end)
            if one.end == sp.oo:
                parts.append(f"{name} >= {low}" if one.start != -sp.oo else f"{name} has any value")
            else:
                parts.append(f"{low} <= {name} <= {high}".removeprefix("-inf <= "))
        else:
            parts += [f"{name} = {_short(x)}" for x in one]
    return f"passes where {' or '.join(parts)}"


def _short(value: sp.Expr) -> str:
    return f"{float(value):.6g}"
