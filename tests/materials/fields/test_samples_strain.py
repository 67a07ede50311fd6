"""Strain and rotation: distortions from results of diffraction."""

import numpy as np
import pytest

from geomtorsion.errors import GridError
from geomtorsion.loops import Loop
from geomtorsion.materials.fields import SampledFrame
from tests.loops.edge_dislocation import distortion
from tests.rounding import ROUNDED

AXIS = np.linspace(-2, 2, 50)
X, Y = np.meshgrid(AXIS, AXIS, indexing="ij")
R2, B = X**2 + Y**2, 0.25


def test_strain_and_rotation_of_an_edge_dislocation():
    """Strain and rotation recombine to the distortion, and b around the masked core is right."""
    beta, core = distortion(X, Y, B), R2 < 0.2
    strain, rotation = (beta + beta.swapaxes(0, 1)) / 2, (beta - beta.swapaxes(0, 1)) / 2
    for turned in (rotation, rotation[1, 0]):
        grid = SampledFrame.from_strain_rotation([AXIS, AXIS], strain, turned, mask=core)
        assert np.nanmax(np.abs(grid.coframe - np.eye(2)[:, :, None, None] - beta)) < ROUNDED
        found = grid.burgers(Loop.circle([0, 0], 1.5))
        assert np.abs(found.vector - [B, 0]).max() <= found.error < 1e-3


def test_rotations_of_space():
    """The vector w rotates by u = w x r: it gives the same three columns as its matrix."""
    w = np.array([X / 10, Y / 20, X * Y / 30])
    eps = np.zeros((3, 3, 3))
    eps[0, 1, 2] = eps[1, 2, 0] = eps[2, 0, 1] = 1
    eps -= eps.swapaxes(0, 1)
    matrix = -np.einsum("ijk,k...->ij...", eps, w)
    none = np.zeros((3, 3, *X.shape))
    one, two = (
        SampledFrame.from_strain_rotation([AXIS, AXIS], none, turned) for turned in (w, matrix)
    )
    assert (one.coframe == two.coframe).all()
    # u = w x r with w along z: u_x = - w y, so d_y u_x = - w.
    assert (one.coframe[0, 1] == -w[2]).all()
    assert one.rows == 3


NONE = np.zeros((2, 2, *X.shape))
ODD = NONE.copy()
ODD[0, 1, 3, 4] = 0.5


@pytest.mark.parametrize(
    ("strain", "rotation", "message"),
    [
        (ODD, X, r"strain: expected symmetric matrices, got \[0, 1\] = 0.5 .* at node \(3, 4\)"),
        (NONE, ODD, r"rotation: expected antisymmetric matrices, .* node \(3, 4\)"),
        (X, X, "strain: expected shape"),
        (
            NONE,
            X[:4],
            r"rotation: expected shape \(2, 2, 50, 50\) \(matrix\) or \(50, 50\) \(angle\)",
        ),
        (np.zeros((3, 3, 50, 50)), X, r"or \(3, 50, 50\) \(vector\)"),
    ],
)
def test_invalid_tables_are_refused(strain, rotation, message):
    """Each wrong table has its own message."""
    with pytest.raises(GridError, match=message):
        SampledFrame.from_strain_rotation([AXIS, AXIS], strain, rotation)
