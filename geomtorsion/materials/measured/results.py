"""Results: closures of circuits, surveys, what they lie on; as tables, arrays and a few numbers."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from geomtorsion.files import written
from geomtorsion.loops import Loop
from geomtorsion.materials.burgers import noise_level
from geomtorsion.npz import write_npz
from geomtorsion.outgoing import csv_cell, one_line


@dataclass(frozen=True)
class Section:
    """A plane through what was measured: two axes, and where it lies on all others, in order."""

    plane: tuple[int, int] = (0, 1)
    at: tuple[float, ...] = ()


# The plane of what has no other.
PLANE = Section()


@dataclass(frozen=True, eq=False)
class Closure:
    """Burgers vector of one circuit.

    path: the circuit as it was taken, in the plane of its section, shape (2, k).
    vector: b^i, shape (rows,), in `vector_unit`; components: what its entries are called.
    noise: root mean square of |b| by noise alone. grid_error: of interpolation and quadrature.
    significance: |b| in units of its errors; noise alone gives sqrt(rows) or so.
    arrow: the part of b in that plane, shape (2,), or None.
    area: enclosed, signed, in the square of `unit`. more: name -> further facts, for JSON and text.
    """

    name: str
    path: np.ndarray
    vector: np.ndarray
    components: tuple[str, ...]
    noise: float
    grid_error: float
    significance: float
    area: float
    arrow: np.ndarray | None
    unit: str
    vector_unit: str
    more: Mapping[str, Any] = field(default_factory=dict)
    section: Section = PLANE

    @property
    def magnitude(self) -> float:
        """|b|, in `vector_unit`."""
        return float(np.linalg.norm(self.vector))

    @property
    def is_significant(self) -> bool:
        """Whether noise gives as much in less than one circuit of a thousand."""
        return bool(self.significance > noise_level(len(self.vector)))

    def to_json(self) -> dict[str, Any]:
        """All of it as plain data; an infinite significance (no noise) is None."""
        finite = np.isfinite(self.significance)
        return {
            "loop": self.name,
            "vector": self.vector.tolist(),
            "components": list(self.components),
            "magnitude": self.magnitude,
            "noise": self.noise,
            "grid_error": self.grid_error,
            "significance": self.significance if finite else None,
            "significant": self.is_significant,
            "area": self.area,
            "unit": self.unit,
            "vector_unit": self.vector_unit,
            **self.more,
        }


@dataclass(frozen=True, eq=False)
class Survey:
    """Burgers vectors of circuits of one size at every place.

    size: cells along both sides. centres: coordinates of the middles of the circuits, shapes (p,)
        and (q,). names: of the two axes. layers: where the planes lie, one text each.
    vectors: b^i, shape (rows, p, q, layers), NaN where nothing is known; components: their names.
    arrows: the part of b in the plane of the map, shape (2, p, q, layers), or None.
    sigma: root mean square of |b| by noise alone; grid_error: of interpolation; significance: |b|
        in units of its errors; shape (p, q, layers) each.
    area: of one circuit. unit, vector_unit: of lengths, and of b.
    missing: why circuits are missing, in words. down: whether pictures show y downwards.
    """

    size: tuple[int, int]
    centres: tuple[np.ndarray, np.ndarray]
    names: tuple[str, str]
    layers: tuple[str, ...]
    vectors: np.ndarray
    components: tuple[str, ...]
    arrows: np.ndarray | None
    sigma: np.ndarray
    grid_error: np.ndarray
    significance: np.ndarray
    area: float
    unit: str
    vector_unit: str
    missing: str
    down: bool = False

    @property
    def known(self) -> np.ndarray:
        """Where a circuit has a Burgers vector, shape (p, q, layers)."""
        return np.asarray(np.isfinite(self.vectors).all(axis=0))

    @property
    def density(self) -> np.ndarray:
        """|b| per area, shape (p, q, layers)."""
        return np.linalg.norm(self.vectors, axis=0) / self.area

    @property
    def floor(self) -> np.ndarray:
        """What noise alone makes of `density`, shape (p, q, layers)."""
        return self.sigma / self.area

    @property
    def level(self) -> float:
        """The significance that noise alone passes in one circuit of a thousand."""
        return float(noise_level(len(self.vectors)))

    @property
    def significant(self) -> np.ndarray:
        """Where |b| is more than noise explains, shape (p, q, layers)."""
        with np.errstate(invalid="ignore"):
            return np.asarray(self.significance > self.level)

    @property
    def density_unit(self) -> str:
        """The unit of `density`."""
        if not self.unit:
            return self.vector_unit
        return (
            f"1/{self.unit}"
            if self.unit == self.vector_unit
            else (f"{self.vector_unit}/{self.unit}^2")
        )

    @property
    def strongest_layer(self) -> int:
        """Number of the layer with the largest density."""
        found = np.where(self.known, self.density, -1.0).max(axis=(0, 1))
        return int(np.argmax(found))


@dataclass(frozen=True, eq=False)
class Backdrop:
    """What lies below circuits in a picture.

    centres: of the pixels along both axes. values: shape (p, q), NaN where nothing is known.
    kind: "grains", whose numbers the values are, "sizes" from zero on, or "image", grey values.
    title: what is shown.
    """

    centres: tuple[np.ndarray, np.ndarray]
    values: np.ndarray
    kind: str
    title: str


class Measured(Protocol):
    """A measured field, whatever it was measured by."""

    @property
    def names(self) -> tuple[str, ...]:
        """Of the axes."""
        ...

    @property
    def unit(self) -> str:
        """Of lengths."""
        ...

    @property
    def down(self) -> bool:
        """Whether pictures show y downwards."""
        ...

    @property
    def about(self) -> tuple[str, ...]:
        """What it is, in lines: its size, its noise and where that is known from."""
        ...

    def closure(self, loop: Loop) -> Closure:
        """Burgers vector of a circuit."""
        ...

    def survey(self, size: int, plane: tuple[int, int] = (0, 1)) -> Survey:
        """Burgers vectors of square circuits of so many cells at every place."""
        ...

    def backdrop(self, section: Section = PLANE) -> Backdrop:
        """What a picture shows below the circuits of a section."""
        ...


def summary(survey: Survey) -> dict[str, Any]:
    """A survey in a few numbers, as plain data; numbers that do not exist are None.

    circuits, known, significant: how many. median, largest: of |b| per area; floor: median of what
    noise alone makes of it; level: the significance that noise passes once in a thousand times.
    place: coordinates of the largest.
    """
    known, density = survey.known, survey.density
    found: dict[str, Any] = {
        "size": list(survey.size),
        "area": survey.area,
        "circuits": known.size,
        "known": int(known.sum()),
        "significant": int((survey.significant & known).sum()),
        "level": survey.level,
        "unit": survey.unit,
        "vector_unit": survey.vector_unit,
        "density_unit": survey.density_unit,
        "median": None,
        "largest": None,
        "floor": None,
        "place": None,
    }
    if known.any():
        p, q, layer = np.unravel_index(np.argmax(np.where(known, density, -1.0)), known.shape)
        found |= {
            "median": float(np.median(density[known])),
            "largest": float(density[p, q, layer]),
            "floor": float(np.median(survey.floor[known])),
            "place": [float(survey.centres[0][p]), float(survey.centres[1][q])],
            "layer": survey.layers[layer],
        }
    return found


def write_table(survey: Survey, path: Path) -> None:
    """One line for each circuit that is known, as CSV; numbers read back as the same doubles."""
    header = [f"{name}_centre" for name in survey.names]
    layered = survey.layers != ("",)
    header += ["layer"] * layered
    header += [*survey.components, "b_per_area", "noise_floor", "grid_error", "significance"]
    density, floor = survey.density, survey.floor
    with written(path) as part, part.open("w", encoding="utf-8", newline="") as file:
        file.write(f"# unit: {one_line(survey.unit)}\n")
        file.write(f"# vector_unit: {one_line(survey.vector_unit)}\n")
        file.write(f"# area: {survey.area!r}\n")
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(map(csv_cell, header))
        for p, q, layer in np.argwhere(survey.known).tolist():
            numbers = [
                *survey.vectors[:, p, q, layer],
                density[p, q, layer],
                floor[p, q, layer],
                survey.grid_error[p, q, layer] / survey.area,
                survey.significance[p, q, layer],
            ]
            writer.writerow(
                [
                    repr(float(survey.centres[0][p])),
                    repr(float(survey.centres[1][q])),
                    *([csv_cell(survey.layers[layer])] * layered),
                    *(repr(float(x)) for x in numbers),
                ]
            )


def write_arrays(survey: Survey, path: Path) -> None:
    """All arrays of a survey as NPZ: axes of places first, then layers."""
    arrays: dict[str, Any] = {
        "vectors": survey.vectors,
        "density": survey.density,
        "noise_floor": survey.floor,
        "grid_error": survey.grid_error,
        "significance": survey.significance,
        "known": survey.known,
        "area": survey.area,
        "size": survey.size,
        "names": list(survey.names),
        "layers": list(survey.layers),
        "components": list(survey.components),
        "unit": survey.unit,
        "vector_unit": survey.vector_unit,
    }
    if survey.arrows is not None:
        arrays["in_plane"] = survey.arrows
    arrays["first_centres"], arrays["second_centres"] = survey.centres
    with written(path) as part:
        write_npz(part, arrays)
