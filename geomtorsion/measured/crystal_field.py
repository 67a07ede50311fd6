"""Crystal field: an orientation map as a measured field."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from geomtorsion.errors import OrientationError
from geomtorsion.loops import Loop
from geomtorsion.measured.results import PLANE, Backdrop, Closure, Section, Survey
from geomtorsion.orientations import Circuit, OrientationMap, slip_families

COMPONENTS = ("b1", "b2", "b3")


@dataclass(frozen=True, eq=False)
class CrystalField:
    """Crystal orientations on a plane of pixels; see `Measured`.

    Components of b are those in crystal axes; `more` and the arrows have the specimen axes.
    """

    map: OrientationMap
    # The structure whose slip systems make up b, if that is asked for.
    slip: str = ""
    # As instruments show them.
    down: bool = True

    @property
    def names(self) -> tuple[str, ...]:
        """Of the axes."""
        return ("x", "y")

    @property
    def unit(self) -> str:
        """Of lengths."""
        return self.map.unit

    @property
    def about(self) -> tuple[str, ...]:
        """What it is, its grains, and its noise."""
        grains = self.map.grains.count
        origin = "estimated from sixth differences" if self.map.sigma is None else "given"
        return (
            repr(self.map),
            (
                f"{grains} grain{'s' * (grains != 1)} at {self.map.threshold:g} degrees, "
                f"{float((self.map.phase == 0).mean()):.1%} of the pixels not indexed"
            ),
            f"noise: {self._degrees()} ({origin})",
        )

    def _degrees(self) -> str:
        """Noise about one axis, in the mean over the three, of each phase."""
        texts = []
        for number, covariance in self.map.noise.items():
            degrees = np.degrees(np.sqrt(np.trace(covariance) / 3))
            texts.append(f"{degrees:.3g} degrees in {self.map.phases[number].name}")
        return ", ".join(texts)

    def closure(self, loop: Loop | Circuit) -> Closure:
        """Burgers vector of the circuit from pixel to pixel round the cells of a loop."""
        circuit = loop if isinstance(loop, Circuit) else self.map.circuit(loop)
        b = self.map.burgers(circuit)
        more: dict[str, Any] = {
            "specimen": b.specimen.tolist(),
            "grain": b.grain,
            "phase": b.phase.name,
            "steps": len(circuit.starts),
        }
        if b.phase.has_lattice:
            more["lattice"] = b.lattice.tolist()
        if self.slip:
            more["slip"] = [
                {
                    "family": one.family.name,
                    "edge": float(np.abs(one.edge).sum()),
                    "screw": float(np.abs(one.screw).sum()),
                }
                for one in b.slip(*slip_families(b.phase, self.slip))
            ]
        ends = np.stack([self._places(circuit.starts), self._places(circuit.ends)], axis=-1)
        gaps = np.full((2, len(circuit.starts), 1), np.nan)
        return Closure(
            name=loop.name or "loop",
            path=np.concatenate([ends, gaps], axis=-1).reshape(2, -1),
            vector=b.vector,
            components=COMPONENTS,
            noise=b.sigma,
            grid_error=b.interpolation_error,
            significance=b.significance,
            area=b.area,
            arrow=b.specimen[:2],
            unit=self.unit,
            vector_unit=self.unit,
            more=more,
        )

    def survey(self, size: int, plane: tuple[int, int] = (0, 1)) -> Survey:
        """Burgers vectors of squares of size x size cells at every place."""
        if plane != (0, 1):
            raise OrientationError(
                "plane: an orientation map has one plane, x and y. Leave the option out."
            )
        found = self.map.burgers_map(size)
        vectors, specimen = (
            x.transpose(2, 1, 0)[..., None] for x in (found.vectors, found.specimen)
        )
        rows, columns = found.clean.shape
        x, y = self._lines(columns, rows)
        half = [size * step / 2 for step in self.map.steps]
        return Survey(
            size=(size, size),
            centres=(x + half[0], y + half[1]),
            names=("x", "y"),
            layers=("",),
            vectors=vectors,
            components=COMPONENTS,
            arrows=specimen[:2],
            sigma=found.sigma.T[..., None],
            grid_error=found.interpolation.T[..., None],
            significance=found.significance.T[..., None],
            area=found.area,
            unit=self.unit,
            vector_unit=self.unit,
            missing="cross a boundary of grains or a pixel that is not indexed",
            down=True,
        )

    def backdrop(self, section: Section = PLANE) -> Backdrop:
        """The map of grains."""
        rows, columns = self.map.shape
        values = np.where(self.map.grain < 0, np.nan, self.map.grain).T
        title = f"grains at {self.map.threshold:g} degrees"
        return Backdrop(self._lines(columns, rows), values, "grains", title)

    def _lines(self, columns: int, rows: int) -> tuple[np.ndarray, np.ndarray]:
        """Coordinates of columns and rows; of hexagonal grids those between even and odd rows."""
        x = self.map.steps[0] * (np.arange(columns) + self.map.shift / 2)
        return x, self.map.steps[1] * np.arange(rows)

    def _places(self, pixels: np.ndarray) -> np.ndarray:
        """Coordinates of pixels, shape (2, k)."""
        row, column = pixels.T
        x = self.map.steps[0] * (column + self.map.shift * (row % 2))
        return np.array([x, self.map.steps[1] * row])
