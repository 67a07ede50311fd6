"""Widened: squares that missing nodes cut off, replaced by larger squares around these nodes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from math import prod

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.materials.burgers import Covariance
from geomtorsion.materials.rings import Rings
from geomtorsion.materials.survey import Errors, Survey


@dataclass(frozen=True, eq=False)
class _Part:
    """Circuits of a larger survey at places of the original one, each a tuple of index arrays."""

    survey: Survey
    places: tuple[np.ndarray, ...]
    source: tuple[np.ndarray, ...]


def widened(
    survey: Survey, rings: Rings, of_side: Callable[[int], Survey], periodic: Sequence[bool]
) -> Survey:
    """The survey with the smallest larger square in each place where a square has no b.

    The larger square contains the requested one, as near to its middle as possible. Its side is
    the extent of a hole, or the smallest side that may pass a hole. of_side: survey of a side.
    """
    side, plane = survey.size[0], survey.plane
    shape, parts = rings.missing.shape, []
    most = min(shape[k] - 1 for k in plane)
    unknown = ~survey.known
    for wider in _sides(rings):
        if not side < wider <= most:
            continue
        if not unknown.any():
            break
        larger = of_side(wider)
        places, source = _containing(larger.known, unknown, plane, wider - side, periodic)
        if len(places[0]):
            parts.append(_Part(larger, places, source))
            unknown[places] = False
    if not parts:
        return survey
    vectors, area = survey.vectors.copy(), np.array(np.broadcast_to(survey.area, unknown.shape))
    sides = np.full(unknown.shape, side)
    passages = np.zeros(unknown.shape) if survey.passages is None else survey.passages.copy()
    for part in parts:
        vectors[(slice(None), *part.places)] = part.survey.vectors[(slice(None), *part.source)]
        area[part.places] = np.broadcast_to(part.survey.area, part.survey.known.shape)[part.source]
        sides[part.places] = part.survey.size[0]
        if part.survey.passages is not None:
            passages[part.places] = part.survey.passages[part.source]
    return replace(
        survey,
        vectors=vectors,
        area=area,
        sides=sides,
        passages=passages,
        estimate=partial(_errors, survey, tuple(parts)),
    )


def _sides(rings: Rings) -> list[int]:
    """Sides of squares that fit a hole, or that may pass one, in cells."""
    if not rings.count:
        return []
    ends = [
        ufunc.reduceat(rings.places, rings.first[:-1], axis=1) for ufunc in (np.minimum, np.maximum)
    ]
    fitting = (ends[1] - ends[0]).max(axis=0)
    passing = np.ceil(np.sqrt(2 * rings.cells)).astype(int)
    return np.unique(np.concatenate([fitting, passing])).tolist()


def _containing(
    known: np.ndarray,
    unknown: np.ndarray,
    plane: tuple[int, int],
    extra: int,
    periodic: Sequence[bool],
) -> tuple[tuple[np.ndarray, ...], tuple[np.ndarray, ...]]:
    """Places without b, and for each the known larger square around it that is nearest to it.

    known: of the larger squares. extra: difference of the sides.
    """
    table, open_ = (np.moveaxis(x, plane, (0, 1)) for x in (known, unknown))
    counts, others = table.shape[:2], table.shape[2:]
    table, open_ = (x.reshape(*x.shape[:2], prod(others)) for x in (table, open_))
    places: list[np.ndarray] = []
    starts: list[np.ndarray] = []
    for layer in range(table.shape[2]):
        rows = np.argwhere(open_[..., layer])
        padded = table[..., layer]
        for axis, k in enumerate(plane):
            ends = [(extra, extra) if axis == one else (0, 0) for one in (0, 1)]
            padded = np.pad(padded, ends, mode="wrap" if periodic[k] else "constant")
        if not (len(rows) and padded.any()):
            continue
        nearest = scipy.ndimage.distance_transform_cdt(
            ~padded, "chessboard", return_distances=False, return_indices=True
        )
        chosen = np.full(rows.shape, -1)
        # If the difference is odd, two middles along each axis are equally near.
        for half in product(sorted({extra // 2, extra - extra // 2}), repeat=2):
            start = nearest[:, *(rows + extra - np.array(half)).T].T - extra
            inside = ((start <= rows) & (start >= rows - extra)).all(axis=1) & (chosen[:, 0] < 0)
            chosen[inside] = (start % np.array(counts))[inside]
        good = chosen[:, 0] >= 0
        index = np.full((int(good.sum()), 1), layer)
        places.append(np.hstack([rows[good], index]))
        starts.append(np.hstack([chosen[good], index]))
    return _restored(places, others, plane), _restored(starts, others, plane)


def _restored(
    rows: list[np.ndarray], others: tuple[int, ...], plane: tuple[int, int]
) -> tuple[np.ndarray, ...]:
    """Index arrays in the order of the axes of the grid, from rows (p, q, layer)."""
    table = np.concatenate([np.zeros((0, 3), dtype=np.int64), *rows])
    rest = iter(np.unravel_index(table[:, 2], others) if others else ())
    along = {plane[0]: table[:, 0], plane[1]: table[:, 1]}
    return tuple(along[k] if k in along else next(rest) for k in range(2 + len(others)))


def _errors(survey: Survey, parts: tuple[_Part, ...]) -> Errors:
    """Errors of the survey, with the errors of the larger squares at their places."""
    shape = survey.known.shape
    every = [(survey.estimated, None), *((part.survey.estimated, part) for part in parts)]
    names = sorted({name for one, _ in every for name in one.covariance})
    covariance: Covariance = {name: np.zeros(shape) for name in names}
    systematic = np.zeros(shape)
    for one, part in every:
        here: tuple[np.ndarray, ...] | slice = slice(None) if part is None else part.places
        for name in names:
            covariance[name][here] = _at(one.covariance.get(name, np.zeros(())), part, shape)
        systematic[here] = _at(one.systematic, part, shape)
    return Errors(covariance, systematic)


def _at(values: np.ndarray, part: _Part | None, shape: tuple[int, ...]) -> np.ndarray:
    """Values of a survey at the places of a part, or all of them."""
    if part is None:
        return np.broadcast_to(values, shape)
    return np.broadcast_to(values, part.survey.known.shape)[part.source]
