"""Flux: the Burgers vector as the flux of torsion through the cone over the loop."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np

from geomtorsion.errors import SingularPointError
from geomtorsion.loops.arcs import Part
from geomtorsion.loops.forms import Forms
from geomtorsion.loops.line import EPS, SHAKE, Route, shaken
from geomtorsion.loops.quadrature import integrate

# Gauss points along the rays of the cone: pairs that are compared, the next if they disagree.
LEVELS = ((4, 6), (6, 10), (10, 16), (16, 26), (26, 42))
MOST_POINTS = 2**17


def flux_route(
    forms: Forms,
    part: Part,
    parameters: Sequence[Any],
    accuracy: float,
    most: int = MOST_POINTS,
) -> Route | None:
    """b^i / size**2, or None where the torsion is not smooth on the cone over the loop.

    Equation
    --------
    b^i = integral_0^1 s ds loop integral (d_m e^i_n - d_n e^i_m)(q0 + s x) x^m dx^n
    (sum over all m, n; Stokes on the surface q0 + s x).  The curl is exact, and x is the offset
    itself: nothing cancels, however small the loop.
    """

    if forms.curl is None:
        zero = np.zeros(len(part.centre))
        return Route(zero, 2, 0.0, 0.0, True, "torsion vanishes identically", 0)
    try:
        rounding = _rounding(forms, part, parameters)
        spent = 2 * len(shaken(part.arcs)[0][0])
        for few, many in LEVELS:
            found = integrate(
                part.arcs,
                lambda x, v, rays=(many, few): flux_at(forms, part, parameters, x, v, *rays),
                accuracy / 2,
                rounding,
                most // (few + many),
            )
            spent += found.points * (few + many)
            if not found.converged:
                return None
            fine, coarse = np.split(found.value, 2)
            along = float(np.abs(fine - coarse).max())
            if along <= max(accuracy / 2 * float(np.abs(fine).max()), rounding):
                rule = f"{found.rule} times {many} Gauss points"
                return Route(fine, 2, found.truncation + along, rounding, True, rule, spent)
    except SingularPointError:
        return None
    return None


def flux_at(
    forms: Forms,
    part: Part,
    parameters: Sequence[Any],
    offsets: np.ndarray,
    slopes: np.ndarray,
    *rays: int,
) -> np.ndarray:
    """The integral along the rays through offsets, by Gauss with so many points; one n for each.

    Shape (n, k) for one rule, (2 n, k) for two.
    """

    compiled = forms.curl
    if compiled is None:
        return np.zeros((len(rays) * len(part.centre), offsets.shape[1]))
    nodes = [ray_rule(count) for count in rays]
    s = np.concatenate([place for place, _ in nodes])
    centre = np.array(part.centre)[:, None, None]
    points = (centre + part.size * (s[:, None] * offsets[:, None, :])).reshape(len(centre), -1)
    values = compiled.function(*points, *parameters).reshape(len(compiled.rows), len(s), -1)
    a, b = forms.pairs
    wedge = (offsets[a] * slopes[b] - offsets[b] * slopes[a])[compiled.columns]
    results, first = [], 0
    for _, weights in nodes:
        along = np.einsum("s,esk->ek", weights, values[:, first : first + len(weights)])
        results.append(compiled.gather @ (along * wedge))
        first += len(weights)
    return np.concatenate(results)


def _rounding(forms: Forms, part: Part, parameters: Sequence[Any]) -> float:
    """What rounding does to the flux, from points whose coordinates are shaken."""

    compiled = forms.curl
    assert compiled is not None
    offsets, slopes = shaken(part.arcs)
    points = np.array(part.centre)[:, None] + 0.7 * part.size * offsets
    signs = np.where(np.arange(points.size).reshape(points.shape) * 7 % 3 == 1, SHAKE, -SHAKE)
    both = np.concatenate([points, points * (1 + signs)], axis=1)
    values, moved = np.split(compiled.function(*both, *parameters), 2, axis=1)
    noise = np.abs(moved - values) / 4 + 4 * EPS * np.abs(values)
    a, b = forms.pairs
    areas = np.abs(offsets[a] * slopes[b]) + np.abs(offsets[b] * slopes[a])
    sums = compiled.gather @ (noise * areas[compiled.columns] / 2)
    return float(sums.mean(axis=1).max()) * len(part.arcs)


@cache
def ray_rule(points: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes on (0, 1) and weights for the weight s: Gauss and Jacobi, by Golub and Welsch."""

    k = np.arange(points)
    # Recurrence of the Jacobi polynomials with alpha = 0, beta = 1 on (-1, 1).
    diagonal = 1.0 / ((2 * k + 1) * (2 * k + 3))
    j = k[1:]
    off = np.sqrt(j * (j + 1.0)) / (2 * j + 1)
    nodes, vectors = np.linalg.eigh(np.diag(diagonal) + np.diag(off, 1) + np.diag(off, -1))
    return (1 + nodes) / 2, vectors[0] ** 2 / 2
