"""Tree: a system whose rates are kept as they were written, lest they grow by being expanded."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import sympy as sp

from geomtorsion.errors import ExpressionError
from geomtorsion.exact.compile import python_function
from geomtorsion.exact.line_code import line_expressions, line_source
from geomtorsion.exact.straight_line import StraightLine
from geomtorsion.motion.flows.dual import DUAL_NAMES, Dual
from geomtorsion.motion.flows.tape import Writer
from geomtorsion.motion.flows.tree_reading import RECIPROCALS, tree_line
from geomtorsion.motion.system import System

# Larger rates, and those with roots, are not read into a field, which multiplies out.
LARGEST = 300
_KINKED = ("Abs", "sign", "Max", "Min", "floor", "ceiling")


@dataclass(frozen=True, eq=False)
class TreeSystem(System):
    """Rates as sympy expressions over states and parameters; nothing in them is expanded.

    trees: one expression for each state; rim: the edge, where `edge` is not None.
    """

    trees: tuple[sp.Expr, ...] = ()
    rim: sp.Expr | None = None

    @cached_property
    def line(self) -> StraightLine | None:
        """The rates with everything shared pulled out, or None where they are too long."""
        return tree_line((*self.states, *self.parameters), self.trees, self.parameters)

    @cached_property
    def edge_line(self) -> StraightLine | None:
        """The same of the edge function."""
        rim = () if self.edge is None else (self.rim,)
        return tree_line((*self.states, *self.parameters), rim, self.parameters)

    @cached_property
    def code(self) -> tuple[str, set[str]]:
        """Python source of the rates and the functions that it calls."""
        return self._source(self.line, self.trees)

    @cached_property
    def edge_code(self) -> tuple[str, set[str]]:
        """Python source of the edge function."""
        return self._source(self.edge_line, (self.rim,))

    def _source(self, line: StraightLine | None, outputs: Sequence[Any]) -> tuple[str, set[str]]:
        if line is not None:
            return line_source((*self.states, *self.parameters), line)
        return self._plain(outputs)

    def _plain(self, terms: Sequence[Any]) -> tuple[str, set[str]]:
        """Source of the terms as they stand, part by part."""
        writer = Writer((*self.states, *self.parameters), sizes=False, literal=True)
        source, _ = writer.source(terms)
        return source, writer.functions

    def scalar_jacobian(self, values: Sequence[float]) -> Callable[[float, Any], Any]:
        """df/dy at (t, y) as an array, by carrying derivatives along."""
        import numpy as np

        inner = python_function(self._plain(self.trees)[0], DUAL_NAMES)
        rows = np.eye(self.size)

        def jacobian(_: float, y: Any) -> Any:
            states = [Dual(float(x), row) for x, row in zip(y, rows, strict=True)]
            found = inner(*states, *values)
            return np.array([x.slope if isinstance(x, Dual) else 0 * rows[0] for x in found])

        return jacobian

    def written(
        self, known: Mapping[str, Any], number: Callable[[int, int], Any]
    ) -> tuple[list[Any], Any]:
        """Rates and edge as heyoka expressions of the known ones; number: p, q -> p/q."""
        writer = _HeyokaTree(known, number)
        if self.line is not None:
            rates = line_expressions(self.line, known, number)
        else:
            rates = [writer.part(tree) for tree in self.trees]
        if self.edge is None:
            return rates, None
        if self.edge_line is not None:
            return rates, line_expressions(self.edge_line, known, number)[0]
        return rates, writer.part(self.rim)


class _HeyokaTree:
    """Writes a sympy tree as heyoka expressions, each part once."""

    def __init__(self, known: Mapping[str, Any], number: Callable[[int, int], Any]) -> None:
        from importlib import import_module

        self.heyoka: Any = import_module("heyoka")
        self.symbols = known
        self.number = number
        self.done: dict[Any, Any] = {}

    def part(self, expr: Any) -> Any:
        """One part."""
        if expr not in self.done:
            self.done[expr] = self._part(expr)
        return self.done[expr]

    def _part(self, expr: Any) -> Any:
        hy = self.heyoka
        if expr.is_Symbol:
            return self.symbols[expr.name]
        if expr.is_Rational:
            return self.number(int(expr.p), int(expr.q))
        if expr.is_Add:
            return self._sum(expr.args)
        if expr.is_Mul:
            return self._product(expr.args)
        if expr.is_Pow:
            return self._product((expr,))
        name = type(expr).__name__
        if expr.is_NumberSymbol:
            from fractions import Fraction

            digits = Fraction(str(expr.evalf(120)))
            return self.number(digits.numerator, digits.denominator)
        inner = [self.part(argument) for argument in expr.args]
        if name in RECIPROCALS:
            return self.number(1, 1) / getattr(hy, RECIPROCALS[name])(*inner)
        return getattr(hy, name)(*inner)

    def _sum(self, terms: Sequence[Any]) -> Any:
        """A sum, with a number that all terms share in front of it."""
        pairs = [term.as_coeff_Mul(rational=True) for term in terms]
        shared = abs(pairs[0][0])
        if any(abs(number) != shared for number, _ in pairs):
            return self.heyoka.sum([self.part(term) for term in terms])
        parts = [self.part(rest) if n > 0 else -self.part(rest) for n, rest in pairs]
        total = self.heyoka.sum(parts)
        if shared == 1:
            return total
        return self.heyoka.prod([self.number(int(shared.p), int(shared.q)), total])

    def _product(self, factors: Sequence[Any]) -> Any:
        """A product over what stands below the line."""
        above, below = [], []
        for factor in factors:
            negative = factor.is_Pow and factor.exp.could_extract_minus_sign()
            power = 1 / factor if negative else factor
            (below if negative else above).append(self._power(power) if power.is_Pow else power)
        over = [x if not isinstance(x, sp.Basic) else self.part(x) for x in above]
        under = [x if not isinstance(x, sp.Basic) else self.part(x) for x in below]
        value = self.heyoka.prod(over) if over else self.number(1, 1)
        return value / self.heyoka.prod(under) if under else value

    def _power(self, expr: Any) -> Any:
        """base**exponent for an exponent without minus, by squares, products and square roots."""
        base, exponent = expr.base, expr.exp
        if base is sp.E:
            return self.heyoka.exp(self.part(exponent))
        if exponent.is_Integer:
            return self._whole(base, int(exponent))
        if exponent.is_Rational and exponent.q == 2:
            root = self.heyoka.sqrt(self.part(base))
            whole = int(exponent.p) // 2
            return self.heyoka.prod([root, self._whole(base, whole)]) if whole else root
        return self.part(base) ** self.part(exponent)

    def _whole(self, base: Any, exponent: int) -> Any:
        # heyoka's series of x**n, n > 2, divides by x; its squares and products do not.
        if exponent == 1:
            return self.part(base)
        key = (base, exponent)
        if key not in self.done:
            square = self._whole(base, exponent // 2) ** 2.0
            odd = exponent % 2
            self.done[key] = self.heyoka.prod([square, self.part(base)]) if odd else square
        return self.done[key]


def is_plain(terms: Sequence[sp.Expr]) -> bool:
    """Whether terms are short polynomials or fractions, which a field makes shorter still."""
    count = 0
    for term in terms:
        for part in sp.preorder_traversal(term):
            count += 1
            if count > LARGEST or (part.is_Pow and not part.exp.is_Integer):
                return False
    return True


def check_smooth(terms: Sequence[sp.Expr], where: Sequence[str]) -> None:
    """Refuse what has kinks or jumps."""
    for term, place in zip(terms, where, strict=True):
        for part in sp.preorder_traversal(term):
            if type(part).__name__ in _KINKED:
                raise ExpressionError(
                    f"{place}: {part} is not smooth. Write the expression of one side (and stop or "
                    "switch where it ends), or a smooth one such as sqrt(x**2 + s**2) for Abs(x)."
                )
