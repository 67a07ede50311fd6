"""Exact scalars: read, differentiate, decide zero, write."""

from geomtorsion.exact.element import Certainty, Element
from geomtorsion.exact.field import Field
from geomtorsion.exact.generators import Branch, Generator
from geomtorsion.exact.parsing import parse_expression

__all__ = ["Branch", "Certainty", "Element", "Field", "Generator", "parse_expression"]
