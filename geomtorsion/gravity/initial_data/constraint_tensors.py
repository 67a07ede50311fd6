"""Constraint tensors: both constraints of a slice, over an exact or a numeric frame."""

from __future__ import annotations

import sympy as sp

from geomtorsion.exact import Element
from geomtorsion.geometry import Frame, Tensor, contract, levi_civita


def constraint_tensors(
    frame: Frame, K: Tensor, rho: Element | None, flux: Tensor | None, constant: Element
) -> tuple[Tensor, Tensor]:
    """H of rank 0 and M_i, see `constraints`.

    K: K_ij, slots dd. rho: density. flux: j_i, slots d. constant: the cosmological constant.
    """
    field, connection = frame.field, levi_civita(frame)
    mixed = K.raised(1)
    trace = contract("aa->", mixed)
    square = contract("ab,ba->", mixed, mixed)
    pi = frame.read([("pi", sp.pi)])[0]
    matter = [] if rho is None else [(-16, pi, rho)]
    R = connection.curvature.scalar

    def hamiltonian() -> Element:
        k = trace.components.get(())
        terms = [(1, R.components.get(())), (1, k, k), (-1, square.components.get(()))]
        return field.sum([*terms, (-2, constant), *matter])

    divergence = connection.divergence(mixed, 1)
    slope = connection.covariant_derivative(trace)

    def momentum(index: tuple[int, ...]) -> Element:
        terms = [(1, divergence.components.get(index)), (-1, slope.components.get(index))]
        terms += [] if flux is None else [(-8, pi, flux.components.get(index))]
        return field.sum(terms)

    H = frame.scalar(hamiltonian, "H", "Hamiltonian constraint")
    return H, Tensor(frame, "d", momentum, (), "M", "momentum constraint")
