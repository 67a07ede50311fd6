"""Frames: random frames with random connections of every maker, small enough to be fast."""

from __future__ import annotations

from itertools import combinations

import sympy as sp
from hypothesis import strategies as st

from geomtorsion.geometry import (
    Connection,
    Frame,
    blend,
    cartan,
    from_coefficients,
    from_contortion,
    from_spin_connection,
    levi_civita,
)

COORDINATES = sp.symbols("x y z u v", real=True)
SHARE, STRENGTH = sp.symbols("s k", real=True)
MAKERS = ("cartan", "levi_civita", "spin", "contortion", "coefficients", "blend", "family")


def entries(symbols: tuple[sp.Symbol, ...]) -> st.SearchStrategy[sp.Expr]:
    """Polynomial, trigonometric and exponential entries, with a parameter, mostly zero."""
    s = st.sampled_from(symbols)
    return (
        st.just(sp.Integer(0))
        | st.just(sp.Integer(0))
        | st.integers(-2, 2).map(sp.Integer)
        | s
        | st.builds(lambda one, two: one * two, s, s)
        | st.builds(sp.sin, s)
        | st.builds(lambda one: sp.cos(2 * one), s)
        | st.builds(lambda one: STRENGTH * one, s)
        | st.builds(sp.exp, s)
    )


@st.composite
def frames(draw: st.DrawFn, smallest: int = 2, largest: int = 4) -> Frame:
    """A frame with unit-triangular coframe times a factor, rows shuffled, of either signature.

    In higher dimensions few entries are off the diagonal, so that exact work stays short.
    """
    n = draw(st.integers(smallest, largest))
    symbols = COORDINATES[:n]
    matrix = sp.eye(n)
    places = list(combinations(range(n), 2))
    most = 3 if n < 4 else 2
    chosen = draw(st.lists(st.sampled_from(places), min_size=1, max_size=most, unique=True))
    for place in chosen:
        matrix[place] = draw(entries(symbols))
    row, symbol = draw(st.integers(0, n - 1)), draw(st.sampled_from(symbols))
    matrix[row, row] = draw(st.sampled_from([1, 1 + symbol**2, sp.exp(symbol), 2 + sp.sin(symbol)]))
    order = draw(st.permutations(range(n)))
    matrix = sp.Matrix([matrix.row(i) for i in order])
    signature = draw(st.sampled_from([(1,) * n, (-1,) + (1,) * (n - 1)]))
    return Frame(symbols, matrix, signature=signature)


def sparse_array(draw: st.DrawFn, frame: Frame, size: int = 3) -> list:
    """n x n x n entries, a few of them not zero."""
    n = frame.dimension
    array = [[[sp.Integer(0)] * n for _ in range(n)] for _ in range(n)]
    index = st.integers(0, n - 1)
    for _ in range(size):
        a, b, c = draw(index), draw(index), draw(index)
        array[a][b][c] = draw(entries(frame.coordinates))
    return array


def antisymmetric_array(draw: st.DrawFn, frame: Frame) -> list:
    """omega_ai^j with omega_aij antisymmetric: a connection that keeps lengths."""
    n = frame.dimension
    lower = sparse_array(draw, frame)
    eta = [frame.eta[i, i] for i in range(n)]
    return [
        [[(lower[a][i][j] - lower[a][j][i]) * eta[j] for j in range(n)] for i in range(n)]
        for a in range(n)
    ]


@st.composite
def connections(draw: st.DrawFn, largest: int = 3, makers: tuple[str, ...] = MAKERS) -> Connection:
    """A connection over a random frame, from any maker."""
    frame = draw(frames(largest=largest))
    maker = draw(st.sampled_from(makers))
    if maker == "cartan":
        return cartan(frame)
    if maker == "levi_civita":
        return levi_civita(frame)
    if maker == "spin":
        return from_spin_connection(frame, antisymmetric_array(draw, frame))
    if maker == "contortion":
        bent = from_spin_connection(frame, antisymmetric_array(draw, frame))
        return from_contortion(frame, bent.contortion * draw(st.integers(1, 3)))
    if maker == "coefficients":
        return from_coefficients(frame, sparse_array(draw, frame))
    if maker == "family":
        return blend(levi_civita(frame), cartan(frame), SHARE)
    return blend(cartan(frame), from_coefficients(frame, sparse_array(draw, frame)), SHARE)
