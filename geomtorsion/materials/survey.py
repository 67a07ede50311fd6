"""Survey: Burgers vectors of circuits of one size at all positions of a source, with errors."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path
from typing import ClassVar

import numpy as np

from geomtorsion.materials.burgers import (
    Covariance,
    Json,
    Numbers,
    counted_significances,
    noise_level,
    numbered,
    significances,
)
from geomtorsion.materials.detours import Passages
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import Plot, figure_by
from geomtorsion.support.files import written
from geomtorsion.support.npz import write_npz
from geomtorsion.support.outgoing import csv_cell, one_line


@dataclass(frozen=True, eq=False)
class Errors:
    """Errors of many Burgers vectors; each field broadcasts to the positions of the circuits.

    covariance: of the components, from noise. systematic: bound on the largest component of the
    sum of all other errors. chance: probability that noise changed the whole numbers of b; None
    where b is measured, not counted.
    """

    covariance: Covariance
    systematic: np.ndarray
    chance: np.ndarray | None = None


@dataclass(frozen=True, eq=False, repr=False)
class Survey:
    """Burgers vectors of circuits of one size at all positions.

    Errors are computed at first use.

    vectors: b^i, shape (rows, places...), NaN where a circuit has none. On a grid, the places have
        one axis for each axis of the source, in the order of `names`; circuits turn from the first
        axis of the plane to the second, in the direction of increasing coordinates.
    centres: coordinates of the middles of the circuits, one array for each axis of the source, each
        broadcasting to the places.
    area: of each circuit, positive, in the square of `unit`.
    size: cells along both sides; for scattered points, the number of rings of triangles.
    estimate: computes the errors. names: of the axes. plane: of the circuits. components: names of
        the components of b. unit: of lengths. vector_unit: of b.
    missing: reason why circuits have no b, in words. down: whether figures show y downwards.
    whole: b in lattice vectors where it is counted, shape (k, places...); empty otherwise.
    passages: how often each circuit goes around missing nodes, see `Burgers.detour`, shape
        (places...); None where no node is missing. `area` is then the area of the circuits with
        their detours, and the errors include the detours. The noise of a detour is an upper bound:
        the noise of the whole ring around the missing nodes.
    directed: computes b along the axes of the source where `vectors` refers to other axes.
    sides: cells along the sides of each square, where larger squares around missing nodes replace
        squares without b, shape (places...); None if all have the same size. Areas and errors
        belong to the larger squares, and `centres` to the requested ones.
    """

    vectors: np.ndarray
    centres: tuple[np.ndarray, ...]
    area: Numbers
    size: tuple[int, ...]
    estimate: Callable[[], Errors]
    names: tuple[str, ...]
    plane: tuple[int, int] = (0, 1)
    components: tuple[str, ...] = ()
    unit: str = ""
    vector_unit: str = ""
    missing: str = "touch a hole"
    down: bool = False
    whole: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    directed: Callable[[], np.ndarray] | None = None
    passages: np.ndarray | None = None
    sides: np.ndarray | None = None

    def __post_init__(self) -> None:
        """Number components without names."""
        if not self.components:
            object.__setattr__(self, "components", numbered(len(self.vectors)))

    # -- b ----------------------------------------------------------------------------------------

    @cached_property
    def known(self) -> np.ndarray:
        """Where a circuit has a Burgers vector, shape (places...)."""
        return np.asarray(np.isfinite(self.vectors).all(axis=0))

    @property
    def detoured(self) -> np.ndarray:
        """Where a circuit has a Burgers vector and goes around missing nodes, shape (places...)."""
        return self.known & (False if self.passages is None else self.passages > 0)

    @property
    def widened(self) -> np.ndarray:
        """Where a larger square replaces the requested one, shape (places...)."""
        wide = False if self.sides is None else self.sides > self.size[0]
        return np.broadcast_to(wide, self.known.shape)

    @property
    def magnitude(self) -> np.ndarray:
        """|b|, shape (places...)."""
        return np.linalg.norm(self.vectors, axis=0)

    @property
    def density(self) -> np.ndarray:
        """b^i per area: the torsion 2 S_ab^i averaged over each circuit, (rows, places...)."""
        return self.vectors / self.area

    @property
    def per_area(self) -> np.ndarray:
        """|b| per area, shape (places...)."""
        return self.magnitude / self.area

    def gnd_density(self, burgers: float) -> np.ndarray:
        """Density of geometrically necessary dislocations of a Burgers vector: |b| / (area b)."""
        return self.per_area / burgers

    @cached_property
    def arrows(self) -> np.ndarray | None:
        """b along both axes of the plane, (2, places...); None if b has no such components."""
        parts = self.vectors if self.directed is None else self.directed()
        return parts[list(self.plane)] if len(parts) > max(self.plane) else None

    @property
    def density_unit(self) -> str:
        """The unit of `density`."""
        if not self.unit:
            return self.vector_unit
        if self.unit == self.vector_unit:
            return f"1/{self.unit}"
        return f"{self.vector_unit}/{self.unit}^2"

    # -- errors -----------------------------------------------------------------------------------

    @cached_property
    def estimated(self) -> Errors:
        """Covariance from noise, systematic errors, and chances of wrong whole numbers."""
        return self.estimate()

    @cached_property
    def sigmas(self) -> np.ndarray:
        """Standard deviation of each component from noise, shape of the vectors."""
        sigmas = np.zeros(self.vectors.shape)
        for i, row in enumerate(sigmas):
            # Rounding may make a variance negative where noise cancels.
            row += np.sqrt(np.maximum(self.estimated.covariance.get((i, i), 0.0), 0.0))
        sigmas[:, ~self.known] = np.nan
        return sigmas

    @property
    def noise(self) -> np.ndarray:
        """Root mean square of |b| from noise, shape (places...)."""
        return np.linalg.norm(self.sigmas, axis=0)

    @property
    def systematic_error(self) -> np.ndarray:
        """Sum of all errors other than noise, for the largest component, shape (places...)."""
        return np.where(self.known, self.estimated.systematic, np.nan)

    @property
    def errors(self) -> np.ndarray:
        """Noise and systematic errors combined, as in `Burgers.error`, shape (places...)."""
        return np.hypot(self.noise, self.systematic_error)

    @property
    def floor(self) -> np.ndarray:
        """Noise floor of `per_area`: its root mean square from noise, shape (places...)."""
        return self.noise / self.area

    @cached_property
    def significance(self) -> np.ndarray:
        """|b| in units of its errors, as in `Burgers.significance`; NaN where b is not known."""
        if self.estimated.chance is not None:
            values = counted_significances(self.whole, self.estimated.chance, len(self.vectors))
        else:
            values = significances(
                self.vectors, self.estimated.covariance, self.estimated.systematic
            )
        return np.where(self.known, values, np.nan)

    @property
    def level(self) -> float:
        """The significance that pure noise exceeds in one circuit of a thousand."""
        return float(noise_level(len(self.vectors)))

    @property
    def significant(self) -> np.ndarray:
        """Whether |b| is larger than noise explains, shape (places...)."""
        with np.errstate(invalid="ignore"):
            return np.asarray(self.significance > self.level)

    # -- places -----------------------------------------------------------------------------------

    @property
    def places(self) -> np.ndarray:
        """Coordinates of the middles of all circuits, shape (d, places...)."""
        return np.array(np.broadcast_arrays(*self.centres))

    @property
    def on_grid(self) -> bool:
        """Whether the places form a grid, with one axis for each axis of the source."""
        return self.vectors.ndim - 1 == len(self.centres)

    @property
    def lines(self) -> tuple[np.ndarray, np.ndarray]:
        """Coordinates of the middles along both axes of the plane; off a grid, of each circuit."""
        one, two = (self.centres[k].ravel() for k in self.plane)
        return one, two

    @property
    def axes(self) -> tuple[str, str]:
        """Names of both axes of the plane."""
        return self.names[self.plane[0]], self.names[self.plane[1]]

    @cached_property
    def _others(self) -> list[int]:
        return [k for k in range(len(self.centres)) if k not in self.plane] if self.on_grid else []

    @cached_property
    def layers(self) -> tuple[str, ...]:
        """Position of each plane on the other axes, in words; one empty text without such axes."""
        names = [self.names[k] for k in self._others]
        lines = (self.centres[k].ravel().tolist() for k in self._others)
        return tuple(place_name(names, at) for at in product(*lines))

    def laid(self, values: np.ndarray) -> np.ndarray:
        """Values of the places by axes of the plane and by layer, (..., p, q, layers).

        Off a grid, p numbers the circuits, and the axes q and layers have length one.
        """
        if not self.on_grid:
            return values[..., None, None]
        order = [*self.plane, *self._others]
        ahead = values.ndim - len(order)
        turned = values.transpose(*range(ahead), *(ahead + k for k in order))
        return turned.reshape(*turned.shape[: ahead + 2], -1)

    @property
    def strongest_layer(self) -> int:
        """Number of the layer with the largest |b|."""
        sizes = np.where(self.known, self.magnitude, -1.0)
        return int(np.argmax(self.laid(sizes).max(axis=(0, 1))))

    @property
    def extent(self) -> str:
        """Size of the circuits, in words."""
        if self.on_grid:
            return f"{' x '.join(map(str, self.size))} cells"
        return f"{self.size[0]} rings of triangles" if self.size[0] else "one triangle"

    @property
    def replaced(self) -> str:
        """How many squares are replaced by larger ones, in words; empty without such squares."""
        count = int(self.widened.sum())
        if self.sides is None or not count:
            return ""
        least, most = (int(f(self.sides[self.widened])) for f in (np.min, np.max))
        sides = f"{least} x {least}" + (f" to {most} x {most}" if most > least else "")
        return f"{count:,} replaced by larger squares of {sides} cells around missing nodes"

    @property
    def _area_varies(self) -> bool:
        """Whether circuits on a grid have different areas, because of detours."""
        return self.on_grid and np.ndim(self.area) > 0

    # -- numbers and files ------------------------------------------------------------------------

    def summary(self) -> Json:
        """Summary of the survey as plain data; None for numbers that do not exist.

        circuits, known, detoured, widened, significant: numbers of circuits. median, largest: of
        |b| per area. floor: median of its noise floor. level: the significance that pure noise
        exceeds in one circuit of a thousand. place: coordinates of the largest |b| per area.
        """
        mask, area = self.known, np.broadcast_to(self.area, self.known.shape)
        summary: Json = {
            "size": list(self.size),
            "area": float(area[mask].mean() if mask.any() else area.mean()),
            "circuits": mask.size,
            "known": int(mask.sum()),
            "detoured": int(self.detoured.sum()),
            "widened": int(self.widened.sum()),
            "significant": int((self.significant & mask).sum()),
            "level": self.level,
            "unit": self.unit,
            "vector_unit": self.vector_unit,
            "density_unit": self.density_unit,
            "median": None,
            "largest": None,
            "floor": None,
            "place": None,
        }
        if mask.any():
            density = self.per_area
            laid = self.laid(np.where(mask, density, -1.0))
            p, q, layer = np.unravel_index(np.argmax(laid), laid.shape)
            one, two = self.lines
            summary |= {
                "median": float(np.median(density[mask])),
                "largest": float(laid[p, q, layer]),
                "floor": float(np.median(self.floor[mask])),
                "place": [float(one[p]), float(two[q if self.on_grid else p])],
                "layer": self.layers[layer],
            }
        return summary

    def write_table(self, path: Path) -> None:
        """Write a CSV line for each circuit with a b; numbers read back as the same doubles."""
        layered = self.layers != ("",)
        places = self.axes if self.on_grid else self.names
        header = [f"{name}_centre" for name in places] + ["layer"] * layered
        header += [*self.components, "b_per_area", "noise_floor", "grid_error", "significance"]
        header += ["area", "passages"] * (self.passages is not None)
        header += ["cells"] * (self.sides is not None)
        columns = [
            *self.vectors, self.per_area, self.floor, self.systematic_error / self.area,
            self.significance,
        ]  # fmt: skip
        if self.passages is not None:
            columns += [np.broadcast_to(self.area, self.known.shape), self.passages]
        if self.sides is not None:
            columns.append(self.sides)
        table = np.stack([self.laid(column) for column in columns], axis=-1)
        one, two = self.lines
        with written(path) as part, part.open("w", encoding="utf-8", newline="") as file:
            file.write(f"# unit: {one_line(self.unit)}\n")
            file.write(f"# vector_unit: {one_line(self.vector_unit)}\n")
            area = f"{self.area!r}" if np.ndim(self.area) == 0 else "by circuit"
            file.write(f"# area: {area}\n")
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(map(csv_cell, header))
            for p, q, layer in np.argwhere(self.laid(self.known)).tolist():
                at: Iterable[float] = (one[p], two[q])
                if not self.on_grid:
                    at = (line[p] for line in self.centres)
                writer.writerow(
                    [
                        *(repr(float(x)) for x in at),
                        *([csv_cell(self.layers[layer])] * layered),
                        *(repr(float(x)) for x in table[p, q, layer]),
                    ]
                )

    def write_arrays(self, path: Path) -> None:
        """Write all arrays as NPZ: axes of the plane first, then layers."""
        one, two = self.lines
        arrays: Json = {
            "vectors": self.laid(self.vectors),
            "density": self.laid(self.per_area),
            "noise_floor": self.laid(self.floor),
            "grid_error": self.laid(self.systematic_error),
            "significance": self.laid(self.significance),
            "known": self.laid(self.known),
            "area": self.laid(np.asarray(self.area)) if self._area_varies else self.area,
            "size": self.size,
            "names": list(self.axes),
            "layers": list(self.layers),
            "components": list(self.components),
            "unit": self.unit,
            "vector_unit": self.vector_unit,
            "first_centres": one,
            "second_centres": two,
        }
        if self.passages is not None:
            arrays["passages"] = self.laid(self.passages)
        if self.sides is not None:
            arrays["cells"] = self.laid(self.sides)
        if self.arrows is not None:
            arrays["in_plane"] = self.laid(self.arrows)
        with written(path) as part:
            write_npz(part, arrays)

    plot: ClassVar[Plot] = figure_by("measured", "draw_survey")

    def __repr__(self) -> str:
        where = "" if self.known.all() else f", {int((~self.known).sum())} {self.missing}"
        units = ""
        if self.unit or self.vector_unit:
            units = f", in {self.vector_unit}, lengths in {self.unit}"
        around = int(self.detoured.sum())
        where += f", {around} around missing nodes" if around else ""
        where += f", {self.replaced}" if self.replaced else ""
        count = " x ".join(map(str, self.known.shape))
        return f"Survey({count} circuits of {self.extent}{where}{units})"


def areas(cell: float, size: tuple[int, int], passages: Passages | None) -> Numbers:
    """Areas of circuits on a grid: one number, or an array if some go around missing nodes.

    cell: area of a cell. size: cells along both sides.
    """
    if passages is None or not passages.count.any():
        return cell * size[0] * size[1]
    whole = size[0] * size[1] + passages.change
    # A circuit that shrinks to nothing has no Burgers vector.
    return cell * np.where(passages.refused, size[0] * size[1], whole)


def middles(
    starts: Sequence[float], steps: Sequence[float], counts: Sequence[int], sides: Sequence[int]
) -> tuple[np.ndarray, ...]:
    """Coordinates of the middles of circuits on a grid, one open array for each axis.

    starts: coordinates of the first node. steps: from node to node. counts: number of places.
    sides: cells of a circuit along each axis.
    """
    every = zip(starts, steps, counts, sides, strict=True)
    lines = [start + step * (np.arange(n) + side / 2) for start, step, n, side in every]
    return tuple(np.meshgrid(*lines, indexing="ij", sparse=True))


def place_name(names: Sequence[str], values: Sequence[float]) -> str:
    """Position of a plane on the other axes, in words."""
    return ", ".join(f"{name} = {x:.6g}" for name, x in zip(names, values, strict=True))
