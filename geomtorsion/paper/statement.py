"""statement: one sentence of the paper, compared with the computed result, in its notation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import permutations

import sympy as sp

from geomtorsion.geometry import Tensor
from geomtorsion.support.checks import expression as expression_of

Index = tuple[int, ...]
Components = Mapping[Index, "sp.Expr | int"]

PHI = phi1, phi2, phi3 = sp.symbols("phi1 phi2 phi3", real=True)
c1, s1, c2, s2 = sp.cos(phi1), sp.sin(phi1), sp.cos(phi2), sp.sin(phi2)
SHORT = dict(zip((c1, s1, c2, s2), sp.symbols("c1 s1 c2 s2"), strict=True))


@dataclass(frozen=True)
class Statement:
    """One statement of the paper, compared with what the generic classes compute.

    Fields
    ------
    equation
        Number as LaTeX prints it, or a position near it.
    says
        The statement as printed, in one line.
    verdict
        "agrees", or "misprint: ..." with the error in print.
    right
        The formula as it was recomputed.
    note
        A condition, or how the print is to be read; may be empty.

    Examples
    --------
    >>> Statement("(12)", "2 S_ijk = -eps_ijk", "agrees", "2 S_123 = -1").agrees
    True
    """

    equation: str
    says: str
    verdict: str
    right: str
    note: str = ""

    @property
    def agrees(self) -> bool:
        """Whether the print is right."""
        return self.verdict == "agrees"


def verdict(holds: bool, wrong: str = "the print differs from the formula on the right") -> str:
    """ "agrees", or the misprint."""
    return "agrees" if holds else f"misprint: {wrong}"


def lost(what: str, corrected: bool) -> str:
    """Description of a misprint, if the corrected formula was found to hold."""
    return f"{what} is lost" if corrected else "wrong in more than its notation"


def epsilon(scale: sp.Expr | int) -> dict[Index, sp.Expr]:
    """Components of scale * eps_abc."""
    return {i: scale * sp.LeviCivita(*i) for i in permutations(range(3))}


def same(tensor: Tensor, printed: Components) -> bool:
    """Whether a tensor has exactly these components and no others."""
    return tensor == Tensor(tensor.frame, tensor.slots, printed)


def short(expression: sp.Expr | int) -> str:
    """An expression with c1, s1, c2, s2 for cosines and sines."""
    return str(expression_of(expression).xreplace(SHORT))


def rows(tensor: Tensor) -> str:
    """A matrix, row by row."""
    n = range(tensor.frame.dimension)
    return "[" + ", ".join("[" + ", ".join(short(tensor[i, j]) for j in n) + "]" for i in n) + "]"


def listed(symbol: str, tensor: Tensor) -> str:
    """Nonzero components with their indices counted from 1, equal values together."""
    heights = ["^" if slot in "uU" else "_" for slot in tensor.slots]
    groups: dict[str, list[str]] = {}
    for index, value in tensor.nonzero().items():
        label, last = symbol, ""
        for k, height in zip(index, heights, strict=True):
            label += (height if height != last else "") + str(k + 1)
            last = height
        groups.setdefault(short(value), []).append(label)
    if not groups:
        return f"{symbol} = 0"
    return "; ".join(f"{' = '.join(names)} = {value}" for value, names in groups.items())
