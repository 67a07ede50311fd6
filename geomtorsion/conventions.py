"""Conventions: index order, signs and factors, stated once; all other files cite this one.

The package follows [FizievKleinert1994] (READING.md). tests/geometry/test_conventions.py checks
each convention with independent arithmetic, tests/test_conventions.py the signs of Burgers
vectors, on atoms.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import ArgumentError, UnknownNameError
from geomtorsion.support import checks

if TYPE_CHECKING:
    import numpy as np


@dataclass(frozen=True)
class Convention:
    """One convention.

    name: of the choice that it settles.
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
        "D_a v^c = partial_a v^c + Gamma_ab^c v^b: connection[a, b, c]",
        "The FIRST lower index is the direction of differentiation; many books put it last.",
    ),
    Convention(
        "cartan",
        "Gamma_ab^c = E_i^c partial_a e^i_b",
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
        "R_mnl^k = partial_m Gamma_nl^k - partial_n Gamma_ml^k - Gamma_ml^t Gamma_nt^k "
        "+ Gamma_nl^t Gamma_mt^k",
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
        "action",
        "S = integral of L sqrt|g| d^n q / (16 pi), with L = R for general relativity",
        "T and Q are minus R_bar up to a divergence: -T has gravitons of positive energy.",
    ),
    Convention(
        "torsion force",
        "q''^c + Gamma_bar_ab^c q'^a q'^b = 2 S_a^c_b q'^a q'^b on an autoparallel",
        "Force per unit mass; zero where S is totally antisymmetric.",
    ),
    Convention(
        "volume form",
        "epsilon_{01...} = det e sqrt|det eta|",
        "Positive on the legs in their order, where the coframe has a positive determinant.",
    ),
    Convention(
        "hodge dual",
        "(*alpha)_{b...} = alpha^{a...} epsilon_{a... b...} / p!",
        "** is (-1)^(p (n - p)) times the sign of det g; alpha ^ *alpha is |alpha|^2 epsilon.",
    ),
    Convention(
        "schouten",
        "P_ab = (R_ab - R g_ab / (2 (n - 1))) / (n - 2), C_abc = D_a P_bc - D_b P_ac",
        "The Cotton tensor C is antisymmetric in its first two indices; many books write C_cab.",
    ),
    Convention(
        "extrinsic curvature",
        "K_ab = (D_mu n_nu) partial_a q^mu partial_b q^nu",
        "Positive on a sphere with the normal outwards; some books have the other sign.",
    ),
    Convention(
        "burgers",
        "b^i = closed integral of e^i_mu dq^mu, right-handed about the line sense",
        "The image in the perfect lattice of a circuit that closes in the sample, from start to "
        "finish: SF/RH. FS/RH has the other sign; `burgers` converts.",
    ),
    Convention(
        "nye",
        "alpha^{ik} = eps^{kab} partial_a e^i_b, b^i = alpha^{ik} n_k A",
        "First index: Burgers vector; second: normal of the area, as Nye, Kroener and MTEX. Mura "
        "writes the transpose. Its sign follows the sign of b.",
    ),
)


@dataclass(frozen=True)
class BurgersConvention:
    """The sign convention of a Burgers vector.

    names: its names; sign: its b over the b of this package, for one line and one sense.
    meaning: its definition.
    """

    names: tuple[str, ...]
    sign: int
    meaning: str


# All for a line of given sense; reversing the sense reverses b in each. A circuit closes in the
# sample; its image in the perfect lattice, atom by atom, goes from start S to finish F.
BURGERS = (
    BurgersConvention(
        ("geomtorsion", "SF/RH", "RH/SF", "FS/LH", "LH/FS"),
        1,
        "right-handed circuit, from S to F: the sum of the images of its steps, the integral of e",
    ),
    BurgersConvention(
        ("FS/RH", "RH/FS", "SF/LH", "LH/SF"),
        -1,
        "right-handed circuit, from F to S, or left-handed, from S to F; a right-handed screw has "
        "b along its sense, an edge its extra half plane towards (sense) x b",
    ),
    BurgersConvention(
        ("Hirth-Lothe", "integral of du"),
        -1,
        "right-handed closed integral of du, u from the perfect place of an atom to its real one: "
        "e = dx - du",
    ),
    BurgersConvention(
        ("OVITO",),
        1,
        "as found in what OVITO 3.17 answers: a right-handed screw has b against the sense in "
        "which its points run",
    ),
    BurgersConvention(
        ("MTEX", "weighted Burgers vector"),
        1,
        "per area, loops counterclockwise in the specimen's x and y (sense z), b in the crystal: "
        "alpha^{i3} of the Nye tensor",
    ),
)


def burgers(vector: Sequence[Any] | np.ndarray, name: str) -> np.ndarray:
    """A Burgers vector of this package in another convention, or back: each is its own inverse.

    Parameters
    ----------
    vector
        b^i, numbers or exact expressions, in any shape.
    name
        "SF/RH" (as here), "FS/RH", "LH/SF", "OVITO", "Hirth-Lothe", "integral of du", "MTEX".

    Raises
    ------
    UnknownNameError
        No convention has this name; the message lists them.
    ArgumentError
        The vector is not a list of numbers.

    Examples
    --------
    >>> burgers([0, 0, 1], "FS/RH").tolist()
    [0, 0, -1]
    """
    # numpy takes 0.09 s to load, which `import geomtorsion` does not need.
    import numpy as np

    signs = {each: one.sign for one in BURGERS for each in one.names}
    known = checks.known_name(name, signs, "convention", UnknownNameError)
    found = np.asarray(checks.entries(vector, "vector", expected="a Burgers vector"))
    if found.dtype.kind not in "iufcO":
        raise ArgumentError(f"vector: expected numbers, got {checks.shown(vector)}.")
    return signs[known] * found


class Signed:
    """A result with a Burgers vector `vector`, convertible to other sign conventions."""

    # Some classes have the vector as a field, others compute it; one type cannot express both.
    def in_convention(self: Any, name: str) -> np.ndarray:
        """The vector in another convention of sign, such as "FS/RH"; see `conventions.burgers`.

        Raises
        ------
        UnknownNameError
            No convention has this name; the message lists them.
        """
        return burgers(self.vector, name)


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
    by_name, kind = {item.name: item for item in CONVENTIONS}, "the name of a convention"
    return by_name[checks.known_name(name, by_name, "", UnknownNameError, expected=kind)]


def __dir__() -> list[str]:
    """All public names."""
    return [
        "BURGERS",
        "BurgersConvention",
        "CONVENTIONS",
        "Convention",
        "Signed",
        "burgers",
        "convention",
    ]
