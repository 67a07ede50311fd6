"""Theory: Lagrangians, their invariants and matter, and the field equations that follow."""
