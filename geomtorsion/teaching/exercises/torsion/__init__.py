"""Chapter 2: Cartan connection and torsion."""
