"""Newman-Penrose: curvature scalars of a null tetrad and the Petrov type."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import combinations

import sympy as sp

from geomtorsion.errors import SignatureError, UndecidedError
from geomtorsion.exact import Element
from geomtorsion.geometry import Frame, levi_civita
from geomtorsion.geometry.connections import FrameLike, as_frame
from geomtorsion.gravity.theory.fields import FrameFields
from geomtorsion.support import checks
from geomtorsion.support.exclusive import exclusive


def newman_penrose(frame: FrameLike) -> NewmanPenrose:
    """Newman-Penrose scalars of the metric of a null tetrad (l, n, m, m_bar).

    Equation
    --------
    Psi_0 = C_abcd l^a m^b l^c m^d
    Psi_1 = C_abcd l^a n^b l^c m^d
    Psi_2 = C_abcd l^a m^b w^c n^d
    Psi_3 = C_abcd l^a n^b w^c n^d
    Psi_4 = C_abcd n^a w^b n^c w^d
    with w = m_bar, the conjugate of m [NewmanPenrose1962].

    Here C has the sign of most books for (-+++), C^a_bcd with R_bd = R^a_bad, which is minus
    `curvature.weyl` at these index positions. For (+---) both signs change, and Psi stays.

    Parameters
    ----------
    frame
        Complex, four legs in the order l, n, m, m_bar, with l.n = -1 and m.m_bar = 1, or the
        opposite signs.

    Raises
    ------
    SignatureError
        eta does not belong to a null tetrad.

    Examples
    --------
    >>> from geomtorsion.gravity import newman_penrose
    >>> from geomtorsion.spaces import load
    >>> kerr = newman_penrose(load("kerr_kinnersley").frame)
    >>> kerr.petrov_type, kerr.psi[0], kerr.psi[4]
    ('D', 0, 0)
    """
    frame = as_frame(frame)
    n = frame.dimension
    eta = [[frame.eta[i, j] for j in range(n)] for i in range(n)]
    product = eta[0][1] if n == 4 else 0
    signature = [[0, 1, 0, 0], [1, 0, 0, 0], [0, 0, 0, -1], [0, 0, -1, 0]]
    if product not in (1, -1) or eta != [[product * x for x in row] for row in signature]:
        raise SignatureError(
            "frame: expected a null tetrad l, n, m, m_bar with l.n = -1, m.m_bar = 1 (or both "
            f"signs changed), got eta = {eta}. Make one with Frame(..., complex=True, "
            "signature=[[0, -1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1], [0, 0, 1, 0]])."
        )
    return NewmanPenrose(frame)


L, N, M, BAR = range(4)
WEYL = ((L, M, L, M), (L, N, L, M), (L, M, BAR, N), (L, N, BAR, N), (N, BAR, N, BAR))


@exclusive
@dataclass(frozen=True, eq=False, repr=False)
class NewmanPenrose:
    """Curvature scalars and spin coefficients of a null tetrad.

    frame: the tetrad l, n, m, m_bar.
    """

    frame: Frame

    @property
    def _sign(self) -> int:
        """l.n: -1 for (-+++), 1 for (+---)."""
        return 1 if self.frame.eta[0, 1] == 1 else -1

    @cached_property
    def _weyl(self) -> list[Element]:
        weyl = levi_civita(self.frame).curvature.weyl.in_frame()
        return [weyl.element(*index) * self._sign for index in WEYL]

    @property
    def psi(self) -> tuple[sp.Expr, ...]:
        """Psi_0 ... Psi_4, the Weyl tensor."""
        return tuple(x.sympy for x in self._weyl)

    @cached_property
    def phi(self) -> dict[str, sp.Expr]:
        """Phi_00 = R_ll / 2, Phi_01 = R_lm / 2, ..., the trace-free Ricci tensor."""
        ricci = levi_civita(self.frame).curvature.ricci.in_frame()
        pairs = {"00": (L, L), "01": (L, M), "02": (M, M), "12": (N, M), "22": (N, N)}
        components = {name: ricci.element(*index) * Fraction(1, 2) for name, index in pairs.items()}
        components["11"] = (ricci.element(L, N) + ricci.element(M, BAR)) * Fraction(1, 4)
        return {name: components[name].sympy for name in sorted(components)}

    @cached_property
    def curvature_scalar(self) -> sp.Expr:
        """Lambda = R / 24 for (-+++), -R / 24 for (+---)."""
        return (levi_civita(self.frame).curvature.scalar.element() * -self._sign / 24).sympy

    @cached_property
    def spin_coefficients(self) -> dict[str, sp.Expr]:
        """The twelve spin coefficients by name: kappa, rho, sigma, tau, nu, mu, ..., beta.

        Equation
        --------
        kappa = m^a l^b D_b l_a, rho = m^a mbar^b D_b l_a, sigma = m^a m^b D_b l_a,
        tau = m^a n^b D_b l_a, nu, mu, lambda, pi = -mbar^a (n, m, mbar, l)^b D_b n_a,
        epsilon, gamma, alpha, beta = (n^a D_b l_a - mbar^a D_b m_a)/2 along l, n, mbar, m
        for (+---); for (-+++) with the opposite sign                      [NewmanPenrose1962]

        Examples
        --------
        >>> from geomtorsion.gravity import newman_penrose
        >>> from geomtorsion.spaces import load
        >>> newman_penrose(load("kerr_kinnersley").frame).spin_coefficients["kappa"]
        0
        """
        omega = FrameFields(levi_civita(self.frame)).omega.lowered(2)

        def turn(along: int, leg: int, other: int) -> Element:
            """The component along another leg of the derivative of a leg."""
            return omega.element(along, leg, other) * self._sign

        along = {"kappa": L, "rho": BAR, "sigma": M, "tau": N}
        values = {name: turn(leg, L, M) for name, leg in along.items()}
        along = {"nu": N, "mu": M, "lambda": BAR, "pi": L}
        values |= {name: -turn(leg, N, BAR) for name, leg in along.items()}
        along = {"epsilon": L, "gamma": N, "alpha": BAR, "beta": M}
        half = Fraction(1, 2)
        values |= {
            name: (turn(leg, L, N) - turn(leg, M, BAR)) * half for name, leg in along.items()
        }
        return {name: value.sympy for name, value in values.items()}

    @cached_property
    def petrov_type(self) -> str:
        """Petrov type at a generic point: O, N, III, D, II or I.

        It follows from the multiplicities of the roots of
        Psi_0 z^4 + 4 Psi_1 z^3 + 6 Psi_2 z^2 + 4 Psi_3 z + Psi_4, which exact zeros of invariants
        and covariants decide; no root is taken.

        Raises
        ------
        UndecidedError
            Whether an invariant vanishes cannot be decided.
        """
        a, b, c, d, e = self._weyl
        if all(map(_vanishes, self._weyl)):
            return "O"
        hessian = [
            a * c - b * b,
            (a * d - b * c) * 2,
            a * e + b * d * 2 - c * c * 3,
            (b * e - c * d) * 2,
            c * e - d * d,
        ]
        first = a * e - b * d * 4 + c * c * 3
        second = a * c * e + b * c * d * 2 - c * c * c - a * d * d - b * b * e
        if _vanishes(first) and _vanishes(second):
            return "N" if all(map(_vanishes, hessian)) else "III"
        if not _vanishes(first**3 - second**2 * 27):
            return "I"
        return "D" if _proportional([a, b * 4, c * 6, d * 4, e], hessian) else "II"

    def __repr__(self) -> str:
        return str(self)

    def __str__(self) -> str:
        lines = [f"Petrov type {self.petrov_type}"]
        lines += [f"  Psi_{k} = {value}" for k, value in enumerate(self.psi) if value != 0]
        lines += [f"  Phi_{k} = {value}" for k, value in self.phi.items() if value != 0]
        if self.curvature_scalar != 0:
            lines.append(f"  Lambda = {self.curvature_scalar}")
        return "\n".join(lines)


def _vanishes(element: Element) -> bool:
    """Whether an element is zero, decided."""
    verdict = element.is_zero
    if verdict is None:
        raise UndecidedError(
            f"whether {element} vanishes cannot be decided, so the Petrov type is not known. "
            + checks.KNOWN_IDENTITIES
        )
    return verdict


def _proportional(one: Sequence[Element], two: Sequence[Element]) -> bool:
    """Whether two rows depend on each other."""
    pairs = combinations(range(len(one)), 2)
    return all(_vanishes(one[i] * two[j] - one[j] * two[i]) for i, j in pairs)
