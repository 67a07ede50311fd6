"""Gravity: a Lagrangian of torsion, curvature and nonmetricity in, field equations out."""

__all__: list[str] = []
