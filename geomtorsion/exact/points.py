"""Points: at which random point of a field elements have values (see `modular`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from geomtorsion.exact.limits import NoPointError
from geomtorsion.exact.modular import ModularPoint
from geomtorsion.exact.primes import BITS

if TYPE_CHECKING:
    from geomtorsion.exact.tower import Tower


def point_of(field: Tower) -> ModularPoint:
    """The point of a field, made on first use."""
    point = field.tables.get("modular point")
    if point is None:
        point = field.tables["modular point"] = ModularPoint(field)
    return point


def leave_point(field: Tower) -> None:
    """Other values for all generators of a field, as one of them is found to depend on others."""
    for name in ("modular point", "extended point"):
        if name in field.tables:
            field.tables[name].leave()


def roomy_point_of(field: Tower) -> ModularPoint:
    """The point at which elements have values: where square roots are many, an extended one.

    A point has n square roots in the numbers modulo a prime with a chance of 2**-n. In the extended
    field this concerns only roots of roots.

    Raises
    ------
    NoPointError
        roots of roots are many.
    """
    many = BITS.bit_length()
    if len(field.generators) < many:
        return point_of(field)
    square = [g for g in field.generators if g.kind == "root" and g.degree == 2]
    if len(square) < many:
        return point_of(field)
    inner = [field.generators_of(g.tail) for g in square if g.tail is not None]
    if sum(any(g.kind == "root" and g.degree == 2 for g in radicand) for radicand in inner) > many:
        raise NoPointError
    point = field.tables.get("extended point")
    if point is None:
        point = field.tables["extended point"] = ModularPoint(field, extended=True)
    return point
