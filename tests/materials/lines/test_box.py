"""Boxes: volume, nearest images, and refused boxes."""

# The tests pass what users pass, including wrong types, and read optional values.
# pyright: reportArgumentType=false

import numpy as np
import pytest

from geomtorsion.errors import NetworkError
from geomtorsion.materials.lines import Box


def test_volume_and_images_of_a_skew_box():
    """The images make each step shortest; open edges have no images."""
    box = Box([[4, 0, 0], [1, 4, 0], [0, 1, 4]], periodic=(True, True, False))
    assert box.volume == 64
    rng = np.random.default_rng(2)
    near = rng.uniform(-0.4, 0.4, (50, 3)) @ box.vectors
    shifts = np.column_stack([rng.integers(-9, 9, (50, 2)), np.zeros(50, int)])
    assert (box.images(near + shifts @ box.vectors) == -shifts).all()
    assert box.images([[0, 0, 400]]).tolist()[0][2] == 0


def test_bad_boxes_are_refused():
    """Flat and infinite boxes, wrong shapes and flags, and positions in other units are refused."""
    for call, message in (
        (lambda: Box([[1, 0, 0], [0, 1, 0], [1, 1, 0]]), "span a finite volume"),
        (lambda: Box(1e200 * np.eye(3)), r"vectors of the box\[0\]: expected lengths between"),
        (lambda: Box([[1, 0], [0, 1]]), r"shape \(3, 3\)"),
        (lambda: Box(np.eye(3), periodic=(1, 2, 0)), "expected 3 truth values"),
        (lambda: Box(np.eye(3), periodic="yes"), "periodic"),
        (lambda: Box.of_bounds([0, 0, 0], [1, 1, 0]), "expected a highest corner above the lowest"),
        (lambda: Box.of_bounds([0, 0, float("nan")], [1, 1, 1]), "not finite"),
        (lambda: Box(np.eye(3)).images([[1e30, 0, 0]]), "same units"),
    ):
        with pytest.raises(NetworkError, match=message):
            call()
