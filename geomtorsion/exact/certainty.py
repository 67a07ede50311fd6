"""Certainty: how sure it is that something vanishes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Certainty:
    """How sure it is that an element vanishes or not.

    proved: whether polynomials decided, or a value that is not zero.
    error: else a bound on the chance that the answer is wrong.
    """

    proved: bool
    error: float = 0.0

    def __str__(self) -> str:
        if self.proved:
            return "proved"
        return f"at a random point modulo a prime: chance of error below {self.error:.0e}"


PROVED = Certainty(proved=True)


def least_certain(verdicts: Iterable[Certainty]) -> Certainty:
    """The certainty that all of some verdicts are right."""
    chances = [verdict.error for verdict in verdicts if not verdict.proved]
    return Certainty(proved=not chances, error=sum(chances))
