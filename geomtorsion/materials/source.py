"""Source: what commands, pictures and pages ask of any measured matter."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from geomtorsion.loops import Loop
from geomtorsion.materials.burgers import PLANE, Burgers, Section
from geomtorsion.materials.survey import Survey


@dataclass(frozen=True, eq=False)
class Backdrop:
    """What a picture shows below circuits.

    centres: of the pixels along both axes, or of points, x and y of each. values: shape (p, q), or
    one for each point; NaN where nothing is known.
    kind: "grains", whose numbers the values are; "sizes" from zero on; "image", grey values; or
    "points", sizes at points. title: what is shown. down: whether y is shown downwards.
    """

    centres: tuple[np.ndarray, np.ndarray]
    values: np.ndarray
    kind: Literal["grains", "sizes", "image", "points"]
    title: str
    down: bool = False


class Source(Protocol):
    """Measured matter that has Burgers vectors: a grid, an orientation map, phases, points.

    Each source decides how it follows a loop. A sampled frame integrates its interpolated coframe
    along the loop itself; an orientation map takes the steps around the cells whose middles the
    loop surrounds; phases of an image and displacements take the nodes along it; scattered points
    take Delaunay's edges beside it. `Burgers.path` is the circuit as it was taken.
    """

    @property
    def names(self) -> Sequence[str]:
        """Names of the axes."""
        ...

    @property
    def unit(self) -> str:
        """Unit of lengths."""
        ...

    @property
    def description(self) -> tuple[str, ...]:
        """Lines about its size, its noise and the origin of both."""
        ...

    def burgers(self, loop: Loop, /) -> Burgers:
        """Burgers vector of a loop in the coordinates of the source."""
        ...

    def burgers_map(self, size: int, /, plane: tuple[int, int] = (0, 1)) -> Survey:
        """Burgers vectors of all circuits of one size."""
        ...

    def backdrop(self, section: Section = PLANE) -> Backdrop:
        """What a picture shows below circuits in a section."""
        ...
