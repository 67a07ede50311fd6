"""Fields: what a coframe on a grid is computed with, from stencils to files."""
