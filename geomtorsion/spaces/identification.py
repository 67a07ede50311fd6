"""Identify: the shipped space that a frame is, in other coordinates or with other legs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import islice, product
from math import prod

import numpy as np
import sympy as sp

from geomtorsion.errors import ArgumentError, GeomtorsionError
from geomtorsion.exact import unknown_functions
from geomtorsion.geometry import Frame
from geomtorsion.geometry.connections import FrameLike, as_frame
from geomtorsion.same import Classification, Equivalence, Invariants
from geomtorsion.same.classification import classification, signature
from geomtorsion.same.equivalence import KEEPS, TRIES, refuse_functions
from geomtorsion.same.fitting import parameters_near
from geomtorsion.same.scalars import is_excluded
from geomtorsion.spaces.registry import CHARTS, names, shipped_space
from geomtorsion.support import checks
from geomtorsion.support.allowance import check_limits
from geomtorsion.support.copies import content_hash, equal_content, only_fields

# Parameters are looked for as a rational number times powers of the parameters of the frame.
POWERS = (Fraction(0), Fraction(1), Fraction(-1), Fraction(2), Fraction(-2), Fraction(1, 2))
# The largest denominator of that rational number; it must be met far more exactly than by chance.
LARGEST = 1000
CLOSE = 0.1 / LARGEST**2


@dataclass(frozen=True, eq=False, repr=False)
class Identified:
    """A shipped space that a frame is.

    name, title, source: of the space.
    parameters: values of its parameters by name, with parameters of the frame; 0 is a limit of the
        space where its parameter is positive.
    equivalence: the comparison, with its certainty and the map of the coordinates.
    """

    name: str
    title: str
    source: str
    parameters: Mapping[str, sp.Expr]
    equivalence: Equivalence

    def __eq__(self, other: object) -> bool:
        return equal_content(self, other)

    def __hash__(self) -> int:
        return content_hash(self)

    def __getstate__(self) -> dict[str, object]:
        return only_fields(self)

    def __str__(self) -> str:
        values = ", ".join(f"{k} = {v}" for k, v in self.parameters.items())
        with_values = f" with {values}" if values else ""
        return f"{self.name}: {self.title}{with_values}"

    def __repr__(self) -> str:
        return str(self)


@dataclass(frozen=True, eq=False, repr=False)
class Identification:
    """Result of `identify`: properties of a frame, and shipped spaces that are the same geometry.

    matches: the spaces that are the same geometry; the first one only, unless all were requested.
    undecided: names of spaces that may or may not be the same.
    special: names of spaces that may be the same for special values of their parameters only.
    classification: properties such as flat, of constant curvature, vacuum or a product.
    assumption: the region that was assumed, in words; empty where the domain was declared.
    negated: whether minus the metric was identified, as its signature has more minus signs.

    It is true where a space is found, and where the curvature is constant.
    """

    matches: tuple[Identified, ...]
    undecided: tuple[str, ...]
    special: tuple[str, ...]
    classification: Classification
    assumption: str = ""
    negated: bool = False

    def __eq__(self, other: object) -> bool:
        return equal_content(self, other)

    def __hash__(self) -> int:
        return content_hash(self)

    def __getstate__(self) -> dict[str, object]:
        return only_fields(self)

    def __bool__(self) -> bool:
        return bool(self.matches) or self.classification.curvature is not None

    def __str__(self) -> str:
        about = str(self.classification)
        if self.matches:
            lines = [*map(str, self.matches), f"  {about}"]
        elif self.classification.curvature is not None:
            lines = [about, "  none of the shipped spaces is a chart of it"]
        elif self.undecided:
            lines = [f"undecided: {', '.join(self.undecided)}", f"  {about}"]
        else:
            lines = ["none of the shipped spaces", f"  {about}"]
        if self.special and not self:
            lines.append(f"  special parameters are not excluded for {', '.join(self.special)}")
        if self.negated:
            lines.append("  for minus the metric, which has more plus signs")
        if self.assumption:
            lines.append(f"  {self.assumption}")
        return "\n".join(lines)

    def __repr__(self) -> str:
        return str(self)


def identify(frame: FrameLike, keep: str = "metric", *, every: bool = False) -> Identification:
    """Properties of a frame, and the shipped space that it is, with values of its parameters.

    Dimension, signature, constant curvature, Ricci and Weyl tensor, torsion, the number of
    symmetries and the Petrov type are compared first. Where they agree, values of parameters are
    fitted at one point, read as rational numbers times powers of the parameters of the frame, and
    confirmed by all invariants to 50 digits, as in `same_geometry`.

    Parameters
    ----------
    frame
        A frame, a space or a name; without unknown functions.
    keep
        "metric", "teleparallel" or "legs", as in `same_geometry`.
    every
        True: all spaces that are the same; False: the first one.

    Returns
    -------
    Identification: matches, properties, and the region that was assumed for a frame without domain.
    A space that cannot be excluded is reported as undecided.

    Raises
    ------
    ArgumentError
        The frame contains unknown functions, or `keep` has another value.

    Examples
    --------
    >>> from geomtorsion.geometry import Frame
    >>> print(identify(Frame("u v", [["3/u", 0], [0, "3/u"]], domain="u > 0")))
    constant curvature -1/9, 3 symmetries
      none of the shipped spaces is a chart of it
    >>> print(identify(Frame("u v", [[3, 0], [0, "3*cos(u)"]], domain="0 < u < 1")))
    s2: the sphere of radius R, compass frame with R = 3
      constant curvature 1/9, 3 symmetries
    """
    frame = as_frame(frame)
    refuse_functions(frame)
    name = checks.choice(keep, KEEPS, "keep", ArgumentError)
    checks.flag(every, "every")
    minus, plus = signature(frame)
    negated = minus > plus
    frame = _negated(frame) if negated else frame
    query = _Query.of(frame, name)
    matches, undecided, special = list[Identified](), list[str](), list[str]()
    general, limits = _candidates(query.classification, name)
    for charts in general:
        check_limits()
        equal, is_open = query.compared(charts, every)
        matches += equal
        undecided += charts[:1] if is_open else []
        if matches and not every:
            break
    for charts in () if matches else limits:
        check_limits()
        equal, is_open = query.compared(charts, every)
        matches += equal
        special += charts[:1] if is_open else []
        if matches:
            break
    parts = tuple(matches), tuple(undecided), tuple(special)
    return Identification(*parts, query.classification, query.assumption, negated)


def _negated(frame: Frame) -> Frame:
    """The frame with minus its metric."""
    n = range(frame.dimension)
    domain, parameters = frame.domain, frame.parameters
    if frame.shape == "metric":
        rows = [[-frame.metric[i, j] for j in n] for i in n]
        return Frame.from_metric(frame.coordinates, rows, domain=domain, parameters=parameters)
    return Frame(
        frame.coordinates,
        [[frame.coframe[i, k] for k in n] for i in n],
        [[-frame.eta[i, j] for j in n] for i in n],
        domain=domain,
        parameters=parameters,
        complex=frame.complex,
    )


def _candidates(
    own: Classification, keep: str
) -> tuple[list[tuple[str, ...]], list[tuple[str, ...]]]:
    """Spaces with the same properties, and spaces with special members that have them."""
    general, limits = [], []
    for charts in _groups(keep):
        frame = shipped_space(charts[0]).frame
        if frame.dimension != own.dimension or _has_functions(frame):
            continue
        other = _classification(charts[0], keep)
        # In flat spaces only the legs depend on parameters.
        if other.is_flat and keep == "metric" and frame.parameters:
            continue
        if not own.excludes(other):
            general.append(charts)
        elif frame.parameters and own.may_be_special(other):
            limits.append(charts)
    return general, limits


def _groups(keep: str) -> list[tuple[str, ...]]:
    """Names of the shipped spaces; charts of one metric together, the first to be fitted."""
    if keep != "metric":
        return [(name,) for name in names()]
    group = {name: charts for charts in CHARTS for name in charts}
    return list(dict.fromkeys(group.get(name, (name,)) for name in names()))


def _has_functions(frame: Frame) -> bool:
    return bool(unknown_functions(x for matrix in frame.given.values() for x in matrix.values()))


@cache
def _classification(name: str, keep: str) -> Classification:
    """The properties of a shipped space for general values of its parameters."""
    return classification(Invariants(shipped_space(name).frame, keep))


@dataclass(frozen=True)
class _Query:
    """The frame that is looked for, at generic values of its parameters.

    values: those values, by name.
    """

    one: Invariants
    values: Mapping[str, sp.Rational]
    classification: Classification
    assumption: str

    @classmethod
    def of(cls, frame: Frame, keep: str) -> _Query:
        """The query for a frame."""
        point = frame.region.point
        values = {str(x): point[x] for x in frame.parameters}
        whole = Invariants(frame, keep)
        one = Invariants(frame.subs(values), keep) if values else whole
        return cls(one, values, classification(whole), frame.region.assumption)

    def compared(self, charts: tuple[str, ...], every: bool) -> tuple[list[Identified], bool]:
        """The first or every chart that is the same, and whether none is found or excluded."""
        first = shipped_space(charts[0]).frame
        if not first.parameters:
            return self._verdicts(charts, {}, every)
        two = Invariants(first, self.one.keep)
        fitting = self._fitting(two)
        # Most geometries that are the same fit at once; a proof that none does saves other starts.
        for candidates in (islice(fitting, 1), fitting):
            for place, values in candidates:
                same, _ = self._verdicts(charts, values, every, place)
                if same:
                    return same, False
            if is_excluded(self.one, two):
                return [], False
        return [], True

    def _verdicts(
        self,
        charts: tuple[str, ...],
        values: Mapping[str, sp.Expr],
        every: bool,
        place: np.ndarray | None = None,
    ) -> tuple[list[Identified], bool]:
        """The first or every chart that is the same geometry at values of its parameters."""
        same, is_open = [], False
        for name in sorted(charts, key=names().index):
            space = shipped_space(name)
            numbers = {
                k: x.subs({own: self.values[own.name] for own in x.free_symbols})
                for k, x in values.items()
            }
            try:
                other = _member(space.frame, numbers)
                two = Invariants(other, self.one.keep)
                near = place if name == charts[0] else None
                equivalence = Equivalence(
                    self.one, two, False, self.values, (self.assumption, ""), near
                )
                verdict = equivalence.verdict
            except GeomtorsionError:
                # Values that the space does not allow.
                continue
            is_open = is_open or verdict == "undecided"
            if verdict == "same":
                texts = name, space.title, space.source
                same.append(Identified(*texts, values, equivalence))
                if not every:
                    break
        return same, is_open and not same

    def _fitting(self, two: Invariants) -> Iterator[tuple[np.ndarray | None, dict[str, sp.Expr]]]:
        """Coordinates and values of parameters at which the invariants of a point recur."""
        tried = set[tuple[sp.Expr, ...]]()
        # A few points, each from a few starts.
        points = islice(self.one.frame.region.points(), TRIES // 4)
        for number, start in enumerate(points):
            for fit in parameters_near(self.one, start, two, TRIES // 3):
                options = [list(islice(_expressions(x, self.values), 4)) for x in fit.values]
                for chosen in product(*options):
                    if chosen not in tried:
                        tried.add(chosen)
                        named = dict(zip(map(str, two.frame.parameters), chosen, strict=True))
                        yield None if number else fit.place, named


def _member(frame: Frame, values: Mapping[str, sp.Expr]) -> Frame:
    """The frame at values of its parameters, or its limit where a positive one is zero."""
    zeros = {x: 0 for x in frame.parameters if values[str(x)] == 0 and x.is_zero is False}
    if not zeros:
        return frame.subs(values) if values else frame
    n = range(frame.dimension)
    relations = [relation.subs(zeros) for relation in frame.domain]
    # Roots of squares take the signs that they have in the domain: sqrt(r**2) is r.
    signs = {q: sp.Dummy(positive=True) for q in frame.coordinates if frame.region.sign(q) == 1}
    back = {dummy: q for q, dummy in signs.items()}
    rows = [
        [sp.powdenest(frame.coframe[i, k].subs({**zeros, **signs})).subs(back) for k in n]
        for i in n
    ]
    limit = Frame(
        frame.coordinates,
        rows,
        [[frame.eta[i, k] for k in n] for i in n],
        parameters=[x for x in frame.parameters if x not in zeros],
        domain=[relation for relation in relations if relation != sp.true],
        complex=frame.complex,
    )
    return limit.subs({str(x): values[str(x)] for x in limit.parameters})


def _expressions(value: float, own: Mapping[str, sp.Rational]) -> Iterator[sp.Expr]:
    """A float as a simple number times powers of parameters, the simplest first."""
    if value == 0:
        yield sp.Integer(0)
    if not value or not np.isfinite(value):
        return
    simple = []
    for powers in product(POWERS, repeat=len(own)):
        factors = zip(own.values(), powers, strict=True)
        size = prod(float(v) ** float(p) for v, p in factors)
        for root in (1, 2):
            ratio = Fraction((value / size) ** root).limit_denominator(LARGEST)
            if ratio and abs(float(ratio) - (value / size) ** root) < CLOSE * abs(float(ratio)):
                number = sp.Rational(ratio.numerator, ratio.denominator)
                number = number if root == 1 else sp.sign(sp.Float(value)) * sp.sqrt(number)
                monomial = sp.prod(
                    sp.Symbol(k, positive=True) ** sp.Rational(p.numerator, p.denominator)
                    for k, p in zip(own, powers, strict=True)
                )
                cost = ratio.numerator + ratio.denominator + 5 * sum(map(abs, powers)) + 9 * root
                simple.append((cost, str(number * monomial), number * monomial))
                break
    for _, _, expression in sorted(simple, key=lambda entry: entry[:2]):
        yield expression
