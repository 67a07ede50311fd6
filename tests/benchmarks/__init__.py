"""Benchmarks: what the geometry of known spaces costs, alone and beside other packages."""
