"""Edges: integrals of a coframe along many straight edges at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from geomtorsion.errors import NetworkError, SingularPointError
from geomtorsion.loops.arcs import shown
from geomtorsion.loops.defects import find_defects
from geomtorsion.loops.forms import Forms, forms, parameter_values
from geomtorsion.loops.line import EPS
from geomtorsion.loops.planes import rows

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame

# Edges that are evaluated at once: what fits in the cache goes fastest.
PIECE = 2**13
# Gauss points of each level; edges that do not converge are halved up to this often.
FEW, MANY = 4, 7
HALVINGS = 30
# An edge that comes this close to a line, as share of its distance, goes through it.
TOUCHES = 1e-13


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
    parameters: Mapping[Any, Any] | None = None,
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
    compiled = forms(frame)
    values = parameter_values(frame, compiled.parameters, parameters)
    vectors = np.empty(starts.shape)
    errors = np.empty(len(starts))
    evaluations = 0
    for begin in range(0, len(starts), PIECE):
        part = slice(begin, begin + PIECE)
        found = _piece(compiled, values, starts[part], ends[part], accuracy, begin)
        vectors[part], errors[part] = found.vectors, found.errors
        evaluations += found.evaluations
    return EdgeIntegrals(vectors, errors, evaluations)


def refuse_touching(
    frame: Frame, starts: np.ndarray, ends: np.ndarray, parameters: Mapping[Any, Any] | None
) -> None:
    """Refuse edges that go through a line on which the coframe is singular.

    Raises
    ------
    SingularPointError
        An edge does; the message names edge, point and line.
    """

    for defect in find_defects(frame):
        if defect.across is None:
            continue
        across = np.array(rows(defect.across, frame.dimension))
        place = np.array(defect.place(parameters))
        first, last = (starts - place) @ across.T, (ends - place) @ across.T
        step = last - first
        square = np.maximum((step * step).sum(axis=1), np.finfo(float).tiny)
        share = np.clip(-(first * step).sum(axis=1) / square, 0, 1)
        near = np.abs(first + share[:, None] * step).max(axis=1)
        size = np.maximum(np.abs(first).max(axis=1), np.abs(last).max(axis=1))
        bad = np.flatnonzero(near <= TOUCHES * size)
        if len(bad):
            k = int(bad[0])
            where = starts[k] + share[k] * (ends[k] - starts[k])
            raise SingularPointError(
                f"edge {k} passes through the {defect}, at {shown(where)}, where the coframe has "
                "no finite value. Lead it past that point."
            )


def _piece(
    compiled: Forms,
    parameters: tuple[Any, ...],
    starts: np.ndarray,
    ends: np.ndarray,
    accuracy: float,
    first: int,
) -> EdgeIntegrals:
    """A block of edges: those that do not converge are halved again and again."""

    vectors = np.zeros(starts.shape)
    errors = np.zeros(len(starts))
    owner = np.arange(len(starts))
    allowed = accuracy * np.abs(ends - starts).max(axis=1)
    rounding = EPS * np.maximum(np.abs(starts), np.abs(ends)).max(axis=1)
    evaluations = 0
    for halving in range(HALVINGS):
        fine, coarse, size = _gauss(compiled, parameters, starts, ends)
        evaluations += len(owner) * (FEW + MANY)
        truncation = np.abs(fine - coarse).max(axis=1)
        noise = 4 * EPS * size + rounding[owner] * size / np.maximum(
            np.abs(ends - starts).max(axis=1), np.finfo(float).tiny
        )
        good = truncation <= np.maximum(allowed[owner] / 2**halving, noise)
        np.add.at(vectors, owner[good], fine[good])
        np.add.at(errors, owner[good], truncation[good] + noise[good])
        if good.all():
            return EdgeIntegrals(vectors, errors, evaluations)
        starts, ends, owner = starts[~good], ends[~good], owner[~good]
        middle = (starts + ends) / 2
        starts, ends = np.concatenate([starts, middle]), np.concatenate([middle, ends])
        owner = np.concatenate([owner, owner])
    raise SingularPointError(
        f"edge {first + int(owner[0])} passes through {shown(starts[0])}, where the integral of "
        "the coframe does not converge: it is singular there. Lead the edge past that point."
    )


def _gauss(
    compiled: Forms, parameters: tuple[Any, ...], starts: np.ndarray, ends: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Integrals by both rules, shape (edges, n), and the size of what was summed."""

    (x, w), (y, u) = (np.polynomial.legendre.leggauss(k) for k in (MANY, FEW))
    share = (np.concatenate([x, y]) + 1)[:, None] / 2
    steps = ends - starts
    points = [starts[:, m] + share * steps[:, m] for m in range(starts.shape[1])]
    form = compiled.coframe
    values = form.function(*points, *parameters)
    products = values * steps.T[form.columns][:, None, :]
    fine = form.gather @ np.einsum("s,esk->ek", w / 2, products[:, :MANY])
    coarse = form.gather @ np.einsum("s,esk->ek", u / 2, products[:, MANY:])
    size = (form.gather @ np.abs(products[:, :MANY]).max(axis=1)).max(axis=0)
    if not np.isfinite(fine).all():
        raise NetworkError("an edge has no finite length. Check the positions of the nodes.")
    return fine.T, coarse.T, size
