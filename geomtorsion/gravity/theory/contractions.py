"""Contractions: values of products of tensors, and their derivatives by one of the tensors."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from fractions import Fraction

from geomtorsion.exact import Element
from geomtorsion.geometry import Frame, Tensor, antisymmetric, contract, symmetric
from geomtorsion.gravity.theory.fields import HALF, Index, Terms
from geomtorsion.gravity.theory.products import EPSILON, METRIC, Factor, Product, simplified
from geomtorsion.support.caching import cached_property
from geomtorsion.support.exclusive import exclusive

# Symmetries of the tensors that a Lagrangian is varied by: pairs of places and signs.
SYMMETRIES = {
    "T": antisymmetric(3),
    "Q": symmetric(3, 1, 2),
    "R": antisymmetric(4),
    "metric R": antisymmetric(4) + antisymmetric(4, 2, 3),
    "F": antisymmetric(2),
}
# Letters for indices, more than a formula may have.
LETTERS = "".join(filter(str.isalpha, map(chr, range(0x1000))))
# dL/dI of an invariant, and a product of it.
Weighted = tuple[Element, Product]


@exclusive
@dataclass(frozen=True, eq=False)
class Contractions:
    """Values and derivatives of products of tensors over one frame.

    frame: the frame, to whose legs all indices refer.
    tensor: factor -> its tensor, with all indices down, except g and eps.
    """

    frame: Frame
    tensor: Callable[[Factor], Tensor]

    @cached_property
    def _contracted(self) -> dict[tuple, Tensor]:
        """Contractions by the names and the indices of their factors."""
        return {}

    @cached_property
    def _epsilon(self) -> Tensor:
        """eps, all indices down in the frame."""
        frame, n = self.frame, self.frame.dimension
        size = (frame.volume / frame.determinant).element()
        return Tensor(frame, "D" * n, {tuple(range(n)): size}, frame.epsilon.symmetry)

    def _of(self, factor: Factor) -> Tensor:
        """The tensor of a factor, whose indices are not summed yet."""
        if factor.name == METRIC:
            return self.frame.eta
        return self._epsilon if factor.name == EPSILON else self.tensor(factor)

    def value(self, products: Iterable[Product]) -> Element:
        """The sum of products without free indices."""
        terms: Terms = []
        for one in products:
            whole, traces = simplified(one.factors, frozenset())
            factor = one.coefficient * self.frame.dimension**traces
            terms.append((factor, self._product(whole, ()).element()))
        return self.frame.field.sum(terms)

    def derivative(self, weighted: Iterable[Weighted], factor: Factor, symmetry: tuple) -> Tensor:
        """Derivative of a sum of products by the tensor of a factor, all its components counted.

        Product rule: drop one factor, contract the others, and project on its symmetry.

        Returns
        -------
        Tensor with all indices down.
        """
        parts: dict[tuple[int, int], list] = {}
        for weight, one in weighted:
            for k, dropped in enumerate(one.factors):
                if (dropped.name, dropped.suffix) != (factor.name, factor.suffix):
                    continue
                rest = [*one.factors[:k], *one.factors[k + 1 :]]
                number, tensor = self._derived(rest, dropped.indices)
                key = id(weight), id(tensor)
                # Equal factors have equal derivatives.
                entry = parts.setdefault(key, [Fraction(0), weight, tensor])
                entry[0] += one.coefficient * number
        rank, total = len(factor.indices), self.frame.field.sum
        listed = [(x, weight, tensor.components.get) for x, weight, tensor in parts.values()]

        def rule(index: Index) -> Element:
            places: list[tuple[Fraction | int, Index]] = [(1, index)]
            for order, sign in symmetry:
                moved = [(sign * x, tuple(place[k] for k in order)) for x, place in places]
                places = [(HALF * x, place) for x, place in places + moved]
            return total([(x * y, w, get(place)) for x, w, get in listed for y, place in places])

        return Tensor(self.frame, "D" * rank, rule if listed else {}, symmetry)

    def _derived(self, rest: list[Factor], indices: Index) -> tuple[Fraction, Tensor]:
        """The contraction of factors with the indices of another one, which are free then."""
        free: list[int] = []
        fresh = max((*indices, *(k for one in rest for k in one.indices)), default=0)
        for k in indices:
            if k in free:
                # A trace of the dropped factor leaves a metric.
                fresh += 1
                rest.append(Factor(METRIC, (k, fresh)))
                k = fresh
            free.append(k)
        whole, traces = simplified(tuple(rest), frozenset(free))
        return Fraction(self.frame.dimension**traces), self._product(whole, tuple(free))

    def _product(self, factors: tuple[Factor, ...], free: Index) -> Tensor:
        """The contraction of factors, whose free indices come in the order of `free`."""
        ordered = _ordered(factors)
        numbers: dict[int, int] = {}
        for one in ordered:
            for k in one.indices:
                numbers.setdefault(k, len(numbers))
        key = (
            tuple((one.name, one.suffix, *(numbers[k] for k in one.indices)) for one in ordered),
            tuple(numbers[k] for k in free),
        )
        if key not in self._contracted:
            self._contracted[key] = self._made(ordered, free)
        return self._contracted[key]

    def _made(self, factors: list[Factor], free: Index) -> Tensor:
        """The contraction of factors in this order."""
        field = self.frame.field
        scalars: list[Element] = []
        tensors: list[Tensor] = []
        indices: list[Index] = []
        for one in factors:
            counts = Counter(one.indices)
            rest = tuple(k for k in one.indices if counts[k] == 1)
            if len(factors) == 1 or rest == one.indices:
                tensors.append(self._of(one))
                indices.append(one.indices)
            elif rest:
                tensors.append(self._product((one,), rest))
                indices.append(rest)
            else:
                scalars.append(self._product((one,), ()).element())
        if not tensors:
            return self.frame.scalar(lambda: field.sum([(1, *scalars)]))
        names: dict[int, str] = {}
        for place, own in enumerate(indices):
            for slot, k in enumerate(own):
                if k in names:
                    # The second of two summed indices is raised.
                    tensors[place] = tensors[place].raised(slot)
                names.setdefault(k, LETTERS[len(names)])
        groups = ["".join(names[k] for k in own) for own in indices]
        wanted = "".join(names[k] for k in free)
        result = contract(f"{','.join(groups)}->{wanted}", *tensors)
        if not scalars:
            return result
        get = result.components.get
        symmetry = result.symmetry
        return Tensor(
            self.frame, result.slots, lambda i: field.sum([(1, *scalars, get(i))]), symmetry
        )


def _ordered(factors: tuple[Factor, ...]) -> list[Factor]:
    """Factors in an order in which each shares as many indices as possible with those before."""
    remaining = sorted(factors, key=lambda one: (one.name, one.suffix))
    ordered = remaining[:1]
    remaining = remaining[1:]
    while remaining:
        present = {k for one in ordered for k in one.indices}
        best = max(remaining, key=lambda one: len(present.intersection(one.indices)))
        remaining.remove(best)
        ordered.append(best)
    return ordered
