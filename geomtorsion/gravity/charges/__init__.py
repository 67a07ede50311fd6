"""Charges: what is inside a closed surface, and the thermodynamics of horizons."""
