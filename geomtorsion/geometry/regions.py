"""Regions: where a frame is real, finite and regular, in words, with points and signs inside."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import count
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp
from flint import arb
from sympy.core.function import AppliedUndef

from geomtorsion.errors import CoordinateError
from geomtorsion.exact import TruncatedField
from geomtorsion.exact.candidates import GRAINS, Candidates
from geomtorsion.geometry.derived import derived
from geomtorsion.geometry.real_points import side
from geomtorsion.geometry.region_signs import RegionSigns, Verdict
from geomtorsion.geometry.region_words import conditions_of, fewest, in_words
from geomtorsion.geometry.walls import Walls
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import latex_of

if TYPE_CHECKING:
    from geomtorsion.geometry.frame import Frame

Array = np.ndarray

# Regions that are reported: more come from formulas with very many walls.
MOST = 12


@dataclass(frozen=True, eq=False, repr=False)
class Region:
    """A connected region where a coframe is real, finite and regular.

    point: symbol -> rational number, of coordinates and parameters; generic: no accidental relation
        between the numbers.
    relations: the fewest relations that describe the region; `str` gives them in words.
    signs: expression that vanishes at a wall -> its sign in the region, +1 or -1.
    box: bounds of each symbol around the point, without a wall between them.
    signature: signs of the metric, in the order of the rows of the frame.
    assumed: whether the region was chosen here; False where it is the declared domain.

    Examples
    --------
    >>> from geomtorsion.geometry import Frame
    >>> frame = Frame.from_metric(
    ...     "t r theta phi",
    ...     [["2*M/r - 1", 0, 0, 0], [0, "1/(1 - 2*M/r)", 0, 0],
    ...      [0, 0, "r**2", 0], [0, 0, 0, "r**2*sin(theta)**2"]],
    ...     parameters="M",
    ... )
    >>> print(frame.region)
    M > 0, r > 2*M, 0 < theta < pi
    >>> frame.region.sign("r - M"), frame.region.sign("r - 3*M"), frame.region.assumed
    (1, None, True)
    """

    point: Mapping[sp.Symbol, sp.Rational]
    relations: tuple[sp.Basic, ...]
    signs: Mapping[sp.Expr, int]
    box: tuple[sp.Basic, ...]
    signature: tuple[int, ...]
    assumed: bool
    _walls: Walls = field(repr=False)

    def __str__(self) -> str:
        return in_words(self.relations) or "everywhere"

    def __repr__(self) -> str:
        return f"Region({self})"

    def __reduce__(self) -> tuple[object, ...]:
        frame = self._walls.frame
        return _again, (frame, regions(frame).index(self))

    def _repr_latex_(self) -> str:
        return (
            "$" + ",\\; ".join(map(latex_of, self.relations)) + "$" if self.relations else str(self)
        )

    def __eq__(self, other: object) -> bool:
        """Equal points, relations, signs and boxes."""
        return self._content == other._content if isinstance(other, Region) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._content)

    @property
    def _content(self) -> tuple[object, ...]:
        pairs = tuple(self.point.items()), tuple(self.signs.items())
        return *pairs, self.relations, self.box, self.signature, self.assumed

    @property
    def assumption(self) -> str:
        """The region as a remark beside an answer; empty where the domain was declared.

        Examples
        --------
        >>> from geomtorsion.geometry import Frame
        >>> Frame("t r", [["sqrt(1 - r)", 0], [0, "1/sqrt(1 - r)"]]).region.assumption
        'for r < 1, assumed; declare domain=[...] for another region'
        """
        return f"for {self}, assumed; declare domain=[...] for another region" * self.assumed

    def points(self) -> Iterator[dict[sp.Symbol, sp.Rational]]:
        """Generic rational points inside the region, without end, the same at every call.

        The first one is `point`; parameters vary as coordinates do.

        Examples
        --------
        >>> from itertools import islice
        >>> from geomtorsion.geometry import Frame
        >>> frame = Frame("x y", [["sqrt(x - y)", 0], [0, 1]])
        >>> x, y = frame.coordinates
        >>> all(point[x] > point[y] for point in islice(frame.region.points(), 5))
        True
        """
        yield dict(self.point)
        seen, walls = {tuple(self.point.values())}, self._walls
        for numbers in walls.members(self):
            for number in numbers:
                inside = walls.candidates.exact(number)
                point = {s: inside[s] for s in walls.symbols}
                if tuple(point.values()) not in seen:
                    seen.add(tuple(point.values()))
                    yield point
        yield from self.near()

    def near(self) -> Iterator[dict[sp.Symbol, sp.Rational]]:
        """Generic rational points in the box around the point, without end.

        Examples
        --------
        >>> from geomtorsion.geometry import Frame
        >>> region = Frame("r theta", [[1, 0], [0, "r"]]).region
        >>> region.surrounds(next(region.near()))
        True
        """
        walls = self._walls
        bounds = {s: (_fraction(low.lts), _fraction(high.gts)) for s, low, high in self._sides}
        within = Candidates(walls.symbols, len(walls.symbols), bounds)
        for number in count():
            yield within.exact(number)

    def surrounds(self, values: Mapping[Any, Any]) -> bool:
        """Whether values of its symbols are in the box around the point, without a wall between.

        Examples
        --------
        >>> import sympy as sp
        >>> from geomtorsion.geometry import Frame
        >>> r, theta = sp.symbols("r theta")
        >>> region = Frame([r, theta], [[1, 0], [0, r]]).region
        >>> region.surrounds(region.point), region.surrounds({r: -1, theta: 1})
        (True, False)
        """
        return all(relation.subs(values) == sp.true for relation in self.box)

    @property
    def _sides(self) -> Iterator[tuple[sp.Symbol, Any, Any]]:
        pairs: Any = zip(self.point, self.box[::2], self.box[1::2], strict=True)
        return pairs

    def sign(self, expression: object) -> int | None:
        """The sign of an expression in the region, if it is proved: +1 or -1; else None.

        See `sign_verdict` for the reason of None. Single points where the expression vanishes do
        not count: (x - 1)**2 has the sign +1.

        Parameters
        ----------
        expression
            an exact element, a sympy expression, a number or text in the symbols of the frame.

        Raises
        ------
        ExpressionError
            The text or expression cannot be read.

        Examples
        --------
        >>> from geomtorsion.geometry import Frame
        >>> region = Frame("theta phi", [[1, 0], [0, "sin(theta)"]]).region
        >>> region.sign("sin(theta)"), region.sign("cos(theta)")
        (1, None)
        """
        return {"positive": 1, "negative": -1}.get(self.sign_verdict(expression))

    def sign_verdict(self, expression: object) -> Verdict:
        """The sign of an expression in the region: positive, negative, zero, both or undecided.

        A sign is proved for all points of the region; both signs are proved at two points.
        Expressions with unknown functions, about which nothing is assumed, are undecided. Arguments
        and errors as for `sign`.

        Examples
        --------
        The first is negative only within a thousandth of x = 1/2, the second nowhere:

        >>> from geomtorsion.geometry import Frame
        >>> region = Frame("x y", [["log(x)", 0], [0, 1]]).region
        >>> region.sign_verdict("(x - 1/2)**2 - 1/1000000"), region.sign_verdict("x**2 - x + 1")
        ('both', 'positive')
        """
        element = self._walls.element(expression)
        extremes = self._walls.extreme_points(self, element)
        return self._signs.verdict(element, extremes)

    @cached_property
    def _signs(self) -> RegionSigns:
        return RegionSigns(self._walls, self)


@derived
def regions(frame: Frame) -> tuple[Region, ...]:
    """See Frame.regions.

    Raises
    ------
    CoordinateError
        No point was found where the frame is real, finite and regular.
    """
    if isinstance(frame.field, TruncatedField):
        whole: Any = frame._plain[1]
        return regions(whole[0])
    walls = Walls(frame)
    if not walls.source.table.groups:
        raise CoordinateError(
            f"expected a region where the frame is real and regular, got none: "
            f"{walls.source.refusal()}"
        )
    table = walls.table
    values = np.concatenate([walls.start(), table.values, *walls.extremes()], axis=1)
    with np.errstate(all="ignore"):
        numbers = walls.numbers(values)
    signs = np.where(np.isfinite(numbers), np.sign(np.real(numbers)), 0).astype(int)
    order = [0, *(1 + k for group in table.groups for k in group.numbers)]
    split = [s for s in walls.source.parameters if s.is_positive is None and s.is_negative is None]
    rows = [walls.symbols.index(s) for s in split]
    first: dict[tuple[tuple[int, ...], ...], int] = {}
    for k in order:
        key = tuple(map(int, signs[:, k])), tuple(map(int, np.sign(values[rows, k])))
        if all(key[0]):
            first.setdefault(key, k)
    found = []
    for (key, _), k in list(first.items())[:MOST]:
        point = walls.first_point() if k == 0 else walls.candidates.exact(k - 1)
        found.append(_region(walls, point, np.array(key, dtype=int), values, signs))
    return tuple(found)


def _again(frame: Frame, number: int) -> Region:
    """A region of a frame by its number."""
    return regions(frame)[number]


def _region(
    walls: Walls, point: dict[sp.Expr, Any], own: Array, values: Array, signs: Array
) -> Region:
    """The region of a point with given signs of all walls."""
    finite = signs != 0
    finite[:, -1] = True
    within = np.ones(values.shape[1], dtype=bool)
    domain = tuple(walls.source.relations)
    with np.errstate(all="ignore"):
        within &= np.all(np.real(walls.sides(values)) > 0, axis=0)
    varied = [
        (expression, int(sign))
        for expression, sign, row, ok in zip(walls.expressions, own, signs, finite, strict=True)
        if len(set(row[ok & within])) > 1 and not (domain and expression.has(AppliedUndef))
    ]
    conditions = conditions_of(varied, point, walls.symbols, walls.source, walls.arguments)
    # Behind each wall, so that none is dropped that bounds the region.
    center = np.array([[float(point[s])] for s in walls.arguments])
    values = np.concatenate([values, walls.beyond(center, values, own)], axis=1)
    with np.errstate(all="ignore"):
        within = np.all(np.real(walls.sides(values)) > 0, axis=0)
    words = fewest(conditions, values[:, within])
    relations = (*domain, *(r for one in words for r in one.relations))
    eta = tuple(int(walls.frame.eta.at({})[i, i].real) for i in range(walls.frame.dimension))
    return Region(
        {s: point[s] for s in walls.symbols},
        relations,
        dict(zip(walls.expressions, map(int, own), strict=True)),
        _box(walls, point, own),
        eta,
        bool(words),
        walls,
    )


def _box(walls: Walls, point: dict[sp.Expr, Any], own: Array) -> tuple[sp.Basic, ...]:
    """Bounds of each symbol; balls prove that no wall lies between them."""
    center = {s: _fraction(value) for s, value in point.items()}
    names = {s: sp.Symbol(f"x{k}") for k, s in enumerate(walls.arguments)}
    sides = [side(relation) for relation in walls.source.relations]
    width = Fraction(1, 2)
    ends: dict[sp.Expr, list[Fraction]] = {}
    while width > Fraction(1, GRAINS[0]):
        ends = {s: sorted((x * (1 - width), x * (1 + width))) for s, x in center.items()}
        balls = [_ball(*ends[s]) if s in walls.symbols else _ball(center[s]) for s in names]
        if _is_clear(walls, [*walls.expressions, *sides], [*own, *(1 for _ in sides)], balls):
            break
        width /= 2
    bounds = (
        (s, *(sp.Rational(x.numerator, x.denominator) for x in ends[s])) for s in walls.symbols
    )
    return tuple(r for s, low, high in bounds for r in (s > low, s < high))


def _is_clear(
    walls: Walls, expressions: Sequence[sp.Expr], signs: Sequence[int], balls: list[arb]
) -> bool:
    """Whether all expressions keep their signs on balls, as is proved by ball arithmetic."""
    code = walls.balls(expressions)
    if code is None:
        return True
    return all(
        isinstance(value, arb) and (value > 0 if sign > 0 else value < 0)
        for value, sign in zip(code.real(balls), signs, strict=True)
    )


def _fraction(value: Any) -> Fraction:
    return Fraction(int(value.p), int(value.q))


def _rational(value: Fraction) -> sp.Rational:
    return sp.Rational(value.numerator, value.denominator)


def _ball(low: Fraction, high: Fraction | None = None) -> arb:
    """The ball over an interval."""
    high = low if high is None else high
    middle, radius = (low + high) / 2, (high - low) / 2
    number = arb(middle.numerator) / middle.denominator
    return number + arb(0, arb(radius.numerator) / radius.denominator) if radius else number
