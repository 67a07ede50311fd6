"""Source: the interface of measured matter for commands, figures and pages."""

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
    """The background of a figure of circuits.

    centres: of the pixels along both axes, or of points, x and y of each. values: shape (p, q), or
    one for each point; NaN where nothing is known.
    kind: "grains", values are numbers of grains; "sizes", values from zero upwards; "image", grey
    values; or "points", sizes at points. title: name of the values. down: whether y points down.
    """

    centres: tuple[np.ndarray, np.ndarray]
    values: np.ndarray
    kind: Literal["grains", "sizes", "image", "points"]
    title: str
    down: bool = False


class Source(Protocol):
    """Interface of measured data with Burgers vectors: a grid, a map, phases, points.

    Each source decides how it follows a loop. A sampled frame integrates its interpolated coframe
    along the loop itself. An orientation map uses the steps around the cells whose middles the
    loop surrounds. Phases of an image and displacements use the nodes along the loop. Scattered
    points use the Delaunay edges next to the loop. `Burgers.path` is the resulting path.
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
        """Lines of text about the size and the noise of the source, and their origin."""
        ...

    def burgers(self, loop: Loop, /) -> Burgers:
        """Burgers vector of a loop in the coordinates of the source."""
        ...

    def burgers_map(self, size: int, /, plane: tuple[int, int] = (0, 1)) -> Survey:
        """Burgers vectors of all circuits of one size."""
        ...

    def backdrop(self, section: Section = PLANE) -> Backdrop:
        """The background of a figure of circuits in a section."""
        ...
