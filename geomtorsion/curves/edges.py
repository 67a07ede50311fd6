"""Edges: where the coordinates of a frame end, from its domain, its roots and its branches."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.exact import Element
from geomtorsion.exact.generators import Generator
from geomtorsion.geometry.derived import derived
from geomtorsion.geometry.domain_edges import Edge, domain_edges
from geomtorsion.ode.rates import changes_with_sign

if TYPE_CHECKING:
    from collections.abc import Iterator

    from geomtorsion.exact.tower import Tower
    from geomtorsion.geometry import Frame

# Functions without a root of their own that may enter a sum of squares.
_REAL = ("symbol", "cos", "sin", "cosh", "sinh", "exp", "log")


@derived
def edges_of(frame: Frame) -> tuple[Edge, ...]:
    """All edges of a frame: its declared domain, roots that vanish, branches that end.

    A root is watched itself, not its radicand: motions that come to rest on the edge touch it, and
    there the radicand has a double zero, which rounding hides, but its root a simple one.

    Examples
    --------
    >>> from geomtorsion.geometry import Frame
    >>> r, phi = sp.symbols("r phi")
    >>> flat = Frame([r, phi], [[1, 0], [0, r]], domain=[r > 0, phi > 0, phi < 2 * sp.pi])
    >>> [edge.words for edge in edges_of(flat)]
    ['r > 0 holds no longer']
    """
    edges = [*domain_edges(frame), *_of_roots(frame)]
    inside = set(frame.coordinates)
    moving = {edge.element: edge for edge in reversed(edges) if edge.element.symbols & inside}
    return tuple(reversed(moving.values()))


def _of_roots(frame: Frame) -> Iterator[Edge]:
    """Roots and arguments of logarithms that may fall through zero."""
    waiting = [value for matrix in frame.given.values() for value in matrix.values()]
    seen: set[Generator] = set()
    while waiting:
        element = waiting.pop(0)
        for generator in element.field.generators_of(element):
            if generator in seen:
                continue
            seen.add(generator)
            if generator.tail is not None:
                waiting.append(generator.tail)
            if generator.kind == "root" and (
                not _is_sum_of_squares(generator.tail) or _has_a_kink(frame, generator)
            ):
                root = element.field.generator_element(generator)
                shown = generator.shown
                yield Edge(root, f"{shown} = 0", f"it needs {shown}", is_root=True)
            elif generator.kind == "log" and isinstance(generator.argument, Element):
                shown = generator.argument
                yield Edge(shown, f"{shown} = 0", f"it needs log({shown})")
            elif generator.kind == "primitive":
                _, slope, _ = generator.argument
                # Inverse functions end where their slope has a pole, most of them a root.
                waiting.append(slope)
                room = slope.inverse()
                if generator.shown.func is sp.atanh:
                    yield Edge(room, f"{room} = 0", f"it needs {generator.shown}")


def _is_sum_of_squares(element: Element | None) -> bool:
    """Whether an element has even powers of real functions only, with positive numbers."""
    if element is None:
        return False
    field: Tower = element.field
    odd = [g.kind not in _REAL for g in field.generators]
    for polynomial in (field.lift(element), *(field.factors[k] for k, _ in element._den)):
        for powers, number in polynomial.to_dict().items():
            if number < 0 or any(power % 2 for power in powers):
                return False
            if any(power and strange for power, strange in zip(powers, odd, strict=True)):
                return False
    return True


def _has_a_kink(frame: Frame, root: Generator) -> bool:
    """Whether the root of a sum of squares may vanish, and the metric is odd in it.

    Series continue with its other sign beyond the point where it vanishes.
    """
    tail = root.tail
    assert tail is not None
    field: Tower = tail.field
    inside = set(frame.coordinates)
    still = [not g.depends & inside for g in field.generators]
    for powers in field.lift(tail).to_dict():
        if all(fixed for power, fixed in zip(powers, still, strict=True) if power):
            return False
    entries = {**frame.metric.nonzero(), **frame.metric.undecided()}.values()
    return any(changes_with_sign(entry, root.shown**2) for entry in entries)
