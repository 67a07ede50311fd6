"""Proofs: balls that contain the true value of a loop integral, a development or a motion."""

from geomtorsion.proofs.prove import Proof, prove

__all__ = ["Proof", "prove"]
