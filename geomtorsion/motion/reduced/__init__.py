"""Geodesics with momenta of cyclic coordinates as constants: smaller systems for engines."""
