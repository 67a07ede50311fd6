"""Numeric: field equations evaluated on numbers, power series and grids, never written out."""
