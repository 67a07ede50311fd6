"""Dense: random frames of mixed functions, whose entries become long when expanded."""

from __future__ import annotations

import sympy as sp
from hypothesis import strategies as st

from geomtorsion.geometry import Frame

COORDINATES = sp.symbols("x0:6", real=True)
SHAPE = sp.Function("f")


def entries(symbols: tuple[sp.Symbol, ...]) -> st.SearchStrategy[sp.Expr]:
    """Polynomial, trigonometric, exponential, root, tan, atan, hyperbolic, unknown function."""
    one, two = st.sampled_from(symbols), st.sampled_from(symbols)
    ratio = st.builds(sp.Rational, st.integers(1, 5), st.integers(1, 4))
    linear = st.builds(
        lambda numbers: sum((k * s for k, s in zip(numbers, symbols, strict=True)), symbols[0]),
        st.lists(st.integers(-1, 2), min_size=len(symbols), max_size=len(symbols)),
    )
    return st.one_of(
        st.builds(lambda c, a, b: c * a**2 * b + 1, ratio, one, two),
        st.builds(lambda c, a: c * sp.sin(a), ratio, linear),
        st.builds(sp.cos, linear),
        st.builds(lambda c, a: sp.exp(c * a), ratio, one),
        st.builds(lambda c, a, b: sp.sqrt(a**2 + b**2 + c), ratio, one, two),
        st.builds(lambda a: 1 / (2 * (a**2 + 2)), one),
        st.builds(lambda a: sp.tan(a / 4), one),
        st.builds(sp.atan, one),
        st.builds(SHAPE, one),
        st.builds(lambda a: (a**2 + 1) ** 2, one),
        st.builds(lambda a: sp.sinh(a) / 3, one),
    )


@st.composite
def dense_frames(draw: st.DrawFn, smallest: int = 2, largest: int = 3) -> Frame:
    """A frame without symmetry: full up to three dimensions, half or a quarter full above."""
    n = draw(st.integers(smallest, largest))
    symbols = COORDINATES[:n]
    entry = entries(symbols)
    rows: list[list[sp.Expr]] = [[sp.Integer(0)] * n for _ in range(n)]
    for i in range(n):
        for j in range(n):
            if i == j:
                rows[i][j] = draw(entry) + 3
            elif n < 4 or draw(st.integers(1, 4)) <= (2 if n == 4 else 1):
                rows[i][j] = draw(entry) / draw(st.integers(1, 3))
    eta = sp.diag(draw(st.sampled_from([1, -1])), sp.eye(n - 1))
    if draw(st.booleans()):
        # Two null legs replace the first two.
        eta[:2, :2] = sp.Matrix([[0, 1], [1, 0]])
    return Frame(symbols, rows, signature=eta)
