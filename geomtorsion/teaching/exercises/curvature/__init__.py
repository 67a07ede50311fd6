"""Chapter 3: curvature, Cartan and Riemann."""
