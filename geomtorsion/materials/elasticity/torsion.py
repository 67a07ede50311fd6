"""Torsion: the Fourier modes of the torsion of lines, coframes and Nye fields, checked."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.errors import GridError, NetworkError
from geomtorsion.materials.elasticity.cell import Cell
from geomtorsion.materials.elasticity.nye_field import (
    NyeField,
    balance_text,
    box_of,
    checked_frame,
)
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.lines import Box, DislocationNetwork, LineArrays
from geomtorsion.support import checks
from geomtorsion.support.precision import CALCULATED


@dataclass(frozen=True, eq=False)
class TorsionModes:
    """A distortion with the torsion of a source, as modes; the sign is of the crystal.

    sign: b of the crystal (closed integral of du) over b of the source. mean: the mean coframe.
    distortion: beta at the nodes; or alpha: at the nodes; or lines with the width of their core.
    """

    sign: int
    mean: np.ndarray = field(default_factory=lambda: np.eye(3))
    distortion: np.ndarray | None = None
    alpha: np.ndarray | None = None
    lines: LineArrays | None = None
    core: float = 0.0

    def modes(self, cell: Cell, waves: np.ndarray) -> np.ndarray:
        """Modes of a distortion with this torsion, shape (modes, 3, 3)."""
        k = cell.vectors(waves)
        k2 = (k**2).sum(axis=1)
        if self.lines is not None:
            alpha = _line_modes(self.lines, cell, waves)
        else:
            values = self.distortion if self.alpha is None else self.alpha
            assert values is not None
            alpha = cell.modes(values, waves)
        alpha = self.sign * alpha * np.exp(-k2 * self.core**2 / 2)[:, None, None]
        if self.distortion is not None:
            return alpha
        return 1j * np.cross(k[:, None, :], alpha) / k2[:, None, None]


def _line_modes(lines: LineArrays, cell: Cell, waves: np.ndarray) -> np.ndarray:
    """Modes of sum b^i t^k delta(line), each straight piece exactly, shape (modes, 3, 3)."""
    alpha = np.zeros((len(waves), 9), complex)
    starts = lines.positions[lines.pairs[:, 0]]
    densities = np.einsum("pi,pk->pik", lines.burgers, lines.steps).reshape(-1, 9)
    for block, means in cell.pieces(starts, lines.steps, waves):
        alpha += means.T @ densities[block]
    return alpha.reshape(-1, 3, 3) / cell.box.volume


def of_network(
    net: DislocationNetwork, shape: object, core: float | None, *, balance: bool, sign: int
) -> tuple[Cell, TorsionModes, tuple[str, ...]]:
    """The torsion of lines in a periodic box, on a grid that resolves their cores.

    Raises
    ------
    NetworkError
        See `stresses`.
    """
    box = net.box
    if box is None or not np.asarray(box.periodic).all():
        raise NetworkError(
            "stresses: expected lines in a box that is periodic along all edges, got "
            f"{'no box' if box is None else 'open edges'}. Give LineArrays(..., box=Box.of_bounds("
            "low, high)); closed loops in a bounded crystal need a larger box around them."
        )
    lines = net.checked().arrays
    if len(lines.pairs) and lines.burgers.shape[1] != 3:
        raise NetworkError(
            f"burgers: expected three components, got {lines.burgers.shape[1]}. Give b in the "
            "coordinates of the nodes."
        )
    lengths = np.linalg.norm(lines.burgers, axis=1) * lines.lengths
    excess = np.abs(lines.excess).max(axis=1, initial=0.0)
    ends = np.flatnonzero(excess > net.tolerance * np.abs(lines.burgers).max(initial=0.0))
    if len(ends):
        raise NetworkError(
            f"stresses: expected lines that end nowhere, got {len(ends):,} that end at a surface, "
            f"such as at node {lines.labels[ends[0]]!r}. Close them outside the crystal."
        )
    total = lines.burgers.T @ lines.steps if len(lines.pairs) else np.zeros((3, 3))
    texts: tuple[str, ...] = ()
    if np.abs(total).max() > net.tolerance * lengths.sum():
        mean = total / box.volume
        if not balance:
            raise NetworkError(
                "stresses: expected lines whose b adds up to zero over the box, got a mean Nye "
                f"tensor up to {np.abs(mean).max():.3g}. Add lines of opposite sign, or give "
                "balance=True, which spreads them evenly."
            )
        texts = (balance_text(mean, ""),)
    cell = Cell(box, _shape_of(lines, box, shape))
    steps = cell.steps[np.array(cell.shape) > 1]
    step = float(steps.max(initial=0.0))
    width = 2 * step if core is None else core
    if width < step:
        raise NetworkError(
            f"core: expected a width of at least one step of the grid, {step:.6g}, got "
            f"{width:.6g}. Give more nodes with shape, or a wider core."
        )
    return cell, TorsionModes(sign, lines=lines, core=width), texts


def _shape_of(lines: LineArrays, box: Box, shape: object) -> tuple[int, ...]:
    """Number of nodes along each edge: one along an edge along which all lines run."""
    edges = np.asarray(box.vectors)
    sizes = np.linalg.norm(edges, axis=1)
    across = np.abs(np.cross(lines.steps[:, None, :], edges)).max(axis=2)
    along = (across <= CALCULATED * sizes * lines.lengths[:, None]).all(axis=0)
    if not len(lines.pairs):
        along[:] = False
    if shape is None or checks.whole(shape) is not None:
        # Two seconds for a loop; the error of the result shows whether a problem needs more.
        nodes = 64 if shape is None else checks.count(shape, "shape", NetworkError, 4)
        flat = np.flatnonzero(along)
        longest = max(s for k, s in enumerate(sizes) if k not in flat)
        wanted = [math.ceil(nodes * s / longest * (1 - 1e-9)) for s in sizes]
        return tuple(
            1 if k in flat else int(scipy.fft.next_fast_len(max(n, 4), real=True))
            for k, n in enumerate(wanted)
        )
    entries = checks.entries(shape, "shape", NetworkError, 3, expected="three numbers or one")
    for k, entry in enumerate(entries):
        checks.count(entry, f"shape[{k}]", NetworkError, 1 if along[k] else 4)
    return tuple(int(n) for n in entries)


def of_frame(
    frame: SampledFrame, core: float, *, sign: int
) -> tuple[Cell, TorsionModes, tuple[str, ...]]:
    """The torsion of a periodic coframe: its own distortion has it, exactly.

    Raises
    ------
    GridError
        The frame is not periodic, has holes, or lacks components.
    """
    if not all(frame.periodic):
        raise GridError(
            "stresses: expected a frame that is periodic along all axes, got one with open ends. "
            "Give NyeField.of_frame(frame).padded(nodes).balanced()."
        )
    values, inverse = checked_frame(frame)
    mean = np.linalg.inv(inverse)
    distortion = np.tensordot(inverse, values - mean[..., None, None, None], 1)
    cell = Cell(box_of(frame), values.shape[2:])
    return cell, TorsionModes(sign, mean, distortion=distortion, core=core), ()


def of_nye(
    source: NyeField, core: float, *, balance: bool, sign: int
) -> tuple[Cell, TorsionModes, tuple[str, ...]]:
    """The torsion of a Nye field, without lines that end.

    Raises
    ------
    GridError
        The field is not periodic, or a net b pierces the cell.
    """
    if not np.asarray(source.box.periodic).all():
        raise GridError(
            "stresses: expected a periodic Nye field, got one with open ends. Surround it with "
            "perfect crystal: source.padded(nodes)."
        )
    mean = source.values.mean(axis=(2, 3, 4))
    largest = float(np.abs(source.values).max())
    if np.abs(mean).max() > CALCULATED * largest:
        if not balance:
            raise GridError(
                "stresses: expected a Nye field whose mean is zero, got components up to "
                f"{np.abs(mean).max():.3g}. Give balance=True or source.balanced(), which spread "
                "the net b with opposite sign."
            )
        source = source.balanced()
    cell = Cell(source.box, source.shape)
    waves = cell.waves()
    modes, k = cell.modes(source.values, waves), cell.vectors(waves)
    k /= np.linalg.norm(k, axis=1)[:, None]
    weights = cell.weights(waves)
    ended = (weights[:, None] * np.abs((modes * k[:, None, :]).sum(axis=2)) ** 2).sum()
    every = (weights[:, None, None] * np.abs(modes) ** 2).sum()
    share = math.sqrt(ended / every) if every else 0.0
    texts = source.corrections
    if share > CALCULATED:
        text = (
            f"Lines that end, {share:.2g} of the Nye tensor, are closed through the crystal: only "
            "the part without divergence counts."
        )
        texts = (*texts, text)
    return cell, TorsionModes(sign, alpha=source.values, core=core), texts
