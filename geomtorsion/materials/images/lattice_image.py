"""LatticeImage: an image of a crystal lattice, with the size of its pixels."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from geomtorsion.errors import ImageError
from geomtorsion.materials.images.image_files import check_size, pixels_of_signal, read_pixels
from geomtorsion.materials.images.phases import LatticePhases, lattice_phases
from geomtorsion.materials.images.pixels import UNSIZED, Region, of_size
from geomtorsion.materials.images.spots import Spectrum, Spots, find_spots, measured
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property

if TYPE_CHECKING:
    from collections.abc import Sequence


@dataclass(frozen=True, eq=False, repr=False)
class LatticeImage:
    """An image of a lattice, such as a micrograph that resolves columns of atoms.

    values: grey values, shape (rows, columns), the first row on top, as in image files.
    step: size of a pixel. unit: of `step`, used in all results; "px" if the size is unknown.

    Coordinates are x to the right and y upwards, counted from the middle of the lower left pixel,
    in `unit`: a right-handed circuit runs anticlockwise on the screen.

    Raises
    ------
    ImageError
        The array does not have two axes, is too small or constant, or a value is not finite.

    Examples
    --------
    >>> y, x = np.mgrid[95:-1:-1, 0:96]
    >>> fringes = np.cos(2 * np.pi * x / 8) + np.cos(2 * np.pi * y / 6)
    >>> image = LatticeImage(fringes, step=0.05, unit="nm")
    >>> abs(image.spots.vectors).round(3)
    array([[0.125, 0.   ],
           [0.   , 0.167]])
    >>> abs(image.phases().lattice).round(2)
    array([[0.4, 0. ],
           [0. , 0.3]])
    """

    values: np.ndarray
    step: float = 1.0
    unit: str = UNSIZED
    # Rows and columns of the smallest image: six periods of a lattice with five pixels per period.
    least: ClassVar[int] = 32

    def __post_init__(self) -> None:
        """Check the array."""
        if np.ma.is_masked(self.values):
            raise ImageError(
                "image: expected a value at each pixel, got masked pixels. Fill them with the "
                "mean, .filled(array.mean()): a region without lattice counts as a hole."
            )
        values = checks.array(
            self.values,
            "image",
            ImageError,
            shape=(None, None),
            expected="an array of grey values",
            remedy="Give one channel, colour[..., 0], or the mean of the channels.",
        )
        if min(values.shape) < self.least:
            raise ImageError(
                f"image: expected {self.least} rows and columns or more, got {values.shape}. Give "
                "a larger part."
            )
        check_size("image", values.shape)
        checks.measured(values, "image", ImageError, is_length=True)
        # The mean of equal floats differs from them by rounding, which must not count as a lattice.
        if np.ptp(values) <= 1e-12 * np.abs(values).max():
            raise ImageError(
                "the image has no lattice: all its values are equal. Give another channel or page."
            )
        object.__setattr__(self, "values", values)
        step = checks.positive(self.step, "step", ImageError)
        object.__setattr__(self, "step", checks.measured(step, "step", ImageError, is_length=True))
        checks.text(self.unit, "unit", ImageError)

    # -- makers -----------------------------------------------------------------------------------

    @classmethod
    def read(
        cls,
        path: str | Path,
        step: float | None = None,
        unit: str | None = None,
        *,
        page: int = 0,
    ) -> LatticeImage:
        """Read TIFF, PNG or NPY, or by rosettasciio .dm3, .dm4, .emd, .mrc, .ser or .hspy.

        Colours are converted to grey. The first row of the data is on top. An .mrc file with the
        first row at the bottom therefore gives a mirror image, in which b has the opposite sign.

        Parameters
        ----------
        step, unit
            Size of a pixel, instead of the size in the file. TIFF (OME, ImageJ, resolution tags
            above 10,000 per inch) and files of microscopes state it; without a step and a unit,
            lengths are in px, and the pixel size is unknown.
        page
            Number of the image in a file with several images or in an array of shape
            (pages, rows, columns).

        Raises
        ------
        FileFormatError
            The file is missing, damaged, too large, or of another kind.
        MissingExtraError
            The library is not installed; it is in the extra "images", or "files" for microscopes.
        ImageError
            The file states pixels that are not square, or a unit is given without a step.
        """
        path = checks.file_name(path, error=ImageError)
        if step is None and unit is not None:
            raise ImageError(
                f"step: expected the size of a pixel in {checks.shown(unit)}, got none. Give both, "
                "or neither to use the size in the file."
            )
        pixels = read_pixels(path, page, sized=step is None)
        if pixels.size is not None:
            step, unit = pixels.size.step, pixels.size.unit
        try:
            return cls(pixels.values, 1.0 if step is None else step, unit or UNSIZED)
        except ImageError as error:
            # An error in the pixels is reported as an error in the file.
            named = f"{path.name}: {error}"
            raise ImageError(named if "image" in str(error)[:10] else str(error)) from None

    @classmethod
    def of_signal(cls, signal: Any) -> LatticeImage:
        """Image from a two-dimensional hyperspy signal, with its scale and unit.

        As for files, x runs along the rows of the data, and y from the last row to the first.

        Raises
        ------
        ImageError
            The signal does not have two axes, its pixels are not square, or an axis decreases.
        """
        return cls(*pixels_of_signal(signal))

    # -- lattice ----------------------------------------------------------------------------------

    @cached_property
    def field(self) -> np.ndarray:
        """The values as a function of coordinates, field[x, y], shape (columns, rows)."""
        return np.ascontiguousarray(self.values[::-1].T)

    @property
    def axes(self) -> tuple[np.ndarray, np.ndarray]:
        """Coordinates x and y of the pixels."""
        columns, rows = self.field.shape
        return self.step * np.arange(columns), self.step * np.arange(rows)

    @cached_property
    def spots(self) -> Spots:
        """Two Bragg spots that span the reciprocal lattice, found automatically.

        Raises
        ------
        ImageError
            The image shows no lattice.
        """
        return find_spots(self.field)

    def phases(
        self,
        spots: Sequence[Sequence[float]] | np.ndarray | None = None,
        resolution: float | None = None,
        reference: Region | None = None,
    ) -> LatticePhases:
        """Geometric phases of two Bragg spots, which give lattice coordinates of each pixel.

        Parameters
        ----------
        spots
            g_1 and g_2 in cycles per unit, rows, shape (2, 2); by default found automatically.
            Spots that span only part of the reciprocal lattice give only part of the Burgers
            vector.
        resolution
            Standard deviation of the Gaussian over which the phases are averaged, in units. The
            default is one lattice spacing, or more if the noise requires it.
        reference
            A region of unstrained lattice, see `LatticePhases.relative_to`. By default, strain is
            relative to the mean lattice of the image.

        Raises
        ------
        ImageError
            The image shows no lattice, a spot is beyond the highest frequency of the pixels, the
            spots are collinear, or the region is outside the image.
        """
        spot_pair = self.spots if spots is None else self._given(spots)
        blur = None if resolution is None else self._resolution(resolution)
        phases = lattice_phases(self.field, self.step, self.unit, spot_pair, blur)
        return phases if reference is None else phases.relative_to(reference)

    def _given(self, spots: object) -> Spots:
        """Spots given by the user, with amplitude and noise measured in the image."""
        pair = self.step * checks.array(spots, "spots", ImageError, shape=(2, 2))
        if np.abs(pair).max() > 0.5:
            raise ImageError(
                f"spots: expected frequencies of at most {0.5 / self.step:.6g} per {self.unit} "
                f"(half a cycle per pixel), got {np.abs(pair).max() / self.step:.6g}. Give cycles "
                f"per {self.unit}."
            )
        lengths = np.hypot(*pair.T)
        periods = lengths.min() * min(self.values.shape)
        if periods < Spectrum.periods:
            raise ImageError(
                f"spots: expected {Spectrum.periods} periods across the image or more, got "
                f"{periods:.3g}: the spot is too close to the origin. Give cycles per {self.unit}, "
                "or a larger part of the image."
            )
        if abs(np.linalg.det(pair)) < 1e-6 * lengths.prod():
            raise ImageError(
                "spots: expected two spots in different directions, got both in one direction. "
                "Give another spot."
            )
        return measured(Spectrum.of(self.field), pair)

    def _resolution(self, value: object) -> float:
        """Resolution given by the user, in pixels."""
        blur = checks.positive(value, "resolution", ImageError) / self.step
        if not 0.5 <= blur <= min(self.values.shape) / 4:
            raise ImageError(
                f"resolution: expected {0.5 * self.step:.6g} to "
                f"{min(self.values.shape) / 4 * self.step:.6g} {self.unit} (half a pixel to a "
                f"quarter of the image), got {blur * self.step:.6g}."
            )
        return blur

    def __repr__(self) -> str:
        rows, columns = self.values.shape
        return f"LatticeImage({columns} x {rows} pixels{of_size(self.step, self.unit)})"
