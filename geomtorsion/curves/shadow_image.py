"""Shadow image: what a camera sees of a shadow: its edge, and the end of the ray of each pixel."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from geomtorsion.curves.problem import CurveProblem
from geomtorsion.errors import StartError
from geomtorsion.geometry.domain_edges import is_angle
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.csv_table import write_csv
from geomtorsion.support.displays import Plot, drawn_by, figure_by
from geomtorsion.support.outgoing import size_text


class Fate(IntEnum):
    """How a ray ends; undecided: it does not end, or its end depends on its error."""

    undecided = -1
    sky = 0
    dark = 1


@dataclass(frozen=True, eq=False)
class ShadowEdge:
    """Edge of a shadow around the axis of the camera.

    angles: directions in the image, in radians from the right upwards, shape (m,).
    radii: angle between the axis and the edge, in radians, shape (m,).
    errors: half width of the bracket of each, in radians, shape (m,).
    """

    angles: np.ndarray
    radii: np.ndarray
    errors: np.ndarray

    @property
    def error(self) -> float:
        """The largest error, in radians."""
        return float(self.errors.max())

    @property
    def points(self) -> np.ndarray:
        """The edge in the image plane: tangents to the right and upwards, shape (m, 2)."""
        size = np.tan(self.radii)
        return np.stack((size * np.cos(self.angles), size * np.sin(self.angles)), axis=-1)

    def to_csv(self, path: str | Path) -> None:
        """Write angles, radii and errors as a table, every digit kept."""
        columns = {"angle": self.angles, "radius": self.radii, "error": self.errors}
        write_csv(checks.file_name(path), columns)

    def to_json(self) -> dict[str, Any]:
        """Angles, radii and errors as plain data."""
        return {
            "angles": self.angles.tolist(),
            "radii": self.radii.tolist(),
            "errors": self.errors.tolist(),
        }

    def __repr__(self) -> str:
        low, high = float(self.radii.min()), float(self.radii.max())
        count = len(self.angles)
        return (
            f"edge of a shadow in {count} direction{'s' * (count > 1)}: {low:.8g} to {high:.8g} "
            f"rad from the axis, error below {size_text(self.error)}"
        )

    _repr_html_ = drawn_by("shadow", "shadow_html")
    plot: ClassVar[Plot] = figure_by("shadow", "draw_shadow")


@dataclass(frozen=True, eq=False)
class ShadowImage:
    """Image that a camera takes of a shadow; rows from the top, columns from the left.

    rays: the equations of the rays, with the camera as start. time: which leg is timelike.
    field: width of the image as an angle, in radians. accuracy: requested for each ray.
    fate: 1 where a ray is captured, 0 where it leads to the sky, -1 where it does not end, or its
        end depends on its error; shape (n, n).
    stopped_by: the condition at the end of each ray, as text, shape (n, n).
    coordinates, frame_velocity: q^mu and u^i at the end of each ray, shapes (n, n, 4).
    errors: largest relative error of each ray, shape (n, n).
    """

    rays: CurveProblem
    time: int
    field: float
    accuracy: float
    fate: np.ndarray
    stopped_by: np.ndarray
    coordinates: np.ndarray
    frame_velocity: np.ndarray
    errors: np.ndarray

    @property
    def dark(self) -> np.ndarray:
        """Pixels whose ray is captured, shape (n, n)."""
        return self.fate == Fate.dark

    @property
    def undecided(self) -> np.ndarray:
        """Pixels whose ray has no certain end, shape (n, n)."""
        return self.fate == Fate.undecided

    @cached_property
    def redshift(self) -> np.ndarray:
        """1 + z of light emitted at rest in the legs at the end of each ray, shape (n, n)."""
        return np.abs(self.frame_velocity[..., self.time])

    @property
    def half_turns(self) -> np.ndarray:
        """Complete half turns of each ray in the first angle of the frame, shape (n, n)."""
        return np.abs(self.turns) // 1

    @cached_property
    def turns(self) -> np.ndarray:
        """Change of the first angle of the frame along each ray, in half turns, shape (n, n).

        Near a horizon the angle of a captured ray may grow without bound.

        Raises
        ------
        StartError
            no coordinate of the frame is an angle over whose full turn it repeats itself.
        """
        frame = self.rays.frame
        places = [k for k, x in enumerate(frame.coordinates) if is_angle(frame, x)]
        if not places:
            raise StartError(
                "turns: expected a coordinate that is an angle, got none. Give the frame a "
                "domain such as phi > 0, phi < 2*pi."
            )
        start = self.rays.start
        assert start is not None
        return (self.coordinates[..., places[0]] - float(start[places[0]])) / np.pi

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        """The fate of each pixel."""
        return self.fate.astype(dtype)

    def __repr__(self) -> str:
        n = len(self.fate)
        unknown = int(self.undecided.sum())
        more = f", {unknown} undecided" if unknown else ""
        return (
            f"image of a shadow, {n} x {n} pixels, {self.field:.4g} rad wide: "
            f"{int(self.dark.sum())} dark{more}"
        )

    _repr_html_ = drawn_by("shadow", "shadow_html")
    plot: ClassVar[Plot] = figure_by("shadow", "draw_shadow")
