"""Chapter 6: the action principle and the top."""
