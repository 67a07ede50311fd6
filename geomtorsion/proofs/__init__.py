"""Proofs: balls that contain the true value of a result, and theorems about orbits."""

from geomtorsion.proofs.closed_orbits import closed_orbit
from geomtorsion.proofs.crossings import Crossing, poincare
from geomtorsion.proofs.orbits import ClosedOrbit
from geomtorsion.proofs.prove import Proof, prove

__all__ = ["ClosedOrbit", "Crossing", "Proof", "closed_orbit", "poincare", "prove"]


def __dir__() -> list[str]:
    """All public names."""
    return [*__all__]
