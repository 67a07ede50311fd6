"""LatticeImage: accepted and refused arrays."""

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import ImageError


def test_coordinates_run_to_the_right_and_upwards():
    """The first row is at the top; axes are in units of length."""
    values = np.arange(40 * 50, dtype=float).reshape(40, 50)
    image = gt.LatticeImage(values, step=0.5, unit="nm")
    assert image.field[0, 0] == values[39, 0]
    assert image.field[3, 39] == values[0, 3]
    assert [len(axis) for axis in image.axes] == [50, 40]
    assert image.axes[0][-1] == 24.5
    assert repr(image) == "LatticeImage(50 x 40 pixels of 0.5 nm)"


@pytest.mark.parametrize(
    ("values", "match"),
    [
        (np.zeros((64, 64)), "no lattice: all its values are equal"),
        (np.full((64, 64), 0.1), "no lattice: all its values are equal"),
        (np.ones((64, 64, 3)), r"expected an array of grey values, got shape \(64, 64, 3\)"),
        (np.ones((8, 64)), "expected 32 rows and columns or more"),
        (np.ones((64, 64)) * 1j, "expected an array of grey values"),
        ("image.tif", "expected an array of grey values"),
        ([[1, 2], [3]], "expected an array of grey values"),
        (np.where(np.eye(64) > 0, np.nan, 1.0), r"image\[0, 0\] = nan is not finite"),
        (np.eye(64) * 1e200, r"image: expected lengths between 1e-70 and 1e\+70, got 1e\+200"),
        (np.eye(64) * 1e-200, r"image: expected lengths between 1e-70 and 1e\+70"),
        (np.ma.masked_less(np.eye(64), 0.5), "got masked pixels"),
        (None, "expected an array of grey values"),
    ],
)
def test_arrays_that_are_not_images_are_refused(values, match):
    """The error states what the image needs."""
    with pytest.raises(ImageError, match=match):
        gt.LatticeImage(values)


@pytest.mark.parametrize("step", [0, -1, np.nan, "1", 1e-300, 1e300])
def test_invalid_steps_are_refused(step):
    """The size of a pixel is a positive number of ordinary magnitude."""
    with pytest.raises(ImageError, match="step"):
        gt.LatticeImage(np.eye(64), step)
