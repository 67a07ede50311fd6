"""Benchmarks: times of the geometry of known spaces, by themselves and beside other packages."""
