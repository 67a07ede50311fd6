"""Line: the Burgers vector as the integral of the coframe along the loop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from geomtorsion.errors import SingularPointError
from geomtorsion.loops.arcs import Arc, Part, shown
from geomtorsion.loops.forms import Forms
from geomtorsion.loops.quadrature import MOST_POINTS, integrate

EPS = 2.0**-52
# Points whose coordinates are shaken by this much, to see what rounding does to the integrand.
SHAKE = 16 * EPS
SHAKEN_POINTS = 24
# A denominator this small beside its largest value is a zero on the loop.
POLE = 1e-24
ZOOMS = 24


@dataclass(frozen=True, eq=False)
class Route:
    """One route to the Burgers vector of one part, once round.

    value: b^i / size**power, shape (n,); power: 1 for the line, 2 for the flux.
    truncation, rounding: the two sources of its error, in the same unit.
    converged: whether the truncation went below the accuracy, or below the rounding.
    rule: which rule was used; points: how many points it took.
    """

    value: np.ndarray
    power: int
    truncation: float
    rounding: float
    converged: bool
    rule: str
    points: int

    @property
    def error(self) -> float:
        """Truncation and rounding together."""
        return self.truncation + self.rounding


def line_route(
    forms: Forms,
    part: Part,
    parameters: Sequence[Any],
    accuracy: float,
    most: int = MOST_POINTS,
) -> Route:
    """b^i / size = loop integral of e^i_mu(q0 + size x) dx^mu.

    Raises
    ------
    SingularPointError
        The coframe has no finite value somewhere on the loop.
    """

    centre = np.array(part.centre)[:, None]
    compiled = forms.coframe
    integrand = partial(line_at, forms, part, parameters)
    refuse_poles(forms, part, parameters)
    offsets, slopes = shaken(part.arcs)
    points = centre + part.size * offsets
    signs = np.where(np.arange(points.size).reshape(points.shape) * 7 % 3 == 1, SHAKE, -SHAKE)
    both = np.concatenate([points, points * (1 + signs)], axis=1)
    values = compiled.function(*both, *parameters)
    values, moved = values[:, : points.shape[1]], values[:, points.shape[1] :]
    noise = np.abs(moved - values) / 4 + 2 * EPS * np.abs(values)
    rounding = _sum_of(forms, noise, slopes, len(part.arcs))
    found = integrate(part.arcs, integrand, accuracy, rounding, most)
    if not found.converged and found.truncation > 1e-2 * _sum_of(
        forms, np.abs(values), slopes, len(part.arcs)
    ):
        raise SingularPointError(_diverges(part, found.worst))
    used = found.points + 2 * points.shape[1]
    return Route(found.value, 1, found.truncation, rounding, found.converged, found.rule, used)


def line_at(
    forms: Forms, part: Part, parameters: Sequence[Any], offsets: np.ndarray, slopes: np.ndarray
) -> np.ndarray:
    """e^i_mu(q0 + size x) dx^mu/ds at offsets x, shape (n, k)."""

    compiled = forms.coframe
    points = np.array(part.centre)[:, None] + part.size * offsets
    values = compiled.function(*points, *parameters)
    return compiled.gather @ (values * slopes[compiled.columns])


def shaken(arcs: Sequence[Arc]) -> tuple[np.ndarray, np.ndarray]:
    """Offsets and slopes at a few points of every arc (of some, where there are many)."""

    chosen = arcs[:: -(-len(arcs) // SHAKEN_POINTS)]
    each = max(1, SHAKEN_POINTS // len(chosen))
    s = (np.arange(each) + 0.382) / each
    pairs = [arc.shape(s) for arc in chosen]
    offsets, slopes = (np.concatenate(arrays, axis=1) for arrays in zip(*pairs, strict=True))
    return offsets, slopes


def _sum_of(forms: Forms, sizes: np.ndarray, slopes: np.ndarray, arcs: int) -> float:
    """Integral of sizes |dx| along all arcs from a few points: the largest component."""

    compiled = forms.coframe
    sums = compiled.gather @ (sizes * np.abs(slopes[compiled.columns]))
    return float(sums.mean(axis=1).max()) * arcs


def refuse_poles(forms: Forms, part: Part, parameters: Sequence[Any]) -> None:
    """Refuse a loop on which a denominator of the coframe vanishes."""

    if forms.poles is None:
        return
    for arc in part.arcs:
        count = max(17, 4 * arc.waves + 1)
        s = np.linspace(0, 1, count)
        values = _poles(forms, part, arc, s, parameters)
        for k, row in enumerate(values):
            largest = np.abs(row).max()
            best = int(np.abs(row).argmin())
            signs = np.flatnonzero(row[1:] * row[:-1] < 0) if not np.iscomplexobj(row) else ()
            for start in sorted({best, *_dips(np.abs(row)).tolist(), *map(int, signs)}):
                low, high = s[max(start - 1, 0)], s[min(start + 1, count - 1)]
                place = _zero(forms, part, arc, parameters, k, low, high, largest)
                if place is not None:
                    point = part.points(arc, place)[0][:, 0]
                    raise SingularPointError(
                        f"the loop passes through {shown(point)}, where {forms.pole_names[k]} "
                        "vanishes and the coframe has no finite value. Lead it past that point."
                    )


def _dips(sizes: np.ndarray) -> np.ndarray:
    """Places of the local minima that are small."""

    inner = (sizes[1:-1] <= sizes[:-2]) & (sizes[1:-1] <= sizes[2:])
    return np.flatnonzero(inner & (sizes[1:-1] < 0.3 * sizes.max())) + 1


def _zero(
    forms: Forms,
    part: Part,
    arc: Arc,
    parameters: Sequence[Any],
    k: int,
    low: float,
    high: float,
    largest: float,
) -> float | None:
    """Where denominator k vanishes between two values of s, or None."""

    for _ in range(ZOOMS):
        s = np.linspace(low, high, 9)
        row = _poles(forms, part, arc, s, parameters)[k]
        best = int(np.abs(row).argmin())
        crosses = not np.iscomplexobj(row) and row.min() < 0 < row.max()
        if np.abs(row[best]) <= POLE * largest or crosses:
            return float(s[best])
        if np.abs(row[best]) > 0.9 * np.abs(row).max():
            return None
        low, high = s[max(best - 1, 0)], s[min(best + 1, 8)]
    return None


def _poles(
    forms: Forms, part: Part, arc: Arc, s: np.ndarray, parameters: Sequence[Any]
) -> np.ndarray:
    """Values of all denominators along an arc, shape (poles, k)."""
    assert forms.poles is not None
    return forms.poles(*part.points(arc, s)[0], *parameters)


def _diverges(part: Part, worst: tuple[int, float] | None) -> str:
    """The message for an integral that does not converge at all."""
    place = ""
    if worst is not None:
        place = f" near {shown(part.points(part.arcs[worst[0]], worst[1])[0][:, 0])}"
    return (
        f"the integral along the loop does not converge{place}: the coframe seems to be singular "
        "there, or to vary faster than can be resolved. Lead the loop past that point."
    )
