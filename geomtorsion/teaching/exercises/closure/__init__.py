"""Chapter 5: loops that fail to close."""
