"""Perturbed: a theory of gravity to first order about flat space, a cosmos or a static hole."""

from geomtorsion.gravity.perturbed.cosmology import TensorModes, tensor_modes
from geomtorsion.gravity.perturbed.particles import Particle, Spectrum, spectrum
from geomtorsion.gravity.perturbed.weak_field import PostNewtonian, post_newtonian

__all__ = [
    "Particle",
    "PostNewtonian",
    "Spectrum",
    "TensorModes",
    "post_newtonian",
    "spectrum",
    "tensor_modes",
]
