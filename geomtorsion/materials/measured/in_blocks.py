"""In blocks: a map of a sampled field, block by block in a folder, stopped and taken up again."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion import checks
from geomtorsion.errors import CheckpointError, GeomtorsionError, GridError
from geomtorsion.files import left_parts, read_json_text, read_text, write_text, written
from geomtorsion.loops.quadrature import PIECE
from geomtorsion.materials.blocks import array_on_disk, digest_of
from geomtorsion.materials.fields import BlockMap, blocked_map
from geomtorsion.materials.fields.blocks import Parts, estimated_sigma
from geomtorsion.materials.fields.sources import Source
from geomtorsion.materials.measured.fields import SampledField, layer_names
from geomtorsion.materials.measured.opening import is_array, open_measured
from geomtorsion.materials.measured.results import Survey, noise_level, summary

# What the folder of blocks is called, and what it says of the run that fills it.
BLOCKS, RUN = "blocks", "run.json"
# Nodes of a block where nobody says how many: some ten megabytes with its halo.
NODES = 8 * PIECE


@dataclass(frozen=True, eq=False)
class BlockedField:
    """A sampled field, in memory or larger, of which a map is made in blocks.

    given: values of shape (rows, columns, grid...), an array or the path of an .npy or Zarr array.
    starts, steps: coordinates of the first node and from one to the next. names: of the axes.
    sigma: noise of each component, shape (rows, columns along the grid); sigma_source: how it is
    known. digest: of the file.
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
    digest: str

    @property
    def about(self) -> tuple[str, ...]:
        """What it is."""
        shape = Source.of(self.given, None).shape
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
        source = Source.of(path, None)
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
            4 if order is None else order, (False,) * d, unit, unit, digest_of(path),
        )  # fmt: skip
    if steps is not None:
        raise GridError(f"steps: {path.name} says them itself. Leave them out.")
    field = open_measured(path, sigma=sigma, order=order)
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
        tuple(frame.periodic), frame.unit, frame.vector_unit, digest_of(path),
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class BlockedRun:
    """A map of a field in blocks, which are kept in a folder until all are done.

    folder: of the results; blocks stand in a folder of their own in it.
    """

    field: BlockedField
    folder: Path
    block: int
    size: int
    plane: tuple[int, int]

    @classmethod
    def begin(
        cls,
        field: BlockedField,
        folder: Path,
        block: int | None,
        size: int,
        plane: tuple[int, int],
        *,
        resume: bool,
        overwrite: bool,
    ) -> BlockedRun:
        """A new run, or one that was stopped.

        Raises
        ------
        CheckpointError
            The folder holds a run that was stopped and nobody said what to do with it; or none, or
            another one, to go on with.
        """
        kept = folder / BLOCKS / RUN
        if overwrite:
            _clear(folder)
        said: dict[str, Any] = {}
        if kept.is_file():
            if not resume:
                raise CheckpointError(
                    f"{folder} holds a map that was stopped. Give --resume to go on with it, or "
                    "--overwrite to begin anew."
                )
            found = read_json_text(read_text(kept), str(kept))
            said = found if isinstance(found, dict) else {}
        elif resume:
            raise CheckpointError(
                f"{folder} holds no map that was stopped. Leave out --resume to begin one."
            )
        if block is None:
            given = said.get("block")
            block = given if isinstance(given, int) else field.block
        run = cls(field, folder, block, size, plane)
        if said and said != run.described:
            differ = [key for key, value in run.described.items() if said.get(key) != value]
            raise CheckpointError(
                f"{folder} holds a map of another run: {', '.join(differ)} differ. Give the same "
                "file and options, or --overwrite to begin anew."
            )
        with written(kept.parent, is_folder=True):
            write_text(kept, json.dumps(run.described))
        return run

    @property
    def described(self) -> dict[str, Any]:
        """What a run must have in common with the one that it takes up."""
        return {
            "file": self.field.digest,
            "block": self.block,
            "size": self.size,
            "plane": list(self.plane),
            "sigma": self.field.sigma.tolist(),
            "order": self.field.order,
            "steps": list(self.field.steps),
        }

    def compute(self, workers: int = 1) -> BlockMap:
        """All blocks that are missing."""
        field = self.field
        try:
            return blocked_map(
                field.given, self.folder / BLOCKS, field.steps, self.block, self.size, self.plane,
                field.order, periodic=field.periodic, sigma=field.sigma, workers=workers,
            )  # fmt: skip
        except GeomtorsionError:
            # What cannot be done at all leaves nothing to go on with.
            if not any((self.folder / BLOCKS).glob("block-*.npy")):
                _clear(self.folder)
            raise

    def finish(
        self, made: BlockMap, report: Callable[[BlockedSurvey], Any] = lambda found: found
    ) -> Any:
        """Write the map as one array, map.npy, report it, and remove the blocks.

        report: writes what else belongs to the map. Until it has returned the blocks stay, so that
        a run that is stopped can be resumed. Returned is what it returns: without it the survey.
        """
        path = self.folder / "map.npy"
        with array_on_disk(path, (2 * made.source.shape[0] + 1, *made.places)) as whole:
            for number, values in made:
                whole[(slice(None), *(slice(*ends) for ends in made.span(number)))] = values
        found = report(BlockedSurvey(self.field, path, self.size, self.plane))
        _clear(self.folder)
        return found


def _clear(folder: Path) -> None:
    """Remove blocks, and nothing else."""
    inner = folder / BLOCKS
    for pattern in ("block-*.npy", ".*.part*", "ledger*", RUN):
        for path in inner.glob(pattern):
            path.unlink()
    for path in left_parts(folder / "map.npy"):
        path.unlink()
    if inner.is_dir() and not any(inner.iterdir()):
        inner.rmdir()


@dataclass(frozen=True, eq=False)
class BlockedSurvey:
    """A finished map on disk: `Parts` of every circuit, shape (2 * rows + 1, places...)."""

    field: BlockedField
    path: Path
    size: int
    plane: tuple[int, int]

    @cached_property
    def values(self) -> np.ndarray:
        """The array, of which parts are read."""
        return np.load(self.path, mmap_mode="r", allow_pickle=False)

    @property
    def area(self) -> float:
        """Of one circuit."""
        one, two = (abs(self.field.steps[k]) for k in self.plane)
        return one * two * self.size**2

    def survey(self, drawn: int = 1000) -> tuple[Survey, dict[str, Any]]:
        """A thinned survey for a picture, of the layer of the largest b, and a summary of all,
        whose median and floor are those of the thinned survey.

        drawn: places along an axis at most; pictures have no more pixels.
        """
        field, values = self.field, self.values
        rows = len(values) // 2
        others = [k for k in range(len(field.names)) if k not in self.plane]
        counts, best = np.zeros(2, dtype=np.int64), (-1.0, (0,) * (values.ndim - 1))
        # Slab by slab along the first axis: never all at once.
        for k in range(values.shape[1]):
            parts = Parts.of(values[:, k])
            sizes = np.linalg.norm(parts.vectors, axis=0)
            known = np.isfinite(sizes)
            far = parts.significance > noise_level(rows)
            counts += (int(known.sum()), int((far & known).sum()))
            if known.any():
                place = np.unravel_index(int(np.nanargmax(sizes)), sizes.shape)
                if sizes[place] > best[0]:
                    best = float(sizes[place]), (k, *map(int, place))
        at = best[1]
        cut: list[Any] = [at[k] for k in range(len(at))]
        every = [-(-values.shape[k + 1] // drawn) for k in self.plane]
        for k, step in zip(self.plane, every, strict=True):
            cut[k] = slice(None, None, step)
        part = np.asarray(values[(slice(None), *cut)])
        if self.plane[0] > self.plane[1]:
            part = part.swapaxes(1, 2)
        part = part[..., None]
        half = self.size / 2
        first, second = (
            field.starts[k] + field.steps[k] * (half + step * np.arange(n))
            for k, step, n in zip(self.plane, every, part.shape[1:3], strict=True)
        )
        parts = Parts.of(part)
        vectors = parts.vectors
        flat = set(self.plane) == {0, 1} and rows > 1
        layer = layer_names([field.names[k] for k in others],
                            [field.starts[k] + field.steps[k] * at[k] for k in others])  # fmt: skip
        survey = Survey(
            size=(self.size, self.size),
            centres=(first, second),
            names=(field.names[self.plane[0]], field.names[self.plane[1]]),
            layers=(layer,),
            vectors=vectors,
            components=tuple(f"b{k}" for k in range(rows)),
            arrows=vectors[list(self.plane)] if flat else None,
            sigma=np.linalg.norm(parts.sigmas, axis=0),
            grid_error=parts.interpolation,
            significance=parts.significance,
            area=self.area,
            unit=field.unit,
            vector_unit=field.vector_unit,
            missing="touch a hole",
        )
        found = summary(survey) | {
            "circuits": int(np.prod(values.shape[1:])),
            "known": int(counts[0]),
            "significant": int(counts[1]),
        }
        if counts[0]:
            place = [field.starts[k] + field.steps[k] * (at[k] + half) for k in self.plane]
            found |= {"largest": best[0] / self.area, "place": place, "layer": layer}
        return survey, found
