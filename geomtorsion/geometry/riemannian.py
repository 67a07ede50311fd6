"""Riemannian: Christoffel symbols and curvature of the metric, from itself or in the frame.

Where the coframe is shorter than the metric (`frame_matrices.is_dense`), so are quantities from the
anholonomy: indices move by constants, and no inverse metric is needed.
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
)
from geomtorsion.geometry.derived import derived
from geomtorsion.geometry.frame import Frame
from geomtorsion.geometry.frame_matrices import is_dense
from geomtorsion.geometry.tensor import Tensor

HALF = Fraction(1, 2)


@derived
def metric_derivative(frame: Frame) -> Components:
    """d_a g_bc at (a, b, c)."""
    metric, coordinates = frame.metric.components.get, frame.coordinates

    def rule(index: Index) -> Element:
        return metric(index[1:]).diff(coordinates[index[0]])

    return Components(frame.field, 3, frame.dimension, rule, symmetric(3, 1, 2))


@derived
def second_metric_derivative(frame: Frame) -> Components:
    """d_a d_b g_cd at (a, b, c, d)."""
    first, coordinates = metric_derivative(frame).get, frame.coordinates

    def rule(index: Index) -> Element:
        return first(index[1:]).diff(coordinates[index[0]])

    symmetry = symmetric(4, 0, 1) + symmetric(4, 2, 3)
    return Components(frame.field, 4, frame.dimension, rule, symmetry)


@derived
def first_kind(frame: Frame) -> Components:
    """[ab, c] = (d_a g_bc + d_b g_ac - d_c g_ab) / 2 at (a, b, c)."""
    derivative = metric_derivative(frame).get

    def rule(index: Index) -> Element:
        a, b, c = index
        # Two of the three terms cancel where the last index is one of the first.
        if a == c:
            return derivative((b, a, a)) * HALF
        if b == c:
            return derivative((a, b, b)) * HALF
        places = ((HALF, (a, b, c)), (HALF, (b, a, c)), (-HALF, (c, a, b)))
        return frame.field.sum([(sign, derivative(place)) for sign, place in places])

    return Components(frame.field, 3, frame.dimension, rule, symmetric(3))


@derived
def christoffel(frame: Frame) -> Tensor:
    """Gamma_bar_ab^c = g^{ce} [ab, e], slots ddu, symmetric in ab; not a tensor in b and c."""
    lower, inverse = first_kind(frame).get, frame.inverse_metric.components

    def rule(index: Index) -> Element:
        a, b, c = index
        return frame.field.sum([(1, x, lower((a, b, e))) for e, x in inverse.rows[c]])

    symbol, name = "\\bar\\Gamma", "Levi-Civita"
    return Tensor(frame, "ddu", rule, symmetric(3), symbol, name, anchored=(1, 2))


@derived
def riemann(frame: Frame) -> Tensor:
    """R_mnlk of the Levi-Civita connection, slots dddd, from second derivatives of the metric.

    R_mnlk = (d_l d_m g_kn + d_k d_n g_lm - d_l d_n g_km - d_k d_m g_ln) / 2
             + g_ef (Gamma_lm^e Gamma_kn^f - Gamma_ln^e Gamma_km^f)

    The inverse metric is never differentiated, and the cyclic identity saves the third of three
    components with four different indices. For a dense coframe the frame computes it.
    """
    if is_dense(frame):
        return riemann_in_frame(frame).in_coordinates()
    second = second_metric_derivative(frame).get
    lower, upper = first_kind(frame).get, christoffel(frame).components.get

    def rule(index: Index) -> Element:
        m, n, l, k = index  # noqa: E741  (the letters of the formula)
        # The cyclic identity gives the third of the components with four different indices.
        if m < l < k < n:
            get = tensor.components.get
            return frame.field.sum([(1, get((m, l, n, k))), (1, get((m, k, l, n)))])
        terms: list = [
            (HALF, second((l, m, k, n))),
            (HALF, second((k, n, l, m))),
            (-HALF, second((l, n, k, m))),
            (-HALF, second((k, m, l, n))),
        ]
        # The metric is taken into the second factor: [ab, e] = g_ef Gamma_ab^f.
        for e in range(frame.dimension):
            terms.append((1, upper((l, m, e)), lower((k, n, e))))
            terms.append((-1, upper((l, n, e)), lower((k, m, e))))
        return frame.field.sum(terms)

    tensor = Tensor(frame, "dddd", rule, RIEMANN, "\\bar R", "Riemann")
    return tensor


@derived
def rotation(frame: Frame) -> Tensor:
    """omega_kij = (C_ijk - C_kij - C_jki) / 2 of the metric, slots DDD, antisymmetric in ij.

    D_bar_k E_i = omega_ki^j E_j.
    """
    lower = frame.anholonomy.lowered(2).components.get

    def rule(index: Index) -> Element:
        k, i, j = index
        places = ((HALF, (i, j, k)), (-HALF, (k, i, j)), (-HALF, (j, k, i)))
        return frame.field.sum([(sign, lower(place)) for sign, place in places])

    return Tensor(frame, "DDD", rule, antisymmetric(3, 1, 2), "\\omega", "rotation")


@derived
def contortion_in_frame(frame: Frame) -> Tensor:
    """K_ki^j = -omega_ki^j of the connection with parallel legs, slots DDU."""
    omega = rotation(frame).raised(2).components.get

    def rule(index: Index) -> Element:
        return -omega(index)

    return Tensor(frame, "DDU", rule, antisymmetric(3, 1, 2), "K", "contortion")


@derived
def riemann_in_frame(frame: Frame) -> Tensor:
    """R_mnlk of the metric in the frame, slots DDDD.

    R_mnlk = E_m(omega_nlk) - E_n(omega_mlk) + C_mn^p omega_plk
             + omega_ml^t omega_nkt - omega_nl^t omega_mkt
    """
    omega = rotation(frame)
    lower, mixed = omega.components.get, omega.raised(2).components.get
    anholonomy, slope = frame.anholonomy.components.get, _slopes(frame, omega)

    def rule(index: Index) -> Element:
        m, n, l, k = index  # noqa: E741  (the letters of the formula)
        # The cyclic identity gives the third of the components with four different indices.
        if m < l < k < n:
            get = tensor.components.get
            return frame.field.sum([(1, get((m, l, n, k))), (1, get((m, k, l, n)))])
        terms: list = [(1, slope((m, n, l, k))), (-1, slope((n, m, l, k)))]
        for t in range(frame.dimension):
            terms.append((1, anholonomy((m, n, t)), lower((t, l, k))))
            terms.append((1, mixed((m, l, t)), lower((n, k, t))))
            terms.append((-1, mixed((n, l, t)), lower((m, k, t))))
        return frame.field.sum(terms)

    tensor = Tensor(frame, "DDDD", rule, RIEMANN, "\\bar R", "Riemann")
    return tensor


def _slopes(frame: Frame, omega: Tensor) -> Rule:
    """E_m(omega_nlk) at (m, n, l, k)."""
    get, columns = omega.components.get, frame.legs.components.columns

    def rule(index: Index) -> Element:
        value = get(index[1:])
        along = columns[index[0]]
        return frame.field.sum([(1, leg, value.diff(frame.coordinates[a])) for a, leg in along])

    symmetry = antisymmetric(4, 2, 3)
    return Components(frame.field, 4, frame.dimension, rule, symmetry).get


@derived
def ricci_in_frame(frame: Frame) -> Tensor:
    """R_nl = R_mnl^m of the metric in the frame, slots DD, symmetric."""
    lower = riemann_in_frame(frame).components.get
    inverse = frame.inverse_eta.components.nonzero

    def rule(index: Index) -> Element:
        return frame.field.sum([(1, x, lower((m, *index, k))) for (m, k), x in inverse.items()])

    return Tensor(frame, "DD", rule, symmetric(2), "R", "Ricci tensor")


def contortion_of(torsion: Tensor) -> Tensor:
    """K_ab^c, slots ddu, of a torsion S_ab^c: K_abc = S_abc - S_bca + S_cab."""
    frame, lower = torsion.frame, torsion.lowered(2).components.get

    def rule(index: Index) -> Element:
        a, b, c = index
        terms = [(1, lower((a, b, c))), (-1, lower((b, c, a))), (1, lower((c, a, b)))]
        return frame.field.sum(terms)

    return Tensor(frame, "ddd", rule, antisymmetric(3, 1, 2), "K", "contortion").raised(2)
