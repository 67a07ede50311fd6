"""Circuits: winding numbers of phases along paths of pixels, and around all squares of one size.

Each comes with its chance of error. The squares share sums along lines.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.errors import ImageError, LoopError
from geomtorsion.loops import Cochain, Loop
from geomtorsion.materials.burgers import Burgers
from geomtorsion.materials.detours import Detour, Passages, detour_of, too_large
from geomtorsion.materials.rings import Edges, Rings
from geomtorsion.materials.windows import Windows
from geomtorsion.support import checks


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class LatticeBurgers(Burgers):
    """The Burgers vector of a circuit through a lattice image: whole numbers of lattice vectors.

    vector: along x and y. chance: of a wrong result, at most the accepted risk. The systematic
    error comes from the lattice vectors, because spots are located to a third of a pixel.
    pixels: of the circuit in order, pixels[k] = (x, y); the first equals the last.
    weakest: position of the smallest ratio of amplitude to noise, (x, y) in units.
    """

    pixels: np.ndarray
    weakest: tuple[float, float]

    def __repr__(self) -> str:
        size = f"{self.magnitude:.4g} {self.unit}"
        return (
            f"LatticeBurgers({self.whole.tolist()} in lattice vectors, {size}, "
            f"chance of error {self.chance:.1g})"
        )


def wound(phase: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Whole turns of phases along a closed path, and the steps of the phases without these turns.

    phase: between -pi and pi, phase[i, k]; the last value equals the first.
    """
    steps = np.diff(phase, axis=1)
    whole = np.rint(steps / (2 * np.pi)).astype(np.int64)
    count = whole.shape[1]
    ring = np.stack([np.arange(count), (np.arange(count) + 1) % count], axis=1)
    sums = Cochain.of_edges(ring, -whole.T).over(np.ones((1, count), dtype=np.int64))
    return sums.vectors[0], steps - 2 * np.pi * whole


def expected_clicks(ratio: np.ndarray, steps: np.ndarray, blur: float, axis: int) -> np.ndarray:
    """Expected number of whole turns, of either sign, that noise adds along each step.

    The rate of a carrier in noise, per unit of length and for both signs, is r erfc(sqrt(rho)) plus
    |f| exp(-rho) if the carrier frequency is off by f [Rice, "Noise in FM receivers" (1963)]. Here
    rho is the ratio of the powers of carrier and noise, and r is the rms frequency of the noise,
    1 / (2 sqrt(2) pi blur). Both terms are averaged over the two ends of the step.

    ratio: amplitude over noise at each pixel. steps: of the phase between pixels, without turns.
    """
    rms = 1 / (np.sqrt(8) * np.pi * blur)
    # Above this ratio, erfc underflows to zero.
    ratio = np.minimum(ratio, 30.0)
    still, drowned = (_means(x, axis) for x in (scipy.special.erfc(ratio), np.exp(-(ratio**2))))
    return rms * still + np.abs(steps) / (2 * np.pi) * drowned


def pixel_path(loop: Loop, step: float, shape: tuple[int, ...], unit: str) -> np.ndarray:
    """The pixels along a loop, each one step along x or y from the previous one, shape (k, 2).

    Raises
    ------
    ImageError
        The loop leaves the image, or covers only a few pixels.
    LoopError
        The loop does not have two coordinates, or does not close.
    """
    checks.instance(loop, Loop, "loop")
    if loop.dimension != 2:
        raise LoopError(
            f"loop: expected two coordinates, x and y of the image, got {loop.dimension}. Give "
            "another loop."
        )
    if loop.gap.any():
        raise LoopError(
            "loop: expected a loop that closes, got one whose ends are "
            f"{checks.shown(loop.gap.tolist())} apart. An image has no periods."
        )
    # A loop longer than a hundred times all borders is a mistake in units.
    longest = 100 * 4 * sum(shape)
    length = loop.length / step
    if length > longest:
        raise ImageError(
            f"loop: expected a length of at most {longest:,} pixels, got {length:.3g}. Give a loop "
            "inside the image with fewer turns."
        )
    corners = loop.points(max(8, int(4 * length))).T / step
    outside = (corners < -0.5) | (corners > np.array(shape) - 0.5)
    if outside.any():
        x, y = (step * corners[int(outside.any(axis=1).argmax())]).tolist()
        raise ImageError(
            f"the circuit leaves the image at ({x:.6g}, {y:.6g}) {unit}. Stay within 0 to "
            f"{step * (shape[0] - 1):.6g} in x and 0 to {step * (shape[1] - 1):.6g} in y."
        )
    # Polygons have long sides: add points, so that steps are shorter than a pixel.
    parts = np.ceil(2 * np.abs(np.diff(corners, axis=0)).max(axis=1)).astype(int)
    at = np.concatenate([[0], np.cumsum(np.maximum(parts, 1))])
    fine = [np.interp(np.arange(at[-1] + 1), at, line) for line in corners.T]
    nodes = np.rint(np.stack(fine, axis=1)).astype(np.int64)
    nodes = np.clip(nodes, 0, np.array(shape) - 1)
    nodes[-1] = nodes[0]
    # A diagonal step becomes two steps.
    between = np.stack([nodes[1:, 0], nodes[:-1, 1]], axis=1)
    path = np.concatenate([np.stack([nodes[:-1], between], axis=1).reshape(-1, 2), nodes[-1:]])
    path = path[np.concatenate([[True], (np.diff(path, axis=0) != 0).any(axis=1)])]
    if np.ptp(path, axis=0).min() < 2:
        raise ImageError(
            "loop: expected a circuit that encloses pixels, got one that is too narrow. Give a "
            f"larger loop; lengths are in {unit}, and a pixel is {step:.6g}."
        )
    return path


def detoured(
    path: np.ndarray, rings: Rings, step: float, unit: str
) -> tuple[np.ndarray, Detour | None]:
    """A path of pixels around the holes that it crosses, and its detour; None without holes.

    path: pixels in order, shape (k, 2); the first equals the last. step, unit: of a pixel.

    Raises
    ------
    ImageError
        A hole has a Burgers vector, reaches the border, or is large beside the path.
    """
    crossed = np.flatnonzero(rings.missing[tuple(path.T)])
    if not len(crossed):
        return path, None
    ways = _around_holes(path, rings)
    holes, times = np.unique(ways[1] if ways else [0], return_counts=True)
    size = abs(enclosed(path))
    if ways is None or too_large(float(times @ rings.cells[holes]), size):
        x, y = (step * path[crossed[0]]).tolist()
        raise ImageError(
            f"the circuit crosses a hole at ({x:.6g}, {y:.6g}) {unit}, where the lattice is not "
            f"visible ({len(crossed)} of {len(path)} pixels). A circuit goes around holes that are "
            "small beside it and have no Burgers vector. Choose a circuit around the hole."
        )
    change = (enclosed(ways[0]) - enclosed(path)) * step**2
    return ways[0], detour_of(rings, holes, times, change, (step, step), 0.0)


def enclosed(path: np.ndarray) -> float:
    """Signed area of a closed path of pixels, in pixels."""
    x, y = path.T
    return float((x[:-1] * y[1:] - x[1:] * y[:-1]).sum() / 2)


def whole_turns(phase: np.ndarray) -> Edges:
    """Whole turns of phases along the steps in x and in y; their sum around a circuit is b."""
    one, two = (
        -np.rint(np.diff(phase, axis=axis) / (2 * np.pi)).astype(np.int64) for axis in (1, 2)
    )
    return one, two


def rings_of(phase: np.ndarray, holes: np.ndarray) -> Rings:
    """Rings around holes without a Burgers vector, around which all circuits may go."""
    rings = Rings.of(holes)
    if not rings.count:
        return rings
    windings = rings.totals_of(rings.steps_of(whole_turns(phase)))
    return rings.only(np.logical_not(np.asarray(windings.any(axis=0))))


def squares_of(
    phase: np.ndarray, ratio: np.ndarray, rings: Rings, blur: float, size: int
) -> tuple[np.ndarray, Passages, np.ndarray]:
    """Windings of phases around all squares, their passages of holes, and expected clicks.

    The cost does not depend on the size, because sums along lines are shared. phase: phase[i, x,
    y]. ratio: the amplitude in units of its noise.
    """
    passages = Passages(rings, Windows((0, 1), (size, size), (False, False)))
    lines, turns = passages.windows, whole_turns(phase)
    clicks = [
        expected_clicks(ratio, np.diff(phase, axis=axis) + 2 * np.pi * whole, blur, axis)
        for axis, whole in zip((1, 2), turns, strict=True)
    ]
    more: np.ndarray | float = 0.0
    if rings.missing.any():
        # A way along a part of a ring has at most the clicks of the whole ring.
        more = passages.around(
            rings.totals_of(rings.steps_of((clicks[0], clicks[1]), signed=False))
        )
        for axis, each in enumerate(clicks):
            absent = rings.missing
            either = absent | np.roll(absent, -1, axis)
            each[:, np.delete(either, -1, axis)] = 0.0
        turns = rings.filled(turns)
    total = lines.sums(*lines.along(clicks[0], clicks[1])) + more
    return lines.rounds(*lines.along(*turns)), passages, np.minimum(total, 1.0)


def _around_holes(path: np.ndarray, rings: Rings) -> tuple[np.ndarray, list[int]] | None:
    """A closed path with ways around holes, and the holes that it passes; None if it has no way.

    path: pixels in order, shape (k, 2); the first equals the last.
    """
    nodes = np.ravel_multi_index((*path[:-1].T, 0), rings.hole.shape)
    absent, names = rings.missing.ravel(), rings.hole.ravel()
    if absent[nodes].all():
        return None
    nodes = np.roll(nodes, -int((~absent[nodes]).argmax()))
    inside = absent[nodes]
    pieces, passed, at = [], [], 0
    while at < len(nodes):
        if not inside[at]:
            pieces.append(nodes[at : at + 1])
            at += 1
            continue
        end = at + int(np.append(~inside[at:], True).argmax())
        hole = int(names[nodes[at]])
        way = rings.way(hole, nodes[at - 1], nodes[end % len(nodes)]) if hole >= 0 else None
        if way is None:
            return None
        pieces.append(way)
        passed.append(hole)
        at = end
    whole = np.concatenate([*pieces, nodes[:1]])
    return np.stack(np.unravel_index(whole, rings.hole.shape)[:2], axis=1), passed


def _means(values: np.ndarray, axis: int) -> np.ndarray:
    """Means of neighbours."""
    count = values.shape[axis]
    one, other = (np.take(values, range(k, count - 1 + k), axis) for k in (0, 1))
    return (one + other) / 2
