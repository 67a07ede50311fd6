"""formats: the components of a space as text, LaTeX, NumPy functions and Mathematica rules."""
