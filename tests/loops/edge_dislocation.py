"""Edge dislocation: its displacement and its distortion, in an isotropic solid."""

import numpy as np

NU = 0.3


def displacement(x: np.ndarray, y: np.ndarray, b: float) -> np.ndarray:
    """u of an edge dislocation [HirthLothe1982], (3-45); its cut is y = 0, x < 0."""
    r2 = x**2 + y**2
    u = np.arctan2(y, x) + x * y / (2 * (1 - NU) * r2)
    v = -((1 - 2 * NU) / (4 * (1 - NU)) * np.log(r2) + (x**2 - y**2) / (4 * (1 - NU) * r2))
    return b / (2 * np.pi) * np.array([u, v])


def distortion(x: np.ndarray, y: np.ndarray, b: float) -> np.ndarray:
    """Derivatives d_j u_i of this displacement, by hand."""
    r2, c = x**2 + y**2, 1 / (2 * (1 - NU))
    rows = [
        [-y / r2 + c * y * (y**2 - x**2) / r2**2, x / r2 + c * x * (x**2 - y**2) / r2**2],
        [
            -(1 - 2 * NU) * c * x / r2 - 2 * c * x * y**2 / r2**2,
            -(1 - 2 * NU) * c * y / r2 + 2 * c * x**2 * y / r2**2,
        ],
    ]
    return b / (2 * np.pi) * np.array(rows)
