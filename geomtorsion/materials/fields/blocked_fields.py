"""Blocked fields: maps of sampled fields larger than memory, which a later run can resume."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion.errors import GridError
from geomtorsion.loops.quadrature import PIECE
from geomtorsion.materials.burgers import Json
from geomtorsion.materials.fields.blocked_map import BlockMap, Parts, blocked_map, run_in
from geomtorsion.materials.fields.large_arrays import LargeArray, estimated_sigma, opened
from geomtorsion.materials.fields.sampled import SampledFrame
from geomtorsion.materials.survey import Survey
from geomtorsion.support import checks
from geomtorsion.support.files import check_resumption

# Default number of nodes in a block: about ten megabytes with the halo.
NODES = 8 * PIECE


@dataclass(frozen=True, eq=False)
class BlockedField:
    """A sampled field, in memory or larger than memory, for maps in blocks.

    given: values of shape (rows, columns, grid...), an array or the path of an .npy or Zarr array.
    starts: coordinates of the first node. steps: from node to node. names: of the axes.
    sigma: noise of each component, shape (rows, columns along the grid). sigma_source: its origin.
    """

    given: Any
    starts: tuple[float, ...]
    steps: tuple[float, ...]
    names: tuple[str, ...]
    sigma: np.ndarray
    sigma_source: str
    order: int
    periodic: tuple[bool, ...]
    unit: str
    vector_unit: str

    @property
    def description(self) -> tuple[str, ...]:
        """Lines of text about the size and the noise of the field."""
        shape = LargeArray.of(self.given).shape
        sizes = " x ".join(map(str, shape[2:]))
        levels = " to ".join(dict.fromkeys(f"{f(self.sigma):.3g}" for f in (np.min, np.max)))
        return (
            f"a field of {sizes} nodes, {shape[0]} rows, in blocks",
            f"noise: {levels} ({self.sigma_source})",
        )

    @property
    def block(self) -> int:
        """Default number of places along the side of a block."""
        return round(NODES ** (1 / len(self.names)))


def array_in_blocks(
    path: Path,
    steps: Sequence[float] | None,
    unit: str,
    sigma: float | str | None,
    order: int | None,
) -> BlockedField:
    """Open the field in an .npy or Zarr array; see `readers.open_in_blocks`."""
    source = LargeArray.of(path)
    d = len(source.shape) - 2
    spacing = (1.0,) * d if steps is None else checks.numbers(steps, d, "steps", GridError)
    if sigma is None or isinstance(sigma, str):
        checks.choice(sigma or "estimate", ["estimate"], "sigma", GridError)
        noise = estimated_sigma(source)
        origin = "the median of sixth differences along the axes, in a sample of the field"
    else:
        value = checks.measured(checks.number(sigma, "sigma", GridError), "sigma", GridError)
        noise, origin = np.full((source.shape[0], d), value), "given"
    return BlockedField(
        str(path), (0.0,) * d, tuple(map(float, spacing)), tuple("xyzuvw"[:d]), noise, origin,
        4 if order is None else order, (False,) * d, unit, unit,
    )  # fmt: skip


def frame_in_blocks(frame: SampledFrame, name: str) -> BlockedField:
    """A sampled frame in memory; name: of its file, for messages.

    Raises
    ------
    GridError
        The frame is made from a displacement, or its noise is not the same everywhere.
    """
    if frame.displacement is not None:
        raise GridError(
            f"blocks: expected a coframe or a distortion in {name}, got a displacement, whose "
            "circuits are sums of its jumps. Omit --blocks."
        )
    noise = np.zeros((frame.rows, frame.dimension))
    if frame.sigma is not None:
        wide = np.broadcast_to(frame.sigma, frame.coframe[:, : frame.dimension].shape)
        sigmas = wide[:, :, ~np.asarray(frame.mask)]
        low, noise = sigmas.min(axis=-1), sigmas.max(axis=-1)
        if (low < noise).any():
            raise GridError(
                "sigma: expected the same noise at all nodes for a map in blocks, got "
                f"{low.min():.3g} to {noise.max():.3g} in {name}. Give one number."
            )
    if frame.covariance is not None:
        raise GridError(
            "covariance: expected independent noise for a map in blocks, got a covariance in the "
            "file. Give --sigma, or omit --blocks."
        )
    # Blocks are in the order of increasing coordinates, which is also the direction of circuits.
    starts = tuple(float(min(axis[0], axis[-1])) for axis in frame.axes)
    turned = tuple(slice(None, None, -1 if step < 0 else 1) for step in frame.steps)
    values = np.where(np.asarray(frame.mask), np.nan, frame.coframe)[(..., *turned)]
    steps = tuple(abs(float(x)) for x in frame.steps)
    return BlockedField(
        values, starts, steps, tuple(frame.names), noise, frame.sigma_source, frame.order,
        tuple(frame.periodic), frame.unit, frame.vector_unit,
    )  # fmt: skip


def map_in_blocks(
    field: BlockedField,
    path: Path,
    block: int | None,
    size: int,
    plane: tuple[int, int],
    *,
    resume: bool = False,
    overwrite: bool = False,
) -> BlockedSurvey:
    """Compute the map of a field into the Zarr array at a path, or resume a stopped run there.

    block: places along the side of a block. If None, it is taken from the resumed run, or gives
    blocks of about ten megabytes. A complete map is replaced unless it is resumed.

    Raises
    ------
    CheckpointError
        The path holds a stopped run, and neither resume nor overwrite is set; or the run to resume
        is missing or belongs to another map.
    """
    there = run_in(path)
    begun = there is not None
    if begun and not resume:
        done = sum(1 for file in path.joinpath("c").rglob("*") if file.is_file())
        begun = 0 < done < opened(str(path), again=True).nchunks
    check_resumption(path, "map", begun=begun, resume=resume, overwrite=overwrite)
    old_block = there.get("block", field.block) if resume and there else field.block
    result = blocked_map(
        field.given, path, field.steps, old_block if block is None else block, size, plane,
        field.order, periodic=field.periodic, sigma=field.sigma, overwrite=not resume,
    )  # fmt: skip
    return BlockedSurvey(field, result)


@dataclass(frozen=True, eq=False)
class BlockedSurvey:
    """A finished map on disk, and its field."""

    field: BlockedField
    result: BlockMap

    @property
    def area(self) -> float:
        """Area of one circuit."""
        one, two = (abs(self.field.steps[k]) for k in self.result.plane)
        return one * two * self.result.size[0] ** 2

    def survey(self, drawn: int = 1000) -> tuple[Survey, Json]:
        """A thinned survey of the layer with the largest b, for figures, and a summary of the map.

        The median and the noise floor in the summary come from the thinned survey.

        drawn: largest number of places along an axis, enough for the pixels of a figure.
        """
        field, plane, places = self.field, self.result.plane, self.result.places
        side = self.result.size[0]
        counts = np.zeros(2, dtype=np.int64)
        # Among equal b, choose the first place, so that the result does not depend on the blocks.
        best = (-1.0, [0] * len(field.names))
        for number, parts in self.result:
            span = self.result.span(number)
            whole = self._survey(parts, [np.arange(*ends) for ends in span])
            mask = whole.known
            counts += (int(mask.sum()), int((whole.significant & mask).sum()))
            if mask.any():
                sizes = whole.magnitude
                place = np.unravel_index(int(np.nanargmax(sizes)), sizes.shape)
                there = [-int(k + n) for (k, _), n in zip(span, place, strict=True)]
                best = max(best, (float(sizes[place]), there))
        at = [-k for k in best[1]]
        chosen = [np.array([k]) for k in at]
        for k in plane:
            chosen[k] = np.arange(0, places[k], -(-places[k] // drawn))
        cut = tuple(
            slice(line[0], line[-1] + 1, line[1] - line[0] if len(line) > 1 else 1)
            for line in chosen
        )
        survey = self._survey(Parts.of(self.result.part((slice(None), *cut))), chosen)
        summary = survey.summary() | {
            "circuits": int(np.prod(places)),
            "known": int(counts[0]),
            "significant": int(counts[1]),
        }
        if counts[0]:
            place = [field.starts[k] + field.steps[k] * (at[k] + side / 2) for k in plane]
            layer = survey.layers[0]
            summary |= {"largest": best[0] / self.area, "place": place, "layer": layer}
        return survey, summary

    def _survey(self, parts: Parts, places: Sequence[np.ndarray]) -> Survey:
        """The survey of selected places, given by their numbers along each axis."""
        field, plane, side = self.field, self.result.plane, self.result.size[0]
        lines = [
            start + step * (line + (side / 2 if k in plane else 0))
            for k, (start, step, line) in enumerate(
                zip(field.starts, field.steps, places, strict=True)
            )
        ]
        return Survey(
            parts.vectors,
            tuple(np.meshgrid(*lines, indexing="ij", sparse=True)),
            self.area,
            (side, side),
            partial(getattr, parts, "errors"),
            field.names,
            plane,
            unit=field.unit,
            vector_unit=field.vector_unit,
        )
