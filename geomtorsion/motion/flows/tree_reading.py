"""Tree reading: sympy trees as sums over literals; nothing in them is expanded."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import sympy as sp

from geomtorsion.exact.emitting import short_line
from geomtorsion.exact.factoring import TooLong
from geomtorsion.exact.literals import Literals
from geomtorsion.exact.straight_line import StraightLine
from geomtorsion.exact.sums import Term

# Functions written as one over another one.
RECIPROCALS = {
    "cot": "tan", "sec": "cos", "csc": "sin", "coth": "tanh", "sech": "cosh", "csch": "sinh",
}  # fmt: skip


def tree_line(
    arguments: Sequence[str], trees: Sequence[Any], constants: Sequence[str]
) -> StraightLine | None:
    """A short straight line for trees, or None where they are too long for it.

    Examples
    --------
    >>> x, y = sp.symbols("x y")
    >>> line = tree_line(["x", "y"], [x * (x - y) ** 2, y * (y - x) ** 2], [])
    >>> [step.kind for step in line.steps]
    ['symbol', 'symbol', 'sum', 'square', 'product', 'product']
    """
    reader = _TreeReader(arguments, constants)
    try:
        return short_line(reader, [reader.sum(tree) for tree in trees])
    except (TooLong, RecursionError):
        return None


class _TreeReader(Literals):
    """Reads sympy trees, each part once."""

    def __init__(self, arguments: Sequence[str], constants: Sequence[str]) -> None:
        super().__init__(arguments, constants)
        self._done: dict[Any, Term] = {}

    def sum(self, tree: Any) -> int:
        """A tree as a sum of its own."""
        return self.sums.entered([self.part(term) for term in sp.Add.make_args(tree)])

    def part(self, tree: Any) -> Term:
        """A tree as one term."""
        if tree not in self._done:
            self._done[tree] = self._part(tree)
        return self._done[tree]

    def _part(self, tree: Any) -> Term:
        if tree.is_Symbol:
            return self.symbols[tree.name]
        if tree.is_Rational:
            return (Fraction(int(tree.p), int(tree.q)), (), ())
        if tree.is_NumberSymbol:
            return self.digits(tree)
        if tree.is_Add:
            return self.sums.literal([self.part(term) for term in tree.args])
        if tree.is_Mul:
            return self.times([self.part(factor) for factor in tree.args])
        if tree.is_Pow:
            return self._power(tree.base, tree.exp)
        name = type(tree).__name__
        if name in RECIPROCALS:
            return self.power(self.call(RECIPROCALS[name], self.part(tree.args[0])), -1)
        return self.call(name, *(self.part(argument) for argument in tree.args))

    def _power(self, base: Any, exponent: Any) -> Term:
        """A power: of whole and half numbers by products and square roots."""
        if base is sp.E:
            return self.call("exp", self.part(exponent))
        if exponent.is_Rational and exponent.q <= 2:
            inner = self.part(base)
            if not inner[0]:
                raise TooLong
            root = inner if exponent.q == 1 else self.root(2, inner)
            return self.times([self.power(root, int(exponent.p))])
        return self.call("power", self.part(base), self.part(exponent))
