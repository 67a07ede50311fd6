"""Killing-Yano forms: antisymmetric tensors whose derivative is antisymmetric."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import combinations, combinations_with_replacement, product
from math import comb

import sympy as sp

from geomtorsion.errors import ArgumentError
from geomtorsion.exact import Echelon, Element, vanishing_sums
from geomtorsion.geometry import Form, Frame, Tensor, levi_civita
from geomtorsion.geometry.connections import FrameLike, as_frame
from geomtorsion.same.symmetry.symmetries import symmetries
from geomtorsion.same.symmetry.symmetry_products import products
from geomtorsion.same.symmetry.symmetry_search import independent
from geomtorsion.support import checks
from geomtorsion.support.exclusive import exclusive

Index = tuple[int, ...]
# Derivatives [m][a] of functions, and a connection by its indices.
Slopes = list[list[Element]]
Coupling = Callable[[Index], Element]


@exclusive
def killing_yano(frame: FrameLike, degree: int = 2) -> tuple[Form, ...]:
    """Killing-Yano forms of a metric in closed form, each checked exactly.

    Equation
    --------
    D_a f_bc... + D_b f_ac... = 0                                          [Yano1952]

    f_ac f_b^c is a Killing tensor. Components along legs or coordinates are sums of products with
    one factor of each coordinate (see `Symmetries.ansatz`); forms of another kind are not found.

    Parameters
    ----------
    degree
        The number of indices, from 1 (Killing covectors) to the dimension (the volume).

    Raises
    ------
    ArgumentError
        The degree is not a whole number from 1 to the dimension.

    Examples
    --------
    >>> from geomtorsion.same import killing_yano
    >>> killing_yano("schwarzschild")
    (r**3*sin(theta) dtheta ^ dphi,)
    """
    frame = as_frame(frame)
    p = checks.count(degree, "degree", ArgumentError, 1, frame.dimension)
    lists = symmetries(frame).waves
    bar = levi_civita(frame)
    echelon = Echelon(frame.field, 2 * frame.dimension ** (p + 1))
    forms = []
    for constants, slot in product((False, True), "d" if frame.complex else "Dd"):
        # Flat space and spheres have the largest number.
        if len(forms) == comb(frame.dimension + 1, p + 1):
            break
        for tensor in _search(frame, products(frame, lists, 1, constants), slot, p):
            lower = tensor.in_coordinates()
            slope = bar.covariant_derivative(lower)
            n = range(frame.dimension)
            # The values of f and D f at one point determine a form.
            values = [lower.element(*index) for index in product(n, repeat=p)]
            values += [slope.element(*index) for index in product(n, repeat=p + 1)]
            if echelon.add(values + [frame.field.zero] * (echelon.width - len(values))):
                forms.append(Form.of(tensor))
    return tuple(forms)


def _search(frame: Frame, functions: Sequence[sp.Expr], slot: str, p: int) -> list[Tensor]:
    """All forms whose components are sums of functions with rational coefficients."""
    if not functions:
        return []
    elements = independent(frame, functions)
    slopes, coupling = _derivatives(frame, elements, slot)
    components = list(combinations(range(frame.dimension), p))
    place = {index: k * len(elements) for k, index in enumerate(components)}
    width = len(components) * len(elements)
    equations = [
        _equation(frame, elements, slopes, coupling, place, pair, rest)
        for pair, rest in product(
            combinations_with_replacement(range(frame.dimension), 2),
            combinations(range(frame.dimension), p - 1),
        )
    ]
    return [
        _antisymmetric(frame, slot, p, _components(frame, elements, place, weights))
        for weights in vanishing_sums(equations, width)
    ]


def _derivatives(frame: Frame, elements: Sequence[Element], slot: str) -> tuple[Slopes, Coupling]:
    """Derivatives of the functions, [m][a], and the connection [a, b, c] of D_a in a slot."""
    n, field = frame.dimension, frame.field
    bar = levi_civita(frame)
    slopes = [[x.diff(one) for one in frame.coordinates] for x in elements]
    if slot == "d":
        return slopes, bar.coefficients.components.get
    legs, omega = frame.legs.components.get, bar.spin_connection.components.get
    slopes = [
        [field.sum([(1, legs((a, i)), x) for a, x in enumerate(slope)]) for i in range(n)]
        for slope in slopes
    ]
    table: dict[Index, Element] = {
        (i, j, k): field.sum([(1, legs((a, i)), omega((a, j, k))) for a in range(n)])
        for i, j, k in product(range(n), repeat=3)
    }
    return slopes, table.__getitem__


def _equation(
    frame: Frame,
    elements: Sequence[Element],
    slopes: Slopes,
    coupling: Coupling,
    place: Mapping[Index, int],
    pair: tuple[int, int],
    rest: Index,
) -> list[Element]:
    """D_a f_b... + D_b f_a... for the pair (a, b), as coefficients of the weights."""
    terms: list[list[tuple]] = [[] for _ in range(len(place) * len(elements))]
    for a, b in (pair, pair[::-1]):
        own = (b, *rest)
        sign, index = _sorted(own)
        if sign:
            for m, slope in enumerate(slopes):
                terms[place[index] + m].append((sign, slope[a]))
        for k, new in product(range(len(own)), range(frame.dimension)):
            sign, index = _sorted((*own[:k], new, *own[k + 1 :]))
            turn = coupling((a, own[k], new))
            if sign and turn is not frame.field.zero:
                for m, x in enumerate(elements):
                    terms[place[index] + m].append((-sign, x, turn))
    return [frame.field.sum(one) if one else frame.field.zero for one in terms]


def _components(
    frame: Frame, elements: Sequence[Element], place: Mapping[Index, int], weights: Sequence
) -> dict[Index, Element]:
    """The components at increasing indices that the weights of the functions give."""
    sums = {
        index: [(c, x) for c, x in zip(weights[first:], elements, strict=False) if c]
        for index, first in place.items()
    }
    return {index: frame.field.sum(parts) for index, parts in sums.items() if parts}


def _antisymmetric(frame: Frame, slot: str, p: int, values: dict[Index, Element]) -> Tensor:
    """The antisymmetric tensor with these components at increasing indices."""

    def rule(index: Index) -> Element:
        sign, place = _sorted(index)
        value = values.get(place) if sign else None
        return frame.field.zero if value is None else value * sign

    return Tensor(frame, slot * p, rule, (), "f", "Killing-Yano form")


def _sorted(index: Index) -> tuple[int, Index]:
    """The sign of the order of indices, 0 if one is repeated, and the indices in order."""
    if len(set(index)) < len(index):
        return 0, index
    swaps = sum(a > b for a, b in combinations(index, 2))
    return (-1) ** swaps, tuple(sorted(index))
