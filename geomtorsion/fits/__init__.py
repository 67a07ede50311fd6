"""Fits: parameters and starts of motions, and dislocations, from data with noise.

NOISE: prefix of the columns of noise in data; `sigma_x` is the standard deviation of `x`.
"""

from geomtorsion.fits.data import NOISE, Data
from geomtorsion.fits.frames import fit_frame
from geomtorsion.fits.loops import fit_loops
from geomtorsion.fits.motions import fit
from geomtorsion.fits.result import Direction, Fit

__all__ = ["NOISE", "Data", "Direction", "Fit", "fit", "fit_frame", "fit_loops"]


def __dir__() -> list[str]:
    """All public names."""
    return [*__all__]
