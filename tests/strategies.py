"""Strategies: random expressions, coframes and points for hypothesis, shared by the tests."""

from __future__ import annotations

from fractions import Fraction

import sympy as sp
from hypothesis import strategies as st

x, y, z, u, v = COORDINATES = sp.symbols("x y z u v", real=True)
k, b = PARAMETERS = sp.symbols("k b", positive=True)
F = sp.Function("F")


def rationals(limit: int = 4) -> st.SearchStrategy[sp.Rational]:
    """Small rational numbers, never zero."""
    whole = st.integers(-limit, limit).filter(bool)
    return st.builds(sp.Rational, whole, st.integers(1, 3))


def linear_forms(symbols: tuple[sp.Symbol, ...]) -> st.SearchStrategy[sp.Expr]:
    """Linear combinations of at most two symbols, also with halves and shifts by parts of pi."""
    factor = st.sampled_from([1, 1, 1, 2, -1, 3, sp.Rational(1, 2)])
    shift = st.sampled_from([0, 0, 0, 0, sp.pi / 3, sp.pi / 4, sp.pi / 2, sp.Rational(1, 2)])
    one = st.builds(lambda s, c, d: c * s + d, st.sampled_from(symbols), factor, shift)
    two = st.builds(
        lambda s, t, c, d: c * s + d * t,
        st.sampled_from(symbols),
        st.sampled_from(symbols),
        st.sampled_from([1, 2]),
        st.sampled_from([1, -1]),
    )
    return one | two


def positive(symbols: tuple[sp.Symbol, ...]) -> st.SearchStrategy[sp.Expr]:
    """Expressions that are positive wherever the symbols are real."""
    s = st.sampled_from(symbols)
    return (
        st.builds(lambda s, n: s**2 + n, s, st.integers(1, 3))
        | st.builds(lambda s, t: 1 + s**2 + t**2, s, s)
        | st.builds(lambda s: 2 + sp.sin(s), s)
        | st.builds(lambda s: 1 + sp.exp(s), s)
        | st.builds(sp.cosh, s)
    )


def atoms(symbols: tuple[sp.Symbol, ...]) -> st.SearchStrategy[sp.Expr]:
    """Symbols, numbers and supported functions of simple arguments."""
    line = linear_forms(symbols)
    return (
        st.sampled_from(symbols)
        | rationals()
        | st.builds(sp.sin, line)
        | st.builds(sp.cos, line)
        | st.builds(sp.exp, line)
        | st.builds(sp.sinh, st.sampled_from(symbols))
        | st.builds(sp.cosh, st.sampled_from(symbols))
        | st.builds(sp.tanh, st.sampled_from(symbols))
        | st.builds(sp.sqrt, positive(symbols))
        | st.builds(sp.log, positive(symbols))
        | st.builds(sp.atan, st.sampled_from(symbols))
        | st.sampled_from([sp.sqrt(2), sp.sqrt(3), sp.pi, sp.sqrt(6)])
    )


def expressions(
    symbols: tuple[sp.Symbol, ...] = (x, y), leaves: int = 5
) -> st.SearchStrategy[sp.Expr]:
    """Trees of sums, products, small powers, and quotients whose denominators cannot vanish."""

    def grow(part: st.SearchStrategy[sp.Expr]) -> st.SearchStrategy[sp.Expr]:
        return (
            st.builds(lambda one, two: one + two, part, part)
            | st.builds(lambda one, two: one * two, part, part)
            | st.builds(lambda one, two: one - two, part, part)
            | st.builds(lambda one, n: one**n, part, st.integers(2, 3))
            | st.builds(lambda one, two: one / two, part, positive(symbols))
            | st.builds(lambda one: 1 / (1 + one**2), part)
        )

    return st.recursive(atoms(symbols), grow, max_leaves=leaves)


def entries(symbols: tuple[sp.Symbol, ...]) -> st.SearchStrategy[sp.Expr]:
    """Entries of random coframes: polynomial, trigonometric, hyperbolic, with a parameter."""
    s = st.sampled_from(symbols)
    return (
        st.just(sp.Integer(0))
        | st.just(sp.Integer(0))
        | st.integers(-2, 2).map(sp.Integer)
        | s
        | st.builds(lambda one, two: one * two, s, s)
        | st.builds(sp.sin, s)
        | st.builds(sp.cos, s)
        | st.builds(lambda one, two: one * sp.cos(two), s, s)
        | st.builds(lambda one: sp.sin(2 * one), s)
        | st.builds(lambda one: k * one, s)
        | st.builds(lambda one: sp.sin(k * one), s)
        | st.builds(sp.exp, s)
        | st.builds(sp.sinh, s)
    )


@st.composite
def coframes(
    draw: st.DrawFn, smallest: int = 2, largest: int = 3
) -> tuple[tuple[sp.Symbol, ...], sp.Matrix, tuple[int, ...]]:
    """Coordinates, a coframe that is regular near the origin, and a signature.

    The matrix is triangular with positive factors on its diagonal, and its rows are permuted: it
    is never singular and has no symmetry.
    """
    size = draw(st.integers(smallest, largest))
    coordinates = COORDINATES[:size]
    entry = entries(coordinates)
    matrix = sp.eye(size)
    for row in range(size):
        for column in range(row + 1, size):
            matrix[row, column] = draw(entry)
    for row in range(size):
        matrix[row, row] = draw(st.just(sp.Integer(1)) | positive(coordinates))
    order = draw(st.permutations(range(size)))
    matrix = sp.Matrix([matrix.row(i) for i in order])
    signature = draw(st.sampled_from([(1,) * size, (-1,) + (1,) * (size - 1)]))
    return coordinates, matrix, signature


def points(symbols: tuple[sp.Symbol, ...]) -> st.SearchStrategy[dict[sp.Symbol, Fraction]]:
    """Points in the open unit cube, away from its sides."""
    one = st.builds(Fraction, st.integers(3, 19), st.just(23))
    return st.fixed_dictionaries(dict.fromkeys(symbols, one))
