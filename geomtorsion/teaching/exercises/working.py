"""Working: worked solutions by hand, in plain sympy and independent of the library."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations, product

import sympy as sp

from geomtorsion.geometry import Frame
from geomtorsion.teaching.exercises.families import matrix_of
from geomtorsion.teaching.exercises.tex import tex

Table = dict[tuple[int, ...], sp.Expr]


@dataclass(frozen=True, eq=False)
class Step:
    """A step of a worked solution.

    text: the step, Markdown with LaTeX. question: the question that it answers, or "".
    value: its answer, in any form that a solution has; derived by hand, not by the library.
    """

    text: str
    question: str = ""
    value: object = None


@lru_cache(maxsize=1024)
def tidy(expr: sp.Expr) -> sp.Expr:
    """An expression as short as sympy can write it."""
    return sp.simplify(sp.expand(expr)) if expr else sp.S.Zero


def nonzero(table: Mapping[tuple[int, ...], sp.Expr]) -> Table:
    """The nonzero components, simplified."""
    components = {key: tidy(value) for key, value in table.items()}
    return {key: value for key, value in components.items() if value != 0}


@lru_cache(maxsize=256)
def legs(frame: Frame) -> sp.ImmutableMatrix:
    """The inverse of the coframe: row mu, one leg per column."""
    rows = matrix_of(frame.coframe)
    inverse = rows.adjugate() / tidy(rows.det())
    return sp.ImmutableMatrix(inverse.applyfunc(tidy))


@lru_cache(maxsize=256)
def cartan_table(frame: Frame) -> Table:
    """Gamma_ab^c = E_i^c d_a e^i_b, component by component."""
    e, inverse, q = matrix_of(frame.coframe), legs(frame), frame.coordinates
    n = range(frame.dimension)
    return nonzero(
        {
            (a, b, c): sp.Add(*(inverse[c, i] * e[i, b].diff(q[a]) for i in n))
            for a, b, c in product(n, repeat=3)
        }
    )


@lru_cache(maxsize=256)
def curls(frame: Frame) -> Table:
    """d_a e^k_b - d_b e^k_a for a < b, by (a, b, k)."""
    e, q, n = matrix_of(frame.coframe), frame.coordinates, range(frame.dimension)
    return nonzero(
        {
            (a, b, k): e[k, b].diff(q[a]) - e[k, a].diff(q[b])
            for a, b in combinations(n, 2)
            for k in n
        }
    )


@lru_cache(maxsize=256)
def anholonomy(frame: Frame) -> Table:
    """C_ij^k = E_i^a E_j^b (d_a e^k_b - d_b e^k_a), the torsion 2S in the frame."""
    inverse, n = legs(frame), range(frame.dimension)
    components: Table = {}
    for i, j in combinations(n, 2):
        for (a, b, k), value in curls(frame).items():
            pair = inverse[a, i] * inverse[b, j] - inverse[b, i] * inverse[a, j]
            components[i, j, k] = components.get((i, j, k), sp.S.Zero) + pair * value
    half = nonzero(components)
    return half | {(j, i, k): -value for (i, j, k), value in half.items()}


def christoffel(frame: Frame) -> Table:
    """The Christoffel symbols of the metric e^T e."""
    rows, q, n = matrix_of(frame.coframe), frame.coordinates, range(frame.dimension)
    g = (rows.T * rows).applyfunc(tidy)
    inverse = (legs(frame) * legs(frame).T).applyfunc(tidy)
    lowered = {
        (a, b, d): (g[d, b].diff(q[a]) + g[a, d].diff(q[b]) - g[a, b].diff(q[d])) / 2
        for a, b, d in product(n, repeat=3)
    }
    return nonzero(
        {
            (a, b, c): sp.Add(*(inverse[c, d] * lowered[a, b, d] for d in n))
            for a, b, c in product(n, repeat=3)
        }
    )


def group_connection(constants: Mapping[tuple[int, ...], sp.Expr], n: int) -> Table:
    """D_i E_j = w_ij^k E_k of the metric, from constant C_ij^k in an orthonormal frame."""

    def c(i: int, j: int, k: int) -> sp.Expr:
        return constants.get((i, j, k), sp.S.Zero)

    return nonzero(
        {
            (i, j, k): -(c(i, j, k) - c(j, k, i) + c(k, i, j)) / 2
            for i, j, k in product(range(n), repeat=3)
        }
    )


def group_ricci(constants: Mapping[tuple[int, ...], sp.Expr], n: int) -> sp.Matrix:
    """The Ricci tensor in an orthonormal frame with constant C_ij^k, positive for spheres."""
    table = group_connection(constants, n)

    def w(i: int, j: int, k: int) -> sp.Expr:
        return table.get((i, j, k), sp.S.Zero)

    def ricci(j: int, k: int) -> sp.Expr:
        # The trace over i of R(E_i, E_j) E_k, with [E_i, E_j] = -C_ij^m E_m.
        return sp.Add(
            *(
                w(j, k, m) * w(i, m, i)
                - w(i, k, m) * w(j, m, i)
                + constants.get((i, j, m), sp.S.Zero) * w(m, k, i)
                for i, m in product(range(n), repeat=2)
            )
        )

    return sp.Matrix(n, n, lambda j, k: tidy(ricci(j, k)))


def quadratic_form(table: Mapping[tuple[int, ...], sp.Expr], rates: Sequence[sp.Symbol]) -> Table:
    """t_ab^c q'^a q'^b for each c."""
    components: Table = {}
    for (a, b, c), value in table.items():
        components[c,] = components.get((c,), sp.S.Zero) + value * rates[a] * rates[b]
    return components


def cross(one: Iterable[sp.Expr], two: Iterable[sp.Expr]) -> list[sp.Expr]:
    """The vector product."""
    return list(sp.Matrix(list(one)).cross(sp.Matrix(list(two))))


def listed(name: str, table: Mapping[tuple[int, ...], object], above: int = 1) -> str:
    """Components in LaTeX, indices counted from 1; the last `above` indices are upper ones.

    Examples
    --------
    >>> listed("S", {(0, 1, 1): sp.Rational(1, 2)})
    'S_{12}{}^{2} = \\\\frac{1}{2}'
    """
    name = {"Gamma": r"\Gamma", "Gamma_bar": r"\bar\Gamma", "omega_bar": r"\bar\omega"}.get(
        name, name
    )
    pieces = []
    for key, value in sorted(table.items()):
        numbers = [str(k + 1) for k in key]
        below, upper = numbers[: len(key) - above], numbers[len(key) - above :]
        lower = f"_{{{''.join(below)}}}{{}}" if below else ""
        raised = f"^{{{''.join(upper)}}}" if upper else ""
        pieces.append(f"{name}{lower}{raised} = {tex(value)}")
    return r",\quad ".join(pieces) or f"{name} = 0"


def differentials(frame: Frame) -> str:
    r"""d e^k of the forms that are not closed, each as a displayed formula.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> differentials(load("heisenberg").frame)
    '\\mathrm{d}e^{3} = - \\mathrm{d}x\\wedge\\mathrm{d}y'
    """
    q, sums = frame.coordinates, {}
    for (a, b, k), value in curls(frame).items():
        pair = rf"\mathrm{{d}}{tex(q[a])}\wedge\mathrm{{d}}{tex(q[b])}"
        minus = value.could_extract_minus_sign()
        size = -value if minus else value
        shown = rf"\left({tex(size)}\right)" if size.is_Add else tex(size)
        before = "- " if minus else "+ " if k in sums else ""
        factor = "" if size == 1 else rf"{shown}\,"
        sums.setdefault(k, []).append(f"{before}{factor}{pair}")
    return ",$$ $$".join(
        rf"\mathrm{{d}}e^{{{k + 1}}} = {' '.join(terms)}" for k, terms in sorted(sums.items())
    )


def surface_ricci(frame: Frame) -> tuple[sp.Expr, list[list[sp.Expr]], sp.Expr]:
    """K = -f''/f, R_ab = K g_ab and R = 2 K of dr^2 + f(r)^2 dphi^2."""
    f, r = matrix_of(frame.coframe)[1, 1], frame.coordinates[0]
    k = tidy(-f.diff(r, 2) / f)
    return k, [[k, sp.S.Zero], [sp.S.Zero, tidy(k * f**2)]], 2 * k


def is_flat(frame: Frame) -> bool:
    """Whether the Ricci tensor of e^T e vanishes: up to three dimensions, whether it is flat."""
    q, n, table = frame.coordinates, range(frame.dimension), christoffel(frame)

    def g(a: int, b: int, c: int) -> sp.Expr:
        return table.get((a, b, c), sp.S.Zero)

    def ricci(a: int, b: int) -> sp.Expr:
        slopes = (g(a, b, c).diff(q[c]) - g(c, b, c).diff(q[a]) for c in n)
        products = (
            g(c, d, c) * g(a, b, d) - g(a, d, c) * g(c, b, d) for c, d in product(n, repeat=2)
        )
        return sp.Add(*slopes, *products)

    return all(tidy(ricci(a, b)) == 0 for a in n for b in n)
