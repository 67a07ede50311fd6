"""Frame matrices: from coordinates to the frame and back, each by its cheaper route."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from geomtorsion.errors import AllowanceError, LimitError
from geomtorsion.exact import Element
from geomtorsion.geometry.components import (
    Components,
    Entries,
    Index,
    Pair,
    Row,
    antisymmetric,
    blocks,
    determinant,
    inverse,
    pairs_of_inverse,
    symmetric,
)
from geomtorsion.geometry.derived import derived
from geomtorsion.geometry.tensor import Tensor

if TYPE_CHECKING:
    from geomtorsion.geometry.frame import Frame

HALF = Fraction(1, 2)


def metric(frame: Frame) -> Components:
    """g_ab: as given, or e^i_a eta_ij e^j_b."""
    upper = frame.given.get("metric")
    if upper is None:
        upper = _squared(frame, frame.coframe.components.rows, frame.given["eta"])
    else:
        upper = {index: value for index, value in upper.items() if index[0] <= index[1]}
    return Components.known(frame.field, 2, frame.dimension, upper, symmetric(2))


def inverse_metric(frame: Frame) -> Components:
    """g^ab: inverse of the metric, or from the legs where the coframe is sparser."""
    if inverts_metric(frame):
        entries = inverse(frame.field, frame.metric.components.nonzero, frame.dimension)
        upper = {index: value for index, value in entries.items() if index[0] <= index[1]}
    else:
        constants = frame.inverse_eta.components.nonzero
        upper = _squared(frame, frame.legs.components.columns, constants)
    return Components.known(frame.field, 2, frame.dimension, upper, symmetric(2))


def coframe(frame: Frame) -> Components:
    """e^i_a: as given, or the completed squares of the metric times their roots."""
    entries = frame.given.get("coframe")
    if entries is None:
        scales = _scales(frame)
        entries = {(i, mu): value * scales[i] for (i, mu), value in frame.given["rows"].items()}
    return Components.known(frame.field, 2, frame.dimension, entries)


@derived
def _scales(frame: Frame) -> list[Element]:
    """sqrt|q_i| of the completed squares."""

    def scale(i: int) -> Element:
        try:
            return (frame.given["squares"][i, i] * frame.given["eta"][i, i]).sqrt()
        except AllowanceError:
            raise
        except LimitError as error:
            raise LimitError(
                f"leg {i} of this metric contains the root of a long sum: {error}. Torsion, "
                "connections and curvature do not need the legs; otherwise give a coframe"
            ) from None

    return [scale(i) for i in range(frame.dimension)]


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
    return Components.known(frame.field, 2, n, entries)


def _raised(frame: Frame, rows: Components) -> dict[Index, Element]:
    """g^ab r_ib at (a, i)."""
    entries = {}
    for mu, row in enumerate(frame.inverse_metric.components.rows):
        for i in range(frame.dimension):
            entries[mu, i] = frame.field.sum([(1, x, rows.get((i, nu))) for nu, x in row])
    return entries


@dataclass(frozen=True)
class ParallelRows:
    """Rows r^i with e^i = f_i r^i, chosen so that no square root is met.

    forms: r^i_b at (i, b). duals: f_i E_i^b at (b, i). derivative: (d_a e^i_b) / f_i at (a, i, b).
    """

    forms: Components
    duals: Components
    derivative: Components


@derived
def parallel_rows(frame: Frame) -> ParallelRows:
    """Rows to make a connection with parallel legs from: the factors f_i cancel."""
    if "rows" not in frame.given:
        legs_, derivative = frame.legs.components, frame.coframe_derivative
        return ParallelRows(frame.coframe.components, legs_, derivative)
    field, n = frame.field, frame.dimension
    rows, squares = frame.given["rows"], frame.given["squares"]
    lowered = {(i, a): value * squares[i, i] for (i, a), value in rows.items()}
    duals = _raised(frame, Components.known(field, 2, n, lowered))
    # d_a(f r) / f = d_a r + (d_a f / f) r, and d_a f / f = (d_a q / q) / 2 for q = f**2: no root.
    halves = [squares[i, i].inverse() * HALF for i in range(n)]

    def rule(index: Index) -> Element:
        a, i, b = index
        row, along = rows.get((i, b), field.zero), frame.coordinates[a]
        slope = squares[i, i].diff(along)
        return field.sum([(1, row.diff(along)), (1, slope, halves[i], row)])

    forms = Components.known(field, 2, n, rows)
    return ParallelRows(forms, Components.known(field, 2, n, duals), Components(field, 3, n, rule))


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

        def scaled(index: Index) -> Element:
            return unscaled(index) * scales[index[1]]

        return Components(frame.field, 3, frame.dimension, scaled)
    get, coordinates = frame.coframe.components.get, frame.coordinates

    def rule(index: Index) -> Element:
        return get(index[1:]).diff(coordinates[index[0]])

    return Components(frame.field, 3, frame.dimension, rule)


@derived
def curl(frame: Frame) -> Components:
    """d_a e^k_b - d_b e^k_a at (a, b, k)."""
    derivative = frame.coframe_derivative.get

    def rule(index: Index) -> Element:
        a, b, k = index
        return frame.field.sum([(1, derivative((a, k, b))), (-1, derivative((b, k, a)))])

    return Components(frame.field, 3, frame.dimension, rule, antisymmetric(3))


def anholonomy(frame: Frame) -> Tensor:
    """C_ij^k = E_i^a E_j^b (d_a e^k_b - d_b e^k_a), slots DDU."""
    if not is_dense(frame):
        return Tensor(frame, "ddU", curl(frame), antisymmetric(3), "C", "anholonomy").in_frame()
    get = curl(frame).get

    def rule(index: Index) -> Element:
        i, j, k = index
        factor, minors = _pairs_of_legs(frame)[i, j]
        return frame.field.sum([(1, x, get((a, b, k))) for a, b, x in minors]) * factor

    return Tensor(frame, "DDU", rule, antisymmetric(3), "C", "anholonomy")


@derived
def is_dense(frame: Frame) -> bool:
    """Whether the coframe is given and at most half as long as the metric.

    Then quantities computed from the anholonomy in the frame are shorter than from the metric, even
    with the conversion back to coordinates.
    """
    if "metric" in frame.given:
        return False
    return 2 * frame.coframe.components.length <= frame.metric.components.length


@derived
def _pairs_of_legs(frame: Frame) -> dict[tuple[int, int], tuple[Element, list[Pair]]]:
    """E_i^a E_j^b - E_i^b E_j^a of all legs i < j."""
    entries, inverted = frame.coframe.components.nonzero, frame.legs.components.nonzero
    return pairs_of_inverse(frame.field, entries, inverted, frame.dimension)


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
