"""spaces: the shipped frames, each in a file of its own, loaded by name or read from a file."""

from geomtorsion.spaces.files import read_file
from geomtorsion.spaces.registry import load, names, titles
from geomtorsion.spaces.space import KnownAnswer, Space

__all__ = ["KnownAnswer", "Space", "load", "names", "read_file", "titles"]
