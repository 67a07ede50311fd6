"""Losses: how much a residual counts, so that single outliers do not decide a fit."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeAlias

import numpy as np

from geomtorsion.errors import StartError
from geomtorsion.support import checks

# rho, rho' and rho'' at squares z of residuals in units of sigma, shape (3, N).
Loss: TypeAlias = Callable[[np.ndarray], np.ndarray]


def _linear(z: np.ndarray) -> np.ndarray:
    return np.array([z, np.ones_like(z), np.zeros_like(z)])


def _soft_l1(z: np.ndarray) -> np.ndarray:
    root = np.sqrt(1 + z)
    return np.array([2 * (root - 1), 1 / root, -0.5 / root**3])


def _huber(z: np.ndarray) -> np.ndarray:
    root = np.sqrt(np.maximum(z, 1.0))
    inside = z <= 1
    return np.array(
        [np.where(inside, z, 2 * root - 1), 1 / root, np.where(inside, 0.0, -0.5 / root**3)]
    )


def _cauchy(z: np.ndarray) -> np.ndarray:
    return np.array([np.log1p(z), 1 / (1 + z), -1 / (1 + z) ** 2])


LOSSES: Mapping[str, Loss] = {
    "linear": _linear,
    "soft_l1": _soft_l1,
    "huber": _huber,
    "cauchy": _cauchy,
}


def loss_of(name: str) -> Loss:
    """The loss with the name that scipy.optimize.least_squares gives it.

    Raises
    ------
    UnknownNameError
        There is no such loss.

    Examples
    --------
    >>> loss_of("huber")(np.array([0.25, 4.0]))[0]
    array([0.25, 3.  ])
    """
    return LOSSES[checks.choice(name, list(LOSSES), "loss", StartError)]


def variance_factor(loss: Loss, residuals: np.ndarray, free: int) -> float:
    """Factor between the covariance of a fit and (J^T J)^-1; one for the linear loss.

    Equation
    --------
    (sum psi^2 / (N - k)) / (sum psi' / N)^2, psi = rho' r, psi' = rho' + 2 rho'' r^2, from
    P. J. Huber, Robust Statistics (1981), section 7.6.
    """
    if loss is _linear:
        return 1.0
    z = residuals**2
    _, first, second = loss(z)
    slope = float(np.mean(first + 2 * second * z))
    spread = float((first**2 * z).sum()) / max(len(z) - free, 1)
    return spread / slope**2 if slope > 0 else np.inf
