"""Motions: parameters and starts of a motion from data along it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from geomtorsion.curves import CurveProblem
from geomtorsion.errors import AccuracyError, ShapeError, StartError, TimeError, UnknownNameError
from geomtorsion.fits.data import NOISE, Data, Noise
from geomtorsion.fits.least_squares import Bounds, Prediction, least_squares
from geomtorsion.fits.result import Fit
from geomtorsion.ode import ODE, Engine, Solution, solve
from geomtorsion.ode.derivatives import checked_by, derivative_name
from geomtorsion.ode.error_estimate import AIM
from geomtorsion.ode.numbers import checked_accuracy
from geomtorsion.support import arguments, checks
from geomtorsion.support.hints import argument_hints


@argument_hints(p0="problem.with_values({name: guess})")
def fit(
    problem: ODE | CurveProblem,
    times: arguments.Times,
    data: arguments.Labelled,
    sigma: Noise,
    free: Sequence[str],
    *,
    bounds: Bounds | None = None,
    loss: str = "linear",
    accuracy: float = 1e-10,
    engine: Engine | None = None,
) -> Fit:
    """Fit parameters and numbers at the start of a motion to data with noise.

    The sum of ((model - data) / sigma)^2 is minimised with exact derivatives (see `solve`). The
    covariance is the inverse of J^T J at the minimum, J the derivatives of the residuals: errors
    are one standard deviation if sigma is right and the noise Gaussian.

    Parameters
    ----------
    problem
        from `geodesic`, `autoparallel` or `ODE.of`; its own values are the first guess.
    times
        of the data, shape (m,), from t = 0 on; or the name of a column or the index of a table.
    data
        name -> values, shape (m,) (or (m, k) for an output that is a vector): coordinates and
        frame velocities of a curve; states and outputs of an ODE. NaN if missing. Also a pandas
        DataFrame or an xarray Dataset with such columns. Coordinate velocities theta' beside all
        frame velocities, as in `solution.to_pandas()`, repeat them and are not counted again.
    sigma
        standard deviation of the noise: a number, or name -> number or array like the data.
        None: columns sigma_NAME of the data.
    free
        names of `problem.variables` to fit. All others are held fixed.
    bounds
        name -> (lowest, highest) value of a free parameter; None for no bound.
    loss
        "soft_l1", "huber" or "cauchy" instead of squares ("linear"): residuals beyond one sigma
        count less, as in `scipy.optimize.least_squares`. Errors are then estimated from the
        residuals themselves (P. J. Huber, Robust Statistics, 1981, section 7.6).
    accuracy, engine
        of each solve; see `solve`.

    Returns
    -------
    Fit: values, errors, covariance, chi^2, residuals, and warnings.

    Raises
    ------
    UnknownNameError
        a name of data or parameters is unknown.
    ShapeError, StartError, TimeError
        arrays do not fit together, sigma is not positive, a first guess is outside of its bounds,
        or there are fewer data than parameters.
    AccuracyError
        the fit does not converge, or numerical errors are not small against sigma.

    Examples
    --------
    >>> from geomtorsion.ode import ODE
    >>> times = np.linspace(0, 5, 50)
    >>> noise = np.random.default_rng(1).normal(size=50)
    >>> swing = ODE.of({"x": "v", "v": "-k*x"}, [1, 0], parameters={"k": 3.9})
    >>> result = fit(swing, times, {"x": np.cos(2 * times) + 0.01 * noise}, 0.01, ["k", "x"])
    >>> print(result)
    k = 4.0013 +- 0.0030
    x = 1.0016 +- 0.0019
    chi^2 = 38 of 48 degrees of freedom (chance 0.85)
    """
    if not isinstance(problem, ODE | CurveProblem):
        raise StartError(
            "fit: expected a problem (geodesic, autoparallel, ...) or an ODE, got "
            f"{checks.shown(problem)}."
        )
    if isinstance(times, str):
        times, data = Data.column(data, times)
    elif (column := getattr(times, "name", None)) and column not in quantities(problem):
        # A column of a table that has the times as well.
        table = checks.by_name(data, "data", StartError)
        data = {name: values for name, values in table.items() if name != column}
    names = checked_by(free, tuple(problem.variables), "free")
    at = checks.array(times, "times", TimeError, shape=(None,), shape_error=ShapeError)
    if not len(at):
        raise TimeError("times: expected the times of the data, got none.")
    measured = Data.of(at, _without_repetition(data, problem), sigma, quantities(problem))
    accuracy = checked_accuracy(accuracy)
    motion = problem.with_derivatives(names)
    grid, rows = _grid(at)

    def model(values: Mapping[str, float]) -> Prediction:
        solution = solve(motion.with_values(values), grid, accuracy, engine)
        residuals, slopes = [], []
        for name, noise in measured.sigma.items():
            _check_error(solution, name, float(noise.min(initial=np.inf)))
            columns = [_column(solution, derivative_name(name, by)) for by in names]
            prediction, *columns = (x.astype(float)[rows] for x in (solution[name], *columns))
            residuals.append(measured.compared(name, prediction))
            slopes.append(measured.slopes(name, columns))
        return Prediction(
            np.concatenate(residuals), np.concatenate(slopes), solution.error, solution
        )

    first = {name: float(problem.variables[name]) for name in names}
    return least_squares(model, first, measured, bounds, loss)


def _without_repetition(data: object, problem: ODE | CurveProblem) -> dict[str, object]:
    """The data without coordinate velocities x' or xdot, where all frame velocities are there.

    Tables of a solution have both, which are the same numbers along other legs.
    """
    table = checks.by_name(data, "data", StartError)
    if isinstance(problem, ODE):
        return table
    speeds = problem.equations().velocities
    coordinates = [x for x in quantities(problem) if x not in speeds]
    names = {f"{x}{mark}" for x in coordinates for mark in ("'", "dot")} & set(table)
    if names and not set(speeds) <= set(table):
        first = min(names)
        raise UnknownNameError(
            f"data: expected frame velocities {', '.join(speeds)}, got the coordinate velocity "
            f"{first}. Multiply the coordinate velocities by the coframe, u^i = e^i_mu q'^mu."
        )
    repeated = names | {f"{NOISE}{name}" for name in names}
    return {name: values for name, values in table.items() if name not in repeated}


def _column(solution: Solution, name: str) -> np.ndarray:
    """A derivative; zero where it is only rounding noise, which determines nothing."""
    column = solution[name]
    return column if solution.resolves(name) else np.zeros_like(column)


def quantities(problem: ODE | CurveProblem) -> tuple[str, ...]:
    """Names that have derivatives."""
    if isinstance(problem, ODE):
        return (*problem.states, *problem.outputs)
    coordinates = problem.coordinates if problem.start is not None else ()
    return (*coordinates, *problem.equations().velocities)


def _grid(at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Different times in the order of the motion, and the place of each given one."""
    grid, rows = np.unique(at, return_inverse=True)
    if grid[-1] <= 0:
        grid, rows = grid[::-1], len(grid) - 1 - rows
    if len(grid) > 1:
        return grid, rows
    # A single time would be read as the end of a motion at many times.
    return np.array([0.0, grid[0]]), np.ones(len(at), dtype=int)


def _check_error(solution: Solution, name: str, noise: float) -> None:
    """Refuse a solution whose error is not small against the noise.

    A tenth of the noise changes chi^2 by a hundredth of it.
    """
    together = solution.problem.together(name) or (name,)
    size = max(float(np.abs(solution[word]).max(initial=0.0)) for word in together)
    error = solution.error_of(name) * size
    if not error <= AIM * noise:
        raise AccuracyError(
            f"expected numerical errors of {name} below {AIM:g} of sigma = {noise:.3g}, got "
            f"{error:.3g}. Give accuracy={solution.accuracy * AIM * noise / error:.1g}."
        )
