"""Remedies: what the parser advises, in words that fit an answer, where nothing can be declared."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from geomtorsion.exercises.wording import symbol_names

if TYPE_CHECKING:
    from geomtorsion.exercises.question import Question

_NAME = re.compile(r"(\S+) is neither a coordinate nor a declared parameter$", re.MULTILINE)
_DECLARE = re.compile(r"(?:Otherwise d|D)eclare \S+ as a parameter\.\Z")
_FUNCTION = re.compile(r"(?:Otherwise d|D)eclare it as an unknown function with .*\Z")
_SMALLER = re.compile(r"Name it as a parameter.*\Z")


def fitting(question: Question, message: str) -> str:
    """A message of the parser, with a remedy that whoever answers a question has.

    Examples
    --------
    >>> from geomtorsion.exercises import load
    >>> question = load("3.2").questions[0]
    >>> fitting(question, "Did you mean phi2? Otherwise declare phi as a parameter.")
    'Did you mean phi2? Names that may occur here: phi1, phi2.'
    """
    names = ", ".join(symbol_names(question))
    allowed = f"Names that may occur here: {names}." if names else "No names occur in this answer."
    message = _NAME.sub(r"\1 is no name that occurs in this answer", message)
    message = _DECLARE.sub(allowed, message)
    message = _FUNCTION.sub("Write it with sin, cos, tan, exp, log, sqrt and the like.", message)
    return _SMALLER.sub("Write a smaller one.", message)
