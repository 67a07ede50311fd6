"""Phases: geometric phase analysis, from two Bragg spots to coframe, strain, Burgers vectors."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.errors import GridError, ImageError
from geomtorsion.loops import Cochain, Complex, Loop
from geomtorsion.materials.burgers import PLANE, Section
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.images.phase_circuits import (
    LatticeBurgers,
    detoured,
    enclosed,
    expected_clicks,
    pixel_path,
    rings_of,
    squares_of,
    whole_turns,
    wound,
)
from geomtorsion.materials.images.pixels import Region, of_size, pixels_of
from geomtorsion.materials.images.spots import Spots
from geomtorsion.materials.rings import Rings
from geomtorsion.materials.source import Backdrop
from geomtorsion.materials.survey import Errors, Survey, areas, middles
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property

# Names of components of b along the axes of the image.
COMPONENTS = ("bx", "by")
# Lower bound of divisors, because a power may vanish.
TINY = float(np.finfo(float).tiny)


@dataclass(frozen=True, eq=False, repr=False)
class LatticePhases:
    """Geometric phases of two Bragg spots of an image.

    Equation
    --------
    H_i(r) exp(2 pi i g_i r) = image filtered around g_i; the phase of H_i is -2 pi g_i u(r)
    [Hytch, Snoeck and Kilaas, Ultramicroscopy 74 (1998) 131], and
    e^i = g_i + grad(arg H_i) / 2 pi = g_i (1 - beta), with beta = grad u. The integral of e along a
    step is the change of the lattice coordinates. Its integral along a right-handed circuit is a
    whole number for each i, equal to -g_i b_0; the integral of du along the circuit is b_0.

    step, unit: size of a pixel. found: the spots, with their noise, in cycles per pixel.
    blur: standard deviation of the averaging Gaussian, in pixels.
    waves: H_i of each spot, complex, waves[i, x, y].
    borders: share of the Gaussian within the image, by x and by y.
    picture: grey values of the image, picture[x, y].
    low: share of the median amplitude below which a pixel is a hole, such as a core or a void.
    reference: e^i_mu of the unstrained lattice, shape (2, 2), lattice vectors per unit; if None,
        the lattice of the spots, which is the mean lattice of the image.
    """

    step: float
    unit: str
    found: Spots
    blur: float
    waves: np.ndarray
    borders: tuple[np.ndarray, np.ndarray]
    picture: np.ndarray
    low: float = 0.2
    reference: np.ndarray | None = None

    # -- the lattice ------------------------------------------------------------------------------

    @property
    def spots(self) -> np.ndarray:
        """g_1 and g_2 in cycles per unit, rows, shape (2, 2)."""
        return self.found.vectors / self.step

    @property
    def lattice(self) -> np.ndarray:
        """Lattice vectors a_1 and a_2 of the reference in units, rows, shape (2, 2)."""
        return np.linalg.inv(self.spots if self.reference is None else self.reference).T

    def relative_to(self, region: Region) -> LatticePhases:
        """The same phases, with distortion, strain and lattice vectors relative to a region.

        Parameters
        ----------
        region
            Unstrained lattice: a rectangle ((x0, x1), (y0, y1)) in units, or truth values by pixel,
            region[x, y]. The reference is its mean coframe without holes.

        Raises
        ------
        ImageError
            The region is outside the image, narrower than the resolution, or consists of holes.

        Examples
        --------
        Fringes with a 2 % larger spacing in the right half, and strain relative to the left half:

        >>> from geomtorsion.materials.images import LatticeImage
        >>> y, x = np.mgrid[127:-1:-1, 0:256]
        >>> place = np.where(x < 128, x, 128 + (x - 128) / 1.02)
        >>> image = LatticeImage(np.cos(2 * np.pi * place / 8) + np.cos(2 * np.pi * y / 8))
        >>> phases = image.phases(reference=((20, 100), (20, 107)))
        >>> phases.strain[0, 0, [60, 200], 64].round(4) + 0.0
        array([0.    , 0.0196])
        """
        chosen = pixels_of(region, self.waves.shape[1:], self.step, self.unit, self.resolution)
        chosen &= ~self.holes
        if not chosen.any():
            raise ImageError(
                "reference: expected a region with a visible lattice, got only holes. Choose "
                "another region."
            )
        return replace(self, reference=self.coframe[:, :, chosen].mean(axis=2))

    @property
    def resolution(self) -> float:
        """Standard deviation of the averaging Gaussian, in units."""
        return self.blur * self.step

    @property
    def doubt(self) -> float:
        """Relative error of lattice vectors: a third of a pixel of the transform over |g|."""
        return 1 / (3 * min(self.waves.shape[1:]) * float(np.hypot(*self.found.vectors.T).min()))

    # -- amplitude and noise ----------------------------------------------------------------------

    @cached_property
    def amplitude(self) -> np.ndarray:
        """Amplitude of each wave, amplitude[i, x, y]; a low amplitude has no meaningful phase."""
        return np.abs(self.waves)

    @cached_property
    def phase(self) -> np.ndarray:
        """The geometric phases -2 pi g_i u, between -pi and pi, phase[i, x, y]."""
        return np.angle(self.waves)

    @cached_property
    def noise(self) -> np.ndarray:
        """Root mean square of the noise in each wave, noise[i, x, y]; larger towards the border.

        It is estimated from the power spectrum around each spot, and assumes noise of equal
        strength in the whole image.
        """
        # A Gaussian reduces white noise of variance 1 to variance 1 / (4 pi blur^2).
        narrow = [_inside(n, self.blur / np.sqrt(2)) for n in self.waves.shape[1:]]
        shares = [np.sqrt(s) / b for s, b in zip(narrow, self.borders, strict=True)]
        one = np.multiply.outer(*shares) / (np.sqrt(4 * np.pi) * self.blur)
        return self.found.noise[:, None, None] * one

    @cached_property
    def ratio(self) -> np.ndarray:
        """Amplitudes in units of their noise, ratio[i, x, y]."""
        return self.amplitude / np.maximum(self.noise, TINY)

    @cached_property
    def levels(self) -> np.ndarray:
        """Median amplitude of each wave, shape (2,)."""
        return np.median(self.amplitude, axis=(1, 2))

    @cached_property
    def holes(self) -> np.ndarray:
        """Whether an amplitude is too low for a phase, holes[x, y]."""
        low = self.amplitude < self.low * self.levels[:, None, None]
        return low[0] | low[1]

    # -- fields -----------------------------------------------------------------------------------

    @cached_property
    def coframe(self) -> np.ndarray:
        """e^i_mu in lattice units per unit of length, coframe[i, mu, x, y], without unwrapping.

        NaN in holes.
        """
        slopes = np.empty((2, *self.waves.shape))
        power = np.maximum(self.amplitude, TINY) ** 2
        for k, wave in enumerate(self.waves):
            # The share inside the image is real: it does not change the phase, but has a slope.
            full = wave * np.multiply.outer(*self.borders)
            scale = power[k] * np.multiply.outer(*self.borders)
            for mu, slope in enumerate(np.gradient(full, edge_order=2)):
                slopes[k, mu] = (wave.conj() * slope).imag / scale
        found = (self.found.vectors[:, :, None, None] + slopes / (2 * np.pi)) / self.step
        found[:, :, self.holes] = np.nan
        return found

    @cached_property
    def spread(self) -> np.ndarray:
        """Standard deviation of the coframe from noise, along x or y, spread[i, x, y].

        Equation
        --------
        Noise s of a wave of amplitude A changes its phase by s / (sqrt(2) A). The slope of this
        phase noise is 1 / (sqrt(2) r) times as large for a Gaussian of standard deviation r.
        """
        slope = 1 / (2 * self.blur * np.maximum(self.ratio, TINY))
        return slope / (2 * np.pi * self.step)

    @cached_property
    def distortion(self) -> np.ndarray:
        """beta^a_mu = d_mu u^a in x and y, distortion[a, mu, x, y], relative to the reference.

        NaN in holes. `strain` is its symmetric part, `rotation` its antisymmetric part.
        """
        unit = np.eye(2)[:, :, None, None]
        return unit - np.einsum("ia,imxy->amxy", self.lattice, self.coframe)

    @property
    def strain(self) -> np.ndarray:
        """Symmetric part of the distortion, strain[a, mu, x, y]."""
        return (self.distortion + self.distortion.swapaxes(0, 1)) / 2

    @property
    def rotation(self) -> np.ndarray:
        """Anticlockwise rotation of the lattice, in radians, rotation[x, y]."""
        return (self.distortion[1, 0] - self.distortion[0, 1]) / 2

    @property
    def margin(self) -> int:
        """Pixels at each border whose averages reach beyond the border; `sampled` omits them."""
        # A pixel closer to the border than half the reach loses more than 2 % of its average.
        return int(np.ceil(_reach(self.blur) / 2))

    def sampled(self, order: int = 4, *, lengths: bool = False) -> SampledFrame:
        """The coframe as a sampled frame without the margin: maps, loops, Nye tensor.

        The frame has the holes of the phases, and its sigma is their noise. This noise is
        correlated over the resolution, and it is a gradient, whose circuit integrals vanish.
        Therefore sigma is correct for single values and strains; for circuits it is an upper bound,
        far above the scatter.

        Parameters
        ----------
        lengths
            Return 1 - beta, in units of length along x and y, instead of lattice coordinates.

        Raises
        ------
        GridError
            The margins cover the whole image.
        """
        checks.count(order, "order", GridError, 2)
        sizes = self.waves.shape[1:]
        if 2 * self.margin + order >= min(sizes):
            raise GridError(
                f"image: expected more than {2 * self.margin + order} pixels along each axis, "
                f"because its margins are {self.margin} pixels wide, got {sizes[0]} x {sizes[1]}. "
                f"Choose a finer resolution than {self.resolution:.3g} {self.unit}."
            )
        keep = slice(self.margin, -self.margin)
        values = np.eye(2)[:, :, None, None] - self.distortion if lengths else self.coframe
        axes = [self.step * np.arange(n)[keep] for n in sizes]
        sigma = np.where(self.holes, 0.0, self.spread)
        if lengths:
            parts = np.einsum("ia,ixy->axy", self.lattice**2, sigma**2)
            sigma = np.sqrt(parts)
        sigma = np.broadcast_to(sigma[:, None], values.shape)
        description = f"phases of an image, averaged over {self.resolution:.3g} {self.unit}"
        return SampledFrame(
            axes, values[:, :, keep, keep], order, unit=self.unit, sigma=sigma[..., keep, keep],
            vector_unit=self.unit if lengths else "lattice vectors", source=description,
        )  # fmt: skip

    # -- whole numbers ----------------------------------------------------------------------------

    def burgers(self, loop: Loop, risk: float = 0.05) -> LatticeBurgers:
        """Burgers vector of a circuit: the whole number of turns of each phase along it.

        The circuit goes around holes without a Burgers vector, which change no whole number.

        Parameters
        ----------
        loop
            In x and y of the image, in its units.
        risk
            Largest accepted chance that noise has changed the result. The estimated chance is
            rather too large than too small.

        Raises
        ------
        ImageError
            The circuit leaves the image, crosses a hole that it cannot go around, or the noise is
            too strong; the message names the position.
        """
        limit = checks.positive(risk, "risk", ImageError)
        path = pixel_path(loop, self.step, self.waves.shape[1:], self.unit)
        path, detour = detoured(path, self._rings, self.step, self.unit)
        x, y = path.T
        whole, steps = wound(self.phase[:, x, y])
        ratio = self.ratio[:, x, y]
        chance = min(1.0, float(expected_clicks(ratio, steps, self.blur, 1).sum()))
        weakest = path[int(ratio.min(axis=0).argmin())]
        if chance > limit:
            raise ImageError(
                "the noise is too strong for this circuit: the probability of a wrong whole number "
                f"is {chance:.2g}, above the accepted risk of {limit:.2g}. Avoid the "
                f"weakest part of the lattice at {self._place(weakest)}, shorten the circuit, or "
                f"give a larger resolution than {self.resolution:.3g}."
            )
        error = float(np.abs(whole) @ np.hypot(*self.lattice.T) * self.doubt)
        low = (self.step * weakest).tolist()
        vector = whole @ self.lattice
        return LatticeBurgers(
            vector=vector,
            unit=self.unit,
            systematic={"lattice vectors": error},
            whole=whole,
            lattice=self.lattice,
            chance=chance,
            name=loop.name or "loop",
            path=self.step * path.T,
            area=enclosed(path) * self.step**2,
            arrow=vector,
            detour=detour,
            components=COMPONENTS,
            length_unit=self.unit,
            pixels=path,
            weakest=(low[0], low[1]),
        )

    @cached_property
    def _rings(self) -> Rings:
        """Rings around the holes without a Burgers vector."""
        return rings_of(self.phase, self.holes)

    def burgers_map(
        self, size: int, plane: tuple[int, int] = (0, 1), *, risk: float = 0.05
    ) -> Survey:
        """Burgers vectors of the square circuits of size x size pixels at all positions.

        The survey has the same whole numbers as `burgers` for each circuit, and b along x and y.
        The cost does not depend on the size. risk: as for `burgers`; b is unknown if the chance of
        a wrong number is larger, or if the circuit touches a hole.

        Raises
        ------
        ImageError
            The size is below 2 or larger than the image, or the plane is not x and y.
        """
        if not checks.is_list(plane) or tuple(plane) != (0, 1):
            raise ImageError(
                f"plane: expected (0, 1), the only plane of an image, got {checks.shown(plane)}. "
                "Omit the option."
            )
        n = checks.count(size, "size", ImageError, 2, min(self.waves.shape[1:]) - 1)
        limit = checks.positive(risk, "risk", ImageError)
        whole, passages, chances = squares_of(self.phase, self.ratio, self._rings, self.blur, n)
        chance = np.minimum(chances.sum(axis=0), 1.0)
        vectors = np.einsum("ia,ixy->axy", self.lattice, whole)
        vectors[:, passages.refused | (chance > limit)] = np.nan
        steps = (self.step, self.step)
        return Survey(
            vectors,
            middles((0.0, 0.0), steps, chance.shape, (n, n)),
            areas(self.step**2, (n, n), passages),
            (n, n),
            partial(self._errors, whole, chances),
            self.names,
            components=COMPONENTS,
            unit=self.unit,
            vector_unit=self.unit,
            missing="touch a hole, or noise may change their numbers",
            whole=whole,
            passages=passages.count,
        )

    def _errors(self, whole: np.ndarray, chances: np.ndarray) -> Errors:
        """Errors of whole numbers, each with the chance that noise changed it, shape (2, x, y)."""
        # Noise that changes a number adds a lattice vector. The error of the lattice vectors comes
        # from the spots, which are located to a third of a pixel of the transform.
        table = np.einsum("ia,ib,ixy->abxy", self.lattice, self.lattice, chances)
        covariance = {(a, b): table[a, b] for a, b in ((0, 0), (0, 1), (1, 1))}
        lengths = np.hypot(*self.lattice.T)
        doubt = self.doubt * np.einsum("i,ixy->xy", lengths, np.abs(whole))
        return Errors(covariance, doubt, np.minimum(chances.sum(axis=0), 1.0))

    # -- as a source ------------------------------------------------------------------------------

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the axes."""
        return ("x", "y")

    @property
    def description(self) -> tuple[str, ...]:
        """Lines of text about the image, its lattice, and its holes."""
        columns, rows = self.picture.shape
        vectors = ", ".join(f"({x:.4g}, {y:.4g})" for x, y in self.lattice.tolist())
        strength = self.levels / np.median(self.noise, axis=(1, 2))
        return (
            f"LatticeImage({columns} x {rows} pixels{of_size(self.step, self.unit)})",
            f"lattice vectors {vectors} {self.unit}, averaged over {self.resolution:.3g}",
            (
                f"amplitudes {strength[0]:.3g} and {strength[1]:.3g} times their noise; holes: "
                f"{float(self.holes.mean()):.1%} of the pixels"
            ),
        )

    def backdrop(self, section: Section = PLANE) -> Backdrop:
        """The image itself, which has one plane."""
        x, y = (self.step * np.arange(n) for n in self.picture.shape)
        return Backdrop((x, y), self.picture, "image", "image and circuits")

    def _place(self, pixel: np.ndarray) -> str:
        """Position of a pixel, for messages."""
        x, y = (self.step * pixel).tolist()
        return f"({x:.6g}, {y:.6g}) {self.unit}"

    @cached_property
    def cochain(self) -> Cochain:
        """Whole turns of both phases along each step from pixel to pixel, as a cochain.

        Its coboundary is the discrete torsion, which is nonzero on the faces that contain a core.
        """
        values = np.concatenate([x.reshape(2, -1).T for x in whole_turns(self.phase)])
        return Cochain(Complex.grid(self.phase.shape[1:]), values)

    @cached_property
    def residues(self) -> np.ndarray:
        """Burgers vector of each square of four pixels, whole numbers, residues[i, x, y]."""
        along_x, along_y = whole_turns(self.phase)
        return np.diff(along_y, axis=1) - np.diff(along_x, axis=2)

    def __repr__(self) -> str:
        lengths = ", ".join(f"{x:.4g}" for x in np.hypot(*self.lattice.T))
        return (
            f"LatticePhases(lattice vectors of {lengths} {self.unit}, resolution "
            f"{self.resolution:.3g} {self.unit})"
        )


def lattice_phases(
    field: np.ndarray, step: float, unit: str, spots: Spots, blur: float | None
) -> LatticePhases:
    """Filter an image around two spots; see LatticeImage.phases."""
    if blur is None:
        blur = _resolution(spots, min(field.shape))
    # Zeros beyond the border separate opposite sides in the periodic transform.
    padded = [scipy.fft.next_fast_len(n + int(_reach(blur))) for n in field.shape]
    spectrum = scipy.fft.fft2(field - field.mean(), padded)
    borders = [_inside(n, blur) for n in field.shape]
    lines = [scipy.fft.fftfreq(n) for n in padded]
    waves = np.empty((2, *field.shape), dtype=complex)
    for wave, vector in zip(waves, spots.vectors, strict=True):
        masks = []
        for k, g in zip(lines, vector, strict=True):
            # Frequencies are periodic along each axis.
            away = (k - g + 0.5) % 1.0 - 0.5
            masks.append(np.exp(-2 * (np.pi * blur * away) ** 2))
        found = scipy.fft.ifft2(spectrum * np.multiply.outer(*masks), overwrite_x=True)
        ramps = [
            np.exp(-2j * np.pi * g * np.arange(n)) / share
            for g, n, share in zip(vector, field.shape, borders, strict=True)
        ]
        wave[:] = found[: field.shape[0], : field.shape[1]] * np.multiply.outer(*ramps)
    if not np.abs(waves).max(axis=(1, 2)).all():
        raise ImageError(
            "spots: expected spots of the lattice, got one without power in the image. Choose "
            "other spots, or omit them."
        )
    return LatticePhases(step, unit, spots, blur, waves, (borders[0], borders[1]), field)


def _reach(blur: float, deviations: float = 4.0) -> float:
    """Distance at which a Gaussian is cut off."""
    return deviations * blur


def _inside(count: int, blur: float) -> np.ndarray:
    """Share of a Gaussian around each of `count` pixels that is within these pixels."""
    reach = int(np.ceil(_reach(blur)))
    weights = np.exp(-((np.arange(-reach, reach + 1) / blur) ** 2) / 2)
    every = np.concatenate([[0.0], np.cumsum(weights / weights.sum())])
    place = np.arange(count)
    above = every[np.minimum(reach + count - place, 2 * reach + 1)]
    return above - every[np.maximum(reach - place, 0)]


def _resolution(spots: Spots, size: int, clear: float = 5.0, coarsest: float = 1 / 12) -> float:
    """One lattice spacing, or more if the amplitudes would not be clear of the noise.

    clear: ratio of amplitude to noise above which noise adds no turn to a phase (less than once in
    a million resolutions). coarsest: largest resolution as a share of the image, because circuits
    need space.
    """
    spacing = 1.0 / float(np.hypot(*spots.vectors.T).min())
    # The lower bound avoids an infinite resolution for a spot without power.
    weakest = np.maximum(spots.amplitudes, spots.noise / size)
    ratio = float((spots.noise / np.maximum(weakest, TINY)).max())
    needed = clear * ratio / np.sqrt(4 * np.pi)
    return min(max(spacing, needed), max(spacing, size * coarsest))
