"""Result: parameters from data, with errors, and what the data do not determine."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
import scipy  # loads its parts on first use

from geomtorsion.fits.data import Data
from geomtorsion.support.caching import cached_property
from geomtorsion.support.copies import ByContent
from geomtorsion.support.displays import Plot, drawn_by, figure_by
from geomtorsion.support.outgoing import measured_text

# By custom of physics, what Gaussian noise gives less often than a residual of this many sigma is
# not ascribed to chance.
FAR = 5.0
SURPRISE = math.erfc(FAR / math.sqrt(2))


@dataclass(frozen=True, eq=False)
class Direction(ByContent):
    """A joint change of parameters.

    changes: name -> change, those that are involved.

    Examples
    --------
    >>> print(Direction({"I1": 0.5, "I2": 1.0}))
    I1 by 0.5 with I2 by 1
    """

    changes: Mapping[str, float]

    def __str__(self) -> str:
        return " with ".join(f"{name} by {x:.3g}" for name, x in self.changes.items())


@dataclass(frozen=True, eq=False)
class Fit(ByContent):
    """Parameters that fit data with noise, with errors; made by `fit`.

    values: name -> best value.
    covariance: of the values, shape (k, k); infinite where the data do not determine a value.
    chi2: sum of the squares of the residuals.
    degrees: degrees of freedom, the number of data minus the number of determined parameters.
    residuals: quantity -> (data - model) / sigma, not a number where data are missing.
    data: the fitted data.
    undetermined: joint changes of parameters that change no prediction.
    curved: a joint change by one sigma that changes chi^2 by less than half of one or by more than
        two: the errors are not standard deviations along it. None if chi^2 rises as it should.
    at_bounds: name -> bound of each value that a bound stops.
    loss: how residuals count, see `fit`; "linear" is least squares.
    solves: number of computations of the model.
    source: the model at the best values, such as a `Solution` with derivatives.
    """

    values: Mapping[str, float]
    covariance: np.ndarray
    chi2: float
    degrees: int
    residuals: Mapping[str, np.ndarray] = field(compare=False)
    data: Data
    undetermined: tuple[Direction, ...]
    curved: Direction | None
    at_bounds: Mapping[str, float]
    loss: str
    solves: int
    source: Any = field(compare=False)  # users know which model they fitted

    def __getitem__(self, name: str) -> float:
        """The best value of a parameter."""
        return self.values[name]

    @cached_property
    def errors(self) -> Mapping[str, float]:
        """One standard deviation of each value; infinite where the data do not determine it."""
        return dict(zip(self.values, np.sqrt(np.diag(self.covariance)).tolist(), strict=True))

    @cached_property
    def correlation(self) -> np.ndarray:
        """Covariance in units of the errors, shape (k, k)."""
        errors = np.array(list(self.errors.values()))
        with np.errstate(invalid="ignore"):
            return self.covariance / np.outer(errors, errors)

    @property
    def chance(self) -> float:
        """Probability that only noise makes chi^2 as large, if sigma is right."""
        return float(scipy.special.chdtrc(self.degrees, self.chi2)) if self.degrees else math.nan

    @property
    def warnings(self) -> tuple[str, ...]:
        """Limits on the use of the errors, in words."""
        lines = [
            f"the data do not determine {' and '.join(x.changes)}: to change {x} changes nothing "
            f"measured. Fix {'one of them' if len(x.changes) > 1 else 'it'}."
            for x in self.undetermined
        ]
        lines += [
            f"{name} is at its bound {bound:.6g}: errors are those without the bound. Widen it, or "
            f"fix {name}."
            for name, bound in self.at_bounds.items()
        ]
        if self.loss == "linear" and self.chance < SURPRISE:
            lines.append(f"chi^2 is too large for chance. {self._largest}")
        if self.curved is not None:
            lines.append(
                f"errors are not sigmas: chi^2 does not rise by 1 where one changes {self.curved}. "
                "Fix a parameter, or take more data."
            )
        return tuple(lines)

    @property
    def _largest(self) -> str:
        """The largest residual, with what to do about it."""
        sizes = {name: np.nan_to_num(np.abs(x)) for name, x in self.residuals.items()}
        name = max(sizes, key=lambda one: sizes[one].max(initial=0.0))
        place = np.unravel_index(int(sizes[name].argmax()), sizes[name].shape)
        return (
            f"The largest residual is {sizes[name][place]:.3g} sigma, {name} at "
            f"{self.data.at[place[0]]:.6g}. Check this number, sigma and the model; "
            'loss="soft_l1" gives single outliers less weight.'
        )

    def __str__(self) -> str:
        lines = []
        for name, value in self.values.items():
            error = self.errors[name]
            if math.isfinite(error):
                lines.append(f"{name} = {measured_text(value, error)}")
            else:
                lines.append(f"{name} = {value:.6g}, undetermined")
        far = sum(int((np.abs(x) > FAR).sum()) for x in self.residuals.values())
        comment = f"chance {self.chance:.2g}"
        if self.loss != "linear":
            # Other losses are for data whose noise is not Gaussian.
            comment = f"loss {self.loss}; beyond {FAR:g} sigma: {far}"
        lines.append(f"chi^2 = {self.chi2:.4g} of {self.degrees} degrees of freedom ({comment})")
        return "\n".join([*lines, *(f"warning: {text}" for text in self.warnings)])

    __repr__ = __str__
    _repr_html_ = drawn_by("notebook_pictures", "fit_html")
    plot: ClassVar[Plot] = figure_by("fits", "draw_fit")

    def to_json(self) -> dict[str, Any]:
        """Values, errors, covariance and chi^2 as a JSON-ready mapping; None where infinite."""
        rows = self.covariance.tolist()
        return {
            "values": dict(self.values),
            "errors": {name: _finite(x) for name, x in self.errors.items()},
            "covariance": [[_finite(x) for x in row] for row in rows],
            "chi2": self.chi2,
            "degrees": self.degrees,
            "loss": self.loss,
            "at_bounds": dict(self.at_bounds),
            "chance": _finite(self.chance),
            "solves": self.solves,
            "warnings": list(self.warnings),
        }


def _finite(value: float) -> float | None:
    """A number that JSON can hold."""
    return value if math.isfinite(value) else None
