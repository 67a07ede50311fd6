"""Spots: the Bragg spots of an image, and the noise around them, from its power spectrum."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
import scipy  # loads its subpackages at first use

from geomtorsion.errors import ImageError


@dataclass(frozen=True, eq=False)
class Spots:
    """Two Bragg spots that span the reciprocal lattice.

    vectors: g_1 and g_2 in cycles per pixel, rows, shape (2, 2); the turn from g_1 to g_2 is
        anticlockwise, and g_1 is closer to the x axis.
    amplitudes: of exp(2 pi i g x) in the image, shape (2,).
    noise: standard deviation per pixel of white noise with the power measured around each spot.
    """

    vectors: np.ndarray
    amplitudes: np.ndarray
    noise: np.ndarray


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Power of an image under a Hann window, in units of white noise of variance one.

    power: shape (N_x, N_y); x, y: frequencies of rows and columns in cycles per pixel.
    smoothing: standard deviation of the Gaussian that smooths the power, in pixels of the
        transform, because a dislocation splits a spot into a ring of about one pixel.
    periods: least number of periods of a spot across the smaller side of the image, because fewer
        periods do not define a phase.
    """

    power: np.ndarray
    x: np.ndarray
    y: np.ndarray
    smoothing: float = 1.5
    periods: int = 6

    @classmethod
    def of(cls, field: np.ndarray) -> Spectrum:
        """The spectrum of a field, with a window that suppresses the borders."""
        window = np.multiply.outer(*(_taper(n) for n in field.shape))
        mean = (window * field).sum() / window.sum()
        transform = scipy.fft.fft2(window * (field - mean), workers=1)
        power = (transform.real**2 + transform.imag**2) / (window**2).sum()
        return cls(power, scipy.fft.fftfreq(field.shape[0]), scipy.fft.fftfreq(field.shape[1]))

    def around(self, place: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Power near a frequency, and the offsets from the frequency along both axes.

        reach: largest offset, in pixels of the larger axis. Frequencies are periodic along each
        axis.
        """
        size = np.array(self.power.shape)
        centre = np.round(place * size).astype(int)
        half = np.maximum(2, np.ceil(reach * size / size.max())).astype(int)
        half = np.minimum(half, (size - 1) // 2)
        lines = [c + np.arange(-h, h + 1) for c, h in zip(centre, half, strict=True)]
        block = self.power[np.ix_(lines[0] % size[0], lines[1] % size[1])]
        dx, dy = lines[0] / size[0] - place[0], lines[1] / size[1] - place[1]
        return block, dx[:, None], dy[None, :]

    @property
    def pixel(self) -> float:
        """The smaller side of a pixel of the transform, in cycles per pixel of the image."""
        return 1.0 / max(self.power.shape)


def _taper(count: int) -> np.ndarray:
    """A window that falls to zero over a quarter of its length at each end."""
    return scipy.signal.windows.tukey(count, 0.5, sym=False)


def find_spots(field: np.ndarray, false_alarm: float = 1e-4) -> Spots:
    """The two Bragg spots of an image that span its lattice, each to a third of a pixel.

    A spot exceeds its surroundings by more than the maximum of noise over the image, except with
    probability `false_alarm`. The result is the strongest pair whose whole multiples include all
    other spots.

    Raises
    ------
    ImageError
        No spot exceeds the noise, all spots are in one direction, or they come from edges.
    """
    spectrum = Spectrum.of(field)
    places, strengths = _significant(spectrum, false_alarm)
    if not len(places):
        raise ImageError(
            "the image has no visible lattice: no spot of its Fourier transform rises above the "
            "background. Give a larger part of the image, or spots=[[x, y], [x, y]]."
        )
    places = np.array([refined(spectrum, place) for place in places])
    covering = np.array([_covers(field, place) for place in places])
    places, strengths = places[covering], strengths[covering]
    if not len(places):
        raise ImageError(
            "the image has no visible lattice: its strongest spots come from edges or blots, not "
            "from a periodic pattern. Cut out the part with the lattice."
        )
    pair = _basis(places, strengths, spectrum.pixel)
    if pair is None:
        k = places[0]
        raise ImageError(
            "image: expected a lattice with spots in two directions, got fringes in one direction, "
            f"{1 / np.hypot(*k):.3g} pixels apart. Tilt the specimen to a zone axis, or give "
            "spots=[[x, y], [x, y]]."
        )
    return measured(spectrum, ordered(places[list(pair)]))


def ordered(pair: np.ndarray) -> np.ndarray:
    """The two spots with signs and order that do not depend on their strengths."""
    turned = np.array([g if (g[0] > 0 or (g[0] == 0 and g[1] > 0)) else -g for g in pair])
    slopes = np.abs(np.arctan2(turned[:, 1], turned[:, 0]))
    first, second = turned[np.argsort(slopes, kind="stable")]
    cross = first[0] * second[1] - first[1] * second[0]
    return np.array([first, second if cross > 0 else -second])


def measured(spectrum: Spectrum, pair: np.ndarray) -> Spots:
    """Amplitudes of two spots, and the noise in the ring halfway to other spots."""
    amplitudes, noise = np.empty(2), np.empty(2)
    shortest = float(np.hypot(*pair.T).min())
    for k, place in enumerate(pair):
        reach = shortest / 2 / spectrum.pixel
        block, dx, dy = spectrum.around(place, reach)
        distance = np.hypot(dx, dy)
        ring = (distance < shortest / 2) & (distance > shortest / 4)
        # The power of noise has an exponential distribution, with median ln 2 times its mean.
        variance = float(np.median(block[ring])) / np.log(2) if ring.any() else 0.0
        inside = distance < min(shortest / 4, 4 * spectrum.smoothing * spectrum.pixel)
        power = block[inside].sum() - variance * inside.sum()
        # By Parseval's theorem, the power under the window is A^2 times the number of pixels.
        amplitudes[k] = np.sqrt(max(power, 0.0) / spectrum.power.size)
        noise[k] = np.sqrt(variance)
    return Spots(pair, amplitudes, noise)


def refined(spectrum: Spectrum, place: np.ndarray) -> np.ndarray:
    """The centroid of a spot, in a Gaussian window that follows it.

    The centroid is the mean gradient of the phase. A dislocation splits a spot but does not shift
    its centroid.
    """
    reach = 4 * spectrum.smoothing
    width = spectrum.smoothing * spectrum.pixel
    for _ in range(50):
        block, dx, dy = spectrum.around(place, reach)
        weight = np.exp(-(dx**2 + dy**2) / (2 * width**2)) * block
        total = weight.sum()
        step = np.array([(weight * dx).sum(), (weight * dy).sum()]) / total
        place = place + step
        if np.abs(step).max() < 1e-4 * spectrum.pixel:
            break
    return place


def _significant(
    spectrum: Spectrum, false_alarm: float, candidates: int = 16
) -> tuple[np.ndarray, np.ndarray]:
    """Spots in half of the frequency plane, and their power over the noise, strongest first.

    candidates: number of spots to examine, enough for the first orders of any lattice.
    """
    power = scipy.ndimage.gaussian_filter(spectrum.power, spectrum.smoothing, mode="wrap")
    kx, ky = spectrum.x[:, None], spectrum.y[None, :]
    least = spectrum.periods / min(power.shape)
    half = (kx > 0) | ((kx == 0) & (ky > 0))
    reach = int(np.ceil(3 * spectrum.smoothing))
    peak = scipy.ndimage.maximum_filter(power, 2 * reach + 1, mode="wrap") == power
    places = np.argwhere(peak & half & (np.hypot(kx, ky) > least))
    ranked = places[np.argsort(-power[tuple(places.T)], kind="stable")][: 4 * candidates]
    limit = _threshold(power.size, spectrum.smoothing, false_alarm)
    radii = np.hypot(kx, ky).ravel()
    # Sort frequencies into rings of one pixel, so that each spot examines only the nearest rings.
    rings = (radii / spectrum.pixel).astype(np.min_scalar_type(max(power.shape)))
    order = np.argsort(rings, kind="stable")
    ends = np.concatenate([[0, 0], np.cumsum(np.bincount(rings)), [len(radii)]])
    spots, strengths = [], []
    for i, j in ranked.tolist():
        place = np.array([spectrum.x[i], spectrum.y[j]])
        block, dx, dy = spectrum.around(place, 4 * reach)
        distance = np.hypot(dx, dy) / spectrum.pixel
        ring = (distance > 2 * reach) & (distance < 4 * reach)
        # A glass scatters equally in all directions: its spots are speckle on a ring.
        radius = float(np.hypot(*place))
        number = int(radius / spectrum.pixel)
        near = order[ends[number] : ends[number + 3]]
        same = spectrum.power.ravel()[near[np.abs(radii[near] - radius) < spectrum.pixel]]
        noise = max(float(np.median(x)) for x in (block[ring], same)) / np.log(2)
        if power[i, j] > limit * noise:
            spots.append(place)
            strengths.append(power[i, j] - noise)
    return np.array(spots[:candidates]), np.array(strengths[:candidates])


def _threshold(count: int, smoothing: float, false_alarm: float) -> float:
    """The level that smoothed noise of mean one exceeds anywhere with chance `false_alarm`.

    A weighted sum of powers nearly has a gamma distribution; the window correlates neighbours.

    count: number of frequencies.
    """
    weights = np.zeros(33)
    weights[16] = 1.0
    weights = scipy.ndimage.gaussian_filter1d(weights, smoothing)
    energy = np.abs(scipy.fft.fft(_taper(1024) ** 2)) ** 2
    correlation = np.roll(energy / energy[0], 8)[:17]
    variance = float(weights @ np.convolve(weights, correlation, mode="same")) ** 2
    shape = 1.0 / variance
    return float(scipy.special.gammainccinv(shape, false_alarm / count) / shape)


def _covers(field: np.ndarray, place: np.ndarray, covered: float = 0.2) -> bool:
    """Whether the wave of a spot extends over the whole image, by the participation ratio.

    covered: the ratio below which the spot comes from edges.
    """
    blur = max(2.0 / float(np.hypot(*place)), 2.0)
    waves = [
        np.exp(-2j * np.pi * k * np.arange(n)) for k, n in zip(place, field.shape, strict=True)
    ]
    envelope = (field - field.mean()) * np.multiply.outer(*waves)
    every = max(1, int(blur / 2))
    # Means over blocks are sufficient to locate the source of the spot.
    shape = [n // every for n in field.shape]
    envelope = envelope[: shape[0] * every, : shape[1] * every]
    envelope = envelope.reshape(shape[0], every, shape[1], every).mean(axis=(1, 3))
    smooth = scipy.ndimage.gaussian_filter(envelope, blur / every, mode="constant")
    power = smooth.real**2 + smooth.imag**2
    return bool(power.mean() ** 2 >= covered * (power**2).mean())


def _basis(
    places: np.ndarray,
    strengths: np.ndarray,
    pixel: float,
    *,
    collinear: float = 0.17,
    orders: int = 4,
    belonging: float = 0.5,
) -> tuple[int, int] | None:
    """The strongest pair among the pairs that span most of the spots; None if there is no pair.

    collinear: sine of the angle, 10 degrees, below which two spots do not span a lattice.
    orders: largest multiple of the pair that can describe another spot.
    belonging: least share of the power of all spots that belongs to one lattice.

    Raises
    ------
    ImageError
        No pair spans the larger part of the spots, such as for the ring of speckle of a glass.
    """
    harmonic = _harmonics(places, strengths, pixel)
    pairs, spanned = [], []
    for a, b in combinations(range(len(places)), 2):
        first, second = places[a], places[b]
        cross = first[0] * second[1] - first[1] * second[0]
        parallel = abs(cross) < collinear * np.hypot(*first) * np.hypot(*second)
        if parallel or harmonic[a] or harmonic[b]:
            continue
        basis = places[[a, b]]
        multiples = np.round(places @ np.linalg.inv(basis))
        rest = multiples @ basis - places
        slack = pixel * np.maximum(1, np.abs(multiples).sum(axis=1) / 2)
        near = (np.hypot(*rest.T) < slack) & (np.abs(multiples).max(axis=1) <= orders)
        pairs.append((a, b))
        spanned.append(strengths[near].sum() / strengths.sum())
    if not pairs:
        return None
    if max(spanned) < belonging:
        raise ImageError(
            "the image has no visible lattice: the spots of its Fourier transform do not belong to "
            "one lattice. Cut out a part with one lattice, or give spots=[[x, y], [x, y]]."
        )
    # Ignore weak spots off the lattice, which come from defects.
    best = [p for p, share in zip(pairs, spanned, strict=True) if share > 0.98 * max(spanned)]
    return max(best, key=lambda pair: (min(strengths[list(pair)]), -sum(pair)))


def _harmonics(
    places: np.ndarray, strengths: np.ndarray, pixel: float, harmonics: int = 12
) -> np.ndarray:
    """Whether each spot is a harmonic of the strongest spot, possibly aliased.

    harmonics: largest order of harmonics, which sharp fringes have and which do not give a second
    direction. Their power falls with the square of the order; fainter spots are ignored.
    """
    orders = np.arange(-harmonics, harmonics + 1)[:, None]
    orders = orders[np.abs(orders[:, 0]) > 1]
    first = int(strengths.argmax())
    rest = places[:, None] - orders * places[first]
    rest -= np.round(rest)
    near = np.hypot(rest[..., 0], rest[..., 1]) < pixel * np.abs(orders[:, 0]) / 2
    # The factor 2 allows for the error of a measured power.
    weak = strengths[:, None] * orders[:, 0] ** 2 < 2 * strengths[first]
    faint = strengths * harmonics**2 < strengths[first]
    return (near & weak).any(axis=1) | faint
