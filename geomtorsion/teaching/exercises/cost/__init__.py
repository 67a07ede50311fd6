"""Chapter 7: what accuracy costs."""
