"""fits: data with their noise, the fitted model, and the residuals."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.fits import Fit
from geomtorsion.ode import Solution
from geomtorsion.pictures.style import SERIES, STYLE, captioned, mathematics, new_figure, quiet
from geomtorsion.support import checks

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw_fit(fit: Fit) -> Figure:
    """Draw data and model of each quantity, and below them the residuals in units of sigma.

    Returns
    -------
    A matplotlib figure.

    Raises
    ------
    ArgumentError
        It is not a fit.
    MissingExtraError
        matplotlib is not installed.

    Examples
    --------
    >>> import geomtorsion as gt
    >>> fall = gt.ODE.of({"v": "-g"}, [0], parameters={"g": 10})
    >>> result = gt.fit(fall, [1, 2, 3], {"v": [-9.7, -19.7, -29.4]}, 0.1, ["g"])
    >>> [axes.get_ylabel() for axes in draw_fit(result).axes]
    ['$v$', 'residual / $\\\\sigma$']
    """
    checks.instance(fit, Fit, "fit", expected="the result of gt.fit")
    panels = list(_panels(fit))
    columns = min(3, len(panels))
    bands = -(-len(panels) // columns)
    figure = new_figure(4.6 * columns, 1.0 + 3.4 * bands)
    figures = figure.subfigures(bands, columns, squeeze=False).ravel()
    for place, (name, index) in zip(figures, panels, strict=False):
        above, below = place.subplots(2, 1, sharex=True, height_ratios=(2, 1))
        at, sigma = fit.data.at, fit.data.sigma[name][index]
        data, residuals = fit.data.values[name][index], fit.residuals[name][index]
        dots = {"fmt": "o", "markersize": 3, "color": SERIES[3].color, "elinewidth": 0.8}
        above.errorbar(at, data, sigma, label="data", **dots)
        above.plot(*_model(fit, name, index), label="model", **SERIES[0].line)
        above.set_ylabel(_label(name, index))
        below.errorbar(at, residuals, np.ones_like(residuals), **dots)
        below.axhline(0.0, **SERIES[0].line)
        below.set_ylabel(r"residual / $\sigma$")
        below.set_xlabel(_abscissa(fit))
        for axes in (above, below):
            quiet(axes)
        above.legend(frameon=False, fontsize=9)
    captioned(figure, str(fit).splitlines())
    return figure


def _panels(fit: Fit) -> Iterator[tuple[str, tuple[slice | int, ...]]]:
    """Name and index of each column of data."""
    for name, values in fit.data.values.items():
        if values.ndim == 1:
            yield name, (slice(None),)
        else:
            yield from ((name, (slice(None), k)) for k in range(values.shape[1]))


def _label(name: str, index: tuple[slice | int, ...]) -> str:
    """The quantity as mathematics, with the number of its component."""
    word = mathematics(name)
    return word if len(index) == 1 else f"{word}, component {int(index[1]) + 1}"  # type: ignore[arg-type]


def _model(fit: Fit, name: str, index: tuple[slice | int, ...]) -> tuple[np.ndarray, np.ndarray]:
    """The model as a smooth line, or at the data if it is known only there."""
    if isinstance(fit.source, Solution):
        times = np.linspace(0.0, float(fit.source.times[-1]), STYLE.samples)
        return times, np.asarray(fit.source.at(times)[name], dtype=float)[index]
    data, sigma = fit.data.values[name], fit.data.sigma[name]
    return fit.data.at, (data - fit.residuals[name] * sigma)[index]


def _abscissa(fit: Fit) -> str:
    """What the data are arranged by."""
    if isinstance(fit.source, Solution):
        return mathematics(fit.source.problem.time_name)
    return "number of the loop or point"
