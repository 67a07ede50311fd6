"""Spots: found to a third of a pixel of the transform, and refused where there is no lattice."""

from functools import cache

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import ImageError
from tests.chosen import one_in
from tests.materials.images.atoms import crystal

made = cache(crystal)


def distance(found: np.ndarray, known: np.ndarray, size: int) -> float:
    """Largest distance in pixels from combinations of the known vectors, which must be a basis."""
    multiples = np.round(found @ np.linalg.inv(known))
    assert abs(round(np.linalg.det(multiples))) == 1
    return float(np.hypot(*(found - multiples @ known).T).max()) * size


@pytest.mark.parametrize(
    ("kind", "size", "dislocated"), one_in(2, ("square", "hexagonal"), (256, 512), (False, True))
)
def test_spots_are_found_to_a_third_of_a_pixel(kind, size, dislocated):
    """With and without a dislocation, which splits a spot, the spots are a basis of the lattice."""
    image = made(size, kind, dislocated=dislocated)
    for seed in range(3):
        found = gt.LatticeImage(image.noisy(0.5, seed)).spots.vectors
        assert distance(found, image.vectors, size) < 1 / 3
        assert np.linalg.det(found) > 0


@pytest.mark.parametrize("turned", [-1.3, -0.4, 0.0, 0.7, 1.5])
def test_spots_do_not_depend_on_the_orientation(turned):
    """Checked for several directions and a spacing that is not a whole number of pixels."""
    image = crystal(200, "hexagonal", 9.37, turned, dislocated=False)
    assert distance(gt.LatticeImage(image.values).spots.vectors, image.vectors, 200) < 0.1


def test_oblong_images_have_their_spots_where_they_are():
    """The pixels of the transform of an oblong image are not square."""
    part = made(512, "square").values[:160]
    found = gt.LatticeImage(part).spots.vectors
    assert distance(found, made(512, "square").vectors, 160) < 1 / 3


def test_the_whole_lattice_is_spanned():
    """Strong diagonal spots span a sublattice of double area; weak spots span the lattice."""
    y, x = np.mgrid[200:0:-1, 0:200] / 10.0
    one, two = 2 * np.pi * (x + y), 2 * np.pi * (x - y)
    weak = np.cos(2 * np.pi * x) + np.cos(2 * np.pi * y)
    found = gt.LatticeImage(np.cos(one) + np.cos(two) + weak / 3).spots.vectors
    assert abs(np.linalg.det(found)) == pytest.approx(0.01, rel=1e-2)


def test_noise_and_amplitude_agree_with_the_image():
    """White noise of 0.5 and the amplitudes of the waves are estimated."""
    y, x = np.mgrid[256:0:-1, 0:256]
    waves = 0.6 * np.cos(2 * np.pi * x / 8) + 0.4 * np.cos(2 * np.pi * y / 7)
    image = gt.LatticeImage(waves + 0.5 * np.random.default_rng(0).normal(size=x.shape))
    assert image.spots.noise == pytest.approx([0.5, 0.5], rel=0.05)
    assert image.spots.amplitudes == pytest.approx([0.3, 0.2], rel=0.03)


def without_lattice() -> dict[str, np.ndarray]:
    """Images of other things, by name."""
    size = 200
    y, x = np.mgrid[:size, :size] / size
    noise = np.random.default_rng(3).normal(size=(size, size))
    k = np.hypot(np.fft.fftfreq(size)[:, None], np.fft.fftfreq(size)[None])
    k[0, 0] = 1
    glass = np.fft.fft2(noise) * np.exp(-(((k - 0.12) / 0.01) ** 2))
    return {
        "noise": noise,
        "clouds": np.fft.ifft2(np.fft.fft2(noise) / k).real,
        "a glass": np.fft.ifft2(glass).real,
        "a ramp": x + 2 * y,
        "an edge": (x > 0.43).astype(float),
        "a disc": (np.hypot(x - 0.5, y - 0.4) < 0.2).astype(float),
        "a spot": np.exp(-((x - 0.5) ** 2 + (y - 0.5) ** 2) / 0.01),
        "rings": np.cos(60 * np.pi * np.hypot(x - 0.5, y - 0.5)),
    }


@pytest.mark.parametrize("name", without_lattice())
def test_an_image_without_lattice_is_refused(name):
    """Noise, clouds, glass, edges, blots and rings are refused."""
    image = gt.LatticeImage(without_lattice()[name])
    with pytest.raises(ImageError, match="the image has no visible lattice"):
        image.phases()


@pytest.mark.parametrize("sharp", [False, True])
def test_fringes_are_refused(sharp):
    """Fringes in one direction are refused, also with harmonics folded back by aliasing."""
    y, x = np.mgrid[:200, :200]
    fringes = np.cos(2 * np.pi * (x + 0.3 * y) / 9.0)
    noise = 0.1 * np.random.default_rng(0).normal(size=x.shape)
    image = gt.LatticeImage((np.sign(fringes) if sharp else fringes) + noise)
    with pytest.raises(ImageError, match="got fringes in one direction, 8.62 pixels apart"):
        image.phases()


def test_noise_is_hardly_ever_taken_for_a_lattice():
    """None of two hundred noise images is accepted; the rule accepts one in 10,000."""
    for seed in range(200):
        noise = np.random.default_rng(seed).normal(size=(64, 64))
        with pytest.raises(ImageError, match="no visible lattice"):
            gt.LatticeImage(noise).phases()
