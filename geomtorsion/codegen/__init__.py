"""Code generation: one graph of shared expressions, printed as NumPy, Python or heyoka."""

from geomtorsion.codegen import balls
from geomtorsion.codegen.arrays import numpy_function
from geomtorsion.codegen.evaluation import exact_number, rational
from geomtorsion.codegen.expression_graph import Graph, graph
from geomtorsion.codegen.printers import compiled
from geomtorsion.codegen.reading import Output, Products

__all__ = [
    "Graph",
    "Output",
    "Products",
    "balls",
    "compiled",
    "exact_number",
    "graph",
    "numpy_function",
    "rational",
]
