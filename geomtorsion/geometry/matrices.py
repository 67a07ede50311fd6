"""Matrices: sparse ones of exact elements, and those of a frame, each by its cheaper route."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import AllowanceError, LimitError
from geomtorsion.exact import Element, Field
from geomtorsion.geometry.components import Components, Index, Row, antisymmetric, symmetric, total
from geomtorsion.geometry.tensor import Tensor

if TYPE_CHECKING:
    from geomtorsion.geometry.frame import Frame


Entries = Mapping[Any, Element]
Pair = tuple[int, int, Element]


def blocks(entries: Entries, n: int) -> list[tuple[list[int], list[int]]]:
    """Independent blocks of a matrix up to permutation: pairs (rows, columns)."""
    columns_of: dict[int, list[int]] = defaultdict(list)
    rows_of: dict[int, list[int]] = defaultdict(list)
    for i, j in entries:
        columns_of[i].append(j)
        rows_of[j].append(i)
    found = []
    seen: set[int] = set()
    for start in range(n):
        if start in seen:
            continue
        rows, columns, waiting = {start}, set(), [start]
        while waiting:
            for j in columns_of[waiting.pop()]:
                if j not in columns:
                    columns.add(j)
                    new = set(rows_of[j]) - rows
                    rows |= new
                    waiting.extend(new)
        seen |= rows
        found.append((sorted(rows), sorted(columns)))
    return found


def _minors(
    field: Field, entries: Entries, rows: Sequence[int], columns: Sequence[int]
) -> dict[int, Element]:
    """Minors of all given rows, by the bit mask of their columns (Laplace, row by row)."""
    # Minors of the first rows are shared by all that follow: 2^n products, not n!.
    minors = {0: field.one}
    for row in rows:
        collected: dict[int, list] = defaultdict(list)
        for mask, minor in minors.items():
            for place, column in enumerate(columns):
                bit = 1 << place
                entry = entries.get((row, column))
                if mask & bit or entry is None:
                    continue
                sign = -1 if (mask >> place).bit_count() % 2 else 1
                collected[mask | bit].append((sign, minor, entry))
        summed = {mask: field.sum(terms) for mask, terms in collected.items()}
        minors = {mask: value for mask, value in summed.items() if not value.is_zero}
    return minors


def _is_odd(order: Sequence[int]) -> bool:
    """Whether a permutation, given as a list of distinct numbers, is odd."""
    inversions = sum(
        order[i] > order[j] for i in range(len(order)) for j in range(i + 1, len(order))
    )
    return inversions % 2 == 1


def determinant(field: Field, entries: Entries, n: int) -> Element:
    """Determinant, block by block."""
    result = field.one
    row_order: list[int] = []
    column_order: list[int] = []
    for rows, columns in blocks(entries, n):
        if len(rows) != len(columns):
            return field.zero
        minor = _minors(field, entries, rows, columns).get((1 << len(rows)) - 1)
        if minor is None:
            return field.zero
        result = result * minor
        row_order += rows
        column_order += columns
    return -result if _is_odd(row_order) != _is_odd(column_order) else result


def inverse(field: Field, entries: Entries, n: int) -> dict[tuple[int, int], Element]:
    """Inverse of a regular matrix, block by block, by cofactors."""
    found: dict[tuple[int, int], Element] = {}
    for rows, columns in blocks(entries, n):
        size = len(rows)
        if size == 1:
            i, j = rows[0], columns[0]
            found[j, i] = field.inverse(entries[i, j], briefly=True)
            continue
        everything = (1 << size) - 1
        cofactors: dict[tuple[int, int], Element] = {}
        for r, row in enumerate(rows):
            others = rows[:r] + rows[r + 1 :]
            for mask, minor in _minors(field, entries, others, columns).items():
                c = (everything ^ mask).bit_length() - 1
                cofactors[row, columns[c]] = -minor if (r + c) % 2 else minor
        # The determinant along the first row costs nothing more: its cofactors are there.
        first = rows[0]
        det = field.sum(
            [
                (1, entries[first, j], cofactors[first, j])
                for j in columns
                if (first, j) in cofactors and (first, j) in entries
            ]
        )
        reciprocal = field.inverse(det, briefly=True)
        for (i, j), cofactor in cofactors.items():
            found[j, i] = cofactor * reciprocal
    return found


def pairs_of_inverse(
    field: Field, entries: Entries, inverted: Entries, n: int
) -> dict[tuple[int, int], tuple[Element, list[Pair]]]:
    """E_i^a E_j^b - E_i^b E_j^a of the inverse E[a, i], for i < j: a factor, (a, b, value), a < b.

    Such a minor of the inverse is, up to its sign, the minor of all other rows and columns over the
    determinant (Jacobi): no square of the determinant is left that would cancel. The factor is
    1 over the determinant of a block; the values are to be multiplied by it.
    """
    found: dict[tuple[int, int], tuple[Element, list[Pair]]] = {}
    single: list[list[tuple[int, int, Element]]] = []
    for rows, columns in blocks(entries, n):
        everything = (1 << len(rows)) - 1
        whole = _minors(field, entries, rows, columns)[everything]
        reciprocal = field.inverse(whole, briefly=True) if len(rows) > 1 else field.one
        for r, s in combinations(range(len(rows)), 2):
            others = [row for k, row in enumerate(rows) if k not in (r, s)]
            minors: list[Pair] = []
            for mask, minor in _minors(field, entries, others, columns).items():
                c, d = (k for k in range(len(rows)) if not mask >> k & 1)
                value = -minor if (r + s + c + d) % 2 else minor
                minors.append((columns[c], columns[d], value))
            found[rows[r], rows[s]] = (reciprocal, minors)
        own = [(i, a) for i in rows for a in columns if (a, i) in inverted]
        single.append([(i, a, inverted[a, i]) for i, a in own])
    for one, two in combinations(single, 2):
        for i, a, first in one:
            for j, b, second in two:
                sign = 1 if (i < j) == (a < b) else -1
                place = (min(i, j), max(i, j))
                value = field.sum([(sign, first, second)])
                products = found.setdefault(place, (field.one, []))[1]
                products.append((min(a, b), max(a, b), value))
    return found


def dependence(field: Field, entries: Entries, n: int) -> dict[int, Element] | None:
    """Coefficients c_i with sum_i c_i row_i = 0, the last of them 1; None for a regular matrix."""
    done: list[tuple[int, dict[int, Element], dict[int, Element]]] = []
    for i in range(n):
        row = {j: entries[i, j] for j in range(n) if (i, j) in entries}
        combination = {i: field.one}
        for pivot, other, others in done:
            if pivot not in row:
                continue
            factor = row[pivot] / other[pivot]
            row = _minus(field, row, other, factor)
            combination = _minus(field, combination, others, factor)
        if not row:
            return combination
        done.append((min(row), row, combination))
    return None


def _minus(
    field: Field, first: Mapping[int, Element], second: Mapping[int, Element], factor: Element
) -> dict[int, Element]:
    """first - factor * second, without zeros."""
    found = {}
    for key in {**first, **second}:
        terms = []
        if key in first:
            terms.append((1, first[key]))
        if key in second:
            terms.append((-1, factor, second[key]))
        value = field.sum(terms)
        if not value.is_zero:
            found[key] = value
    return found


HALF = Fraction(1, 2)


def metric(frame: Frame) -> Components:
    """g_ab: as given, or e^i_a eta_ij e^j_b."""
    upper = frame.given.get("metric")
    if upper is None:
        upper = _squared(frame, frame.coframe.components.rows, frame.given["eta"])
    else:
        upper = {index: value for index, value in upper.items() if index[0] <= index[1]}
    return Components.known(2, frame.dimension, upper, symmetric(2))


def inverse_metric(frame: Frame) -> Components:
    """g^ab: inverse of the metric, or from the legs where the coframe is sparser."""
    if inverts_metric(frame):
        entries = inverse(frame.field, frame.metric.components.nonzero, frame.dimension)
        upper = {index: value for index, value in entries.items() if index[0] <= index[1]}
    else:
        constants = frame.inverse_eta.components.nonzero
        upper = _squared(frame, frame.legs.components.columns, constants)
    return Components.known(2, frame.dimension, upper, symmetric(2))


def coframe(frame: Frame) -> Components:
    """e^i_a: as given, or the completed squares of the metric times their roots."""
    entries = frame.given.get("coframe")
    if entries is None:
        scales = _scales(frame)
        entries = {(i, mu): value * scales[i] for (i, mu), value in frame.given["rows"].items()}
    return Components.known(2, frame.dimension, entries)


def _scales(frame: Frame) -> list[Element]:
    """sqrt|q_i| of the completed squares."""

    def scale(i: int) -> Element:
        try:
            return (frame.given["squares"][i, i] * frame.given["eta"][i, i]).sqrt()
        except AllowanceError:
            raise
        except LimitError as error:
            raise LimitError(
                f"leg {i} of this metric has the root of a long sum in it: {error}. Torsion, "
                "connections and curvature need no legs; or give a coframe"
            ) from None

    def make() -> list[Element]:
        return [scale(i) for i in range(frame.dimension)]

    return frame.derived("scales", make)


def legs(frame: Frame) -> Components:
    """E_i^a: as given, the inverse of the coframe, or g^ab e_ib where the metric is simpler."""
    n = frame.dimension
    entries = frame.given.get("legs")
    if entries is None and "rows" in frame.given:
        inverses = [scale.inverse() for scale in _scales(frame)]
        duals = parallel_rows(frame).duals.nonzero
        entries = {(mu, i): value * inverses[i] for (mu, i), value in duals.items()}
    elif entries is None and goes_through_metric(frame):
        entries = _raised(frame, frame.coframe.lowered(0).components)
    elif entries is None:
        entries = inverse(frame.field, frame.given["coframe"], n)
    return Components.known(2, n, entries)


def _raised(frame: Frame, rows: Components) -> dict[Index, Element]:
    """g^ab r_ib at (a, i)."""
    entries = {}
    for mu, row in enumerate(frame.inverse_metric.components.rows):
        for i in range(frame.dimension):
            pairs = [(x, rows.get((i, nu))) for nu, x in row]
            value = total(frame.field, [(1, x, y) for x, y in pairs if y is not None])
            if value is not None:
                entries[mu, i] = value
    return entries


@dataclass(frozen=True)
class ParallelRows:
    """Rows r^i with e^i = f_i r^i, chosen so that no square root is met.

    forms: r^i_b at (i, b). duals: f_i E_i^b at (b, i). derivative: (d_a e^i_b) / f_i at (a, i, b).
    """

    forms: Components
    duals: Components
    derivative: Components


def parallel_rows(frame: Frame) -> ParallelRows:
    """Rows to make a connection with parallel legs from: the factors f_i drop out of it."""
    if "rows" not in frame.given:
        legs_, derivative = frame.legs.components, frame.coframe_derivative
        return ParallelRows(frame.coframe.components, legs_, derivative)

    def make() -> ParallelRows:
        n, rows, squares = frame.dimension, frame.given["rows"], frame.given["squares"]
        lowered = {(i, a): value * squares[i, i] for (i, a), value in rows.items()}
        duals = _raised(frame, Components.known(2, n, lowered))
        # d_a(f r) / f = d_a r + (d_a f / f) r, and d_a f / f is half that of q = f**2: no root.
        halves = [squares[i, i].inverse() * HALF for i in range(n)]

        def rule(index: Index) -> Element | None:
            a, i, b = index
            row = rows.get((i, b))
            if row is None:
                return None
            along = frame.coordinates[a]
            slope = squares[i, i].diff(along)
            return frame.field.sum([(1, row.diff(along)), (1, slope, halves[i], row)])

        forms = Components.known(2, n, rows)
        return ParallelRows(forms, Components.known(2, n, duals), Components(3, n, rule))

    return frame.derived("parallel_rows", make)


def inverts_metric(frame: Frame) -> bool:
    """Whether the inverse metric comes from the metric: it is given, or as sparse and short."""
    if "metric" in frame.given:
        return True
    if is_dense(frame):
        return False
    return len(frame.metric.components.nonzero) <= len(frame.given["coframe"])


def goes_through_metric(frame: Frame) -> bool:
    """Whether the legs come from the inverse metric: it falls into smaller blocks."""
    n = frame.dimension
    size = max(len(rows) for rows, _ in blocks(frame.given["coframe"], n))
    metric_size = max(len(rows) for rows, _ in blocks(frame.metric.components.nonzero, n))
    return inverts_metric(frame) and metric_size < size


def _squared(frame: Frame, rows: Sequence[Row], constants: Entries) -> dict[Index, Element]:
    """Upper triangle of rows^T constants rows."""
    collected: dict[Index, list] = {}
    for (i, j), value in constants.items():
        factor = (value.as_fraction(),) if value.is_rational else (1, value)
        for mu, first in rows[i]:
            for nu, second in rows[j]:
                if mu <= nu:
                    collected.setdefault((mu, nu), []).append((*factor, first, second))
    return {index: frame.field.sum(terms) for index, terms in collected.items()}


def coframe_derivative(frame: Frame) -> Components:
    """d_a e^i_b at (a, i, b)."""
    if "rows" in frame.given:
        unscaled, scales = parallel_rows(frame).derivative.get, _scales(frame)

        def scaled(index: Index) -> Element | None:
            value = unscaled(index)
            return None if value is None else value * scales[index[1]]

        return Components(3, frame.dimension, scaled)
    get, coordinates = frame.coframe.components.get, frame.coordinates

    def rule(index: Index) -> Element | None:
        value = get(index[1:])
        return None if value is None else value.diff(coordinates[index[0]])

    return Components(3, frame.dimension, rule)


def curl(frame: Frame) -> Components:
    """d_a e^k_b - d_b e^k_a at (a, b, k)."""

    def make() -> Components:
        derivative = frame.coframe_derivative.get

        def rule(index: Index) -> Element | None:
            a, b, k = index
            one, two = derivative((a, k, b)), derivative((b, k, a))
            if two is None:
                return one
            return -two if one is None else frame.field.sum([(1, one), (-1, two)])

        return Components(3, frame.dimension, rule, antisymmetric(3))

    return frame.derived("curl", make)


def anholonomy(frame: Frame) -> Tensor:
    """C_ij^k = E_i^a E_j^b (d_a e^k_b - d_b e^k_a), slots DDU."""
    if not is_dense(frame):
        return Tensor(frame, "ddU", curl(frame), antisymmetric(3), "C", "anholonomy").in_frame()
    get, pairs = curl(frame).get, _pairs_of_legs(frame)

    def rule(index: Index) -> Element | None:
        i, j, k = index
        factor, minors = pairs()[i, j]
        found = [(x, get((a, b, k))) for a, b, x in minors]
        value = total(frame.field, [(1, x, y) for x, y in found if y is not None])
        return None if value is None else value * factor

    return Tensor(frame, "DDU", rule, antisymmetric(3), "C", "anholonomy")


def is_dense(frame: Frame) -> bool:
    """Whether the coframe is given and at most half as long as the metric.

    Then what follows from the anholonomy in the frame is shorter than what follows from the metric,
    also with the way back to coordinates.
    """
    if "metric" in frame.given:
        return False
    return frame.derived(
        "is_dense", lambda: 2 * frame.coframe.components.length <= frame.metric.components.length
    )


def _pairs_of_legs(frame: Frame) -> Callable[[], dict[tuple[int, int], tuple[Element, list[Pair]]]]:
    """E_i^a E_j^b - E_i^b E_j^a of all legs i < j, made when they are asked for."""
    entries, inverted = frame.coframe.components, frame.legs.components

    def make() -> dict[tuple[int, int], tuple[Element, list[Pair]]]:
        n = frame.dimension
        return pairs_of_inverse(frame.field, entries.nonzero, inverted.nonzero, n)

    return lambda: frame.derived("pairs_of_legs", make)


def coframe_determinant(frame: Frame) -> Element:
    """det e^i_a."""
    return determinant(frame.field, frame.coframe.components.nonzero, frame.dimension)


def volume(frame: Frame) -> Element:
    """det e * sqrt|det eta|; real for a null tetrad, whose determinant is imaginary."""
    eta = determinant(frame.field, frame.given["eta"], frame.dimension)
    det = frame.determinant.element()
    # The legs of a null tetrad come in conjugate pairs, which makes the determinant imaginary.
    if frame.complex and det.conjugate() == -det:
        det = det * frame.field.imaginary
    size = eta if eta.sympy.is_positive else -eta
    return det if size == frame.field.one else det * size.sqrt()
