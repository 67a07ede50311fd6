"""Chapter 4: straightest and shortest."""
