"""Initial data: the constraints of a slice of a spacetime, from formulas and on grids."""
