"""Pieces: expressions that change at levels of a term, their branches, and tables of rows."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from geomtorsion.codegen import Graph, graph
from geomtorsion.errors import ExpressionError

# (pieces, number of the branch that holds).
Choice: TypeAlias = Callable[["pieces"], int]

# Expressions that Max and Min compare: pieces of pieces double with each.
MOST_COMPARED = 6


class pieces(sp.Function):  # written as functions of sympy are
    """Expression by pieces: pieces(x, f0, c1, f1, c2, f2, ...), with increasing levels c1, c2, ...

    It is f0 for x < c1, f1 from c1 to c2, and so on. The value at a level itself does not matter
    for a motion.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> force = pieces(x, 0, 1, x - 1)
    >>> force, force.diff(x), force.subs(x, 3)
    (pieces(x, 0, 1, x - 1), pieces(x, 0, 1, 1), 2)
    """

    @classmethod
    def eval(cls, *args: sp.Expr) -> sp.Expr | None:
        """A single branch where that is known; see sympy."""
        if len(args) < 2 or len(args) % 2:
            raise ExpressionError(
                f"pieces: expected a term, an expression, and then a level and an expression for "
                f"each further piece, got {len(args)} entries. Write pieces(x, a, 1, b) for a below"
                " x = 1 and b from there on."
            )
        branches, levels = args[1::2], args[2::2]
        if all(a.is_number and b.is_number for a, b in pairwise(levels)):
            for low, high in pairwise(levels):
                if not low < high:
                    raise ExpressionError(
                        f"pieces: expected increasing levels, got {low} before {high}. Write the "
                        "pieces in the order of their levels."
                    )
        if all(branch == branches[0] for branch in branches):
            return branches[0]
        if args[0].is_number and all(level.is_number for level in levels):
            return branches[sum(bool(args[0] >= level) for level in levels)]
        return None

    @property
    def term(self) -> sp.Expr:
        """The term that is compared with the levels."""
        return self.args[0]

    @property
    def branches(self) -> tuple[sp.Expr, ...]:
        """One expression more than there are levels."""
        return self.args[1::2]

    @property
    def levels(self) -> tuple[sp.Expr, ...]:
        """Values of the term at which the expression changes."""
        return self.args[2::2]

    def with_branches(self, change: Callable[[sp.Expr], sp.Expr]) -> sp.Expr:
        """The same levels with other branches."""
        return joined(self.term, self.levels, [change(x) for x in self.branches])

    def _eval_derivative(self, s: sp.Symbol) -> sp.Expr:
        return self.with_branches(lambda branch: sp.diff(branch, s))

    def _eval_is_extended_real(self) -> bool:
        return True


class ends(sp.Function):  # written as functions of sympy are
    """Mark of a branch in which an expression has no value: ends(x), behind the rows of a table."""

    nargs = 1

    def _eval_derivative(self, s: sp.Symbol) -> sp.Expr:
        return self

    def _eval_is_extended_real(self) -> bool:
        return True


# What a text may contain besides the functions of the parser.
FUNCTIONS = {"pieces": pieces, "ends": ends}


def joined(term: sp.Expr, levels: Sequence[sp.Expr], branches: Sequence[sp.Expr]) -> sp.Expr:
    """Branches between levels of a term as one expression."""
    pairs = zip(levels, branches[1:], strict=True)
    return pieces(term, branches[0], *(x for pair in pairs for x in pair))


def without_piecewise(expr: sp.Expr, where: str) -> sp.Expr:
    """Piecewise of sympy as `pieces`; conditions are comparisons, or several joined by And and Or.

    Raises
    ------
    ExpressionError
        a condition is something else, or the conditions leave a gap.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> without_piecewise(sp.Piecewise((-x, x < 0), (x, True)), "the rate of x")
    pieces(x, -x, 0, x)
    """
    parts = expr.atoms(sp.Piecewise)
    if not parts:
        return expr
    changes = {part: _nested(list(part.args), where) for part in parts}
    # Inner ones first: they may be a part of outer ones.
    for part in sorted(parts, key=lambda x: x.count_ops(), reverse=True):
        expr = expr.subs(part, changes[part])
    return without_piecewise(expr, where)


def without_kinks(expr: sp.Expr) -> sp.Expr:
    """Abs, sign, Max, Min and Heaviside as `pieces`.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> without_kinks(-sp.sign(x - 1)), without_kinks(sp.Abs(x))
    (-pieces(x, -1, 1, 1), pieces(x, -x, 0, x))
    """
    if not expr.has(sp.Abs, sp.sign, sp.Max, sp.Min, sp.Heaviside):
        return expr
    args = [without_kinks(part) for part in expr.args]
    if isinstance(expr, sp.Abs):
        return _merged(args[0], -args[0], args[0])
    if isinstance(expr, sp.sign):
        return _merged(args[0], sp.S.NegativeOne, sp.S.One)
    if isinstance(expr, sp.Heaviside):
        return _merged(args[0], sp.S.Zero, sp.S.One)
    if isinstance(expr, sp.Max | sp.Min):
        if len(args) > MOST_COMPARED:
            name = type(expr).__name__
            raise ExpressionError(
                f"{name}: expected at most {MOST_COMPARED} expressions, got {len(args)}. Each pair "
                "is compared; write the largest of them by pieces(...)."
            )
        first, *others = args
        for other in others:
            below, above = (other, first) if isinstance(expr, sp.Max) else (first, other)
            first = _merged(first - other, below, above)
        return first
    return expr.func(*args)


def _nested(rows: list[tuple[sp.Expr, sp.Basic]], where: str) -> sp.Expr:
    """Rows (expression, condition), of which the first holds whose condition does."""
    if not rows:
        raise ExpressionError(
            f"{where}: expected a piece for all values, got none for the rest. Give (expression, "
            "True) as the last piece of Piecewise."
        )
    (branch, condition), *rest = rows
    if condition == True:  # noqa: E712  # a condition of sympy
        return branch
    return _chosen(condition, branch, _nested(rest, where), where)


def _chosen(condition: sp.Basic, yes: sp.Expr, no: sp.Expr, where: str) -> sp.Expr:
    """One expression where a condition holds, and another elsewhere."""
    if condition == True:  # noqa: E712
        return yes
    if condition == False:  # noqa: E712
        return no
    if isinstance(condition, sp.And):
        for part in condition.args:
            yes = _chosen(part, yes, no, where)
        return yes
    if isinstance(condition, sp.Or):
        for part in condition.args:
            no = _chosen(part, yes, no, where)
        return no
    if isinstance(condition, sp.Not):
        return _chosen(condition.args[0], no, yes, where)
    if isinstance(condition, sp.StrictGreaterThan | sp.GreaterThan):
        return _merged(condition.lhs - condition.rhs, no, yes)
    if isinstance(condition, sp.StrictLessThan | sp.LessThan):
        return _merged(condition.lhs - condition.rhs, yes, no)
    raise ExpressionError(
        f"{where}: expected comparisons such as x < 1 as conditions of Piecewise, got {condition}."
        " Write each condition with < or >."
    )


def _merged(gap: sp.Expr, below: sp.Expr, above: sp.Expr) -> sp.Expr:
    """`below` where a gap is negative, `above` elsewhere; levels of one term are put together.

    A gap by pieces itself is compared piece by piece.
    """
    for inner in sorted(gap.atoms(pieces), key=sp.default_sort_key):
        if not has_pieces((inner.term, *inner.levels)):
            cases = [
                _merged(*(x.xreplace({inner: branch}) for x in (gap, below, above)))
                for branch in inner.branches
            ]
            return joined(inner.term, inner.levels, cases)
    if gap.is_number:
        return below if gap < 0 else above
    constant, term = gap.as_coeff_Add()
    factor, term = term.as_coeff_Mul()
    if factor < 0:
        below, above = above, below
    level = -constant / factor
    if isinstance(above, pieces) and above.term == term and above.levels[0].is_number:
        place = sum(bool(x <= level) for x in above.levels)
        levels, branches = above.levels[place:], above.branches[place:]
    else:
        levels, branches = (), (above,)
    if isinstance(below, pieces) and below.term == term and below.levels[0].is_number:
        place = sum(bool(x < level) for x in below.levels)
        levels = (*below.levels[:place], level, *levels)
        branches = (*below.branches[: place + 1], *branches)
    else:
        levels, branches = (level, *levels), (below, *branches)
    return joined(term, levels, branches)


def has_pieces(terms: Iterable[sp.Expr]) -> bool:
    """Whether some expressions are given by pieces."""
    return any(term.has(pieces, ends) for term in terms)


def resolved(expr: sp.Expr, choice: Choice) -> sp.Expr:
    """An expression with the branches that hold; only those are looked at."""
    if not expr.has(pieces):
        return expr
    if isinstance(expr, pieces):
        return resolved(expr.branches[choice(expr)], choice)
    return expr.func(*(resolved(part, choice) for part in expr.args))


def all_pieces(terms: Iterable[sp.Expr]) -> list[pieces]:
    """All expressions by pieces in some terms, in a fixed order."""
    every = [part for term in terms for part in sp.preorder_traversal(term)]
    return list(dict.fromkeys(part for part in every if isinstance(part, pieces)))


@lru_cache(maxsize=128)
def _graph(names: tuple[str, ...], terms: tuple[sp.Expr, ...]) -> Graph:
    return graph(names, list(terms), factor=False)


class BranchedGraph:
    """Values of expressions by pieces, with the methods of a `Graph` that readers call."""

    def __init__(self, names: Sequence[str], terms: Sequence[sp.Expr]) -> None:
        self.names, self.terms = tuple(names), tuple(terms)
        self.size = len(terms)

    def numpy(self) -> Callable[..., np.ndarray]:
        """Function of one array for each name; not a number where a table has ended."""
        return lambda *values: self._over(self.terms, values, lambda one: one.numpy())

    def sizes(self, *values: ArrayLike) -> np.ndarray:
        """See `Graph.sizes`."""
        return self._over(self.terms, values, lambda one: one.sizes)

    def exactly(self, values: Sequence[Any], bits: int) -> list[Any]:
        """See `Graph.exactly`."""
        floats = [np.array([float(x)]) for x in values]
        terms = self._chosen(self.terms, floats)
        if any(term.has(ends) for term in terms):
            raise ZeroDivisionError
        return _graph(self.names, terms).exactly(values, bits)

    def _first(self, terms: tuple[sp.Expr, ...]) -> pieces | None:
        """An expression by pieces whose term has none itself."""
        every = (x for x in all_pieces(terms) if not has_pieces([x.term, *x.levels]))
        return next(every, None)

    def _chosen(self, terms: tuple[sp.Expr, ...], one: list[np.ndarray]) -> tuple[sp.Expr, ...]:
        while (part := self._first(terms)) is not None:
            branch = part.branches[int(self._places(part, one)[0])]
            terms = tuple(term.xreplace({part: branch}) for term in terms)
        return terms

    def _places(self, part: pieces, values: Sequence[ArrayLike]) -> np.ndarray:
        """Numbers of the branches, one for each row."""
        compared = _graph(self.names, (part.term, *part.levels)).numpy()(*values)
        return np.sum(compared[1:] <= compared[0], axis=0)

    def _over(
        self,
        terms: tuple[sp.Expr, ...],
        values: Sequence[ArrayLike],
        kind: Callable[[Graph], Callable[..., np.ndarray]],
    ) -> np.ndarray:
        part = self._first(terms)
        if part is None:
            ended = [term.has(ends) for term in terms]
            rest = tuple(sp.S.Zero if x else term for x, term in zip(ended, terms, strict=True))
            result = np.array(kind(_graph(self.names, rest))(*values), dtype=float)
            result[ended] = np.nan
            return result
        wide = np.broadcast_arrays(*values)
        places = np.broadcast_to(self._places(part, values), wide[0].shape)
        result = np.empty((len(terms), *wide[0].shape))
        for place in np.unique(places):
            chosen = places == place
            some = tuple(term.xreplace({part: part.branches[place]}) for term in terms)
            rows = [x[chosen] for x in wide] if wide[0].ndim else wide
            result[:, chosen] = np.reshape(self._over(some, rows, kind), (len(terms), -1))
        return result


def term_graph(names: Sequence[str], terms: Sequence[sp.Expr]) -> Graph | BranchedGraph:
    """Values of expressions over named arguments, also of expressions by pieces."""
    if has_pieces(terms):
        return BranchedGraph(names, terms)
    return graph(names, list(terms), factor=False)
