"""Golden answers: results of public calls, recorded before the package was rebuilt."""
