"""Identities: Noether identities of field equations, checked exactly."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product

from geomtorsion.exact import Certainty, Element
from geomtorsion.geometry import IdentityCheck, Tensor
from geomtorsion.gravity.theory.fields import FrameFields, Index, Terms

# Indices, and the difference of both sides of an identity at an index.
Differences = tuple[Sequence[Index], Callable[[Index], Element]]


def rotations(M: Tensor) -> IdentityCheck:
    """E_[ji] + D_n C^n_[ij] = 0: rotations of the legs leave the Lagrangian invariant."""
    return _checked("rotations", "E_[ji] + D_n C^n_[ij] = 0", *rotation_terms(M))


def rotation_terms(M: Tensor) -> Differences:
    """Twice E_[ji] + D_n C^n_[ij]."""
    n, get = range(M.frame.dimension), M.components.get

    def value(index: Index) -> Element:
        return M.frame.field.sum([(1, get(index)), (-1, get(index[::-1]))])

    return [(i, j) for i in n for j in n if i < j], value


def translations(
    E: Tensor,
    M: Tensor,
    connections: Sequence[tuple[FrameFields, Tensor, Tensor]],
    matter: Callable[[int], Terms],
) -> IdentityCheck:
    """D_n(e E_i^n)/e = T_in^j E_j^n + R_ink^j C^{nk}_j + Q_ijk M^jk + (matter)."""
    equation = "D_n(e E_i^n)/e = T_in^j E_j^n + R_ink^j C^{nk}_j + Q_ijk M^jk"
    return _checked("translations", equation, *translation_terms(E, M, connections, matter))


def translation_terms(
    E: Tensor,
    M: Tensor,
    connections: Sequence[tuple[FrameFields, Tensor, Tensor]],
    matter: Callable[[int], Terms],
) -> Differences:
    """Left minus right side of the identity of translations.

    connections: of each the fields, C and (1/e) D_n(e C^{ni}_j).
    matter: terms of matter fields for an index i.
    """
    frame, n = E.frame, range(E.frame.dimension)
    first = connections[0][0]
    e, m = E.components.get, M.raised().components.get
    flow = first.divergence(Tensor(frame, "UD", lambda place: e(place[::-1]))).components.get
    t, q = first.torsion.components.get, first.nonmetricity.components.get
    omega = first.omega.components.get

    def value(index: Index) -> Element:
        (i,) = index
        terms: Terms = [(1, flow(index)), *matter(i)]
        terms += [(-1, t((i, a, j)), e((j, a))) for a in n for j in n]
        terms += [(-1, q((i, j, k)), m((j, k))) for j in n for k in n]
        for fields, C, turned in connections:
            c, r = C.components.get, fields.curvature.raised(3).components.get
            terms += [(-1, r((i, a, k, j)), c((a, k, j))) for a, k, j in product(n, repeat=3)]
            if fields is not first:
                # Each further connection turns with the legs as the first one does.
                own, d = fields.omega.components.get, turned.components.get
                for k, j in product(n, repeat=2):
                    terms.append((1, own((i, k, j)), d((k, j))))
                    terms.append((-1, omega((i, k, j)), d((k, j))))
        return frame.field.sum(terms)

    return [(i,) for i in n], value


def _checked(
    name: str, equation: str, indices: Sequence[Index], value: Callable[[Index], Element]
) -> IdentityCheck:
    """Evaluate the difference of both sides at every index."""
    holds: bool | None = True
    worst, chances, proved = None, 0.0, True
    for index in indices:
        element = value(index)
        verdict = element.is_zero
        if verdict is not False:
            proved = proved and element.certainty.proved
            chances += element.certainty.error
        if (verdict is False and holds is not False) or (verdict is None and holds):
            holds, worst = verdict, index
    return IdentityCheck(
        name, equation, holds, len(indices), worst, Certainty(proved, min(chances, 1.0))
    )
