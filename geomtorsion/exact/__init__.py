"""Exact scalars: read, differentiate, decide zero, write.

Five files import each other, because an element holds its field and a field makes elements. At run
time the imports point one way: tower, kept, element, limits, with generators below tower. The
imports in the other direction are only for types.
"""

from geomtorsion.exact import limits, names, syntax, tokens, units
from geomtorsion.exact.element import Certainty, Element
from geomtorsion.exact.field import Field
from geomtorsion.exact.functions import unknown_functions
from geomtorsion.exact.generators import Branch, Generator
from geomtorsion.exact.jets import linear_parts
from geomtorsion.exact.linear import Reduced, reduced, sign, signature, squares, vanishes
from geomtorsion.exact.parsing import parse_expression, read_tokens
from geomtorsion.exact.printing import PrintedOnce, TexPrinter
from geomtorsion.exact.relations import Echelon, vanishing_sums
from geomtorsion.exact.specialization import Specialization
from geomtorsion.exact.truncated import Truncated, TruncatedField

__all__ = [
    "Branch",
    "Certainty",
    "Echelon",
    "Element",
    "Field",
    "Generator",
    "PrintedOnce",
    "Reduced",
    "Specialization",
    "TexPrinter",
    "Truncated",
    "TruncatedField",
    "limits",
    "linear_parts",
    "names",
    "parse_expression",
    "read_tokens",
    "reduced",
    "sign",
    "signature",
    "squares",
    "syntax",
    "tokens",
    "units",
    "unknown_functions",
    "vanishes",
    "vanishing_sums",
]


def __dir__() -> list[str]:
    """All public names."""
    return [*__all__]
