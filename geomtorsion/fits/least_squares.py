"""Least squares: the parameters whose prediction is nearest to data with noise."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import scipy  # loads its parts on first use

from geomtorsion.errors import AccuracyError, GeomtorsionError, StartError, UnknownNameError
from geomtorsion.fits.data import Data
from geomtorsion.fits.losses import Loss, loss_of, variance_factor
from geomtorsion.fits.result import Direction, Fit
from geomtorsion.support import checks
from geomtorsion.support.precision import EPS

# chi^2 changes by less than this part in the last step: far less than one, which is one sigma.
CONVERGED = math.sqrt(EPS)


@dataclass(frozen=True, eq=False)
class Prediction:
    """Prediction of a model for some parameters, in units of the noise.

    residuals: (prediction - data) / sigma, shape (N,).
    slopes: their derivatives, shape (N, k).
    error: relative numerical error of the slopes.
    source: the computed object, such as a solution.
    """

    residuals: np.ndarray
    slopes: np.ndarray
    error: float
    source: object


# Name -> lower and upper bound; None for none.
Bounds: TypeAlias = Mapping[str, tuple[float | None, float | None]]
Model: TypeAlias = Callable[[Mapping[str, float]], Prediction]


class _Trials:
    """Predictions of a model; the last good one is kept for its slopes.

    count: how many were made.
    """

    def __init__(self, model: Model, names: Sequence[str]) -> None:
        self.model, self.names, self.count = model, names, 0
        self.last: tuple[bytes, Prediction] | None = None

    def at(self, values: np.ndarray) -> Prediction:
        """The prediction at some values, made once even if it is needed twice."""
        key = values.tobytes()
        if self.last is None or self.last[0] != key:
            self.count += 1
            named = dict(zip(self.names, values.tolist(), strict=True))
            self.last = key, self.model(named)
        return self.last[1]

    def residuals(self, values: np.ndarray) -> np.ndarray:
        """Residuals; infinite if the model has no solution, so that the search steps back."""
        try:
            return self.at(values).residuals
        except GeomtorsionError:
            assert self.last is not None
            return np.full_like(self.last[1].residuals, np.inf)


def least_squares(
    model: Model,
    first: Mapping[str, float],
    data: Data,
    bounds: Bounds | None = None,
    loss: str = "linear",
) -> Fit:
    """The fit of a model, from a first guess.

    A trust region in scaled parameters, as Levenberg and Marquardt proposed, with exact slopes
    (scipy.optimize.least_squares). It steps back from parameters at which the model has no answer.

    Raises
    ------
    StartError
        There are fewer data than parameters, or a first guess is outside of its bounds.
    AccuracyError
        It does not converge.
    """
    counted = loss_of(loss)
    limits = _limits(bounds, first)
    names, start = tuple(first), np.array(list(first.values()), dtype=float)
    count = sum(int(here.sum()) for here in data.present.values())
    if count < len(names):
        raise StartError(
            f"free: expected at most as many parameters as the {count} data, got {len(names)}. "
            "Free fewer."
        )
    trials = _Trials(model, names)
    trials.at(start)
    # Nothing is missing from what the search must not change.
    held = np.zeros(len(names))
    result = scipy.optimize.least_squares(
        lambda x: np.concatenate((trials.residuals(x), held)), start,
        lambda x: _Spectrum(trials.at(x)).slopes, method="trf", x_scale="jac",
        bounds=limits, loss=counted, ftol=CONVERGED, xtol=CONVERGED, gtol=None,
    )  # fmt: skip
    if result.status <= 0:
        raise AccuracyError(
            f"expected the fit to converge, got chi^2 = {2 * result.cost:.6g} after "
            f"{result.nfev} solves. Start nearer to the answer, or free fewer parameters."
        )
    best = trials.at(result.x)
    covariance, directions = _covariance(names, best)
    factor = variance_factor(counted, best.residuals, len(names) - len(directions))
    at_bounds = {
        name: float(limits[max(side, 0)][k])
        for k, (name, side) in enumerate(zip(names, result.active_mask.tolist(), strict=True))
        if side
    }
    # A step of one sigma may leave the bounds.
    curved = None if at_bounds else _curved(trials, names, result.x, best, counted, factor)
    return Fit(
        values=dict(zip(names, result.x.tolist(), strict=True)),
        covariance=factor * covariance,
        chi2=float(best.residuals @ best.residuals),
        degrees=count - len(names) + len(directions),
        residuals=data.laid_out(-best.residuals),
        data=data,
        undetermined=directions,
        curved=curved,
        at_bounds=at_bounds,
        loss=loss,
        solves=trials.count,
        source=best.source,
    )


def _limits(bounds: Bounds | None, first: Mapping[str, float]) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper bounds of all free parameters, shape (k,) each."""
    low, high = np.full(len(first), -np.inf), np.full(len(first), np.inf)
    table = checks.known_keys(bounds or {}, first, "bounds", UnknownNameError)
    for name, pair in table.items():
        subject, wanted = f"bounds of {name}", "a lower and an upper bound"
        sides = checks.entries(pair, subject, StartError, 2, expected=wanted)
        one, two = (
            default if side is None else checks.real(side)
            for side, default in zip(sides, (-np.inf, np.inf), strict=True)
        )
        if one is None or two is None:
            checks.refuse(StartError, subject, wanted, pair, "Give numbers, or None.")
        if one >= two:
            remedy = "Give the lower bound first."
            raise StartError(f"{subject}: expected {wanted}, got {one:g} and {two:g}. {remedy}")
        if not one <= first[name] <= two:
            raise StartError(
                f"{subject}: expected bounds around the first guess {first[name]:g}, got {one:g} "
                f"and {two:g}. Change the bounds or the guess."
            )
        k = list(first).index(name)
        low[k], high[k] = one, two
    return low, high


class _Spectrum:
    """Singular values of the slopes, each column in units of its size.

    clear: which of them are larger than numerical noise. Along the others nothing is determined,
    and the search must not move.
    """

    def __init__(self, best: Prediction) -> None:
        sizes = np.linalg.norm(best.slopes, axis=0)
        self.scales = np.where(sizes > 0, sizes, 1.0)
        self.left, self.singular, self.rows = np.linalg.svd(
            best.slopes / self.scales, full_matrices=False
        )
        # Numerical errors of the slopes add up to this where the exact singular value is zero.
        self.noise = math.sqrt(len(sizes)) * max(best.error, EPS * len(best.residuals))
        self.clear = self.singular > self.noise

    @property
    def slopes(self) -> np.ndarray:
        """Slopes of the residuals, then rows for undetermined directions; shape (N + k, k).

        Without these rows a search along an undetermined direction does not end.
        """
        clear = np.where(self.clear, self.singular, 0.0)
        # Where nothing is determined at all, one holds as well as any size.
        held = np.where(self.clear, 0.0, self.singular[0] or 1.0)
        rows = self.rows * self.scales
        return np.concatenate(((self.left * clear) @ rows, held[:, None] * rows))


def _covariance(names: Sequence[str], best: Prediction) -> tuple[np.ndarray, tuple[Direction, ...]]:
    """(J^T J)^-1, infinite for parameters in a combination that the data do not determine."""
    spectrum = _Spectrum(best)
    clear, scales = spectrum.clear, spectrum.scales
    inverse = spectrum.rows[clear].T / spectrum.singular[clear]
    covariance = (inverse @ inverse.T) / np.outer(scales, scales)
    directions = []
    for shares in spectrum.rows[~clear]:
        # Smaller shares are noise of the direction itself.
        involved = np.abs(shares) > math.sqrt(spectrum.noise)
        change = shares / scales
        change = change / change[np.argmax(np.abs(change) * involved)]
        pairs = zip(names, change.tolist(), involved.tolist(), strict=True)
        directions.append(Direction({name: x for name, x, one in pairs if one}))
        covariance[involved, :] = covariance[:, involved] = np.nan
        covariance[involved, involved] = np.inf
    return covariance, tuple(directions)


def _curved(
    trials: _Trials,
    names: Sequence[str],
    values: np.ndarray,
    best: Prediction,
    loss: Loss,
    factor: float,
) -> Direction | None:
    """The least certain direction, if a step of one sigma along it is not as slopes predict."""
    spectrum = _Spectrum(best)
    last = int(spectrum.clear.sum()) - 1
    if last < 0:
        return None
    step = spectrum.rows[last] / spectrum.singular[last] / spectrum.scales * math.sqrt(factor)
    here, first, second = loss(best.residuals**2)
    expected = factor * float(np.mean(first + 2 * second * best.residuals**2))
    for sign in (1.0, -1.0):
        there = loss(trials.residuals(values + sign * step) ** 2)[0]
        rise = float((there - here).sum()) / expected
        # One where the prediction is linear; errors are sigmas where it is not far from one.
        if not 0.5 < rise < 2:
            return Direction({n: x for n, x in zip(names, step.tolist(), strict=True) if x})
    return None
