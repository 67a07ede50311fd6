"""Frame basis: rotation coefficients and curvature of the metric from the anholonomy alone.

Where the coframe is shorter than the metric this is the shorter way: indices move by constants, and
neither the metric nor its inverse is needed.
"""

from __future__ import annotations

from fractions import Fraction

from geomtorsion.exact import Element
from geomtorsion.geometry.components import Components, Rule, total
from geomtorsion.geometry.frame import Frame
from geomtorsion.geometry.symmetry import RIEMANN, Index, antisymmetric, symmetric
from geomtorsion.geometry.tensor import Tensor

HALF = Fraction(1, 2)


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


def contortion(frame: Frame) -> Tensor:
    """K_ki^j = -omega_ki^j of the connection with parallel legs, slots DDU."""

    def make() -> Tensor:
        omega = rotation(frame).raised(2).components.get

        def rule(index: Index) -> Element | None:
            value = omega(index)
            return None if value is None else -value

        return Tensor(frame, "DDU", rule, antisymmetric(3, 1, 2), "K", "contortion")

    return frame.derived("contortion_in_frame", make)


def riemann(frame: Frame) -> Tensor:
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


def ricci(frame: Frame) -> Tensor:
    """R_nl = R_mnl^m of the metric in the frame, slots DD, symmetric."""

    def make() -> Tensor:
        lower, inverse = riemann(frame).components.get, frame.inverse_eta.components.nonzero

        def rule(index: Index) -> Element | None:
            found = [(x, lower((m, *index, k))) for (m, k), x in inverse.items()]
            return total(frame.field, [(1, x, y) for x, y in found if y is not None])

        return Tensor(frame, "DD", rule, symmetric(2), "R", "Ricci tensor")

    return frame.derived("ricci_in_frame", make)
