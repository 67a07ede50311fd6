"""Tests of geomtorsion.pictures."""
