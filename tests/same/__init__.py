"""Tests of the comparison of geometries."""
