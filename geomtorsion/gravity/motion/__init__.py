"""Motion: solutions of reduced field equations, from one place or between two."""
