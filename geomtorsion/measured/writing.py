"""Writing: surveys as tables and arrays, and what they say in a few numbers."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np

from geomtorsion.measured.results import Survey


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
    with path.open("w", encoding="utf-8", newline="") as file:
        file.write(f"# unit: {survey.unit}\n# vector_unit: {survey.vector_unit}\n")
        file.write(f"# area: {survey.area!r}\n")
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
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
                    *([survey.layers[layer]] * layered),
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
    with path.open("wb") as stream:
        np.savez_compressed(stream, **arrays)
