"""Oracle: geometry of a numeric coframe by central differences, independent of the package.

A coframe is a callable q -> rows e[i][mu] of mpmath numbers. Derivatives are nested central
differences at 90 digits: steps 1e-25 inside and 1e-15 outside leave about 28 right digits in
second derivatives. Index order and signs follow the paper: Gamma[a, b, c] = Gamma_ab^c with
a the direction of differentiation, R[m, n, l, k] = R_mnl^k, Ricci R_nl = R_mnl^m, S with the half.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import mpmath
import numpy as np

from tests.differences import (
    DIGITS,
    INNER_STEP,
    OUTER_STEP,
    Field,
    Point,
    antisymmetrised,
    array,
    difference,
    inverse,
    quantity,
)


@dataclass(frozen=True)
class Oracle:
    """Geometry at one point of a coframe, or of given connection coefficients on it.

    coframe: q -> e[i, mu]; point: q; eta: constant matrix, default the unit matrix;
    coefficients: q -> Gamma[a, b, c], default Cartan's e_i^c d_a e^i_b.
    """

    coframe: Callable[[Point], Any]
    point: Sequence[Any]
    eta: Any = None
    coefficients: Callable[[Point], Any] | None = None

    def coframe_at(self, point: Point) -> np.ndarray:
        """e[i, mu] at a point."""
        return array(self.coframe(point))

    def metric_at(self, point: Point) -> np.ndarray:
        """g = e^T eta e."""
        e = self.coframe_at(point)
        return e.T @ self.flat @ e

    def christoffel_at(self, point: Point) -> np.ndarray:
        """Levi-Civita Gamma_bar[a, b, c] from first differences of g."""
        slope = difference(self.metric_at, INNER_STEP)(point)  # slope[a, b, c] = d_a g_bc
        lowered = slope + slope.transpose(1, 0, 2) - slope.transpose(1, 2, 0)
        return lowered @ inverse(self.metric_at(point)) / 2

    def cartan_at(self, point: Point) -> np.ndarray:
        """Gamma[a, b, c] = e_i^c d_a e^i_b."""
        slope = difference(self.coframe_at, INNER_STEP)(point)  # slope[a, i, b]
        return np.einsum("aib,ci->abc", slope, inverse(self.coframe_at(point)))

    def gamma_at(self, point: Point) -> np.ndarray:
        """Coefficients of the given connection, or Cartan's."""
        if self.coefficients is None:
            return self.cartan_at(point)
        return array(self.coefficients(point))

    def curvature_of(self, gamma: Field) -> np.ndarray:
        """R[m, n, l, k] of any connection by differences of its coefficients."""
        value = gamma(self.point)
        slope = difference(gamma, OUTER_STEP)(self.point)  # slope[m, n, l, k]
        half = slope + np.einsum("nlt,mtk->mnlk", value, value)
        return half - half.transpose(1, 0, 2, 3)

    @quantity
    def flat(self) -> np.ndarray:
        """eta."""
        size = len(self.point)
        return array(np.eye(size, dtype=int).tolist() if self.eta is None else self.eta)

    @quantity
    def e(self) -> np.ndarray:
        return self.coframe_at(self.point)

    @quantity
    def legs(self) -> np.ndarray:
        """E[mu, i]."""
        return inverse(self.e)

    @quantity
    def determinant(self) -> Any:
        """det e."""
        return mpmath.det(mpmath.matrix(self.e.tolist()))

    @quantity
    def metric(self) -> np.ndarray:
        return self.metric_at(self.point)

    @quantity
    def inverse_metric(self) -> np.ndarray:
        return inverse(self.metric)

    @quantity
    def anholonomy(self) -> np.ndarray:
        """C[i, j, k] = E_i^a E_j^b (d_a e^k_b - d_b e^k_a)."""
        slope = difference(self.coframe_at, INNER_STEP)(self.point)
        curl = slope.transpose(0, 2, 1) - slope.transpose(2, 0, 1)  # [a, b, k]
        return np.einsum("abk,ai,bj->ijk", curl, self.legs, self.legs)

    @quantity
    def christoffel(self) -> np.ndarray:
        return self.christoffel_at(self.point)

    @quantity
    def gamma(self) -> np.ndarray:
        return self.gamma_at(self.point)

    @quantity
    def torsion(self) -> np.ndarray:
        """S[a, b, c] = (Gamma_ab^c - Gamma_ba^c) / 2."""
        return (self.gamma - self.gamma.transpose(1, 0, 2)) / 2

    @quantity
    def torsion_lowered(self) -> np.ndarray:
        """T_abc = 2 S_abc."""
        return 2 * self.torsion @ self.metric

    @quantity
    def torsion_whole(self) -> np.ndarray:
        """T = 2 S."""
        return 2 * self.torsion

    @quantity
    def torsion_vector(self) -> np.ndarray:
        """v_a = T_ab^b."""
        return 2 * np.einsum("abb->a", self.torsion)

    @quantity
    def torsion_axial(self) -> np.ndarray:
        """T_[abc]."""
        return antisymmetrised(self.torsion_lowered)

    @quantity
    def torsion_tensor(self) -> np.ndarray:
        """T_abc minus its axial and its vector part."""
        trace = np.einsum("a,bc->abc", self.torsion_vector, self.metric)
        vector = (trace - trace.transpose(1, 0, 2)) / (len(self.point) - 1)
        return self.torsion_lowered - self.torsion_axial - vector

    @quantity
    def force_coefficients(self) -> np.ndarray:
        """S_a^c_b + S_b^c_a at [a, b, c]."""
        mixed = np.einsum("adb,dc->abc", self.torsion @ self.metric, self.inverse_metric)
        return mixed + mixed.transpose(1, 0, 2)

    @quantity
    def torsion_scalar(self) -> Any:
        """(1/4) T_abc T^abc + (1/2) T_abc T^cba - v_a v^a."""
        down, up = self.torsion_lowered, self.inverse_metric
        raised = np.einsum("abc,ai,bj,ck->ijk", down, up, up, up, optimize=True)
        v = self.torsion_vector
        return (
            (down * raised).sum() / 4
            + (down * raised.transpose(2, 1, 0)).sum() / 2
            - np.einsum("a,b,ab->", v, v, up)
        )

    @quantity
    def superpotential(self) -> np.ndarray:
        """d(torsion_scalar) / dT_abc at [a, b, c], the last index lowered."""
        down, up = self.torsion_lowered, self.inverse_metric
        raised = np.einsum("abc,ai,bj,ck->ijk", down, up, up, up, optimize=True)
        trace = np.einsum("a,ab,ck->bck", self.torsion_vector, up, up)
        swapped = raised.transpose(2, 1, 0) - raised.transpose(1, 2, 0)
        return (raised + swapped) / 2 @ self.metric - (
            trace - trace.transpose(1, 0, 2)
        ) @ self.metric

    @quantity
    def contortion(self) -> np.ndarray:
        """Gamma - Gamma_bar: contortion where the connection is metric."""
        return self.gamma - self.christoffel

    @quantity
    def nonmetricity(self) -> np.ndarray:
        """D_a g_bc = d_a g_bc - Gamma_ab^d g_dc - Gamma_ac^d g_bd."""
        slope = difference(self.metric_at, INNER_STEP)(self.point)
        bent = self.gamma @ self.metric
        return slope - bent - bent.transpose(0, 2, 1)

    @quantity
    def curvature(self) -> np.ndarray:
        """Curvature of the connection itself (zero for Cartan's)."""
        return self.curvature_of(self.gamma_at)

    @quantity
    def riemann(self) -> np.ndarray:
        """Levi-Civita curvature R[m, n, l, k]."""
        return self.curvature_of(self.christoffel_at)

    @quantity
    def riemann_lowered(self) -> np.ndarray:
        return self.riemann @ self.metric

    @quantity
    def riemann_in_frame(self) -> np.ndarray:
        """R_mnlk in the frame."""
        found = self.riemann_lowered
        for _ in range(4):
            # The contraction removes the first index and appends its replacement as the last.
            found = np.tensordot(found, self.legs, axes=(0, 0))
        return found

    @quantity
    def ricci(self) -> np.ndarray:
        """R_nl = R_mnl^m."""
        return np.einsum("mnlm->nl", self.riemann)

    @quantity
    def scalar(self) -> Any:
        return (self.ricci * self.inverse_metric).sum()

    @quantity
    def einstein(self) -> np.ndarray:
        return self.ricci - self.metric * self.scalar / 2

    @quantity
    def schouten(self) -> np.ndarray:
        """P_ab, both indices down; needs three dimensions."""
        n = len(self.point)
        return (self.ricci - self.scalar * self.metric / (2 * (n - 1))) / (n - 2)

    @quantity
    def weyl(self) -> np.ndarray:
        """C_mnlk, all indices down, in the index order of R_mnlk; needs three dimensions."""
        g = self.metric

        def product(h: np.ndarray) -> np.ndarray:
            """g owedge h, signed so that a unit sphere has R_mnlk = g_mk g_nl - g_ml g_nk."""
            one = np.einsum("mk,nl->mnlk", g, h) + np.einsum("mk,nl->mnlk", h, g)
            return one - one.transpose(0, 1, 3, 2)

        return self.riemann_lowered - product(self.schouten)

    @quantity
    def kretschmann(self) -> Any:
        """R_mnlk R^mnlk."""
        # R_mn^lk R_lk^mn needs two raisings instead of four.
        mixed = np.einsum("mnak,al->mnlk", self.riemann, self.inverse_metric)
        return np.einsum("mnlk,lkmn->", mixed, mixed)

    def turned(self, gamma: np.ndarray) -> np.ndarray:
        """omega[a, i, j] with D_a E_i = omega_ai^j E_j for given coefficients."""
        slope = difference(lambda q: inverse(self.coframe_at(q)), INNER_STEP)(self.point)
        moved = slope + np.einsum("abc,bj->acj", gamma, self.legs)  # D_a E_j^c
        return np.einsum("kc,acj->ajk", self.e, moved)

    @quantity
    def spin_connection(self) -> np.ndarray:
        """Spin connection of the given connection."""
        return self.turned(self.gamma)

    @quantity
    def metric_spin_connection(self) -> np.ndarray:
        """Spin connection of the Levi-Civita connection."""
        return self.turned(self.christoffel)

    def force(self, velocity: Sequence[Any]) -> np.ndarray:
        """f^c = 2 S_a^c_b q'^a q'^b."""
        with mpmath.workdps(DIGITS):
            v = array(list(velocity))
            return np.einsum("abc,a,b->c", self.force_coefficients, v, v)
