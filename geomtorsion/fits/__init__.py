"""Fits: parameters and starts of motions, and dislocations, from data with noise."""

from geomtorsion.fits.data import Data
from geomtorsion.fits.motions import fit
from geomtorsion.fits.result import Direction, Fit

__all__ = ["Data", "Direction", "Fit", "fit"]
