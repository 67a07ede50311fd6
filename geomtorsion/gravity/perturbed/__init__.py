"""Perturbed: a theory of gravity to first order about flat space, a cosmos or a static hole."""

from geomtorsion.gravity.perturbed.spectrum import Particle, Spectrum, spectrum

__all__ = ["Particle", "Spectrum", "spectrum"]
