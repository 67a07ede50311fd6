"""Killing-Yano forms: antisymmetric tensors whose derivative is antisymmetric."""

from __future__ import annotations

from collections.abc import Callable, Sequence
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
    n, field, q = frame.dimension, frame.field, frame.coordinates
    elements = independent(frame, functions)
    slopes = [[x.diff(one) for one in q] for x in elements]
    bar = levi_civita(frame)
    gamma = bar.coefficients.components.get
    coupling: Callable[[Index], Element] = gamma
    if slot == "D":
        legs, omega = frame.legs.components.get, bar.spin_connection.components.get
        slopes = [
            [field.sum([(1, legs((a, i)), x) for a, x in enumerate(slope)]) for i in range(n)]
            for slope in slopes
        ]
        table: dict[Index, Element] = {
            (i, j, k): field.sum([(1, legs((a, i)), omega((a, j, k))) for a in range(n)])
            for i, j, k in product(range(n), repeat=3)
        }
        coupling = table.__getitem__
    components = list(combinations(range(n), p))
    place = {index: k for k, index in enumerate(components)}
    size = len(elements)
    equations = []
    for (i, j), rest in product(
        combinations_with_replacement(range(n), 2), combinations(range(n), p - 1)
    ):
        terms: list[list[tuple]] = [[] for _ in range(len(components) * size)]
        for a, b in ((i, j), (j, i)):
            own = (b, *rest)
            sign, index = _sorted(own)
            for m in range(size if sign else 0):
                terms[place[index] * size + m].append((sign, slopes[m][a]))
            for k, old in enumerate(own):
                for new in range(n):
                    sign, index = _sorted((*own[:k], new, *own[k + 1 :]))
                    turn = coupling((a, old, new))
                    if sign and turn is not field.zero:
                        for m, x in enumerate(elements):
                            terms[place[index] * size + m].append((-sign, x, turn))
        equations.append([field.sum(one) if one else field.zero for one in terms])
    tensors = []
    for weights in vanishing_sums(equations, len(components) * size):
        values: dict[Index, Element] = {}
        for k, index in enumerate(components):
            parts = [(c, x) for c, x in zip(weights[k * size :], elements, strict=False) if c]
            if parts:
                values[index] = field.sum(parts)
        tensors.append(_antisymmetric(frame, slot, p, values))
    return tensors


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
