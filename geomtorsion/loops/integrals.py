"""Integrals: the coframe along loops and its curl over them, each the check of the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from geomtorsion.errors import LoopError, SingularPointError
from geomtorsion.loops.arcs import Arc, Part, Segment, at_arcs, shown
from geomtorsion.loops.chains import Chain, ClosedCurve, Shape, Square, Strip, pairs_of
from geomtorsion.loops.forms import Form, Forms, perturbed
from geomtorsion.loops.quadrature import (
    MOST_AT_ONCE,
    MOST_POINTS,
    ROUNDING,
    Integral,
    integrate,
    intervals,
    kronrod,
    kronrod_rule,
    norm,
    ray_rule,
    refined,
)
from geomtorsion.support.precision import HALF

# Two routes disagree when they differ by more than this many times their errors together.
DISAGREE = 30
# Every fifth node of the first level, or of the first intervals, is perturbed to estimate rounding:
# fewer may all be where rounding is small, more cost as much as a finer rule.
EVERY = 5
# Gauss points along the rays of a cone: pairs that are compared, the next if they disagree.
RAYS = ((4, 6), (6, 10), (10, 16), (16, 26), (26, 42))
# An integral whose error is this fraction of the sum of absolute values does not converge at all;
# the error of others reports that they did not reach the accuracy.
DIVERGES = 1e-2


@dataclass(frozen=True, eq=False)
class Route:
    """One route to the Burgers vectors of several loops, once around each.

    values: b^i / size**power, shape (n, k); power: 1 for the line, 2 for the flux.
    truncation, rounding: the two sources of the error, in the same unit, shape (k,).
    converged: where the truncation went below the accuracy, or below the rounding, shape (k,).
    rule: which rule was used; points: how many points it took.
    """

    values: np.ndarray
    power: int
    truncation: np.ndarray
    rounding: np.ndarray
    converged: np.ndarray
    rule: str
    points: int

    @property
    def error(self) -> np.ndarray:
        """Truncation and rounding together, shape (k,)."""
        return self.truncation + self.rounding


@dataclass(frozen=True, eq=False)
class Places:
    """Positions of copies of one shape.

    centres: q0^mu, shape (n, k). sizes: shape (k,).
    shares: half-axes or steps along the coordinates of the shape, in units of the size, (d, k);
        None: all of them are 1.
    directions: of the coordinates of the shape, shape (d, n); None: the coordinates of the frame.
    """

    centres: np.ndarray
    sizes: np.ndarray
    shares: np.ndarray | None = None
    directions: np.ndarray | None = None

    @classmethod
    def of(cls, part: Part) -> Places:
        """The one place of a part of a loop."""
        return cls(np.array(part.centre)[:, None], np.array([part.size]))

    def points(self, offsets: np.ndarray) -> np.ndarray:
        """Coordinates of the offsets, shape (d, p), at every place: shape (n, k, p)."""
        scaled = offsets[:, None, :] * self.sizes[:, None]
        if self.shares is not None:
            scaled *= self.shares[:, :, None]
        if self.directions is None:
            return self.centres[:, :, None] + scaled
        # Row by row: a product of matrices this thin costs more than what it computes.
        at = np.repeat(self.centres[:, :, None], offsets.shape[1], axis=2)
        for row, along in zip(scaled, self.directions.tolist(), strict=True):
            for mu, share in enumerate(along):
                if share:
                    at[mu] += row if share == 1 else share * row
        return at

    def chosen(self, which: np.ndarray) -> Places:
        """Some of the places."""
        if len(which) == len(self.sizes):
            return self
        shares = None if self.shares is None else self.shares[:, which]
        return replace(self, centres=self.centres[:, which], sizes=self.sizes[which], shares=shares)

    def projection(self, form: Form, pairs: np.ndarray | None) -> np.ndarray:
        """Components along the coordinates (or pairs) of the shape, shape (n, c, entries).

        pairs: pairs of coordinates of the frame, for a two-form; None for a one-form.
        """
        if self.directions is None:
            return form.components
        along = self.directions
        if pairs is not None:
            a, b = pairs_of(len(along))
            one, two = along[a], along[b]
            along = one[:, pairs[0]] * two[:, pairs[1]] - one[:, pairs[1]] * two[:, pairs[0]]
        return form.gather[:, None, :] * along[:, form.columns]

    def measures(self, degree: int) -> np.ndarray | None:
        """Lengths (or areas) of the coordinates (or pairs) of the shape, shape (c, k)."""
        if self.shares is None or degree == 1:
            return self.shares
        a, b = pairs_of(len(self.shares))
        return self.shares[a] * self.shares[b]


@dataclass(frozen=True, eq=False)
class _Copies:
    """A form over copies of one shape.

    tensor: its components along the coordinates (or pairs) of the shape, shape (n, c * entries).
    measures: lengths (or areas) of these at every place, shape (c, k); None: all of them are 1.
    """

    form: Form
    places: Places
    tensor: np.ndarray
    measures: np.ndarray | None

    def over(
        self, chains: Sequence[Chain], which: np.ndarray, probed: slice | None = None
    ) -> tuple[list[np.ndarray], np.ndarray]:
        """The integrals over each chain at some places, shape (n, k) each.

        Also the effect of rounding on the first of them, shape (k,), from its probed nodes. All is
        evaluated in one call, because calls take longer than the numbers of one loop.
        """
        offsets = np.concatenate([chain.points for chain in chains], axis=1)
        at = self.places.chosen(which).points(offsets)
        n, count, nodes = at.shape
        points = at.reshape(n, -1)
        if probed is not None:
            moved = perturbed(at[:, :, probed], self.places.centres[:, :, None])
            points = np.concatenate([points, moved.reshape(n, -1)], axis=1)
        sampled = self.form.values(points)
        values = sampled[:, : count * nodes].reshape(-1, count, nodes)
        noise = np.zeros(count)
        if probed is not None:
            here = values[:, :, probed]
            there = sampled[:, count * nodes :].reshape(here.shape)
            errors = (np.abs(there - here) + ROUNDING * np.abs(here)).mean(axis=2)
            spread = errors[:, :, None] * np.abs(chains[0].weights).sum(axis=1)
            noise = self._projected(np.abs(self.tensor), spread, which).max(axis=0)
        sums, start = [], 0
        for chain in chains:
            end = start + chain.points.shape[1]
            each = values[:, :, start:end] @ chain.weights.T
            sums.append(self._projected(self.tensor, each, which))
            start = end
        return sums, noise

    def _projected(self, tensor: np.ndarray, sums: np.ndarray, which: np.ndarray) -> np.ndarray:
        """From sums over the nodes, shape (entries, k, c), to frame components, shape (n, k)."""
        if self.measures is not None:
            sums = sums * self.measures[:, which].T
        return tensor @ sums.transpose(2, 0, 1).reshape(tensor.shape[1], -1)


def by_levels(
    forms: Forms, shape: Shape, places: Places, accuracy: float, degree: int
) -> Route | None:
    """The coframe along copies of a shape (degree 1), or its curl over them (degree 2).

    None where the shape needs too many points for this.
    """
    levels = shape.levels[degree - 1]
    form = forms.coframe if degree == 1 else forms.curl
    count = len(places.sizes)
    if form is None:
        return _without_torsion(places)
    if levels < 2:
        return None
    tensor = places.projection(form, forms.pairs if degree == 2 else None)
    copies = _Copies(form, places, tensor.reshape(len(tensor), -1), places.measures(degree))
    chain_of = shape.rim if degree == 1 else shape.inside
    chains = [chain_of(0), chain_of(1)]
    nodes = [x.points.shape[1] for x in chains]
    probed = slice(0, nodes[0], EVERY)
    points = count * (sum(nodes) + -(-nodes[0] // EVERY))

    def evaluate(level: int, which: np.ndarray) -> np.ndarray:
        nonlocal points
        chains.append(chain_of(level))
        points += len(which) * chains[-1].points.shape[1]
        return copies.over(chains[-1:], which)[0][0]

    with np.errstate(all="ignore"):
        first, rounding = copies.over(chains, np.arange(count), probed)
        sums = refined(first, evaluate, accuracy / 2, rounding, levels)
    return Route(
        sums.values, degree, sums.truncation, rounding, sums.converged, chains[-1].rule, points
    )


def _without_torsion(places: Places) -> Route:
    """The flux where the torsion vanishes identically."""
    n, count = len(places.centres), len(places.sizes)
    zeros, every = np.zeros(count), np.ones(count, dtype=bool)
    rule = "torsion vanishes identically"
    return Route(np.zeros((n, count)), 2, zeros, zeros, every, rule, 0)


def line_route(
    forms: Forms, part: Part, accuracy: float, cuts: Sequence[tuple[int, float]] = ()
) -> Route:
    """b^i / size = loop integral of e^i_mu(q0 + size x) dx^mu, of one part of a loop.

    cuts: where intervals are to end, because a pole of the coframe is near.

    Raises
    ------
    SingularPointError
        The coframe has no finite value somewhere on the loop.
    """
    copy = None if cuts else as_copy(part)
    if copy is not None:
        route = by_levels(forms, *copy, accuracy, 1)
        if route is not None and route.converged[0]:
            return route
    offsets, slopes, weights = probes(part.arcs, cuts)
    centre = np.array(part.centre)[:, None]
    points = centre + part.size * offsets
    values = forms.coframe.at(points)
    noise = forms.coframe.noise(points, values, centre)
    if cuts:
        noise = np.maximum(noise, _cancelled(forms, points, values) * np.abs(values))
    lengths = np.abs(slopes[forms.coframe.columns]) * weights
    size, rounding = (
        float((forms.coframe.gather @ (x * lengths)).sum(axis=1).max())
        for x in (np.abs(values), noise)
    )
    with np.errstate(all="ignore"):
        integrand = partial(line_at, forms, part)
        route = kronrod(part.arcs, integrand, accuracy, rounding, MOST_POINTS, cuts)
    if not route.converged and route.truncation > DIVERGES * size:
        raise SingularPointError(_diverges(part, route.worst))
    return _route(route, 1, rounding, route.points + 2 * points.shape[1])


def _cancelled(forms: Forms, points: np.ndarray, values: np.ndarray) -> np.ndarray:
    """The share of the entries near a pole that rounding leaves in doubt, shape (k,).

    A denominator that is small because terms cancel has few digits, and a rounding of the point
    need not show it: the largest entries are compared with exact ones. Its rounding is the same
    farther away, where it is larger itself.
    """
    poles = forms.poles
    if poles is None or poles.sizes is None:
        return np.zeros(points.shape[1])
    chosen = np.argsort(np.abs(values).max(axis=0))[-EVERY:]
    worst = 0.0
    for k in chosen:
        exact = poles.sizes(*points[:, k], *poles.numbers)
        missed = np.abs(np.abs(values[:, k]) - exact).max()
        worst = max(worst, float(missed / np.maximum(exact.max(), np.finfo(float).tiny)))
    with np.errstate(all="ignore"):
        below = np.abs(poles.values(points)).prod(axis=0)
        farther = np.fmin(below[chosen].max() / below, 1.0)
    # A few points represent all: the next may have a larger error.
    return EVERY * worst * farther


def line_at(forms: Forms, part: Part, offsets: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """e^i_mu(q0 + size x) dx^mu/ds at offsets x, shape (n, k)."""
    form = forms.coframe
    return form.along(form.at(np.array(part.centre)[:, None] + part.size * offsets), slopes)


def flux_route(forms: Forms, part: Part, accuracy: float) -> Route | None:
    """b^i / size**2, or None where the torsion is not smooth on the cone over the loop.

    Equation
    --------
    b^i = integral_0^1 s ds loop integral (d_m e^i_n - d_n e^i_m)(q0 + s x) x^m dx^n
    (sum over all m, n; Stokes on the surface q0 + s x).  The curl is exact, and x is the offset
    itself: nothing cancels, however small the loop.
    """
    if part.gap:
        return _strip_route(forms, part, accuracy)
    if forms.curl is None:
        return _without_torsion(Places.of(part))
    copy = as_copy(part)
    if copy is not None:
        route = by_levels(forms, *copy, accuracy, 2)
        if route is not None and route.converged[0]:
            return route
    try:
        rounding, used = _flux_rounding(forms, part)
        for few, many in RAYS:
            integrand = partial(flux_at, forms, part, rays=(many, few))
            most = MOST_AT_ONCE // (few + many)
            route = integrate(part.arcs, integrand, accuracy / 2, rounding, most)
            used += route.points * (few + many)
            if not route.converged:
                return None
            fine, coarse = np.split(route.value, 2)
            radial = norm(fine - coarse)
            if radial <= max(accuracy / 2 * norm(fine), rounding):
                rule = f"{route.rule} times {many} Gauss points"
                route = replace(route, value=fine, truncation=route.truncation + radial, rule=rule)
                return _route(route, 2, rounding, used)
    except SingularPointError:
        return None
    return None


def _strip_route(forms: Forms, part: Part, accuracy: float) -> Route | None:
    """The same for a loop that closes modulo periods: a straight line, and the strip beside it."""
    if not smooth(part):
        return None
    line = replace(part, arcs=(Segment((0.0,) * len(part.gap), part.gap),))
    strip = by_levels(forms, Strip(part.arcs[0], part.gap), Places.of(part), accuracy, 2)
    if strip is None or not strip.converged[0]:
        return None
    try:
        straight = line_route(forms, line, accuracy)
    except SingularPointError:
        return None
    return Route(
        strip.values + straight.values / part.size, 2,
        strip.truncation + straight.truncation / part.size,
        strip.rounding + straight.rounding / part.size,
        straight.converged, f"{strip.rule}, and a straight line", strip.points + straight.points,
    )  # fmt: skip


def refuse_other_periods(forms: Forms, part: Part) -> None:
    """Refuse a loop that closes modulo periods that the coframe does not have.

    Raises
    ------
    LoopError
        The coframe is another one a period further on.
    """
    if not part.gap:
        return
    offsets, _, _ = probes(part.arcs)
    centre, gap = np.array(part.centre)[:, None], np.array(part.gap)[:, None]
    here = centre + part.size * offsets
    coframe = forms.coframe.at(here)
    shifted = forms.coframe.at(here + part.size * gap)
    missed = np.abs(shifted - coframe).max()
    if missed > HALF * np.abs(coframe).max():
        raise LoopError(
            f"the loop closes modulo {shown(part.size * gap[:, 0])}, but there the coframe differs "
            f"by {missed:.3g}: it does not have this period. Use develop, which counts the turn of "
            "the legs, or a period of the frame."
        )


def flux_at(
    forms: Forms, part: Part, offsets: np.ndarray, slopes: np.ndarray, rays: tuple[int, ...]
) -> np.ndarray:
    """The integral along the rays through offsets, by Gauss; rays: points of each rule.

    Shape (n, k) for one rule, (2 n, k) for two.
    """
    form = forms.curl
    if form is None:
        return np.zeros((len(rays) * len(part.centre), offsets.shape[1]))
    nodes = [ray_rule(count) for count in rays]
    s = np.concatenate([place for place, _ in nodes])
    centre = np.array(part.centre)[:, None, None]
    points = (centre + part.size * (s[:, None] * offsets[:, None, :])).reshape(len(centre), -1)
    values = form.at(points).reshape(len(form.rows), len(s), -1)
    a, b = forms.pairs
    area = (offsets[a] * slopes[b] - offsets[b] * slopes[a])[form.columns]
    results, first = [], 0
    for _, weights in nodes:
        along = np.einsum("s,esk->ek", weights, values[:, first : first + len(weights)])
        results.append(form.gather @ (along * area))
        first += len(weights)
    return np.concatenate(results)


def _flux_rounding(forms: Forms, part: Part) -> tuple[float, int]:
    """What rounding does to the flux, from points halfway out in area, and how many they are."""
    form = forms.curl
    assert form is not None
    offsets, slopes, weights = probes(part.arcs)
    centre = np.array(part.centre)[:, None]
    points = centre + np.sqrt(0.5) * part.size * offsets
    a, b = forms.pairs
    areas = (np.abs(offsets[a] * slopes[b]) + np.abs(offsets[b] * slopes[a])) * weights / 2
    sums = form.gather @ (form.noise(points, form.at(points), centre) * areas[form.columns])
    return float(sums.sum(axis=1).max()), 2 * points.shape[1]


def as_copy(part: Part) -> tuple[Shape, Places] | None:
    """A part as the only copy of a shape of which maps have many: the shape and its position.

    None for polygons and splines, but for parallelograms.
    """
    if smooth(part):
        return ClosedCurve(part.arcs[0]), Places.of(part)
    sides = [arc for arc in part.arcs if isinstance(arc, Segment)]
    if len(part.arcs) != 4 or len(sides) != 4:
        return None
    corners = np.array([side.start for side in sides])
    first, second = corners[1] - corners[0], corners[3] - corners[0]
    missed = np.abs(corners[2] - corners[1] - second).max()
    if missed > ROUNDING * np.abs(corners).max():
        return None
    middle = np.array(part.centre) + part.size * corners.mean(axis=0)
    places = Places(middle[:, None], np.array([part.size]), None, np.stack([first, second]))
    return Square(), places


def smooth(part: Part) -> bool:
    """Whether a part is one smooth closed curve."""
    return len(part.arcs) == 1 and part.arcs[0].is_periodic


def probes(
    arcs: Sequence[Arc], cuts: Sequence[tuple[int, float]] = ()
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Offsets and slopes at a few points of the first intervals of every arc, and their weights."""
    owner, low, width = intervals(arcs, cuts)
    nodes = kronrod_rule().nodes[::EVERY]
    offsets, slopes = at_arcs(arcs, owner, low[:, None] + width[:, None] * nodes)
    return offsets, slopes, np.repeat(width / len(nodes), len(nodes))


def agreement(line: Route, flux: Route, sizes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where both routes agree, and where they do and the flux has the smaller error; (k,) each."""
    flux_error = sizes * flux.error
    difference = np.abs(line.values - sizes * flux.values).max(axis=0)
    agree = difference <= DISAGREE * (line.error + flux_error)
    return agree, agree & (flux_error <= line.error)


def _route(found: Integral, power: int, rounding: float, points: int) -> Route:
    """One integral as a route."""
    array = np.array
    return Route(
        found.value[:, None], power, array([found.truncation]), array([rounding]),
        array([found.converged]), found.rule, points,
    )  # fmt: skip


def _diverges(part: Part, worst: tuple[int, float] | None) -> str:
    """The message for an integral that does not converge at all."""
    place = ""
    if worst is not None:
        place = f" near {shown(part.points(part.arcs[worst[0]], worst[1])[0][:, 0])}"
    return (
        f"the integral along the loop does not converge{place}: the coframe seems to be singular "
        "there, or to vary faster than can be resolved. Lead the loop past that point."
    )
