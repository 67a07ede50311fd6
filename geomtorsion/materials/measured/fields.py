"""Fields: a sampled frame, an orientation map, the phases of an image, each as a measured field."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from geomtorsion.errors import ImageError, OrientationError
from geomtorsion.loops import Loop
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.images import LatticeImage, LatticePhases
from geomtorsion.materials.maps import Circuit, OrientationMap, slip_families
from geomtorsion.materials.measured.results import (
    PLANE,
    Backdrop,
    Closure,
    Section,
    Survey,
    noise_level,
)


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
            down=self.down,
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


IN_SPECIMEN = ("b1", "b2", "b3")


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
            components=IN_SPECIMEN,
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
        if tuple(plane) != (0, 1):
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
            components=IN_SPECIMEN,
            arrows=specimen[:2],
            sigma=found.sigma.T[..., None],
            grid_error=found.interpolation.T[..., None],
            significance=found.significance.T[..., None],
            area=found.area,
            unit=self.unit,
            vector_unit=self.unit,
            missing="cross a boundary of grains or a pixel that is not indexed",
            down=self.down,
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


IN_IMAGE = ("bx", "by")


@dataclass(frozen=True, eq=False)
class LatticeField:
    """A picture of a lattice with its phases; see `Measured`.

    Burgers vectors are whole numbers of lattice vectors, given as lengths along x and y; the whole
    numbers stand in `more`. Noise changes such a number with some chance, or not at all: its
    significance is the length that normal noise passes with that chance.
    """

    image: LatticeImage
    phases: LatticePhases
    # Coordinates of images run upwards.
    down: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        """Of the axes."""
        return ("x", "y")

    @property
    def unit(self) -> str:
        """Of lengths."""
        return self.image.unit

    @property
    def about(self) -> tuple[str, ...]:
        """What it is, its lattice, and where it cannot be seen."""
        rows = ", ".join(f"({x:.4g}, {y:.4g})" for x, y in self.phases.lattice.tolist())
        strength = self.phases.levels / np.median(self.phases.noise, axis=(1, 2))
        return (
            repr(self.image),
            f"lattice vectors {rows} {self.unit}, averaged over {self.phases.resolution:.3g}",
            (
                f"amplitudes {strength[0]:.3g} and {strength[1]:.3g} times their noise; holes: "
                f"{float(self.phases.holes.mean()):.1%} of the pixels"
            ),
        )

    def closure(self, loop: Loop) -> Closure:
        """Burgers vector of a loop: whole numbers, or a refusal."""
        b = self.phases.burgers(loop)
        noise = float(np.sqrt(b.chance) * np.hypot(*b.lattice.T).max())
        x, y = b.path.T * self.image.step
        return Closure(
            name=loop.name or "loop",
            path=np.stack([x, y]),
            vector=b.vector,
            components=IN_IMAGE,
            noise=noise,
            grid_error=b.error,
            significance=noise_level(2, b.chance) if b.whole.any() else 0.0,
            area=float((x[:-1] * y[1:] - x[1:] * y[:-1]).sum() / 2),
            arrow=b.vector,
            unit=self.unit,
            vector_unit=self.unit,
            more={"whole": b.whole.tolist(), "chance": b.chance, "vectors": b.lattice.tolist()},
        )

    def survey(self, size: int, plane: tuple[int, int] = (0, 1)) -> Survey:
        """Whole numbers of squares of size x size pixels at every place, as lengths.

        Left out is what touches a hole, or what noise changes too often.
        """
        if tuple(plane) != (0, 1):
            raise ImageError("plane: an image has one plane, x and y. Leave the option out.")
        found = self.phases.burgers_map(size)
        known, chance = found.known, found.chance
        vectors = np.where(known, found.vectors, np.nan)
        lengths = np.hypot(*found.lattice.T)[:, None, None]
        sigma = np.sqrt((lengths**2 * found.chances).sum(axis=0))
        significance = np.where(found.whole.any(axis=0), noise_level(2, chance), 0.0)
        # The spots, and with them the lattice, are known to a third of a pixel of the transform.
        doubt = self.phases.doubt * (np.abs(found.whole) * lengths).sum(axis=0)
        x, y = (self.image.step * (np.arange(n) + size / 2) for n in known.shape)
        return Survey(
            size=(size, size),
            centres=(x, y),
            names=("x", "y"),
            layers=("",),
            vectors=vectors[..., None],
            components=IN_IMAGE,
            arrows=vectors[..., None],
            sigma=np.where(known, sigma, np.nan)[..., None],
            grid_error=np.where(known, doubt, np.nan)[..., None],
            significance=np.where(known, significance, np.nan)[..., None],
            area=found.area,
            unit=self.unit,
            vector_unit=self.unit,
            missing="touch a hole, or noise may change their numbers",
            down=self.down,
        )

    def backdrop(self, section: Section = PLANE) -> Backdrop:
        """The picture itself."""
        return Backdrop(self.image.axes, self.image.field, "image", "image and circuits")
