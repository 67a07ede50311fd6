"""Degrees: bounds on degrees of elements in the random numbers of `modular`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from geomtorsion.exact.element import in_order

if TYPE_CHECKING:
    from flint import fmpq_mpoly

    from geomtorsion.exact.element import Element
    from geomtorsion.exact.generators import Generator


def degree(element: Element) -> int:
    """A bound on the degree of an element's numerator and denominator in the random numbers."""
    field = element.field
    weights: dict[str, int] = {}

    def of_element(whole: Element) -> int:
        degrees: dict[int, int] = {}
        for node in in_order(whole, lambda x: id(x) in degrees):
            recipe = node._recipe
            # Over one common denominator the degrees of all denominators add up.
            sizes = (degrees[id(x)] if x.is_kept else of_polynomials(x) for x in recipe.parts)
            degrees[id(node)] = sum(sizes)
        return degrees[id(whole)] if whole.is_kept else of_polynomials(whole)

    def of_polynomials(one: Element) -> int:
        total = _total(field.lift(one))
        return total + sum(e * _total(field.factors[i]) for i, e in one._den)

    def _total(poly: fmpq_mpoly) -> int:
        return sum(
            int(d) * weight(generator)
            for d, generator in zip(poly.degrees(), field.generators, strict=True)
            if d
        )

    def weight(generator: Generator) -> int:
        # cos and sin are quotients of degree two in the number that is chosen.
        if generator.name not in weights:
            own = 2 if generator.kind in ("cos", "sin", "cosh", "sinh") else 1
            meaning = field.meanings.get(generator.name)
            if generator.degree and own == 1 and generator.tail is not None:
                own = of_polynomials(generator.tail) + 1
            elif meaning is not None:
                own = of_element(meaning)
            weights[generator.name] = own
        return weights[generator.name]

    return max(of_element(element), 1)
