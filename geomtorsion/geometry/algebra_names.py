"""Names of Lie algebras: Bianchi types, real simple algebras, their sums and extensions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from functools import cache
from itertools import combinations, product

from geomtorsion.exact import Element, Reduced, Specialization, reduced, signature, vanishes
from geomtorsion.geometry.brackets import Brackets

# The names of three-dimensional algebras that have one beside their Bianchi type.
_THREE = {
    "I": "R^3",
    "II": "Heisenberg algebra",
    "III": "aff(R) + R",
    "VI_0": "e(1, 1)",
    "VII_0": "e(2)",
    "VIII": "sl(2, R)",
    "IX": "so(3)",
}


def name(algebra: Brackets) -> str:
    """See LieAlgebra.name."""
    d = algebra.dimension
    if not algebra.table:
        return {0: "trivial", 1: "R"}.get(d, f"R^{d}")
    if d == 3:
        bianchi_type = bianchi(algebra)
        assert bianchi_type is not None
        return _THREE.get(bianchi_type, f"Bianchi {bianchi_type}")
    if not algebra.radical.rank:
        return _semisimple(algebra)
    factor = _central_factor(algebra)
    if factor.rank:
        rest = name(algebra.quotient(factor))
        return f"{rest} + {'R' if factor.rank == 1 else f'R^{factor.rank}'}"
    if algebra.radical.rank == d:
        return _solvable(algebra)
    return _mixed(algebra)


# -- three dimensions ------------------------------------------------------------------------------


def bianchi(algebra: Brackets) -> str | None:
    """See LieAlgebra.bianchi.

    C_ij^k = epsilon_ijl n^lk + delta_j^k a_i - delta_i^k a_j, and in class B
    a_i a_j = h epsilon_ikl epsilon_jmn n^km n^ln / 2 [EllisMacCallum1969].
    """
    if algebra.dimension != 3:
        return None
    field, C = algebra.field, algebra.constant
    a = [field.sum([(1, C(i, k)[k]) for k in range(3)]) / 2 for i in range(3)]
    # C_23^k, C_31^k, C_12^k, whose antisymmetric part is a.
    cyclic = [C(1, 2), C(2, 0), C(0, 1)]
    n = [[(cyclic[i][k] + cyclic[k][i]) / 2 for k in range(3)] for i in range(3)]
    positive, negative, zero = signature(field, n)
    rank = 3 - zero
    is_definite = positive * negative == 0
    traced = next((i for i in range(3) if not vanishes(a[i])), None)
    if traced is None:
        two = "VII_0" if is_definite else "VI_0"
        return ("I", "II", two, "IX" if is_definite else "VIII")[rank]
    if rank < 2:
        return ("V", "IV")[rank]
    j, k = (m for m in range(3) if m != traced)
    h = a[traced] * a[traced] / (n[j][j] * n[k][k] - n[j][k] * n[j][k])
    if h == -1:
        return "III"
    return f"{'VII_h' if is_definite else 'VI_h'}, h = {h.sympy}"


# -- semisimple algebras ---------------------------------------------------------------------------

# Name, dimension, positive squares of the Killing form, 1 for the underlying real algebra of a
# complex one.
Simple = tuple[str, int, int, int]


def _simple(largest: int) -> Iterator[Simple]:
    """The real simple algebras up to a dimension (Cartan), isomorphic ones once."""
    yield from [("so(3)", 3, 0, 0), ("sl(2, R)", 3, 2, 0), ("so(3, 1)", 6, 3, 1)]
    yield from [("g2", 14, 0, 0), ("split g2", 14, 8, 0), ("complex g2", 28, 14, 1)]
    yield from [("sp(3)", 21, 0, 0), ("sp(6, R)", 21, 12, 0), ("sp(1, 2)", 21, 8, 0)]
    for n in range(3, largest):
        if n != 4:
            yield f"sl({n}, R)", n * n - 1, (n - 1) * (n + 2) // 2, 0
        yield f"sl({n}, C)", 2 * (n * n - 1), n * n - 1, 1
        for q in range(n // 2 + 1):
            # su(4), su(2, 2) are so(6), so(4, 2).
            if n != 4 or q == 1:
                label = f"su({n - q}, {q})" if q else f"su({n})"
                yield label, n * n - 1, 2 * (n - q) * q, 0
    for n in range(5, largest):
        if n != 6:
            yield f"so({n}, C)", n * (n - 1), n * (n - 1) // 2, 1
        for q in range(n // 2 + 1):
            label = f"so({n - q}, {q})" if q else f"so({n})"
            yield label, n * (n - 1) // 2, (n - q) * q, 0


@cache
def _sums(dimension: int, positive: int) -> tuple[tuple[str, int, int], ...]:
    """Sums of simple algebras: name, number of ideals, number of complex ones."""
    every = sorted((s for s in _simple(dimension) if s[1] <= dimension), key=lambda s: s[1:])
    sums: list[tuple[str, int, int]] = []

    def fill(start: int, left: tuple[int, int], parts: tuple[Simple, ...]) -> None:
        if left == (0, 0):
            label = _joined([part[0] for part in parts])
            sums.append((label, len(parts), sum(part[3] for part in parts)))
            return
        for k in range(start, len(every)):
            rest = left[0] - every[k][1], left[1] - every[k][2]
            if min(rest) >= 0:
                fill(k, rest, (*parts, every[k]))

    fill(0, (dimension, positive), ())
    return tuple(sums)


def _joined(parts: Sequence[str]) -> str:
    """A direct sum of simple algebras; so(4) and so(2, 2) have a name of their own."""
    counts = Counter(parts)
    for own, whole in (("so(3)", "so(4)"), ("sl(2, R)", "so(2, 2)")):
        if counts == {own: 2}:
            return whole
    return " + ".join(counts.elements())


def _semisimple(algebra: Brackets) -> str:
    """The simple ideals, from dimension, Killing form and, where these leave a choice, centroid."""
    d, (positive, _, _) = algebra.dimension, algebra.signature
    sums = _sums(d, positive)
    names = [label for label, _, _ in sums]
    if len(names) > 1:
        numbers = _ideals(algebra)
        names = [label for label, *counts in sums if tuple(counts) == numbers]
    return " or ".join(names) or f"semisimple algebra of dimension {d}"


def _ideals(algebra: Brackets) -> tuple[int, int]:
    """The number of simple ideals, and of those that are complex.

    The maps that commute with ad are numbers on each ideal, real or complex ones. The trace of the
    product of two is positive for real numbers, and has one positive and one negative square for
    complex ones.
    """
    algebra = _sampled(algebra)
    n, field = algebra.dimension, algebra.field
    equations = []
    # Two generic elements generate a semisimple algebra; their weights are arbitrary whole numbers.
    for seed in (3, 7):
        element = [field.rational((seed * (i + 2) ** 3) % 101 - 50) for i in range(n)]
        images = [algebra.bracket(element, algebra.unit(j)) for j in range(n)]
        for r, c in product(range(n), repeat=2):
            row = [field.zero] * (n * n)
            for m in range(n):
                row[r * n + m] = row[r * n + m] + images[c][m]
                row[m * n + c] = row[m * n + c] - images[m][r]
            equations.append(row)
    maps = reduced(field, equations, n * n).kernel()
    places = [(r * n + c, c * n + r) for r, c in product(range(n), repeat=2)]
    traces = [[field.sum([(1, one[k], two[m]) for k, m in places]) for two in maps] for one in maps]
    ideals, complex_ones, _ = signature(field, traces)
    return ideals, complex_ones


def _sampled(algebra: Brackets) -> Brackets:
    """The algebra with numbers for its symbols, near those at which signs are read off."""
    place = Specialization(algebra.field, algebra.field.symbols, 16)
    table = {pair: place.all(row) for pair, row in algebra.table.items()}
    return Brackets.of(place.field, algebra.dimension, table)


# -- with a radical --------------------------------------------------------------------------------


def _central_factor(algebra: Brackets) -> Reduced:
    """Central elements that are independent modulo brackets."""
    derived = algebra.derived[0]
    outside = reduced(algebra.field, [derived.rest(z) for z in algebra.center], algebra.dimension)
    # As many central elements as there are independent rests.
    chosen: list[list[Element]] = []
    for z in algebra.center:
        trial = [*chosen, z]
        rests = [derived.rest(one) for one in trial]
        if reduced(algebra.field, rests, algebra.dimension).rank == len(trial):
            chosen = trial
        if len(chosen) == outside.rank:
            break
    return reduced(algebra.field, chosen, algebra.dimension)


def _solvable(algebra: Brackets) -> str:
    """The name of a solvable algebra without a central factor."""
    d, series = algebra.dimension, algebra.derived_dimensions
    if d == 2:
        return "aff(R)"
    if algebra.lower_central[-1] == 0:
        if len(algebra.center) == 1 and series == (d, 1, 0):
            return f"Heisenberg algebra of dimension {d}"
        steps = ", ".join(map(str, algebra.lower_central))
        return f"nilpotent algebra of dimension {d}, lower central series {steps}"
    if d == 4 and len(algebra.center) == 1 and series == (4, 3, 1, 0):
        return _oscillator(algebra)
    return f"solvable algebra of dimension {d}, derived series {', '.join(map(str, series))}"


def _oscillator(algebra: Brackets) -> str:
    """e(2) or e(1, 1) with a central element: the oscillator algebra of Nappi and Witten."""
    quotient = algebra.quotient(algebra.span(algebra.center))
    alias = _THREE.get(bianchi(quotient) or "", "")
    if alias == "e(2)":
        return "oscillator algebra"
    if alias == "e(1, 1)":
        return "split oscillator algebra"
    return "solvable algebra of dimension 4, derived series 4, 3, 1, 0"


def _mixed(algebra: Brackets) -> str:
    """A semisimple algebra that acts on a radical."""
    radical = algebra.radical
    levi = algebra.quotient(radical)
    inner = name(levi)
    m = radical.rank
    if all(vanishes(x) for a, b in combinations(radical.rows, 2) for x in algebra.bracket(a, b)):
        form = _invariant_form(algebra) if levi.dimension == m * (m - 1) // 2 else None
        if form is not None:
            q, p = sorted(form)
            return f"e({p})" if q == 0 else f"iso({p}, {q})"
        return f"{inner} acting on R^{m}"
    return f"{inner} acting on the radical: {name(algebra.subalgebra(radical))}"


def _invariant_form(algebra: Brackets) -> tuple[int, int] | None:
    """Signature of the only symmetric form on an abelian radical that the algebra preserves.

    A faithful algebra of dimension m (m - 1) / 2 that preserves it is the whole of so(p, q).
    """
    field, radical = algebra.field, algebra.radical
    m = radical.rank
    pairs = [(i, j) for i in range(m) for j in range(i, m)]
    place = {pair: k for k, pair in enumerate(pairs)} | {
        (j, i): k for k, (i, j) in enumerate(pairs)
    }
    rows = []
    for k in radical.free:
        # action[i][j]: [X_k, R_i] = action[i][j] R_j
        images = [algebra.bracket(algebra.unit(k), row) for row in radical.rows]
        action = [[image[pivot] for pivot in radical.pivots] for image in images]
        for i, j in pairs:
            row = [field.zero] * len(pairs)
            for n in range(m):
                row[place[n, j]] = row[place[n, j]] + action[i][n]
                row[place[i, n]] = row[place[i, n]] + action[j][n]
            rows.append(row)
    forms = reduced(field, rows, len(pairs)).kernel()
    if len(forms) != 1:
        return None
    matrix = [[forms[0][place[i, j]] for j in range(m)] for i in range(m)]
    positive, negative, zero = signature(field, matrix)
    return None if zero else (positive, negative)
