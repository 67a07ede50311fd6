"""Sampled field: a sampled frame as a measured field."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from geomtorsion.loops import Loop, SampledFrame
from geomtorsion.measured.results import PLANE, Backdrop, Closure, Section, Survey


@dataclass(frozen=True, eq=False)
class SampledField:
    """A coframe on a grid of two axes or more; see `Measured`."""

    frame: SampledFrame
    down: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        """Of the axes."""
        return tuple(self.frame.names)

    @property
    def unit(self) -> str:
        """Of lengths."""
        return self.frame.unit

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the components of b."""
        return tuple(f"b{k}" for k in range(self.frame.rows))

    @property
    def about(self) -> tuple[str, ...]:
        """What it is, and where its noise is known from."""
        noise = self.frame.sigma_source or "not known: errors are those of the grid alone"
        source = (f"source: {self.frame.source}",) if self.frame.source else ()
        return (repr(self.frame), f"noise: {noise}", *source)

    def closure(self, loop: Loop) -> Closure:
        """Burgers vector of a loop."""
        b = self.frame.burgers(loop)
        points, area = _closed(loop.points()), np.asarray(loop.area, dtype=float)
        section = self._section(points, area)
        plane = list(section.plane)
        return Closure(
            name=loop.name or "loop",
            path=points[plane],
            vector=b.vector,
            components=self.components,
            noise=float(np.linalg.norm(b.sigmas)),
            grid_error=b.interpolation_error + b.quadrature_error,
            significance=b.significance,
            area=float(area[section.plane]),
            arrow=b.vector[plane] if len(b.vector) > max(plane) else None,
            section=section,
            unit=self.unit,
            vector_unit=b.unit,
        )

    def _section(self, points: np.ndarray, area: np.ndarray) -> Section:
        """The plane in which a loop has its largest area, through the middle of the loop."""
        one, two = np.unravel_index(int(np.abs(np.triu(area)).argmax()), area.shape)
        plane = (int(one), int(two)) if one != two else (0, 1)
        others = [k for k in range(self.frame.dimension) if k not in plane]
        return Section(plane, tuple(points[others].mean(axis=1).tolist()))

    def survey(self, size: int, plane: tuple[int, int] = (0, 1)) -> Survey:
        """Burgers vectors of squares of size x size cells at every place of every layer."""
        frame = self.frame
        found = frame.burgers_map(size, plane)
        others = [k for k in range(frame.dimension) if k not in plane]
        order = [*plane, *others]
        places = [found.known.shape[k] for k in order]

        def laid(values: np.ndarray) -> np.ndarray:
            """Axes of the plane first, all others as layers."""
            full = np.broadcast_to(values, (*values.shape[: -frame.dimension], *found.known.shape))
            ahead = full.ndim - frame.dimension
            turned = full.transpose(*range(ahead), *(ahead + k for k in order))
            return turned.reshape(*full.shape[:ahead], *places[:2], -1)

        centres = []
        for k, cells, count in zip(plane, found.size, places, strict=False):
            start, step = frame.axes[k][0], frame.steps[k]
            centres.append(start + step * (np.arange(count) + cells / 2))
        beyond = [frame.names[k] for k in others]
        layers = [layer_names(beyond, at) for at in product(*(frame.axes[k] for k in others))]
        vectors = laid(found.vectors)
        flat = set(plane) == {0, 1} and frame.rows > 1
        return Survey(
            size=found.size,
            centres=(centres[0], centres[1]),
            names=(frame.names[plane[0]], frame.names[plane[1]]),
            layers=tuple(layers),
            vectors=vectors,
            components=self.components,
            arrows=vectors[list(plane)] if flat else None,
            sigma=np.linalg.norm(laid(found.sigmas), axis=0),
            grid_error=laid(found.interpolation),
            significance=laid(found.significance),
            area=found.area,
            unit=self.unit,
            vector_unit=frame.vector_unit,
            missing="touch a hole",
        )

    def backdrop(self, section: Section = PLANE) -> Backdrop:
        """|b| per area of every cell, in the layer next to the section; holes stay blank."""
        frame = self.frame
        found = self.survey(1, section.plane)
        others = [k for k in range(frame.dimension) if k not in section.plane]
        middles = [float(np.mean(frame.axes[k])) for k in others]
        at = [
            int(np.abs(np.asarray(frame.axes[k]) - x).argmin())
            for k, x in zip(others, section.at or middles, strict=True)
        ]
        layer = int(np.ravel_multi_index(at, [len(frame.axes[k]) for k in others])) if at else 0
        unit = f" ({found.density_unit})" if found.density_unit else ""
        where = f", {found.layers[layer]}" if at else ""
        title = f"|b| per area of each cell{unit}{where}"
        return Backdrop(found.centres, found.density[..., layer], "sizes", title)


def layer_names(names: Sequence[str], values: Sequence[float]) -> str:
    """Where a plane lies, in words."""
    return ", ".join(f"{name} = {x:.6g}" for name, x in zip(names, values, strict=True))


def _closed(points: np.ndarray) -> np.ndarray:
    """A curve led back to its first point."""
    return np.concatenate([points, points[:, :1]], axis=1)
