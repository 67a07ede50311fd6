"""Search: vectors that keep a metric, among sums of functions with rational coefficients."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations_with_replacement, product

import sympy as sp

from geomtorsion.exact import Element, vanishing_sums
from geomtorsion.geometry import Frame, Tensor, levi_civita

Entry = Callable[[int, int], Element]


@dataclass(frozen=True)
class Components:
    """The equations of Killing for one kind of components of xi.

    e_i f h_kj + e_j f h_ki + f C_ijk = 0, summed over all terms f of all components xi_k.

    legs: e_i^a, the vectors along which components are differentiated; None for coordinates.
    lowering: h_kj, which lowers the index of a component.
    coupling: C_ijk.
    """

    legs: Entry | None
    lowering: Entry
    coupling: Callable[[int, int, int], Element]


def _components(frame: Frame, slot: str) -> Components:
    """Slot u: xi^a; d: xi_a; D: xi_i along legs."""
    field, n = frame.field, frame.dimension

    def unit(k: int, j: int) -> Element:
        return field.one if k == j else field.zero

    if slot == "u":
        g = frame.metric.components.get
        return Components(
            None, lambda k, j: g((k, j)), lambda i, j, k: g((i, j)).diff(frame.coordinates[k])
        )
    bar = levi_civita(frame)
    if slot == "d":
        gamma = bar.coefficients.components.get
        return Components(None, unit, lambda i, j, k: gamma((i, j, k)) * -2)
    legs, omega = frame.legs.components.get, bar.spin_connection.components.get

    def turning(i: int, j: int, k: int) -> Element:
        terms = [
            (-1, legs((a, x)), omega((a, y, k))) for a in range(n) for x, y in ((i, j), (j, i))
        ]
        return field.sum(terms)

    return Components(lambda a, i: legs((a, i)), unit, turning)


def killing_vectors(
    frame: Frame, functions: Sequence[sp.Expr], slot: str, scaling: int
) -> list[Tensor]:
    """All xi^a whose components are sums of functions with rational coefficients.

    The factor phi of L_xi g = 2 phi g is such a sum too.

    slot: u for components xi^a, d for xi_a, D for components along legs.
    scaling: 0 for phi = 0, 1 for constant phi, 2 for any.
    """
    if not functions:
        return []
    n, field, q = frame.dimension, frame.field, frame.coordinates
    elements = independent(frame, functions)
    own = _components(frame, slot)
    along = _derivatives(frame, elements, own)
    lowering = [[own.lowering(k, j) for j in range(n)] for k in range(n)]
    unknowns = list(product(range(n), range(len(elements))))
    # Factors phi of the metric, after the components of the vector.
    factors = ((), [x for x in elements if all(x.free_of(one) for one in q)], elements)[scaling]
    metric = (frame.eta if slot == "D" else frame.metric).components.get
    equations = []
    for i, j in combinations_with_replacement(range(n), 2):
        coupling = [own.coupling(i, j, k) for k in range(n)]
        row = []
        for k, m in unknowns:
            terms = [(1, along[m][i], lowering[k][j]), (1, along[m][j], lowering[k][i])]
            row.append(field.sum([*terms, (1, elements[m], coupling[k])]))
        row += [field.sum([(-2, x, metric((i, j)))]) for x in factors]
        equations.append(row)
    return [
        _vector(frame, slot, zip(unknowns, weights[: len(unknowns)], strict=True), elements)
        for weights in vanishing_sums(equations, len(unknowns) + len(factors))
    ]


def _derivatives(frame: Frame, elements: Sequence[Element], own: Components) -> list[list[Element]]:
    """Derivatives of functions by each coordinate, or along each leg."""
    n = frame.dimension
    slopes = [[x.diff(one) for one in frame.coordinates] for x in elements]
    if own.legs is None:
        return slopes
    legs = [[own.legs(a, i) for a in range(n)] for i in range(n)]
    return [
        [frame.field.sum([(1, x, y) for x, y in zip(leg, slope, strict=True)]) for leg in legs]
        for slope in slopes
    ]


def _vector(
    frame: Frame,
    slot: str,
    terms: Iterable[tuple[tuple[int, int], Fraction]],
    elements: Sequence[Element],
) -> Tensor:
    """The vector with components of one kind."""
    sums: dict[tuple[int, ...], list[tuple]] = {}
    for (k, m), c in terms:
        if c:
            sums.setdefault((k,), []).append((c, elements[m]))
    components = Tensor(frame, slot, {k: frame.field.sum(own) for k, own in sums.items()})
    upper = components if slot == "u" else components.in_coordinates().raised(0)
    return Tensor(frame, "u", upper.components, (), "\\xi", "symmetry")


def independent(frame: Frame, functions: Sequence[sp.Expr]) -> list[Element]:
    """Functions as exact elements, without those that are sums of others."""
    elements = frame.read([("ansatz", one) for one in functions])
    # The last function of each relation, such as sin**2 + cos**2 = 1, is a sum of the others.
    relations = vanishing_sums([elements], len(elements))
    spare = {max(k for k, c in enumerate(one) if c) for one in relations}
    return [x for k, x in enumerate(elements) if k not in spare]
