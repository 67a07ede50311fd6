"""AdaptedFrame: a frame some of whose forms are the constraints, and what changes with it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.action.tangent_bundle import TangentBundle
from geomtorsion.errors import ConstraintError
from geomtorsion.geometry import Frame
from geomtorsion.geometry.matrices import inverse
from geomtorsion.geometry.validation import Opened

if TYPE_CHECKING:
    from geomtorsion.exact import Element

Row = dict[int, "Element"]


@dataclass(frozen=True, eq=False)
class AdaptedFrame:
    """A frame in which constraints a^r_i u^i + c^r = 0 read w^r = -c^r; all other forms stay.

    bundle: the adapted frame, in the field of the frame before.
    free: numbers of the forms that stay; the others are replaced by constraints, in order.
    fixed: w^r = -c^r(q, t) by the number of the form that it replaces; mostly zero.
    given: B^i_k with u^i = B^i_k w^k, at (i, k).
    """

    bundle: TangentBundle
    free: tuple[int, ...]
    fixed: Mapping[int, Element]
    given: Mapping[tuple[int, int], Element]

    def covector(self, values: Sequence[Element]) -> tuple[Element, ...]:
        """B^i_k v_i: a covector (momenta, forces) in the adapted frame."""
        n, field = self.bundle.dimension, self.bundle.field
        terms: list[list] = [[] for _ in range(n)]
        for (i, k), value in self.given.items():
            terms[k].append((1, value, values[i]))
        return tuple(field.sum(row) for row in terms)

    def velocity_substitution(self) -> dict[sp.Symbol, sp.Expr]:
        """u^i = B^i_k w^k, the new velocities under the names of the old ones."""
        u = self.bundle.symbols.velocities
        terms: list[list[sp.Expr]] = [[] for _ in u]
        for (i, k), value in self.given.items():
            terms[i].append(value.sympy * u[k])
        return {symbol: sp.Add(*row) for symbol, row in zip(u, terms, strict=True)}

    def fixed_values(self) -> dict[sp.Symbol, sp.Expr]:
        """The values of the replaced velocities."""
        u = self.bundle.symbols.velocities
        return {u[k]: value.sympy for k, value in self.fixed.items()}


def adapted_frame(
    bundle: TangentBundle, constraints: Sequence[tuple[str, Element]]
) -> AdaptedFrame:
    """The frame adapted to constraints that are linear in the velocities.

    Each constraint takes the place of one form: of one with a constant coefficient if there is
    any, so that the adapted frame ends where the given one does; the last such.

    Raises
    ------
    ConstraintError
        A constraint is not linear in u, its coefficients depend on t, or it follows from others.
    """
    read = [_coefficients(bundle, where, value) for where, value in constraints]
    rows = [row for row, _ in read]
    replaced = _pivots(bundle, rows, [where for where, _ in constraints])
    n, one = bundle.dimension, bundle.field.one
    turn = {(i, i): one for i in range(n) if i not in replaced}
    for row, place in zip(rows, replaced, strict=True):
        turn.update(((place, i), value) for i, value in row.items())
    coframe = {}
    for (k, i), value in turn.items():
        for mu, form in bundle.frame.coframe.components.rows[i]:
            coframe.setdefault((k, mu), []).append((1, value, form))
    summed = {index: bundle.field.sum(terms) for index, terms in coframe.items()}
    free = tuple(i for i in range(n) if i not in replaced)
    adapted = _reframed(bundle.frame, summed)
    fixed = {place: -rest for place, (_, rest) in zip(replaced, read, strict=True)}
    return AdaptedFrame(bundle.over(adapted), free, fixed, inverse(bundle.field, turn, n))


def _reframed(frame: Frame, coframe: Mapping[tuple[int, int], Element]) -> Frame:
    """Another coframe over the same coordinates, in the same field."""
    entries = {index: value for index, value in coframe.items() if not value.is_zero}
    opened = Opened(frame.coordinates, frame.parameters, frame.domain, frame.complex, frame.field)
    # A frame of its own field would not know the symbols of the velocities.
    adapted: Frame = object.__new__(Frame)
    given = {"coframe": entries, "eta": dict(frame.given["eta"])}
    adapted.fill(opened, frame.name, given, ("coframe", dict(entries)))
    return adapted


def _coefficients(bundle: TangentBundle, where: str, value: Element) -> tuple[Row, Element]:
    """a_i and c of a_i(q) u^i + c(q, t)."""
    found: Row = {}
    for i, symbol in enumerate(bundle.symbols.velocities):
        slope = value.diff(symbol)
        if not slope.is_zero:
            found[i] = slope
    terms = [(-1, a, bundle.velocities[i]) for i, a in found.items()]
    rest = bundle.field.sum([(1, value), *terms])
    velocities = set(bundle.symbols.velocities)
    bound = [a for a in found.values() if a.symbols & {*velocities, bundle.symbols.time}]
    if rest.symbols & velocities or bound or not found:
        raise ConstraintError(
            f"{where}: {value} = 0 is no constraint linear in the velocities. Give a sum of "
            "coefficients of q times u^i, plus a function of q and t if need be, as in 'u2' or "
            "'sin(theta)*u1 - cos(theta)*u2'."
        )
    return found, rest


def _pivots(bundle: TangentBundle, rows: Sequence[Row], names: Sequence[str]) -> list[int]:
    """For each constraint the form that it replaces, such that what results is a frame."""
    field, done = bundle.field, []
    places: list[int] = []
    for name, row in zip(names, rows, strict=True):
        reduced = dict(row)
        for place, other in done:
            factor = reduced.pop(place, None)
            if factor is None:
                continue
            for i, value in other.items():
                if i != place:
                    terms = [(1, reduced[i])] if i in reduced else []
                    reduced[i] = field.sum([*terms, (-1, factor, value)])
        reduced = {i: value for i, value in reduced.items() if not value.is_zero}
        if not reduced:
            raise ConstraintError(
                f"{name} follows from the constraints before it, or contradicts them. Leave it "
                "out: each constraint must take away one velocity."
            )
        # A pivot that may vanish would end the adapted frame where the given one goes on.
        place = min(reduced, key=lambda i: (_rank(bundle, reduced[i]), -i))
        scale = reduced[place].inverse()
        done.append((place, {i: value * scale for i, value in reduced.items()}))
        places.append(place)
    return places


def _rank(bundle: TangentBundle, value: Element) -> int:
    """0 for a number, 1 for a parameter, 2 for what may vanish somewhere."""
    if value.is_rational:
        return 0
    return 2 if value.symbols & set(bundle.frame.coordinates) else 1
