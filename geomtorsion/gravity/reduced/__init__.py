"""Reduced: equations of functions of one variable, from jets to first-order equations."""
