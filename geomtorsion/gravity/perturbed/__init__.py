"""Perturbed: a theory of gravity to first order about flat space, a cosmos or a static hole."""

from geomtorsion.gravity.perturbed.cosmology import TensorModes, tensor_modes
from geomtorsion.gravity.perturbed.dust import Growth, growth
from geomtorsion.gravity.perturbed.evolution import Evolution
from geomtorsion.gravity.perturbed.particles import Particle, Spectrum, spectrum
from geomtorsion.gravity.perturbed.phase_space import DegreesOfFreedom, degrees_of_freedom
from geomtorsion.gravity.perturbed.quasi_normal import Mode, Ringing, ringing
from geomtorsion.gravity.perturbed.scalar_waves import ScalarModes, scalar_modes
from geomtorsion.gravity.perturbed.solar_system import SolarTest
from geomtorsion.gravity.perturbed.weak_field import PostNewtonian, post_newtonian

__all__ = [
    "DegreesOfFreedom",
    "Evolution",
    "Growth",
    "Mode",
    "Particle",
    "PostNewtonian",
    "Ringing",
    "ScalarModes",
    "SolarTest",
    "Spectrum",
    "TensorModes",
    "degrees_of_freedom",
    "growth",
    "post_newtonian",
    "ringing",
    "scalar_modes",
    "spectrum",
    "tensor_modes",
]
