"""Edges: integrals of a coframe along many straight edges at once, each a sum of its own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.errors import NetworkError, SingularPointError
from geomtorsion.loops.arcs import Parameters, Part, Segment, shown
from geomtorsion.loops.defects import find_defects, lines_alone
from geomtorsion.loops.forms import Form, Forms, forms
from geomtorsion.loops.integrals import line_route
from geomtorsion.loops.poles import NEAR_POLE, SAMPLES, refuse_poles
from geomtorsion.loops.quadrature import PIECE, ROUNDING, cut, gauss_pair, graded, halved
from geomtorsion.loops.validation import rows
from geomtorsion.loops.winding import nearest
from geomtorsion.precision import CALCULATED

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame

# Most edges are so short that fewer points of Gauss than Kronrod's are enough.
POINTS = (4, 7)
# Lines nearer than this share of an edge make a peak that these points may miss.
NEAR = 1 / 16


@dataclass(frozen=True, eq=False)
class EdgeIntegrals:
    """Integrals along edges.

    vectors: shape (edges, n); errors: bound on the largest component of each, shape (edges,).
    evaluations: points at which the coframe was evaluated.
    """

    vectors: np.ndarray
    errors: np.ndarray
    evaluations: int


def edge_integrals(
    frame: Frame,
    starts: np.ndarray,
    ends: np.ndarray,
    accuracy: float = 1e-12,
    *,
    parameters: Parameters | None = None,
) -> EdgeIntegrals:
    """Integral of e^i_mu dq^mu along straight edges, shape (edges, n) each; errors are measured.

    Raises
    ------
    SingularPointError
        An edge passes through a point where the coframe is singular; the message names it.
    NetworkError
        The frame is complex.
    """
    if frame.complex:
        raise NetworkError(
            "networks are summed in real numbers, but the frame is declared complex. "
            "Use burgers_vector or develop for single loops, or a real frame."
        )
    compiled = forms(frame, parameters)
    shares, distances = _nearest_line(frame, starts, ends, parameters)
    vectors, errors = np.empty(starts.shape), np.empty(len(starts))
    evaluations = 0
    alone = _near_other_poles(frame, compiled, starts, ends)
    for k in alone.tolist():
        vectors[k], errors[k], points = _by_itself(compiled, starts[k], ends[k], accuracy, k)
        evaluations += points
    others = np.delete(np.arange(len(starts)), alone)
    # As many as fit in the cache go fastest.
    together = PIECE // sum(POINTS)
    for begin in range(0, len(others), together):
        # A slice where all edges are meant: what lies together is taken together.
        part = others[begin : begin + together] if len(alone) else slice(begin, begin + together)
        vectors[part], errors[part], points = _block(
            compiled.coframe, starts[part], ends[part], shares[part], distances[part], accuracy,
            others[begin : begin + together],
        )  # fmt: skip
        evaluations += points
    return EdgeIntegrals(vectors, errors, evaluations)


def _block(
    coframe: Form,
    starts: np.ndarray,
    ends: np.ndarray,
    shares: np.ndarray,
    distances: np.ndarray,
    accuracy: float,
    numbers: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, int]:
    """Vectors and errors of a block of edges, and how many points were evaluated."""
    begin, step = starts.T, (ends - starts).T
    lengths = np.abs(step).max(axis=0)
    count = len(starts)

    def sampler(owner: np.ndarray, s: np.ndarray) -> np.ndarray:
        along = step[:, owner]
        points = begin[:, owner][:, :, None] + s * along[:, :, None]
        values = coframe.values(points.reshape(len(points), -1)).reshape(-1, *s.shape)
        result = np.zeros_like(points)
        # Row by row: a product of matrices this thin costs more than what it computes.
        for i, mu, value in zip(coframe.rows, coframe.columns, values, strict=True):
            result[i] += value * along[mu][:, None]
        return result

    # A peak near a singular line would be missed; the nearer it is, the narrower.
    widths = distances / lengths
    cuts = [
        (int(k), s)
        for k in np.flatnonzero(widths < NEAR)
        for s in graded(float(shares[k]), float(widths[k]), NEAR)
    ]
    whole = cut(np.arange(count), np.zeros(count), cuts)
    # Ends rounded in their last place, and the evaluation of the coframe between them.
    places = np.maximum(np.abs(starts), np.abs(ends)).max(axis=1)
    noise = ROUNDING + ROUNDING / 4 * places / np.minimum(lengths, distances)
    with np.errstate(all="ignore"):
        found = halved(
            sampler, np.arange(count), whole, gauss_pair(*POINTS), 0.0, accuracy * lengths, noise
        )
    if found.worst is not None:
        k, s = found.worst
        where = starts[k] + s * (ends[k] - starts[k])
        raise SingularPointError(
            f"edge {numbers[k]} passes through {shown(where)}, where the integral of the coframe "
            "does not converge: it is singular there. Lead the edge past that point."
        )
    assert found.sizes is not None
    return found.values.T, found.truncation + noise * found.sizes, found.points


def _near_other_poles(
    frame: Frame, compiled: Forms, starts: np.ndarray, ends: np.ndarray
) -> np.ndarray:
    """Numbers of the edges near poles that are no straight lines."""
    poles = compiled.poles
    found = [np.zeros(0, dtype=np.int64)]
    if poles is None or lines_alone(frame, poles):
        return found[0]
    together = PIECE // SAMPLES
    s = np.linspace(0, 1, SAMPLES)
    for begin in range(0, len(starts), together):
        low, high = starts[begin : begin + together].T, ends[begin : begin + together].T
        points = low[:, :, None] + (high - low)[:, :, None] * s
        values = poles.values(points.reshape(len(points), -1)).reshape(-1, low.shape[1], SAMPLES)
        sizes = np.abs(values)
        near = ~(sizes.min(axis=2) >= NEAR_POLE * sizes.max(axis=2))
        if not np.iscomplexobj(values):
            near |= (values.min(axis=2) < 0) & (values.max(axis=2) > 0)
        found.append(begin + np.flatnonzero(near.any(axis=0)))
    return np.concatenate(found)


def _by_itself(
    compiled: Forms, start: np.ndarray, end: np.ndarray, accuracy: float, number: int
) -> tuple[np.ndarray, float, int]:
    """Vector and error of one edge, as a side of a loop, and points evaluated.

    Raises
    ------
    SingularPointError
        It goes through a pole; the message names edge and point.
    """
    size = float(np.abs(end - start).max())
    side = Segment((0.0,) * len(start), tuple(((end - start) / size).tolist()))
    part = Part(tuple(start.tolist()), size, (side,))
    try:
        found = line_route(compiled, part, accuracy, refuse_poles(compiled.poles, part))
    except SingularPointError as reason:
        raise SingularPointError(str(reason).replace("the loop", f"edge {number}")) from None
    return size * found.values[:, 0], size * float(found.error[0]), found.points


def _nearest_line(
    frame: Frame, starts: np.ndarray, ends: np.ndarray, parameters: Parameters | None
) -> tuple[np.ndarray, np.ndarray]:
    """Where each edge is nearest to a line on which the coframe is singular, and how near.

    Returns
    -------
    Share of the way along each edge, and distance, infinite without lines; shape (edges,) each.

    Raises
    ------
    SingularPointError
        An edge goes through such a line; the message names edge, point and line.
    """
    shares, distances = np.zeros(len(starts)), np.full(len(starts), np.inf)
    for defect in find_defects(frame):
        if defect.across is None:
            continue
        across = np.array(rows(defect.across, frame.dimension))
        place = np.array(defect.place(parameters))
        one, two = (across @ (points - place).T for points in (starts, ends))
        share, distance = nearest(one, two)
        size = np.maximum(np.abs(one).max(axis=0), np.abs(two).max(axis=0))
        bad = np.flatnonzero(distance <= CALCULATED * size)
        if len(bad):
            k = int(bad[0])
            where = starts[k] + share[k] * (ends[k] - starts[k])
            raise SingularPointError(
                f"edge {k} passes through the {defect}, at {shown(where)}, where the coframe has "
                "no finite value. Lead it past that point."
            )
        shares = np.where(distance < distances, share, shares)
        distances = np.minimum(distances, distance)
    return shares, distances
