"""Lattice field: the phases of a lattice image as a measured field."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geomtorsion.errors import ImageError
from geomtorsion.images import LatticeImage, LatticePhases
from geomtorsion.loops import Loop
from geomtorsion.measured.results import PLANE, Backdrop, Closure, Section, Survey, noise_level

COMPONENTS = ("bx", "by")


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
            components=COMPONENTS,
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
        if plane != (0, 1):
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
            components=COMPONENTS,
            arrows=vectors[..., None],
            sigma=np.where(known, sigma, np.nan)[..., None],
            grid_error=np.where(known, doubt, np.nan)[..., None],
            significance=np.where(known, significance, np.nan)[..., None],
            area=found.area,
            unit=self.unit,
            vector_unit=self.unit,
            missing="touch a hole, or noise may change their numbers",
        )

    def backdrop(self, section: Section = PLANE) -> Backdrop:
        """The picture itself."""
        return Backdrop(self.image.axes, self.image.field, "image", "image and circuits")
