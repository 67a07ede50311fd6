"""Riemannian: Christoffel symbols and Riemann tensor of the metric alone."""

from __future__ import annotations

from fractions import Fraction

from geomtorsion.exact import Element
from geomtorsion.geometry import frame_basis, frame_matrices
from geomtorsion.geometry.components import Components, total
from geomtorsion.geometry.frame import Frame
from geomtorsion.geometry.symmetry import RIEMANN, Index, symmetric
from geomtorsion.geometry.tensor import Tensor

HALF = Fraction(1, 2)


def metric_derivative(frame: Frame) -> Components:
    """d_a g_bc at (a, b, c)."""

    def make() -> Components:
        metric, coordinates = frame.metric.components.get, frame.coordinates

        def rule(index: Index) -> Element | None:
            value = metric(index[1:])
            return None if value is None else value.diff(coordinates[index[0]])

        return Components(3, frame.dimension, rule, symmetric(3, 1, 2))

    return frame.derived("metric_derivative", make)


def second_metric_derivative(frame: Frame) -> Components:
    """d_a d_b g_cd at (a, b, c, d)."""

    def make() -> Components:
        first, coordinates = metric_derivative(frame).get, frame.coordinates

        def rule(index: Index) -> Element | None:
            value = first(index[1:])
            return None if value is None else value.diff(coordinates[index[0]])

        return Components(4, frame.dimension, rule, symmetric(4, 0, 1) + symmetric(4, 2, 3))

    return frame.derived("second_metric_derivative", make)


def first_kind(frame: Frame) -> Components:
    """[ab, c] = (d_a g_bc + d_b g_ac - d_c g_ab) / 2 at (a, b, c)."""

    def make() -> Components:
        derivative = metric_derivative(frame).get

        def rule(index: Index) -> Element | None:
            a, b, c = index
            # Two of the three terms cancel where the last index is one of the first.
            if a == c:
                value = derivative((b, a, a))
                return None if value is None else value * HALF
            if b == c:
                value = derivative((a, b, b))
                return None if value is None else value * HALF
            parts = ((HALF, (a, b, c)), (HALF, (b, a, c)), (-HALF, (c, a, b)))
            found = [(sign, derivative(place)) for sign, place in parts]
            return total(frame.field, [(s, x) for s, x in found if x is not None])

        return Components(3, frame.dimension, rule, symmetric(3))

    return frame.derived("first_kind", make)


def christoffel(frame: Frame) -> Tensor:
    """Gamma_bar_ab^c = g^{ce} [ab, e], slots ddu, symmetric in ab; not a tensor in b and c."""

    def make() -> Tensor:
        lower, inverse = first_kind(frame).get, frame.inverse_metric.components

        def rule(index: Index) -> Element | None:
            a, b, c = index
            pairs = [(x, lower((a, b, e))) for e, x in inverse.rows[c]]
            return total(frame.field, [(1, x, y) for x, y in pairs if y is not None])

        symmetry = symmetric(3)
        return Tensor(frame, "ddu", rule, symmetry, "\\bar\\Gamma", "Levi-Civita", anchored=(1, 2))

    return frame.derived("christoffel", make)


def riemann(frame: Frame) -> Tensor:
    """R_mnlk of the Levi-Civita connection, slots dddd, from second derivatives of the metric.

    R_mnlk = (d_l d_m g_kn + d_k d_n g_lm - d_l d_n g_km - d_k d_m g_ln) / 2
             + g_ef (Gamma_lm^e Gamma_kn^f - Gamma_ln^e Gamma_km^f)

    The inverse metric is never differentiated, and the cyclic identity saves the third of three
    components with four different indices. Of a dense coframe it comes from the frame.
    """

    def make() -> Tensor:
        if frame_matrices.is_dense(frame):
            return frame_basis.riemann(frame).in_coordinates()
        second = second_metric_derivative(frame).get
        lower, upper = first_kind(frame).get, christoffel(frame).components.get
        n, field = frame.dimension, frame.field

        def products(terms: list, sign: int, one: Index, two: Index) -> None:
            # The pair with the fewer terms would do for either place: the product is symmetric.
            for e in range(n):
                first = upper((*one, e))
                if first is not None:
                    other = lower((*two, e))
                    if other is not None:
                        terms.append((sign, first, other))

        def rule(index: Index) -> Element | None:
            m, n_, l, k = index  # noqa: E741  (the letters of the formula)
            # The cyclic identity gives the third of the components with four different indices.
            if m < l < k < n_:
                one, two = (
                    tensor.components.get((m, l, n_, k)),
                    tensor.components.get((m, k, l, n_)),
                )
                terms = [(1, x) for x in (one, two) if x is not None]
                return total(field, terms)
            terms = []
            for sign, place in (
                (HALF, (l, m, k, n_)),
                (HALF, (k, n_, l, m)),
                (-HALF, (l, n_, k, m)),
                (-HALF, (k, m, l, n_)),
            ):
                value = second(place)
                if value is not None:
                    terms.append((sign, value))
            products(terms, 1, (l, m), (k, n_))
            products(terms, -1, (l, n_), (k, m))
            return total(field, terms)

        tensor = Tensor(frame, "dddd", rule, RIEMANN, "\\bar R", "Riemann")
        return tensor

    return frame.derived("riemann", make)
