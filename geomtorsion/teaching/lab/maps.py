"""maps: the facts that the page needs about an uploaded map or image, in any format."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from geomtorsion.errors import OrientationError
from geomtorsion.loops import Loop
from geomtorsion.materials.burgers import Burgers
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.images import LatticePhases
from geomtorsion.materials.maps import LAUE_GROUPS, Circuit, OrientationMap
from geomtorsion.pictures.style import number
from geomtorsion.support.caching import cached_property
from geomtorsion.support.outgoing import size_text
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.lab.numbers import raised, table
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.texts import ENGLISH, Texts, texts


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
    def text(self) -> Texts:
        """The texts of maps in the language of the page."""
        ...

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
    text: Texts

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
        samples, text = self.frame, self.text
        sizes = " × ".join(str(len(axis)) for axis in samples.axes)
        source = "unknown" if samples.sigma is None else samples.sigma_source
        parts = [text("frame", nodes=sizes), text("noise", source=text.named("sources", source))]
        if samples.holes:
            parts.append(text("holes", count=len(samples.holes)))
        if len(samples.axes) > 2:
            parts.append(text("middle"))
        return "; ".join(parts)

    @property
    def settings(self) -> Json:
        """No options."""
        return {}

    def picture(self, side: int) -> MapPicture:
        """|b| per area, in the middle of the other axes."""
        cells = self.frame.burgers_map(side)
        middle = tuple(len(axis) // 2 for axis in self.frame.axes[2:])
        density = cells.per_area[(slice(None), slice(None), *middle)]
        return _dense(density, self.layout, side, self.frame.vector_unit, self.text)

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
        remark = "" if samples.sigma is not None else self.text("no_noise")
        error = b.systematic_error
        heads = [f"b{raised(k)}" for k in range(samples.rows)]
        return _answer(b, heads, error, remark, side, self.text)


@dataclass(frozen=True)
class UploadedOrientations:
    """An orientation map; colours show one phase, or all for 0."""

    map: OrientationMap
    text: Texts
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
        grains = self.text("grain") if count == 1 else self.text("grains", count=count)
        return self.text(
            "orientations", rows=rows, columns=columns, phases=phases, grains=grains,
            angle=f"{self.map.threshold:g}",
        )  # fmt: skip

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
        return _dense(density, self.layout, side, self.map.unit, self.text)

    def circuit(self, corner: Sequence[int], side: int) -> Json:
        """Crystal axes, lengths in the unit of the map."""
        column, row = corner
        if min(corner) < 0:
            raise OrientationError(
                f"expected a circuit inside the map, got a corner at column {column}, row {row}. "
                "Choose another centre, or a smaller side."
            )
        b = self.map.burgers(Circuit.square((row, column), side))
        remark = self.text("crystal", grain=b.grain, phase=b.phase.name)
        heads = [f"b{raised(k)}" for k in range(3)]
        return _answer(b, heads, None, remark, side, self.text)


@dataclass(frozen=True, eq=False)
class UploadedImage:
    """An image of a lattice; lengths are in pixels."""

    phases: LatticePhases
    text: Texts

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
        first, second = (f"{length:.4g}" for length in lengths)
        return self.text(
            "image", columns=columns, rows=rows, first=first, second=second,
            share=f"{self.phases.holes.mean():.1%}",
        )  # fmt: skip

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
        return MapPicture(self._pixels, self.text("pixels_shown"))

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
        heads = ("", *map(self.text, ("whole_number", "lattice_x", "lattice_y")))
        return {
            "sentence": self.text(
                "whole",
                side=side,
                b=numbers,
                chance=f"{b.chance:.1g}",
                size=f"{b.magnitude:.4g}",
                error=f"{b.error:.1g}",
            ),
            "table": table(heads, rows, self.text("caption_lattice")),
            "b": b.whole.tolist(),
            "noise": [b.chance] * 2,
            "interpolation": b.error,
            "unit": "lattice vectors",
        }


def uploaded(
    found: SampledFrame | OrientationMap | LatticePhases,
    phase: int = 0,
    language: str = ENGLISH,
) -> UploadedFrame | UploadedOrientations | UploadedImage:
    """The content of a file, in the form that the page needs."""
    text = texts("figures", "maps", language)
    if isinstance(found, OrientationMap):
        return UploadedOrientations(found, text, phase if phase in found.phases else 0)
    if isinstance(found, LatticePhases):
        return UploadedImage(found, text)
    return UploadedFrame(found, text)


def _dense(density: np.ndarray, layout: Layout, side: int, vectors: str, text: Texts) -> MapPicture:
    """Values of circuits at the nodes in their centres."""
    whole = np.full(layout.shape, np.nan)
    half = side // 2
    whole[half : half + density.shape[0], half : half + density.shape[1]] = density
    # Pixels follow increasing coordinates, also where an axis descends.
    turned = whole[:: int(np.sign(layout.steps[0])), :: int(np.sign(layout.steps[1]))]
    title = text("density", side=side)
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
    b: Burgers,
    heads: Sequence[str],
    interpolation: float | None,
    remark: str,
    side: int,
    text: Texts,
) -> Json:
    """A Burgers vector with its errors, component by component, in words and as a table.

    interpolation: error of the largest component, None if it is far below the noise. remark: a
    further sentence.
    """
    behind = f" {b.unit}" if b.unit else ""
    size, most = float(np.linalg.norm(b.vector)), float(np.max(b.sigmas))
    values = {"side": side, "size": f"{size:.4g}{behind}", "noise": f"{size_text(most)}{behind}"}
    error = "–" if interpolation is None else size_text(interpolation)
    if interpolation is None:
        sentences = [text("circuit", **values)]
    else:
        sentences = [text("circuit_grid", **values, interpolation=f"{error}{behind}")]
    if np.isfinite(b.significance):
        # With noise only, |b| / sigma is the square root of the number of components.
        pure = f"{len(b.vector) ** 0.5:.1f}"
        times = number(float(f"{b.significance:.3g}"))
        sentences.append(text("significance", times=times, pure=pure))
    if remark:
        sentences.append(remark)
    rows = [
        [head, number(float(f"{value:.5g}")), size_text(sigma), error]
        for head, value, sigma in zip(heads, b.vector.tolist(), b.sigmas.tolist(), strict=True)
    ]
    caption = text("caption_unit", unit=b.unit) if b.unit else text("caption")
    return {
        "sentence": " ".join(sentences),
        "table": table(("", "b", text("head_noise"), text("head_error")), rows, caption),
        "b": b.vector.tolist(),
        "noise": b.sigmas.tolist(),
        "interpolation": interpolation,
        "unit": b.unit,
    }
