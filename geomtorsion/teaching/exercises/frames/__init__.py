"""Chapter 1: frames and anholonomy."""
