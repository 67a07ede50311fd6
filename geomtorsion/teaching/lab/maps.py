"""maps: the facts that the page needs about an uploaded map or image, in any format."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from geomtorsion.errors import OrientationError
from geomtorsion.loops import Loop
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.images import LatticePhases
from geomtorsion.materials.maps import LAUE_GROUPS, Circuit, OrientationMap
from geomtorsion.pictures.style import number
from geomtorsion.support.caching import cached_property
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.lab.numbers import raised, table
from geomtorsion.teaching.lab.settings import PAGE


@dataclass(frozen=True)
class Layout:
    """Positions of the nodes.

    shape: nodes along x and y. starts: coordinates of the first node. steps: coordinate
    differences to the next node. names: of the axes. unit: of coordinates.
    """

    shape: tuple[int, int]
    starts: tuple[float, float]
    steps: tuple[float, float]
    names: tuple[str, str]
    unit: str


@dataclass(frozen=True)
class MapPicture:
    """Picture of all nodes: numbers, shape (y, x), or colours, shape (y, x, 3).

    title: the quantity. unit: of the numbers, which are not finite where they are unknown.
    side: of the circuits whose centres carry the numbers, 0 if the nodes carry them.
    """

    pixels: np.ndarray
    title: str
    side: int = 0
    unit: str = ""


class UploadedMap(Protocol):
    """A map or an image."""

    @property
    def layout(self) -> Layout:
        """Positions of its nodes."""
        ...

    @property
    def least(self) -> int:
        """Cells along the side of the smallest circuit."""
        ...

    @property
    def description(self) -> str:
        """A description in words."""
        ...

    @property
    def settings(self) -> Json:
        """The options for reading it; empty if there are none."""
        ...

    def picture(self, side: int) -> MapPicture:
        """The picture behind a circuit of so many cells along its side."""
        ...

    def circuit(self, corner: Sequence[int], side: int) -> Json:
        """sentence, table, b, noise, interpolation and unit of a square circuit."""
        ...


@dataclass(frozen=True)
class UploadedFrame:
    """A sampled frame."""

    frame: SampledFrame

    @property
    def layout(self) -> Layout:
        """Its first two axes."""
        (x, y), names = self.frame.axes[:2], self.frame.names
        starts, steps = (float(x[0]), float(y[0])), self.frame.steps
        return Layout(
            (len(x), len(y)), starts, (float(steps[0]), float(steps[1])), (names[0], names[1]),
            self.frame.unit,
        )  # fmt: skip

    @property
    def least(self) -> int:
        """Cells along the side of the smallest circuit."""
        return 1

    @property
    def description(self) -> str:
        """Its nodes, its noise, its holes."""
        samples = self.frame
        noise = "unknown" if samples.sigma is None else samples.sigma_source
        holes = f"; holes: {len(samples.holes)}" if samples.holes else ""
        sizes = " × ".join(str(len(axis)) for axis in samples.axes)
        what = f"a sampled frame of {sizes} nodes; noise: {noise}{holes}"
        more = "; circuits are in the middle of its other axes" if len(samples.axes) > 2 else ""
        return what + more

    @property
    def settings(self) -> Json:
        """No options."""
        return {}

    def picture(self, side: int) -> MapPicture:
        """|b| per area, in the middle of the other axes."""
        cells = self.frame.burgers_map(side)
        middle = tuple(len(axis) // 2 for axis in self.frame.axes[2:])
        density = cells.per_area[(slice(None), slice(None), *middle)]
        return _dense(density, self.layout, side, self.frame.vector_unit)

    def circuit(self, corner: Sequence[int], side: int) -> Json:
        """From x to y."""
        samples = self.frame
        axes = zip(samples.axes, samples.steps, corner, strict=False)
        low = [float(a[0]) + h * k for a, h, k in axes]
        high = [a + h * side for a, h in zip(low, samples.steps, strict=False)]
        (x0, x1), (y0, y1) = (sorted(pair) for pair in zip(low, high, strict=True))
        rest = [float(axis[len(axis) // 2]) for axis in samples.axes[2:]]
        corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        b = samples.burgers(Loop.polygon([[*point, *rest] for point in corners], name="square"))
        remark = "" if samples.sigma is not None else "The noise of this map is unknown."
        error = b.systematic_error
        heads = [f"b{raised(k)}" for k in range(samples.rows)]
        return _answer(b.vector, b.sigmas, heads, error, b.unit, b.significance, remark, side)


@dataclass(frozen=True)
class UploadedOrientations:
    """An orientation map; colours show one phase, or all for 0."""

    map: OrientationMap
    phase: int = 0

    @property
    def layout(self) -> Layout:
        """x along rows, y along columns."""
        rows, columns = self.map.shape
        return Layout((columns, rows), (0.0, 0.0), self.map.steps, ("x", "y"), self.map.unit)

    @property
    def least(self) -> int:
        """Cells along the side of the smallest circuit."""
        return 1

    @property
    def description(self) -> str:
        """Its pixels, phases with their Laue groups, and grains."""
        rows, columns = self.map.shape
        phases = ", ".join(f"{one.name}: {one.laue}" for one in self.map.phases.values())
        count = self.map.grains.count
        grains = f"{count} grain{'s' * (count != 1)} at {self.map.threshold:g}°"
        return f"an orientation map of {rows} × {columns} pixels ({phases}), {grains}"

    @property
    def settings(self) -> Json:
        """Threshold, phases and Laue groups."""
        phases = [[key, one.name] for key, one in self.map.phases.items()]
        return {"threshold": self.map.threshold, "phases": phases, "groups": list(LAUE_GROUPS)}

    def picture(self, side: int) -> MapPicture:
        """|b| per area of circuits within grains of the phase."""
        density = self.map.burgers_map(side).per_area
        if self.phase:
            density = np.where(self.phase == self.map.phase[:-side, :-side].T, density, np.nan)
        return _dense(density, self.layout, side, self.map.unit)

    def circuit(self, corner: Sequence[int], side: int) -> Json:
        """Crystal axes, lengths in the unit of the map."""
        column, row = corner
        if min(corner) < 0:
            raise OrientationError(
                f"expected a circuit inside the map, got a corner at column {column}, row {row}. "
                "Choose another centre, or a smaller side."
            )
        b = self.map.burgers(Circuit.square((row, column), side))
        remark = (
            f"Grain {b.grain}, {b.phase.name}. Components are along the axes of the crystal. The "
            "interpolation error is far below the noise."
        )
        heads = [f"b{raised(k)}" for k in range(3)]
        return _answer(b.vector, b.sigmas, heads, None, b.unit, b.significance, remark, side)


@dataclass(frozen=True, eq=False)
class UploadedImage:
    """An image of a lattice; lengths are in pixels."""

    phases: LatticePhases

    @property
    def layout(self) -> Layout:
        """x to the right, y upwards, from the lower left pixel."""
        columns, rows = self.phases.picture.shape
        return Layout((columns, rows), (0.0, 0.0), (1.0, 1.0), ("x", "y"), "px")

    @property
    def least(self) -> int:
        """Cells along the side of the smallest circuit."""
        return 2

    @property
    def description(self) -> str:
        """Its pixels, its lattice, its holes."""
        columns, rows = self.layout.shape
        lengths = np.hypot(*self.phases.lattice.T)
        return (
            f"an image of {columns} × {rows} pixels of a lattice with vectors of {lengths[0]:.4g} "
            f"and {lengths[1]:.4g} pixels; {self.phases.holes.mean():.1%} of the area are holes"
        )

    @property
    def settings(self) -> Json:
        """No options."""
        return {}

    @cached_property
    def _pixels(self) -> np.ndarray:
        """The picture, at most at the resolution of the page; holes are red."""
        values, holes = self.phases.picture.T, self.phases.holes.T
        every = -(-max(values.shape) // PAGE.across)
        rows, columns = (n // every * every for n in values.shape)
        blocks = (rows // every, every, columns // every, every)
        means = values[:rows, :columns].reshape(blocks).mean(axis=(1, 3))
        touched = holes[:rows, :columns].reshape(blocks).any(axis=(1, 3))
        # A few very bright or dark pixels do not hide the rest.
        low, high = np.percentile(means, [1, 99])
        share = np.clip((means - low) / ((high - low) or 1.0), 0, 1)
        grey = np.rint(255 * share).astype(np.uint8)
        colours = np.repeat(grey[..., None], 3, axis=2)
        colours[touched] = colours[touched] // 2 + np.array([127, 40, 30], np.uint8)
        return colours

    def picture(self, side: int) -> MapPicture:
        """The image itself."""
        return MapPicture(self._pixels, "the image; red: no lattice found")

    def circuit(self, corner: Sequence[int], side: int) -> Json:
        """Integer components, and the probability that noise has changed one."""
        x, y = corner
        corners = [(x, y), (x + side, y), (x + side, y + side), (x, y + side)]
        b = self.phases.burgers(Loop.polygon([list(map(float, p)) for p in corners]))
        numbers = ", ".join(number(float(n)) for n in b.whole.tolist())
        rows = [
            [f"b{raised(k)}", number(float(n)), *(number(float(f"{v:.4g}")) for v in vector)]
            for k, (n, vector) in enumerate(zip(b.whole.tolist(), b.lattice.tolist(), strict=True))
        ]
        heads = ("", "whole number", "lattice vector: x", "lattice vector: y")
        sentence = (
            f"Circuit of {side} × {side} pixels: b = ({numbers}) in lattice vectors, exactly. "
            f"Noise has changed a number with a probability of {b.chance:.1g}. "
            f"|b| = {b.magnitude:.4g} pixels, error {b.error:.1g}."
        )
        return {
            "sentence": sentence,
            "table": table(heads, rows, "Burgers vector of the circuit, in lattice vectors"),
            "b": b.whole.tolist(),
            "noise": [b.chance] * 2,
            "interpolation": b.error,
            "unit": "lattice vectors",
        }


def uploaded(
    found: SampledFrame | OrientationMap | LatticePhases, phase: int = 0
) -> UploadedFrame | UploadedOrientations | UploadedImage:
    """The content of a file, in the form that the page needs."""
    if isinstance(found, OrientationMap):
        return UploadedOrientations(found, phase if phase in found.phases else 0)
    return UploadedImage(found) if isinstance(found, LatticePhases) else UploadedFrame(found)


def _dense(density: np.ndarray, layout: Layout, side: int, vectors: str) -> MapPicture:
    """Values of circuits at the nodes in their centres."""
    whole = np.full(layout.shape, np.nan)
    half = side // 2
    whole[half : half + density.shape[0], half : half + density.shape[1]] = density
    # Pixels follow increasing coordinates, also where an axis descends.
    turned = whole[:: int(np.sign(layout.steps[0])), :: int(np.sign(layout.steps[1]))]
    title = f"|b| per area, circuits of {side} × {side} cells"
    return MapPicture(turned.T, title, side, density_unit(vectors, layout.unit))


def density_unit(vectors: str, lengths: str) -> str:
    """The unit of b per area.

    Examples
    --------
    >>> density_unit("um", "um"), density_unit("nm", "um"), density_unit("", "")
    ('1/um', 'nm/um²', '')
    """
    if not lengths or not vectors:
        return ""
    return f"1/{lengths}" if vectors == lengths else f"{vectors}/{lengths}²"


def _answer(
    vector: np.ndarray,
    noise: np.ndarray,
    heads: Sequence[str],
    interpolation: float | None,
    unit: str,
    significance: float,
    remark: str,
    side: int,
) -> Json:
    """A Burgers vector with its errors, component by component, in words and as a table.

    interpolation: of the largest component, None if it is far below the noise. significance:
    ratio of |b| to its errors. remark: a further sentence.
    """
    behind = f" {unit}" if unit else ""
    size, most = float(np.linalg.norm(vector)), float(np.max(noise))
    text = f"Circuit of {side} × {side} cells: |b| = {size:.4g}{behind}"
    text += f"; noise {most:.1e}{behind} in the noisiest component"
    if interpolation is not None:
        text += f", interpolation {interpolation:.1e}{behind}"
    if np.isfinite(significance):
        # With noise only, |b| / sigma is the square root of the number of components.
        alone = len(vector) ** 0.5
        times = number(float(f"{significance:.3g}"))
        text += f". |b| is {times} times its error; pure noise would give about {alone:.1f} times"
    error = "–" if interpolation is None else f"{interpolation:.1e}"
    rows = [
        [head, number(float(f"{value:.5g}")), f"{sigma:.1e}", error]
        for head, value, sigma in zip(heads, vector.tolist(), noise.tolist(), strict=True)
    ]
    caption = f"Burgers vector of the circuit{f' in {unit}' if unit else ''}"
    return {
        "sentence": f"{text}. {remark}".rstrip(),
        "table": table(("", "b", "noise", "interpolation"), rows, caption),
        "b": vector.tolist(),
        "noise": noise.tolist(),
        "interpolation": interpolation,
        "unit": unit,
    }
