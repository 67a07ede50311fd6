"""Values: the numbers of the invariants at a point, in an orthonormal basis or along fixed legs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from itertools import combinations

import mpmath
import numpy as np
import sympy as sp

from geomtorsion import codegen
from geomtorsion.errors import SingularPointError
from geomtorsion.same.invariants import Invariants
from geomtorsion.support.caching import cached_property
from geomtorsion.support.precision import working_digits

Array = np.ndarray
# Sums of products of floats up to one that vanish are smaller than this.
ROUNDING = float(np.sqrt(np.finfo(float).eps))


@dataclass(frozen=True, eq=False)
class Values:
    """Numbers at one point.

    signs: squares of the legs to which they refer, -1 first.
    orders: for each order of derivatives its tensors, all indices down.
    legs: coordinates (rows) of the legs (columns).
    """

    signs: tuple[int, ...]
    orders: tuple[tuple[Array, ...], ...]
    legs: Array

    @property
    def flat(self) -> Array:
        """All components in one row."""
        parts = [t.ravel() for order in self.orders for t in order]
        return np.concatenate(parts) if parts else np.zeros(0)

    def turned(self, turn: Array) -> Values:
        """The numbers along the legs L_a = turn[a, b] L_b."""
        orders = tuple(tuple(turned(t, turn) for t in order) for order in self.orders)
        return Values(self.signs, orders, self.legs @ turn.T)

    def to(self, order: int) -> Values:
        """The same, up to an order of derivatives."""
        return Values(self.signs, self.orders[: order + 1], self.legs)

    @cached_property
    def _powers(self) -> list[tuple[Array, int, int, int]]:
        """Symmetric matrices M_ab, each with the order and the place of its tensor and its power.

        Squares of a tensor over all indices but one, its traces, and squares of traces.
        """
        eta = np.array(self.signs)
        rows = []
        for order, tensors in enumerate(self.orders):
            for place, tensor in enumerate(tensors):
                rank = tensor.ndim
                raised = tensor * reduce(np.multiply.outer, [eta] * rank)
                for k in range(rank):
                    others = [j for j in range(rank) if j != k]
                    # Both factors have the index k down.
                    square = np.tensordot(tensor, raised, (others, others)) * eta
                    rows.append((square, order, place, 2))
                for k, m in combinations(range(rank), 2):
                    signs = eta.reshape([-1 if j == k else 1 for j in range(rank)])
                    trace = np.trace(tensor * signs, axis1=k, axis2=m)
                    if trace.ndim == 1:
                        rows.append((np.outer(trace, trace), order, place, 2))
                    elif trace.ndim == 2:
                        rows.append(((trace + trace.T) / 2, order, place, 1))
        return rows

    @cached_property
    def matrices(self) -> list[Array]:
        """Symmetric matrices M_ab made of the tensors: squares over all indices but one, traces."""
        return [matrix for matrix, *_ in self._powers]

    @property
    def has_scalars(self) -> bool:
        """Whether scalars are more than rounding errors; for plane waves all of them vanish."""
        size = float(np.max(np.abs(self.flat), initial=0))
        if not size:
            return False
        orders = tuple(tuple(t / size for t in order) for order in self.orders)
        scalars = Values(self.signs, orders, self.legs).scalars
        return bool(np.max(np.abs(scalars), initial=0) > ROUNDING)

    @cached_property
    def scalars(self) -> Array:
        """Numbers that no turn changes: traces of products of the matrices."""
        if not self.matrices:
            return np.zeros(0)
        mixed = np.stack(self.matrices) * np.array(self.signs)
        count, flipped = len(mixed), np.swapaxes(mixed, 1, 2)
        # tr(A B) is the product of A and of B transposed, as rows of numbers.
        pairs = mixed.reshape(count, -1) @ flipped.reshape(count, -1).T
        cubes = np.sum((mixed @ mixed) * flipped, axis=(1, 2))
        traces = np.trace(mixed, axis1=1, axis2=2)
        return np.concatenate([traces, pairs[np.triu_indices(count)], cubes])

    def scalar_weights(self, weights: Sequence[int]) -> Array:
        """Powers of 1/length of the scalars, from the powers of the tensors in order 0."""
        single = [power * (weights[place] + order) for _, order, place, power in self._powers]
        pairs = [a + b for j, a in enumerate(single) for b in single[j:]]
        return np.array([*single, *pairs, *(3 * a for a in single)])

    def component_weights(self, weights: Sequence[int]) -> Array:
        """Powers of 1/length of all components in one row, in the same way."""
        parts = [
            np.full(t.size, weights[place] + order)
            for order, tensors in enumerate(self.orders)
            for place, t in enumerate(tensors)
        ]
        return np.concatenate(parts) if parts else np.zeros(0)


def turned(tensor: Array, turn: Array) -> Array:
    """A tensor along the legs L_a = turn[a, b] L_b."""
    for _ in range(tensor.ndim):
        # The first index goes to the end, as often as there are indices.
        tensor = np.tensordot(tensor, turn, (0, 1))
    return tensor


def generators(signs: Sequence[int]) -> list[Array]:
    """Infinitesimal turns G_a^m in each plane."""
    result = []
    for b, c in combinations(range(len(signs)), 2):
        matrix = np.zeros((len(signs),) * 2)
        matrix[b, c], matrix[c, b] = signs[c], -signs[b]
        result.append(matrix)
    return result


def _real(numbers: Array) -> Array:
    """The real parts of numbers, which are real."""
    if numbers.dtype != object:
        return np.real(numbers)
    return np.array([x.real for x in numbers.ravel()], dtype=object).reshape(numbers.shape)


class Evaluation:
    """The values of invariants up to an order, at points of the coordinates, quickly or exactly."""

    def __init__(self, invariants: Invariants, order: int) -> None:
        self.invariants = invariants
        self.order = order

    @cached_property
    def _tensors(self) -> list[list]:
        return [self.invariants.order(k) for k in range(self.order + 1)]

    @cached_property
    def _basis(self) -> list:
        """Tensors from which the basis of the numbers follows."""
        inv = self.invariants
        return [inv.frame.legs] if inv.slot == "D" else [inv.scalar_product]

    def at(self, point: Mapping[sp.Symbol, object], digits: int) -> Values | None:
        """Values at a point to many digits, as numbers of mpmath; None where one is not finite."""
        try:
            orders = [[t.at(point, digits=digits) for t in order] for order in self._tensors]
            (basis,) = (t.at(point, digits=digits) for t in self._basis)
        except SingularPointError:
            return None
        with working_digits(digits):
            return self._values(orders, basis, digits)

    @cached_property
    def _compiled(self) -> tuple:
        """A function of floats for all independent components, and where they belong."""
        elements, places = [], []
        for tensor in (t for order in (*self._tensors, self._basis) for t in order):
            independent = tensor.components.independent
            rows = {index: len(elements) + k for k, index in enumerate(independent)}
            elements += independent.values()
            signs = [(i, *tensor.components.representative(i)) for i in tensor.components.support]
            shape = (self.invariants.frame.dimension,) * len(tensor.slots)
            flat = [int(np.ravel_multi_index(i, shape)) if i else 0 for i, *_ in signs]
            sources, weights = [rows[j] for *_, j in signs], [s for _, s, _ in signs]
            places.append((shape, flat, sources, np.array(weights, dtype=float)))
        frame = self.invariants.frame
        symbols = [*frame.coordinates, *frame.parameters]
        function = codegen.numpy_function(elements, symbols, check=False)
        return function, places

    def near(self, point: Array) -> Values | None:
        """Values as floats at coordinates and parameters; None where one is not finite."""
        function, places = self._compiled
        with np.errstate(all="ignore"):
            table = function(*point)
        if not np.all(np.isfinite(table)):
            return None
        tensors = []
        for shape, flat, sources, weights in places:
            tensor = np.zeros(int(np.prod(shape)), dtype=table.dtype)
            tensor[flat] = weights * table[sources]
            tensors.append(tensor.reshape(shape))
        orders, start = [], 0
        for order in self._tensors:
            orders.append(tensors[start : start + len(order)])
            start += len(order)
        return self._values(orders, tensors[-1], None)

    def _values(
        self, orders: Sequence[Sequence[Array]], basis: Array, digits: int | None
    ) -> Values | None:
        inv = self.invariants
        if not inv.turns:
            return Values((1,) * len(basis), tuple(map(tuple, orders)), basis)
        if inv.frame.complex:
            # Components in coordinates are real, whatever the legs are.
            orders, basis = [[_real(t) for t in order] for order in orders], _real(basis)
        in_frame = inv.slot == "D"
        vectors = self._frame_basis(digits) if in_frame else orthonormal(basis, digits)
        if vectors is None:
            return None
        signs, matrix = vectors
        if matrix is None:
            return Values(signs, tuple(map(tuple, orders)), basis)
        if np.linalg.det(matrix.astype(float)) < 0:
            # As the legs, or as the coordinates, in their order.
            matrix = np.concatenate([matrix[:-1], -matrix[-1:]])
        orders = [[turned(t, matrix) for t in order] for order in orders]
        legs = basis @ matrix.T if in_frame else matrix.T
        return Values(signs, tuple(map(tuple, orders)), legs)

    def _frame_basis(self, digits: int | None) -> tuple[tuple[int, ...], Array | None] | None:
        """An orthonormal basis of the frame: rows in terms of the legs; None: the legs."""
        return self._float_basis if digits is None else self._basis_to(digits)

    @cached_property
    def _float_basis(self) -> tuple[tuple[int, ...], Array | None] | None:
        return self._basis_to(None)

    def _basis_to(self, digits: int | None) -> tuple[tuple[int, ...], Array | None] | None:
        eta = self.invariants.frame.eta.at({}, digits=digits)
        squares = [int(x) if x in (1, -1) else 0 for x in np.diag(eta)]
        if 0 in squares or np.any(eta != np.diag(np.diag(eta))):
            return orthonormal(eta, digits)
        if squares == sorted(squares):
            return tuple(squares), None
        order = sorted(range(len(squares)), key=lambda k: squares[k])
        return tuple(squares[k] for k in order), np.eye(len(squares))[order]


def orthonormal(metric: Array, digits: int | None) -> tuple[tuple[int, ...], Array] | None:
    """Signs, -1 first, and orthonormal vectors (rows) at a point, by Gram and Schmidt.

    The vectors to begin with are fixed and of no particular direction, so that none is null and
    the result changes smoothly from point to point.
    """
    n, root = len(metric), np.sqrt if digits is None else mpmath.sqrt
    signs, rows = [], []
    for k in range(n):
        row = [
            Fraction(1 if j == k else 0 if j < k else 1, 2 + k + 3 * j if j > k else 1)
            for j in range(n)
        ]
        if digits is None:
            vector = np.array(row, dtype=float)
        else:
            vector = np.array([mpmath.mpf(x.numerator) / x.denominator for x in row], dtype=object)
        for sign, other in zip(signs, rows, strict=True):
            vector = vector - sign * (vector @ metric @ other) * other
        square = vector @ metric @ vector
        if square == 0:
            return None
        signs.append(1 if square > 0 else -1)
        rows.append(vector / root(abs(square)))
    order = sorted(range(n), key=lambda k: signs[k])
    return tuple(signs[k] for k in order), np.array([rows[k] for k in order])
