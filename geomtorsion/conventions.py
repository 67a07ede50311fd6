"""Conventions: index order, signs and factors, stated once; everything else cites this file.

They are those of [FizievKleinert1994] (READING.md). tests/geometry/test_conventions.py holds the
package to each of them with arithmetic of its own.
"""

from __future__ import annotations

from dataclasses import dataclass

from geomtorsion.errors import UnknownNameError


@dataclass(frozen=True)
class Convention:
    """One convention.

    name: what it settles.
    formula: the defining equation; repeated indices are summed.
    note: where other books differ, or how to read the indices.
    """

    name: str
    formula: str
    note: str


CONVENTIONS = (
    Convention(
        "coframe",
        "e^i = e^i_mu dq^mu: coframe[i, mu]",
        "Rows are frame indices, columns coordinate indices.",
    ),
    Convention(
        "legs",
        "E_i^mu e^i_nu = delta^mu_nu: legs[mu, i]",
        "Columns are the legs: legs is the matrix inverse of coframe.",
    ),
    Convention(
        "metric",
        "g_mu_nu = e^i_mu eta_ij e^j_nu",
        "eta is constant; no complex conjugate is taken for complex legs.",
    ),
    Convention(
        "connection",
        "D_a v^c = d_a v^c + Gamma_ab^c v^b: connection[a, b, c]",
        "The FIRST lower index is the direction of differentiation; many books put it last.",
    ),
    Convention(
        "cartan",
        "Gamma_ab^c = E_i^c d_a e^i_b",
        "The connection in which the legs are parallel (Weitzenboeck).",
    ),
    Convention(
        "spin connection",
        "D_a E_i = omega_ai^j E_j: spin_connection[a, i, j]",
        "First the direction of differentiation, then as for Gamma.",
    ),
    Convention(
        "torsion",
        "S_ab^c = (Gamma_ab^c - Gamma_ba^c) / 2, T = 2 S",
        "S with the half (Schouten, Kleinert); T is what most texts call torsion.",
    ),
    Convention(
        "anholonomy",
        "de^k = (1/2) C_ij^k e^i ^ e^j, [E_i, E_j] = - C_ij^k E_k",
        "C_ij^k = 2 S_ij^k of the Cartan connection in the frame: minus the structure constants.",
    ),
    Convention(
        "contortion",
        "K_ab^c = S_ab^c - S_b^c_a + S^c_ab = Gamma_ab^c - Gamma_bar_ab^c",
        "The second form for metric connections; K_abc is antisymmetric in b and c.",
    ),
    Convention(
        "nonmetricity",
        "Q_abc = D_a g_bc, L_abc = -(Q_abc + Q_bac - Q_cab) / 2",
        "Gamma = Gamma_bar + K + L for every connection; L is the disformation.",
    ),
    Convention(
        "curvature",
        "R_mnl^k = d_m Gamma_nl^k - d_n Gamma_ml^k - Gamma_ml^t Gamma_nt^k + Gamma_nl^t Gamma_mt^k",
        "[D_m, D_n] v^k = R_mnl^k v^l - 2 S_mn^t D_t v^k.",
    ),
    Convention(
        "ricci",
        "R_nl = R_mnl^m, R = g^nl R_nl",
        "Positive for spheres.",
    ),
    Convention(
        "torsion parts",
        "v_a = T_ab^b, A_abc = T_[abc] = (T_abc + T_bca + T_cab) / 3",
        "T_abc = A_abc + (v_a g_bc - v_b g_ac) / (n - 1) + tensor part.",
    ),
    Convention(
        "torsion scalar",
        "T = T_abc T^abc / 4 + T_abc T^cba / 2 - v_a v^a",
        "R = R_bar + T + 2 D_bar_a v^a; R = 0 for Cartan: R_bar = - T - 2 D_bar_a v^a.",
    ),
    Convention(
        "torsion force",
        "q''^c + Gamma_bar_ab^c q'^a q'^b = 2 S_a^c_b q'^a q'^b on an autoparallel",
        "Force per unit mass; zero where S is totally antisymmetric.",
    ),
)


def convention(name: str) -> Convention:
    """The convention of this name.

    Raises
    ------
    UnknownNameError
        There is none; the message lists the names.

    Examples
    --------
    >>> convention("torsion").formula
    'S_ab^c = (Gamma_ab^c - Gamma_ba^c) / 2, T = 2 S'
    """
    for item in CONVENTIONS:
        if item.name == name:
            return item
    known = ", ".join(item.name for item in CONVENTIONS)
    raise UnknownNameError(f"no convention is called {name!r}. Known are {known}.")
