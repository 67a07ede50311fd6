"""Golden answers: what public calls gave before the house was rebuilt."""
