"""Loops: parameters of a frame, such as a dislocation, from the Burgers vectors of circuits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from geomtorsion.errors import AccuracyError, ShapeError, StartError
from geomtorsion.fits.data import Data, Noise
from geomtorsion.fits.least_squares import Bounds, Prediction, least_squares
from geomtorsion.fits.result import Fit
from geomtorsion.geometry.connections import FrameLike, as_frame
from geomtorsion.loops import Loop, burgers_derivatives, burgers_vector
from geomtorsion.ode.derivatives import checked_by
from geomtorsion.ode.error_estimate import AIM
from geomtorsion.support import checks


def fit_loops(
    frame: FrameLike,
    loops: Sequence[Loop],
    vectors: np.ndarray | Sequence[Sequence[float]],
    sigma: Noise,
    free: Sequence[str],
    *,
    parameters: Mapping[str, float],
    bounds: Bounds | None = None,
    loss: str = "linear",
    accuracy: float = 1e-10,
) -> Fit:
    """Fit parameters of a frame to measured Burgers vectors of circuits.

    `fit` explains the sum that is minimised, and the errors.

    Parameters
    ----------
    frame
        with the parameters, such as b, the position and the core width of a dislocation.
    loops
        the circuits, k of them.
    vectors
        measured b^i, shape (k, n), in the frame; NaN if missing.
    sigma
        standard deviation of the noise: a number, or numbers of shape (k, n).
    free
        names of the parameters to fit.
    parameters
        name -> number: the first guess, and the fixed values of the others.
    bounds, loss
        as in `fit`.
    accuracy
        relative error of each Burgers vector and of its derivatives.

    Raises
    ------
    UnknownNameError, ShapeError, StartError
        A name is unknown, arrays do not fit together, or sigma is not positive.
    AccuracyError
        The fit does not converge, or numerical errors are not small against sigma.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> screw = load("screw_dislocation").frame
    >>> circles = [Loop.circle([0, 0, 0], r) for r in (1, 2)]
    >>> measured = [[0, 0, 2.9], [0, 0, 3.2]]
    >>> print(fit_loops(screw, circles, measured, 0.1, ["b"], parameters={"b": 1}))
    b = 3.050 +- 0.071
    chi^2 = 4.5 of 5 degrees of freedom (chance 0.48)
    """
    frame = as_frame(frame)
    circuits = [checks.instance(x, Loop, "loops") for x in checks.entries(loops, "loops")]
    numbers = {name: float(x) for name, x in checks.by_name(parameters, "parameters").items()}
    names = checked_by(free, tuple(symbol.name for symbol in frame.parameters), "free")
    checks.check_values(names, numbers, "parameters", StartError, "Add a first guess.")
    data = Data.of(np.arange(len(circuits)), {"b": vectors}, sigma, ("b",))
    if data.values["b"].shape != (len(circuits), frame.dimension):
        raise ShapeError(
            f"vectors: expected shape {(len(circuits), frame.dimension)}, got "
            f"{data.values['b'].shape}."
        )
    noise = float(data.sigma["b"].min())

    def model(values: Mapping[str, float]) -> Prediction:
        table = {**numbers, **values}
        results = [burgers_vector(frame, loop, accuracy, parameters=table) for loop in circuits]
        error = max(b.error for b in results)
        if not error <= AIM * noise:
            raise AccuracyError(
                f"expected numerical errors of b below {AIM:g} of sigma = {noise:.3g}, got "
                f"{error:.3g}. Give a finer accuracy, or loops away from singular places."
            )
        slopes = [
            burgers_derivatives(frame, loop, names, accuracy, parameters=table) for loop in circuits
        ]
        columns, relative = [], 0.0
        for name in names:
            column = np.array([row[name].vector for row in slopes])
            size, error = float(np.abs(column).max()), max(row[name].error for row in slopes)
            # A column that is only error determines nothing.
            columns.append(column if size > error else np.zeros_like(column))
            relative = max(relative, error / size if size > error else 0.0)
        predicted = np.array([b.vector for b in results])
        return Prediction(data.compared("b", predicted), data.slopes("b", columns), relative, frame)

    return least_squares(model, {name: numbers[name] for name in names}, data, bounds, loss)
