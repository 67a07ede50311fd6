"""Riemannian: Christoffel symbols and curvature of the metric, from itself or in the frame.

Where the coframe is shorter than the metric (`frame_matrices.is_dense`) what follows from the
anholonomy is shorter, too: indices move by constants, and no inverse metric is needed.
"""

from __future__ import annotations

from fractions import Fraction

from geomtorsion.exact import Element
from geomtorsion.geometry.components import (
    RIEMANN,
    Components,
    Index,
    Rule,
    antisymmetric,
    symmetric,
    total,
)
from geomtorsion.geometry.frame import Frame
from geomtorsion.geometry.frame_matrices import is_dense
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
        if is_dense(frame):
            return riemann_in_frame(frame).in_coordinates()
        second = second_metric_derivative(frame).get
        lower, upper = first_kind(frame).get, christoffel(frame).components.get
        n, field = frame.dimension, frame.field

        def products(terms: list, sign: int, one: Index, two: Index) -> None:
            # g_ef Gamma^e Gamma^f, the metric taken into the second: [ab, e] = g_ef Gamma_ab^f.
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


def rotation(frame: Frame) -> Tensor:
    """omega_kij = (C_ijk - C_kij - C_jki) / 2 of the metric, slots DDD, antisymmetric in ij.

    D_bar_k E_i = omega_ki^j E_j.
    """

    def make() -> Tensor:
        lower = frame.anholonomy.lowered(2).components.get

        def rule(index: Index) -> Element | None:
            k, i, j = index
            parts = ((HALF, (i, j, k)), (-HALF, (k, i, j)), (-HALF, (j, k, i)))
            found = [(sign, lower(place)) for sign, place in parts]
            return total(frame.field, [(s, x) for s, x in found if x is not None])

        return Tensor(frame, "DDD", rule, antisymmetric(3, 1, 2), "\\omega", "rotation")

    return frame.derived("rotation", make)


def contortion_in_frame(frame: Frame) -> Tensor:
    """K_ki^j = -omega_ki^j of the connection with parallel legs, slots DDU."""

    def make() -> Tensor:
        omega = rotation(frame).raised(2).components.get

        def rule(index: Index) -> Element | None:
            value = omega(index)
            return None if value is None else -value

        return Tensor(frame, "DDU", rule, antisymmetric(3, 1, 2), "K", "contortion")

    return frame.derived("contortion_in_frame", make)


def riemann_in_frame(frame: Frame) -> Tensor:
    """R_mnlk of the metric in the frame, slots DDDD.

    R_mnlk = E_m(omega_nlk) - E_n(omega_mlk) + C_mn^p omega_plk
             + omega_ml^t omega_nkt - omega_nl^t omega_mkt
    """

    def make() -> Tensor:
        omega, field, n = rotation(frame), frame.field, frame.dimension
        lower, mixed = omega.components.get, omega.raised(2).components.get
        anholonomy, slope = frame.anholonomy.components.get, _slopes(frame, omega)

        def rule(index: Index) -> Element | None:
            m, n_, l, k = index  # noqa: E741  (the letters of the formula)
            # The cyclic identity gives the third of the components with four different indices.
            if m < l < k < n_:
                get = tensor.components.get
                others = (get((m, l, n_, k)), get((m, k, l, n_)))
                return total(field, [(1, x) for x in others if x is not None])
            terms: list = []
            for sign, one, two in ((1, m, n_), (-1, n_, m)):
                value = slope((one, two, l, k))
                if value is not None:
                    terms.append((sign, value))
            pairs = [(1, anholonomy((m, n_, p)), lower((p, l, k))) for p in range(n)]
            for t in range(n):
                pairs.append((1, mixed((m, l, t)), lower((n_, k, t))))
                pairs.append((-1, mixed((n_, l, t)), lower((m, k, t))))
            terms += [(s, x, y) for s, x, y in pairs if x is not None and y is not None]
            return total(field, terms)

        tensor = Tensor(frame, "DDDD", rule, RIEMANN, "\\bar R", "Riemann")
        return tensor

    return frame.derived("riemann_in_frame", make)


def _slopes(frame: Frame, omega: Tensor) -> Rule:
    """E_m(omega_nlk) at (m, n, l, k)."""
    get, columns = omega.components.get, frame.legs.components.columns

    def rule(index: Index) -> Element | None:
        value = get(index[1:])
        if value is None:
            return None
        along = [(leg, value.diff(frame.coordinates[a])) for a, leg in columns[index[0]]]
        return total(frame.field, [(1, leg, x) for leg, x in along])

    symmetry = antisymmetric(4, 2, 3)
    return Components(4, frame.dimension, rule, symmetry).get


def ricci_in_frame(frame: Frame) -> Tensor:
    """R_nl = R_mnl^m of the metric in the frame, slots DD, symmetric."""

    def make() -> Tensor:
        lower, inverse = (
            riemann_in_frame(frame).components.get,
            frame.inverse_eta.components.nonzero,
        )

        def rule(index: Index) -> Element | None:
            found = [(x, lower((m, *index, k))) for (m, k), x in inverse.items()]
            return total(frame.field, [(1, x, y) for x, y in found if y is not None])

        return Tensor(frame, "DD", rule, symmetric(2), "R", "Ricci tensor")

    return frame.derived("ricci_in_frame", make)
