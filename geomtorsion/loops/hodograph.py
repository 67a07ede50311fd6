"""Hodograph: the curve that a loop draws in the frame, up to where it fails to close."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from geomtorsion.loops.forms import forms
from geomtorsion.loops.integrals import line_at
from geomtorsion.loops.loop import Loop
from geomtorsion.loops.quadrature import kronrod_rule
from geomtorsion.loops.result import BurgersVector

# Smaller loops are drawn at this size: their deviation from the linear image scales as its square.
LEAST_SIZE = float(np.finfo(float).eps ** (1 / 3))


@dataclass(frozen=True, eq=False)
class Hodograph:
    """A loop and its image, ready to be drawn.

    path: offsets from the centre in units of `unit`, shape (n, k).
    image: X^i along the loop in the same unit, shape (n, k); it starts at 0.
    centre: coordinates from which the path counts.
    unit: what the axes count, as text: empty for 1.
    magnified: by how much the gap and all that is not linear was enlarged.
    """

    path: np.ndarray
    image: np.ndarray
    centre: tuple[float, ...]
    unit: str
    magnified: float


def outline(loop: Loop, points: int = 360) -> tuple[np.ndarray, float, str]:
    """Offsets of a loop from its centre, shape (n, k), the size of one loop in them, and the unit.

    Tiny and huge loops are measured in units of their own size; the unit is given as text.
    """
    stretches = list(loop.arcs())
    each = max(2, points // len(stretches))
    path = []
    for part, arc, backwards in stretches:
        shift = (np.array(part.centre) - np.array(loop.centre)) / loop.size
        ends, _ = arc.shape(np.arange(each + 1) / each)
        offsets = shift[:, None] + part.size / loop.size * ends
        path.append(offsets[:, ::-1] if backwards else offsets)
    way = np.concatenate([path[0][:, :1], *(piece[:, 1:] for piece in path)], axis=1)
    plain = 1e-3 <= loop.size <= 1e3
    size = loop.size if plain else 1.0
    return way * size, size, "" if plain else f"{loop.size:.3g}"


def hodograph(b: BurgersVector, points: int = 360, shown: float = 0.25) -> Hodograph:
    """The image of a loop in the frame, with its gap enlarged where it could not be seen.

    shown: a gap below a tenth of this share of the figure is magnified to it.
    """
    loop, compiled = b.loop, forms(b.frame, b.parameters)
    stretches = list(loop.arcs())
    each = max(2, points // len(stretches))
    steps, linear = [], []
    grown = max(1.0, LEAST_SIZE / loop.size) if b.power == 2 else 1.0
    first = loop.parts[0]
    base = tuple(replace(first, size=first.size * grown).base.tolist())
    for part, arc, backwards in stretches:
        larger = replace(part, size=part.size * grown)
        rule = kronrod_rule()
        s = (np.arange(each)[:, None] + rule.nodes).ravel() / each
        offsets, slopes = arc.shape(s)
        values = line_at(compiled, larger, offsets, slopes)
        rows = values.reshape(len(values), each, -1) @ rule.fine / each
        # The frame at the base point, taken as constant, gives a linear image that closes.
        fixed = replace(part, size=0.0, centre=base)
        flat = line_at(compiled, fixed, offsets, slopes)
        flat = flat.reshape(len(flat), each, -1) @ rule.fine / each
        share = part.size / loop.size
        sign = -1 if backwards else 1
        order = slice(None, None, sign)
        linear.append(sign * share * flat[:, order])
        steps.append(sign * share * ((rows - flat) / grown)[:, order])
    curved = _running(np.concatenate(steps, axis=1))
    straight = _running(np.concatenate(linear, axis=1))
    extent = float(np.ptp(straight + curved, axis=1).max()) or 1.0
    gap = float(np.abs(b.reduced).max()) * (b.size if b.power == 2 else 1.0)
    magnified = 1.0
    if 0 < gap < shown / 10 * extent and not b.vanishes:
        magnified = float(10.0 ** np.floor(np.log10(shown * extent / gap) + 0.5))
    path, size, unit = outline(loop, points)
    image = np.real(straight + magnified * curved) * size
    return Hodograph(path, image, loop.centre, unit, magnified)


def _running(steps: np.ndarray) -> np.ndarray:
    """Running sum from zero, along the last axis."""
    return np.concatenate([np.zeros((len(steps), 1)), np.cumsum(steps, axis=1)], axis=1)
