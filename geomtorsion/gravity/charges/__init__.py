"""Charges: mass, spin and charge inside closed surfaces, and the thermodynamics of horizons."""
