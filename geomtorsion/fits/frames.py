"""Frames: parameters of a coframe, such as a dislocation, from the coframe measured at points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from geomtorsion.codegen import graph
from geomtorsion.errors import ShapeError, SingularPointError, StartError
from geomtorsion.fits.data import Data
from geomtorsion.fits.least_squares import Bounds, Prediction, least_squares
from geomtorsion.fits.result import Fit
from geomtorsion.geometry.connections import FrameLike, as_frame
from geomtorsion.ode.derivatives import checked_by
from geomtorsion.support import checks
from geomtorsion.support.precision import EPS


def fit_frame(
    frame: FrameLike,
    points: np.ndarray | Sequence[Sequence[float]],
    coframe: np.ndarray | Sequence[object],
    sigma: float | np.ndarray,
    free: Sequence[str],
    *,
    parameters: Mapping[str, float],
    bounds: Bounds | None = None,
    loss: str = "linear",
) -> Fit:
    """Fit parameters of a frame to its coframe, measured at points: 1 + distortion of a crystal.

    `fit` explains the sum that is minimised, and the errors.

    Parameters
    ----------
    frame
        with the parameters, such as b and the position of a dislocation.
    points
        q^mu, shape (k, n).
    coframe
        measured e^i_mu, shape (k, n, n); NaN if missing, as for components along a
        direction in which nothing was measured.
    sigma
        standard deviation of the noise: a number, or numbers of shape (k, n, n).
    free
        names of the parameters to fit.
    parameters
        name -> number: the first guess, and the fixed values of the others.
    bounds, loss
        as in `fit`.

    Raises
    ------
    UnknownNameError, ShapeError, StartError
        A name is unknown, arrays do not fit together, or sigma is not positive.
    SingularPointError
        The coframe has no value at a point for the first guess.
    AccuracyError
        The fit does not converge.

    Examples
    --------
    >>> from geomtorsion.geometry import Frame
    >>> stretched = Frame("x y", [["1 + s*y", "0"], ["0", "1"]], parameters="s")
    >>> measured = [[[1.1, 0], [0, 1]], [[1.21, 0], [0, 1]]]
    >>> points = [[0, 1], [0, 2]]
    >>> print(fit_frame(stretched, points, measured, 0.01, ["s"], parameters={"s": 0}))
    s = 0.1040 +- 0.0045
    chi^2 = 0.2 of 7 degrees of freedom (chance 1)
    """
    frame = as_frame(frame)
    n, symbols = frame.dimension, {symbol.name: symbol for symbol in frame.parameters}
    places = checks.array(points, "points", StartError, shape=(None, n), shape_error=ShapeError)
    numbers = {name: float(x) for name, x in checks.by_name(parameters, "parameters").items()}
    names = checked_by(free, tuple(symbols), "free")
    checks.check_values(symbols, numbers, "parameters", StartError, "Add it.")
    shape = (len(places), n, n)
    values = _rows(coframe, shape, "coframe")
    noise = sigma if isinstance(sigma, int | float) else _rows(sigma, shape, "sigma")
    data = Data.of(np.arange(len(places)), {"coframe": values}, noise, ("coframe",))
    entries = [frame.coframe.element(i, mu) for i in range(n) for mu in range(n)]
    slopes = [entry.diff(symbols[name]) for name in names for entry in entries]
    arguments = [symbol.name for symbol in (*frame.coordinates, *frame.parameters)]
    function = graph(arguments, [*entries, *slopes], factor=False).numpy()
    present = data.present["coframe"]

    def model(values: Mapping[str, float]) -> Prediction:
        table = {**numbers, **values}
        with np.errstate(all="ignore"):
            rows = function(*places.T, *(table[name] for name in symbols))
        result = np.array([np.broadcast_to(row, len(places)) for row in rows], dtype=float)
        predicted, *columns = result.reshape(1 + len(names), n * n, -1).transpose(0, 2, 1)
        lost = present & ~np.isfinite(predicted)
        if lost.any():
            k = int(np.argmax(lost.any(axis=1)))
            raise SingularPointError(
                f"expected finite values of the coframe at all points, got none at point {k}: "
                f"{places[k].tolist()}. Omit this point, or change the first guess."
            )
        slopes = data.slopes("coframe", columns)
        return Prediction(data.compared("coframe", predicted), slopes, EPS, frame)

    return least_squares(model, {name: numbers[name] for name in names}, data, bounds, loss)


def _rows(values: object, shape: tuple[int, int, int], what: str) -> np.ndarray:
    """A matrix at each point as one row each."""
    try:
        array = np.array(values, dtype=float)
    except (TypeError, ValueError):
        array = np.zeros(0)
    if array.shape != shape:
        raise ShapeError(f"{what}: expected numbers of shape {shape}, got {checks.shown(values)}.")
    return array.reshape(len(array), -1)
