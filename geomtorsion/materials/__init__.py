"""Materials: Burgers vectors of measured and simulated matter."""
