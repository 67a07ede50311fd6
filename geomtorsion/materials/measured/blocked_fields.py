"""Blocked fields: maps of sampled fields larger than memory, which a later run can resume."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion import checks
from geomtorsion.errors import GridError
from geomtorsion.files import check_resumption
from geomtorsion.loops.quadrature import PIECE
from geomtorsion.materials.burgers import noise_level
from geomtorsion.materials.fields import BlockMap, blocked_map
from geomtorsion.materials.fields.blocked_map import Parts, run_in
from geomtorsion.materials.fields.large_arrays import LargeArray, estimated_sigma, opened
from geomtorsion.materials.measured.fields import SampledField, layer_names
from geomtorsion.materials.measured.results import Survey, summary
from geomtorsion.materials.readers import is_array, open_source

# Nodes of a block where nobody says how many: some ten megabytes with its halo.
NODES = 8 * PIECE


@dataclass(frozen=True, eq=False)
class BlockedField:
    """A sampled field, in memory or larger, of which a map is made in blocks.

    given: values of shape (rows, columns, grid...), an array or the path of an .npy or Zarr array.
    starts, steps: coordinates of the first node and from one to the next. names: of the axes.
    sigma: noise of each component, shape (rows, columns along the grid); sigma_source: how it is
    known.
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
    def about(self) -> tuple[str, ...]:
        """What it is."""
        shape = LargeArray.of(self.given).shape
        sizes = " x ".join(map(str, shape[2:]))
        levels = " to ".join(dict.fromkeys(f"{f(self.sigma):.3g}" for f in (np.min, np.max)))
        return (
            f"a field of {sizes} nodes, {shape[0]} rows, in blocks",
            f"noise: {levels} ({self.sigma_source})",
        )

    @property
    def block(self) -> int:
        """Places along the side of a block, where nobody says how many."""
        return round(NODES ** (1 / len(self.names)))


def open_in_blocks(
    path: Path,
    *,
    steps: Sequence[float] | None = None,
    unit: str = "",
    sigma: float | str | None = None,
    order: int | None = None,
) -> BlockedField:
    """The field in an .npy or Zarr array, or in any file of a sampled frame.

    steps, unit: of the axes, of arrays, which do not say them.

    Raises
    ------
    FileFormatError
        The file is missing or damaged.
    GridError
        It is no grid, or its noise is not the same everywhere.
    """
    if is_array(path):
        source = LargeArray.of(path)
        d = len(source.shape) - 2
        spacing = (1.0,) * d if steps is None else checks.numbers(steps, d, "steps", GridError)
        if sigma is None or isinstance(sigma, str):
            checks.choice(sigma or "estimate", ["estimate"], "sigma", GridError)
            noise = estimated_sigma(source)
            said = "the median of sixth differences along the axes, in a sample of the field"
        else:
            value = checks.number(sigma, "sigma", GridError)
            noise, said = np.full((source.shape[0], d), value), "given"
        return BlockedField(
            str(path), (0.0,) * d, tuple(map(float, spacing)), tuple("xyzuvw"[:d]), noise, said,
            4 if order is None else order, (False,) * d, unit, unit,
        )  # fmt: skip
    if steps is not None:
        raise GridError(f"steps: {path.name} says them itself. Leave them out.")
    field = open_source(path, sigma=sigma, order=order)
    if not isinstance(field, SampledField):
        raise GridError(
            f"blocks: they belong to sampled frames, but {path.name} is something else, of which a "
            "map is made at once. Leave out blocks and resume."
        )
    frame = field.frame
    if frame.displacement is not None:
        raise GridError(
            f"blocks: expected a coframe or a distortion, got a displacement in {path.name}, whose "
            "circuits are sums of its jumps. Leave out --blocks."
        )
    noise = np.zeros((frame.rows, frame.dimension))
    if frame.sigma is not None:
        wide = np.broadcast_to(frame.sigma, frame.coframe[:, : frame.dimension].shape)
        known = wide[:, :, ~np.asarray(frame.mask)]
        low, noise = known.min(axis=-1), known.max(axis=-1)
        if (low < noise).any():
            raise GridError(
                "sigma: of a field in blocks the noise must be the same everywhere, but that of "
                f"the file is {low.min():.3g} to {noise.max():.3g}. Give one number."
            )
    if frame.covariance is not None:
        raise GridError(
            "covariance: expected independent noise for a map in blocks, got a covariance in the "
            "file. Give --sigma, or leave out --blocks."
        )
    # Blocks are listed as coordinates increase; circuits run so anyway.
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
    """Compute the map of a field in the Zarr array at a path, or the blocks that it lacks.

    block: places along the side of a block; None: as in the run that is resumed, or some ten
    megabytes. A complete map is replaced unless it is resumed.

    Raises
    ------
    CheckpointError
        The path holds a run that was stopped, and neither resume nor overwrite is set; or it holds
        no run to resume, or another one.
    """
    there = run_in(path)
    begun = there is not None
    if begun and not resume:
        done = sum(1 for file in path.joinpath("c").rglob("*") if file.is_file())
        begun = 0 < done < opened(str(path), again=True).nchunks
    check_resumption(path, "map", begun=begun, resume=resume, overwrite=overwrite)
    kept = there.get("block", field.block) if resume and there else field.block
    result = blocked_map(
        field.given, path, field.steps, kept if block is None else block, size, plane,
        field.order, periodic=field.periodic, sigma=field.sigma, overwrite=not resume,
    )  # fmt: skip
    return BlockedSurvey(field, result)


@dataclass(frozen=True, eq=False)
class BlockedSurvey:
    """A finished map on disk, and the field of which it is."""

    field: BlockedField
    result: BlockMap

    @property
    def area(self) -> float:
        """Of one circuit."""
        one, two = (abs(self.field.steps[k]) for k in self.result.plane)
        return one * two * self.result.size[0] ** 2

    def survey(self, drawn: int = 1000) -> tuple[Survey, dict[str, Any]]:
        """A thinned survey for a picture, of the layer of the largest b, and a summary of all,
        whose median and floor are those of the thinned survey.

        drawn: places along an axis at most; pictures have no more pixels.
        """
        field, plane, places = self.field, self.result.plane, self.result.places
        side = self.result.size[0]
        rows = self.result.source.shape[0]
        others = [k for k in range(len(field.names)) if k not in plane]
        counts = np.zeros(2, dtype=np.int64)
        # Of equally large b that of the first place, whatever the blocks.
        best = (-1.0, [0] * len(field.names))
        for number, parts in self.result:
            sizes = np.linalg.norm(parts.vectors, axis=0)
            known = np.isfinite(sizes)
            far = parts.significance > noise_level(rows)
            counts += (int(known.sum()), int((far & known).sum()))
            if known.any():
                place = np.unravel_index(int(np.nanargmax(sizes)), sizes.shape)
                first = [begin for begin, _ in self.result.span(number)]
                there = [-int(k + n) for k, n in zip(first, place, strict=True)]
                best = max(best, (float(sizes[place]), there))
        at = [-k for k in best[1]]
        cut: list[Any] = list(at)
        every = [-(-places[k] // drawn) for k in plane]
        for k, step in zip(plane, every, strict=True):
            cut[k] = slice(None, None, step)
        part = self.result.part((slice(None), *cut))
        if plane[0] > plane[1]:
            part = part.swapaxes(1, 2)
        part = part[..., None]
        half = side / 2
        first, second = (
            field.starts[k] + field.steps[k] * (half + step * np.arange(n))
            for k, step, n in zip(plane, every, part.shape[1:3], strict=True)
        )
        parts = Parts.of(part)
        vectors = parts.vectors
        flat = set(plane) == {0, 1} and rows > 1
        layer = layer_names([field.names[k] for k in others],
                            [field.starts[k] + field.steps[k] * at[k] for k in others])  # fmt: skip
        survey = Survey(
            size=(side, side),
            centres=(first, second),
            names=(field.names[plane[0]], field.names[plane[1]]),
            layers=(layer,),
            vectors=vectors,
            components=tuple(f"b{k}" for k in range(rows)),
            arrows=vectors[list(plane)] if flat else None,
            sigma=np.linalg.norm(parts.sigmas, axis=0),
            grid_error=parts.interpolation,
            significance=parts.significance,
            area=self.area,
            unit=field.unit,
            vector_unit=field.vector_unit,
            missing="touch a hole",
        )
        found = summary(survey) | {
            "circuits": int(np.prod(places)),
            "known": int(counts[0]),
            "significant": int(counts[1]),
        }
        if counts[0]:
            place = [field.starts[k] + field.steps[k] * (at[k] + half) for k in plane]
            found |= {"largest": best[0] / self.area, "place": place, "layer": layer}
        return survey, found
