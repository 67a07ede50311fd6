"""Prescan: finds all angles and exponents in expressions before any is read."""

from __future__ import annotations

from operator import attrgetter
from typing import TYPE_CHECKING

import sympy

from geomtorsion.exact.functions import CIRCULAR, HYPERBOLIC
from geomtorsion.exact.kept import inside_out

if TYPE_CHECKING:
    from collections.abc import Iterator

    Exprs = list[sympy.Basic]


class Scan:
    """Arguments of circular functions, exponents and hyperbolic arguments, by nesting."""

    def __init__(self, exprs: list[sympy.Expr]) -> None:
        self._depth: dict[sympy.Basic, int] = {}
        self._found: dict[int, tuple[Exprs, Exprs, Exprs]] = {}
        for expr in exprs:
            for part in inside_out(expr, attrgetter("args"), self._depth.__contains__):
                self._depth[part] = self._visit(part)

    def levels(self) -> Iterator[tuple[Exprs, Exprs, Exprs]]:
        """(angles, exponents, hyperbolic arguments), innermost first."""
        for depth in sorted(self._found):
            yield self._found[depth]

    def _visit(self, expr: sympy.Basic) -> int:
        """The depth of functions inside an expression, from those of its parts; notes it."""
        if not expr.args:
            return 0
        depth = max([self._depth[arg] for arg in expr.args])
        name = type(expr).__name__
        if name in CIRCULAR:
            self._note(depth, 0, expr.args[0])
        elif name == "exp":
            self._note(depth, 1, expr.args[0])
        elif name in HYPERBOLIC:
            self._note(depth, 2, expr.args[0])
        elif isinstance(expr, sympy.Pow) and not expr.exp.is_Rational:
            base, exponent = expr.args
            if base is sympy.E:
                self._note(depth, 1, exponent)
            else:
                depth += 1
                self._note(depth, 1, exponent * sympy.log(base))
        if expr.is_Function or (isinstance(expr, sympy.Pow) and not expr.exp.is_Integer):
            depth += 1
        return depth

    def _note(self, depth: int, kind: int, argument: sympy.Basic) -> None:
        self._found.setdefault(depth, ([], [], []))[kind].append(argument)
